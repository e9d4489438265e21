// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "acquisition/conditioning/baseline.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// A channel computed from another one, and how.
struct Derived {
  datasets::Channel channel;
  datasets::Edit edit;
};

/// What an integral needs to know besides the signal.
struct IntegrationOptions {
  /// Where the integrand should have been zero (before the trigger): its straight line there is
  /// taken off first, so that the integral neither runs away nor bends. Only for an integrand
  /// that is zero there (acceleration of a free swing at its lowest point, not velocity).
  std::optional<TimeSpan> quiet{};
  double zero_at = 0.0;  ///< time at which the integral is 0 [s]; clamped to the record
};

/// The integral of a channel over time by the trapezoidal rule: velocity from acceleration,
/// displacement from velocity, impulse (N s, quantity `other`) from force.
///
/// The error for a signal of angular frequency w is (w h)²/12 of it, h the sample interval: 0.03 %
/// at 10 kHz and 1 MHz. White noise of standard deviation s grows to s h sqrt(n) after n samples,
/// an unknown offset b to b h n. Invalid samples are bridged by straight lines and stay marked;
/// what follows them carries their error as a constant.
///
/// Throws std::invalid_argument when the channel is no time history with uniform steps.
Derived integrate(const datasets::Channel& channel, const IntegrationOptions& options = {});

/// The derivative of a channel by the five-point stencil
///
///   f'(t_i) = (f_{i-2} - 8 f_{i-1} + 8 f_{i+1} - f_{i+2}) / 12 h
///
/// and the one-sided five-point ones of the same order at the first and last two samples; exact
/// for polynomials of degree 4. The error for a signal of angular frequency w is (w h)⁴/30 of it.
/// White noise s becomes 0.95 s/h: differentiating a recording of 1 MHz multiplies a noise of
/// 1 mm/s to 950 m/s². A sample whose stencil touches an invalid one is invalid.
///
/// Throws std::invalid_argument when the channel is no time history with uniform steps or has fewer
/// than 5 samples.
Derived differentiate(const datasets::Channel& channel);

}  // namespace impactrig::acquisition
