// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/floating_frame.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "models/integration/gauss.hpp"

namespace impactrig::models {
namespace {

double axial_wave_number(int number, double length) {
  return (number - 0.5) * std::numbers::pi / length;
}

}  // namespace

FloatingFrameBeam::FloatingFrameBeam(const Rig& rig, Basis basis, int modes, int axial_modes)
    : axial_(axial_modes),
      bending_(modes),
      length_(rig.beam.length),
      inertia_(rig.beam.hinge_inertia()),
      gravity_(rig.gravity_along()),
      gravity_across_(rig.gravity_across()),
      hinge_(rig.hinge),
      damping_(rig.beam.damping),
      further_stops_(rig.further_stops),
      timoshenko_(rig.beam.shears()),
      hinge_row_(Eigen::VectorXd::Unit(size(), 0)),
      axial_scale_(std::sqrt(2.0 / rig.beam.bar_mass())),
      modes_(rig.beam, basis, modes),
      stiffness_(Eigen::VectorXd::Zero(size())),
      rotary_(Eigen::MatrixXd::Zero(size(), size())),
      fineness_(20 + 4 * std::max(modes, axial_modes)),
      kinetic_(1),
      mass_(size(), size()),
      rhs_(size()),
      coupled_(modes),
      hinge_turns_(size()),
      at_rest_(Eigen::VectorXd::Zero(size())),
      factor_(size()) {
  const double wave_speed_squared = rig.beam.youngs_modulus / rig.beam.density;
  for (int k = 0; k < axial_; ++k) {
    const double wave_number = axial_wave_number(k + 1, length_);
    stiffness_[1 + k] = wave_speed_squared * wave_number * wave_number;
  }
  stiffness_.tail(bending_) = modes_.omega().cwiseAbs2();
  hinge_row_.tail(bending_) = modes_.rotation_at_hinge();
  if (rig.beam.shears()) {
    const Eigen::MatrixXd rotary = modes_.rotary_inertia();
    rotary_(0, 0) = rotary(0, 0);
    rotary_.row(0).tail(bending_) = rotary.row(0).tail(bending_);
    rotary_.col(0).tail(bending_) = rotary.col(0).tail(bending_);
    rotary_.bottomRightCorner(bending_, bending_) = rotary.bottomRightCorner(bending_, bending_);
  }
  set_stations(modes_.places(fineness_), rig.beam.masses);
  struck_ = section_at(rig.contact.position);
}

void FloatingFrameBeam::set_stations(const std::vector<AssumedModes::Place>& places,
                                     const std::vector<LumpedMass>& masses) {
  FrameStations& all = stations_;
  all.of_bar = static_cast<Eigen::Index>(places.size());
  all.size = all.of_bar + static_cast<Eigen::Index>(masses.size());
  all.x = all.mass = all.pull = Eigen::VectorXd::Zero(all.size);
  Eigen::Index i = 0;
  for (const AssumedModes::Place& place : places) {
    all.x[i] = place.x;
    all.mass[i] = place.mass;
    all.pull[i++] = place.width * place.below;
  }
  for (const LumpedMass& lump : masses) {
    all.x[i] = lump.position;
    all.mass[i++] = lump.mass;
  }
  all.axial.resize(all.size, axial_);
  all.bending.resize(all.size, bending_);
  for (i = 0; i < all.size; ++i) {
    const Station section = section_at(all.x[i]);
    all.axial.row(i) = section.axial;
    all.bending.row(i) = section.bending;
  }
}

FrameEquations& FloatingFrameBeam::equations() const {
  if (equations_) return *equations_;
  std::vector<FramePart> parts;
  for (const BarElement& element : modes_.elements()) parts.push_back({element.x, element.length});
  const int points = parts.empty() ? fineness_ : 5;  // the product of two quadratics
  if (parts.empty()) parts.push_back({0.0, length_});
  Eigen::MatrixXd slopes;
  if (bending_ > 0) {
    const Eigen::VectorXd places = gauss_points(parts, points);
    slopes.resize(places.size(), bending_);
    for (Eigen::Index j = 0; j < places.size(); ++j) slopes.row(j) = modes_.slope(places[j]);
  }
  equations_ = std::make_unique<FrameEquations>(
      FrameIntegrals(stations_, parts, points, std::move(slopes)), gravity_, gravity_across_,
      timoshenko_ ? rotary_ : Eigen::MatrixXd());
  return *equations_;
}

const FloatingFrameBeam::Station& FloatingFrameBeam::struck() const {
  if (!struck_coupled_) struck_ = station_at(struck_.x);
  struck_coupled_ = true;
  return struck_;
}

FloatingFrameBeam::Station FloatingFrameBeam::section_at(double x) const {
  Station station;
  station.x = x;
  station.axial.resize(axial_);
  for (int k = 0; k < axial_; ++k)
    station.axial[k] = axial_scale_ * std::sin(axial_wave_number(k + 1, length_) * x);
  station.bending = modes_.deflection(x);
  return station;
}

void FloatingFrameBeam::add_coupling(double from, double to, int panels,
                                     Eigen::MatrixXd& coupling) const {
  const GaussRule& rule = gauss_legendre(8);
  const auto add = [&](double begin, double end) {
    for (std::size_t i = 0; i < rule.points.size(); ++i) {
      const Eigen::VectorXd slopes = modes_.slope(begin + (end - begin) * rule.points[i]);
      coupling.noalias() += (end - begin) * rule.weights[i] * slopes * slopes.transpose();
    }
  };
  if (modes_.elements().empty()) {
    const double panel = (to - from) / panels;
    for (int p = 0; p < panels; ++p) add(from + panel * p, from + panel * (p + 1));
    return;
  }
  // slopes jump where a section that shears ends
  for (const BarElement& element : modes_.elements()) {
    const double begin = std::max(from, element.x), end = std::min(to, element.x + element.length);
    if (begin < end) add(begin, end);
  }
}

FloatingFrameBeam::Station FloatingFrameBeam::station_at(double x) const {
  Station station = section_at(x);
  station.coupling = Eigen::MatrixXd::Zero(bending_, bending_);
  add_coupling(0.0, x, 2 + bending_, station.coupling);  // one wave of a product a panel
  return station;
}

const FloatingFrameBeam::Station& FloatingFrameBeam::cached_station(double x) const {
  if (x == struck_.x) return struck();
  for (const Station& station : looked_at_)
    if (station.x == x) return station;
  return looked_at_.emplace_back(station_at(x));
}

FloatingFrameBeam::InFrame FloatingFrameBeam::in_frame(const Station& station, ConstVector q,
                                                       ConstVector v) const {
  const auto a = q.segment(1, axial_);
  const auto b = q.tail(bending_);
  look_.noalias() = station.coupling * b;
  return {.x = station.x + station.axial.dot(a) - 0.5 * b.dot(look_),
          .y = station.bending.dot(b),
          .x_rate = station.axial.dot(v.segment(1, axial_)) - look_.dot(v.tail(bending_)),
          .y_rate = station.bending.dot(v.tail(bending_))};
}

Eigen::VectorXd FloatingFrameBeam::inertia_diagonal() const {
  Eigen::VectorXd diagonal = Eigen::VectorXd::Ones(size());
  diagonal[0] = inertia_;
  for (Eigen::Index i = stations_.of_bar; i < stations_.size; ++i) {
    diagonal.segment(1, axial_) += stations_.mass[i] * stations_.axial.row(i).cwiseAbs2();
    diagonal.tail(bending_) += stations_.mass[i] * stations_.bending.row(i).cwiseAbs2();
  }
  return diagonal;
}

void FloatingFrameBeam::set_rigid_motion(double angle, double rate, VectorRef q,
                                         VectorRef v) const {
  q.setZero();
  v.setZero();
  q[0] = -angle;
  v[0] = -rate;
}

bool FloatingFrameBeam::set_steady_motion(double angle, double rate, VectorRef q,
                                          VectorRef v) const {
  set_rigid_motion(angle, rate, q, v);
  if (axial_ == 0) return true;
  const double pull = gravity_ * std::cos(angle) + gravity_across_ * std::sin(angle);
  Eigen::MatrixXd stiffness = stiffness_.segment(1, axial_).asDiagonal();
  stiffness -=
      rate * rate * (stations_.axial.transpose() * stations_.mass.asDiagonal() * stations_.axial);
  const Eigen::VectorXd pulls = stations_.mass.array() * (pull + rate * rate * stations_.x.array());
  const Eigen::VectorXd force = stations_.axial.transpose() * pulls;
  const Eigen::LLT<Eigen::MatrixXd> factor(stiffness);
  if (factor.info() != Eigen::Success) return false;
  q.segment(1, axial_) = factor.solve(force);
  v[0] *= struck_.x / (struck_.x + struck_.axial.dot(q.segment(1, axial_)));
  return true;
}

/// F ∂X/∂q at a station (14)-(17).
void FloatingFrameBeam::add_force(const Station& station, ConstVector q, double force,
                                  VectorRef r) {
  const double sine = std::sin(q[0]);
  const double cosine = std::cos(q[0]);
  const auto bending = q.tail(bending_);
  coupled_.noalias() = station.coupling * bending;
  const double x =
      station.x + station.axial.dot(q.segment(1, axial_)) - 0.5 * bending.dot(coupled_);
  const double y = station.bending.dot(bending);
  r[0] += force * (cosine * x - sine * y);
  r.segment(1, axial_) += force * sine * station.axial;
  r.tail(bending_) += force * (cosine * station.bending - sine * coupled_);
}

void FloatingFrameBeam::add_stop(int stop, ConstVector q, double force, VectorRef r) {
  if (force == 0.0) return;
  if (stop == 0) return add_force(struck(), q, force, r);
  const FurtherStop& there = further_stops_[static_cast<std::size_t>(stop - 1)];
  add_force(cached_station(there.contact.position), q, there.direction() * force, r);
}

/// Springs, dampers and what drives the hinge.
void FloatingFrameBeam::add_springs(ConstVector q, ConstVector v, VectorRef r) const {
  r -= stiffness_.cwiseProduct(q);
  if (damping_.stiffness != 0.0) r -= damping_.stiffness * stiffness_.cwiseProduct(v);
  if (hinge_ != Hinge{})
    r -= (hinge_.spring * hinge_row_.dot(q) + hinge_.viscous * hinge_row_.dot(v)) * hinge_row_;
  if (drive_.moment != 0.0) r -= drive_.moment * hinge_row_;
}

void FloatingFrameBeam::acceleration(ConstVector q, ConstVector v, std::span<const double> forces,
                                     VectorRef a) {
  equations().unbalanced(q, v, at_rest_, rhs_);
  add_springs(q, v, rhs_);
  for (std::size_t i = 0; i < forces.size(); ++i) add_stop(static_cast<int>(i), q, forces[i], rhs_);
  equations().set_mass(q, mass_);
  factor_.compute(mass_);
  a = rhs_;
  factor_.solveInPlace(a);
  if (damping_.mass != 0.0) a -= damping_.mass * v;
  if (drive_.held) hold_hinge(a);
}

void FloatingFrameBeam::unbalanced(ConstMatrix q, ConstMatrix v, ConstMatrix a, ConstMatrix forces,
                                   MatrixRef r) {
  if (damping_.mass != 0.0) {
    with_damping_ = a + damping_.mass * v;
    equations().unbalanced(q, v, with_damping_, r);
  } else {
    equations().unbalanced(q, v, a, r);
  }
  for (Eigen::Index k = 0; k < q.cols(); ++k) {
    add_springs(q.col(k), v.col(k), r.col(k));
    for (Eigen::Index stop = 0; stop < forces.cols(); ++stop)
      add_stop(static_cast<int>(stop), q.col(k), forces(k, stop), r.col(k));
  }
}

void FloatingFrameBeam::set_tangent(ConstVector q, ConstVector v, ConstVector a, Tangent& tangent) {
  rhs_ = a + damping_.mass * v;
  equations().set_tangent(q, v, rhs_, tangent);
  tangent.by_q.diagonal() -= stiffness_;
  tangent.by_v.diagonal() -= damping_.stiffness * stiffness_;
  tangent.by_v -= damping_.mass * tangent.mass;
  hinge_turns_ = hinge_.spring * hinge_row_;
  tangent.by_q.noalias() -= hinge_turns_ * hinge_row_.transpose();
  hinge_turns_ = hinge_.viscous * hinge_row_;
  tangent.by_v.noalias() -= hinge_turns_ * hinge_row_.transpose();
}

void FloatingFrameBeam::set_pressed(ConstVector q, MatrixRef pressed) {
  pressed.setZero();
  for (Eigen::Index stop = 0; stop < pressed.cols(); ++stop)
    add_stop(static_cast<int>(stop), q, 1.0, pressed.col(stop));
}

void FloatingFrameBeam::balance_hinge(MatrixRef forces) const {
  for (int i = 1; i < size(); ++i)
    if (hinge_row_[i] != 0.0) forces.row(i) -= hinge_row_[i] * forces.row(0);
  forces.row(0).setZero();
}

double FloatingFrameBeam::hold_hinge(ConstVector a, double acceleration, VectorRef r) const {
  const double moment = r[0];
  balance_hinge(r);
  r[0] = inertia_ * (hinge_rate(a) - acceleration);
  return moment;
}

void FloatingFrameBeam::hold_hinge(Tangent& tangent) const {
  balance_hinge(tangent.mass);
  balance_hinge(tangent.by_q);
  balance_hinge(tangent.by_v);
  tangent.mass.row(0) = inertia_ * hinge_row_;
}

/// Adds to the accelerations of a free hinge those of the moment that holds it.
void FloatingFrameBeam::hold_hinge(VectorRef a) {
  hinge_turns_ = -hinge_row_;
  factor_.solveInPlace(hinge_turns_);
  holding_moment_ = (drive_.acceleration - hinge_rate(a)) / hinge_rate(hinge_turns_);
  a += holding_moment_ * hinge_turns_;
}

/// Along the bar; what bending shortens grows by half the slope's square.
FloatingFrameBeam::InFrame FloatingFrameBeam::slope_in_frame(double x, ConstVector q,
                                                             ConstVector v) const {
  const Eigen::VectorXd bending = modes_.slope(x);
  Eigen::VectorXd axial(axial_);
  for (int k = 0; k < axial_; ++k) {
    const double wave_number = axial_wave_number(k + 1, length_);
    axial[k] = axial_scale_ * wave_number * std::cos(wave_number * x);
  }
  const double slope = bending.dot(q.tail(bending_)), slope_rate = bending.dot(v.tail(bending_));
  return {.x = 1.0 + axial.dot(q.segment(1, axial_)) - 0.5 * slope * slope,
          .y = slope,
          .x_rate = axial.dot(v.segment(1, axial_)) - slope * slope_rate,
          .y_rate = slope_rate};
}

PointMotion FloatingFrameBeam::motion(const InFrame& p, ConstVector q, ConstVector v) {
  const double sine = std::sin(q[0]);
  const double cosine = std::cos(q[0]);
  return {.displacement = -(sine * p.x + cosine * p.y),
          .velocity = -(v[0] * (cosine * p.x - sine * p.y) + sine * p.x_rate + cosine * p.y_rate)};
}

/// The difference of two displacements, with that of sin and cos as products.
double FloatingFrameBeam::advance(const Station& station, ConstVector from, ConstVector way) const {
  const auto b = way.tail(bending_);
  look_.noalias() = station.coupling * b;
  const double x_way =
      station.axial.dot(way.segment(1, axial_)) - (from.tail(bending_) + 0.5 * b).dot(look_);
  const double y_way = station.bending.dot(b);
  const InFrame p = in_frame(station, from, from);
  const double to = from[0] + way[0], middle = from[0] + 0.5 * way[0];
  const double turned = 2.0 * std::sin(0.5 * way[0]);
  return -(turned * (std::cos(middle) * p.x - std::sin(middle) * p.y) + std::sin(to) * x_way +
           std::cos(to) * y_way);
}

PointMotion FloatingFrameBeam::struck_point(ConstVector q, ConstVector v) const {
  return motion(in_frame(struck(), q, v), q, v);
}

double FloatingFrameBeam::struck_acceleration(ConstVector q, ConstVector v, ConstVector a) const {
  return acceleration_of(struck(), q, v, a);
}

double FloatingFrameBeam::point_acceleration(double x, ConstVector q, ConstVector v,
                                             ConstVector a) const {
  return acceleration_of(cached_station(x), q, v, a);
}

double FloatingFrameBeam::acceleration_of(const Station& station, ConstVector q, ConstVector v,
                                          ConstVector a) const {
  const InFrame p = in_frame(station, q, v);
  const double sine = std::sin(q[0]);
  const double cosine = std::cos(q[0]);
  const auto rate = v.tail(bending_);
  look_.noalias() = station.coupling * rate;
  const double shortening = rate.dot(look_);
  // what a does as a velocity would, and the part that is quadratic in v
  const double quadratic = 2.0 * v[0] * (cosine * p.x_rate - sine * p.y_rate) -
                           v[0] * v[0] * (sine * p.x + cosine * p.y) - sine * shortening;
  return motion(in_frame(station, q, a), q, a).velocity - quadratic;
}

PointMotion FloatingFrameBeam::point(double x, ConstVector q, ConstVector v) const {
  return motion(in_frame(cached_station(x), q, v), q, v);
}

PointMotion FloatingFrameBeam::point_slope(double x, ConstVector q, ConstVector v) const {
  return motion(slope_in_frame(x, q, v), q, v);
}

/// `straight`: x of the straight bar.
FloatingFrameBeam::Departure FloatingFrameBeam::departure(const InFrame& p, double straight,
                                                          ConstVector q) const {
  const double turned = -hinge_angle(q) - q[0];  // of the hinge in the frame
  const double half = std::sin(0.5 * turned);
  return {.deflection = std::sin(turned) * p.x - std::cos(turned) * p.y,
          .extension = p.x - straight - 2.0 * half * half * p.x + std::sin(turned) * p.y};
}

FloatingFrameBeam::Departure FloatingFrameBeam::departure(double x, ConstVector q) const {
  return departure(in_frame(cached_station(x), q, q), x, q);
}

FloatingFrameBeam::Departure FloatingFrameBeam::departure_slope(double x, ConstVector q) const {
  return departure(slope_in_frame(x, q, q), 1.0, q);
}

std::vector<int> FloatingFrameBeam::coordinates_of(double) const {
  std::vector<int> all(static_cast<std::size_t>(size()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// [ψ, b]: axial modes do not move with them. Gravity turns the bar back, and lifts what bending
/// shortens.
SmallMotion FloatingFrameBeam::small_motion() const {
  const int n = 1 + bending_;
  SmallMotion motion;
  motion.mass = motion.stiffness = motion.gravity = Eigen::MatrixXd::Zero(n, n);
  motion.load = small_motion_load();
  motion.rigid = -Eigen::VectorXd::Unit(n, 0);
  motion.hinge = -Eigen::VectorXd::Unit(n, 0);
  motion.hinge.tail(bending_) = -hinge_row_.tail(bending_);
  motion.spring = hinge_.spring;
  motion.mass.diagonal().setOnes();
  motion.mass(0, 0) = inertia_;
  motion.stiffness.diagonal().tail(bending_) = stiffness_.tail(bending_);
  motion.mass.row(0).tail(bending_) = rotary_.row(0).tail(bending_);
  motion.mass.col(0).tail(bending_) = rotary_.col(0).tail(bending_);
  const FrameStations& all = stations_;
  const Eigen::VectorXd moment = all.bending.transpose() * all.mass.cwiseProduct(all.x);
  motion.mass.row(0).tail(bending_) += moment;
  motion.mass.col(0).tail(bending_) += moment;
  motion.gravity(0, 0) = gravity_ * all.mass.dot(all.x);
  motion.gravity.col(0).tail(bending_) = gravity_ * (all.bending.transpose() * all.mass);
  motion.gravity.row(0).tail(bending_) = motion.gravity.col(0).tail(bending_);
  auto bent_mass = motion.mass.bottomRightCorner(bending_, bending_);
  auto bent_gravity = motion.gravity.bottomRightCorner(bending_, bending_);
  for (Eigen::Index i = 0; i < all.of_bar; ++i) {
    // ∫ ρA g H dx = ∫ m g S2'ᵀ S2' dx, m the mass of the bar below
    const Eigen::VectorXd slopes = modes_.slope(all.x[i]);
    bent_gravity += all.pull[i] * gravity_ * slopes * slopes.transpose();
  }
  for (Eigen::Index i = all.of_bar; i < all.size; ++i) {  // m S2ᵀ S2 and m g H of a lumped mass
    bent_mass += all.mass[i] * all.bending.row(i).transpose() * all.bending.row(i);
    bent_gravity += all.mass[i] * gravity_ * station_at(all.x[i]).coupling;
  }
  return motion;
}

Eigen::VectorXd FloatingFrameBeam::small_motion_row(double x) const {
  Eigen::VectorXd row(1 + bending_);
  row[0] = -x;
  row.tail(bending_) = -section_at(x).bending;
  return row;
}

Eigen::MatrixXd FloatingFrameBeam::strains(const Eigen::MatrixXd& own) const {
  return stiffness_.tail(bending_).cwiseSqrt().asDiagonal() * own.bottomRows(bending_);
}

Eigen::VectorXd FloatingFrameBeam::small_motion_load() const {
  Eigen::VectorXd load(1 + bending_);
  load[0] = -gravity_across_ * stations_.mass.dot(stations_.x);
  load.tail(bending_) = -gravity_across_ * (stations_.bending.transpose() * stations_.mass);
  return load;
}

double FloatingFrameBeam::damping_power(ConstVector q, ConstVector v) const {
  const double turning = hinge_row_.dot(v);
  double power =
      hinge_.viscous * turning * turning + damping_.stiffness * v.dot(stiffness_.cwiseProduct(v));
  if (damping_.mass > 0.0) power += 2.0 * damping_.mass * energy(q, v).kinetic;
  return power;
}

BeamEnergy FloatingFrameBeam::energy(ConstVector q, ConstVector v) const {
  BeamEnergy energy;
  energy.elastic = 0.5 * q.dot(stiffness_.cwiseProduct(q));
  energy.spring = 0.5 * hinge_.spring * std::pow(hinge_row_.dot(q), 2);
  equations().kinetic(q, v, kinetic_);
  energy.kinetic = kinetic_[0];
  energy.gravitational = equations().gravitational(q);
  return energy;
}

RigidPart FloatingFrameBeam::rigid_part(ConstVector q, ConstVector v) const {
  RigidPart rigid = equations().rigid_part(q, v);
  rigid.along /= inertia_;
  rigid.angle /= inertia_;
  rigid.rate /= inertia_;
  return rigid;
}

}  // namespace impactrig::models
