// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "datasets/conditioning.hpp"

namespace impactrig::datasets {

/// A Butterworth low-pass of `order` forwards and then backwards over `values` (n), which were
/// taken every `interval` h [s]: no delay, and both passes together have the gain
///
///   1 / (1 + (w/w₁)^2n),  w = tan(pi f h),  w₁ = tan(pi f_c h) / (√2 − 1)^(1/2n)
///
/// at frequency f, n the order: 3 dB down at the cutoff f_c.
/// State variables are integrators by the trapezoidal rule, which keeps the rounding error small at
/// any f_c h. The record is prolonged at both ends by its own reflection about the end points,
/// until the filter remembers 1e-9 of what lies beyond. What a longer record would have given
/// differs by a tenth of the record's range at its ends, where that is noise, and by 1e-5
/// within 11.5 of the memories below: 3.4/f_c at order 4, far more from a cutoff of 0.4 of the
/// sample rate on.
///
/// Throws std::invalid_argument when the cutoff is not between 0 and half of the sample rate or the
/// order is not 1 to 8.
std::vector<double> zero_phase_low_pass(std::span<const double> values, double interval,
                                        const LowPass& filter);

/// Samples in which what the filter remembers of one in either pass has fallen to 1/e.
double low_pass_memory(const LowPass& filter, double interval);

}  // namespace impactrig::datasets
