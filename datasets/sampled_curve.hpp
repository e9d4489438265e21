// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "datasets/sensor.hpp"

namespace impactrig::datasets {

/// Where a curve is not continuous.
struct CurveJump {
  double time = 0.0;                 ///< [s]
  double before = 0.0, after = 0.0;  ///< the curve to both sides
};

/// What a curve has beside its values and jumps, in so short a time that it is there all at once.
struct CurveSpike {
  double time = 0.0;  ///< [s]
  double area = 0.0;  ///< [the curve's unit s]
};

/// A curve on a fine uniform grid, smooth but for its jumps.
struct SampledCurve {
  double start = 0.0;                 ///< of values[0] [s]
  double interval = 0.0;              ///< [s]
  std::vector<double> values;         ///< (n); on a jump, what is before it
  std::vector<CurveJump> jumps = {};  ///< in order of time
  /// In order of time: of a derivative by what moves a jump in time, or what lines between the
  /// values miss of the curve's integral. Sensors' chains and filters see them, at() does not.
  std::vector<CurveSpike> spikes = {};

  /// Value and slope at a time, by cubics through the four nearest samples that no jump parts from
  /// it, and the jump's own sides; on a jump that after it. Held constant beyond the ends.
  std::array<double, 2> at(double time) const;

  /// The same of the piece between jumps of this number, continued beyond its ends.
  std::array<double, 2> at(double time, std::size_t piece) const;

  /// Of the piece that a time lies in.
  std::size_t piece_at(double time) const;
};

/// Adds a spike at a time for what lines, to both sides of jumps, and spikes miss of the curve's
/// integral [its unit s] from the value before to this one.
void add_missed(SampledCurve& curve, double time, std::size_t value, double integral);

/// (one - other) / span of two curves on one grid. Where both have as many jumps each piece is
/// taken from its like, so that jumps that moved leave no spike; they are then half way between.
SampledCurve difference_quotient(const SampledCurve& one, const SampledCurve& other, double span);

/// What the sensor's linear chain makes of a curve, as sensor_response() of its samples does, jumps
/// and spikes taken exactly. The result has the same jumps, some of them of size zero, and no
/// spikes where there is a chain.
SampledCurve sensor_response(const Sensor& sensor, SampledCurve curve);

}  // namespace impactrig::datasets
