// SPDX-License-Identifier: BSD-3-Clause
//
// Error against time: models::simulate() and SUNDIALS on the same equations of the same meshes. An
// error is the largest of the relative errors of peak force (over the run), duration and impulse of
// the first contact, against models::simulate() with exact = true at accuracy 1e-12. That reference
// counts as converged only as far as a second run at 1e-13 confirms it, and errors below three
// times their difference are not claimed; how far CVODE at tolerance 1e-12 is from it is printed as
// an independent check. simulate() is judged as called: set-up of the bar included, one setting for
// each accuracy. SUNDIALS is judged by hindsight: orders, tables, tolerances and their ratio are
// swept, and for each error the fastest run that reached it counts. Its steps are its own choice,
// its events its own root finding, its peaks its own interpolant. Right-hand sides are the same
// code for all; those spent on Jacobians and interpolants are counted. Without `exact`, an
// evaluation of simulate() may be another, cheaper thing.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/log_plot.hpp"
#include "bench/sundials_impact.hpp"
#include "bench/timing.hpp"
#include "datasets/record.hpp"
#include "fitting/rig_file.hpp"
#include "models/simulation.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace impactrig;
using Json = nlohmann::ordered_json;

struct Study {
  std::string rig = tests::source_dir + "/datasets/samples/shen2007.toml";
  std::vector<std::string> scenes;
  int runs = 7;
  double time_limit = 2.0;
  std::string output, plot;
};

struct SceneChoice {
  const char* name;
  const char* description;
  std::vector<fitting::Override> overrides;
};

const std::vector<SceneChoice> scene_choices = {
    {"paper", "ANCF [14, 2]", {{"solver.elements", "[14, 2]"}}},
    {"hybrid", "hybrid, 12 modes", {{"solver.model", "hybrid"}, {"solver.modes", "12"}}},
    {"ancf32", "ANCF [28, 4]", {{"solver.elements", "[28, 4]"}}},
};

/// What a run is judged by.
struct Observed {
  double peak = 0.0, duration = 0.0, impulse = 0.0;
  long evaluations = 0, steps = 0;
  std::string failure{};
};

struct Point {
  std::string method, setting;
  double asked = 0.0;  ///< accuracy or relative tolerance
  double error = 0.0;  ///< largest of the three
  Observed observed;
  double fastest = 0.0, median = 0.0;  ///< [s]
};

struct Method {
  const char* name;
  const char* colour;
  bool dashed;
};

// Okabe and Ito 2008
constexpr std::array methods = {
    Method{"simulate()", "#0f4584", false}, Method{"simulate(), exact", "#0f4584", true},
    Method{"CVODE Adams", "#009e73", false}, Method{"CVODE BDF", "#cc79a7", false},
    Method{"ARKODE ERK", "#d55e00", false}};

Observed observe(const models::Simulation& run) {
  const models::Episode& first = run.episodes.at(0);
  return {.peak = run.peak_force,
          .duration = first.end,
          .impulse = first.impulse,
          .evaluations = run.cost.evaluations,
          .steps = run.cost.steps};
}

double largest_difference(const Observed& a, const Observed& b) {
  const auto relative = [](double x, double y) { return std::abs(x / y - 1.0); };
  const double largest = std::max(
      {relative(a.peak, b.peak), relative(a.duration, b.duration), relative(a.impulse, b.impulse)});
  return std::isfinite(largest) ? largest : 1.0;
}

class SceneStudy {
 public:
  SceneStudy(const Study& study, const SceneChoice& choice)
      : study_(study),
        choice_(choice),
        file_(fitting::read_rig_file(study.rig, choice.overrides)) {}

  void run() {
    find_reference();
    for (const bool exact : {false, true})
      for (int digits = 3; digits <= 10; ++digits) measure_own(std::pow(10.0, -digits), exact);
    sweep("CVODE Adams", {.method = bench::SundialsMethod::adams}, "");
    for (const int order : {2, 5})
      for (const int band : {0, 3})
        if (band == 0 || file_.solver.model == models::BeamModel::ancf)
          sweep("CVODE BDF",
                {.method = bench::SundialsMethod::bdf, .most_order = order, .band_nodes = band},
                fmt::format("order {}, {}", order, band > 0 ? "band" : "dense"));
    for (const auto& [table, name] :
         {std::pair{"ARKODE_DORMAND_PRINCE_7_4_5", "Dormand-Prince 5(4)"},
          std::pair{"ARKODE_CASH_KARP_6_4_5", "Cash-Karp 5(4)"},
          std::pair{"ARKODE_FEHLBERG_13_7_8", "Fehlberg 8(7)"}})
      sweep("ARKODE ERK", {.method = bench::SundialsMethod::erk, .table = table}, name);
  }

