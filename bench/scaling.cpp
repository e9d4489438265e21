// SPDX-License-Identifier: BSD-3-Clause
//
// What a run of simulate() takes, and what for: against the number of ANCF elements, against the
// number of contacts, against the time between them, and with and without each simplification.
// Processor time of a call, the bar's set-up included, the quickest of several; explain() times
// likewise. All scenes are the paper's, changed as their names say. Bounces: ANCF [7, 1], small
// motion, damping "exact"; gravity pulls the bar back to the stop. With gravity g and a duration
// proportional to 1/g the flights grow longer and the contacts hardly more. With so many bounces
// every error is magnified: how many there are differs from method to method.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/log_plot.hpp"
#include "bench/timing.hpp"
#include "datasets/record.hpp"
#include "fitting/rig_file.hpp"
#include "models/explain.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/simulation.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace impactrig;
using Json = nlohmann::ordered_json;

struct Study {
  std::string rig = tests::source_dir + "/datasets/samples/shen2007.toml";
  std::vector<std::string> parts = {"elements", "contacts", "simplifications"};
  int most_elements = 1024;
  std::string output, plot;

  fitting::RigFile read(const std::vector<fitting::Override>& overrides) const {
    return fitting::read_rig_file(rig, overrides);
  }
};

constexpr double longest_without = 20.0;  // of a run without a simplification [s]

/// A run of a series, by the size of its task.
struct Point {
  double size = 0.0;
  double seconds = 0.0;
  long steps = 0, rejected = 0, contacts = 0;
  double simulated = 0.0;  ///< [s]
};

struct Series {
  std::string name;
  const char* colour;
  bool dashed;
  std::vector<Point> points = {};
};

using Number = std::function<double(const Point&)>;

double size_of(const Point& point) {
  return point.size;
}

double contacts_of(const Point& point) {
  return static_cast<double>(point.contacts);
}

double simulated_of(const Point& point) {
  return point.simulated;
}

double seconds_of(const Point& point) {
  return point.seconds;
}

double milliseconds_of(const Point& point) {
  return 1e3 * point.seconds;
}

double microseconds_a_contact(const Point& point) {
  return 1e6 * point.seconds / contacts_of(point);
}

double steps_of(const Point& point) {
  return static_cast<double>(point.steps);
}

