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
template <typename Matrix, typename Part>
void add_to(Matrix& sum, double weight, const Part& part) {
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

/// What a bar's modes and the rows before them are made of.
struct BarParts {
  BarInModes bar;
  Rows rows;

  /// `own`: values of the modes.
  static BarParts of(const Rig& rig, const Solver& solver, const HistoryRequest& history,
                     const Eigen::MatrixXd& own) {
    const std::unique_ptr<SmallMotionBeam> beam = make_small_motion_beam(rig, solver);
    return {
        {beam->small_motion(), beam->shapes_of(own), beam->strains(own), ViscousDamping::of(rig)},
        Rows::of(*beam, rig, history)};
  }
};

/// Slopes of it: sums of differences, of which what does not change is exactly nothing.
struct BarChange : BarParts {
  void add(double weight, const BarParts& there, const BarParts& here) {
    const SmallMotion &to = there.bar.motion, &from = here.bar.motion;
    SmallMotion& motion = bar.motion;
    add_to(motion.mass, weight, to.mass - from.mass);
    add_to(motion.gravity, weight, to.gravity - from.gravity);
    add_to(motion.load, weight, to.load - from.load);
    add_to(motion.hinge, weight, to.hinge - from.hinge);
    add_to(motion.rigid, weight, to.rigid - from.rigid);
    motion.spring += weight * (to.spring - from.spring);
    add_to(bar.shapes, weight, there.bar.shapes - here.bar.shapes);
    add_to(bar.strains, weight, there.bar.strains - here.bar.strains);
    const ViscousDamping &resists = there.bar.damping, &resisted = here.bar.damping;
    bar.damping.mass += weight * (resists.mass - resisted.mass);
    bar.damping.stiffness += weight * (resists.stiffness - resisted.stiffness);
    bar.damping.hinge += weight * (resists.hinge - resisted.hinge);
    const std::size_t stops = here.rows.struck.size();
    rows.struck.resize(stops);
    for (std::size_t k = 0; k < stops; ++k)
      add_to(rows.struck[k], weight, there.rows.struck[k] - here.rows.struck[k]);
    add_to(rows.velocity, weight, there.rows.velocity - here.rows.velocity);
    add_to(rows.displacement, weight, there.rows.displacement - here.rows.displacement);
  }
};

double start_rate(const Rig& rig) {
  return touch_velocity(rig) / rig.contact.position;
}

/// [rad/s]; of a bar that does not bend how fast it moves by itself.
double slowest_bending(const ModalBeam& modes) {
  double slowest = std::numeric_limits<double>::infinity();
  for (const double omega : modes.omega().tail(modes.modes() - 1))
    if (omega > 0.0) slowest = std::min(slowest, omega);
  return std::isfinite(slowest) ? slowest : modes.fastest();
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
  const Eigen::MatrixXd own = bar.own_values();
  const BarParts here = BarParts::of(rig, solver, history, own);
  BarChange change;
  by().for_each_place([&](std::size_t place) {
    change.add(by().weight(place), BarParts::of(by().rig_at(place), solver, history, own), here);
  });
  slope_ = bar.slope(change.bar);
  const Rows& rows = here.rows;
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

/// How far along the slope each mode may be moved; infinite where it does not change (m).
Eigen::VectorXd ParameterEffect::spacings() const {
  // rates have the size of each mode's own, slow ones that of the slowest that bends; what is zero
  // has no size: then the parameter's own has to do
  const double own = 1.0 / by().size();
  const Eigen::ArrayXd rates = modes_.omega().cwiseAbs().cwiseMax(slowest_bending(modes_));
  Eigen::ArrayXd most = Eigen::ArrayXd::Zero(modes_.modes());  // change over size
  const auto change = [&](const Eigen::VectorXd& slope, const Eigen::ArrayXd& sizes) {
    const Eigen::ArrayXd each = slope.array().abs();
    most = most.max((sizes > 0.0).select(each / sizes, (each > 0.0).select(own, each)));
  };
  const auto change_of_row = [&](const Eigen::VectorXd& slope, const Eigen::VectorXd& row) {
    change(slope, Eigen::ArrayXd::Constant(row.size(), largest_of(row)));
  };
  change(slope_.omega, rates);
  change(slope_.damping, rates);
  change_of_row(slope_.rigid, modes_.rigid());
  for (int stop = 0; stop < modes_.stops(); ++stop)
    change_of_row(struck(stop), modes_.struck(stop));
  // what a load does is linear in it: it may be moved by however much
  most = (most == 0.0 && slope_.load.array() != 0.0).select(own, most);
  return mode_step / most;
}

/// Slow modes go as far as they can, however little those of a short element can: their rounding
/// is divided by the way.
void ParameterEffect::move_modes() {
  constexpr double alike = 30.0;
  const Eigen::VectorXd ways = spacings();
  std::vector<Eigen::Index> left;
  for (Eigen::Index i = 0; i < ways.size(); ++i)
    if (std::isfinite(ways[i])) left.push_back(i);
  std::ranges::stable_sort(left, {}, [&ways](Eigen::Index i) { return ways[i]; });
  for (auto first = left.begin(); first != left.end();) {
    const auto last = std::find_if(first, left.end(),
                                   [&](Eigen::Index i) { return ways[i] > alike * ways[*first]; });
    Group& group = groups_.emplace_back(Group{{first, last}, ways[*first], {}});
    std::ranges::sort(group.modes);
    for (const double offset : by().stencil().offsets)
      group.moved.push_back(modes_.moved(slope_, offset * group.spacing).only(group.modes));
    if (group.modes.front() == 0) load_spacing_ = group.spacing;
    first = last;
  }
  if (groups_.empty()) return;
  for (const double offset : by().stencil().offsets)
    if (load_spacing_ > 0.0) loads_.emplace_back(modes_.moved(slope_, offset * load_spacing_));
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
  for (std::size_t place = 0; place < loads_.size(); ++place) {
    if (!by().counts(place)) continue;
    const double weight = by().stencil().weights[place] / load_spacing_;
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
  for (const Group& group : groups_) steps.push_back(step_of(group, h));
  std::vector<ModalStep::Share> shares;
  for (std::size_t i = 0; i < steps.size(); ++i) shares.push_back({&steps[i], &groups_[i].modes});
  return steps_.emplace(h, ModalStep::joined(shares, modes_.modes())).first->second;
}

ModalStep ParameterEffect::step_of(const Group& group, double h) const {
  std::vector<ModalStep> steps;
  std::vector<double> weights;
  for (std::size_t place = 0; place < group.moved.size(); ++place) {
    if (!by().counts(place)) continue;
    steps.emplace_back(group.moved[place], rule_, h);
    weights.push_back(by().stencil().weights[place] / group.spacing);
  }
  std::vector<const ModalStep*> places;
  for (const ModalStep& step : steps) places.push_back(&step);
  return ModalStep::sum(places, weights, h);
}

void ParameterEffect::add_advance(double h, std::span<const NodeVector> series,
                                  const ModalState& from, ModalState& to) {
  for (const Group& group : groups_) {
    from_.a = from.a(group.modes);
    from_.rate = from.rate(group.modes);
    there_ = from_;
    for (std::size_t place = 0; place < group.moved.size(); ++place) {
      if (!by().counts(place)) continue;
      advance(group.moved[place], h, series, from_, there_);
      const double weight = by().stencil().weights[place] / group.spacing;
      to.a(group.modes) += weight * there_.a;
      to.rate(group.modes) += weight * there_.rate;
    }
  }
}

}  // namespace impactrig::models
