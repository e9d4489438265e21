// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "models/beams/beam_dynamics.hpp"

namespace impactrig::models {

inline double total(const BeamEnergy& energy) {
  return energy.kinetic + energy.elastic + energy.spring + energy.gravitational;
}

/// What a Legendre series of S terms leaves out, from the squares of its terms: its last pair, less
/// where the pair before was much larger, as much as the pairs that follow would be.
template <int S>
double series_remainder(const Eigen::Array<double, S, 1>& squares, int pairs_further = 1) {
  const double last = std::sqrt(squares[S - 1] + squares[S - 2]);
  const double before = std::sqrt(squares[S - 3] + squares[S - 4]);
  const double ratio = std::min(1.0, 3.0 * last / std::max(before, 1e-300));
  return last * std::pow(ratio, pairs_further);
}

/// What is wrong at the end of a Radau step of S stages, of order 2 S - 1: what its series would
/// have left with nearly twice its terms. Derivatives of the motion are less smooth than it is, and
/// where they are `followed` their errors count by themselves: then the series as it is.
template <int S>
double end_remainder(const Eigen::Array<double, S, 1>& squares, bool followed) {
  return series_remainder<S>(squares, followed ? 1 : S / 2 - 1);
}

/// How much an error of speed in a step counts that is this part of the contact's time: as the way
/// it makes within the step, for what it does is vibration; the more, the more steps of random sign
/// add theirs to it.
inline double weight_of_step(double part) {
  constexpr double few_steps = 1000.0;
  return std::min(1.0, part) * std::sqrt(std::max(1.0, 1.0 / (few_steps * part)));
}

/// What a damped contact makes of the vibration that the method lets die before the struck point in
/// a step h over the contact's time [s], as a part of its force: by the squares of the terms of
/// that point's acceleration [m²/s⁴], less what may be rounding of it [m/s²]. Most of it comes and
/// goes; vibration too fast for the step turns by more than a radian a stage, and has that much
/// less speed.
template <int S>
double error_of_rate(const Eigen::Array<double, S, 1>& squares, double rounding, double damping,
                     double time, double h) {
  constexpr double share = 0.02;
  return damping * std::min(share * time, h / S) *
         std::max(series_remainder<S>(squares) - rounding, 0.0);
}

/// Of an acceleration, by the rounding of displacements of this size [m/s²].
inline double rounding_of_acceleration(double displacement, double h) {
  return 16.0 * std::numeric_limits<double>::epsilon() * displacement / (h * h);
}

/// A method that lets fast vibration die must not let it take along energy that counts.
struct EnergyLoss {
  double in_step = 0.0;  ///< [J]
  double before = 0.0;   ///< in the steps before [J]
  BeamEnergy energy;     ///< of the bar at the step's end
  double weight = 0.0;   ///< what the weight could do at most [J]

  /// Of the accuracy asked for, what all losses together may take: a lost energy moves force and
  /// duration by its like, and by several times that where the bar turns at a shallow angle.
  static constexpr double share = 0.1;

  /// The loss of the step as a part of the energy that counts [J], and more when the steps before
  /// have left little of its share; rounding of the energies is not held against the step.
  double error(double scale, double accuracy) const {
    const double rounding =
        1e-14 * (std::abs(energy.elastic) + energy.kinetic + energy.spring) + 1e-15 * weight;
    const double lost = std::max(std::abs(in_step) - rounding, 0.0) / scale;
    return lost / std::max(1.0 - std::abs(before) / (scale * share * accuracy), 0.02);
  }
};

}  // namespace impactrig::models
