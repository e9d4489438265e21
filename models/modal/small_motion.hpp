// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "models/beams/bar_element.hpp"
#include "models/rig.hpp"

namespace impactrig::models {

/// A bar on its hinge moving little about hanging straight, in coordinates q (n) of which only the
/// motion across the bar is kept: M q̈ + (K + G + k hᵀ h) q = Q − rᵀ F, where r q is the
/// displacement of the struck point, closing > 0, and F presses it back.
struct SmallMotion {
  Eigen::MatrixXd mass;       ///< M (n, n)
  Eigen::MatrixXd stiffness;  ///< K, elastic (n, n)
  Eigen::MatrixXd gravity;    ///< G, of the hanging weight (n, n)
  Eigen::VectorXd load;       ///< Q, of gravity from the side (n)
  Eigen::VectorXd hinge;      ///< h: angle of the axis at the hinge, closing > 0 (n)
  double spring = 0.0;        ///< k, of the hinge [N m/rad]
  Eigen::VectorXd rigid;      ///< q of a rigid rotation by 1 rad, closing (n)
};

/// Modes of a bar under its weight and with its hinge's spring, slow ones first.
struct BarModes {
  Eigen::VectorXd squares;  ///< ω² [rad²/s²] (m); below zero where the bar would fall over
  /// Shapes of unit modal mass, a coordinate of the bar a column (m, n); none where the coordinates
  /// are the modes.
  Eigen::MatrixXd rows;
  int own = 0;  ///< how many are modes of the bar; those after them stand for the rest
  /// ω² of what these stand for, which they may be slower than [rad²/s²] (m − own).
  Eigen::VectorXd left_out;
  /// The hanging weight's stiffness in those that it holds by more than a millionth (p, p), p ≤ m.
  Eigen::MatrixXd weight;
  Eigen::VectorXd hinge;  ///< angle of the axis at the hinge, closing > 0 (m)
  Eigen::VectorXd rigid;  ///< modal velocities of a rigid rotation at 1 rad/s, closing (m)
};

/// What resists the small motion of a bar and its hinge: C = α M + τ K + c hᵀ h.
struct ViscousDamping {
  double mass = 0.0;       ///< α [1/s]
  double stiffness = 0.0;  ///< τ [s]
  double hinge = 0.0;      ///< c [N m s/rad]

  static ViscousDamping of(const Rig& rig) {
    return {rig.beam.damping.mass, rig.beam.damping.stiffness, rig.hinge.viscous};
  }

  bool operator==(const ViscousDamping&) const = default;
};

/// A bar that can tell its small motion.
class SmallMotionBeam {
 public:
  virtual ~SmallMotionBeam() = default;

  /// The bar's motion across itself, linearised about hanging straight.
  virtual SmallMotion small_motion() const = 0;

  /// Displacement of a point under unit coordinates of small_motion(), closing > 0 (n).
  virtual Eigen::VectorXd small_motion_row(double x) const = 0;

  /// SmallMotion::load.
  virtual Eigen::VectorXd small_motion_load() const = 0;

  /// Shapes (n, m) in values that tell how each part of the bar bends whatever turns with it; back.
  virtual Eigen::MatrixXd own_values(const Eigen::MatrixXd& shapes) const { return shapes; }

  virtual Eigen::MatrixXd shapes_of(const Eigen::MatrixXd& own) const { return own; }

  /// Of bars bent so (n, m), strains of all parts, each by the root of what resists it: K is their
  /// product with themselves, to digits that its matrix has not where an element is far shorter
  /// than the others [√J] (.., m).
  virtual Eigen::MatrixXd strains(const Eigen::MatrixXd& own) const = 0;

  /// All its modes, where it has a better way to them than those matrices.
  virtual std::optional<BarModes> modes() const { return std::nullopt; }

  /// Elements of which the bar of the full equations stretches where it bends unevenly: their axes
  /// are cubics. Small motion does not know of it.
  virtual std::vector<BarElement> stretching_elements() const { return {}; }

  /// Angle, under unit coordinates, of a frame in which the bar bends as if it did not turn,
  /// closing > 0 (n); none where the coordinates are absolute.
  virtual Eigen::VectorXd frame() const { return {}; }

  /// In how many axial modes the bar of the full equations stretches; none: in all there are.
  virtual std::optional<int> axial_modes() const { return std::nullopt; }
};

}  // namespace impactrig::models
