// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::datasets {

/// Samples on an even grid that begins at an instant of its own.
struct GridSamples {
  std::ptrdiff_t first = 0;    ///< number of values[0] on the grid
  std::vector<double> values;  ///< (n_samples)
};

/// A linear filter of a record's samples, no matter when they were taken.
struct SampleFilter {
  std::variant<LowPass, Resample> action;
  double interval = 0.0;  ///< of the samples that it was applied to [s]

  /// Within this to either side lies all that a filtered sample depends on by more than 1e-5 [s].
  double reach() const;

  /// Up to here a quarter of the power or more passes [Hz].
  double pass_band() const;

  /// What it makes of a stretch of samples that were taken at that interval, prolonged by
  /// reflections as records are. Resampled ones lie on the new rate's grid, which begins where the
  /// old one does; as many as the stretch reaches over.
  GridSamples of(GridSamples samples) const;
};

/// The filters that a channel has been through, or the channel that it was made of, as the record's
/// edits tell, in their order. None where one of them cannot be told: it was put on even times.
std::optional<std::vector<SampleFilter>> filters_of(const Record& record, const Channel& channel);

}  // namespace impactrig::datasets
