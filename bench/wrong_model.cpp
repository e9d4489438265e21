// SPDX-License-Identifier: BSD-3-Clause
//
// How often a fit's diagnostics notice a wrong model, and how often they accuse a right one. Each
// case makes shots with one rig and fits them with another; the noise has a seed of its own in each
// shot. A case whose two rigs are the same counts false alarms, which should stay within 5 %.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <map>
#include <string>
#include <vector>

#include "fitting/fit.hpp"
#include "fitting/rig_file.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace {

using namespace impactrig;
using Overrides = std::vector<fitting::Override>;

struct Case {
  std::string truth, model;
  Overrides truth_set, model_set;
  tests::ShotTruth shot = {};
};

const Overrides fast = {{"solver.model", "hybrid"},
                        {"solver.basis", "pinned-free"},
                        {"solver.modes", "4"},
                        {"solver.duration", "1.5 ms"}};
const Overrides trusted_delays = {{"sensors.force.delay", R"({ value = "0 us" })"},
                                  {"sensors.velocity.delay", R"({ value = "2 us" })"}};

std::vector<Case> right_models() {
  return {
      {"lankarani-nikravesh", "the same", {}, {}},
      {"noise of memory 0.6", "the same", {}, {}, {.noise_memory = 0.6}},
      {"noise of memory 0.9", "the same", {}, {}, {.noise_memory = 0.9}},
      {"steps of the noise's size", "the same", {}, {}, {.step = 1.0}},
      {"steps of 8 times the noise", "the same", {}, {}, {.step = 8.0}},
      {"hum of 1 % of the peak", "the same", {}, {}, {.force_hum = 20.0, .velocity_hum = 4e-3}}};
}

std::vector<Case> wrong_models() {
  const Overrides law = {{"contact.law", "hertz-point"}};
  const Overrides stop = {{"stop.mass", "50 g"}, {"stop.stiffness", "2e8 N/m"}};
  const Overrides linear = {{"contact.law", "linear"}, {"contact.stiffness", "5e7 N/m"}};
  // 1 % of the peak force, 2 % of the speed
  const tests::ShotTruth noisy = {.force_noise = 20.0, .velocity_noise = 1e-2};
  const Overrides viscous = {{"contact.damping", "viscous"}};
  return {{"lankarani-nikravesh", "none", {}, {{"contact.damping", "none"}}},
          {"lankarani-nikravesh", "viscous", {}, viscous},
          {"lankarani-nikravesh", "tsuji", {}, {{"contact.damping", "tsuji"}}},
          {"goldsmith", "hertz-point", {}, law},
          {"goldsmith", "linear", {}, linear},
          {"laser at 0.69 m", "laser at 0.72 m", {}, {{"sensors.velocity.position", "0.72 m"}}},
          {"stop of 50 g on 2e8 N/m", "rigid stop", stop, {}},
          {"8 modes", "4 modes", {{"solver.modes", "8"}}, {}},
          {"8 modes", "2 modes", {{"solver.modes", "8"}}, {{"solver.modes", "2"}}},
          {"force 1.5 us late",
           "delays without uncertainty",
           trusted_delays,
           trusted_delays,
           {.force_delay = 1.5e-6}},
          {"force 0.3 us late",
           "delays without uncertainty",
           trusted_delays,
           trusted_delays,
           {.force_delay = 0.3e-6}},
          {"lankarani-nikravesh, noisy", "viscous", {}, viscous, noisy},
          {"goldsmith, noisy", "linear", {}, linear, noisy},
          {"laser at 0.69 m, noisy",
           "laser at 0.70 m",
           {},
           {{"sensors.velocity.position", "0.70 m"}},
           noisy},
          {"stop of 10 g on 1e9 N/m, noisy",
           "rigid stop",
           {{"stop.mass", "10 g"}, {"stop.stiffness", "1e9 N/m"}},
           {},
           noisy}};
}

fitting::RigFile rig_with(const Overrides& more) {
  Overrides all = fast;
  for (const fitting::Override& change : more) {
    const auto same = std::ranges::find(all, change.first, &fitting::Override::first);
    if (same != all.end())
      *same = change;
    else
      all.push_back(change);
  }
  return fitting::parse_rig_file(tests::paper_rig, "rig.toml", all);
}

struct Tally {
  int shots = 0, unsound = 0, discrepant = 0;
  std::map<std::string, int> channels;  ///< how often each was called unsound
  std::string sentence;                 ///< of the most telling channel of the first such shot
};

void count(const fitting::Fit& fit, Tally& tally) {
  ++tally.shots;
  const fitting::ChannelFit* worst = nullptr;
  bool discrepant = false;
  for (const fitting::ChannelFit& channel : fit.channels) {
    discrepant = discrepant || channel.diagnostics->discrepancy.significant;
    if (channel.diagnostics->sound) continue;
    ++tally.channels[channel.quantity];
    if (worst == nullptr ||
        channel.residual_rms / channel.noise > worst->residual_rms / worst->noise)
      worst = &channel;
  }
  tally.discrepant += discrepant ? 1 : 0;
  if (worst == nullptr) return;
  ++tally.unsound;
  if (tally.sentence.empty()) tally.sentence = worst->diagnostics->sentence;
}

void print(const Case& study, const Tally& tally, bool right) {
  using boost::math::binomial_distribution;
  const double n = tally.shots, k = tally.unsound;
  const double low = binomial_distribution<>::find_lower_bound_on_p(n, k, 0.025);
  const double high = binomial_distribution<>::find_upper_bound_on_p(n, k, 0.025);
  fmt::print("{:<27} {:<27} {:>5.1f} % ({:.1f} to {:.1f})  {:>5.1f} %\n", study.truth, study.model,
             100.0 * k / n, 100.0 * low, 100.0 * high, 100.0 * tally.discrepant / n);
  for (const auto& [channel, times] : tally.channels)
    if (right) fmt::print("    {}: {} of {}\n", channel, times, tally.shots);
  if (!tally.sentence.empty()) fmt::print("    {}\n", tally.sentence);
  std::fflush(stdout);
}

void run(const std::vector<Case>& cases, int shots, std::uint64_t seed, bool right) {
  fmt::print("{:<27} {:<27} {:<24} {}\n", "truth", "model fitted", "unsound (95 % CI)",
             "discrepancy");
  for (const Case& study : cases) {
    const fitting::RigFile truth = rig_with(study.truth_set), model = rig_with(study.model_set);
    Tally tally;
    for (int i = 0; i < shots; ++i) {
      tests::ShotTruth shot = study.shot;
      shot.duration = 1.6e-3;
      shot.seed = seed + static_cast<std::uint64_t>(i);
      count(fitting::fit({tests::synthetic_shot(truth, shot)}, model), tally);
    }
    print(study, tally, right);
    seed += 100000;  // other noise in each case
  }
}

}  // namespace

int main(int argc, char** argv) {
  int right = 200, wrong = 20;
  std::uint64_t seed = 1000;
  CLI::App program("How often diagnostics notice a wrong model and accuse a right one");
  program.add_option("--right", right, "Shots of each right model")->capture_default_str();
  program.add_option("--wrong", wrong, "Shots of each wrong model")->capture_default_str();
  program.add_option("--seed", seed, "Of the first shot")->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  try {
    if (right > 0) run(right_models(), right, seed, true);
    if (wrong > 0) run(wrong_models(), wrong, seed, false);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
