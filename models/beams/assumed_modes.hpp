// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "models/beams/bar_element.hpp"
#include "models/beams/bending_modes.hpp"

namespace impactrig::models {

/// The mesh that so many shapes of a bar come from; none where they are closed forms.
std::vector<BarElement> elements_of_shapes(const Beam& beam, int count);

/// The bending shapes of hybrid coordinates, without further masses, of unit modal mass: closed
/// forms for a uniform Euler-Bernoulli bar, for any other those of a mesh of 64 + 8n elements,
/// which has the frequency of the last of n modes to some 1e-5 and the lower ones with the fourth
/// power of their number better.
class AssumedModes {
 public:
  AssumedModes(const Beam& beam, Basis basis, int count);

  int count() const { return static_cast<int>(omega_.size()); }

  const Eigen::VectorXd& omega() const { return omega_; }  ///< [rad/s] (n)

  Eigen::VectorXd deflection(double x) const;  ///< (n) [1/√kg]
  Eigen::VectorXd slope(double x) const;       ///< of the axis (n)
  Eigen::VectorXd rotation_at_hinge() const;   ///< of the section there (n)

  /// Rotary inertia of the sections, turning with the frame (first) and with the modes (n + 1, n +
  /// 1).
  Eigen::MatrixXd rotary_inertia() const;

  /// Of the mesh that the shapes come from, where their derivatives jump; none of closed forms.
  const std::vector<BarElement>& elements() const { return elements_; }

  /// A share of the bar in an integral over it.
  struct Place {
    double x = 0.0;
    double width = 0.0;  ///< [m]
    double mass = 0.0;   ///< [kg]
    double below = 0.0;  ///< mass of the bar beyond x [kg]
  };

  /// For integrals of products of the shapes, `fineness` is that of the rule for closed forms.
  std::vector<Place> places(int fineness) const;

 private:
  void solve(const Beam& beam, Basis basis, int count);
  Eigen::VectorXd shown(double x, BarElement::Shape (BarElement::*shape)(double) const) const;

  Beam beam_;
  std::vector<BendingMode> closed_;
  Eigen::VectorXd omega_;
  std::vector<BarElement> elements_;  // of the mesh; none with closed forms
  Eigen::MatrixXd rows_;              // in coordinates of LinearBar (n, its size)
  std::vector<std::array<int, BarElement::values>> places_of_;  // of each element's values there
};

}  // namespace impactrig::models
