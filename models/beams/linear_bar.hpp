// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "models/beams/bar_element.hpp"
#include "models/modal/small_motion.hpp"

namespace impactrig::models {

/// Finite elements of a hinged bar that moves little across itself, by Euler-Bernoulli's or
/// Timoshenko's theory. The hinge holds the axis, spring and stop act on the section there and on
/// the axis.
///
/// q = [θ_0, (w, θ)_1, ..., (w, θ)_N], w against closing, θ = dw/dx where the bar does not shear;
/// where it does, (w, θ, a, b, c)_e with the values inside of the element that ends there. Its own
/// values are what an element's end deflects and turns beyond a rigid one, in place of w and θ.
class LinearBar : public SmallMotionBeam {
 public:
  /// `negligible_weight`: the part of ω² from which on that of the weight is left out of modes().
  LinearBar(const Rig& rig, std::vector<BarElement> elements, double negligible_weight = 0.0);

  /// Of runs at an accuracy: what damping makes of the weight in a mode is by far less than of ω².
  static double negligible_weight_at(double accuracy);

  SmallMotion small_motion() const override;
  Eigen::VectorXd small_motion_row(double x) const override;
  Eigen::VectorXd small_motion_load() const override;
  Eigen::MatrixXd own_values(const Eigen::MatrixXd& shapes) const override;
  Eigen::MatrixXd shapes_of(const Eigen::MatrixXd& own) const override;
  Eigen::MatrixXd strains(const Eigen::MatrixXd& own) const override;
  std::optional<BarModes> modes() const override;

  std::vector<BarElement> stretching_elements() const override {
    return elements_.front().shears() ? std::vector<BarElement>{} : elements_;
  }

  const std::vector<BarElement>& elements() const { return elements_; }

  double negligible_weight() const { return negligible_weight_; }

  int size() const;

  /// Coordinates of an element's values; −1: held, or there is none.
  std::array<int, BarElement::values> places(std::size_t element) const;

  /// What an element and the masses on it are.
  struct Share {
    std::array<int, BarElement::values> places;  ///< coordinates; −1: held, or there is none
    BarElement::Matrix mass, stiffness, gravity;
  };

  std::vector<Share> shares() const;  ///< from the hinge to the tip

  /// What small_motion_row() has that is not zero.
  struct Row {
    int element;
    std::array<int, BarElement::values> places;  ///< −1: none
    BarElement::Shape values;
  };

  Row row_at(double x) const;

  Eigen::VectorXd hinge() const;  ///< SmallMotion::hinge
  Eigen::VectorXd rigid() const;  ///< SmallMotion::rigid

  double spring() const { return spring_; }

  /// Whether the weight pulls at the bar.
  bool hangs() const { return gravity_ != 0.0; }

 private:
  int values_of_element() const { return elements_.front().shears() ? 2 + BarElement::inside : 2; }

  std::vector<BarElement> elements_;
  std::vector<LumpedMass> masses_;
  double gravity_;         // from hinge to tip
  double gravity_across_;  // closing
  double spring_;
  double negligible_weight_;  // as the constructor has it
};

}  // namespace impactrig::models
