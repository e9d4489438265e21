// SPDX-License-Identifier: BSD-3-Clause
//
// How often the 95 % intervals of a fit hold the truth. Each shot has a seed of its own: truths
// (restitution 0.3 to 0.8, stiffness factor 0.8 to 1.25, speed 0.3 to 0.5 m/s), calibration errors
// of gains and delays and everything else the laboratory adds are drawn from it. A pull is (fitted
// - true) over the standard error: mean 0, standard deviation 1 where the intervals are honest.
// Intervals of profile likelihood and bootstrap beside those of the covariance where asked for.
// Disturbances can be left out, to see which one the fit does not understand; the truth can be
// simulated with other solver settings than the fit's, to see what a mesh error does. The truth is
// solved to 1e-9.

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
#include "acquisition/synthetic.hpp"
#include "bench/recorded_shot.hpp"
#include "fitting/all_cores.hpp"
#include "fitting/fit.hpp"
#include "fitting/rig_file.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace impactrig;

const std::vector<std::string> names = {"contact.restitution",   "contact.stiffness_factor",
                                        "start.velocity",        "sensors.force.gain",
                                        "sensors.force.delay",   "sensors.velocity.gain",
                                        "sensors.velocity.delay"};
const std::vector<std::string> kinds = {"covariance", "profile", "parametric", "residual"};
const std::vector<std::string> disturbances = {"hum",   "drift",  "speckle",     "offset",
                                               "noise", "digits", "calibration", "dropouts"};

constexpr double normal_quantile = 1.959963984540054;  // 97.5 %

struct Study {
  std::string rig = tests::source_dir + "/datasets/samples/shen2007.toml";
  std::vector<std::string> set, truth_set, without;
  std::uint64_t seed = 101;
  int shots = 40;
  double pre_trigger = 0.5e-3;
  double duration = 4e-3;
  std::string day = "good";
  std::string output;
  bool profile = false;
  int bootstrap = 0;
};

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

/// One parameter of one shot.
struct Pull {
  bool fitted = false;
  double truth = 0.0, value = 0.0, error = 0.0;
  std::map<std::string, bool> inside = {};  // by kind of interval
};

struct Shot {
  std::uint64_t seed = 0;
  std::vector<Pull> pulls;  // (names)
  double reduced = 0.0;
  long simulations = 0;
  bool sound = true;  // as the diagnostics of its channels say
};

/// The record, and into `truth_of` what gains and delays really are.
datasets::Record record_shot(const Study& study, const fitting::RigFile& rig, std::uint64_t seed,
                             std::map<std::string, double>& truth_of) {
  const bool good = study.day == "good";
  const bench::RecordedShot shot = bench::record_shot(
      rig, {.pre_trigger = study.pre_trigger,
            .duration = study.duration,
            .day = good ? acquisition::good_laboratory_day : acquisition::bad_day,
            .change = [&](acquisition::SyntheticOptions& options, double) {
              options.seed = seed;
              if (good) acquisition::draw_calibration_errors(bench::sensors_of(rig), seed, options);
              leave_out(study.without, options);
            }});
  truth_of["sensors.force.gain"] = 1.0 + shot.options.force.gain_error;
  truth_of["sensors.velocity.gain"] = 1.0 + shot.options.velocity.gain_error;
  truth_of["sensors.force.delay"] =
      (rig.force ? rig.force->delay.value : 0.0) + shot.options.force.delay_error;
  truth_of["sensors.velocity.delay"] =
      (rig.velocity ? rig.velocity->delay.value : 0.0) + shot.options.velocity.delay_error;
  return shot.record;
}

bool within(double truth, double low, double high) {
  return low <= truth && truth <= high;
}

Pull pull_of(const Study& study, const fitting::Fit& fit, const std::string& name, double truth) {
  Pull pull{.fitted = true, .truth = truth};
  const auto p = std::ranges::find(fit.parameters, name, &fitting::Parameter::name);
  if (p == fit.parameters.end() || !p->identifiable) return {};
  pull.value = p->value;
  pull.error = p->std_error;
  // a truth from the same mesh is not to be found in what the interval holds for the mesh's error
  pull.inside["covariance"] = study.truth_set.empty()
                                  ? std::abs(truth - p->value) <= normal_quantile * p->std_error
                                  : within(truth, p->ci95[0], p->ci95[1]);
  for (const fitting::Profile& profile : fit.profiles)
    if (profile.name == name)
      pull.inside["profile"] =
          within(truth, profile.lower.value_or(-HUGE_VAL), profile.upper.value_or(HUGE_VAL));
  return pull;
}

void add_bootstrap(const fitting::Fit& fit, fitting::BootstrapKind kind, Shot& shot) {
  for (const fitting::Bootstrap::Parameter& b : fit.bootstrap->parameters)
    if (const auto place = std::ranges::find(names, b.name); place != names.end()) {
      Pull& pull = shot.pulls[static_cast<std::size_t>(place - names.begin())];
      pull.inside[std::string(fitting::name(kind))] = within(pull.truth, b.ci95[0], b.ci95[1]);
    }
}

