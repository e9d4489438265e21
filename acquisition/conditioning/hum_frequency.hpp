// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/conditioning/hum_fit.hpp"

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

}  // namespace impactrig::acquisition
