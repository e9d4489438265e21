// SPDX-License-Identifier: BSD-3-Clause
//
// Shots of laboratories that no development had in view: bar, material, section, stop, contact and
// damping law, restitution, speed, sampling and sensor are drawn for each, the fit starts from
// e = 0.5, stiffness as the law has it and a speed 30 % off, on an open mesh (of which the truth
// has a finer one), on stated elements or modes, or a rigid bar. Printed of each: whether the 95 %
// intervals hold the truth, how wide they are, the window, reduced chi-square and seconds.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/random_stream.hpp"
#include "acquisition/synthetic.hpp"
#include "bench/recorded_shot.hpp"
#include "fitting/fit.hpp"
#include "fitting/mesh_choice.hpp"
#include "fitting/rig_file.hpp"

namespace {

using namespace impactrig;
using acquisition::RandomStream;

struct Material {
  const char* name;
  double modulus, poisson, density;  // [Pa], [-], [kg/m^3]
};

constexpr Material materials[] = {{"steel", 210e9, 0.30, 7850},    {"aluminium", 70e9, 0.33, 2700},
                                  {"brass", 105e9, 0.34, 8500},    {"PMMA", 3.2e9, 0.37, 1190},
                                  {"titanium", 114e9, 0.34, 4430}, {"nylon", 2.5e9, 0.40, 1140},
                                  {"glass", 70e9, 0.22, 2500}};
constexpr const char* groove_laws[] = {"goldsmith",   "dubowsky-freudenstein",
                                       "esdu-78035",  "johnson",
                                       "radzimovsky", "liu",
                                       "pereira",     "persson",
                                       "hertz-point"};
constexpr const char* cylinder_laws[] = {"goldsmith", "esdu-78035", "radzimovsky", "hertz-point"};
constexpr const char* dampings[] = {
    "lankarani-nikravesh", "exact", "hunt-crossley", "flores", "viscous", "tsuji"};
constexpr const char* solvers[] = {"model = \"ancf\"",
                                   "model = \"ancf\"",
                                   "model = \"ancf\"\nelements = [14, 4]",
                                   "model = \"hybrid\"\nmodes = 12",
                                   "model = \"hybrid\"\nbasis = \"pinned-free\"\nmodes = 15",
                                   "model = \"rigid\""};
constexpr const char* accuracies[] = {"1e-3", "1e-4", "1e-4", "1e-5"};
constexpr double sample_rates[] = {2e5, 5e5, 1e6, 2e6};  // [Hz]
constexpr int high_cuts[] = {50, 100, 200};              // [kHz]

template <typename Item, std::size_t n>
const Item& one_of(RandomStream& random, const Item (&items)[n]) {
  const auto place = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(n)));
  return items[std::min(place, n - 1)];
}

/// The numbers that are fitted.
struct Numbers {
  double restitution, stiffness_factor, speed;  // [-], [-], [m/s]
};

struct Laboratory {
  std::string beam, contact, solver, accuracy, sensors, summary;
  Numbers truth{};
  double sample_rate = 0.0;

  std::string rig(const Numbers& numbers, const std::string& solved_to) const {
    return beam + contact +
           fmt::format(
               "restitution = {}\nstiffness_factor = {}\n[start]\nvelocity = \"{} m/s\"\n"
               "[solver]\n{}\naccuracy = {}\n",
               numbers.restitution, numbers.stiffness_factor, numbers.speed, solver, solved_to) +
           sensors;
  }
};

std::string drawn_section(RandomStream& random, double radius) {
  const double kind = random.uniform(0.0, 3.0), share = random.uniform();
  if (kind < 1.0) return fmt::format("{{ shape = \"circle\", radius = \"{:.3g} mm\" }}", radius);
  if (kind < 2.0)
    return fmt::format("{{ shape = \"tube\", radius = \"{:.3g} mm\", wall = \"{:.3g} mm\" }}",
                       radius, radius * (0.1 + 0.3 * share));
  return fmt::format("{{ shape = \"rectangle\", width = \"{:.3g} mm\", height = \"{:.3g} mm\" }}",
                     radius * (1.6 + 2.4 * share), 2.0 * radius);
}

