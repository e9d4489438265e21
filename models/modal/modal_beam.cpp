// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_beam.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "models/beams/bar_element.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/lanes/mode_lanes.hpp"
#include "models/lanes/station_lanes.hpp"
#include "models/modal/mode_kernel.hpp"

namespace impactrig::models {

namespace {

/// Jacobi's method for a nearly diagonal symmetric matrix, to the relative accuracy of each of its
/// entries; the rotations are gathered in the columns of `basis`. [GolubVanLoan2013, 8.5]
void diagonalise(Eigen::MatrixXd& matrix, Eigen::MatrixXd& basis) {
  const Eigen::Index n = matrix.rows();
  // both triangles are kept, so that all that is turned are columns
  const auto turn = [n](double* p, double* q, double c, double s) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const double x = p[k], y = q[k];
      p[k] = c * x - s * y;
      q[k] = s * x + c * y;
    }
  };
  for (int sweep = 0; sweep < 30; ++sweep) {
    bool rotated = false;
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = i + 1; j < n; ++j) {
        const double mixed = matrix(i, j), first = matrix(i, i), second = matrix(j, j);
        if (mixed * mixed <= 1e-32 * std::abs(first * second)) continue;
        const double slope = 0.5 * (second - first) / mixed;
        const double t =
            std::copysign(1.0, slope) / (std::abs(slope) + std::sqrt(1.0 + slope * slope));
        const double c = 1.0 / std::sqrt(1.0 + t * t), s = t * c;
        turn(matrix.col(i).data(), matrix.col(j).data(), c, s);
        matrix.row(i) = matrix.col(i).transpose();
        matrix.row(j) = matrix.col(j).transpose();
        matrix(i, i) = first - t * mixed;
        matrix(j, j) = second + t * mixed;
        matrix(i, j) = matrix(j, i) = 0.0;
        turn(basis.col(i).data(), basis.col(j).data(), c, s);
        rotated = true;
      }
    if (!rotated) return;
  }
}

/// Of a bending wave of a given frequency, how many are in the piece; only ratios matter.
double waves(const BarElement& piece) {
  return piece.length * piece.wave_number();
}

/// The bar's pieces, those alike taken together, cut at the struck point.
std::vector<BarElement> unlike_spans(const Rig& rig) {
  std::vector<BarElement> spans;
  for (const BarElement& piece : bar_pieces(rig.beam)) {
    const bool like = !spans.empty() && spans.back().line_density == piece.line_density &&
                      spans.back().bending_stiffness == piece.bending_stiffness;
    if (like)
      spans.back().length = piece.x + piece.length - spans.back().x;
    else
      spans.push_back(piece);
  }
  const double struck = rig.contact.position;
  const std::size_t cut = element_at(spans, struck);
  const double before = struck - spans[cut].x, beyond = spans[cut].length - before;
  const double shortest = 1e-9 * rig.beam.length;
  if (before <= shortest || beyond <= shortest) return spans;
  BarElement second = spans[cut];
  spans[cut].length = before;
  second.x = struck;
  second.length = beyond;
  spans.insert(spans.begin() + static_cast<std::ptrdiff_t>(cut) + 1, second);
  return spans;
}

/// Two a half wave of the fastest mode, or of the slow ones that move most of a mesh with many.
std::vector<BarElement> station_spans(const Rig& rig, int modes) {
  constexpr std::size_t fewest_of_span = 2;
  const auto usual = static_cast<std::size_t>(std::clamp(2 * modes, 24, 48));
  const std::vector<BarElement> spans = unlike_spans(rig);
  std::vector<std::size_t> shares(spans.size(), fewest_of_span);
  for (std::size_t all = fewest_of_span * spans.size(); all < usual; ++all) {
    std::size_t coarsest = 0;
    for (std::size_t i = 1; i < spans.size(); ++i)
      if (waves(spans[i]) * static_cast<double>(shares[coarsest]) >
          waves(spans[coarsest]) * static_cast<double>(shares[i]))
        coarsest = i;
    ++shares[coarsest];
  }
  std::vector<BarElement> stations;
  for (std::size_t i = 0; i < spans.size(); ++i)
    for (std::size_t k = 0; k < shares[i]; ++k) {
      BarElement station = spans[i];
      station.length /= static_cast<double>(shares[i]);
      station.x += static_cast<double>(k) * station.length;
      stations.push_back(station);
    }
  return stations;
}

}  // namespace

