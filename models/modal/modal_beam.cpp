// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_beam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/beams/bar_element.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/lanes/mode_lanes.hpp"
#include "models/modal/mode_kernel.hpp"
#include "models/modal/small_motion_modes.hpp"

namespace impactrig::models {

ModalBeam::ModalBeam(const SmallMotionBeam& beam, const Rig& rig)
    : beam_(&beam),
      viscous_(ViscousDamping::of(rig)),
      length_(rig.beam.length),
      struck_position_(rig.contact.position),
      spring_(rig.hinge.spring) {
  if (std::optional<BarModes> modes = beam.modes()) {
    take(*std::move(modes));
    all_digits_ = true;
  } else {
    take(modes_by_matrices(beam.small_motion()));
  }
  find_damping();
  const Eigen::VectorXd load = beam.small_motion_load();
  load_ = rows_.size() > 0 ? Eigen::VectorXd(rows_ * load) : load;
  struck_ = point(rig.contact.position);
  for (const FurtherStop& stop : rig.further_stops)
    further_.push_back(stop.direction() * point(stop.contact.position));
  elastic_compliance_ = models::elastic_compliance(rig.beam, rig.contact.position);
  stations_ = BarStations(
      rig, modes(), [this](double x) { return point(x); },
      beam.axial_modes().value_or(BarStations::most_axial_modes));
  const Eigen::VectorXd frame = beam.frame();
  if (frame.size() > 0) frame_ = rows_.size() > 0 ? Eigen::VectorXd(rows_ * frame) : frame;
  find_stretching();
}

void ModalBeam::find_stretching() {
  const std::vector<BarElement> elements = beam_->stretching_elements();
  axial_.resize(static_cast<Eigen::Index>(elements.size()));
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const BarElement& element = elements[e];
    const double h = element.length;
    axial_[static_cast<Eigen::Index>(e)] = element.axial_stiffness * h;
    // Of slopes p P₁ + q P₂ the bending energy is 2 EI (p² + 3 q²) / h, and (3pq/5)² / 7 +
    // (9q²/35)² / 9 at most 9/2000 of (p² + 3 q²)²; elements share the bar's energy.
    most_stretching_ = std::max(most_stretching_, 9.0 / 16000.0 * element.axial_stiffness * h * h *
                                                      h / std::pow(element.bending_stiffness, 2));
  }
}

const Eigen::MatrixXd& ModalBeam::uneven_slopes() const {
  std::call_once(uneven_->found, [this] {
    const std::vector<BarElement> elements = beam_->stretching_elements();
    const auto count = static_cast<Eigen::Index>(elements.size());
    Eigen::MatrixXd slopes(modes(), 2 * count);
    for (Eigen::Index e = 0; e < count; ++e) {
      const BarElement& element = elements[static_cast<std::size_t>(e)];
      const double h = element.length;
      const auto across = [&](double xi) { return point(element.x + xi * h); };
      const Eigen::VectorXd first = across(0.0), low = across(1.0 / 3.0), high = across(2.0 / 3.0);
      const Eigen::VectorXd second = first - 2.0 * low + high;
      const Eigen::VectorXd third = across(1.0) - first + 3.0 * (low - high);
      const Eigen::VectorXd cubic = 4.5 * third, square = 4.5 * second - cubic;
      slopes.col(2 * e) = (square + 1.5 * cubic) / h;
      slopes.col(2 * e + 1) = 0.5 * cubic / h;
    }
    uneven_->matrix = slopes.transpose();
  });
  return uneven_->matrix;
}

const Eigen::MatrixXd& ModalBeam::whole_weight() const {
  if (weight_.rows() == modes()) return weight_;
  std::call_once(whole_weight_->found, [this] {
    whole_weight_->matrix = rows_ * beam_->small_motion().gravity * rows_.transpose();
  });
  return whole_weight_->matrix;
}

double ModalBeam::stretching_energy(const Eigen::VectorXd& a) const {
  static thread_local Eigen::VectorXd slope;
  slope.noalias() = uneven_slopes() * a;
  double energy = 0.0;
  for (Eigen::Index e = 0; e < axial_.size(); ++e) {
    const double first = slope[2 * e], second = slope[2 * e + 1];
    const double third = 3.0 / 5.0 * first * second, fourth = 9.0 / 35.0 * second * second;
    energy += 0.5 * axial_[e] * (third * third / 7.0 + fourth * fourth / 9.0);
  }
  return energy;
}