Laboratory drawn(std::uint64_t seed) {
  RandomStream random(seed, "laboratory");
  const double length = 0.14 * std::pow(11.5, random.uniform());     // [m]
  const double radius = 1e3 * length * random.uniform(0.008, 0.03);  // [mm]
  const Material &bar = one_of(random, materials), &stop = one_of(random, materials);
  const bool groove = random.uniform() < 0.5;
  const std::string law = groove ? one_of(random, groove_laws) : one_of(random, cylinder_laws);
  const std::string damping = one_of(random, dampings);
  Laboratory lab;
  lab.beam = fmt::format(
      "[beam]\nlength = \"{:.4g} m\"\nsection = {}\nyoungs_modulus = \"{} Pa\"\npoisson_ratio = "
      "{}\n"
      "density = \"{} kg/m^3\"\ntheory = \"{}\"\n",
      length, drawn_section(random, radius), bar.modulus, bar.poisson, bar.density,
      random.uniform() < 1.0 / 3.0 ? "timoshenko" : "euler-bernoulli");
  lab.contact = fmt::format(
      "[contact]\nposition = \"{:.4g} m\"\ncounterface = {{ shape = \"{}\", radius = \"{:.4g} mm\" "
      "}}\nlength = \"{:.3g} mm\"\nradius = \"{:.3g} mm\"\ncounter_modulus = \"{} Pa\"\n"
      "counter_poisson_ratio = {}\nlaw = \"{}\"\n{}damping = \"{}\"\n",
      length * random.uniform(0.55, 0.98), groove ? "groove" : "cylinder",
      radius * (groove ? random.uniform(1.05, 2.0) : random.uniform(0.3, 3.0)),
      radius * random.uniform(0.5, 2.0), radius, stop.modulus, stop.poisson, law,
      law == "goldsmith" ? "exponent = 3\n" : "", damping);
  lab.solver = one_of(random, solvers);
  lab.accuracy = one_of(random, accuracies);
  lab.sensors = fmt::format(
      "[sensors.force]\nchannel = \"Force\"\nsensitivity = \"1.000(5) mV/N\"\n"
      "amplifier = {{ gain = \"10\", low_cut = \"0.5 Hz\", high_cut = \"{} kHz\" }}\n"
      "delay = {{ value = \"1.5 us\", uncertainty = \"0.2 us\" }}\n"
      "[sensors.velocity]\nchannel = \"Velocity\"\nsensitivity = \"125.0(6) mm/s/V\"\n"
      "high_cut = \"1 MHz\"\ndelay = {{ value = \"0.4 us\", uncertainty = \"0.1 us\" }}\n",
      one_of(random, high_cuts));
  lab.sample_rate = one_of(random, sample_rates);
  lab.truth = {random.uniform(0.2, 0.92), random.uniform(0.7, 1.4),
               0.05 * std::pow(30.0, random.uniform())};
  lab.summary = fmt::format("{:<9} {:<21} {:<19} {:.4g} m", bar.name, law, damping, length);
  return lab;
}

struct Outcome {
  std::string summary, failure;
  std::array<double, 3> truth{}, value{}, low{}, high{};
  bool converged = false;
  double window = 0.0, reduced = 0.0, seconds = 0.0;
  std::size_t contacts = 0;
};

constexpr std::array names = {"contact.restitution", "contact.stiffness_factor", "start.velocity"};

/// Throws what simulating, recording and fitting throw.
void try_out(std::uint64_t seed, const Laboratory& lab, double duration, Outcome& outcome) {
  constexpr double off = 1.3;  // the start's speed
  fitting::RigFile truth = fitting::parse_rig_file(lab.rig(lab.truth, "1e-8"), "truth.toml");
  fitting::choose_mesh(truth, fitting::finest_mesh);
  const bench::RecordedShot shot = bench::record_shot(
      truth, {.pre_trigger = 1e-3,
              .duration = duration,
              .sample_rate = lab.sample_rate,
              .accuracy = 1e-8,
              .change = [&](acquisition::SyntheticOptions& options, double) {
                options.seed = seed;
                acquisition::draw_calibration_errors(bench::sensors_of(truth), seed, options);
              }});
  const auto started = std::chrono::steady_clock::now();
  const Numbers start{0.5, 1.0, off * lab.truth.speed};
  fitting::RigFile rig = fitting::parse_rig_file(lab.rig(start, lab.accuracy), "rig.toml");
  const std::vector<datasets::Impact> impacts =
      acquisition::find_impacts(acquisition::condition(shot.record, bench::sensors_of(rig)));
  fitting::choose_mesh(rig, fitting::finest_mesh_of_fits);
  const fitting::Fit fit = fitting::fit({impacts.at(0)}, rig);
  outcome.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  outcome.truth = {lab.truth.restitution, lab.truth.stiffness_factor, lab.truth.speed};
  for (std::size_t k = 0; k < names.size(); ++k)
    for (const fitting::Parameter& p : fit.parameters) {
      if (p.name != names[k]) continue;
      outcome.value[k] = p.value;
      const bool known = p.identifiable;
      outcome.low[k] = known ? p.ci95[0] : -std::numeric_limits<double>::infinity();
      outcome.high[k] = known ? p.ci95[1] : std::numeric_limits<double>::infinity();
    }
  outcome.converged = fit.termination == "converged";
  outcome.window = fit.window;
  outcome.contacts = fit.predictions.at(0).episodes.size();
  outcome.reduced = fit.goodness.chi2 / static_cast<double>(fit.goodness.dof);
}

