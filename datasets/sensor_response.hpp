// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "datasets/sensor.hpp"

namespace impactrig::datasets {

/// What the sensor's linear chain (resonance, low cut, high cut; not delay, sensitivity, polarity) makes of a history.
///
/// The input is taken as linear between its samples and each section is integrated exactly for such an input, so that the
/// error is the input's own interpolation error. Before the first sample the input was constant for ever: low-passes
/// start at input[0], a low cut at 0.
///
/// input: (n), any SI unit; interval [s]; returns (n) in the same unit.
std::vector<double> sensor_response(const Sensor& sensor, std::span<const double> input,
                                    double interval);

}  // namespace impactrig::datasets
