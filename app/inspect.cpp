// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/importer.hpp"
#include "acquisition/statistics.hpp"
#include "app/import_options.hpp"
#include "app/program.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::app {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string file;
  ImportArguments reading;
  CommonOptions common;
};

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json channel_json(const datasets::Channel& channel) {
  const acquisition::ChannelStatistics s = acquisition::statistics(channel);
  const double interval = channel.clock.interval;
  ordered_json json = {{"name", channel.name},
                       {"quantity", datasets::name(channel.quantity)},
                       {"unit", channel.unit},
                       {"samples", s.samples},
                       {"sample_rate_hz", number(interval > 0.0 ? 1.0 / interval : NAN)},
                       {"interval_s", number(interval > 0.0 ? interval : NAN)},
                       {"start_s", number(channel.size() > 0 ? channel.clock.time(0) : NAN)},
                       {"uniform", channel.clock.uniform()},
                       {"first", number(s.first)},
                       {"last", number(s.last)},
                       {"min", number(s.min)},
                       {"max", number(s.max)},
                       {"mean", number(s.mean)},
                       {"rms", number(s.rms)},
                       {"sum", number(s.sum)},
                       {"sum_of_squares", number(s.sum_of_squares)},
                       {"invalid", s.invalid}};
  if (channel.complex()) {
    json["complex"] = true;
    json["sum_re"] = number(s.complex_sum.real());
    json["sum_im"] = number(s.complex_sum.imag());
    json["sum_abs2"] = number(s.sum_abs2);
  }
  if (!channel.attributes.empty()) json["attributes"] = channel.attributes;
  return json;
}

/// Impacts of every channel that could show one, each searched alone.
ordered_json impacts_json(const datasets::Record& record, std::vector<std::string>& warnings) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    const datasets::Channel& channel = record.channels[i];
    using enum datasets::Quantity;
    if (channel.quantity != force && channel.quantity != acceleration) continue;
    if (channel.complex() || !channel.clock.uniform() || !(channel.clock.interval > 0.0)) continue;
    acquisition::DetectionOptions options;
    options.trigger_channel = std::to_string(i);
    try {
      for (const datasets::Impact& impact : acquisition::find_impacts(record, options)) {
        ordered_json flags = ordered_json::array();
        for (const datasets::ImpactFlag flag : impact.flags) flags.push_back(datasets::name(flag));
        const std::string unit(datasets::si_unit(channel.quantity));
        list.push_back({{"channel", channel.name},
                        {"unit", unit},
                        {"start_s", number(impact.start)},
                        {"end_s", number(impact.end)},
                        {"peak", number(impact.peak)},
                        {"peak_time_s", number(impact.peak_time)},
                        {"width_s", number(impact.width)},
                        {"impulse", number(impact.impulse)},
                        {"impulse_unit", channel.quantity == force ? "N s" : "m/s"},
                        {"flags", flags}});
      }
    } catch (const datasets::InputError& error) {
      warnings.push_back(
          fmt::format("impacts of '{}' were not looked for: {}", channel.name, error.problem()));
    }
  }
  return list;
}

void print_text(const ordered_json& json) {
  fmt::print("{}: {}\n\n", json["file"].get<std::string>(), json["format"].get<std::string>());
  if (json["channels"].empty()) fmt::print("no channels\n");
  std::size_t widest = 7;
  for (const auto& c : json["channels"])
    widest = std::max(widest, c["name"].get<std::string>().size());
  const auto value = [](const ordered_json& v) {
    return v.is_null() ? std::string("-") : fmt::format("{:.6g}", v.get<double>());
  };
  if (!json["channels"].empty())
    fmt::print("  #  {:<{}}  {:<13}{:<8}{:>10}  {:>12}  {:>12}  {:>12}  {:>12}  {:>12}\n",
               "channel", widest, "quantity", "unit", "samples", "rate [Hz]", "start [s]", "min",
               "max", "rms");
  int index = 0;
  for (const auto& c : json["channels"])
    fmt::print("{:>3}  {:<{}}  {:<13}{:<8}{:>10}  {:>12}  {:>12}  {:>12}  {:>12}  {:>12}\n",
               index++, c["name"].get<std::string>(), widest, c["quantity"].get<std::string>(),
               c["unit"].get<std::string>(), c["samples"].get<std::size_t>(),
               value(c["sample_rate_hz"]), value(c["start_s"]), value(c["min"]), value(c["max"]),
               value(c["rms"]));
  if (json.contains("attributes")) {
    fmt::print("\nas read:");
    for (const auto& [key, text] : json["attributes"].items())
      fmt::print("  {} = {}", key, text.get<std::string>());
    fmt::print("\n");
  }
  if (!json["impacts"].empty()) fmt::print("\nimpacts:\n");
  for (const auto& i : json["impacts"])
    fmt::print("  {}: at {} s, peak {} {}, width {} s, impulse {} {}{}\n",
               i["channel"].get<std::string>(), value(i["start_s"]), value(i["peak"]),
               i["unit"].get<std::string>(), value(i["width_s"]), value(i["impulse"]),
               i["impulse_unit"].get<std::string>(),
               i["flags"].empty() ? "" : fmt::format(" ({})", i["flags"].dump()));
  for (const auto& warning : json["warnings"])
    fmt::print("\nwarning: {}\n", warning.get<std::string>());
}

void inspect(const Options& options) {
  acquisition::ImportOptions reading = import_options(options.reading);
  reading.require_clock = false;
  const datasets::Record record = acquisition::import_recording(options.file, reading);
  std::vector<std::string> warnings = record.warnings;
  ordered_json json = {{"schema", "impactrig/inspect/1"},
                       {"file", options.file},
                       {"format", record.provenance.importer},
                       {"bytes", record.provenance.bytes},
                       {"sha256", record.provenance.sha256}};
  if (!record.started.empty()) json["started"] = record.started;
  json["channels"] = ordered_json::array();
  for (const datasets::Channel& channel : record.channels)
    json["channels"].push_back(channel_json(channel));
  if (!record.attributes.empty()) json["attributes"] = record.attributes;
  json["impacts"] = impacts_json(record, warnings);
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
  add_import_arguments(*command, options->reading);
  add_json(*command, options->common);
  command->callback([options] { inspect(*options); });
}

}  // namespace impactrig::app