ModalBeam::ModalBeam(const SmallMotionBeam& beam, const Rig& rig)
    : beam_(&beam),
      viscous_(ViscousDamping::of(rig)),
      length_(rig.beam.length),
      struck_position_(rig.contact.position),
      spring_(rig.hinge.spring) {
  if (std::optional<BarModes> modes = beam.modes())
    take(*std::move(modes));
  else
    solve(beam.small_motion());
  find_damping();
  struck_ = point(rig.contact.position);
  for (const FurtherStop& stop : rig.further_stops)
    further_.push_back(stop.direction() * point(stop.contact.position));
  elastic_compliance_ = models::elastic_compliance(rig.beam, rig.contact.position);
  find_stations(rig);
  find_stretching();
}

void ModalBeam::find_stations(const Rig& rig) {
  const std::vector<BarElement> spans = station_spans(rig, modes());
  const auto count = static_cast<Eigen::Index>(spans.size());
  for (Eigen::VectorXd* values : {&stations_.x, &stations_.length, &stations_.mass})
    values->resize(count);
  Eigen::MatrixXd slopes(modes(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const BarElement& span = spans[static_cast<std::size_t>(i)];
    stations_.x[i] = span.x;
    stations_.length[i] = span.length;
    stations_.mass[i] = span.line_density * span.length;
    slopes.col(i) = (point(span.x + span.length) - point(span.x)) / span.length;
  }
  stations_.slopes = slopes.transpose();
  for (const LumpedMass& lump : rig.beam.masses) {
    const auto station = static_cast<Eigen::Index>(element_at(spans, lump.position));
    const double part = (lump.position - stations_.x[station]) / stations_.length[station];
    stations_.lumps.push_back({station, std::min(part, 1.0), lump.mass});
  }
  stations_.weight = stations_.mass;
  for (const Stations::Lump& lump : stations_.lumps) stations_.weight[lump.station] += lump.mass;
  Stations::add_up_from_tip(stations_.weight);
  stations_.weight *= rig.gravity_along();
  stations_.bending.resize(count - 1);
  for (Eigen::Index i = 0; i + 1 < count; ++i) {
    const BarElement& here = spans[static_cast<std::size_t>(i)];
    const BarElement& next = spans[static_cast<std::size_t>(i) + 1];
    stations_.bending[i] =
        2.0 / (here.length / here.bending_stiffness + next.length / next.bending_stiffness);
  }
  find_axial_modes(spans);
  const Eigen::VectorXd frame = beam_->frame();
  if (frame.size() > 0) frame_ = rows_.size() > 0 ? Eigen::VectorXd(rows_ * frame) : frame;
}

void ModalBeam::Stations::add_up_from_tip(Eigen::VectorXd& values) {
  double beyond = 0.0;
  for (Eigen::Index i = values.size() - 1; i >= 0; --i) {
    const double own = values[i];
    values[i] = beyond + 0.5 * own;
    beyond += own;
  }
}

/// Ritz' of those of a uniform bar, sin((k - ½) π x / L). Faster ones hardly move, and the stations
/// could not tell them apart.
void ModalBeam::find_axial_modes(const std::vector<BarElement>& spans) {
  constexpr int most = 8;
  const int modes = std::min(beam_->axial_modes().value_or(most), most);
  const Eigen::Index count = stations_.x.size();
  const auto lumps = static_cast<Eigen::Index>(stations_.lumps.size());
  stations_.stretch = Eigen::VectorXd::Zero(count);
  stations_.axial.resize(count + lumps, modes);
  stations_.axial_squares.resize(modes);
  if (modes == 0) return;
  const auto at = [&](double x) {
    Eigen::VectorXd shapes(modes);
    for (int k = 0; k < modes; ++k)
      shapes[k] = std::sin((k + 0.5) * std::numbers::pi * x / length_);
    return shapes;
  };
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(modes, modes), stiffness = mass;
  const auto add = [&](Eigen::Index row, double x, double share) {
    const Eigen::VectorXd shapes = at(x);
    stations_.axial.row(row) = shapes;
    mass.selfadjointView<Eigen::Lower>().rankUpdate(shapes, share);
  };
  for (Eigen::Index i = 0; i < count; ++i) {
    const double x = stations_.x[i], length = stations_.length[i];
    const double axial = spans[static_cast<std::size_t>(i)].axial_stiffness;
    stations_.stretch[i] = length / axial;
    add(i, stations_.middle(i), stations_.mass[i]);
    stiffness.selfadjointView<Eigen::Lower>().rankUpdate(at(x + length) - at(x), axial / length);
  }
  for (Eigen::Index l = 0; l < lumps; ++l) {
    const Stations::Lump& lump = stations_.lumps[static_cast<std::size_t>(l)];
    add(count + l, stations_.place(lump), lump.mass);
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
  stations_.axial_squares = solver.eigenvalues();
  stations_.axial *= solver.eigenvectors();
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

void ModalBeam::add_stretching_force(const Eigen::VectorXd& a, Eigen::VectorXd& force) const {
  static thread_local Eigen::VectorXd slope, pull;
  const Eigen::MatrixXd& uneven = uneven_slopes();
  slope.noalias() = uneven * a;
  pull.resize(slope.size());
  for (Eigen::Index e = 0; e < axial_.size(); ++e) {
    const double first = slope[2 * e], second = slope[2 * e + 1];
    const double third = 3.0 / 5.0 * first * second, fourth = 9.0 / 35.0 * second * second;
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
  for (const auto vector :
       {&ModalBeam::struck_, &ModalBeam::rigid_, &ModalBeam::hinge_, &ModalBeam::frame_})
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
  stations_.slopes /= root;
  stations_.mass *= mass;
  for (Stations::Lump& lump : stations_.lumps) lump.mass *= mass;
  stations_.bending *= stiffness;
  stations_.weight *= stiffness;
  stations_.stretch /= stiffness;
  stations_.axial /= root;
  stations_.axial_squares *= square;
  axial_ *= stiffness;
  most_stretching_ /= stiffness;
  uneven_ = std::make_shared<Late>();
  whole_weight_ = std::make_shared<Late>();
}

/// The rigid rotation is taken out first: its only stiffness is that of weight and spring, which a
/// rounding error of the highest modes' would drown. The bending modes among themselves are then
/// solved as they are, and what weight and spring couple them to the rotation by rotations of
/// pairs.
void ModalBeam::solve(const SmallMotion& motion) {
  constexpr Eigen::Index most = 700;  // the work grows with the cube of the number
  const Eigen::Index n = motion.rigid.size();
  if (n > most)
    throw std::runtime_error("two of the bar's modes are too close to be told apart in short time");
  const Eigen::LLT<Eigen::MatrixXd> mass(motion.mass);
  if (mass.info() != Eigen::Success)
    throw std::runtime_error("the bar's mass matrix is not positive definite");
  const auto scaled = [&](const Eigen::MatrixXd& matrix) {
    const Eigen::MatrixXd half = mass.matrixL().solve(matrix);
    return Eigen::MatrixXd(mass.matrixL().solve(half.transpose()));
  };
  Eigen::VectorXd rigid = mass.matrixU() * motion.rigid;
  rigid.normalize();
  const Eigen::HouseholderQR<Eigen::MatrixXd> reflection(rigid);
  const Eigen::MatrixXd reflector = reflection.householderQ() * Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd elastic = reflector.transpose() * scaled(motion.stiffness) * reflector;
  const Eigen::MatrixXd weight = reflector.transpose() * scaled(motion.gravity) * reflector;
  const Eigen::VectorXd hinge = reflector.transpose() * mass.matrixL().solve(motion.hinge);
  const Eigen::MatrixXd restoring = weight + motion.spring * hinge * hinge.transpose();

  Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd coupled = Eigen::MatrixXd::Zero(n, n);
  coupled(0, 0) = restoring(0, 0);
  if (n > 1) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> bending(
        elastic.bottomRightCorner(n - 1, n - 1) + restoring.bottomRightCorner(n - 1, n - 1));
    if (bending.info() != Eigen::Success)
      throw std::runtime_error("the bar's modes could not be computed");
    basis.bottomRightCorner(n - 1, n - 1) = bending.eigenvectors();
    coupled.diagonal().tail(n - 1) = bending.eigenvalues();
    coupled.row(0).tail(n - 1) = restoring.row(0).tail(n - 1) * bending.eigenvectors();
    coupled.col(0).tail(n - 1) = coupled.row(0).tail(n - 1).transpose();
    diagonalise(coupled, basis);
  }
  omega_ = coupled.diagonal().cwiseMax(0.0).cwiseSqrt();  // a weightless pendulum: zero
  const Eigen::MatrixXd shapes = mass.matrixU().solve(reflector * basis);
  rows_ = shapes.transpose();
  weight_ = basis.transpose() * weight * basis;
  hinge_ = basis.transpose() * hinge;
  rigid_ = rows_ * (motion.mass * motion.rigid);
}

void ModalBeam::take(BarModes modes) {
  omega_ = modes.squares.cwiseMax(0.0).cwiseSqrt();  // a weightless pendulum: zero
  rows_ = std::move(modes.rows);
  weight_ = std::move(modes.weight);
  hinge_ = std::move(modes.hinge);
  rigid_ = std::move(modes.rigid);
  all_digits_ = true;
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

ModalSlope ModalBeam::slope(const SmallMotion& change, const ViscousDamping& damping) const {
  const Eigen::Index m = omega_.size();
  const SmallMotion motion = beam_->small_motion();
  const Eigen::MatrixXd shapes = rows_.transpose();
  const Eigen::VectorXd& h = motion.hinge;
  const Eigen::MatrixXd coupled = motion.spring * (change.hinge * h.transpose());
  const Eigen::MatrixXd stiffness = change.stiffness + change.gravity + coupled +
                                    coupled.transpose() + change.spring * h * h.transpose();
  const Eigen::MatrixXd k = rows_ * stiffness * shapes;
  const Eigen::MatrixXd mass = rows_ * change.mass * shapes;
  Eigen::MatrixXd turned(m, m);  // column k: mode k's change in the modes
  for (Eigen::Index i = 0; i < m; ++i)
    for (Eigen::Index j = 0; j < m; ++j) {
      const double square = omega_[i] * omega_[i];
      turned(j, i) = i == j ? -0.5 * mass(i, i)
                            : (k(j, i) - square * mass(j, i)) / (square - omega_[j] * omega_[j]);
    }
  ModalSlope slope;
  slope.shapes = shapes * turned;
  slope.omega.resize(m);
  for (Eigen::Index i = 0; i < m; ++i)
    slope.omega[i] =
        omega_[i] > 0.0 ? (k(i, i) - omega_[i] * omega_[i] * mass(i, i)) / (2.0 * omega_[i]) : 0.0;
  const Eigen::ArrayXd turned_change =
      2.0 * hinge_.array() * (rows_ * change.hinge + slope.shapes.transpose() * h).array();
  const auto in_modes = [&](const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& other) {
    return (shapes.array() * (matrix * other).array()).colwise().sum().transpose().eval();
  };
  slope.damping =
      damping.mass + damping.hinge * hinge_.array().square() + viscous_.hinge * turned_change;
  if (damping.stiffness != 0.0 || viscous_.stiffness != 0.0)
    slope.damping.array() += damping.stiffness * in_modes(motion.stiffness, shapes) +
                             viscous_.stiffness * (in_modes(change.stiffness, shapes) +
                                                   2.0 * in_modes(motion.stiffness, slope.shapes));
  slope.rigid = slope.shapes.transpose() * (motion.mass * motion.rigid) +
                rows_ * (change.mass * motion.rigid + motion.mass * change.rigid);
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
  return bar;
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
  for (Eigen::VectorXd& row : more.further_) append(0.0, row);
  more.damped_ = damped_ || damping != 0.0;
  return more;
}

void ModalBeam::find_slopes(const Eigen::VectorXd& a, const Eigen::VectorXd& rate,
                            StationSlopes& to) const {
  to.slope.resize(stations_.slopes.rows());
  to.rate.resize(stations_.slopes.rows());
  models::find_slopes({.stations = static_cast<int>(stations_.slopes.rows()),
                       .modes = modes(),
                       .slopes = stations_.slopes.data(),
                       .a = a.data(),
                       .rate = rate.data(),
                       .slope = to.slope.data(),
                       .slope_rate = to.rate.data()});
}

double ModalBeam::shorten(const StationSlopes& slopes, Eigen::VectorXd& momentum) const {
  const auto count = static_cast<std::size_t>(slopes.slope.size());
  momentum.resize(slopes.slope.size());
  const std::span slope(slopes.slope.data(), count), rate(slopes.rate.data(), count);
  const std::span length(stations_.length.data(), count), mass(stations_.mass.data(), count);
  const std::span of(momentum.data(), count);
  double drawn = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double step = slope[i] * rate[i] * length[i];
    const double middle = drawn + 0.5 * step;
    of[i] = mass[i] * middle;
    energy += 0.5 * of[i] * middle;
    drawn += step;
  }
  for (const Stations::Lump& lump : stations_.lumps) {
    const auto station = static_cast<std::size_t>(lump.station);
    double speed = lump.part * slope[station] * rate[station] * length[station];
    for (std::size_t i = 0; i < station; ++i) speed += slope[i] * rate[i] * length[i];
    of[station] += lump.mass * speed;
    energy += 0.5 * lump.mass * speed * speed;
  }
  return energy;
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
