// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/ritz_bar.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace impactrig::models {
namespace {

// Of a vector, what orthogonalisation may leave before it is taken for rounding.
constexpr double rounding = 1e-11;

using Triplets = std::vector<Eigen::Triplet<double>>;

void add(Triplets& to, const LinearBar::Share& share, const BarElement::Matrix& of) {
  for (std::size_t r = 0; r < BarElement::values; ++r)
    for (std::size_t c = 0; c < BarElement::values; ++c) {
      const double value = of(static_cast<int>(r), static_cast<int>(c));
      if (share.places[r] >= 0 && share.places[c] >= 0 && value != 0.0)
        to.emplace_back(share.places[r], share.places[c], value);
    }
}

}  // namespace

RitzBar::RitzBar(std::unique_ptr<const LinearBar> bar, const std::vector<Eigen::VectorXd>& loads,
                 int most)
    : bar_(std::move(bar)),
      mass_(bar_->size(), bar_->size()),
      weight_(bar_->size(), bar_->size()) {
  Triplets mass, weight;
  const std::vector<LinearBar::Share> shares = bar_->shares();
  for (std::size_t e = 0; e < shares.size(); ++e) {
    const LinearBar::Share& share = shares[e];
    add(mass, share, share.mass);
    if (bar_->hangs()) add(weight, share, share.gravity);
    const Eigen::Matrix2d end = share.stiffness.block<2, 2>(2, 2);
    Piece piece = {share.places,        bar_->elements()[e].length, end.inverse(),
                   end.llt().matrixU(), Eigen::Vector3d{},          Eigen::Vector3d{}};
    if (bar_->elements()[e].shears()) {
      const Eigen::Vector3d inside = share.stiffness.diagonal().tail<BarElement::inside>();
      piece.inside = inside.cwiseInverse();
      piece.inside_root = inside.cwiseSqrt();
    }
    pieces_.push_back(piece);
  }
  mass_.setFromTriplets(mass.begin(), mass.end());
  weight_.setFromTriplets(weight.begin(), weight.end());
  span(loads, std::min(most, bar_->size()));
  turn_to_modes();
  find_stiffness();
  find_weight();
  slow_down();
  rows_ = basis_.transpose();
  basis_.resize(0, 0);
}

/// Each vector bends the bar anew, until there are as many as asked for; the last ones only tell
/// what is left out.
void RitzBar::span(const std::vector<Eigen::VectorXd>& loads, int most) {
  basis_.resize(bar_->size(), most);
  bent_.setZero(most, most);
  std::vector<std::pair<int, double>> left_out;
  Eigen::VectorXd motion = bar_->rigid(), shares(most);
  const auto keep = [&](double norm) { basis_.col(kept_++) = motion / norm; };
  keep(std::sqrt(motion.dot(mass_ * motion)));
  const Eigen::VectorXd turning = mass_ * basis_.col(0);
  for (const Eigen::VectorXd& load : loads) {
    motion = deflection(load - turning * basis_.col(0).dot(load));
    const double size = std::sqrt(motion.dot(mass_ * motion));
    const double norm = split(motion, shares);
    if (norm > rounding * size && kept_ < most) keep(norm);
  }
  for (int k = 1; k < kept_; ++k) {
    motion = deflection(mass_ * basis_.col(k));
    const double norm = split(motion, shares);
    bent_.col(k).segment(1, kept_ - 1) = shares.segment(1, kept_ - 1);
    if (!(norm > rounding * std::hypot(norm, shares.segment(1, kept_ - 1).norm()))) continue;
    if (kept_ < most) {
      bent_(kept_, k) = norm;
      keep(norm);
    } else {
      left_out.emplace_back(k, norm);
    }
  }
  basis_.conservativeResize(Eigen::NoChange, kept_);
  bent_.conservativeResize(kept_, kept_);
  left_out_.setZero(static_cast<Eigen::Index>(left_out.size()), kept_);
  for (std::size_t i = 0; i < left_out.size(); ++i)
    left_out_(static_cast<Eigen::Index>(i), left_out[i].first) = left_out[i].second;
}

