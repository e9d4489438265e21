// SPDX-License-Identifier: BSD-3-Clause
//
// What a fit costs: one synthetic shot of 3000 samples a channel, fitted with 1 to 6 free
// parameters of the physics by the hybrid model and by ANCF, with covariance and everything a
// report needs. Beside the time: simulations, the fitted restitution's miss of the truth in
// standard errors, and the reduced chi-square.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "bench/recorded_shot.hpp"
#include "bench/timing.hpp"
#include "fitting/fit.hpp"
#include "fitting/rig_file.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace impactrig;

constexpr double pre_trigger = 0.3e-3;  // [s]
constexpr double duration = 3e-3;       // [s]

const std::vector<std::string> parameters = {"contact.restitution", "contact.stiffness_factor",
                                             "start.velocity",      "contact.position",
                                             "beam.youngs_modulus", "beam.density"};

void measure(const std::string& path, const std::string& model,
             const std::vector<fitting::Override>& settings, int repeats, int least, int most) {
  const fitting::RigFile rig = fitting::read_rig_file(path, settings);
  const bench::RecordedShot shot =
      bench::record_shot(rig, {.pre_trigger = pre_trigger, .duration = duration});
  const auto impacts =
      acquisition::find_impacts(acquisition::condition(shot.record, bench::sensors_of(rig)));
  for (int count = least; count <= most; ++count)
    for (const bool for_report : {false, true}) {
      fitting::FitOptions options;
      options.for_report = for_report;
      options.free.assign(parameters.begin(), parameters.begin() + count);
      std::vector<double> times, processor;
      fitting::Fit fit;
      for (int k = 0; k < repeats; ++k) {
        const auto started = std::chrono::steady_clock::now();
        const double before = bench::processor_seconds();
        fit = fitting::fit({impacts.at(0)}, rig, options);
        times.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
        processor.push_back(bench::processor_seconds() - before);
      }
      std::ranges::sort(times);
      std::ranges::sort(processor);
      const fitting::Parameter& e = fit.parameters.front();
      fmt::print("{:<14} {:>4} {:<6} {:>9.1f} {:>9.1f} {:>9.1f} {:>5} {:>11} {:>8.2f} {:>10.3f}\n",
                 model, count, for_report ? "report" : "fit", 1e3 * times.front(),
                 1e3 * times[times.size() / 2], 1e3 * processor.front(), fit.iterations,
                 fit.simulations, (e.value - rig.rig.contact.restitution) / e.std_error,
                 fit.goodness.chi2 / static_cast<double>(fit.goodness.dof));
    }
}

}  // namespace

int main(int argc, char** argv) {
  std::string rig = tests::source_dir + "/datasets/samples/shen2007.toml";
  int repeats = 5, least = 1, most = 6;
  bool hybrid_only = false, full = false;
  CLI::App program("What a fit costs against the number of free parameters");
  program.add_option("--rig", rig, "Rig file")->capture_default_str();
  program.add_option("--repeats", repeats, "Of every fit")->check(CLI::Range(1, 1000));
  program.add_option("--parameters", most, "Free parameters at most")->check(CLI::Range(1, 6));
  program.add_option("--from", least, "Free parameters at least")->check(CLI::Range(1, 6));
  program.add_flag("--hybrid-only", hybrid_only, "Without ANCF");
  program.add_flag("--full", full, "A hinge damper of 5 N m s/rad, which takes the full equations");
  CLI11_PARSE(program, argc, argv);
  fmt::print("{:<14} {:>4} {:<6} {:>9} {:>9} {:>9} {:>5} {:>11} {:>8} {:>10}\n", "model", "free",
             "what", "least ms", "median ms", "cpu ms", "steps", "simulations", "miss/se",
             "chi2/dof");
  std::vector<fitting::Override> hybrid = {{"solver.model", "hybrid"}, {"solver.modes", "12"}};
  std::vector<fitting::Override> ancf = {{"solver.elements", "[14, 2]"}};
  if (full)
    for (auto* settings : {&hybrid, &ancf}) settings->emplace_back("hinge.viscous", "5 N*m*s/rad");
  try {
    measure(rig, "hybrid, 12", hybrid, repeats, least, most);
    if (!hybrid_only) measure(rig, "ANCF [14, 2]", ancf, repeats, least, most);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
