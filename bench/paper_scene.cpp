// SPDX-License-Identifier: BSD-3-Clause
//
// The scene of Shen et al. (2007) by every model, damped and undamped, exponent 1 and 3. Each run
// is made at two accuracies a hundredfold apart; a number is printed to the last digit on which
// both agree, so that every digit shown is converged in time. The mesh or the modes are those
// named: their error is what the lines differ by.

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "fitting/rig_file.hpp"
#include "models/simulation.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace impactrig;

constexpr double coarse = 1e-9;
constexpr double fine = 1e-11;

/// `value` to the digits that a second value confirms; at most nine.
std::string confirmed(double value, double again) {
  const double difference = std::abs(value - again);
  for (int digits = 9; digits > 1; --digits) {
    const double last = std::pow(10.0, std::floor(std::log10(std::abs(value))) - digits + 1);
    if (2.0 * difference < last) return fmt::format("{:.{}g}", value, digits);
  }
  return "?";
}

struct Case {
  std::string label;
  std::vector<fitting::Override> overrides;
};

std::vector<Case> cases() {
  std::vector<Case> list = {{"rigid", {{"solver.model", "rigid"}}}};
  for (const char* basis : {"cantilever", "pinned-free"})
    for (int modes = 1; modes <= 12; ++modes)
      list.push_back({fmt::format("hybrid {:<11} n = {}", basis, modes),
                      {{"solver.model", "hybrid"},
                       {"solver.basis", basis},
                       {"solver.modes", std::to_string(modes)}}});
  for (const char* elements : {"[7, 1]", "[14, 2]", "[28, 4]"})
    list.push_back({fmt::format("ancf {}", elements),
                    {{"solver.model", "ancf"}, {"solver.elements", elements}}});
  return list;
}

void print_case(const Case& c, const char* damping, const char* exponent, double& worst_imbalance) {
  std::vector<fitting::Override> overrides = c.overrides;
  overrides.push_back({"contact.damping", damping});
  overrides.push_back({"contact.exponent", exponent});
  const fitting::RigFile rig =
      fitting::read_rig_file(tests::source_dir + "/datasets/samples/shen2007.toml", overrides);
  models::Solver solver = rig.solver;
  solver.accuracy = coarse;
  const models::Simulation a = models::simulate(rig.rig, solver);
  solver.accuracy = fine;
  const models::Simulation b = models::simulate(rig.rig, solver);
  const models::Episode& e = b.episodes.front();
  const models::Episode& f = a.episodes.front();
  worst_imbalance = std::max(worst_imbalance, std::abs(b.energy.imbalance));
  fmt::print("  {:<26}{:>13}{:>13}{:>14}{:>14}{:>9}\n", c.label,
             confirmed(b.peak_force, a.peak_force), confirmed(1e6 * e.end, 1e6 * f.end),
             confirmed(e.impulse, f.impulse),
             confirmed(e.separation_velocity, f.separation_velocity), b.episodes.size());
}

}  // namespace

int main() {
  double worst_imbalance = 0.0;
  for (const char* exponent : {"1", "3"})
    for (const char* damping : {"none", "lankarani-nikravesh"}) {
      fmt::print("\nexponent {}, damping {}, 3 ms\n", exponent, damping);
      fmt::print("  {:<26}{:>13}{:>13}{:>14}{:>14}{:>9}\n", "model", "peak [N]", "contact [us]",
                 "impulse [N s]", "leaves [m/s]", "contacts");
      for (const Case& c : cases()) print_case(c, damping, exponent, worst_imbalance);
    }
  fmt::print("\nworst energy imbalance at accuracy {:g}: {:.1e} of the initial kinetic energy\n",
             fine, worst_imbalance);
}
