// SPDX-License-Identifier: BSD-3-Clause
#include "app/fit_job.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/needed_channels.hpp"
#include "acquisition/conditioning/steps.hpp"
#include "acquisition/importer.hpp"
#include "app/conditioning_limit.hpp"
#include "app/quantity_option.hpp"
#include "datasets/input_error.hpp"
#include "datasets/sample_filter.hpp"
#include "fitting/fit.hpp"
#include "fitting/fit_keys.hpp"
#include "fitting/mesh_choice.hpp"
#include "fitting/other_model.hpp"
#include "fitting/parameters.hpp"
#include "fitting/plausibility.hpp"
#include "fitting/rig_file.hpp"
#include "fitting/velocity_timing.hpp"

namespace impactrig::app {
namespace {

std::string host_name() {
  char name[256] = "";
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// Whether a recording without force is refused: not where the rig file describes what was measured
/// instead and nobody asks for a force.
bool needs_force(const fitting::RigFile& rig, const fitting::FitOptions& options) {
  const bool others = rig.velocity || rig.displacement;
  return options.use_force && (options.channels_stated || rig.force || !others);
}

/// The impact that is asked for; others of the recording are left alone, and a warning says so.
datasets::Impact chosen_impact(const datasets::Record& record, const FitJob& job, bool with_force,
                               std::vector<std::string>& warnings) {
  const std::vector<datasets::Impact> impacts =
      acquisition::find_impacts(record, detection_options(job.detection));
  const std::string& file = record.provenance.source_file;
  if (impacts.empty())
    throw datasets::InputError({.file = file},
                               "there is no impact in this recording: nothing rises clearly above "
                               "the noise. Check that the right channels are named in the rig "
                               "file's [sensors] and that the trigger fired; `impactrig inspect` "
                               "shows what is in the file");
  if (impacts.size() < static_cast<std::size_t>(job.impact))
    throw datasets::InputError(
        {.file = file}, fmt::format("holds {} impact{}, so there is no number {}", impacts.size(),
                                    impacts.size() == 1 ? "" : "s", job.impact));
  datasets::Impact impact = impacts[static_cast<std::size_t>(job.impact) - 1];
  if (!impact.force && with_force)
    throw datasets::InputError({.file = file},
                               "has no force channel; name it with sensors.force.channel (and "
                               "sensitivity, if it is in volts) in the "
                               "rig file, or fit what there is with --channels velocity or "
                               "--channels displacement");
  if (impact.has(datasets::ImpactFlag::swapped))
    throw datasets::InputError({.file = file},
                               std::string(sentence(datasets::ImpactFlag::swapped)));
  if (impact.force && impact.peak < 0.0)
    throw datasets::InputError(
        {.file = file},
        fmt::format("the force is negative in the impact ({:.4g} N); if the sensor inverts, "
                    "state sensors.force.polarity = -1",
                    impact.peak));
  if ((impact.velocity || impact.rebound) && impact.approach_velocity < 0.0)
    throw datasets::InputError(
        {.file = file},
        fmt::format("the bar moves away from the stop before the impact ({:.4g} m/s); if the "
                    "laser looks from the other side, state sensors.{}.polarity = -1",
                    impact.approach_velocity, impact.rebound ? "displacement" : "velocity"));
  if (impacts.size() > 1)
    warnings.push_back(fmt::format(
        "{} holds {} impacts; number {}, at {:.6g} s, was fitted.{}", file, impacts.size(),
        job.impact, impact.start,
        job.impact > 1
            ? " The model begins with a bar that swings without vibrating: what the impact before "
              "left of that is not in it."
            : ""));
  impact.recording = std::filesystem::path(file).filename().string();
  return impact;
}

/// Flags an impact whose impulse does not fit the rig, and says so at once: a fit to wrong units
/// takes long and comes to nothing, and one to times in another unit does not end.
void check_momentum(const std::string& path, const fitting::RigFile& rig, datasets::Impact& impact,
                    bool quiet, std::vector<std::string>& warnings) {
  const auto balance = fitting::momentum_balance(impact, rig);
  if (!balance || balance->plausible) return;
  if (balance->times)
    throw datasets::InputError(
        {.file = path},
        balance->sentence + " State the unit of the times with --units, or --sample-rate.");
  impact.flags.push_back(datasets::ImpactFlag::implausible);
  warnings.push_back(fmt::format("{}: {}", impact.recording, balance->sentence));
  if (!quiet) fmt::print(stderr, "warning: {}\n", warnings.back());
}

/// Says at once where the channels seem to be of different times.
void check_times(const fitting::RigFile& rig, const datasets::Impact& impact, bool quiet,
                 std::vector<std::string>& warnings) {
  const std::string timing = fitting::velocity_out_of_time(impact, rig);
  if (timing.empty()) return;
  warnings.push_back(fmt::format("{}: {}", impact.recording, timing));
  if (!quiet) fmt::print(stderr, "warning: {}\n", warnings.back());
}

/// Nothing is guessed: of two channels of a kind the rig file names one.
void refuse_choice(const datasets::Record& record, const fitting::RigFile& rig) {
  std::string names;
  int count = 0;
  for (const datasets::Channel& channel : record.channels) {
    if (channel.quantity != datasets::Quantity::force) continue;
    names += fmt::format("{}'{}'", count++ > 0 ? ", " : "", channel.name);
  }
  if (count > 1 && !rig.force)
    throw datasets::InputError(
        {.file = record.provenance.source_file},
        fmt::format(
            "has {} force channels ({}); name one with sensors.force.channel in the rig file",
            count, names));
}

/// Where the record does not tell what its samples have been through, the prediction cannot go the
/// same way.
void warn_of_unknown_filters(datasets::Record& record) {
  for (const datasets::Channel& channel : record.channels)
    if (!datasets::filters_of(record, channel))
      record.warnings.push_back(fmt::format(
          "channel '{}' was put on even times, which ties its samples in ways that a "
          "prediction cannot follow: the intervals of the fit may be too narrow. Record "
          "at even times, or state the sample rate (--sample-rate) where they are meant "
          "to be even",
          channel.name));
}

/// A sensor whose channel is neither fitted nor there is left out; returns what to say of it.
std::vector<std::string> leave_out_absent(const datasets::Record& record,
                                          const fitting::FitOptions& options,
                                          acquisition::SensorSet& sensors) {
  std::vector<std::string> warnings;
  const auto leave_out = [&](auto& sensor, const char* key, bool fitted) {
    const bool named = sensor && !sensor->channel.empty();
    if (!named || fitted || record.find(sensor->channel) != nullptr) return;
    warnings.push_back(
        fmt::format("there is no single channel '{}', which sensors.{}.channel names: it is not "
                    "fitted, and nothing is read from it",
                    sensor->channel, key));
    sensor.reset();
  };
  leave_out(sensors.force, "force", options.use_force);
  leave_out(sensors.velocity, "velocity", options.use_velocity);
  leave_out(sensors.displacement, "displacement", options.use_displacement);
  return warnings;
}

/// In SI, conditioned as the rig file asks; only the channels that its sensors name are read.
datasets::Record conditioned_recording(const std::string& path, const FitJob& job,
                                       const fitting::RigFile& rig,
                                       const fitting::FitOptions& options) {
  const acquisition::ImportOptions reading = import_options(job.reading);
  const auto reader = acquisition::open_recording(path, reading);
  acquisition::SensorSet sensors{rig.force, rig.velocity, rig.displacement};
  const std::vector<std::string> absent = leave_out_absent(reader->head().record, options, sensors);
  acquisition::Selection wanted = acquisition::selection_of(reader->head(), reading);
  acquisition::narrow_to_sensors(reader->head(), wanted, sensors);
  refuse_too_many_to_condition(path, samples_of(reader->head(), wanted),
                               "--from and --to say which, and the rig file's sensors name the "
                               "channels");
  datasets::Record recorded = acquisition::read_into_memory(*reader, wanted);
  recorded.provenance.sha256 = acquisition::sha256_of_recording(path);
  datasets::Record record = acquisition::condition(recorded, sensors);
  acquisition::apply_steps(rig.conditioning, record, sensors, detection_options(job.detection));
  record.warnings.insert(record.warnings.end(), absent.begin(), absent.end());
  warn_of_unknown_filters(record);
  return record;
}

/// The name before the =, without blanks around it.
std::string name_in(const std::string& text) {
  const std::vector<std::string> names = split_names(text.substr(0, text.find('=')));
  return names.empty() ? std::string() : names.front();
}

void refuse_twice(const char* option, const std::vector<std::string>& texts) {
  std::set<std::string> seen;
  for (const std::string& text : texts)
    if (!seen.insert(name_in(text)).second)
      throw CLI::ValidationError(option, fmt::format("'{}' is named twice", name_in(text)));
}

/// Throws CLI::ValidationError for options that say nothing beside the others, or contradict them.
void refuse_idle(const FitJob& job, const fitting::FitOptions& options) {
  if (options.bootstrap == 0 && (!job.bootstrap_kind.empty() || job.seed))
    throw CLI::ValidationError(job.seed ? "--seed" : "--bootstrap-kind",
                               "there is no bootstrap it is of; --bootstrap N asks for one");
  if (!job.against.empty() && options.loss != fitting::Loss::squares)
    throw CLI::ValidationError(
        "--against", fmt::format("models are compared by their likelihood, which goes with the "
                                 "loss squares, not with {} (--loss squares)",
                                 fitting::name(options.loss)));
  refuse_twice("--prior", job.priors);
  refuse_twice("--bounds", job.bounds);
  refuse_twice("--tie", job.ties);
  const std::vector<std::string> fixed = split_names(job.fix);
  const auto refuse_of_fixed = [&](const char* option, const std::vector<std::string>& texts) {
    for (const std::string& text : texts)
      if (std::ranges::find(fixed, name_in(text)) != fixed.end())
        throw CLI::ValidationError(option,
                                   fmt::format("'{}' is not fitted, by --fix", name_in(text)));
  };
  refuse_of_fixed("--free", split_names(job.free));
  refuse_of_fixed("--prior", job.priors);
  refuse_of_fixed("--bounds", job.bounds);
  refuse_of_fixed("--tie", job.ties);
  refuse_of_fixed("--log", split_names(job.log));
}

/// The rig file's [fit], and on top of it what the command line states.
fitting::FitOptions fit_options(const FitJob& job, const fitting::RigFile& rig) {
  fitting::FitOptions options = rig.fit;
  const auto each = [](const char* option, const std::vector<std::string>& texts, auto&& read) {
    for (const std::string& text : texts) try {
        read(text);
      } catch (const std::invalid_argument& error) {
        throw CLI::ValidationError(option, error.what());
      }
  };
  if (!job.free.empty()) options.free = split_names(job.free);
  if (job.window > 0.0) options.window = job.window;
  if (!job.loss.empty()) options.loss = fitting::loss_named(job.loss);
  if (job.profile) options.profile = true;
  if (job.bootstrap > 0) options.bootstrap = job.bootstrap;
  if (!job.bootstrap_kind.empty())
    options.bootstrap_kind = fitting::bootstrap_named(job.bootstrap_kind);
  if (job.seed) options.seed = *job.seed;
  each("--fix", split_names(job.fix), [&](const std::string& name) {
    fitting::unit_of(name);
    options.setting(name).fixed = true;
  });
  each("--shared", split_names(job.shared),
       [&](const std::string& name) { fitting::choose_shared(name, true, options); });
  const std::vector<std::string> shared = split_names(job.shared);
  each("--own", split_names(job.own), [&](const std::string& name) {
    if (std::ranges::find(shared, name) != shared.end())
      throw std::invalid_argument(fmt::format("'{}' is named by --shared too", name));
    fitting::choose_shared(name, false, options);
  });
  each("--log", split_names(job.log), [&](const std::string& name) {
    fitting::unit_of(name);
    options.setting(name).by_logarithm = true;
  });
  each("--prior", job.priors, [&](const std::string& text) { fitting::read_prior(text, options); });
  each("--bounds", job.bounds,
       [&](const std::string& text) { fitting::read_bounds(text, options); });
  each("--tie", job.ties, [&](const std::string& text) { fitting::read_tie(text, options); });
  if (!job.channels.empty())
    each("--channels", {job.channels},
         [&](const std::string& names) { fitting::choose_channels(split_names(names), options); });
  refuse_idle(job, options);
  return options;
}

/// The rig file's own model and those of --against.
std::vector<fitting::Candidate> candidates(const FitJob& job, const fitting::RigFile& own,
                                           const fitting::FitOptions& options) {
  std::vector<fitting::Alternatives> alternatives;
  for (const std::string& text : job.against) try {
      alternatives.push_back(fitting::read_alternatives(text));
    } catch (const std::invalid_argument& error) {
      throw CLI::ValidationError("--against", error.what());
    }
  std::vector<fitting::Candidate> result = {{"the rig file's own", own}};
  for (const auto& [label, changes] : fitting::combinations(alternatives)) {
    if (changes.empty()) continue;
    try {
      result.push_back(fitting::other_model(own, split_overrides(job.common.overrides), label,
                                            changes, options));
    } catch (const std::invalid_argument& error) {
      throw CLI::ValidationError("--against", error.what());
    }
  }
  return result;
}

/// Everything that decides the numbers, as text: what the result key is made of.
std::string result_text(const FitJob& job, const std::string& config_sha256,
                        const std::vector<std::string>& inputs_sha256) {
  const ImportArguments& r = job.reading;
  std::string text = fmt::format(
      "impactrig {} {}\nfree {}\nfix {}\nshared {}\nown {}\nlog {}\n"
      "prior {}\nbounds {}\ntie {}\nloss {}\nagainst {}\nprofile {}\n"
      "bootstrap {} {} {}\n"
      "channels {}\nwindow {}\nrig {}\nread {}|{}|{}|{}|{}|{}|{}|{}\n"
      "trigger {}|{}|{}|{}|{}\nfrom {} to {}\n",
      IMPACTRIG_VERSION, IMPACTRIG_COMMIT, job.free, job.fix, job.shared, job.own, job.log,
      fmt::join(job.priors, ";"), fmt::join(job.bounds, ";"), fmt::join(job.ties, ";"), job.loss,
      fmt::join(job.against, ";"), job.profile, job.bootstrap, job.bootstrap_kind,
      job.seed.value_or(1), job.channels, job.window, config_sha256, r.format, r.encoding,
      r.delimiter, r.decimal, r.time_column, r.units, r.skip_lines, r.sample_rate,
      job.detection.trigger, job.detection.threshold, job.detection.pre_trigger,
      job.detection.post_trigger, job.impact, r.from, r.to);
  for (const std::string& input : inputs_sha256) text += input + "\n";
  return text;
}

/// Program, command, rig and host; the rest is of the run.
reports::ResultProvenance origin(const fitting::RigFile& rig, std::time_t wall_clock) {
  reports::ResultProvenance out;
  out.tool = "impactrig";
  out.version = IMPACTRIG_VERSION;
  out.build = IMPACTRIG_BUILD;
  out.git = IMPACTRIG_COMMIT;
  out.command = command_line();
  out.config = rig.text;
  out.config_sha256 = rig.sha256;
  std::tm local{};
  localtime_r(&wall_clock, &local);
  out.started = fmt::format("{:%Y-%m-%dT%H:%M:%S%z}", local);
  out.host = host_name();
  return out;
}

/// Why a fit has no force.
std::string without_force(const std::string& path, const FitJob& job) {
  const auto reader = acquisition::open_recording(path, import_options(job.reading));
  const auto& channels = reader->head().record.channels;
  const auto force =
      std::ranges::find(channels, datasets::Quantity::force, &datasets::Channel::quantity);
  if (force != channels.end())
    return fmt::format(
        "{}: channel '{}' is a force, but the rig file describes other sensors and none of a "
        "force: the fit is without. Add [sensors.force] to use it.",
        path, force->name);
  return fmt::format(
      "{}: no channel is known to be a force, and the rig file names none "
      "(sensors.force.channel): the fit is without.",
      path);
}

}  // namespace

void add_fit_job(CLI::App& command, FitJob& job) {
  command.add_option("recording", job.recordings, "Recordings of any format (`impactrig formats`)")
      ->required();
  command.add_option("--rig", job.rig, "Rig file (TOML)")->required();
  command.add_option("--free", job.free,
                     "Parameters to fit, comma between; default "
                     "contact.restitution,contact.stiffness_factor,start.velocity");
  command.add_option("--fix", job.fix, "Parameters not to fit, comma between (sensors.force.gain)");
  command.add_option("--prior", job.priors,
                     "NAME=VALUE +- UNCERTAINTY, for example of a calibration");
  command.add_option("--bounds", job.bounds,
                     "NAME=LOW:HIGH, with units: start.velocity=0.43 m/s:0.45 m/s");
  command.add_option("--tie", job.ties, "NAME=FACTOR*OTHER: the one goes with the other");
  command.add_option("--shared", job.shared, "Parameters that all recordings share, comma between");
  command.add_option("--own", job.own, "Parameters of which each recording has its own");
  command.add_option("--log", job.log,
                     "Parameters searched by their logarithms, comma between: stay above zero");
  command.add_option("--loss", job.loss, "What a residual costs: squares, huber, cauchy, tukey")
      ->check(CLI::IsMember({"squares", "huber", "cauchy", "tukey"}));
  command.add_option("--against", job.against,
                     "KEY=VALUE,VALUE: compare models, all combinations of several of these "
                     "(contact.damping=viscous,hunt-crossley)");
  command.add_flag("--profile", job.profile,
                   "Profile likelihood of the impact's and the sensors' parameters");
  command.add_option("--bootstrap", job.bootstrap, "Refits of drawn data; 1000 for 95 %")
      ->check(CLI::Range(2, 1000000));
  command.add_option("--bootstrap-kind", job.bootstrap_kind, "parametric (default) or residual")
      ->check(CLI::IsMember({"parametric", "residual"}));
  command.add_option("--seed", job.seed, "Of the bootstrap; default 1");
  command.add_option("--channels", job.channels,
                     "Channels to fit, comma between; default force,velocity");
  command.add_option("--window", job.window, "Fit no more than this after first touch [s]")
      ->transform(with_unit("s"))
      ->check(positive);
  command.add_option("--title", job.title, "Title of the report");
  command
      .add_option("--impact", job.impact,
                  "Which impact of a recording to fit, from 1; default the first")
      ->check(positive);
  add_set(command, job.common);
  add_quiet(command, job.common);
  add_force(command, job.common);
  add_window_arguments(command, job.reading);
  add_import_arguments(command, job.reading);
  add_detection_arguments(command, job.detection);
}

std::vector<std::string> inputs_of(const FitJob& job) {
  std::vector<std::string> inputs = job.recordings;
  inputs.push_back(job.rig);
  return inputs;
}

std::string result_key(const FitJob& job, const std::string& config_sha256,
                       const std::vector<std::string>& inputs_sha256) {
  return datasets::sha256_of(result_text(job, config_sha256, inputs_sha256));
}

reports::ResultProvenance provenance_of(const FitJob& job) {
  const fitting::RigFile rig =
      fitting::read_rig_file(job.rig, split_overrides(job.common.overrides));
  candidates(
      job, rig,
      fit_options(job, rig));  // refuses what is badly written before the first recording is read
  return origin(rig, std::time(nullptr));
}

reports::ReportData run_fit_job(const FitJob& job) {
  const auto started = std::chrono::steady_clock::now();
  const std::time_t wall_clock = std::time(nullptr);
  fitting::RigFile rig = fitting::read_rig_file(job.rig, split_overrides(job.common.overrides));
  reports::ReportData data;
  data.provenance = origin(rig, wall_clock);
  const fitting::FitOptions options = fit_options(job, rig);
  std::string chosen;
  std::vector<fitting::Candidate> models;  // first, which refuses what is badly written
  if (!job.against.empty()) {
    chosen = fitting::choose_mesh(rig, fitting::finest_mesh_of_fits).sentence;
    models = candidates(job, rig, options);
  }
  std::vector<datasets::Impact> impacts;
  std::vector<std::string> hashes;
  std::vector<std::string> warnings = rig.remarks;
  for (const std::string& path : job.recordings) {
    if (!job.common.quiet) fmt::print(stderr, "reading {}\n", path);
    datasets::Record record = conditioned_recording(path, job, rig, options);
    for (const std::string& warning : record.warnings)
      warnings.push_back(fmt::format("{}: {}", path, warning));
    refuse_choice(record, rig);
    impacts.push_back(chosen_impact(record, job, needs_force(rig, options), warnings));
    if (!impacts.back().force && options.use_force) warnings.push_back(without_force(path, job));
    check_momentum(path, rig, impacts.back(), job.common.quiet, warnings);
    check_times(rig, impacts.back(), job.common.quiet, warnings);
    for (const reports::InputFile& input : data.provenance.inputs)
      if (input.sha256 == record.provenance.sha256)
        throw datasets::InputError(
            {.file = path}, fmt::format("is the same recording as {}; name each once", input.name));
    data.provenance.inputs.push_back({path, record.provenance.bytes, record.provenance.sha256});
    hashes.push_back(record.provenance.sha256);
    data.records.push_back(std::move(record));
  }
  if (chosen.empty()) chosen = fitting::choose_mesh(rig, fitting::finest_mesh_of_fits).sentence;
  if (!job.common.quiet)
    fmt::print(stderr, "fitting {} impact(s), model {}\n", impacts.size(),
               models::name(rig.solver.model));
  data.fit = fitting::fit(impacts, rig, options);
  // a mesh that the fit refined has a warning of its own
  if (!chosen.empty() && data.fit.rig.solver.elements == rig.solver.elements)
    warnings.push_back(chosen);
  data.fit.warnings.insert(data.fit.warnings.begin(), warnings.begin(), warnings.end());
  if (!job.against.empty()) {
    fitting::FitOptions alone = options;
    alone.window = data.fit.window;
    alone.profile = false;
    alone.bootstrap = 0;
    data.models = fitting::compare_models(impacts, models, alone);
  }
  data.title = !job.title.empty()
                   ? job.title
                   : fmt::format("Impact of {}",
                                 std::filesystem::path(job.recordings.front()).filename().string());
  data.provenance.wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  data.provenance.result_key = result_key(job, rig.sha256, hashes);
  return data;
}

}  // namespace impactrig::app
