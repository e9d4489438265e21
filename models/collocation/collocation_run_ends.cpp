// SPDX-License-Identifier: BSD-3-Clause
//
// What ends a CollocationRun.
#include "models/collocation/collocation_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>

#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

// Of the speed of approach: contacts follow each other down to the smallest numbers there are.
constexpr double at_rest = 1e-100;
// A run that need not look how long it takes [s].
constexpr double short_run = 1e-3;

}  // namespace

/// Whether the run ends where this point meets its stop's plane: the bar has come to rest, or it
/// crosses the plane on the hinge's other side, where there is no stop.
bool CollocationRun::over_at(const ContactPoint& point) {
  if (!result_.episodes.empty() && point.struck().velocity < at_rest * approach_) {
    done_ = true;
    result_.termination = "the bar has come to rest at the stop";
    return true;
  }
  if (!(bar_.rigid_part().along < 0.0)) return false;
  if (result_.episodes.empty())
    throw std::runtime_error(
        "the bar swings round, away from the stop, and does not strike it; look at "
        "start.release_angle and environment.gravity_direction");
  done_ = true;
  result_.termination = "the bar has turned half round, away from the stop";
  result_.warnings.push_back(
      result_.termination +
      "; what comes later is not in the result: it would strike the stop from behind.");
  return true;
}

/// The contacts that are over stand; throws where none is.
void CollocationRun::stop_without_headway() {
  const std::string stopped = fmt::format(
      "the integration stopped {:g} s after first touch: steps of {:g} s make no headway", t_,
      bar_.step());
  if (result_.episodes.empty() || result_.episodes.front().open)
    throw std::runtime_error(stopped + "; ask for less accuracy");
  result_.termination = stopped;
  result_.cut_short = true;
  result_.warnings.push_back(
      stopped +
      "; what comes later is not in the result. Ask for less accuracy, or state a shorter "
      "solver.duration.");
  done_ = true;
}

/// Whether the time allowed is over. Throws when no contact is over by then.
bool CollocationRun::out_of_time() {
  if (!looks_.due()) return false;
  if (!time_limit_) {
    // the clock of its thread costs a short run more than it could tell
    const std::chrono::duration<double> so_far = std::chrono::steady_clock::now() - started_;
    if (so_far.count() < std::min(short_run, solver_.time_limit)) return false;
    time_limit_.emplace(solver_.time_limit);
  }
  if (!time_limit_->over()) return false;
  const bool any = !result_.episodes.empty() && !result_.episodes.front().open;
  const std::string reached = fmt::format(
      "{:.3g} s of processor time, what was left of solver.time_limit, took the simulation to {:g} "
      "s {}",
      std::max(solver_.time_limit, 0.0), t_,
      result_.episodes.empty() ? "of the swing before first touch" : "after first touch");
  const std::string remedy =
      "State a shorter solver.duration, fewer elements or modes (an element much shorter than the "
      "others vibrates fast), a larger solver.accuracy, or a longer solver.time_limit.";
  if (!any)
    throw std::runtime_error(
        fmt::format("{}, before the first contact was over. {}", reached, remedy));
  result_.termination = reached;
  result_.cut_short = true;
  result_.warnings.push_back(fmt::format("{}; what comes later{} is not in the result. {}", reached,
                                         rig_.stop ? ", be it more in the sensor," : "", remedy));
  return true;
}

/// Whether nothing more can happen at the stop. Throws when a released bar does not reach it.
bool CollocationRun::ends_early() {
  if (result_.episodes.empty()) {
    const RigidPart rigid = bar_.rigid_part();
    if (rigid.rate < -0.1 * approach_ / rig_.contact.position)
      throw std::runtime_error(fmt::format(
          "the bar turned back {:g} rad before it touched the stop: released, it bends, and what "
          "that takes is missing; release it from further away",
          -rigid.angle));
    return false;
  }
  if (solver_.duration) return false;
  const bool left = free() && left_for_good(rig_, elastic_reach_, bar_.rigid_part(), bar_.energy());
  if (left && !bar_.sensor_may_rise()) {
    result_.termination = "the bar has left the stop for good";
    return true;
  }
  if (tried_.end == End::run && left) {
    result_.termination = fmt::format("{:g} s after first touch the bar had left the stop for good",
                                      longest_default_run);
  } else if (tried_.end == End::run) {
    result_.termination = fmt::format(
        "{:g} s after first touch the bar was still within reach of the stop", longest_default_run);
    result_.warnings.push_back(
        result_.termination +
        "; later contacts are not in the result. State solver.duration to go on.");
  }
  return false;
}

}  // namespace impactrig::models
