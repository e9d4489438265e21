// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "datasets/impact.hpp"
#include "fitting/noise_model.hpp"

namespace impactrig::fitting {

/// Of the peak, where the record shows no noise at all.
inline constexpr double unseen_noise = 1e-3;

/// Of the contact's duration: the least that lies between the quiet stretch and first touch, which
/// moves during the fit.
inline constexpr double margin_part = 0.1;

/// A channel of a recording as the fit weighs it.
struct FittedChannel {
  const datasets::ImpactSignal* signal = nullptr;
  std::vector<double> measured;  ///< what is fitted: the signal's values, or others in their place
  NoiseModel noise;
  bool noise_known = true;  ///< it was seen before the trigger
  bool one_by_one = false;  ///< samples are weighed as if the noise were white
  /// 1 where a sample, and all that a filter made it of, was recorded (n_samples).
  std::vector<std::uint8_t> sound;
  /// One sample in so many is fitted: a filter of the record ties those between to them.
  std::size_t every = 1;
  std::vector<std::size_t> used;  ///< indices of the samples fitted, ascending
};

/// How a channel is measured.
struct Measurement {
  double gain = 1.0;
  double shift = 0.0;  ///< first touch as this channel shows it, on the record's axis [s]
};

/// Whether the noise does not reach from one step of the digitiser to the next, so that samples in
/// a row stay on one.
bool within_steps(const datasets::ImpactSignal& signal);

/// The least standard deviation of a sample, by the digitiser's step [SI]: of noise within steps
/// that of a step and of what noise they may hide.
double least_noise(const datasets::ImpactSignal& signal);

/// A channel of an impact with the noise that it shows before the trigger, hum of the mains'
/// frequency [Hz] apart; where it shows none, with `unseen_noise`.
FittedChannel weigh(const datasets::Impact& impact, const datasets::ImpactSignal& signal,
                    double mains_frequency);

/// Whitens what is at a channel's used samples by its noise, stretch by stretch of samples in a
/// row.
void whiten(const FittedChannel& channel, std::span<double> of_used);

}  // namespace impactrig::fitting
