// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/beams/beam_dynamics.hpp"
#include "models/implicit/radau_stages.hpp"

namespace impactrig::models {

/// How a point moves over a step of S stages, or what that changes by.
template <int S>
struct PointCurve {
  using Series = Eigen::Matrix<double, S, 1>;

  double displacement = 0.0, velocity = 0.0;  ///< where the step begins
  Series acceleration = Series::Zero();       ///< at the nodes

  /// Ready to be looked at, over a step of this length.
  PointCurve over(double h, const RadauStages<S>& stages,
                  const Eigen::Matrix<double, S, S>& to_series) const {
    PointCurve curve = *this;
    const Series speed =
        Series::Constant(velocity) + h * (stages.to_velocity * acceleration).eval();
    curve.acceleration_ = to_series * acceleration;
    curve.gained_velocity_ = h * curve.acceleration_;
    curve.gained_displacement_ = h * (to_series * speed);
    return curve;
  }

  /// At a place, by the integrals of the Legendre polynomials up to there.
  PointMotion at(const NodeVector& integrals) const {
    return {displacement + gained_displacement_.dot(integrals),
            velocity + gained_velocity_.dot(integrals)};
  }

  /// By their values there.
  double rate(const NodeVector& legendre) const { return acceleration_.dot(legendre); }

 private:
  Series acceleration_ = Series::Zero(), gained_velocity_ = acceleration_,
         gained_displacement_ = acceleration_;  // Legendre series
};

}  // namespace impactrig::models
