// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"
#include "datasets/sampled_curve.hpp"

namespace impactrig::datasets {

/// A linear filter of a record's samples, no matter when they were taken.
struct SampleFilter {
  std::variant<LowPass, Resample> action;
  double interval = 0.0;  ///< of the samples that it was applied to [s]

  /// Within this to either side lies all that a filtered sample depends on by more than 1e-5 [s].
  double reach() const;

  /// Up to here a quarter of the power or more passes [Hz].
  double pass_band() const;

  /// What the filter makes of a curve that is sampled at that interval, at any instant: of each of
  /// the instants of a fine grid that lie the interval apart what it makes of such a record. The
  /// result is smooth as far as the samples show it and has no jumps; spikes, which move with a
  /// jump, are spread over an interval. Prolonged by reflections as records are.
  SampledCurve of(const SampledCurve& curve) const;
};

/// The filters that a channel has been through, or the channel that it was made of, as the record's
/// edits tell, in their order. None where one of them cannot be told: it was put on even times.
std::optional<std::vector<SampleFilter>> filters_of(const Record& record, const Channel& channel);

}  // namespace impactrig::datasets