void ModalBeam::add_stretching_force(const Eigen::VectorXd& a, const Eigen::VectorXd& rate,
                                     Eigen::VectorXd& force) const {
  static thread_local Eigen::VectorXd slope, slope_rate, pull;
  const Eigen::MatrixXd& uneven = uneven_slopes();
  slope.noalias() = uneven * a;
  const bool creeps = viscous_.stiffness > 0.0;
  if (creeps) slope_rate.noalias() = uneven * rate;
  pull.resize(slope.size());
  for (Eigen::Index e = 0; e < axial_.size(); ++e) {
    const double first = slope[2 * e], second = slope[2 * e + 1];
    double third = 3.0 / 5.0 * first * second, fourth = 9.0 / 35.0 * second * second;
    if (creeps) {
      const double first_rate = slope_rate[2 * e], second_rate = slope_rate[2 * e + 1];
      third += viscous_.stiffness * 3.0 / 5.0 * (first_rate * second + first * second_rate);
      fourth += viscous_.stiffness * 18.0 / 35.0 * second * second_rate;
    }
    pull[2 * e] = axial_[e] * third / 7.0 * 3.0 / 5.0 * second;
    pull[2 * e + 1] =
        axial_[e] * (third / 7.0 * 3.0 / 5.0 * first + fourth / 9.0 * 18.0 / 35.0 * second);
  }
  force.noalias() -= uneven.transpose() * pull;
}

ModalBeam::ModalBeam(const ModalBeam& other, const Change& change) : ModalBeam(other) {
  hang(change.heaviness(), change.spring / change.stiffness);
  scale(change.stiffness, change.mass);
  viscous_.hinge = change.viscous;
  find_damping();
}

/// Of what depends on the weight the pendulum's frequency does so by its root; its square is
/// smooth.
void ModalBeam::become_between(std::span<const ModalBeam* const> others,
                               std::span<const double> weights, const Change& change) {
  *this = *others.front();
  std::vector<const double*> arrays(others.size());
  const auto interpolate = [&](const auto& part) {
    std::ranges::transform(others, arrays.begin(),
                           [&](const ModalBeam* other) { return part(*other).data(); });
    auto& to = part(*this);
    find_sum({.count = static_cast<int>(to.size()),
              .terms = static_cast<int>(others.size()),
              .arrays = arrays.data(),
              .weights = weights.data(),
              .sum = to.data()});
  };
  omega_ = weights[0] * omega_.cwiseAbs2();
  for (std::size_t j = 1; j < others.size(); ++j)
    omega_ += weights[j] * others[j]->omega_.cwiseAbs2();
  omega_ = omega_.cwiseMax(0.0).cwiseSqrt();
  for (const auto vector : {&ModalBeam::struck_, &ModalBeam::rigid_, &ModalBeam::load_,
                            &ModalBeam::hinge_, &ModalBeam::frame_})
    interpolate([&](auto& beam) -> auto& { return beam.*vector; });
  for (const auto matrix : {&ModalBeam::rows_, &ModalBeam::weight_})
    interpolate([&](auto& beam) -> auto& { return beam.*matrix; });
  interpolate([](auto& beam) -> auto& { return beam.stations_.slopes; });
  interpolate([](auto& beam) -> auto& { return beam.stations_.weight; });
  scale(change.stiffness, change.mass);
  find_damping();
}

/// In the modes so far the elastic part stays, the weight becomes so many times what it is, and a
/// spring is added.
void ModalBeam::hang(double weight, double spring) {
  const Eigen::MatrixXd& whole = whole_weight();
  Eigen::MatrixXd coupled = (weight - 1.0) * whole + spring * hinge_ * hinge_.transpose();
  coupled.diagonal() += omega_.cwiseAbs2();
  Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(modes(), modes());
  diagonalise(coupled, basis);
  omega_ = coupled.diagonal().cwiseMax(0.0).cwiseSqrt();
  weight_ = weight * (basis.transpose() * whole * basis);
  rows_ = basis.transpose() * rows_;
  stations_.slopes = stations_.slopes * basis;
  stations_.weight *= weight;
  struck_ = basis.transpose() * struck_;
  if (frame_.size() > 0) frame_ = basis.transpose() * frame_;
  for (Eigen::VectorXd& row : further_) row = basis.transpose() * row;
  hinge_ = basis.transpose() * hinge_;
  rigid_ = basis.transpose() * rigid_;
  load_ = weight * (basis.transpose() * load_);
  spring_ = spring;
}

