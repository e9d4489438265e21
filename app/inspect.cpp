// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/steps.hpp"
#include "acquisition/importer.hpp"
#include "acquisition/statistics.hpp"
#include "app/import_options.hpp"
#include "app/program.hpp"
#include "app/rebound_texts.hpp"
#include "datasets/input_error.hpp"
#include "fitting/plausibility.hpp"
#include "fitting/velocity_timing.hpp"
#include "reports/json_parts.hpp"

namespace impactrig::app {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string file;
  std::string rig;  ///< what the sensors are and how the recording is conditioned; "" = as recorded
  DetectionArguments detection;
  ImportArguments reading;
  bool no_statistics = false;
  CommonOptions common;
};

/// Impacts are looked for in recordings of up to so many samples, as those must be in memory.
constexpr std::uint64_t most_searched = 16'000'000;

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

/// Figures of every channel, as its samples come.
class Gathering final : public acquisition::SampleSink {
 public:
  Gathering(const acquisition::RecordingHead& head, const std::vector<std::size_t>& chosen)
      : statistics_(chosen.size()),
        complex_(chosen.size(), false) {
    for (const std::size_t index : chosen) heads_.push_back(head.record.channels[index]);
  }

  void take(std::size_t channel, const acquisition::SampleBlock& block) override {
    statistics_[channel].add(block, heads_[channel].scale, heads_[channel].offset);
    complex_[channel] = complex_[channel] || !block.imaginary.empty();
  }

  void take_times(std::size_t channel, std::span<const double>) override {
    uneven_.insert(channel);
  }

  acquisition::ChannelStatistics statistics(std::size_t channel) const {
    return statistics_[channel].figures();
  }

  bool complex(std::size_t channel) const { return complex_[channel]; }

  bool uniform(std::size_t channel) const { return !uneven_.contains(channel); }

 private:
  std::vector<datasets::Channel> heads_;
  std::vector<acquisition::StatisticsGathering> statistics_;
  std::vector<bool> complex_;
  std::set<std::size_t> uneven_;
};

/// What the head says of a channel.
ordered_json head_json(const datasets::Channel& channel, std::uint64_t samples) {
  const double interval = channel.clock.interval;
  return {{"name", channel.name},
          {"quantity", datasets::name(channel.quantity)},
          {"unit", channel.unit},
          {"samples", samples},
          {"sample_rate_hz", number(interval > 0.0 ? 1.0 / interval : NAN)},
          {"interval_s", number(interval > 0.0 ? interval : NAN)},
          {"start_s", number(samples > 0 ? channel.clock.start : NAN)}};
}

void add_statistics(const Gathering& gathering, std::size_t channel, ordered_json& json) {
  const acquisition::ChannelStatistics s = gathering.statistics(channel);
  json["uniform"] = gathering.uniform(channel);
  json["first"] = number(s.first);
  json["last"] = number(s.last);
  json["min"] = number(s.min);
  json["max"] = number(s.max);
  json["mean"] = number(s.mean);
  json["rms"] = number(s.rms);
  json["sum"] = number(s.sum);
  json["sum_of_squares"] = number(s.sum_of_squares);
  json["invalid"] = s.invalid;
  if (!gathering.complex(channel)) return;
  json["complex"] = true;
  json["sum_re"] = number(s.complex_sum.real());
  json["sum_im"] = number(s.complex_sum.imag());
  json["sum_abs2"] = number(s.sum_abs2);
}

ordered_json impact_json(const datasets::Impact& impact, const datasets::Channel& channel) {
  using enum datasets::Quantity;
  ordered_json flags = ordered_json::array();
  for (const datasets::ImpactFlag flag : impact.flags) flags.push_back(datasets::name(flag));
  const char* const impulse_unit = channel.quantity == force          ? "N s"
                                   : channel.quantity == acceleration ? "m/s"
                                   : channel.quantity == displacement ? "m s"
                                                                      : "m";
  ordered_json json = {
      {"channel", channel.name},         {"unit", datasets::si_unit(channel.quantity)},
      {"start_s", number(impact.start)}, {"end_s", number(impact.end)},
      {"peak", number(impact.peak)},     {"peak_time_s", number(impact.peak_time)},
      {"width_s", number(impact.width)}, {"impulse", number(impact.impulse)},
      {"impulse_unit", impulse_unit},    {"flags", flags}};
  if (impact.velocity || impact.rebound)
    json["approach_velocity_m_s"] = number(impact.approach_velocity);
  if (impact.rebound) json["rebound"] = reports::rebound_json(*impact.rebound);
  return json;
}

