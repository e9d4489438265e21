// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/parameter_effect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "models/history_recorder.hpp"
#include "models/make_beam.hpp"
#include "models/stop/stop_head.hpp"

namespace impactrig::models {
namespace {

// How far modes are moved, of their size: truncation and rounding of the stencil are both below
// 1e-9.
constexpr double mode_step = 1e-4;

constexpr std::array shown = {&History::force, &History::penetration, &History::velocity,
                              &History::displacement};

/// A sum that begins empty.
template <typename Matrix>
void add_to(Matrix& sum, double weight, const Matrix& part) {
  if (sum.size() == 0)
    sum = weight * part;
  else
    sum += weight * part;
}

/// Rows of small motion of the points that a run looks at (n).
struct Rows {
  std::vector<Eigen::VectorXd> struck;
  Eigen::VectorXd velocity, displacement;

  static Rows of(const SmallMotionBeam& beam, const Rig& rig, const HistoryRequest& history) {
    Rows rows;
    for (int stop = 0; stop < rig.stops(); ++stop) {
      const double side =
          stop == 0 ? 1.0 : rig.further_stops[static_cast<std::size_t>(stop - 1)].direction();
      rows.struck.push_back(side * beam.small_motion_row(rig.contact_of(stop).position));
    }
    const auto spot = [&](double asked) -> Eigen::VectorXd {
      return asked > 0.0 ? beam.small_motion_row(asked) : rows.struck[0];
    };
    rows.velocity = spot(history.velocity_position);
    rows.displacement = spot(history.displacement_position);
    return rows;
  }
};

/// Slopes of what a bar's modes and the rows before them are made of.
struct BarChange {
  SmallMotion motion;
  ViscousDamping damping;
  Rows rows;

  void add(double weight, const SmallMotion& other, const ViscousDamping& resisting,
           const Rows& seen) {
    add_to(motion.mass, weight, other.mass);
    add_to(motion.stiffness, weight, other.stiffness);
    add_to(motion.gravity, weight, other.gravity);
    add_to(motion.hinge, weight, other.hinge);
    add_to(motion.rigid, weight, other.rigid);
    motion.spring += weight * other.spring;
    damping.mass += weight * resisting.mass;
    damping.stiffness += weight * resisting.stiffness;
    damping.hinge += weight * resisting.hinge;
    rows.struck.resize(seen.struck.size());
    for (std::size_t k = 0; k < seen.struck.size(); ++k)
      add_to(rows.struck[k], weight, seen.struck[k]);
    add_to(rows.velocity, weight, seen.velocity);
    add_to(rows.displacement, weight, seen.displacement);
  }
};

/// Whether the bars, and the points that are looked at, are the same.
bool same_bar(const Rig& one, const Rig& other) {
  for (int stop = 0; stop < one.stops(); ++stop)
    if (one.contact_of(stop).position != other.contact_of(stop).position) return false;
  return one.beam == other.beam && one.hinge == other.hinge && one.gravity == other.gravity &&
         one.gravity_direction == other.gravity_direction;
}

double start_rate(const Rig& rig) {
  return touch_velocity(rig) / rig.contact.position;
}

double largest_of(const Eigen::VectorXd& values) {
  return values.size() == 0 ? 0.0 : values.cwiseAbs().maxCoeff();
}

}  // namespace

ParameterEffect::SensorRow ParameterEffect::SensorRow::of(const Stop& stop) {
  const double root = std::sqrt(stop.mass);
  return {stop.stiffness / root, stop.viscous / root};
}

ParameterEffect::ParameterEffect(const Rig& rig, const Solver& solver,
                                 const HistoryRequest& history, RigParameter parameter,
                                 const ModalBeam& bar, const ModalBeam& modes,
                                 const Collocation& rule)
    : modes_(modes),
      rule_(rule),
      by_(rig, parameter),
      start_rate_(
          by_.slope([&](std::size_t place) { return models::start_rate(by_.rig_at(place)); })) {
  laws_.reserve(static_cast<std::size_t>(rig.stops()));
  for (int stop = 0; stop < rig.stops(); ++stop) laws_.emplace_back(rig, stop, by_);
  const Rig beside = by_.rig_beside();
  const bool same = same_bar(rig, beside);
  if (same && rig.stop == beside.stop) return;
  if (same)
    keep_bar(bar);
  else
    find_bar(rig, solver, history, bar);
  if (rig.stop) find_head();
  move_modes();
}

void ParameterEffect::keep_bar(const ModalBeam& bar) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(bar.modes());
  slope_.omega = slope_.damping = slope_.struck = slope_.rigid = none;
  slope_.further.assign(static_cast<std::size_t>(bar.stops() - 1), none);
  velocity_row_ = displacement_row_ = none;
}

void ParameterEffect::find_bar(const Rig& rig, const Solver& solver, const HistoryRequest& history,
                               const ModalBeam& bar) {
  const std::unique_ptr<SmallMotionBeam> beam = make_small_motion_beam(rig, solver);
  BarChange change;
  for (std::size_t place = 0; place < ParameterStencil::places; ++place) {
    if (!by_.counts(place)) continue;
    const Rig there = by_.rig_at(place);
    const std::unique_ptr<SmallMotionBeam> moved = make_small_motion_beam(there, solver);
    change.add(by_.weight(place), moved->small_motion(), ViscousDamping::of(there),
               Rows::of(*moved, there, history));
  }
  slope_ = bar.slope(change.motion, change.damping);
  const Rows rows = Rows::of(*beam, rig, history);
  slope_.struck = bar.row_slope(slope_, rows.struck[0], change.rows.struck[0]);
  for (std::size_t k = 1; k < rows.struck.size(); ++k)
    slope_.further.push_back(bar.row_slope(slope_, rows.struck[k], change.rows.struck[k]));
  velocity_row_ = bar.row_slope(slope_, rows.velocity, change.rows.velocity);
  displacement_row_ = bar.row_slope(slope_, rows.displacement, change.rows.displacement);
}

