// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "acquisition/exporter.hpp"
#include "acquisition/replay.hpp"
#include "acquisition/synthetic.hpp"
#include "app/files.hpp"
#include "app/program.hpp"
#include "app/quantity_option.hpp"
#include "datasets/input_error.hpp"
#include "fitting/force_curve.hpp"
#include "fitting/mesh_choice.hpp"
#include "fitting/rig_file.hpp"
#include "models/simulation.hpp"

namespace impactrig::app {
namespace {

constexpr int finer_than_recording = 20;
// What the sensors' chains answer is linear between the samples of the motion: of a contact that a
// slow recorder shows in few samples, too, no more of them may be apart [s], unless the recording
// is long.
constexpr double fine = 0.1e-6;
constexpr double most_samples = 4e6;
// What a rig's own accuracy leaves out would be in every shot alike, and a fit that takes better
// equations than that would find them wrong.
constexpr double accuracy_of_truth = 1e-6;

struct Options {
  std::string source;
  std::string rig;
  std::vector<std::string> recordings;
  std::string output;
  std::string day = "good";
  std::uint64_t seed = 1;
  std::uint64_t calibration_seed = 1;
  double sample_rate = 1e6;
  double pre_trigger = 1e-3;
  double duration = 4e-3;
  int shots = 1;
  bool real_time = false;
  CommonOptions common;
};

double interval_of_motion(const Options& options) {
  return std::min(1.0 / (finer_than_recording * options.sample_rate),
                  std::max(fine, options.duration / most_samples));
}

acquisition::Trajectory trajectory_of(const fitting::RigFile& rig, const Options& options,
                                      models::Simulation& simulation) {
  models::SimulationOptions request;
  const double margin = 50e-6;  // delays and trigger jitter look this far beyond
  request.history = {.interval = interval_of_motion(options), .lead = options.pre_trigger + margin};
  if (rig.velocity) request.history.velocity_position = rig.velocity->position;
  if (rig.displacement) request.history.displacement_position = rig.displacement->position;
  models::Solver solver = rig.solver;
  solver.accuracy = std::min(solver.accuracy, accuracy_of_truth);
  solver.duration = options.duration - options.pre_trigger + margin;
  simulation = models::simulate(rig.rig, solver, request);
  const models::History& h = simulation.history;
  const double recorded = options.duration - options.pre_trigger;
  if (simulation.duration < recorded)
    throw datasets::InputError(
        {.file = options.rig},
        fmt::format("the simulation ended {:.4g} s after first touch, the recording asked for goes "
                    "on to {:.4g} s: {}. State a shorter --duration{}",
                    simulation.duration, recorded, simulation.termination,
                    simulation.cut_short ? " or a longer solver.time_limit" : ""));
  datasets::SampledCurve force = fitting::force_curve(h);
  return {.start = h.start,
          .interval = h.interval,
          .force = std::move(force.values),
          .velocity = h.velocity,
          .displacement = h.displacement,
          .force_jumps = std::move(force.jumps),
          .force_spikes = std::move(force.spikes)};
}

acquisition::SyntheticOptions day_of(const Options& options, const acquisition::SensorSet& sensors,
                                     const acquisition::ShownPeaks& peaks, std::uint64_t seed) {
  acquisition::SyntheticOptions day;
  if (options.day == "good") day = acquisition::good_laboratory_day(sensors, peaks);
  if (options.day == "bad") day = acquisition::bad_day(sensors, peaks);
  day.sample_rate = options.sample_rate;
  day.pre_trigger = options.pre_trigger;
  day.duration = options.duration;
  day.seed = seed;
  if (options.day == "good")
    acquisition::draw_calibration_errors(sensors, options.calibration_seed, day);
  return day;
}

/// What the synthetic source knows and a laboratory does not, for judging a fit.
std::string truth_json(const fitting::RigFile& rig, const models::Simulation& simulation,
                       const datasets::Record& record, const Options& options, std::uint64_t seed) {
  nlohmann::ordered_json json = {{"schema", "impactrig/truth/1"},
                                 {"program", datasets::program_version()},
                                 {"rig_sha256", rig.sha256},
                                 {"seed", seed},
                                 {"day", options.day},
                                 {"contact.stiffness_factor", rig.rig.contact.stiffness_factor},
                                 {"start.velocity", models::touch_velocity(rig.rig)},
                                 {"model", models::name(rig.solver.model)},
                                 {"peak_force_n", simulation.peak_force},
                                 {"kinematic_restitution", simulation.restitution.kinematic}};
  const models::Contact& contact = rig.rig.contact;
  if (contact.takes_restitution()) json["contact.restitution"] = contact.restitution;
  if (contact.viscous) json["contact.viscous"] = *contact.viscous;
  if (contact.relaxation_time) json["contact.relaxation_time"] = *contact.relaxation_time;
  for (const auto& [key, value] : record.attributes)
    if (key.starts_with("truth.")) json[key.substr(6)] = value;
  return json.dump(2) + "\n";
}

/// "shot.h5" for one shot, "shot_03.h5" for the third of several.
std::string shot_path(const Options& options, int shot) {
  if (options.shots == 1) return options.output;
  const std::filesystem::path path(options.output);
  return (path.parent_path() /
          fmt::format("{}_{:02}{}", path.stem().string(), shot, path.extension().string()))
      .string();
}

std::string truth_path(const std::string& shot) {
  return std::filesystem::path(shot).replace_extension(".truth.json").string();
}

/// Of all shots, so that a bad path fails before the first one.
void check_outputs(const Options& options, const std::vector<std::string>& inputs) {
  std::vector<std::string> shots, truths;
  for (int shot = 1; shot <= options.shots; ++shot) {
    shots.push_back(shot_path(options, shot));
    truths.push_back(truth_path(shots.back()));
  }
  std::vector<std::string> outputs = shots;
  if (options.source == "synthetic") outputs.insert(outputs.end(), truths.begin(), truths.end());
  refuse_inputs(outputs, inputs);
  for (const std::string& path : outputs) check_output(path, options.common.force);
}

void acquire_synthetic(const Options& options) {
  if (options.rig.empty()) throw CLI::RequiredError("--rig (the synthetic source simulates a rig)");
  check_outputs(options, {options.rig});
  fitting::RigFile rig =
      fitting::read_rig_file(options.rig, split_overrides(options.common.overrides));
  if (!rig.force && !rig.velocity && !rig.displacement)
    throw datasets::InputError(
        {.file = options.rig},
        "describes no sensors to record with; add [sensors.force] and [sensors.velocity]");
  if (!rig.rig.has_stop())
    throw datasets::InputError({.file = options.rig},
                               "has no [contact]: the synthetic source records impacts");
  fitting::choose_mesh(rig, fitting::finest_mesh);
  models::Simulation simulation;
  const acquisition::Trajectory trajectory = trajectory_of(rig, options, simulation);
  const acquisition::SensorSet sensors = {rig.force, rig.velocity, rig.displacement};
  const acquisition::ShownPeaks peaks = acquisition::shown_peaks(trajectory, sensors);
  for (int shot = 1; shot <= options.shots; ++shot) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(shot - 1);
    const std::string path = shot_path(options, shot);
    datasets::Record record =
        acquisition::synthesise(trajectory, sensors, day_of(options, sensors, peaks, seed));
    write_output(truth_path(path), truth_json(rig, simulation, record, options, seed), true);
    std::erase_if(record.attributes,
                  [](const auto& entry) { return entry.first.starts_with("truth."); });
    export_and_tell(record, path, options.common.quiet);
    if (!options.common.quiet) fmt::print(stderr, "{} written, its truth beside it\n", path);
  }
}

void acquire_replay(const Options& options) {
  if (options.recordings.empty()) throw CLI::RequiredError("--recording (what to replay)");
  Options named = options;
  named.shots = static_cast<int>(options.recordings.size());
  check_outputs(named, options.recordings);
  acquisition::ReplaySource source(
      options.recordings, {},
      options.real_time ? acquisition::Pace::real_time : acquisition::Pace::at_once);
  int shot = 0;
  while (const auto record = source.next()) {
    const std::string path = shot_path(named, ++shot);
    export_and_tell(*record, path, options.common.quiet);
    if (!options.common.quiet) fmt::print(stderr, "{} written\n", path);
  }
}

void acquire(const Options& options) {
  if (!(options.duration > options.pre_trigger))
    throw CLI::ValidationError("--duration", "must be longer than --pre-trigger");
  check_ending(options.output);
  if (options.source == "synthetic")
    acquire_synthetic(options);
  else
    acquire_replay(options);
}

}  // namespace