bool holds(const Outcome& o, std::size_t k) {
  return o.low[k] <= o.truth[k] && o.truth[k] <= o.high[k];
}

void print(std::uint64_t seed, const Outcome& o) {
  fmt::print("{:>5} {:<62}", seed, o.summary);
  if (!o.failure.empty()) {
    fmt::print("{}\n", o.failure);
    return;
  }
  for (std::size_t k = 0; k < names.size(); ++k)
    fmt::print(" {:>8.4g} ({:.4g}) ± {:<7.2g}{}", o.value[k], o.truth[k],
               0.5 * (o.high[k] - o.low[k]), holds(o, k) ? ' ' : '!');
  fmt::print("{:>3} contacts {:>5.2f} ms chi2 {:>7.3g} {:>6.2f} s{}\n", o.contacts, 1e3 * o.window,
             o.reduced, o.seconds, o.converged ? "" : " not converged");
}

}  // namespace

int main(int count, char** arguments) {
  CLI::App program("Fits of shots from laboratories drawn at random");
  std::uint64_t seed = 1;
  int shots = 60;
  double duration = 6e-3;
  std::string output;
  program.add_option("--seed", seed, "Of the first")->capture_default_str();
  program.add_option("--shots", shots, "How many, each of a laboratory of its own")
      ->capture_default_str();
  program.add_option("--duration", duration, "Recorded, 1 ms of it before touch [s]")
      ->capture_default_str();
  program.add_option("-o,--output", output, "Figures (JSON)");
  CLI11_PARSE(program, count, arguments);

  std::array<int, 3> inside{};
  int fitted = 0;
  double longest = 0.0, sum = 0.0;
  nlohmann::ordered_json table = nlohmann::ordered_json::array();
  for (int k = 0; k < shots; ++k) {
    const std::uint64_t number = seed + static_cast<std::uint64_t>(k);
    const Laboratory lab = drawn(number);
    Outcome outcome;
    outcome.summary = lab.summary;
    try {
      try_out(number, lab, duration, outcome);
    } catch (const std::exception& error) {
      outcome.failure = error.what();
    }
    print(number, outcome);
    std::fflush(stdout);
    table.push_back(
        {{"seed", number}, {"laboratory", outcome.summary}, {"failure", outcome.failure}});
    if (!outcome.failure.empty()) continue;
    ++fitted;
    sum += outcome.seconds;
    longest = std::max(longest, outcome.seconds);
    for (std::size_t i = 0; i < names.size(); ++i) {
      inside[i] += holds(outcome, i) ? 1 : 0;
      table.back()[names[i]] = {{"truth", outcome.truth[i]},
                                {"value", outcome.value[i]},
                                {"ci95", {outcome.low[i], outcome.high[i]}}};
    }
    table.back()["window_s"] = outcome.window;
    table.back()["reduced_chi2"] = outcome.reduced;
    table.back()["seconds"] = outcome.seconds;
  }
  fmt::print("{} of {} fitted; intervals hold the truth of", fitted, shots);
  for (std::size_t i = 0; i < names.size(); ++i) fmt::print(" {} {},", names[i], inside[i]);
  fmt::print(" {:.2g} s a fit, {:.2g} s at most\n", sum / std::max(1, fitted), longest);
  if (!output.empty()) std::ofstream(output) << table.dump(1) << "\n";
}
