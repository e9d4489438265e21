// SPDX-License-Identifier: BSD-3-Clause
//
// How often the 95 % intervals of a fit hold the truth. Each shot has a seed of its own: truths
// (restitution 0.3 to 0.8, stiffness factor 0.8 to 1.25, speed 0.3 to 0.5 m/s), calibration errors
// and everything else the laboratory adds are drawn from it. A pull is (fitted - true) over the
// standard error: mean 0, standard deviation 1 where the intervals are honest. Disturbances can be
// left out, to see which one the fit does not understand; the truth can be simulated with other
// solver settings than the fit's, to see what a mesh error does.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/random_stream.hpp"
#include "acquisition/synthetic.hpp"
#include "fitting/fit.hpp"
#include "fitting/rig_file.hpp"
#include "models/simulation.hpp"

namespace {

using namespace impactrig;

const std::vector<std::string> names = {"contact.restitution", "contact.stiffness_factor",
                                        "start.velocity"};
const std::vector<std::string> disturbances = {"hum",   "drift",  "speckle",     "offset",
                                               "noise", "digits", "calibration", "dropouts"};

constexpr double mesh_part = 1.1;  // of a mesh shift, in an interval: fitting/fit.cpp

struct Study {
  std::string rig = IMPACTRIG_SOURCE_DIR "/datasets/samples/shen2007.toml";
  std::vector<std::string> set, truth_set, without;
  std::uint64_t seed = 101;
  int shots = 40;
  double pre_trigger = 0.5e-3;
  double duration = 4e-3;
  std::string day = "good";
  std::string output;
};

std::vector<fitting::Override> overrides(const std::vector<std::string>& assignments) {
  std::vector<fitting::Override> list;
  for (const std::string& text : assignments) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw CLI::ValidationError("--set", "needs key=value");
    list.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return list;
}

void leave_out(const std::vector<std::string>& without, acquisition::SyntheticOptions& options) {
  const auto leaves = [&](const char* what) { return std::ranges::count(without, what) > 0; };
  for (acquisition::Disturbances* d : {&options.force, &options.velocity, &options.displacement}) {
    if (leaves("hum")) d->hum = 0.0;
    if (leaves("drift")) d->drift = 0.0;
    if (leaves("speckle")) d->low_frequency_noise = 0.0;
    if (leaves("offset")) d->offset = 0.0;
    if (leaves("noise")) d->noise = 0.0;
    if (leaves("digits")) d->bits = 0;
    if (leaves("calibration")) d->gain_error = d->delay_error = 0.0;
    if (leaves("dropouts")) d->dropouts_per_second = 0.0;
  }
}

struct Shot {
  std::uint64_t seed = 0;
  std::vector<double> truth, value, error;  // (names)
  std::vector<bool> inside;                 // (names)
  double reduced = 0.0;
  long simulations = 0;
  bool sound = true;  // no channel's diagnostics find fault
};

datasets::Record record_shot(const Study& study, const fitting::RigFile& rig, std::uint64_t seed) {
  constexpr double margin = 50e-6;
  acquisition::SyntheticOptions options;
  models::SimulationOptions request;
  request.history = {.interval = 0.05 / options.sample_rate, .lead = study.pre_trigger + margin};
  if (rig.velocity) request.history.velocity_position = rig.velocity->position;
  models::Solver solver = rig.solver;
  solver.duration = study.duration - study.pre_trigger + margin;
  const models::Simulation truth = models::simulate(rig.rig, solver, request);
  const acquisition::SensorSet sensors = {rig.force, rig.velocity, rig.displacement};
  const double fastest =
      std::ranges::max(truth.history.velocity, {}, [](double v) { return std::abs(v); });
  options = study.day == "bad"
                ? acquisition::bad_day(sensors, truth.peak_force, std::abs(fastest))
                : acquisition::good_laboratory_day(sensors, truth.peak_force, std::abs(fastest));
  options.pre_trigger = study.pre_trigger;
  options.duration = study.duration;
  options.seed = seed;
  if (study.day == "good") acquisition::draw_calibration_errors(sensors, seed, options);
  leave_out(study.without, options);
  const models::History& h = truth.history;
  return acquisition::synthesise({.start = h.start,
                                  .interval = h.interval,
                                  .force = h.force,
                                  .velocity = h.velocity,
                                  .displacement = h.displacement},
                                 sensors, options);
}

Shot fit_shot(const Study& study, std::uint64_t seed) {
  acquisition::RandomStream random(seed, "truth");
  Shot shot;
  shot.seed = seed;
  shot.truth = {random.uniform(0.3, 0.8), random.uniform(0.8, 1.25), random.uniform(0.3, 0.5)};
  std::vector<fitting::Override> settings = overrides(study.set);
  for (const fitting::Override& other : overrides(study.truth_set)) settings.push_back(other);
  fitting::RigFile truth = fitting::read_rig_file(study.rig, settings);
  truth.rig.contact.restitution = shot.truth[0];
  truth.rig.contact.stiffness_factor = shot.truth[1];
  truth.rig.start.velocity = shot.truth[2];
  const datasets::Record record = record_shot(study, truth, seed);

  const fitting::RigFile rig = fitting::read_rig_file(study.rig, overrides(study.set));
  const std::vector<datasets::Impact> impacts = acquisition::find_impacts(
      acquisition::condition(record, {rig.force, rig.velocity, rig.displacement}));
  const fitting::Fit fit = fitting::fit({impacts.at(0)}, rig);
  shot.reduced = fit.goodness.chi2 / static_cast<double>(fit.goodness.dof);
  shot.simulations = fit.simulations;
  for (const fitting::ChannelFit& channel : fit.channels)
    shot.sound = shot.sound && channel.diagnostics->sound;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto p = std::ranges::find(fit.parameters, names[i], &fitting::Parameter::name);
    shot.value.push_back(p->value);
    shot.error.push_back(p->std_error);
    // a truth from the same mesh is not to be found in what the interval holds for the mesh's error
    const double mesh = study.truth_set.empty() ? mesh_part * std::abs(p->mesh_shift) : 0.0;
    shot.inside.push_back(p->ci95[0] + mesh <= shot.truth[i] && shot.truth[i] <= p->ci95[1] - mesh);
  }
  return shot;
}

