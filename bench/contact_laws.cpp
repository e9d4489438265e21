// SPDX-License-Identifier: BSD-3-Clause
// Nanoseconds an evaluation of every contact law takes, and how exact the closed inverse is.
//
//   bench_contact_laws [-o laws.json]
//
// Penetrations are drawn over twelve decades, so that no branch is guessed; the time is that of a
// loop over them, the quickest of several.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "models/contact/contact_force.hpp"

namespace {

using namespace impactrig;
using nlohmann::json;

constexpr double mass = 0.7, speed = 0.441;  // [kg], [m/s]: the paper's rigid bar

models::Contact paper_contact(std::string_view law) {
  return {.position = 0.69,
          .counterface = models::Counterface::groove,
          .radius = 0.015,
          .counter_radius = 0.0175,
          .length = 0.02,
          .modulus = 6.8952e10,
          .poisson_ratio = 0.3,
          .counter_modulus = 6.8952e10,
          .counter_poisson_ratio = 0.3,
          .law = std::string(law),
          .stiffness = law == "linear" ? 1.4e8 : 3e9,
          .power = law == "linear" ? 1.0 : 1.25,
          .damping = "exact",
          .restitution = 0.5};
}

/// Of the logarithms evenly, from a hundred-millionth of the paper's depth on.
std::vector<double> spread_depths(double deepest) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> decades(-12.0, 0.0);
  std::vector<double> depths(4096);
  for (double& depth : depths) depth = deepest * std::pow(10.0, decades(random));
  return depths;
}

double sink = 0.0;  // read at the end: nothing is computed in vain

/// Nanoseconds of one call.
template <typename Call>
double nanoseconds(const std::vector<double>& at, const Call& call) {
  const double seconds = bench::quickest([&] {
    double sum = 0.0;
    for (const double x : at) sum += call(x);
    sink += sum;
  });
  return 1e9 * seconds / static_cast<double>(at.size());
}

/// Largest error of f(δ), in units in the last place times the condition u / (u − 1).
double worst_inverse(const models::LogarithmicContact<>& law) {
  const models::LogarithmicContact<long double> exact{law.compliance, law.limit_force};
  long double worst = 0.0;
  for (const double part : spread_depths(1.0)) {
    const double x = part * law.limit_penetration();
    const long double u = exact.bracket(x);
    const long double off = std::abs(law.force(x) / exact.force(x) - 1.0L);
    worst = std::max(worst, off / std::numeric_limits<double>::epsilon() * (u - 1.0L) / u);
  }
  return static_cast<double>(worst);
}

json time_elastic(std::string_view name) {
  const models::ElasticLaw any = models::elastic_law(paper_contact(name));
  return std::visit(
      [&](const auto& law) {
        const double depth = law.penetration_storing(0.5 * mass * speed * speed);
        const std::vector<double> depths = spread_depths(depth);
        std::vector<double> forces, energies;
        for (const double x : depths) {
          forces.push_back(law.force(x));
          energies.push_back(law.energy(x));
        }
        json row = {
            {"law", name},
            {"force_ns", nanoseconds(depths, [&](double x) { return law.force(x); })},
            {"force_and_stiffness_ns", nanoseconds(depths,
                                                   [&](double x) {
                                                     const auto both = law.force_and_stiffness(x);
                                                     return both.force + both.stiffness;
                                                   })},
            {"energy_ns", nanoseconds(depths, [&](double x) { return law.energy(x); })},
            {"penetration_ns", nanoseconds(forces, [&](double f) { return law.penetration(f); })},
            {"penetration_storing_ns",
             nanoseconds(energies, [&](double u) { return law.penetration_storing(u); })}};
        if constexpr (std::is_same_v<std::decay_t<decltype(law)>, models::LogarithmicContact<>>)
          row["inverse_ulp_per_condition"] = worst_inverse(law);
        return row;
      },
      any);
}

json time_damping(std::string_view name) {
  models::Contact contact = paper_contact("goldsmith");
  contact.damping = name;
  contact.restitution = 0.8;  // the implicit laws know no small ones
  models::ContactForce force(contact, mass);
  force.begin_episode(speed);
  force.set_phase(models::ContactForce::Phase::pressed);
  const std::vector<double> depths = spread_depths(3e-5);
  const double begin = bench::quickest([&] {
    models::ContactForce other(contact, mass);
    other.begin_episode(speed);
    sink += other.strength();
  });
  return {{"law", name},
          {"force_with_derivatives_ns", nanoseconds(depths,
                                                    [&](double x) {
                                                      const auto law = force.pressed(x, 0.1);
                                                      return law.force + law.to_depth + law.to_rate;
                                                    })},
          {"first_contact_us", 1e6 * begin}};
}

}  // namespace

int main(int argc, char** argv) {
  std::string output;
  CLI::App program("Nanoseconds an evaluation of every contact law takes");
  program.add_option("-o,--output", output, "The same as JSON");
  CLI11_PARSE(program, argc, argv);
  json elastic = json::array(), damping = json::array();
  fmt::print("{:<30}{:>8}{:>10}{:>8}{:>8}{:>8}{:>16}   [ns]\n", "elastic law", "f(d)", "f, df/dd",
             "U(d)", "d(f)", "d(U)", "ulp/condition");
  for (const models::ElasticLawEntry& entry : models::elastic_laws()) {
    const json& row = elastic.emplace_back(time_elastic(entry.text.name));
    fmt::print("{:<30}{:>8.1f}{:>10.1f}{:>8.1f}{:>8.1f}{:>8.1f}", entry.text.name,
               row["force_ns"].get<double>(), row["force_and_stiffness_ns"].get<double>(),
               row["energy_ns"].get<double>(), row["penetration_ns"].get<double>(),
               row["penetration_storing_ns"].get<double>());
    if (row.contains("inverse_ulp_per_condition"))
      fmt::print("{:>16.2f}", row["inverse_ulp_per_condition"].get<double>());
    fmt::print("\n");
  }
  fmt::print("\n{:<30}{:>10}{:>20}   beside goldsmith\n", "damping law", "f, df [ns]",
             "first contact [us]");
  for (const models::DampingLaw& law : models::damping_laws()) {
    const json& row = damping.emplace_back(time_damping(law.text.name));
    fmt::print("{:<30}{:>10.1f}{:>20.2f}\n", law.text.name,
               row["force_with_derivatives_ns"].get<double>(),
               row["first_contact_us"].get<double>());
  }
  if (!std::isfinite(sink)) return 1;
  if (output.empty()) return 0;
  std::ofstream(output) << json{{"schema", "impactrig/bench-contact-laws/1"},
                                {"elastic", elastic},
                                {"damping", damping}}
                               .dump(2)
                        << '\n';
}