void add_acquire(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("acquire", "Record shots from a source");
  command->add_option("--source", options->source, "synthetic or replay (`impactrig sources`)")
      ->required()
      ->check(CLI::IsMember({"synthetic", "replay"}));
  command
      ->add_option("-o,--output", options->output,
                   "Recording: .h5, .mat, .uff or .csv; several shots are numbered")
      ->required();
  command->add_option("--rig", options->rig, "Synthetic: the rig to simulate, with its sensors");
  command->add_option("--seed", options->seed, "Synthetic: of noise, hum and trigger")
      ->capture_default_str();
  command
      ->add_option("--calibration-seed", options->calibration_seed,
                   "Synthetic: of gain and delay errors, within what the rig file states")
      ->capture_default_str();
  command->add_option("--day", options->day, "Synthetic: ideal, good or bad laboratory day")
      ->check(CLI::IsMember({"ideal", "good", "bad"}))
      ->capture_default_str();
  command->add_option("--sample-rate", options->sample_rate, "Synthetic [Hz]")
      ->transform(with_unit("Hz"))
      ->check(CLI::Range(1e3, 1e8))
      ->capture_default_str();
  command
      ->add_option("--pre-trigger", options->pre_trigger,
                   "Synthetic: recorded before first touch [s]")
      ->transform(with_unit("s"))
      ->check(CLI::Range(1e-5, 10.0))
      ->capture_default_str();
  command->add_option("--duration", options->duration, "Synthetic: recorded in all [s]")
      ->transform(with_unit("s"))
      ->check(CLI::Range(1e-4, 100.0))
      ->capture_default_str();
  command->add_option("-n,--shots", options->shots, "Synthetic: how many, seeds counting up")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--recording", options->recordings, "Replay: recordings of any format");
  command->add_flag("--real-time", options->real_time, "Replay: no faster than they were recorded");
  add_set(*command, options->common);
  add_quiet(*command, options->common);
  add_force(*command, options->common);
  command->callback([options] { acquire(*options); });
}

}  // namespace impactrig::app
