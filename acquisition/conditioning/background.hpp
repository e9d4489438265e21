// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace impactrig::acquisition {

/// 1.4826 median absolute deviations are one standard deviation of a normal distribution.
inline constexpr double normal_mad = 1.4826;

double median(std::vector<double> values);  ///< of at least one value

/// At most `most` of them, evenly spread.
std::vector<double> evenly_spread(std::span<const double> values, std::size_t most);

// Samples that `valid` has as 0 do not count below, as what bridges them is no noise; where too few
// others are there, all do.

/// Median and robust standard deviation (from the median absolute deviation), of at most 2¹⁸ evenly
/// spread samples.
struct Spread {
  double centre = 0.0;
  double sigma = 0.0;
};

Spread robust_spread(std::span<const double> values, std::span<const std::uint8_t> valid = {});

/// Standard deviation of the part of a signal that changes from sample to sample, from the median
/// absolute second difference over sqrt(6): exact for white noise, too small for correlated noise,
/// blind to anything slow.
double step_noise(std::span<const double> values, std::span<const std::uint8_t> valid = {});

/// The means of this many blocks: what a signal does that is slow beside them. Blocks of which less
/// than a quarter counts are left out.
std::vector<double> block_means(std::span<const double> values, std::span<const std::uint8_t> valid,
                                std::size_t blocks);

/// From the least to the largest of them; 0 where there is none.
double range_of_means(std::span<const double> values, std::span<const std::uint8_t> valid,
                      std::size_t blocks);

/// How many standard deviations nothing but noise may reach among n samples: 6, and more from 10⁴
/// samples on, sqrt(2 ln n) + 1.7 (the expected extreme of n normal numbers, plus a margin that
/// normal noise passes less than once in 10⁴ records).
double noise_gate(std::size_t n);

/// One digitiser step: that of the grid on which nearly all distinct values lie, where there are
/// many repeats; else 0.
double quantum_of(std::span<const double> values, std::span<const std::uint8_t> valid = {});

/// What two samples must differ by to differ at all: the digitiser step, or the rounding of a
/// 24-bit number, 1e-7 of the largest value.
double grain_of(std::span<const double> values, std::span<const std::uint8_t> valid = {});

/// A stretch before the trigger: its course and the scatter about it.
struct QuietFit {
  std::size_t begin = 0, end = 0;      ///< samples [begin, end)
  double coefficients[3] = {0, 0, 0};  ///< of 1, u, u²; u = (i - middle) / half, i in samples
  double middle = 0.0, half = 1.0;
  double mean = 0.0;         ///< of the samples that belong to the course
  double sigma = 0.0;        ///< standard deviation about the course
  double correlation = 1.0;  ///< integrated autocorrelation time of that scatter [samples]

  double at(double index) const {
    const double u = (index - middle) / half;
    return coefficients[0] + u * (coefficients[1] + u * coefficients[2]);
  }

  std::size_t size() const { return end - begin; }
};

/// Fits a polynomial of degree 0, 1 or 2 to values[begin, end), at least 3 samples: robust
/// (repeated medians of blocks) at first, then least squares over the samples within 4 standard
/// deviations, or 1.6 digitiser steps where those are more: a coarsely digitised quiet signal has
/// most of its samples on one value, and no median absolute deviation.
QuietFit fit_quiet(std::span<const double> values, std::size_t begin, std::size_t end, int degree,
                   double quantum, std::span<const std::uint8_t> valid = {});

/// Integrated autocorrelation time 1 + 2 sum rho_k of a stretch with mean zero, in samples, >= 1.
/// The sum ends at the first lag of at least 5 times its own value [Sokal1997]; a stretch shorter
/// than 50 such times gives a rough figure only. Of a longer one than 2²⁰ samples those in its
/// middle tell. With `valid`, rho_k is of the pairs that both count.
double correlation_time(std::span<const double> residuals,
                        std::span<const std::uint8_t> valid = {});

/// What drift and mains hum cannot have made of a record: what is left when a polynomial that
/// follows anything below 200 Hz is taken off. Meant for records of up to 20 ms.
struct FastPart {
  double rms = 0.0;      ///< of the means of `blocks` blocks
  double highest = 0.0;  ///< of the single samples
  std::size_t blocks = 0;
};

FastPart fast_part(std::span<const double> values, double interval);

/// A record longer than this shows hum as such, by its median absolute deviation [s].
inline constexpr double longest_hum = 20e-3;

/// True when drift and hum explain a record in which a signal of `height` fills most of the time:
/// the fast part is less than 1.4 times the noise `sigma`, or 1 % of the height.
bool explained_by_drift_and_hum(std::span<const double> values, double interval, double height,
                                double sigma);

}  // namespace impactrig::acquisition