  void print() const;
  Json to_json() const;
  bench::LogPlot plot() const;

 private:
  models::Simulation simulate(double accuracy, bool exact) const {
    models::Solver solver = file_.solver;
    solver.accuracy = accuracy;
    models::SimulationOptions options;
    options.exact = exact;
    return models::simulate(file_.rig, solver, options);
  }

  void find_reference() {
    reference_ = observe(simulate(1e-12, true));
    confirmed_ = largest_difference(observe(simulate(1e-13, true)), reference_);
    const Observed other =
        sundials({.method = bench::SundialsMethod::adams, .tolerance = 1e-12, .time_limit = 60.0});
    independent_ = other.failure.empty() ? largest_difference(other, reference_) : 1.0;
  }

  Observed sundials(const bench::SundialsSettings& settings) const {
    const bench::SundialsRun run = bench::run_sundials(file_.rig, file_.solver, settings);
    return {.peak = run.peak_force,
            .duration = run.first_end,
            .impulse = run.first_impulse,
            .evaluations = run.evaluations,
            .steps = run.steps,
            .failure = run.failure};
  }

  double resolved(double error) const { return std::max(error, 3.0 * confirmed_); }

  /// Runs often enough for a stable minimum. `call` gives what it saw; its time is measured here.
  Point timed(const std::function<Observed()>& call) const {
    Point point;
    std::vector<double> times;
    double spent = 0.0;
    for (int k = 0; k < study_.runs; ++k) {
      const double started = bench::processor_seconds();
      point.observed = call();
      times.push_back(bench::processor_seconds() - started);
      spent += times.back();
      if (!point.observed.failure.empty() || (k >= 2 && spent > 1.0)) break;
    }
    std::ranges::sort(times);
    point.fastest = times.front();
    point.median = times[times.size() / 2];
    point.error = resolved(largest_difference(point.observed, reference_));
    return point;
  }

  void measure_own(double accuracy, bool exact) {
    Point point = timed([&] { return observe(simulate(accuracy, exact)); });
    point.method = exact ? "simulate(), exact" : "simulate()";
    point.asked = accuracy;
    points_.push_back(point);
  }

  void sweep(const char* method, bench::SundialsSettings settings, const std::string& setting) {
    settings.time_limit = study_.time_limit;
    for (const double absolute : {1.0, 0.01})
      for (int k = 0; k <= 16; ++k) {
        settings.tolerance = std::pow(10.0, -2.0 - k / 1.5);
        settings.absolute = absolute;
        Point point = timed([&] { return sundials(settings); });
        point.method = method;
        point.setting =
            fmt::format("{}{}absolute {:g}", setting, setting.empty() ? "" : ", ", absolute);
        point.asked = settings.tolerance;
        points_.push_back(point);
        if (point.fastest > 0.5 * study_.time_limit) break;
      }
  }

  /// The fastest run of a method with at most this error.
  const Point* fastest(const std::string& method, double error) const {
    const Point* best = nullptr;
    for (const Point& point : points_)
      if (point.method == method && point.observed.failure.empty() && point.error <= error &&
          (best == nullptr || point.fastest < best->fastest))
        best = &point;
    return best;
  }

  const Study& study_;
  const SceneChoice& choice_;
  fitting::RigFile file_;
  Observed reference_;
  double confirmed_ = 0.0;    // to which a second run of ours agrees
  double independent_ = 0.0;  // to which SUNDIALS does
  std::vector<Point> points_;
};

void SceneStudy::print() const {
  fmt::print("\n{}: {}, {:g} ms\n", choice_.name, choice_.description,
             1e3 * file_.solver.duration.value());
  fmt::print(
      "  reference: peak {:.12g} N, first contact {:.12g} us, impulse {:.12g} N s; confirmed "
      "to {:.1e}\n",
      reference_.peak, 1e6 * reference_.duration, reference_.impulse, confirmed_);
  fmt::print("  CVODE Adams at 1e-12 differs from it by {:.1e}\n", independent_);
  fmt::print("\n  {:<20}{:>10}{:>11}{:>12}{:>12}{:>13}{:>9}\n", "", "asked", "error", "min [ms]",
             "median [ms]", "evaluations", "steps");
  for (const Point& point : points_)
    if (point.method.starts_with("simulate"))
      fmt::print("  {:<20}{:>10.0e}{:>11.1e}{:>12.3f}{:>12.3f}{:>13}{:>9}\n", point.method,
                 point.asked, point.error, 1e3 * point.fastest, 1e3 * point.median,
                 point.observed.evaluations, point.observed.steps);
  fmt::print("\n  fastest run within an error: milliseconds (evaluations)\n  {:<8}", "error");
  for (const Method& method : methods) fmt::print("{:>21}", method.name);
  for (int digits = 2; digits <= 10; ++digits) {
    const double error = std::pow(10.0, -digits);
    if (error < 3.0 * confirmed_) break;
    fmt::print("\n  {:<8.0e}", error);
    for (const Method& method : methods) {
      const Point* best = fastest(method.name, error);
      fmt::print("{:>21}", best == nullptr ? "-"
                                           : fmt::format("{:.3f} ({})", 1e3 * best->fastest,
                                                         best->observed.evaluations));
    }
  }
  fmt::print("\n\n  settings of the fastest run within 1e-3, 1e-6, 1e-9\n");
  for (const Method& method : methods)
    for (const double error : {1e-3, 1e-6, 1e-9})
      if (const Point* best = fastest(method.name, error); best && !best->setting.empty())
        fmt::print("  {:<14}{:<8.0e}{}, relative {:.1e}: error {:.1e}, {:.3f} ms\n", method.name,
                   error, best->setting, best->asked, best->error, 1e3 * best->fastest);
}

