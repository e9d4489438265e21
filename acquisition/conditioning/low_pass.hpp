// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// A Butterworth low-pass of `order` forwards and then backwards over `values` (n), which were
/// taken every `interval` h [s]: no delay, and both passes together have the gain
///
///   1 / (1 + (w/w₁)^2n),  w = tan(pi f h),  w₁ = tan(pi f_c h) / (√2 − 1)^(1/2n)
///
/// at frequency f, n the order: 3 dB down at the cutoff f_c.
/// State variables are integrators by the trapezoidal rule, which keeps the rounding error small at
/// any f_c h. The record is prolonged at both ends by its own reflection about the end points, as
/// often as the filter's memory asks for; what lies within about 1/f_c of an end depends on that.
///
/// Throws std::invalid_argument when the cutoff is not between 0 and half of the sample rate or the
/// order is not 1 to 8.
std::vector<double> zero_phase_low_pass(std::span<const double> values, double interval,
                                        const datasets::LowPass& filter);

/// What a low-pass did to a channel.
struct LowPassed {
  datasets::Edit edit;
  double lost = 0.0;  ///< part of the largest departure from the median that is gone
};

/// The same for a channel; invalid samples and such as are not finite are bridged by straight lines
/// before and stay, or become, marked. Throws std::invalid_argument besides when the record is
/// shorter than a period of the cutoff.
LowPassed low_pass(datasets::Channel& channel, const datasets::LowPass& filter);

}  // namespace impactrig::acquisition