/// Nearly to the modes, slow ones first: of the slow ones the stiffness of the fast would leave
/// rounding.
void RitzBar::turn_to_modes() {
  const Eigen::Index elastic = kept_ - 1;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> bending(
      bent_.bottomRightCorner(elastic, elastic));
  if (bending.info() != Eigen::Success)
    throw std::runtime_error("the bar's modes could not be computed");
  const Eigen::MatrixXd turn = bending.eigenvectors().rowwise().reverse();
  basis_.rightCols(elastic) = basis_.rightCols(elastic) * turn;
  left_out_.rightCols(elastic) = left_out_.rightCols(elastic) * turn;
  bent_.setZero();
  bent_.diagonal().tail(elastic) = bending.eigenvalues().reverse();
}

/// Takes out of a motion what the basis has of it; tells the norm of what is left. Twice is enough.
double RitzBar::split(Eigen::VectorXd& motion, Eigen::VectorXd& shares) const {
  const auto basis = basis_.leftCols(kept_);
  shares.head(kept_).setZero();
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::VectorXd inertia = mass_ * motion;
    const Eigen::VectorXd part = basis.transpose() * inertia;
    motion.noalias() -= basis * part;
    shares.head(kept_) += part;
  }
  return std::sqrt(std::max(motion.dot(mass_ * motion), 0.0));
}

/// Of the bar held at the hinge, under forces without moment about it. From the tip to the hinge
/// they add up to what each element carries, from the hinge to the tip its bending adds up to the
/// deflection: no equations are to be solved, so that a fine mesh costs no digits.
Eigen::VectorXd RitzBar::deflection(const Eigen::VectorXd& force) const {
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(force.size());
  double shear = 0.0, moment = 0.0;
  for (std::size_t e = pieces_.size(); e-- > 0;) {
    const Piece& piece = pieces_[e];
    shear += force[piece.places[2]];
    moment += force[piece.places[3]];
    const Eigen::Vector2d bent = piece.compliance * Eigen::Vector2d(shear, moment);
    motion[piece.places[2]] = bent[0];
    motion[piece.places[3]] = bent[1];
    for (std::size_t i = 0; i < BarElement::inside; ++i)
      if (const int place = piece.places[4 + i]; place >= 0)
        motion[place] = piece.inside[static_cast<Eigen::Index>(i)] * force[place];
    moment += shear * piece.length;
  }
  double displacement = 0.0, angle = 0.0;
  for (const Piece& piece : pieces_) {
    displacement += angle * piece.length + motion[piece.places[2]];
    angle += motion[piece.places[3]];
    motion[piece.places[2]] = displacement;
    motion[piece.places[3]] = angle;
  }
  return motion;
}

/// From what each element is bent by: the motions themselves would leave rounding of the stiffest.
void RitzBar::find_stiffness() {
  const Eigen::Index rows = bar_->elements().front().shears() ? 5 : 2;
  Eigen::MatrixXd bent(rows * static_cast<Eigen::Index>(pieces_.size()), kept_);
  for (Eigen::Index k = 0; k < kept_; ++k) {
    const auto motion = basis_.col(k);
    Eigen::Index row = 0;
    for (const Piece& piece : pieces_) {
      const double before = piece.places[0] < 0 ? 0.0 : motion[piece.places[0]];
      const double angle = motion[piece.places[1]];
      const Eigen::Vector2d end(motion[piece.places[2]] - before - angle * piece.length,
                                motion[piece.places[3]] - angle);
      bent.block<2, 1>(row, k) = piece.root * end;
      for (Eigen::Index i = 0; i + 2 < rows; ++i)
        bent(row + 2 + i, k) =
            piece.inside_root[i] * motion[piece.places[static_cast<std::size_t>(4 + i)]];
      row += rows;
    }
  }
  bent.col(0).setZero();
  stiffness_.setZero(kept_, kept_);
  stiffness_.selfadjointView<Eigen::Lower>().rankUpdate(bent.transpose());
  stiffness_.triangularView<Eigen::StrictlyUpper>() = stiffness_.transpose();
}