/// A bar with all its moduli and its spring, and all its masses, times these, under a weight a mass
/// that grows with the moduli.
void ModalBeam::scale(double stiffness, double mass) {
  const double square = stiffness / mass;
  const double root = std::sqrt(mass);
  omega_ *= std::sqrt(square);
  weight_ *= square;
  spring_ *= stiffness;
  elastic_compliance_ /= stiffness;
  rows_ /= root;
  struck_ /= root;
  frame_ /= root;
  for (Eigen::VectorXd& row : further_) row /= root;
  hinge_ /= root;
  rigid_ *= root;
  load_ *= square * root;
  stations_.scale(stiffness, mass);
  axial_ *= stiffness;
  most_stretching_ /= stiffness;
  uneven_ = std::make_shared<Late>();
  whole_weight_ = std::make_shared<Late>();
}

void ModalBeam::take(BarModes modes) {
  omega_ = modes.squares.cwiseMax(0.0).cwiseSqrt();  // a weightless pendulum: zero
  rows_ = std::move(modes.rows);
  weight_ = std::move(modes.weight);
  hinge_ = std::move(modes.hinge);
  rigid_ = std::move(modes.rigid);
}

/// The eigenvalues err by a part of the largest's last digit: by 0.002 to 0.05 of it, measured on
/// meshes of 5 to 130 elements.
double ModalBeam::rounding() const {
  constexpr double share = 0.1;
  if (all_digits_) return 0.0;
  if (modes() < 3) return 0.0;
  const double ratio = omega_[modes() - 1] / omega_[1];
  return share * std::numeric_limits<double>::epsilon() * ratio * ratio;
}

/// The elastic stiffness in a mode is what weight and spring leave of ω².
void ModalBeam::find_damping() {
  damped_ = viscous_ != ViscousDamping{};
  damping_.setZero(modes());
  if (!damped_) return;
  const Eigen::ArrayXd turned = hinge_.array().square();
  const Eigen::ArrayXd squares = omega_.array().square();
  Eigen::ArrayXd elastic = squares - spring_ * turned;
  elastic.head(weight_.rows()) -= weight_.diagonal().array();
  elastic = (elastic > 1e-12 * squares).select(elastic, 0.0);  // a rigid bar's is rounding
  damping_ = viscous_.mass + viscous_.stiffness * elastic + viscous_.hinge * turned;
}

double ModalBeam::fastest() const {
  double fastest = 0.0;
  for (Eigen::Index i = 0; i < omega_.size(); ++i)
    fastest = std::max(fastest, ModeKernel(omega_[i], damping_[i]).fastest_rate());
  return fastest;
}

void ModalBeam::coupled_drag(const Eigen::VectorXd& a, Eigen::VectorXd& drag) const {
  const Eigen::Index held = weight_.rows();
  drag.setZero(a.size());
  drag.head(held).noalias() = -viscous_.stiffness * (weight_ * a.head(held));
  drag.head(held).array() += viscous_.stiffness * weight_.diagonal().array() * a.head(held).array();
  const double hinge = viscous_.hinge - viscous_.stiffness * spring_;
  const double turned = hinge_.dot(a);
  drag.array() += hinge * (turned * hinge_.array() - hinge_.array().square() * a.array());
}

ModalSlope ModalBeam::slope(const BarInModes& change) const {
  const Eigen::Index m = omega_.size();
  const SmallMotion motion = beam_->small_motion();
  const SmallMotion& by = change.motion;
  const Eigen::MatrixXd shapes = rows_.transpose();
  const Eigen::MatrixXd strains = beam_->strains(own_values());
  const Eigen::VectorXd& h = motion.hinge;
  // of forms of the shapes as they move: half of each, the other is its transpose
  const Eigen::VectorXd turn = change.shapes.transpose() * h + rows_ * by.hinge;
  Eigen::MatrixXd k = strains.transpose() * change.strains +
                      rows_ * (motion.gravity * change.shapes + 0.5 * by.gravity * shapes) +
                      hinge_ * (motion.spring * turn + 0.5 * by.spring * hinge_).transpose();
  Eigen::MatrixXd mass = rows_ * (motion.mass * change.shapes + 0.5 * by.mass * shapes);
  k += k.transpose().eval();
  mass += mass.transpose().eval();
  Eigen::MatrixXd turned(m, m);  // column k: mode k's change in the modes
  for (Eigen::Index i = 0; i < m; ++i)
    for (Eigen::Index j = 0; j < m; ++j) {
      const double square = omega_[i] * omega_[i];
      turned(j, i) = i == j ? -0.5 * mass(i, i)
                            : (k(j, i) - square * mass(j, i)) / (square - omega_[j] * omega_[j]);
    }
  ModalSlope slope;
  slope.shapes = change.shapes + shapes * turned;
  slope.omega.resize(m);
  for (Eigen::Index i = 0; i < m; ++i)
    slope.omega[i] =
        omega_[i] > 0.0 ? (k(i, i) - omega_[i] * omega_[i] * mass(i, i)) / (2.0 * omega_[i]) : 0.0;
  const Eigen::ArrayXd turned_change =
      2.0 * hinge_.array() * (rows_ * by.hinge + slope.shapes.transpose() * h).array();
  const auto with_strains = [&strains](const Eigen::MatrixXd& others) {
    return strains.cwiseProduct(others).colwise().sum().transpose().array().eval();
  };
  const ViscousDamping& damping = change.damping;
  slope.damping =
      damping.mass + damping.hinge * hinge_.array().square() + viscous_.hinge * turned_change;
  if (damping.stiffness != 0.0 || viscous_.stiffness != 0.0)
    slope.damping.array() +=
        damping.stiffness * with_strains(strains) +
        2.0 * viscous_.stiffness * with_strains(change.strains + strains * turned);
  slope.load = row_slope(slope, motion.load, by.load);
  slope.rigid = slope.shapes.transpose() * (motion.mass * motion.rigid) +
                rows_ * (by.mass * motion.rigid + motion.mass * by.rigid);
  return slope;
}

