// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "models/implicit/point_curve.hpp"
#include "models/sensitivities/motion_slope.hpp"

namespace impactrig::models {

/// What is seen of a motion's slope over a step: the points before the stops, what the lasers see,
/// and how that goes on in the run itself.
template <int S>
struct SeenPoints {
  std::vector<PointCurve<S>> stops;
  PointCurve<S> velocity, displacement, run_velocity, run_displacement;
  PointCurve<S> along, run_along;  ///< displacement along the bar, of a turned hinge

  /// Goes to a place of the step.
  void look(double part) {
    part_ = part;
    shifted_legendre(part, legendre_);
    shifted_legendre_integrals(part, integrals_);
  }

  PointMotion struck(int stop) const {
    return stops[static_cast<std::size_t>(stop)].at(integrals_);
  }

  double part() const { return part_; }

  /// The displacement across the bar, −X, and that along it, −U, with their slopes.
  struct Departing {
    double across, along, across_slope, along_slope;
  };

  Departing departing() const {
    const auto place = [&](const PointCurve<S>& curve) {
      return curve.at(integrals_).displacement;
    };
    return {place(run_displacement), place(run_along), place(displacement), place(along)};
  }

  MotionSlope::Spots spots() const {
    return {.velocity = velocity.at(integrals_).velocity,
            .displacement = displacement.at(integrals_).displacement,
            .velocity_rate = run_velocity.rate(legendre_),
            .displacement_rate = run_displacement.at(integrals_).velocity};
  }

 private:
  double part_ = 0.0;
  NodeVector legendre_ = NodeVector::Zero(S), integrals_ = legendre_;
};

}  // namespace impactrig::models