void print_summary(const std::vector<Shot>& shots, nlohmann::ordered_json& json) {
  using boost::math::binomial_distribution;
  const double n = static_cast<double>(shots.size());
  fmt::print("{:<26} {:>8} {:>17} {:>7} {:>6} {:>7} {:>13}\n", "parameter", "inside",
             "coverage, 95 % CI", "mean", "sd", "worst", "median error");
  for (std::size_t i = 0; i < names.size(); ++i) {
    double sum = 0.0, squares = 0.0, worst = 0.0, inside = 0.0;
    std::vector<double> errors;
    for (const Shot& shot : shots) {
      const double pull = (shot.value[i] - shot.truth[i]) / shot.error[i];
      sum += pull;
      squares += pull * pull;
      if (std::abs(pull) > std::abs(worst)) worst = pull;
      inside += shot.inside[i] ? 1.0 : 0.0;
      errors.push_back(shot.error[i] / shot.truth[i]);
    }
    std::ranges::sort(errors);
    const double mean = sum / n;
    const double sd = n > 1.0 ? std::sqrt((squares - n * mean * mean) / (n - 1.0)) : 0.0;
    const double low = binomial_distribution<>::find_lower_bound_on_p(n, inside, 0.025);
    const double high = binomial_distribution<>::find_upper_bound_on_p(n, inside, 0.025);
    fmt::print("{:<26} {:>4}/{:<3} {:>6.1f} to {:>5.1f} % {:>7.2f} {:>6.2f} {:>7.2f} {:>12.3g}%\n",
               names[i], inside, n, 100.0 * low, 100.0 * high, mean, sd, worst,
               100.0 * errors[errors.size() / 2]);
    json["parameters"].push_back({{"name", names[i]},
                                  {"inside", inside},
                                  {"coverage_ci95", {low, high}},
                                  {"pull_mean", mean},
                                  {"pull_sd", sd},
                                  {"pull_worst", worst},
                                  {"median_relative_error", errors[errors.size() / 2]}});
  }
}

void run(const Study& study) {
  const auto started = std::chrono::steady_clock::now();
  std::vector<Shot> shots;
  nlohmann::ordered_json json = {{"schema", "impactrig/coverage/1"},
                                 {"program", datasets::program_version()},
                                 {"first_seed", study.seed},
                                 {"shots", study.shots},
                                 {"without", study.without},
                                 {"truth_set", study.truth_set},
                                 {"set", study.set},
                                 {"day", study.day}};
  for (int k = 0; k < study.shots; ++k) {
    shots.push_back(fit_shot(study, study.seed + static_cast<std::uint64_t>(k)));
    const Shot& shot = shots.back();
    json["fits"].push_back({{"seed", shot.seed},
                            {"truth", shot.truth},
                            {"value", shot.value},
                            {"std_error", shot.error},
                            {"reduced_chi2", shot.reduced},
                            {"simulations", shot.simulations},
                            {"sound", shot.sound}});
  }
  print_summary(shots, json);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  fmt::print("{} of {} called unsound by their diagnostics\n",
             std::ranges::count(shots, false, &Shot::sound), study.shots);
  fmt::print("{} shots from seed {}, {:.2f} s a shot\n", study.shots, study.seed,
             seconds / study.shots);
  if (!study.output.empty()) std::ofstream(study.output) << json.dump(1) << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  Study study;
  CLI::App program("How often the 95 % intervals of a fit hold the truth");
  program.add_option("--rig", study.rig, "Rig file")->capture_default_str();
  program.add_option("--shots", study.shots, "How many")->check(CLI::Range(1, 100000));
  program.add_option("--seed", study.seed, "Of the first shot")->capture_default_str();
  program.add_option("--day", study.day, "good or bad")->check(CLI::IsMember({"good", "bad"}));
  program.add_option("--pre-trigger", study.pre_trigger, "[s]")->capture_default_str();
  program.add_option("--duration", study.duration, "[s]")->capture_default_str();
  program.add_option("--set", study.set, "key=value of the rig file, for truth and fit");
  program.add_option("--truth-set", study.truth_set, "key=value for the truth alone");
  program.add_option("--without", study.without, "Disturbances to leave out")
      ->check(CLI::IsMember(disturbances))
      ->delimiter(',');
  program.add_option("-o,--output", study.output, "Every fit, as JSON");
  CLI11_PARSE(program, argc, argv);
  try {
    run(study);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
