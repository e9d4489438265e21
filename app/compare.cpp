// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/pair_histories.hpp"
#include "acquisition/importer.hpp"
#include "app/comparison_texts.hpp"
#include "app/conditioning_limit.hpp"
#include "app/import_options.hpp"
#include "app/program.hpp"
#include "app/quantity_option.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"
#include "fitting/metrics/area_metric.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::app {
namespace {

using datasets::InputError;

struct Options {
  std::string measured, predicted;
  std::vector<std::string> repeats;
  std::string channel, predicted_channel, rig;
  ImportArguments reading;
  std::string predicted_units;
  double predicted_rate = 0.0;
  double shift = 0.0;
  std::vector<std::string> u_num, u_input, u_data;
  double coverage_factor = 2.0;
  CommonOptions common;
};

/// A channel that was read, and the recording it comes from.
struct Side {
  datasets::Record record;

  const datasets::Channel& channel() const { return record.channels.front(); }

  const std::string& file() const { return record.provenance.source_file; }

  acquisition::NamedChannel named() const { return {channel(), file()}; }

  ComparedFile told() const {
    return {file(), record.provenance.importer, channel().name, channel().unit,
            record.provenance.sha256};
  }
};

/// What is asked for by name: of a file with a single channel that one, whatever its name.
struct Wanted {
  std::string channel;
  std::string option;   ///< that names one
  bool strict = false;  ///< the name is meant for this file alone
};

std::string names_of(const datasets::Record& record) {
  std::string names;
  for (const datasets::Channel& channel : record.channels)
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", channel.name);
  return names;
}

/// The channel that is wanted of those a recording has. `hit` becomes true when its name was found.
std::size_t chosen_channel(const datasets::Record& record, const std::string& path,
                           const Wanted& wanted, bool& hit) {
  if (record.channels.empty())
    throw InputError({.file = path}, "has no channels; `impactrig inspect` shows what it holds");
  const datasets::Channel* const named =
      wanted.channel.empty() ? nullptr : record.find(wanted.channel);
  hit = hit || named != nullptr;
  if (named != nullptr) return static_cast<std::size_t>(named - record.channels.data());
  if (!wanted.channel.empty() && (wanted.strict || record.channels.size() > 1))
    throw InputError({.file = path}, fmt::format("there is no channel '{}'; the channels are {}",
                                                 wanted.channel, names_of(record)));
  if (record.channels.size() > 1)
    throw InputError({.file = path},
                     fmt::format("has {} channels ({}); choose one with {}", record.channels.size(),
                                 names_of(record), wanted.option));
  return 0;
}

/// Reads one channel.
Side read_side(const std::string& path, const acquisition::ImportOptions& reading,
               const Wanted& wanted, bool& hit) {
  const auto reader = acquisition::open_recording(path, reading);
  acquisition::Selection selection = acquisition::selection_of(reader->head(), reading);
  selection.channels = {chosen_channel(reader->head().record, path, wanted, hit)};
  Side side{acquisition::read_into_memory(*reader, selection)};
  side.record.provenance.sha256 = acquisition::sha256_of_recording(path);
  return side;
}

/// The window of recorded times that holds one of conditioned times, of which delays are taken off.
acquisition::ImportOptions recorded_window(
    acquisition::ImportOptions reading,
    std::initializer_list<const std::optional<datasets::Sensor>*> sensors) {
  double earliest = 0.0, latest = 0.0;
  for (const auto* const sensor : sensors)
    if (*sensor) {
      earliest = std::min(earliest, (*sensor)->delay.value);
      latest = std::max(latest, (*sensor)->delay.value);
    }
  reading.from += earliest;
  reading.to += latest;
  return reading;
}

bool has_uneven_times(const datasets::Record& record) {
  return std::ranges::any_of(record.channels, [](const datasets::Channel& channel) {
    return !channel.clock.times.empty();
  });
}

/// Reads one channel and makes it what the sensors saw: in SI, by sensitivity, polarity and delay.
Side read_conditioned(const std::string& path, acquisition::ImportOptions reading,
                      const fitting::RigFile& rig, const Wanted& wanted, bool& hit) {
  // a window is one of the conditioned times
  const acquisition::ImportOptions window =
      recorded_window(reading, {&rig.force, &rig.velocity, &rig.displacement});
  reading.from = ImportArguments{}.from;
  reading.to = ImportArguments{}.to;
  const auto reader = acquisition::open_recording(path, reading);
  const acquisition::Selection all = acquisition::selection_of(reader->head(), reading);
  refuse_too_many_to_condition(path, samples_of(reader->head(), all),
                               "`impactrig import` with --from and --to makes a file of a part");
  datasets::Record recorded = acquisition::read_into_memory(*reader, all);
  if (has_uneven_times(recorded))  // what lies within the window may be even
    recorded =
        acquisition::read_into_memory(*reader, acquisition::selection_of(reader->head(), window));
  recorded.provenance.sha256 = acquisition::sha256_of_recording(path);
  datasets::Record record =
      acquisition::condition(recorded, {rig.force, rig.velocity, rig.displacement});
  datasets::Channel channel = std::move(record.channels[chosen_channel(record, path, wanted, hit)]);
  record.channels.assign(1, std::move(channel));
  return {std::move(record)};
}

/// Both sides' reading options: what is stated for the predicted file replaces what is stated for
/// both.
acquisition::ImportOptions predicted_reading(const Options& options) {
  ImportArguments arguments = options.reading;
  if (!options.predicted_units.empty()) arguments.units = options.predicted_units;
  if (options.predicted_rate > 0.0) arguments.sample_rate = options.predicted_rate;
  arguments.from = ImportArguments{}.from;
  arguments.to = ImportArguments{}.to;
  return import_options(arguments);
}

struct Sides {
  Side measured, predicted;
  std::vector<Side> repeats;
};

/// Throws where one shot is named twice: the scatter between copies says nothing.
void refuse_copies(const Sides& sides) {
  std::vector<const Side*> shots = {&sides.measured};
  for (const Side& repeat : sides.repeats) {
    for (const Side* const other : shots)
      if (other->record.provenance.sha256 == repeat.record.provenance.sha256)
        throw InputError({.file = repeat.file()},
                         fmt::format("is the same recording as {}; name each once", other->file()));
    shots.push_back(&repeat);
  }
}

Sides read_sides(const Options& options) {
  const acquisition::ImportOptions reading = import_options(options.reading);
  const Wanted wanted{options.channel, "--channel"};
  const bool own = !options.predicted_channel.empty();
  const Wanted of_predicted{own ? options.predicted_channel : options.channel,
                            own || !options.channel.empty() ? "--predicted-channel" : "--channel",
                            own};
  bool hit = false, predicted_hit = false;
  std::optional<fitting::RigFile> rig;
  if (!options.rig.empty()) rig = fitting::read_rig_file(options.rig, {});
  const auto read_measured = [&](const std::string& path) {
    return rig ? read_conditioned(path, reading, *rig, wanted, hit)
               : read_side(path, reading, wanted, hit);
  };
  Sides sides;
  sides.measured = read_measured(options.measured);
  sides.predicted = read_side(options.predicted, predicted_reading(options), of_predicted,
                              own ? predicted_hit : hit);
  for (const std::string& path : options.repeats) sides.repeats.push_back(read_measured(path));
  if (!options.channel.empty() && !hit)
    throw InputError({.file = options.measured},
                     fmt::format("there is no channel '{}', neither here ('{}') nor in {} ('{}')",
                                 options.channel, sides.measured.channel().name, options.predicted,
                                 sides.predicted.channel().name));
  refuse_copies(sides);
  return sides;
}

/// The unit of what is summed up over time: "N s", of velocities "m"; "" where none is stated.
std::string integral_unit(const std::string& unit) {
  if (unit.empty()) return "";
  if (unit == "1") return "s";
  if (unit.ends_with("/s")) return unit.substr(0, unit.size() - 2);
  if (unit.ends_with("/s^2")) return unit.substr(0, unit.size() - 2);
  return unit + " s";
}

/// One of the scalars: its names and its place in HistoryScalars.
struct ScalarKind {
  const char* key;
  const char* title;
  double fitting::HistoryScalars::*value;
};

constexpr ScalarKind scalar_kinds[] = {
    {"peak", "Peak", &fitting::HistoryScalars::peak},                    //
    {"peak_time", "Time of peak", &fitting::HistoryScalars::peak_time},  //
    {"impulse", "Impulse", &fitting::HistoryScalars::impulse},           //
    {"duration", "Duration", &fitting::HistoryScalars::duration},        //
};

std::string scalar_unit(const ScalarKind& kind, const std::string& unit) {
  const std::string key = kind.key;
  return key == "peak" ? unit : key == "impulse" ? integral_unit(unit) : "s";
}

/// What was stated of one scalar's uncertainty, by "peak=60 N" or "peak=2 %".
class StatedUncertainties {
 public:
  StatedUncertainties(const std::string& option, const std::vector<std::string>& list)
      : option_(option) {
    for (const std::string& text : list) {
      const std::size_t equals = text.find('=');
      const std::string key = text.substr(0, equals);
      const auto same = [&](const ScalarKind& kind) { return key == kind.key; };
      if (equals == std::string::npos || std::ranges::none_of(scalar_kinds, same))
        throw CLI::ValidationError(
            option, fmt::format("expected peak, peak_time, impulse or duration and its standard "
                                "uncertainty, for example peak=\"60 N\" or peak=\"2 %\", found {}",
                                text));
      stated_[key] = text.substr(equals + 1);
    }
  }

