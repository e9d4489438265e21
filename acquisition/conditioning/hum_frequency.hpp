// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "acquisition/conditioning/hum_fit.hpp"
#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// How far the mains may be from its stated frequency, as a part of it.
constexpr double mains_tolerance = 0.02;

/// The frequency within the mains' tolerance at which hum explains quiet samples best, in a time
/// that grows with n log n.
///
/// `coarse` has a few points a period, for the fundamental alone: where the frequencies to compare,
/// a fifth of the spectral width 1/T apart, are few, each is fitted. Where they are many, the
/// points less a line for each stretch are turned back by the stated frequency and averaged to 32
/// times the tolerance; the peaks of the transform of that short series are fitted
/// [RifeBoorstyn1974]. `points` with all multiples then settle it by steps of Gauss and Newton, to
/// 1e-9 of 1/T.
double hum_frequency(const HumPoints& coarse, const HumPoints& points, double stated,
                     int harmonics);

constexpr double default_mains = 50.0;  ///< where none is stated [Hz]

/// The quiet samples of a channel, and the mains in them.
struct QuietHum {
  HumPoints points;
  double frequency = 0.0;  ///< [Hz]
  bool from_data = false;  ///< else as stated: the samples span less than 5 periods
};

/// `values`: those of the channel, or what is left of them. Throws std::invalid_argument when fewer
/// than 32 samples are quiet, or the highest multiple is not below a quarter of the sample rate.
QuietHum find_quiet_hum(const datasets::Channel& channel, const datasets::RemoveHum& hum,
                        std::span<const double> values);

}  // namespace impactrig::acquisition