void RitzBar::find_weight() {
  gravity_.setZero(kept_, kept_);
  weight_left_out_.setZero(kept_);
  if (!bar_->hangs()) return;
  Eigen::MatrixXd pull = weight_ * basis_;
  gravity_.noalias() = basis_.transpose() * pull;
  pull -= mass_ * (basis_ * gravity_);
  for (int k = 0; k < kept_; ++k) {
    const Eigen::VectorXd bent = deflection(pull.col(k));
    weight_left_out_[k] = std::sqrt(bent.dot(mass_ * bent));
  }
}

void RitzBar::slow_down() {
  constexpr double right = 0.3, faster_by_far = 2.0;
  double fastest = std::sqrt(1.0 / bent_(1, 1));
  for (int k = 1; k < kept_; ++k)
    if (left_out_.col(k).norm() < right * bent_(k, k))
      fastest = std::max(fastest, std::sqrt(1.0 / bent_(k, k)));
  scale_ = (faster_by_far * fastest / stiffness_.diagonal().array().sqrt()).min(1.0);
  scale_[0] = 1.0;
  basis_ = basis_ * scale_.asDiagonal();
  stiffness_ = scale_.asDiagonal() * stiffness_ * scale_.asDiagonal();
  gravity_ = scale_.asDiagonal() * gravity_ * scale_.asDiagonal();
  weight_left_out_ = weight_left_out_.cwiseProduct(scale_);
  bent_ = bent_ * scale_.cwiseInverse().asDiagonal();
  left_out_ = left_out_ * scale_.cwiseInverse().asDiagonal();
}

SmallMotion RitzBar::small_motion() const {
  const Eigen::VectorXd rigid = bar_->rigid();
  SmallMotion motion;
  motion.mass = Eigen::MatrixXd::Identity(kept_, kept_);
  motion.stiffness = stiffness_;
  motion.gravity = gravity_;
  motion.hinge = rows_ * bar_->hinge();
  motion.spring = bar_->spring();
  motion.rigid = Eigen::VectorXd::Unit(kept_, 0) * std::sqrt(rigid.dot(mass_ * rigid));
  // what an element is bent by is a difference of motions
  double shortest = bar_->elements().front().length, length = 0.0;
  for (const Piece& piece : pieces_) {
    shortest = std::min(shortest, piece.length);
    length += piece.length;
  }
  motion.rounding = std::numeric_limits<double>::epsilon() * std::pow(length / shortest, 2);
  return motion;
}

Eigen::VectorXd RitzBar::small_motion_row(double x) const {
  const LinearBar::Row at = bar_->row_at(x);
  Eigen::VectorXd row = Eigen::VectorXd::Zero(kept_);
  for (std::size_t i = 0; i < BarElement::values; ++i)
    if (at.places[i] >= 0) row += at.values[static_cast<int>(i)] * rows_.col(at.places[i]);
  return row;
}

/// The spring's moment is one of the loads.
Eigen::VectorXd RitzBar::residuals(const Eigen::MatrixXd& shapes) const {
  const Eigen::MatrixXd forces = stiffness_ * shapes;
  const Eigen::MatrixXd within = bent_ * forces - scale_.asDiagonal() * shapes;
  const Eigen::MatrixXd beyond = left_out_ * forces;
  const Eigen::MatrixXd slowed = (1.0 - scale_.array().square()).matrix().asDiagonal() * shapes;
  const Eigen::RowVectorXd squares = within.bottomRows(kept_ - 1).colwise().squaredNorm() +
                                     beyond.colwise().squaredNorm() +
                                     slowed.colwise().squaredNorm();
  return squares.transpose().cwiseSqrt() + shapes.cwiseAbs().transpose() * weight_left_out_;
}

}  // namespace impactrig::models
