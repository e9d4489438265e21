// SPDX-License-Identifier: BSD-3-Clause
//
// The throughput of simulate_ensemble() against that of simulate(): random parameter sets of the
// paper's scene, hybrid coordinates with 12 pinned-free modes, 3 ms, as small motion. In "contact"
// the contact's parameters and the speed vary, in "bar" Young's modulus and density too, so that
// every bar has its own modes. Counted in processor time, so that what else the machine does
// matters little; the repetitions of all ways are interleaved, the best of each counts. A core is
// slower while others work beside it, so that what takes every core is compared with simulate() on
// every core.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "bench/timing.hpp"
#include "datasets/record.hpp"
#include "fitting/rig_file.hpp"
#include "models/ensemble.hpp"
#include "models/modal/bar_cache.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace impactrig;

struct Study {
  int members = 2000;
  int repetitions = 5;
  unsigned seed = 1;
  std::vector<double> accuracies = {1e-3, 1e-4, 1e-6};
  std::string output;
};

fitting::RigFile scene() {
  return fitting::read_rig_file(tests::source_dir + "/datasets/samples/shen2007.toml",
                                {{"solver.model", "hybrid"},
                                 {"solver.basis", "pinned-free"},
                                 {"solver.modes", "12"},
                                 {"solver.duration", "3 ms"}});
}

std::vector<models::Rig> draw(const Study& study, const models::Rig& rig, bool bars) {
  std::mt19937 random(study.seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<models::Rig> rigs(static_cast<std::size_t>(study.members), rig);
  for (models::Rig& member : rigs) {
    models::Contact& contact = member.contact;
    contact.restitution = uniform(0.3, 0.8);
    contact.length *= uniform(0.9, 1.1);
    contact.modulus *= uniform(0.9, 1.1);
    contact.radius *= uniform(0.98, 1.02);
    contact.counter_radius *= uniform(0.98, 1.02);
    contact.stiffness_factor = uniform(0.8, 1.25);
    member.start.velocity = uniform(0.3, 0.5);
    if (!bars) continue;
    member.beam.youngs_modulus *= uniform(0.95, 1.05);
    member.beam.density *= uniform(0.95, 1.05);
  }
  return rigs;
}

/// The largest relative deviation of peak force, duration and impulse of the first contact.
double deviation(const models::Simulation& a, const models::Simulation& b) {
  if (a.episodes.size() != b.episodes.size()) return std::numeric_limits<double>::infinity();
  const models::Episode& x = a.episodes.front();
  const models::Episode& y = b.episodes.front();
  return std::max({std::abs(a.peak_force / b.peak_force - 1.0), std::abs(x.end / y.end - 1.0),
                   std::abs(x.impulse / y.impulse - 1.0)});
}

struct Way {
  std::string name;
  std::function<void()> run;
  std::size_t yardstick = 0;  ///< the way it is compared with
  double seconds = std::numeric_limits<double>::infinity();
};

/// Calls `run` for every member, in turn by as many threads.
void by_threads(std::size_t members, std::size_t threads,
                const std::function<void(std::size_t)>& run) {
  std::vector<std::jthread> others;
  for (std::size_t k = 0; k < threads; ++k)
    others.emplace_back([&, k] {
      for (std::size_t i = k; i < members; i += threads) run(i);
    });
}

nlohmann::ordered_json measure(const Study& study, double accuracy, bool bars) {
  const fitting::RigFile file = scene();
  models::Solver solver = file.solver;
  solver.accuracy = accuracy;
  const std::vector<models::Rig> rigs = draw(study, file.rig, bars);
  models::EnsembleOptions options;
  options.simulation.motion = models::Motion::small;
  std::vector<models::Simulation> singles(rigs.size());
  std::vector<models::EnsembleMember> members;
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const auto one_by_one = [&](std::size_t threads, models::BarCache* cache) {
    models::SimulationOptions single = options.simulation;
    single.bars = cache;
    by_threads(rigs.size(), threads,
               [&](std::size_t i) { singles[i] = models::simulate(rigs[i], solver, single); });
  };
  const auto ensemble = [&](int threads) {
    options.threads = threads;
    members = models::simulate_ensemble(rigs, solver, options);
  };
  std::vector<Way> ways = {{"simulate()", [&] { one_by_one(1, nullptr); }},
                           {"simulate(), every core", [&] { one_by_one(cores, nullptr); }},
                           {"simulate(), shared BarCache",
                            [&] {
                              models::BarCache cache;
                              one_by_one(1, &cache);
                            }},
                           {"ensemble, 1 thread", [&] { ensemble(1); }},
                           {"ensemble, every core", [&] { ensemble(0); }, 1}};
  for (int k = 0; k < study.repetitions; ++k)
    for (Way& way : ways) {
      const double started = bench::processor_seconds();
      way.run();
      way.seconds = std::min(way.seconds, bench::processor_seconds() - started);
    }
  double worst = 0.0;
  for (std::size_t i = 0; i < rigs.size(); ++i)
    worst = std::max(worst, deviation(members[i].simulation, singles[i]));

  fmt::print("\n{} parameters vary, accuracy {:g}\n", bars ? "bar and contact" : "contact",
             accuracy);
  nlohmann::ordered_json json = {
      {"varied", bars ? "bar" : "contact"}, {"accuracy", accuracy}, {"deviation", worst}};
  for (const Way& way : ways) {
    const double each = way.seconds / study.members;
    fmt::print("  {:<28} {:>8.1f} us of a core each, {:>8.0f} a second and core, {:>5.2f} times\n",
               way.name, 1e6 * each, 1.0 / each, ways[way.yardstick].seconds / way.seconds);
    json["ways"].push_back({{"name", way.name},
                            {"core_seconds_each", each},
                            {"per_core_second", 1.0 / each},
                            {"times_simulate", ways[way.yardstick].seconds / way.seconds}});
  }
  fmt::print("  largest deviation of peak force, duration, impulse: {:.1e}\n", worst);
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  Study study;
  CLI::App program("Throughput of an ensemble against single runs");
  program.add_option("--members", study.members, "How many")->check(CLI::Range(1, 1000000));
  program.add_option("--repetitions", study.repetitions, "Of each way; the best counts")
      ->check(CLI::Range(1, 1000));
  program.add_option("--seed", study.seed, "Of the parameters")->capture_default_str();
  program.add_option("--accuracy", study.accuracies, "One or several")->capture_default_str();
  program.add_option("-o,--output", study.output, "The figures, as JSON");
  CLI11_PARSE(program, argc, argv);
  try {
    nlohmann::ordered_json json = {{"schema", "impactrig/ensemble/1"},
                                   {"program", datasets::program_version()},
                                   {"members", study.members},
                                   {"repetitions", study.repetitions},
                                   {"seed", study.seed}};
    for (const bool bars : {false, true})
      for (const double accuracy : study.accuracies)
        json["scenes"].push_back(measure(study, accuracy, bars));
    if (!study.output.empty()) std::ofstream(study.output) << json.dump(1) << "\n";
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