Json SceneStudy::to_json() const {
  Json json = {{"scene", choice_.name},
               {"description", choice_.description},
               {"duration_s", file_.solver.duration.value()},
               {"reference",
                {{"peak_force_n", reference_.peak},
                 {"first_contact_s", reference_.duration},
                 {"first_impulse_ns", reference_.impulse},
                 {"confirmed_to", confirmed_},
                 {"cvode_adams_differs_by", independent_}}}};
  for (const Point& p : points_) {
    const auto relative = [](double a, double b) { return std::abs(a / b - 1.0); };
    json["points"].push_back(
        {{"method", p.method},
         {"setting", p.setting},
         {"asked", p.asked},
         {"error", p.error},
         {"peak_error", relative(p.observed.peak, reference_.peak)},
         {"duration_error", relative(p.observed.duration, reference_.duration)},
         {"impulse_error", relative(p.observed.impulse, reference_.impulse)},
         {"fastest_s", p.fastest},
         {"median_s", p.median},
         {"evaluations", p.observed.evaluations},
         {"steps", p.observed.steps},
         {"failure", p.observed.failure}});
  }
  return json;
}

/// Of each method the runs that nothing of the same method beats in both error and time.
bench::LogPlot SceneStudy::plot() const {
  bench::LogPlot plot{.title = choice_.description,
                      .x_label = "time [ms]",
                      .y_label = "relative error",
                      .curves = {}};
  for (const Method& method : methods) {
    std::vector<const Point*> sorted;
    for (const Point& point : points_)
      if (point.method == method.name && point.observed.failure.empty() && point.error < 0.5)
        sorted.push_back(&point);
    std::ranges::sort(sorted, {}, [](const Point* p) { return p->fastest; });
    bench::LogCurve curve{method.name, {}, {}, method.colour, method.dashed};
    double lowest = 1.0;
    for (const Point* point : sorted) {
      if (point->error >= lowest) continue;
      lowest = point->error;
      curve.x.push_back(1e3 * point->fastest);
      curve.y.push_back(point->error);
    }
    plot.curves.push_back(curve);
  }
  return plot;
}

void run(const Study& study) {
  Json json = {{"schema", "impactrig/work-precision/1"},
               {"program", datasets::program_version()},
               {"rig", study.rig}};
  std::vector<bench::LogPlot> plots;
  for (const SceneChoice& choice : scene_choices) {
    if (!study.scenes.empty() && std::ranges::count(study.scenes, choice.name) == 0) continue;
    SceneStudy scene(study, choice);
    scene.run();
    scene.print();
    std::fflush(stdout);
    json["scenes"].push_back(scene.to_json());
    plots.push_back(scene.plot());
  }
  if (!study.output.empty()) std::ofstream(study.output) << json.dump(1) << "\n";
  if (!study.plot.empty()) std::ofstream(study.plot) << bench::log_svg(plots);
}

}  // namespace

int main(int argc, char** argv) {
  Study study;
  CLI::App program("Error against time, for simulate() and SUNDIALS on the same equations");
  program.add_option("--rig", study.rig, "Rig file with solver.duration")->capture_default_str();
  program.add_option("--scenes", study.scenes, "Some of paper, hybrid, ancf32")
      ->check(CLI::IsMember({"paper", "hybrid", "ancf32"}))
      ->delimiter(',');
  program.add_option("--runs", study.runs, "Of each setting; three at least, then for a second")
      ->check(CLI::Range(3, 1000))
      ->capture_default_str();
  program
      .add_option("--time-limit", study.time_limit,
                  "Of one SUNDIALS run; a sweep ends at half of it [s]")
      ->capture_default_str();
  program.add_option("-o,--output", study.output, "Every run, as JSON");
  program.add_option("--plot", study.plot, "Error against time, as SVG");
  CLI11_PARSE(program, argc, argv);
  try {
    run(study);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
