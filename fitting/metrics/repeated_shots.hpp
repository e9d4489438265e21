// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

namespace impactrig::fitting {

/// How much of a computed history lies within a band round a measured one.
struct BandCoverage {
  double fraction = 0.0;           ///< share of the samples inside [-]
  double effective_samples = 0.0;  ///< of the residual in parts of the band's half width
  double low = 0.0;                ///< 95 % interval of the share (Wilson), with as many
  double high = 0.0;               ///< independent samples as effective_samples
};

/// Counts |c − centre| ≤ half_width, sample by sample (n). A share below that of the band (0.95 for
/// one of 95 %) speaks against the model only where the interval does not reach it: samples that
/// follow each other smoothly lie in or out together. Samples with a half width of 0 are left out
/// of the effective number, and count as inside where c equals the centre. Throws
/// std::invalid_argument for different lengths, no samples, or a negative half width. Sources:
/// [Wilson1927], [Sokal1997].
BandCoverage band_coverage(std::span<const double> computed, std::span<const double> centre,
                           std::span<const double> half_width);

/// Shots of one condition, sample by sample.
struct ShotScatter {
  std::vector<double> mean;       ///< m̄ (n)
  std::vector<double> deviation;  ///< s, standard deviation between shots (n), shots − 1
};

/// Throws std::invalid_argument for fewer than two shots or different lengths.
ShotScatter shot_scatter(const std::vector<std::vector<double>>& shots);

/// χ² of a computed history against the mean of repeated shots, a sample:
///
///   χ² / n = Σ ((c − m̄) / (s / √shots))² / n
///
/// About (shots − 1) / (shots − 3) where c is the truth and there are more than three shots (s is
/// estimated), far more where c is off by more than the mean is known. Samples with s = 0 are left
/// out; NaN where all are.
double chi2_per_sample(std::span<const double> computed, const ShotScatter& scatter,
                       std::size_t shots);

}  // namespace impactrig::fitting
