// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <array>
#include <optional>
#include <vector>

#include "models/beams/beam_dynamics.hpp"
#include "models/beams/linear_bar.hpp"
#include "models/beams/reissner_element.hpp"

namespace impactrig::models {

/// A bar that shears and whose sections have rotary inertia, of ReissnerElement, without
/// small-rotation assumption; its small motion is LinearBar's of the same mesh. The hinge turns
/// with the section there. Masses on the bar have no rotary inertia.
///
/// q = [Θ_0, inside of the first element, X_1, U_1, Θ_1, inside of the second, ...]: the elements'
/// coordinates one after the other, without the hinge's two displacements.
class ReissnerBeam : public BeamDynamics {
 public:
  /// elements: hinge to struck point, struck point to tip (0 when it is the tip). Throws
  /// std::invalid_argument for a bar that does not shear.
  ReissnerBeam(const Rig& rig, std::array<int, 2> elements);

  static constexpr int held = 2;  ///< coordinates of the first element that are left out

  int size() const override { return ReissnerElement::own * count() + 3 - held; }

  Eigen::VectorXd inertia_diagonal() const override;
  void set_rigid_motion(double angle, double rate, VectorRef q, VectorRef v) const override;
  bool set_steady_motion(double angle, double rate, VectorRef q, VectorRef v) const override;
  using BeamDynamics::acceleration;
  void acceleration(ConstVector q, ConstVector v, std::span<const double> forces,
                    VectorRef a) override;
  PointMotion struck_point(ConstVector q, ConstVector v) const override;
  double struck_acceleration(ConstVector q, ConstVector v, ConstVector a) const override;
  double point_acceleration(double x, ConstVector q, ConstVector v, ConstVector a) const override;
  PointMotion point(double x, ConstVector q, ConstVector v) const override;
  std::vector<int> coordinates_of(double x) const override;
  SmallMotion small_motion() const override;
  Eigen::VectorXd small_motion_row(double x) const override;
  Eigen::VectorXd small_motion_load() const override;
  Eigen::MatrixXd own_values(const Eigen::MatrixXd& shapes) const override;
  Eigen::MatrixXd shapes_of(const Eigen::MatrixXd& own) const override;
  Eigen::MatrixXd strains(const Eigen::MatrixXd& own) const override;
  double damping_power(ConstVector q, ConstVector v) const override;
  BeamEnergy energy(ConstVector q, ConstVector v) const override;
  RigidPart rigid_part(ConstVector q, ConstVector v) const override;

  const std::vector<ReissnerElement>& elements() const { return elements_; }

  /// With the masses on it (elements).
  const std::vector<ReissnerElement::Matrix>& masses() const { return masses_; }

  const Eigen::VectorXd& weight_force() const { return weight_force_; }  ///< (n) [N, N m]

  const Hinge& hinge() const { return hinge_; }

  const BarDamping& damping() const { return damping_; }

  /// Displacement X of the bar's axis at x: values of an element [-].
  struct Row {
    std::size_t element;
    ReissnerElement::Vector shape;
  };

  Row row_at(double x) const;
  Row slope_row_at(double x) const;  ///< of X' there [1/m]; where two elements meet the first's

 private:
  using Values = ReissnerElement::Values<double>;

  int count() const { return static_cast<int>(elements_.size()); }

  std::size_t element_at(double x) const;

  std::optional<Eigen::VectorXd> steady_stretch(double pull, double rate) const;
  Values gather(ConstVector q, std::size_t element) const;
  void scatter(const Values& values, std::size_t element, double factor, VectorRef to) const;
  void subtract_damping(ConstVector q, ConstVector v, VectorRef force) const;

  std::vector<ReissnerElement> elements_;
  LinearBar linear_;
  int struck_;
  double struck_place_;              // [m]
  double gravity_, gravity_across_;  // from hinge to tip and towards closing, of the straight bar
  std::vector<FurtherStop> further_stops_;
  Hinge hinge_;
  BarDamping damping_;
  double inertia_;
  std::vector<ReissnerElement::Matrix> masses_;
  Eigen::VectorXd weight_force_;
  Eigen::VectorXd reference_;  // X = x, Θ = 1: a rigid rotation, opening
  Eigen::SparseMatrix<double> mass_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      factor_;
};

}  // namespace impactrig::models
