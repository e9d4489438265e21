// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/touch_scan.hpp"

#include <algorithm>
#include <limits>

namespace impactrig::fitting {
namespace {

/// Of the force, or of the velocity where there is none [s].
double sample_interval(const Shot& shot) {
  return (shot.impact->force ? *shot.impact->force : *shot.channels.front().signal).interval;
}

bool has_few_samples(const Shot& shot) {
  constexpr double few = 20.0;  // as ImpactFlag::undersampled has it
  return shot.contact < few * sample_interval(shot);
}

const Shot& shot_of(const FitProblem& problem, const Variable& touch) {
  return problem.shots()[static_cast<std::size_t>(std::max(0, touch.recording))];
}

bool is_open(const FitProblem& problem, const Variable& v) {
  return v.role == Variable::Role::touch && has_few_samples(shot_of(problem, v));
}

/// Gains, delays and the like of which something is stated.
std::vector<std::size_t> stated_sensors(const FitProblem& problem) {
  std::vector<std::size_t> stated;
  for (const std::size_t i : problem.unknowns())
    if (const Variable& v = problem.variables()[i]; v.is_of_sensor() && v.prior)
      stated.push_back(i);
  return stated;
}

/// Where a touch may be [s]: detection takes the sample before, or what vibrates three samples
/// earlier, for it.
std::vector<double> times(const FitProblem& problem, const Variable& touch) {
  constexpr double before = 2.0, behind = 4.0;  // intervals
  constexpr double coarse = 1.0 / 16.0;         // of a contact
  constexpr double fine = 1.0 / 64.0;           // what rings faster, a contact hardly rings
  const Shot& shot = shot_of(problem, touch);
  const double interval = sample_interval(shot);
  const auto& sensor = problem.rig().force;
  double step = coarse * shot.contact;
  if (sensor && sensor->resonance)
    step = std::clamp(0.25 / sensor->resonance->frequency, fine * shot.contact, step);
  std::vector<double> all;
  for (double by = -before * interval; by <= behind * interval; by += step)
    all.push_back(touch.initial + by);
  return all;
}

/// The present values with another touch.
void move_touch(FitProblem& problem, std::size_t touch, double time) {
  std::vector<double> values = problem.values();
  const Variable& v = problem.variables()[touch];
  values[touch] = std::clamp(time, v.lower, v.upper);
  problem.set_values(values);
}

/// From the present values. Where a search is likely to end is told well by what it would end with
/// if all were linear.
int scan(FitProblem& problem, std::size_t touch, std::vector<std::size_t> held) {
  held.push_back(touch);
  double best = problem.value(touch), least = std::numeric_limits<double>::infinity();
  for (const double time : times(problem, problem.variables()[touch])) {
    if (problem.out_of_time()) break;
    move_touch(problem, touch, time);
    const double cost = problem.linear_end(held);
    if (cost >= least) continue;
    least = cost;
    best = time;
  }
  move_touch(problem, touch, best);
  return problem.search(first_search, held).iterations;
}

}  // namespace

bool leaves_touch_open(const FitProblem& problem) {
  return std::ranges::any_of(
      problem.unknowns(), [&](std::size_t i) { return is_open(problem, problem.variables()[i]); });
}

int scan_touch(FitProblem& problem) {
  const std::vector<std::size_t> sensors = stated_sensors(problem);
  problem.set_initial_values();
  int iterations = 0;
  for (const std::size_t i : problem.unknowns())
    if (is_open(problem, problem.variables()[i])) iterations += scan(problem, i, sensors);
  return iterations;
}

}  // namespace impactrig::fitting