  /// In the scalar's unit; a percentage is of `whole`. 0 where none is stated.
  double of(const ComparedScalar& scalar, double whole) const {
    const auto found = stated_.find(scalar.key);
    if (found == stated_.end()) return 0.0;
    const std::string& text = found->second;
    double value = 0.0;
    try {
      value = text.ends_with('%')
                  ? std::abs(whole) * datasets::parse_quantity(text, "1").value
                  : datasets::parse_quantity(text, scalar.unit.empty() ? "1" : scalar.unit).value;
    } catch (const std::invalid_argument& error) {
      throw CLI::ValidationError(option_, fmt::format("{}: {}", scalar.key, error.what()));
    }
    if (!(value >= 0.0))
      throw CLI::ValidationError(
          option_, fmt::format("{}: an uncertainty is not negative, found {}", scalar.key, text));
    return value;
  }

  bool mentions(const std::string& key) const { return stated_.contains(key); }

 private:
  std::string option_;
  std::map<std::string, std::string> stated_;
};

/// Adds what the repeats say: values of all shots, their area metric, the scatter of their mean.
void add_shots(ComparedScalar& scalar, std::vector<double> shots) {
  if (!std::ranges::all_of(shots, [](double x) { return std::isfinite(x); })) return;
  const double n = static_cast<double>(shots.size());
  const double mean = std::accumulate(shots.begin(), shots.end(), 0.0) / n;
  double squares = 0.0;
  for (const double shot : shots) squares += (shot - mean) * (shot - mean);
  scalar.measured = mean;
  scalar.uncertainty.data = std::sqrt(squares / (n - 1.0) / n);
  scalar.has_uncertainty = true;
  if (std::isfinite(scalar.predicted))
    scalar.area = fitting::area_metric(std::vector{scalar.predicted}, shots);
  scalar.shots = std::move(shots);
}

void add_scalars(const Options& options, const std::vector<fitting::HistoryScalars>& repeats,
                 ComparisonResult& result) {
  const StatedUncertainties num("--u-num", options.u_num), input("--u-input", options.u_input),
      data("--u-data", options.u_data);
  for (const ScalarKind& kind : scalar_kinds) {
    ComparedScalar scalar;
    scalar.key = kind.key;
    scalar.title = kind.title;
    if (scalar.key == "impulse" && result.pair.unit != "N") scalar.title = "Integral";
    scalar.unit = scalar_unit(kind, result.pair.unit);
    scalar.measured = result.metrics.measured.*kind.value;
    scalar.predicted = result.metrics.computed.*kind.value;
    if (!repeats.empty()) {
      std::vector<double> shots = {scalar.measured};
      for (const fitting::HistoryScalars& repeat : repeats) shots.push_back(repeat.*kind.value);
      add_shots(scalar, std::move(shots));
    }
    scalar.uncertainty.numerical = num.of(scalar, scalar.predicted);
    scalar.uncertainty.input = input.of(scalar, scalar.predicted);
    scalar.uncertainty.data = std::hypot(scalar.uncertainty.data, data.of(scalar, scalar.measured));
    for (const StatedUncertainties* stated : {&num, &input, &data})
      scalar.has_uncertainty = scalar.has_uncertainty || stated->mentions(scalar.key);
    scalar.has_uncertainty = scalar.has_uncertainty && std::isfinite(scalar.error());
    if (scalar.has_uncertainty)
      scalar.validation = fitting::comparison_error(scalar.predicted, scalar.measured,
                                                    scalar.uncertainty, options.coverage_factor);
    result.scalars.push_back(std::move(scalar));
  }
}

/// Further shots on the instants of the first.
std::vector<std::vector<double>> repeats_on(const Sides& sides, ComparisonResult& result) {
  std::vector<std::vector<double>> shots;
  for (const Side& repeat : sides.repeats) {
    // half a step of slack, so that rounding loses no instant
    const acquisition::PairingOptions window = {
        .from = result.pair.start - 0.5 * result.pair.interval,
        .to = result.pair.end() + 0.5 * result.pair.interval};
    acquisition::PairedHistories pair =
        acquisition::pair_histories(sides.measured.named(), repeat.named(), window);
    if (pair.measured.size() != result.pair.measured.size())
      throw InputError(
          {.file = repeat.file()},
          fmt::format("covers {:.6g} s to {:.6g} s of the {:.6g} s to {:.6g} s that the others "
                      "share; choose a window in all of them with --from and --to",
                      pair.start, pair.end(), result.pair.start, result.pair.end()));
    for (std::string& note : pair.notes)
      if (std::ranges::find(result.warnings, note) == result.warnings.end())
        result.warnings.push_back(std::move(note));
    result.repeats.push_back(repeat.told());
    shots.push_back(std::move(pair.predicted));
  }
  return shots;
}

void compare_repeats(const Options& options, const std::vector<std::vector<double>>& repeats,
                     ComparisonResult& result) {
  std::vector<std::vector<double>> shots = repeats;
  shots.push_back(result.pair.measured);
  const fitting::ShotScatter scatter = fitting::shot_scatter(shots);
  result.scatter.chi2_per_sample =
      fitting::chi2_per_sample(result.pair.predicted, scatter, shots.size());
  std::vector<double> half_width = scatter.deviation;
  for (double& width : half_width) width *= options.coverage_factor;
  result.scatter.coverage = fitting::band_coverage(result.pair.predicted, scatter.mean, half_width);
}

void warn_of_side(const Side& side, const char* word, ComparisonResult& result) {
  for (const std::string& warning : side.record.warnings)
    result.warnings.push_back(fmt::format("{}: {}", side.file(), warning));
  const auto& delay = side.channel().delay;
  if (delay && !delay->removed && delay->value != 0.0)
    result.warnings.push_back(fmt::format(
        "{}: the {} channel shows events {:.6g} s late and that was not taken off; --shift does",
        side.file(), word, delay->value));
}

void warn_of_numbers(ComparisonResult& result) {
  const auto constant = [](const std::vector<double>& x) {
    return std::ranges::all_of(x, [&](double value) { return value == x.front(); });
  };
  if (constant(result.pair.measured))
    result.warnings.push_back(
        "the measured history is constant: correlation, R^2 and the NRMSE of the range are not "
        "defined");
  else if (constant(result.pair.predicted))
    result.warnings.push_back("the predicted history is constant: its correlation is not defined");
  if (!result.metrics.iso18571)
    result.warnings.push_back(fmt::format(
        "ISO/TS 18571 and CORA were left out: they compare each of {} samples with thousands of "
        "others and are computed up to {} samples; --from and --to choose a window",
        result.metrics.samples, fitting::most_rated));
}

ComparisonResult compare_sides(const Options& options, const Sides& sides) {
  ComparisonResult result;
  result.measured = sides.measured.told();
  result.predicted = sides.predicted.told();
  result.shift = options.shift;
  result.coverage_factor = options.coverage_factor;
  warn_of_side(sides.measured, "measured", result);
  warn_of_side(sides.predicted, "predicted", result);
  for (const Side& repeat : sides.repeats) warn_of_side(repeat, "measured", result);
  result.pair = acquisition::pair_histories(
      sides.measured.named(), sides.predicted.named(),
      {.shift = options.shift, .from = options.reading.from, .to = options.reading.to});
  result.warnings.insert(result.warnings.end(), result.pair.notes.begin(), result.pair.notes.end());
  const fitting::HistoryPair pair{result.pair.measured, result.pair.predicted};
  if (fitting::peak_of(pair.measured) == 0.0)
    throw InputError({.file = sides.measured.file()},
                     fmt::format("channel '{}' is zero throughout from {:.6g} s to {:.6g} s, and "
                                 "nothing can be told in parts of it; choose another window or "
                                 "channel",
                                 result.measured.channel, result.pair.start, result.pair.end()));
  result.metrics = fitting::compare_histories(pair, result.pair.start, result.pair.interval);
  result.impulse_ratio = fitting::impulse_ratio(pair);
  const std::vector<std::vector<double>> repeats = repeats_on(sides, result);
  std::vector<fitting::HistoryScalars> scalars;
  for (const std::vector<double>& repeat : repeats)
    scalars.push_back(fitting::history_scalars(repeat, result.pair.start, result.pair.interval));
  if (!repeats.empty()) compare_repeats(options, repeats, result);
  add_scalars(options, scalars, result);
  warn_of_numbers(result);
  return result;
}

void compare(const Options& options) {
  if (!std::isfinite(options.shift))
    throw CLI::ValidationError("--shift", "expected a time in seconds");
  if (!(options.coverage_factor > 0.0) || !std::isfinite(options.coverage_factor))
    throw CLI::ValidationError("--coverage-factor", "must be greater than zero");
  const ComparisonResult result = compare_sides(options, read_sides(options));
  if (!options.common.quiet)
    for (const std::string& warning : result.warnings) fmt::print(stderr, "warning: {}\n", warning);
  if (options.common.json)
    fmt::print("{}\n", to_json(result).dump(2, ' ', false,
                                            nlohmann::ordered_json::error_handler_t::replace));
  else
    fmt::print("{}", to_text(result));
}

void add_validation_arguments(CLI::App& command, Options& options) {
  const char* group = "Uncertainties of peak, peak_time, impulse, duration (ASME V&V 20)";
  const auto add = [&](const char* name, std::vector<std::string>& list, const char* help) {
    command.add_option(name, list, help)->allow_extra_args(false)->group(group);
  };
  add("--u-num", options.u_num, "Of the prediction's numbers: peak=\"20 N\", peak=\"0.5 %\"");
  add("--u-input", options.u_input, "Of the prediction by what was put into it");
  add("--u-data", options.u_data, "Of the measurement, besides the scatter of --repeat");
  command
      .add_option("--coverage-factor", options.coverage_factor,
                  "k of intervals (E +- k u) and bands (mean +- k s)")
      ->capture_default_str()
      ->group(group);
}

}  // namespace