/// The mode of a stop's head, which is one with b = √m x.
void ParameterEffect::find_head() {
  const auto slope_of = [&](const auto& value_of) {
    return by_.slope([&](std::size_t place) { return value_of(*by_.rig_at(place).stop); });
  };
  const auto append = [](double value, Eigen::VectorXd& values) {
    values.conservativeResize(values.size() + 1);
    values.tail<1>()[0] = value;
  };
  append(slope_of([](const Stop& stop) { return StopHead(stop).mode().omega; }), slope_.omega);
  append(slope_of([](const Stop& stop) { return StopHead(stop).mode().damping; }), slope_.damping);
  append(slope_of([](const Stop& stop) { return StopHead(stop).mode().struck; }), slope_.struck);
  append(0.0, slope_.rigid);
  for (Eigen::VectorXd& row : slope_.further) append(0.0, row);
  append(0.0, velocity_row_);
  append(0.0, displacement_row_);
  sensor_row_ = {slope_of([](const Stop& stop) { return SensorRow::of(stop).of_a; }),
                 slope_of([](const Stop& stop) { return SensorRow::of(stop).of_rate; })};
}

void ParameterEffect::move_modes() {
  const auto step_along = [](double size, const Eigen::VectorXd& slope) {
    const double largest = largest_of(slope);
    return largest > 0.0 ? mode_step * size / largest : std::numeric_limits<double>::infinity();
  };
  // a weightless rigid bar without a damper has no rate: then the parameter's own size has to do
  const double fastest = modes_.fastest();
  const double rate = fastest > 0.0 ? fastest : by_.size() * largest_of(slope_.damping);
  spacing_ = std::min({step_along(largest_of(modes_.omega()), slope_.omega),
                       step_along(rate, slope_.damping),
                       step_along(largest_of(modes_.rigid()), slope_.rigid)});
  for (int stop = 0; stop < modes_.stops(); ++stop)
    spacing_ = std::min(spacing_, step_along(largest_of(modes_.struck(stop)), struck(stop)));
  if (!std::isfinite(spacing_)) return;
  for (const double offset : by_.stencil().offsets)
    moved_.push_back(modes_.moved(slope_, offset * spacing_));
}

const ModalStep& ParameterEffect::step(double h) {
  const auto found = steps_.find(h);
  if (found != steps_.end()) return found->second;
  std::vector<ModalStep> steps;
  std::vector<double> weights;
  for (std::size_t place = 0; place < moved_.size(); ++place) {
    if (!by_.counts(place)) continue;
    steps.emplace_back(moved_[place], rule_, h);
    weights.push_back(by_.stencil().weights[place] / spacing_);
  }
  return steps_.emplace(h, ModalStep::sum(steps, weights)).first->second;
}

void ParameterEffect::add_advance(double h, std::span<const NodeVector> series,
                                  const ModalState& from, ModalState& to) {
  there_ = to;
  for (std::size_t place = 0; place < moved_.size(); ++place) {
    if (!by_.counts(place)) continue;
    advance(moved_[place], h, series, from, there_);
    const double weight = by_.stencil().weights[place] / spacing_;
    to.a += weight * there_.a;
    to.rate += weight * there_.rate;
  }
}

/// Where nothing before touch changes.
History ParameterEffect::still(const HistoryRequest& wanted) const {
  History zero;
  const long before = samples_before_touch(wanted);
  zero.start = -static_cast<double>(before) * wanted.interval;
  zero.interval = wanted.interval;
  const std::vector<double> zeros(static_cast<std::size_t>(before) + 1, 0.0);
  for (const auto values : shown) zero.*values = zeros;
  zero.further.assign(laws_.size() - 1, {zeros, zeros});
  return zero;
}

History ParameterEffect::lead(const HistoryRequest& wanted) const {
  History sum;
  if (!(wanted.interval > 0.0)) return sum;
  if (start_rate_ == 0.0 && !moves_modes() && !moves_gap()) return still(wanted);
  const auto add = [](std::vector<double>& to, double weight, const std::vector<double>& part) {
    to.resize(part.size(), 0.0);
    for (std::size_t k = 0; k < part.size(); ++k) to[k] += weight * part[k];
  };
  for (std::size_t place = 0; place < ParameterStencil::places; ++place) {
    if (!by_.counts(place)) continue;
    const Rig there = by_.rig_at(place);
    const double speed = touch_velocity(there);
    const auto speed_at = [&](double x) {
      return x > 0.0 ? speed * x / there.contact.position : speed;
    };
    History lead;
    begin_history(there, wanted, speed, speed_at(wanted.velocity_position),
                  speed_at(wanted.displacement_position), lead);
    sum.start = lead.start;
    sum.interval = lead.interval;
    const double weight = by_.weight(place);
    for (const auto values : shown) add(sum.*values, weight, lead.*values);
    sum.further.resize(lead.further.size());
    for (std::size_t k = 0; k < lead.further.size(); ++k) {
      add(sum.further[k].force, weight, lead.further[k].force);
      add(sum.further[k].penetration, weight, lead.further[k].penetration);
    }
  }
  return sum;
}

}  // namespace impactrig::models
