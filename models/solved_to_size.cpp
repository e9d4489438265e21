// SPDX-License-Identifier: BSD-3-Clause
#include "models/solved_to_size.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace impactrig::models {
namespace {

// Of a first contact solved to its size: how much smaller it may come out than it was taken for,
// and of its approach, with how little speed it creeps apart.
constexpr double doubtful = 2.0, creeping = 1e-3;

double accuracy_to_size(double accuracy, double smallness) {
  return std::max(smallness * accuracy, Solver::finest_accuracy);
}

/// How far off a number may be, by times the accuracy asked for.
std::string off_by(double times) {
  return times < 1e3 ? fmt::format("by {:.0f} times the accuracy asked for", times)
                     : std::string("by all of itself");
}

/// What is not known of a first contact that is too small, or ends too slowly, for the accuracy it
/// was solved to.
std::string doubt_of(const Episode& first, double times) {
  const double speed = std::abs(first.separation_velocity);
  if (first.open || speed < creeping * first.approach_velocity)
    return fmt::format(
        "the first contact creeps apart, if at all: its end, and with that its duration, may be "
        "off {}, since the last digits of the way decide it, or rounding; its peak force is not "
        "touched by that. Less damping in the contact lets it part, a solver.duration that ends "
        "before makes it one contact",
        off_by(times));
  return fmt::format(
      "the first contact has an impulse of {:.3g} N s, next to nothing of what the bar could give "
      "or of what pushes and pulls in it: that may be off {}. Count on its peak force and duration "
      "alone, ask for less accuracy, or let the contact pull less",
      first.impulse, off_by(times));
}

/// Whether one of two solutions of a contact is off by more than this.
bool differ(const Episode& a, const Episode& b, double accuracy) {
  const auto far = [&](double x, double y) { return !(std::abs(x - y) <= accuracy * std::abs(y)); };
  return a.open != b.open || far(a.peak_force, b.peak_force) || far(a.impulse, b.impulse) ||
         far(a.end - a.start, b.end - b.start);
}

}  // namespace

Solver solver_to_size(const Solver& solver, double smallness) {
  Solver finer = solver;
  finer.accuracy = accuracy_to_size(solver.accuracy, smallness);
  return finer;
}

Simulation solved_to_size(const Simulation& first, Solved again, double smallness,
                          double accuracy) {
  const Episode& contact = again.result.episodes.front();
  // errors are as small a part of it as it is small, but for a contact that no accuracy reaches
  const double times = contact.open
                           ? 1.0 / smallness
                           : accuracy_to_size(accuracy, smallness) / (accuracy * again.smallness);
  if (times > doubtful && differ(first.episodes.front(), contact, accuracy))
    again.result.warnings.push_back(doubt_of(contact, times));
  return std::move(again.result);
}

Simulation not_solved_to_size(Solved first) {
  first.result.warnings.push_back(fmt::format(
      "the first contact is so small, for what the bar could give, or ends so slowly, that it "
      "may be off {}, and solver.time_limit left no time to solve it again; state a longer one",
      off_by(1.0 / first.smallness)));
  return std::move(first.result);
}

}  // namespace impactrig::models
