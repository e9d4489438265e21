// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <vector>

#include "models/beams/linear_bar.hpp"
#include "models/modal/small_motion.hpp"

namespace impactrig::models {

/// A bar of many elements in few coordinates, those that matter where forces press it at known
/// points: the rigid rotation and the Krylov space of its deflections under the forces, under their
/// inertia, under the inertia of these, and so on [NourOmidClough1984].
///
/// It bends under steady forces exactly as the bar does and has the bar's slowest modes. What it
/// has of faster ones stands for all that are left out: they follow a force as springs do unless it
/// changes as fast as they vibrate. Those that are faster by far than any that is right are given
/// more mass, as springs need none.
class RitzBar : public SmallMotionBeam {
 public:
  /// `loads`: rows of small_motion_row() of the points, and of what else presses it. Takes as many
  /// coordinates as `most`, fewer where the bar has no more.
  RitzBar(std::unique_ptr<const LinearBar> bar, const std::vector<Eigen::VectorXd>& loads,
          int most);

  SmallMotion small_motion() const override;
  Eigen::VectorXd small_motion_row(double x) const override;

  std::vector<BarElement> stretching_elements() const override {
    return bar_->stretching_elements();
  }

  /// How far modes of this are from being the bar's: of what a mode's own forces bend the bar by
  /// what is not that mode, relative in the norm of the mass (m). `shapes`: the modes in the
  /// coordinates of small_motion(), of unit modal mass (n, m).
  Eigen::VectorXd residuals(const Eigen::MatrixXd& shapes) const;

 private:
  /// Where an element bends and shears: its right end against its left, and its values inside.
  struct Piece {
    std::array<int, BarElement::values> places;
    double length;
    Eigen::Matrix2d compliance, root;     // of the end, and L' of the inverse's L L'
    Eigen::Vector3d inside, inside_root;  // likewise
  };

  void span(const std::vector<Eigen::VectorXd>& loads, int most);
  double split(Eigen::VectorXd& motion, Eigen::VectorXd& shares) const;
  Eigen::VectorXd deflection(const Eigen::VectorXd& force) const;
  void turn_to_modes();
  void find_stiffness();
  void find_weight();
  void slow_down();

  std::unique_ptr<const LinearBar> bar_;
  std::vector<Piece> pieces_;
  Eigen::SparseMatrix<double> mass_, weight_;
  Eigen::MatrixXd basis_;     // (N, n), M-orthonormal but for slow_down(), the rigid rotation first
  Eigen::MatrixXd rows_;      // of it in the end, a place of the bar together
  int kept_ = 0;              // n, while they are found
  Eigen::MatrixXd bent_;      // deflections under the inertia of each, in the basis (n, n)
  Eigen::MatrixXd left_out_;  // what of them is not in it, of some each: its norm (k, n)
  Eigen::MatrixXd stiffness_, gravity_;  // (n, n)
  Eigen::VectorXd scale_;                // of what slow_down() takes of each (n)
  Eigen::VectorXd weight_left_out_;      // deflection by what of the weight's pull is not in it (n)
};

}  // namespace impactrig::models