Shot fit_shot(const Study& study, std::uint64_t seed) {
  Shot shot;
  shot.seed = seed;
  std::vector<fitting::Override> settings = bench::overrides(study.set);
  for (const fitting::Override& other : bench::overrides(study.truth_set))
    settings.push_back(other);
  fitting::RigFile truth = fitting::read_rig_file(study.rig, settings);
  std::map<std::string, double> truth_of;
  bench::draw_truth(seed, truth.rig);
  truth_of["contact.restitution"] = truth.rig.contact.restitution;
  truth_of["contact.stiffness_factor"] = truth.rig.contact.stiffness_factor;
  truth_of["start.velocity"] = truth.rig.start.velocity;
  const datasets::Record record = record_shot(study, truth, seed, truth_of);

  fitting::RigFile rig = fitting::read_rig_file(study.rig, bench::overrides(study.set));
  rig.fit.profile = study.profile;
  rig.fit.seed = seed;
  const std::vector<datasets::Impact> impacts =
      acquisition::find_impacts(acquisition::condition(record, bench::sensors_of(rig)));
  const fitting::Fit fit = fitting::fit({impacts.at(0)}, rig);
  shot.reduced = fit.goodness.chi2 / static_cast<double>(fit.goodness.dof);
  shot.simulations = fit.simulations;
  for (const fitting::ChannelFit& channel : fit.channels)
    shot.sound = shot.sound && channel.diagnostics->sound;
  for (const std::string& name : names)
    shot.pulls.push_back(pull_of(study, fit, name, truth_of[name]));
  if (study.bootstrap > 0)
    for (const auto kind : {fitting::BootstrapKind::parametric, fitting::BootstrapKind::residual}) {
      fitting::FitOptions again = rig.fit;
      again.for_report = again.profile = false;
      again.bootstrap = study.bootstrap;
      again.bootstrap_kind = kind;
      add_bootstrap(fitting::fit({impacts.at(0)}, rig, again), kind, shot);
    }
  return shot;
}

/// Mean, standard deviation and worst of the pulls of a parameter; median of its relative error.
void print_pulls(const std::vector<Shot>& shots, std::size_t i, nlohmann::ordered_json& json) {
  double sum = 0.0, squares = 0.0, worst = 0.0, n = 0.0;
  std::vector<double> errors;
  for (const Shot& shot : shots) {
    const Pull& p = shot.pulls[i];
    if (!p.fitted) continue;
    const double pull = (p.value - p.truth) / p.error;
    n += 1.0;
    sum += pull;
    squares += pull * pull;
    if (std::abs(pull) > std::abs(worst)) worst = pull;
    errors.push_back(p.error);
  }
  if (errors.empty()) return;
  std::ranges::sort(errors);
  const double mean = sum / n;
  const double sd = n > 1.0 ? std::sqrt((squares - n * mean * mean) / (n - 1.0)) : 0.0;
  fmt::print("{:<26} {:>6.2f} ± {:<5.2f} {:>6.2f} {:>7.2f} {:>11.3g}\n", names[i], mean,
             sd / std::sqrt(n), sd, worst, errors[errors.size() / 2]);
  json["parameters"].push_back({{"name", names[i]},
                                {"pull_mean", mean},
                                {"pull_sd", sd},
                                {"pull_worst", worst},
                                {"median_std_error", errors[errors.size() / 2]}});
}

void print_coverage(const std::vector<Shot>& shots, std::size_t i, const std::string& kind,
                    nlohmann::ordered_json& json) {
  using boost::math::binomial_distribution;
  double n = 0.0, inside = 0.0;
  for (const Shot& shot : shots)
    if (const auto found = shot.pulls[i].inside.find(kind); found != shot.pulls[i].inside.end()) {
      n += 1.0;
      inside += found->second ? 1.0 : 0.0;
    }
  if (n == 0.0) return;
  const double low = binomial_distribution<>::find_lower_bound_on_p(n, inside, 0.025);
  const double high = binomial_distribution<>::find_upper_bound_on_p(n, inside, 0.025);
  fmt::print("{:<26} {:<11} {:>5}/{:<5} {:>6.1f} %   {:>5.1f} to {:.1f} %\n", names[i], kind,
             inside, n, 100.0 * inside / n, 100.0 * low, 100.0 * high);
  json["coverage"].push_back({{"name", names[i]},
                              {"kind", kind},
                              {"inside", inside},
                              {"shots", n},
                              {"ci95", {low, high}}});
}

void print_summary(const std::vector<Shot>& shots, nlohmann::ordered_json& json) {
  fmt::print("{:<26} {:>14} {:>6} {:>7} {:>11}\n", "pulls", "mean", "sd", "worst", "std. error");
  for (std::size_t i = 0; i < names.size(); ++i) print_pulls(shots, i, json);
  fmt::print("\n{:<26} {:<11} {:>11} {:>8}   {}\n", "95 % intervals", "kind", "hold truth", "share",
             "of that 95 %");
  for (std::size_t i = 0; i < names.size(); ++i)
    for (const std::string& kind : kinds) print_coverage(shots, i, kind, json);
  const auto unsound = std::ranges::count_if(shots, [](const Shot& shot) { return !shot.sound; });
  fmt::print("{} of {} fits called unsound by their diagnostics\n", unsound, shots.size());
  json["unsound"] = unsound;
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
  shots.resize(static_cast<std::size_t>(study.shots));
  fitting::run_on_all_cores(shots.size(), [&](std::size_t k, std::size_t) {
    shots[k] = fit_shot(study, study.seed + k);
  });
  for (const Shot& shot : shots) {
    nlohmann::ordered_json fit = {{"seed", shot.seed},
                                  {"reduced_chi2", shot.reduced},
                                  {"simulations", shot.simulations},
                                  {"sound", shot.sound}};
    for (std::size_t i = 0; i < names.size(); ++i)
      fit["pulls"][names[i]] = {shot.pulls[i].truth, shot.pulls[i].value, shot.pulls[i].error};
    json["fits"].push_back(fit);
  }
  print_summary(shots, json);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
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
  program.add_flag("--profile", study.profile, "Intervals by profile likelihood as well");
  program.add_option("--bootstrap", study.bootstrap,
                     "Refits for intervals by parametric and by residual bootstrap");
  program.add_option("-o,--output", study.output, "Every fit, as JSON");
  CLI11_PARSE(program, argc, argv);
  try {
    run(study);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
