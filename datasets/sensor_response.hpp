// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "datasets/sensor.hpp"

namespace impactrig::datasets {

/// What the sensor's linear chain (resonance, low cut, high cut; not delay, sensitivity, polarity)
/// makes of a history.
///
/// The input is taken as linear between its samples and the whole chain is integrated exactly for
/// such an input (ramp-invariant, or first-order hold), so that the error is the input's own
/// interpolation error, of second order in the interval. Stable for any interval. Before the first
/// sample the input was constant for ever: low-passes start at input[0], a low cut at 0.
///
/// input: (n), any SI unit; interval [s], > 0; returns (n) in the same unit.
/// Throws std::invalid_argument where the interval or a value of the chain is out of its range.
std::vector<double> sensor_response(const Sensor& sensor, std::span<const double> input,
                                    double interval);

}  // namespace impactrig::datasets