/// Exponent of how one number grows with another: slope of least squares on logarithms.
double exponent(const std::vector<Point>& points, const Number& number,
                const Number& grown = seconds_of) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const Point& point : points) {
    const double a = std::log(number(point)), b = std::log(grown(point));
    n += 1.0;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

Point measure(double size, const models::Rig& rig, const models::Solver& solver,
              const models::SimulationOptions& options) {
  models::Simulation run;
  const double seconds = bench::quickest([&] { run = models::simulate(rig, solver, options); });
  return {.size = size,
          .seconds = seconds,
          .steps = run.cost.steps,
          .rejected = run.cost.rejected,
          .contacts = static_cast<long>(run.episodes.size()),
          .simulated = run.duration};
}

Json to_json(const Series& series) {
  Json json = {{"name", series.name}};
  for (const Point& point : series.points)
    json["points"].push_back({{"size", point.size},
                              {"seconds", point.seconds},
                              {"steps", point.steps},
                              {"rejected", point.rejected},
                              {"contacts", point.contacts},
                              {"simulated_s", point.simulated}});
  return json;
}

/// One number of each point against another.
struct Panel {
  std::string title;
  std::string x_label, y_label;
  Number x, y;
};

bench::LogPlot plot(const std::vector<Series>& all, const Panel& panel) {
  bench::LogPlot plot{
      .title = panel.title, .x_label = panel.x_label, .y_label = panel.y_label, .curves = {}};
  for (const Series& series : all) {
    bench::LogCurve curve{series.name, {}, {}, series.colour, series.dashed};
    for (const Point& point : series.points) {
      curve.x.push_back(panel.x(point));
      curve.y.push_back(panel.y(point));
    }
    plot.curves.push_back(curve);
  }
  return plot;
}

// Elements.

enum class Equations { full, small, small_known };

Series measure_elements(const Study& study, double accuracy, Equations equations, Series series) {
  models::BarCache known;
  models::SimulationOptions options;
  options.exact = equations == Equations::full;
  if (!options.exact) options.motion = models::Motion::small;
  if (equations == Equations::small_known) options.bars = &known;
  for (int elements = 8; elements <= study.most_elements; elements *= 2) {
    fitting::RigFile file =
        study.read({{"solver.elements", fmt::format("[{}, {}]", elements / 8 * 7, elements / 8)},
                    {"solver.duration", "3 ms"}});
    file.solver.accuracy = accuracy;
    if (options.bars) models::simulate(file.rig, file.solver, options);  // finds them
    series.points.push_back(measure(elements, file.rig, file.solver, options));
  }
  return series;
}

void print_elements(const Series& series) {
  const std::vector<Point> finest(series.points.end() - 3, series.points.end());
  fmt::print(
      "\n{}: time grows as elements^{:.2f}, over the last three as ^{:.2f}; steps as ^{:.2f}",
      series.name, exponent(series.points, size_of), exponent(finest, size_of),
      exponent(series.points, size_of, steps_of));
  fmt::print("\n  {:>8}{:>12}{:>9}{:>10}{:>12}{:>26}\n", "elements", "ms", "steps", "rejected",
             "us a step", "ns a step and element");
  for (const Point& point : series.points) {
    const double step = point.seconds / static_cast<double>(point.steps);
    fmt::print("  {:>8}{:>12.3f}{:>9}{:>10}{:>12.2f}{:>26.1f}\n", point.size, 1e3 * point.seconds,
               point.steps, point.rejected, 1e6 * step, 1e9 * step / point.size);
  }
}

void run_elements(const Study& study, Json& json, std::vector<bench::LogPlot>& plots) {
  fmt::print("Elements: the paper's scene, 3 ms\n");
  std::vector<Series> all;
  const auto add = [&](double accuracy, Equations equations, const Series& series) {
    all.push_back(measure_elements(study, accuracy, equations, series));
    print_elements(all.back());
    std::fflush(stdout);
    json["elements"].push_back(to_json(all.back()));
    json["elements"].back()["exponent"] = exponent(all.back().points, size_of);
  };
  // Okabe and Ito 2008
  add(1e-3, Equations::full, {"full equations, 1e-3", "#0f4584", false});
  add(1e-6, Equations::full, {"full equations, 1e-6", "#0f4584", true});
  add(1e-3, Equations::small, {"small motion, 1e-3", "#d55e00", false});
  add(1e-6, Equations::small, {"small motion, 1e-6", "#d55e00", true});
  add(1e-3, Equations::small_known, {"modes known, 1e-3", "#009e73", false});
  add(1e-6, Equations::small_known, {"modes known, 1e-6", "#009e73", true});
  plots.push_back(plot(
      all, {"Paper's scene, 3 ms", "elements", "processor time [ms]", size_of, milliseconds_of}));
}

// Contacts.

Point measure_bounces(const Study& study, double gravity, double duration, bool at_once) {
  fitting::RigFile file = study.read({{"solver.elements", "[7, 1]"},
                                      {"contact.damping", "exact"},
                                      {"contact.restitution", "0.95"}});
  file.rig.gravity = gravity;
  file.solver.duration = duration;
  models::SimulationOptions options;
  options.motion = models::Motion::small;
  if (!at_once) options.kept = {models::Simplification::flight_at_once};
  return measure(gravity, file.rig, file.solver, options);
}

void print_bounces(const Series& series, const Number& number, const char* of) {
  fmt::print("\n{}: time grows as {}^{:.2f}\n", series.name, of, exponent(series.points, number));
  fmt::print("  {:>10}{:>12}{:>10}{:>10}{:>12}{:>15}{:>20}\n", "g [m/s^2]", "simulated s",
             "contacts", "steps", "ms", "us a contact", "ms a simulated s");
  for (const Point& point : series.points)
    fmt::print("  {:>10.3g}{:>12.3g}{:>10}{:>10}{:>12.3f}{:>15.2f}{:>20.3f}\n", point.size,
               point.simulated, point.contacts, point.steps, milliseconds_of(point),
               microseconds_a_contact(point), milliseconds_of(point) / point.simulated);
}

/// Flights at once and in steps, of one family of scenes.
std::vector<Series> measure_family(const std::function<Point(double, bool)>& scene,
                                   const std::vector<double>& times) {
  std::vector<Series> all = {{"flights at once", "#cc79a7", false},
                             {"flights in steps", "#cc79a7", true}};
  for (Series& series : all)
    for (const double time : times) series.points.push_back(scene(time, &series == &all.front()));
  return all;
}

void run_contacts(const Study& study, Json& json, std::vector<bench::LogPlot>& plots) {
  const double g = 9.81;
  const auto longer = [&](double time, bool at_once) {
    return measure_bounces(study, g, time, at_once);
  };
  const auto slower = [&](double time, bool at_once) {
    return measure_bounces(study, g / time, time, at_once);
  };
  const std::vector<double> times = {0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0};
  const std::vector<Series> by_contacts = measure_family(longer, times);
  const std::vector<Series> by_time = measure_family(slower, times);
  fmt::print("\nBounces, the longer the more\n");
  for (const Series& series : by_contacts) {
    print_bounces(series, contacts_of, "contacts");
    json["bounces"].push_back(to_json(series));
    json["bounces"].back()["exponent_of_contacts"] = exponent(series.points, contacts_of);
    json["bounces"].back()["exponent_of_time"] = exponent(series.points, simulated_of);
  }
  fmt::print("\nBounces with longer flights: g lower, durations longer\n");
  for (const Series& series : by_time) {
    print_bounces(series, simulated_of, "simulated time");
    json["slow_bounces"].push_back(to_json(series));
    json["slow_bounces"].back()["exponent_of_time"] = exponent(series.points, simulated_of);
  }
  plots.push_back(plot(by_contacts, {"Bounces, 0.2 s to 20 s", "contacts", "processor time [ms]",
                                     contacts_of, milliseconds_of}));
  plots.push_back(
      plot(by_time, {"Bounces with longer flights", "simulated time [s]",
                     "processor time a contact [us]", simulated_of, microseconds_a_contact}));
}

// Simplifications.

struct Scene {
  const char* name;
  std::vector<fitting::Override> overrides;
  std::optional<double> release = {};  // instead of the paper's speed [rad]
  bool stop = true;
};

const std::vector<Scene> scenes = {
    {"paper's, ANCF [14, 2], 3 ms", {{"solver.elements", "[14, 2]"}}},
    {"paper's, ANCF [56, 8], 3 ms", {{"solver.elements", "[56, 8]"}}},
    {"paper's, ANCF [448, 64], 3 ms", {{"solver.elements", "[448, 64]"}}},
    {"paper's, 12 modes, 3 ms, 1e-6",
     {{"solver.model", "hybrid"}, {"solver.modes", "12"}, {"solver.accuracy", "1e-6"}}},
    {"hinge friction 0.1 mN m, ANCF [14, 2], 3 ms",
     {{"solver.elements", "[14, 2]"}, {"hinge.friction", "0.1 mN.m"}}},
    {"released at 0.1 rad, ANCF [14, 2], 3 ms", {{"solver.elements", "[14, 2]"}}, 0.1},
    {"released at 0.1 rad, rigid, 3 ms", {{"solver.model", "rigid"}}, 0.1},
    {"released at 0.1 rad, 100 us of damping, ANCF [14, 2], 3 ms",
     {{"solver.elements", "[14, 2]"}, {"beam.damping.stiffness", "100 us"}},
     0.1},
    {"released at 1 rad, 1 us of damping, ANCF [14, 2], 3 ms",
     {{"solver.elements", "[14, 2]"}, {"beam.damping.stiffness", "1 us"}},
     1.0},
    {"bouncing for 1 s, e = 0.95, ANCF [7, 1]",
     {{"solver.elements", "[7, 1]"},
      {"contact.damping", "exact"},
      {"contact.restitution", "0.95"},
      {"solver.duration", "1 s"}}},
    {"pulled into the stop, ANCF [14, 2], 3 ms",
     {{"solver.elements", "[14, 2]"}, {"environment.gravity_direction", "90 deg"}}},
    {"leaning by 5 degrees, bouncing for 1 s, e = 0.8, ANCF [14, 2]",
     {{"solver.elements", "[14, 2]"},
      {"environment.gravity_direction", "5 deg"},
      {"contact.restitution", "0.8"},
      {"solver.duration", "1 s"}}},
    {"no stop, released at 0.3 rad, 8 ANCF elements, 1 s",
     {{"solver.duration", "1 s"}},
     0.3,
     false},
};

std::vector<models::Explanation> explain(const Study& study, const Scene& scene) {
  std::vector<fitting::Override> overrides = {{"solver.accuracy", "1e-4"}};
  for (const fitting::Override& override : scene.overrides) overrides.push_back(override);
  fitting::RigFile file = study.read(overrides);
  file.rig.start.release_angle = scene.release;
  if (!scene.stop) {
    file.rig.contact.law = "none";
    file.rig.contact.position = file.rig.beam.length;
    file.solver.elements = {8, 0};
  }
  return models::explain(file.rig, file.solver, {}, longest_without);
}

void print_explanation(const models::Explanation& found) {
  const auto change = [](double value) {
    return std::isnan(value) ? std::string("-") : fmt::format("{:.1e}", value);
  };
  fmt::print("  {:<16}", name(found.what));
  if (!found.failure.empty()) {
    fmt::print("without it: {}\n", found.failure);
    return;
  }
  fmt::print("{:>10}{:>10}{:>10}{:>11.3f}{:>13.3f}{:>8.1f}\n", change(found.peak_force),
             change(found.duration), change(found.impulse), 1e3 * found.seconds,
             1e3 * found.seconds_without, found.seconds_without / found.seconds);
}

Json to_json(const models::Explanation& found) {
  return {{"what", std::string(name(found.what))},
          {"sentence", found.sentence},
          {"peak_force", found.peak_force},
          {"duration", found.duration},
          {"impulse", found.impulse},
          {"seconds", found.seconds},
          {"seconds_without", found.seconds_without},
          {"failure", found.failure}};
}

void run_simplifications(const Study& study, Json& json) {
  fmt::print("\nSimplifications: change of the first contact, accuracy 1e-4 unless stated\n");
  for (const Scene& scene : scenes) {
    fmt::print("\n{}\n  {:<16}{:>10}{:>10}{:>10}{:>11}{:>13}{:>8}\n", scene.name, "", "peak",
               "duration", "impulse", "ms", "ms without", "times");
    Json found = {{"scene", scene.name}};
    for (const models::Explanation& explanation : explain(study, scene)) {
      print_explanation(explanation);
      found["explanations"].push_back(to_json(explanation));
    }
    json["simplifications"].push_back(found);
  }
}

void run(const Study& study) {
  Json json = {{"schema", "impactrig/scaling/1"},
               {"program", datasets::program_version()},
               {"rig", study.rig}};
  std::vector<bench::LogPlot> plots;
  const auto asked = [&](const char* part) { return std::ranges::count(study.parts, part) > 0; };
  if (asked("elements")) run_elements(study, json, plots);
  if (asked("contacts")) run_contacts(study, json, plots);
  if (asked("simplifications")) run_simplifications(study, json);
  if (!study.output.empty()) std::ofstream(study.output) << json.dump(1) << "\n";
  if (!study.plot.empty()) std::ofstream(study.plot) << bench::log_svg(plots);
}

}  // namespace

int main(int argc, char** argv) {
  Study study;
  CLI::App program("What a run takes against elements, contacts and simplifications");
  program.add_option("--rig", study.rig, "Rig file")->capture_default_str();
  program.add_option("--parts", study.parts, "Some of elements, contacts, simplifications")
      ->check(CLI::IsMember({"elements", "contacts", "simplifications"}))
      ->delimiter(',');
  program.add_option("--most-elements", study.most_elements, "Doubled from 8 up to this")
      ->check(CLI::Range(32, 4096))
      ->capture_default_str();
  program.add_option("-o,--output", study.output, "The figures, as JSON");
  program.add_option("--plot", study.plot, "Time against elements, contacts, duration, as SVG");
  CLI11_PARSE(program, argc, argv);
  try {
    run(study);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
