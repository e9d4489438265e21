// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/frame_equations.hpp"

#include <cmath>
#include <utility>

#include "models/lanes/product_lanes.hpp"

namespace impactrig::models {

FrameEquations::FrameEquations(FrameIntegrals integrals, double along, double across,
                               Eigen::MatrixXd rotary)
    : bar_(std::move(integrals)),
      along_(along),
      across_(across),
      rotary_(std::move(rotary)),
      axial_(bar_.axial.size()),
      bending_(bar_.bending.size()),
      points_(bar_.slopes.rows()) {
  at_.slope = at_.half_square = at_.run_x = at_.run_y = weights_ = Eigen::VectorXd::Zero(points_);
  turned_ = turned_rate_ = run_turned_ = weighted_ = Eigen::MatrixXd::Zero(points_, bending_);
  of_turned_ = Eigen::MatrixXd::Zero(bending_, points_);
  across_turned_ = across_rate_ = Eigen::MatrixXd::Zero(bending_, bending_);
  along_turned_ = Eigen::MatrixXd::Zero(axial_, bending_);
  residual_ = turn_ = Eigen::VectorXd::Zero(1 + axial_ + bending_);
}

FrameEquations::Weight FrameEquations::weight_at(double angle) const {
  const double sine = std::sin(angle), cosine = std::cos(angle);
  return {.along = along_ * cosine - across_ * sine, .across = -along_ * sine - across_ * cosine};
}

void FrameEquations::go_to(ConstVector q) {
  const auto a = q.segment(1, axial_);
  const auto b = q.tail(bending_);
  at_.slope.noalias() = bar_.slopes * b;
  at_.half_square = 0.5 * at_.slope.cwiseAbs2();
  bar_.run_run.multiply(at_.half_square, weights_);
  at_.run_x = bar_.run_moment - weights_;
  at_.run_x.noalias() += bar_.run_axial * a;
  at_.run_y.noalias() = bar_.run_bending * b;
  at_.axial_x = bar_.axial_moment;
  at_.axial_x.noalias() += bar_.axial_axial * a;
  at_.axial_x.noalias() -= bar_.run_axial.transpose() * at_.half_square;
  at_.axial_y.noalias() = bar_.axial_bending * b;
  at_.bending_gained.noalias() = bar_.axial_bending.transpose() * a;
  at_.bending_gained.noalias() -= bar_.run_bending.transpose() * at_.half_square;
  at_.bending_x = bar_.bending_moment + at_.bending_gained;
  at_.bending_y.noalias() = bar_.bending_bending * b;
  at_.x = bar_.moment + bar_.axial.dot(a) - bar_.run.dot(at_.half_square);
  at_.y = bar_.bending.dot(b);
  const double gained = bar_.axial_moment.dot(a) - bar_.run_moment.dot(at_.half_square);
  at_.moment_x = bar_.inertia + gained;
  at_.inertia_gained =
      gained + at_.axial_x.dot(a) - at_.run_x.dot(at_.half_square) + at_.bending_y.dot(b);
}

FrameEquations::States& FrameEquations::scratch_of(Eigen::Index states) {
  States& scratch = states == 1 ? one_ : many_;
  if (scratch.pull.cols() == states) return scratch;
  scratch.bent.resize(bending_, 3 * states);
  scratch.slope.resize(points_, 3 * states);
  scratch.shortening.resize(points_, 2 * states);
  scratch.deflection.resize(bending_, 2 * states);
  scratch.extension.resize(axial_, 2 * states);
  scratch.on_run.resize(points_, 2 * states);
  scratch.on_axial.resize(axial_, 2 * states);
  scratch.on_bending.resize(bending_, 2 * states);
  scratch.pull.resize(points_, states);
  scratch.lateral.resize(bar_.places.size(), states);
  return scratch;
}

/// Of a state's f.
void FrameEquations::set_parts(States& of, Eigen::Index state, ConstVector q, ConstVector v,
                               ConstVector a) const {
  const Eigen::Index states = of.pull.cols(), along = state, across = states + state;
  const double spin = v[0], turn = a[0];
  const auto s = of.slope.col(state).array(), rate = of.slope.col(states + state).array(),
             second = of.slope.col(2 * states + state).array();
  of.shortening.col(along) = s * second + rate.square() - 0.5 * spin * spin * s.square();
  of.shortening.col(across) = 0.5 * turn * s.square() + 2.0 * spin * s * rate;
  of.deflection.col(along) = turn * q.tail(bending_) + 2.0 * spin * v.tail(bending_);
  of.deflection.col(across) = spin * spin * q.tail(bending_) - a.tail(bending_);
  of.extension.col(along) = spin * spin * q.segment(1, axial_) - a.segment(1, axial_);
  of.extension.col(across) = -turn * q.segment(1, axial_) - 2.0 * spin * v.segment(1, axial_);
}

/// Of these parts of f, on all that moves the bar; on the modes not what is across the straight
/// bar.
void FrameEquations::set_work(States& of) const {
  const Eigen::Index states = of.pull.cols();
  bar_.run_run.multiply(of.shortening, of.on_run);
  add_product(bar_.run_bending, of.deflection, of.on_run);
  of.on_run.noalias() += bar_.run_axial * of.extension;
  set_product(bar_.bending_run, of.shortening, of.on_bending);
  add_product(bar_.bending_bending, of.deflection.leftCols(states), of.on_bending.leftCols(states));
  of.on_bending.noalias() += bar_.axial_bending.transpose() * of.extension;
  of.on_axial.noalias() = bar_.run_axial.transpose() * of.shortening;
  of.on_axial.noalias() += bar_.axial_bending * of.deflection;
  of.on_axial.noalias() += bar_.axial_axial * of.extension;
}

/// Adds what weight and the frame's turn are to the straight bar: the same force at all points, and
/// one in proportion to x.
void FrameEquations::add_straight(States& of, Eigen::Index state, const Weight& weight, double spin,
                                  double turn) const {
  const Eigen::Index along = state, across = of.pull.cols() + state;
  const double lever_along = spin * spin, lever_across = -turn;
  of.on_run.col(along) += weight.along * bar_.run + lever_along * bar_.run_moment;
  of.on_run.col(across) += weight.across * bar_.run + lever_across * bar_.run_moment;
  of.on_axial.col(along) += weight.along * bar_.axial + lever_along * bar_.axial_moment;
  of.on_axial.col(across) += weight.across * bar_.axial + lever_across * bar_.axial_moment;
  of.on_bending.col(along) += weight.along * bar_.bending + lever_along * bar_.bending_moment;
  of.lateral.col(state).array() += weight.across + lever_across * bar_.places.array();
  of.lateral.col(state).array() *= bar_.masses.array();
}

/// f = m (g − α), the acceleration α in the frame: along, ẍ − ψ̈ y − 2 ψ̇ ẏ − ψ̇² x, and across,
/// ÿ + ψ̈ x + 2 ψ̇ ẋ − ψ̇² y. It does work on δx − y δψ along and δy + x δψ across. What is across the
/// straight bar is added up station by station: there the frame's turn and modes that nearly undo
/// it leave little, whose rounding is not in the way of any mode.
void FrameEquations::unbalanced(ConstMatrix q, ConstMatrix v, ConstMatrix a, MatrixRef r) {
  const Eigen::Index states = q.cols();
  States& of = scratch_of(states);
  of.bent.leftCols(states) = q.bottomRows(bending_);
  of.bent.middleCols(states, states) = v.bottomRows(bending_);
  of.bent.rightCols(states) = a.bottomRows(bending_);
  set_product(bar_.slopes, of.bent, of.slope);
  for (Eigen::Index k = 0; k < states; ++k) set_parts(of, k, q.col(k), v.col(k), a.col(k));
  set_work(of);
  set_product(bar_.deflections, of.deflection.rightCols(states), of.lateral);
  for (Eigen::Index k = 0; k < states; ++k) {
    add_straight(of, k, weight_at(q(0, k)), v(0, k), a(0, k));
    const Eigen::Index along = k, across = states + k;
    const auto s = of.slope.col(k).array();
    r(0, k) = bar_.places.dot(of.lateral.col(k)) + bar_.axial_moment.dot(of.extension.col(across)) +
              bar_.run_moment.dot(of.shortening.col(across)) +
              q.col(k).segment(1, axial_).dot(of.on_axial.col(across)) -
              0.5 * (s.square() * of.on_run.col(across).array()).sum() -
              q.col(k).tail(bending_).dot(of.on_bending.col(along));
    r.col(k).segment(1, axial_) = of.on_axial.col(along);
    r.col(k).tail(bending_) = of.on_bending.col(across);
    of.pull.col(k) = -s * of.on_run.col(along).array();
  }
  add_product(bar_.of_deflections, of.lateral, r.bottomRows(bending_));
  add_product(bar_.of_slopes, of.pull, r.bottomRows(bending_));
  if (rotary_.size() > 0) r.noalias() -= rotary_ * a;
}

/// With J = [−y, S1, −I s S2'] along and [x, 0, S2] across, ∫ JᵀJ dm.
void FrameEquations::set_mass(ConstVector q, MatrixRef mass) {
  go_to(q);
  turned_ = at_.slope.asDiagonal() * bar_.slopes;
  bar_.run_run.multiply(turned_, run_turned_);
  along_turned_.noalias() = bar_.run_axial.transpose() * turned_;
  auto to_bending = mass.row(0).tail(bending_);
  auto between = mass.block(1, 1 + axial_, axial_, bending_);
  auto bent = mass.bottomRightCorner(bending_, bending_);
  mass(0, 0) = bar_.inertia + at_.inertia_gained;
  mass.row(0).segment(1, axial_) = -at_.axial_y;
  to_bending = at_.bending_x;
  to_bending.noalias() += at_.run_y.transpose() * turned_;
  mass.block(1, 1, axial_, axial_) = bar_.axial_axial;
  between = -along_turned_;
  bent = bar_.bending_bending;
  of_turned_ = bar_.of_slopes * at_.slope.asDiagonal();
  add_product(of_turned_, run_turned_, bent);
  mass.col(0).tail(axial_ + bending_) = mass.row(0).tail(axial_ + bending_);
  mass.block(1 + axial_, 1, bending_, axial_) = between.transpose();
  if (rotary_.size() > 0) mass += rotary_;
}

void FrameEquations::set_tangent(ConstVector q, ConstVector v, ConstVector a, Tangent& tangent) {
  set_mass(q, tangent.mass);
  unbalanced(q, v, a, residual_);
  turned_rate_ = one_.slope.col(1).asDiagonal() * bar_.slopes;
  across_turned_.noalias() = bar_.run_bending.transpose() * turned_;
  across_rate_.noalias() = bar_.run_bending.transpose() * turned_rate_;
  derive_by_q(q, v, a, tangent.by_q);
  derive_by_v(v, tangent.by_v);
}

/// After unbalanced() of this state alone.
void FrameEquations::derive_by_q(ConstVector q, ConstVector v, ConstVector a,
                                 Eigen::MatrixXd& by_q) {
  const double spin = v[0], turn = a[0];
  const Weight weight = weight_at(q[0]);
  const auto s = one_.slope.col(0), rate = one_.slope.col(1), second = one_.slope.col(2);

  by_q(0, 0) = -weight.along * at_.x - weight.across * at_.y;
  by_q.row(0).segment(1, axial_) =
      one_.on_axial.col(1) - turn * at_.axial_x - spin * spin * at_.axial_y;
  auto to_bending = by_q.row(0).tail(bending_);
  to_bending = spin * spin * at_.bending_x - turn * at_.bending_y - one_.on_bending.col(0);
  weights_.array() = (turn * s + 2.0 * spin * rate).array() * at_.run_x.array() -
                     (second - spin * spin * s).array() * at_.run_y.array() -
                     s.array() * one_.on_run.col(1).array();
  to_bending.noalias() += weights_.transpose() * bar_.slopes;

  weighted_ = (second - spin * spin * s).asDiagonal() * bar_.slopes;
  by_q.col(0).segment(1, axial_) = weight.across * bar_.axial;
  by_q.block(1, 1, axial_, axial_) = spin * spin * bar_.axial_axial;
  auto between = by_q.block(1, 1 + axial_, axial_, bending_);
  between = turn * bar_.axial_bending;
  between.noalias() += bar_.run_axial.transpose() * weighted_;

  auto of_bending = by_q.col(0).tail(bending_);
  of_bending = -weight.along * bar_.bending;
  of_bending.noalias() -= weight.across * (turned_.transpose() * bar_.run);
  by_q.block(1 + axial_, 1, bending_, axial_) =
      -turn * bar_.axial_bending.transpose() - spin * spin * along_turned_.transpose();
  auto bent = by_q.bottomRightCorner(bending_, bending_);
  bent = spin * spin * bar_.bending_bending + turn * across_turned_ + 2.0 * spin * across_rate_ -
         turn * across_turned_.transpose();
  bent.noalias() -= run_turned_.transpose() * weighted_;
  weighted_ = one_.on_run.col(0).asDiagonal() * bar_.slopes;
  bent.noalias() -= bar_.slopes.transpose() * weighted_;
}

void FrameEquations::derive_by_v(ConstVector v, Eigen::MatrixXd& by_v) {
  const double spin = v[0];
  const auto axial_rate = v.segment(1, axial_);
  const auto bending_rate = v.tail(bending_);
  weights_ = at_.slope.cwiseProduct(one_.slope.col(1));  // what shortens, as a rate

  by_v(0, 0) = -2.0 * (at_.axial_x.dot(axial_rate) - at_.run_x.dot(weights_) +
                       at_.bending_y.dot(bending_rate));
  by_v.row(0).segment(1, axial_) = -2.0 * spin * at_.axial_x;
  auto to_bending = by_v.row(0).tail(bending_);
  to_bending = -2.0 * spin * at_.bending_y;
  to_bending.noalias() += 2.0 * spin * (at_.run_x.transpose() * turned_);
  to_bending.noalias() -= 2.0 * (at_.run_y.transpose() * turned_rate_);

  auto of_axial = by_v.col(0).segment(1, axial_);
  of_axial = 2.0 * spin * at_.axial_x;
  of_axial.noalias() += 2.0 * (bar_.axial_bending * bending_rate);
  by_v.block(1, 1, axial_, axial_).setZero();
  auto between = by_v.block(1, 1 + axial_, axial_, bending_);
  between = 2.0 * spin * bar_.axial_bending;
  between.noalias() += 2.0 * (bar_.run_axial.transpose() * turned_rate_);

  auto of_bending = by_v.col(0).tail(bending_);
  of_bending = 2.0 * spin * at_.bending_y;
  of_bending.noalias() -= 2.0 * (bar_.axial_bending.transpose() * axial_rate);
  of_bending.noalias() += 2.0 * (bar_.run_bending.transpose() * weights_);
  weights_ = spin * at_.run_x;
  weights_.noalias() += bar_.run_bending * bending_rate;
  of_bending.noalias() -= 2.0 * (turned_.transpose() * weights_);
  by_v.block(1 + axial_, 1, bending_, axial_) = -2.0 * spin * bar_.axial_bending.transpose();
  auto bent = by_v.bottomRightCorner(bending_, bending_);
  bent = 2.0 * spin * (across_turned_ - across_turned_.transpose());
  bent.noalias() -= 2.0 * (run_turned_.transpose() * turned_rate_);
}

/// What moves across the straight bar, the frame's turn and modes that nearly undo it, is added
/// before it is squared: the square of each has more digits than their energy would be left.
void FrameEquations::kinetic(ConstVector q, ConstMatrix v, VectorRef energies) {
  const Eigen::Index states = v.cols();
  go_to(q);
  States& of = scratch_of(states);
  auto shortening = of.shortening.leftCols(states), run = of.on_run.leftCols(states);
  set_product(bar_.slopes, v.bottomRows(bending_), of.pull);
  shortening = at_.slope.asDiagonal() * of.pull;  // as a rate
  bar_.run_run.multiply(shortening, run);
  set_product(bar_.deflections, v.bottomRows(bending_), of.lateral);
  of.lateral.noalias() += bar_.places * v.row(0);
  for (Eigen::Index k = 0; k < states; ++k) {
    const auto a = v.col(k).segment(1, axial_);
    const auto g = shortening.col(k);
    auto along = turn_.segment(1, axial_);
    along.noalias() = bar_.axial_axial * a;
    along.noalias() -= 2.0 * (bar_.run_axial.transpose() * g);
    const double momentum =
        at_.bending_gained.dot(v.col(k).tail(bending_)) - at_.axial_y.dot(a) + at_.run_y.dot(g);
    energies[k] =
        0.5 * ((bar_.masses.array() * of.lateral.col(k).array().square()).sum() + along.dot(a) +
               run.col(k).dot(g) + v(0, k) * (2.0 * momentum + v(0, k) * at_.inertia_gained));
    if (rotary_.size() == 0) continue;
    turn_.noalias() = rotary_ * v.col(k);
    energies[k] += 0.5 * turn_.dot(v.col(k));
  }
}

double FrameEquations::gravitational(ConstVector q) {
  go_to(q);
  const double sine = std::sin(q[0]), cosine = std::cos(q[0]), half = std::sin(0.5 * q[0]);
  const double shortened = bar_.run.dot(at_.half_square) - bar_.axial.dot(q.segment(1, axial_));
  return along_ * (shortened + 2.0 * half * half * at_.x + sine * at_.y) +
         across_ * (sine * at_.x + cosine * at_.y);
}

RigidPart FrameEquations::rigid_part(ConstVector q, ConstVector v) {
  go_to(q);
  const double sine = std::sin(q[0]), cosine = std::cos(q[0]);
  const double moment_y = bar_.bending_moment.dot(q.tail(bending_));
  weights_.noalias() = bar_.slopes * v.tail(bending_);
  const double momentum =
      at_.bending_x.dot(v.tail(bending_)) - at_.axial_y.dot(v.segment(1, axial_)) +
      at_.run_y.dot(weights_.cwiseProduct(at_.slope)) + v[0] * (bar_.inertia + at_.inertia_gained);
  RigidPart rigid = {.angle = -(sine * at_.moment_x + cosine * moment_y),
                     .rate = -momentum,
                     .along = cosine * at_.moment_x - sine * moment_y};
  if (rotary_.size() > 0) {
    rigid.angle -= rotary_.row(0).dot(q);
    rigid.rate -= rotary_.row(0).dot(v);
  }
  return rigid;
}

}  // namespace impactrig::models