/// That a search which was asked for found nothing.
std::string no_impact(std::string_view where) {
  return fmt::format(
      "there is no impact in {}: nothing rises clearly above the noise (--threshold states from "
      "which departure on there is one, --trigger another channel)",
      where);
}

/// Impacts in one channel of a record; a sentence where they cannot be looked for.
void add_impacts(const datasets::Record& record, std::size_t index,
                 acquisition::DetectionOptions options, ordered_json& list,
                 std::vector<std::string>& warnings) {
  const datasets::Channel& channel = record.channels[index];
  options.trigger_index = index;
  try {
    for (const datasets::Impact& impact : acquisition::find_impacts(record, options))
      list.push_back(impact_json(impact, channel));
  } catch (const datasets::InputError& error) {
    warnings.push_back(
        fmt::format("impacts of '{}' were not looked for: {}", channel.name, error.problem()));
  }
}

/// Of which quantities a record is searched: the first of these kinds that it has.
std::vector<datasets::Quantity> searched_quantities(const datasets::Record& record) {
  using enum datasets::Quantity;
  const std::vector<std::vector<datasets::Quantity>> kinds = {{force, acceleration}, {velocity}};
  for (const auto& kind : kinds)
    for (const datasets::Channel& channel : record.channels)
      if (std::ranges::find(kind, channel.quantity) != kind.end()) return kind;
  return {displacement};
}

/// Impacts of the trigger channel, else of every force and acceleration, or every velocity where
/// there are none, or every displacement where there are none either, each searched alone.
ordered_json impacts_json(const datasets::Record& record, const DetectionArguments& detection,
                          std::vector<std::string>& warnings) {
  ordered_json list = ordered_json::array();
  const acquisition::DetectionOptions options = detection_options(detection);
  const std::size_t told = warnings.size();
  if (!detection.trigger.empty()) {
    const datasets::Channel* const channel = record.find(detection.trigger);
    if (channel == nullptr)
      throw datasets::InputError(
          {.file = record.provenance.source_file},
          fmt::format("there is no single channel '{}' to look for impacts in", detection.trigger));
    add_impacts(record, static_cast<std::size_t>(channel - record.channels.data()), options, list,
                warnings);
    if (list.empty() && warnings.size() == told)
      warnings.push_back(no_impact(fmt::format("'{}'", channel->name)));
    return list;
  }
  const std::vector<datasets::Quantity> quantities = searched_quantities(record);
  bool searched = false;
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    const datasets::Channel& channel = record.channels[i];
    if (std::ranges::find(quantities, channel.quantity) == quantities.end()) continue;
    // What is over no time has no impacts; of uneven times a sentence says what to do.
    const bool over_time = !channel.clock.uniform() || channel.clock.interval > 0.0;
    if (channel.complex() || !over_time) continue;
    searched = true;
    add_impacts(record, i, options, list, warnings);
  }
  const bool any = std::ranges::any_of(record.channels, [](const datasets::Channel& channel) {
    return !channel.complex() && channel.clock.uniform() && channel.clock.interval > 0.0;
  });
  if (!searched && any)
    warnings.emplace_back(
        "impacts were not looked for: no channel is a force, an acceleration, a velocity or a "
        "displacement (--rig or import --map says what they are)");
  if (detection.threshold > 0.0 && searched && list.empty() && warnings.size() == told)
    warnings.push_back(fmt::format(
        "there is no impact: no {} passes --threshold {:g} from a quiet level; state a lower one, "
        "or a higher one where noise passes it",
        quantities.size() > 1 ? "force or acceleration" : datasets::name(quantities.front()),
        detection.threshold));
  return list;
}

/// Impacts as a fit with this rig sees them: through its sensors, conditioned, held against it.
ordered_json impacts_on_rig(const datasets::Record& recorded, const Options& options,
                            std::vector<std::string>& warnings) {
  const fitting::RigFile rig = fitting::read_rig_file(options.rig);
  const acquisition::SensorSet sensors{rig.force, rig.velocity, rig.displacement};
  datasets::Record record = acquisition::condition(recorded, sensors);
  acquisition::apply_steps(rig.conditioning, record, sensors, detection_options(options.detection));
  for (std::size_t i = recorded.warnings.size(); i < record.warnings.size(); ++i)
    warnings.push_back(record.warnings[i]);
  ordered_json list = ordered_json::array();
  for (datasets::Impact& impact :
       acquisition::find_impacts(record, detection_options(options.detection))) {
    const auto balance = fitting::momentum_balance(impact, rig);
    if (balance && !balance->plausible) {
      impact.flags.push_back(datasets::ImpactFlag::implausible);
      warnings.push_back(balance->sentence);
    }
    if (std::string timing = fitting::velocity_out_of_time(impact, rig); !timing.empty())
      warnings.push_back(std::move(timing));
    const auto trigger =
        std::ranges::find(record.channels, impact.trigger, &datasets::Channel::name);
    ordered_json json = impact_json(impact, *trigger);
    if (balance) json["impulse_ratio"] = number(balance->ratio);
    list.push_back(std::move(json));
  }
  if (list.empty()) warnings.push_back(no_impact("the channels of the rig's sensors"));
  return list;
}

