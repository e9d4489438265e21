// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/contact_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace impactrig::models {
namespace {

// How well the way of free flight is resolved where a touch is looked for, of the penetration.
constexpr double motion_resolution = 1e-3;
// The same far from the stop, of the gap.
constexpr double gap_share = 0.1;
// Of the force that vibration which the contact should have damped makes, what it may change the
// peak by. Less than a tenth of that it made where it dies out in the contact's time.
constexpr double share_of_undamped = 0.03;
// As many roundings of a depth as its nodes differ by.
constexpr double roundings = 4.0;

}  // namespace

ContactPoint::ContactPoint(const Rig& rig, int number, BarMotion& bar, StopStep& step,
                           ContactLog& log)
    : number_(number),
      position_(rig.contact_of(number).position),
      gap_(number == 0 ? 0.0 : rig.further_stops[static_cast<std::size_t>(number - 1)].gap),
      bar_(bar),
      rule_(bar.rule()),
      step_(step),
      log_(log),
      contact_(rig, number) {}

void ContactPoint::set_scales(double energy, double approach, double deepest, double accuracy) {
  depth_ = std::min(penetration_storing(contact_, energy), deepest);
  force_scale_ = contact_.elastic(depth_);
  local_force_ = force_scale_;
  first_step_ = std::min(0.1, 3.0 * std::sqrt(accuracy)) * depth_ / approach;
  time_scale_ = depth_ / approach;
}

void ContactPoint::predict_force() {
  const int s = rule_.nodes();
  step_.force.setZero(s);
  if (last_series_.size() == 0 || !contact_.presses()) return;
  const double ahead = bar_.step() / last_h_;
  // after a step cut to next to nothing, the rounding of its terms would outgrow the force by so
  // much that Newton's method had none of its digits left
  const int terms = ahead > StepLadder::largest_growth ? 1 : std::min(std::max(4, s - 2), 6);
  step_.force = rule_.values_between(last_series_.head(terms), last_part_, last_part_ + ahead);
}

void ContactPoint::complete() {
  const int s = rule_.nodes();
  step_.at_end = seen(bar_.struck_at_end(number_));
  step_.dissipation.setZero(s);
  if (contact_.phase() != Phase::free)
    for (int i = 0; i < s; ++i)
      step_.dissipation[i] =
          contact_.dissipation(resolved(step_.displacement[i]), step_.velocity[i]);
  step_.dissipation_series = rule_.to_series() * step_.dissipation;
  step_.displacement_series = rule_.to_series() * step_.displacement;
}

BarMotion::ContactSlope ContactPoint::slope_at(double part) const {
  if (!contact_.presses()) return {};
  // nodes are near enough, and known
  const Eigen::Index last = step_.to_depth.size() - 1;
  const auto node =
      static_cast<Eigen::Index>(std::lround(std::min(part, 1.0) * static_cast<double>(last)));
  return {step_.to_depth[node], step_.to_rate[node]};
}

double ContactPoint::shown_force(const PointMotion& p) const {
  const double there = contact_.force(p.displacement, p.velocity);
  // at a phase's end rounding may put the place just beyond it, where the law would pull
  return contact_.may_pull() ? there : std::max(there, 0.0);
}

/// Largest ∂f/∂δ̇ of the solved step [N s/m].
double ContactPoint::most_damping() const {
  if (!contact_.damped()) return 0.0;
  if (contact_.form() == DampingForm::proportional)
    return contact_.strength() * step_.force.cwiseAbs().maxCoeff();
  double most = 0.0;
  for (int i = 0; i < rule_.nodes(); ++i)
    most = std::max(most, contact_.pressed(step_.displacement[i], step_.velocity[i]).to_rate);
  return most;
}

/// How much of what the force's series leaves out comes back as the contact's answer to the motion
/// it makes; at most all. It changes sign about twice a node, so that speed gathers little of it. A
/// node that parts from the stop stands for no less depth than is passed between nodes: a damped
/// force may not vanish there, and force over depth would be as great as the node is near.
double ContactPoint::answer() const {
  const double s = rule_.nodes();
  const double passed = way() / (s * s);
  const double stiffness =
      (step_.force.array() / step_.displacement.array().abs().max(passed)).abs().maxCoeff();
  const double damping = most_damping() / (2.0 * rule_.nodes());
  const BarMotion::Response& response = bar_.response(number_, number_);
  return std::min(1.0, stiffness * response.most_displacement + damping * response.most_velocity);
}

/// Impulse that is missing where a force rises before the first node, as that of damping may that
/// sets in by itself, from what it begins with to what its series begins with [N s].
double ContactPoint::missing_at_begin() const {
  const bool begins = last_series_.size() == 0 && contact_.presses();
  if (!begins || contact_.form() == DampingForm::proportional) return 0.0;
  const PointMotion begun = struck();
  const double rise =
      legendre_sum(step_.force_series, 0.0) - contact_.force(begun.displacement, begun.velocity);
  return 0.5 * rule_.points()[0] * bar_.step() * std::abs(rise);
}

/// What rounding of the way to the stop makes of the force [N].
double ContactPoint::rounding() const {
  if (!contact_.presses()) return 0.0;
  return std::numeric_limits<double>::epsilon() * std::abs(gap_) *
         step_.to_depth.cwiseAbs().maxCoeff();
}

double ContactPoint::force_error(double impulse, double energy) const {
  if (contact_.phase() == Phase::free) return 0.0;
  // no shorter step leaves less out than that
  const double left = std::max(0.0, truncation(step_.force_series) - roundings * rounding());
  const double loss = truncation(step_.dissipation_series) * bar_.step();
  const double peak =
      std::max({log_.episode(number_).peak_force, local_force_, step_.force.cwiseAbs().maxCoeff()});
  const double damping = most_damping();
  const double undamped =
      damping > 0.0 ? damping * bar_.undamped_speed(number_, damping, time_scale_) : 0.0;
  return std::max({left * bar_.step() / impulse, left * answer() / peak, loss / energy,
                   share_of_undamped * undamped / peak, missing_at_begin() / impulse});
}

double ContactPoint::motion_error() const {
  if (contact_.presses()) return 0.0;
  const int s = rule_.nodes();
  const double gap =
      std::min(std::abs(struck().displacement), step_.displacement.cwiseAbs().minCoeff());
  return step_.displacement_series.segment<2>(s - 2).norm() /
         (motion_resolution * depth_ + gap_share * gap);
}

}  // namespace impactrig::models