void add_compare(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "compare", "Validation metrics of two histories: how far a prediction is from a measurement");
  command->footer(
      "Examples:\n"
      "  impactrig simulate rig.toml -o history.h5\n"
      "  impactrig compare shot.uff history.h5 --rig rig.toml --channel Force --from 0 --to "
      "400e-6\n"
      "  impactrig compare shot.csv history.csv --channel Force --shift 1.5e-6 --json\n"
      "  impactrig compare shot1.h5 history.h5 --channel Force --repeat shot2.h5 --repeat shot3.h5 "
      "--u-num peak=\"5 N\"\n"
      "Formulas and how to choose: docs/metrics.md");
  command->add_option("measured", options->measured, "Recording of any format")->required();
  command
      ->add_option("predicted", options->predicted,
                   "Prediction: a history of `simulate -o`, or any recording")
      ->required();
  command->add_option("--channel", options->channel,
                      "Channel, by name or index from 0, where a file has several");
  command->add_option("--predicted-channel", options->predicted_channel,
                      "Channel of the prediction, where its name is another");
  command->add_option("--rig", options->rig,
                      "Rig file (TOML): sensitivities, polarities and delays of the measurements");
  command->add_option("--from", options->reading.from, "First time compared [s, or as \"5 ms\"]")
      ->transform(with_unit("s"));
  command->add_option("--to", options->reading.to, "Last time compared [s]")
      ->transform(with_unit("s"));
  command->add_option("--shift", options->shift, "Move the prediction later by so much [s]")
      ->transform(with_unit("s"));
  command
      ->add_option("--repeat", options->repeats,
                   "A further shot of the same condition: scatter, area metric; repeatable")
      ->allow_extra_args(false);
  add_validation_arguments(*command, *options);
  add_import_arguments(*command, options->reading);
  command
      ->add_option("--predicted-units", options->predicted_units,
                   "As --units, for the prediction alone")
      ->group("How to read recordings (detected unless stated)");
  command
      ->add_option("--predicted-sample-rate", options->predicted_rate,
                   "As --sample-rate, for the prediction alone [Hz]")
      ->transform(with_unit("Hz"))
      ->check(positive)
      ->group("How to read recordings (detected unless stated)");
  add_json(*command, options->common);
  add_quiet(*command, options->common);
  command->callback([options] { compare(*options); });
}

}  // namespace impactrig::app