std::string shown(const ordered_json& value) {
  return value.is_null() ? std::string("-") : fmt::format("{:.6g}", value.get<double>());
}

/// A vibration has many pulses: the first few of each channel are shown.
void print_impacts(const ordered_json& impacts) {
  constexpr int most = 6;
  if (!impacts.empty()) fmt::print("\nimpacts:\n");
  std::map<std::string, int> found;
  for (const auto& i : impacts) {
    const auto channel = i["channel"].get<std::string>();
    if (++found[channel] > most) continue;
    fmt::print(
        "  {}: at {} s, peak {} {}, width {} s, impulse {} {}{}\n", channel, shown(i["start_s"]),
        shown(i["peak"]), i["unit"].get<std::string>(), shown(i["width_s"]), shown(i["impulse"]),
        i["impulse_unit"].get<std::string>(),
        i["flags"].empty()
            ? ""
            : fmt::format(" ({})", fmt::join(i["flags"].get<std::vector<std::string>>(), ", ")));
    if (i.contains("rebound"))
      fmt::print("    {}\n", rebound_text(i["approach_velocity_m_s"], i["rebound"]));
  }
  for (const auto& [channel, count] : found)
    if (count > most) fmt::print("  {}: {} more (--json lists them all)\n", channel, count - most);
}

/// How many samples are not valid, of the first few channels that have such.
void print_invalid(const ordered_json& channels) {
  constexpr std::size_t most = 8;
  std::vector<std::string> told;
  std::size_t found = 0;
  for (const auto& c : channels) {
    const std::size_t count = c.value("invalid", std::size_t{0});
    if (count > 0 && ++found <= most)
      told.push_back(fmt::format("{} of '{}'", count, c["name"].get<std::string>()));
  }
  if (found == 0) return;
  if (found > most) told.push_back(fmt::format("{} more channels (--json has all)", found - most));
  fmt::print("\nsamples not valid:  {}; the figures are those of all that are numbers\n",
             fmt::join(told, ", "));
}

void print_text(const ordered_json& json) {
  const auto started = json.value("started", std::string());
  fmt::print("{}: {}{}{}\n\n", json["file"].get<std::string>(), json["format"].get<std::string>(),
             started.empty() ? "" : ", recorded ", started);
  if (json["channels"].empty()) fmt::print("no channels\n");
  std::size_t widest = 7;
  for (const auto& c : json["channels"])
    widest = std::max(widest, c["name"].get<std::string>().size());
  if (!json["channels"].empty())
    fmt::print("  #  {:<{}}  {:<13}{:<8}{:>10}  {:>12}  {:>12}  {:>12}  {:>12}  {:>12}\n",
               "channel", widest, "quantity", "unit", "samples", "rate [Hz]", "start [s]", "min",
               "max", "rms");
  int index = 0;
  for (const auto& c : json["channels"])
    fmt::print("{:>3}  {:<{}}  {:<13}{:<8}{:>10}  {:>12}  {:>12}  {:>12}  {:>12}  {:>12}\n",
               index++, c["name"].get<std::string>(), widest, c["quantity"].get<std::string>(),
               c["unit"].get<std::string>(),
               fmt::format("{}{}", c.contains("samples_estimated") ? "~" : "",
                           c["samples"].get<std::size_t>()),
               shown(c["sample_rate_hz"]), shown(c["start_s"]),
               shown(c.value("min", ordered_json())), shown(c.value("max", ordered_json())),
               shown(c.value("rms", ordered_json())));
  print_invalid(json["channels"]);
  if (json.contains("attributes")) {
    fmt::print("\nas read:");
    for (const auto& [key, text] : json["attributes"].items())
      fmt::print("  {} = {}", key, text.get<std::string>());
    fmt::print("\n");
  }
  print_impacts(json.value("impacts", ordered_json::array()));
  for (const auto& warning : json["warnings"])
    fmt::print("\nwarning: {}\n", warning.get<std::string>());
}

