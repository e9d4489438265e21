// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// How much later than another channel a channel shows the same event.
struct DelayEstimate {
  double value = 0.0;        ///< [s], positive: later than the reference
  double uncertainty = 0.0;  ///< standard uncertainty [s]
  double misfit = 0.0;  ///< rms of what is left over rms of the part that follows the reference
  int terms = 1;        ///< of the expansion that links the two
};

/// Estimates the delay of `channel` against `reference` from the data within `window` (on the
/// channel's clock): least squares of
///
///   y(t) = Σ c_k B_k(t - delay) + polynomial(t)
///
/// over the delay within +-range, the c_k and the polynomial.
///
/// - Two records of one motion (displacement, velocity, acceleration in any pair, or twice the same
///   quantity): B_0 is the reference, integrated as often as it takes; a free factor and a
///   polynomial of degree 1, and one more for each integration.
/// - Force and motion of a struck bar: B_k is the force's integral over (t - s)^((k-1)/2) ds, once
///   more integrated for a displacement. A bar's answer to an impulse begins as t^(-1/2) (bending
///   waves, Euler-Bernoulli) and the powers of √t that follow are what the ends, shear and the
///   rigid motion add, so that no knowledge of the bar is needed. As many terms, up to 4, as lower
///   Schwarz's criterion. The window should end at the force's peak: later, more terms are needed.
///
/// Both channels pass a low-pass at a tenth of the sample rate first. The uncertainty is that of
/// least squares with the residuals' scatter and autocorrelation, and with what the noise of a
/// reference that is integrated, as seen before it moves, adds to them; for force and motion the
/// change by one more term, what other numbers of terms say by their weights, how far the delay
/// moves beyond the noise where the window ends earlier, and a twentieth of a sample are added in
/// quadrature. Whatever filters do to one of the two only is part of what is estimated, and only
/// roughly a delay: pass each through the other's (sensor_response) where they are known.
///
/// Throws std::invalid_argument when the two quantities have no such relation, clocks are not
/// uniform, fewer than 24 samples lie in the window, or the best delay is at the edge of the range.
DelayEstimate estimate_delay(const datasets::Channel& reference, const datasets::Channel& channel,
                             const datasets::TimeSpan& window, double range);

/// Takes an estimated delay off the channel's clock, beside what was taken off before.
datasets::Edit remove_estimated_delay(const DelayEstimate& estimate, const std::string& reference,
                                      datasets::Channel& channel);

/// Whether a statement gives a value or an uncertainty.
bool says_something(const datasets::Delay& delay);

/// Takes a known delay off the channel's clock: what is stated, else the channel's own. One that
/// was taken off already stays as it is. An edit where the clock has moved.
std::optional<datasets::Edit> remove_known_delay(datasets::Channel& channel,
                                                 const datasets::Delay& stated = {});

}  // namespace impactrig::acquisition
