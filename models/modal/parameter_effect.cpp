// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/parameter_effect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/make_beam.hpp"
#include "models/stop/stop_head.hpp"

namespace impactrig::models {
namespace {

// How far modes are moved, of their size: truncation and rounding of the stencil are both below
// 1e-9.
constexpr double mode_step = 1e-4;

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
    add_to(motion.load, weight, other.load);
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
    : RigEffect(rig, parameter, solver, history),
      modes_(modes),
      rule_(rule),
      start_rate_(
          by().slope([&](std::size_t place) { return models::start_rate(by().rig_at(place)); })) {
  if (keeps_bar() && rig.stop == by().rig_beside().stop) return;
  if (keeps_bar())
    keep_bar(bar);
  else
    find_bar(rig, solver, history, bar);
  if (rig.stop) find_head();
  move_modes();
}

void ParameterEffect::keep_bar(const ModalBeam& bar) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(bar.modes());
  slope_.omega = slope_.damping = slope_.struck = slope_.rigid = slope_.load = none;
  slope_.further.assign(static_cast<std::size_t>(bar.stops() - 1), none);
  velocity_row_ = displacement_row_ = none;
}

void ParameterEffect::find_bar(const Rig& rig, const Solver& solver, const HistoryRequest& history,
                               const ModalBeam& bar) {
  const std::unique_ptr<SmallMotionBeam> beam = make_small_motion_beam(rig, solver);
  BarChange change;
  for (std::size_t place = 0; place < ParameterStencil::places; ++place) {
    if (!by().counts(place)) continue;
    const Rig there = by().rig_at(place);
    const std::unique_ptr<SmallMotionBeam> moved = make_small_motion_beam(there, solver);
    change.add(by().weight(place), moved->small_motion(), ViscousDamping::of(there),
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
    return by().slope([&](std::size_t place) { return value_of(*by().rig_at(place).stop); });
  };
  const auto append = [](double value, Eigen::VectorXd& values) {
    values.conservativeResize(values.size() + 1);
    values.tail<1>()[0] = value;
  };
  append(slope_of([](const Stop& stop) { return StopHead(stop).mode().omega; }), slope_.omega);
  append(slope_of([](const Stop& stop) { return StopHead(stop).mode().damping; }), slope_.damping);
  append(slope_of([](const Stop& stop) { return StopHead(stop).mode().struck; }), slope_.struck);
  append(0.0, slope_.rigid);
  append(0.0, slope_.load);
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
  // what is zero has no size: then the parameter's own has to do
  const auto size_of = [&](double size, const Eigen::VectorXd& slope) {
    return size > 0.0 ? size : by().size() * largest_of(slope);
  };
  spacing_ = std::min({step_along(largest_of(modes_.omega()), slope_.omega),
                       step_along(size_of(modes_.fastest(), slope_.damping), slope_.damping),
                       step_along(largest_of(modes_.rigid()), slope_.rigid)});
  for (int stop = 0; stop < modes_.stops(); ++stop)
    spacing_ = std::min(spacing_, step_along(largest_of(modes_.struck(stop)), struck(stop)));
  // what a load does is linear in it: it may be moved by however much, and as little as it is
  if (!std::isfinite(spacing_))
    spacing_ = step_along(by().size() * largest_of(slope_.load), slope_.load);
  if (!std::isfinite(spacing_)) return;
  for (const double offset : by().stencil().offsets)
    loads_.emplace_back(moved_.emplace_back(modes_.moved(slope_, offset * spacing_)));
  find_held(ModalLoad(modes_).held());
}

/// Q / ω² of the modes that bend.
void ParameterEffect::find_held(const Eigen::VectorXd& held) {
  const Eigen::VectorXd squares = modes_.omega().cwiseAbs2();
  held_ = (slope_.load - 2.0 * held.cwiseProduct(modes_.omega()).cwiseProduct(slope_.omega))
              .cwiseQuotient(squares);
  held_[0] = 0.0;
  for (int stop = 0; stop < modes_.stops(); ++stop)
    held_at_.push_back(struck(stop).dot(held) + modes_.struck(stop).dot(held_));
}

ModalLoad::Fall ParameterEffect::fall(double time) const {
  ModalLoad::Fall slope;
  for (std::size_t place = 0; place < moved_.size(); ++place) {
    if (!by().counts(place)) continue;
    const double weight = by().stencil().weights[place] / spacing_;
    const ModalLoad::Fall fall = loads_[place].fall(time);
    slope.a += weight * fall.a;
    slope.rate += weight * fall.rate;
  }
  return slope;
}

const ModalStep& ParameterEffect::step(double h) {
  const auto found = steps_.find(h);
  if (found != steps_.end()) return found->second;
  std::vector<ModalStep> steps;
  std::vector<double> weights;
  for (std::size_t place = 0; place < moved_.size(); ++place) {
    if (!by().counts(place)) continue;
    steps.emplace_back(moved_[place], rule_, h);
    weights.push_back(by().stencil().weights[place] / spacing_);
  }
  std::vector<const ModalStep*> places;
  for (const ModalStep& step : steps) places.push_back(&step);
  return steps_.emplace(h, ModalStep::sum(places, weights, h)).first->second;
}

void ParameterEffect::add_advance(double h, std::span<const NodeVector> series,
                                  const ModalState& from, ModalState& to) {
  there_ = to;
  for (std::size_t place = 0; place < moved_.size(); ++place) {
    if (!by().counts(place)) continue;
    advance(moved_[place], h, series, from, there_);
    const double weight = by().stencil().weights[place] / spacing_;
    to.a += weight * there_.a;
    to.rate += weight * there_.rate;
  }
}

}  // namespace impactrig::models