/// Channels with figures over their samples; `record` becomes what was read.
ordered_json read_channels(acquisition::RecordingReader& reader,
                           const acquisition::Selection& wanted, datasets::Record& record) {
  const std::vector<std::size_t> chosen = acquisition::selected_channels(reader.head(), wanted);
  Gathering gathering(reader.head(), chosen);
  record = acquisition::read_window(reader, wanted, gathering);
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    const datasets::Channel& channel = record.channels[i];
    ordered_json json = head_json(channel, gathering.statistics(i).samples);
    add_statistics(gathering, i, json);
    if (!channel.attributes.empty()) json["attributes"] = channel.attributes;
    list.push_back(std::move(json));
  }
  return list;
}

/// Channels by the head alone.
ordered_json list_channels(const acquisition::RecordingHead& head,
                           const acquisition::Selection& wanted) {
  ordered_json list = ordered_json::array();
  for (const std::size_t index : acquisition::selected_channels(head, wanted)) {
    ordered_json json = head_json(head.record.channels[index], head.samples[index]);
    if (!head.counted) json["samples_estimated"] = true;
    if (!head.record.channels[index].attributes.empty())
      json["attributes"] = head.record.channels[index].attributes;
    list.push_back(std::move(json));
  }
  return list;
}

std::uint64_t samples_of(const ordered_json& channels) {
  std::uint64_t samples = 0;
  for (const auto& channel : channels) samples += channel["samples"].get<std::uint64_t>();
  return samples;
}

/// Impacts where the samples fit into memory; else a sentence.
ordered_json find_all_impacts(acquisition::RecordingReader& reader,
                              const acquisition::Selection& wanted, const ordered_json& channels,
                              const Options& options, std::vector<std::string>& warnings) {
  const std::uint64_t samples = samples_of(channels);
  if (samples <= most_searched) {
    const datasets::Record record = acquisition::read_into_memory(reader, wanted);
    return options.rig.empty() ? impacts_json(record, options.detection, warnings)
                               : impacts_on_rig(record, options, warnings);
  }
  warnings.push_back(fmt::format(
      "impacts are looked for in up to {} million samples, these are {} million: --channel, "
      "--from and --to say where to look",
      most_searched / 1'000'000, samples / 1'000'000));
  return ordered_json::array();
}

/// Where a head alone is an estimate, it may lack channels that are asked for: of later segments.
std::unique_ptr<acquisition::RecordingReader> open(const Options& options,
                                                   acquisition::ImportOptions reading) {
  reading.head_only = options.no_statistics;
  auto reader = acquisition::open_recording(options.file, reading);
  const acquisition::RecordingHead& head = reader->head();
  const bool all_known = std::ranges::all_of(
      reading.channels, [&](const std::string& name) { return head.record.find(name) != nullptr; });
  if (head.counted || all_known) return reader;
  reading.head_only = false;
  return acquisition::open_recording(options.file, reading);
}

void inspect(const Options& options) {
  acquisition::ImportOptions reading = import_options(options.reading);
  reading.require_clock = false;
  const auto reader = open(options, reading);
  const acquisition::Selection wanted = acquisition::selection_of(reader->head(), reading);
  datasets::Record record = reader->head().record;
  ordered_json channels = options.no_statistics ? list_channels(reader->head(), wanted)
                                                : read_channels(*reader, wanted, record);
  std::vector<std::string> warnings = record.warnings;
  ordered_json json = {{"schema", "impactrig/inspect/1"},
                       {"file", options.file},
                       {"format", record.provenance.importer},
                       {"bytes", record.provenance.bytes}};
  // a part of the file is asked for, so that the whole is not read
  const bool all = wanted.channels.empty() && !wanted.has_window();
  if (!options.no_statistics && all)
    json["sha256"] = acquisition::sha256_of_recording(options.file);
  if (!record.started.empty()) json["started"] = record.started;
  json["channels"] = channels;
  if (!record.attributes.empty()) json["attributes"] = record.attributes;
  if (!options.no_statistics)
    json["impacts"] = find_all_impacts(*reader, wanted, channels, options, warnings);
  json["warnings"] = warnings;
  if (options.common.json)
    fmt::print("{}\n", json.dump(2, ' ', false, ordered_json::error_handler_t::replace));
  else
    print_text(json);
}

}  // namespace

void add_inspect(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "inspect", "Show what is in a recording: channels, statistics, impacts, warnings");
  command->add_option("file", options->file, "A recording of any format")->required();
  command->add_option("--rig", options->rig,
                      "Rig file: impacts as a fit sees them, held against the rig");
  add_detection_arguments(*command, options->detection);
  add_selection_arguments(*command, options->reading);
  add_import_arguments(*command, options->reading);
  command->add_flag("--no-statistics", options->no_statistics,
                    "Only what the head says: at once, whatever the size");
  add_json(*command, options->common);
  command->callback([options] { inspect(*options); });
}

}  // namespace impactrig::app