ModalBeam ModalBeam::moved(const ModalSlope& slope, double amount) const {
  ModalBeam bar = *this;
  bar.omega_ += amount * slope.omega;
  bar.damping_ += amount * slope.damping;
  bar.damped_ = damped_ || slope.damping.any();
  bar.struck_ += amount * slope.struck;
  for (std::size_t k = 0; k < further_.size(); ++k) bar.further_[k] += amount * slope.further[k];
  bar.rigid_ += amount * slope.rigid;
  bar.load_ += amount * slope.load;
  return bar;
}

ModalBeam ModalBeam::only(const std::vector<Eigen::Index>& modes) const {
  ModalBeam few = *this;
  for (Eigen::VectorXd* const values :
       {&few.omega_, &few.damping_, &few.struck_, &few.rigid_, &few.load_, &few.hinge_})
    *values = (*values)(modes).eval();
  for (Eigen::VectorXd& row : few.further_) row = row(modes).eval();
  return few;
}

ModalBeam ModalBeam::with_mode(double omega, double damping, double struck) const {
  ModalBeam more = *this;
  const auto append = [](double value, Eigen::VectorXd& values) {
    values.conservativeResize(values.size() + 1);
    values.tail<1>()[0] = value;
  };
  append(omega, more.omega_);
  append(damping, more.damping_);
  append(struck, more.struck_);
  append(0.0, more.rigid_);
  append(0.0, more.load_);
  append(0.0, more.hinge_);
  for (Eigen::VectorXd& row : more.further_) append(0.0, row);
  more.damped_ = damped_ || damping != 0.0;
  return more;
}

Eigen::VectorXd ModalBeam::point(double x) const {
  const Eigen::VectorXd row = beam_->small_motion_row(x);
  if (rows_.size() == 0) return row;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(modes());
  for (Eigen::Index i = 0; i < row.size(); ++i)  // only an element's values move a point of a mesh
    if (row[i] != 0.0) sum += row[i] * rows_.col(i);
  return sum;
}

Eigen::VectorXd ModalBeam::point_slope(double x) const {
  constexpr double part = 1e-5;  // of the length: bending waves of the highest modes are longer
  const double low = std::max(x - part * length_, 0.0);
  const double high = std::min(x + part * length_, length_);
  return (point(high) - point(low)) / (high - low);
}

BeamEnergy ModalBeam::energy(const Eigen::VectorXd& a, const Eigen::VectorXd& rate) const {
  static thread_local Eigen::VectorXd weighed;  // asked for at every step: no allocation
  const auto held = a.head(weight_.rows());
  weighed.noalias() = weight_ * held;
  const double gravitational = 0.5 * held.dot(weighed);
  const double turned = hinge_.dot(a);
  const double spring = 0.5 * spring_ * turned * turned;
  // the elastic energy of q itself would drown in what a rigid rotation leaves of rounding
  const double potential = 0.5 * omega_.cwiseProduct(a).squaredNorm();
  return {.kinetic = 0.5 * rate.squaredNorm(),
          .elastic = potential - gravitational - spring,
          .spring = spring,
          .gravitational = gravitational};
}

RigidPart ModalBeam::rigid_part(const Eigen::VectorXd& a, const Eigen::VectorXd& rate) const {
  const double inertia = rigid_.squaredNorm();
  return {.angle = rigid_.dot(a) / inertia, .rate = rigid_.dot(rate) / inertia};
}

}  // namespace impactrig::models
