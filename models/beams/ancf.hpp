// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "models/beams/band_cholesky.hpp"
#include "models/beams/bar_element.hpp"
#include "models/beams/beam_dynamics.hpp"
#include "models/beams/linear_bar.hpp"

namespace impactrig::models {

/// Absolute nodal coordinates: planar gradient-deficient cubic elements, Shen et al. (19)-(30). No
/// small-rotation assumption.
///
/// Strain energy U = ½ ∫ EA ε² dx + ½ ∫ EI r_xx·r_xx dx with ε = (r_x·r_x − 1)/2, integrated
/// exactly (five Gauss points: the integrand of the axial force has degree 8). r_xx is the
/// curvature to first order in the axial strain. A mass on the bar enters with the shape functions
/// of its place, on a node or between two.
///
/// The material is Kelvin-Voigt's with the retardation time τ: with ε goes ε + τ ε̇, with r_xx goes
/// r_xx + τ D, D = ṙ_xx − ω × r_xx its rate seen from the turning tangent, ω = r_x × ṙ_x / r_x².
/// The forces are the derivatives of ½ τ ∫ (EA ε̇² + EI D·D) dx by the rates, so that a rigid
/// rotation of the bent bar, for which ε̇ = 0 and D = 0, is neither braked nor turned by them. With
/// ṙ_xx instead of D a moment τ EI ω ∫ r_xx·r_xx dx would brake it.
///
/// The hinge turns with the slope vector r_x of the first node.
///
/// q = [X, U]: X the nodal positions and slopes across the hanging bar (closing is −X), U the same
/// of the displacement along it, Y = −x + U. Displacements, not positions, so that strains of 1e-12
/// keep their digits. The hinge's two positions are left out; each of X and U holds [slope_0,
/// (value, slope)_1, ..., (value, slope)_N].
class AncfBeam : public BeamDynamics {
 public:
  /// elements: hinge to struck point, struck point to tip (0 when it is the tip). Throws
  /// std::invalid_argument for a bar that shears.
  AncfBeam(const Rig& rig, std::array<int, 2> elements);

  int size() const override { return 2 * dofs_; }

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

  const std::vector<BarElement>& elements() const { return elements_; }

  const Hinge& hinge() const { return hinge_; }

  const BarDamping& damping() const { return damping_; }

  /// Of one direction, as X is ordered (n/2, n/2).
  const BandMatrix& mass() const { return mass_; }

  /// Generalised forces of the weight on X and U (n) [N, N m].
  Eigen::VectorXd weight_force() const {
    Eigen::VectorXd force(size());
    force << -gravity_across_ * weight_, -gravity_ * weight_;
    return force;
  }

  /// Displacement X of the bar's axis at x: four values of nodes, from the element's first [-].
  struct Row {
    std::size_t element;
    Eigen::Vector4d shape;
  };

  Row row_at(double x) const;
  Row slope_row_at(double x) const;  ///< of X' there [1/m]; where two elements meet the first's

  /// Angle of the slope vector at the hinge, closing > 0, and its derivatives with respect to the
  /// first coordinate of X and of U.
  struct HingeAngle {
    double angle = 0.0;
    double by_across = 0.0, by_along = 0.0;
  };

 private:
  using Nodal = Eigen::Vector4d;  // value, slope of the first node, of the second

  int first_dof(std::size_t element) const { return 2 * static_cast<int>(element) - 1; }

  Nodal shape_at(std::size_t element, double x) const;
  std::optional<Eigen::VectorXd> steady_stretch(double pull, double rate) const;
  bool turned_over(const Eigen::VectorXd& parts) const;
  void add_axial(std::size_t element, const Eigen::VectorXd& parts, Eigen::VectorXd& force,
                 BandMatrix& stiffness) const;
  void set_straight(const Eigen::VectorXd& stretch, double angle, double rate, VectorRef q,
                    VectorRef v) const;
  void add_weight(std::size_t element, const Nodal& share);
  Nodal gather(ConstVector part, std::size_t element) const;
  double kinetic_energy(ConstVector v) const;
  void add_elastic_force(ConstVector q, VectorRef force) const;
  void add_material_damping(ConstVector q, ConstVector v, VectorRef force) const;
  HingeAngle hinge_angle(ConstVector q) const;
  double hinge_rate(const HingeAngle& hinge, ConstVector v) const;
  void add_hinge_moment(ConstVector q, ConstVector v, VectorRef force) const;

  std::vector<BarElement> elements_;
  LinearBar linear_;
  int dofs_;  // of one direction
  int struck_dof_;
  double gravity_, gravity_across_;  // from hinge to tip and towards closing, of the straight bar
  Hinge hinge_;
  BarDamping damping_;
  std::vector<FurtherStop> further_stops_;
  double inertia_;
  std::vector<LumpedMass> masses_;
  std::array<Eigen::Vector4d, 5> slope_shapes_;  // dS/dξ at the Gauss points, for unit length
  std::array<double, 5> points_, weights_;
  Eigen::VectorXd reference_;  // x as nodal values of one direction
  Eigen::VectorXd weight_;     // ∫ S dm, one direction
  BandMatrix mass_;
  BandCholesky factor_;
  mutable Eigen::VectorXd scratch_;  // of damping_power()
};

}  // namespace impactrig::models
