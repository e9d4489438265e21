// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

using datasets::TimeSpan;

/// What was taken off a channel, and the standard uncertainty of that, in the channel's unit.
struct RemovedBaseline {
  datasets::Edit edit;
  double uncertainty = 0.0;
  double noise = 0.0;        ///< standard deviation about it
  double correlation = 1.0;  ///< integrated autocorrelation time of that [samples]
};

/// Takes the robust mean over `quiet` (before the trigger) off a channel. The samples stay; only
/// Channel::offset changes. Not for velocity or displacement, whose level before touch is the
/// motion itself. Samples that are not valid do not count, nor do they in the stated uncertainty.
/// Throws std::invalid_argument when fewer than 3 others lie within the span.
RemovedBaseline remove_baseline(datasets::Channel& channel, const TimeSpan& quiet);

/// The line that came off, and what it is uncertain by.
struct RemovedDrift {
  datasets::Edit edit;
  double middle = 0.0, half = 1.0;  ///< of its span [samples]
  /// Of the value in the middle, of the change from there to an end, and of both [unit²].
  double of_level = 0.0, of_rise = 0.0, of_both = 0.0;
  double noise = 0.0;        ///< standard deviation about it
  double correlation = 1.0;  ///< integrated autocorrelation time of that [samples]

  /// Standard error of the sum of what is left between two samples [unit]: what the line is off,
  /// and the noise itself.
  double error_of_sum(double from, double to) const;
};

/// Takes the straight line through `quiet` (robust: outliers beyond 4 standard deviations do not
/// count) off the whole channel; the samples become double. The line's slope is uncertain by
/// sigma sqrt(12 / n³) a sample, so the further the channel reaches beyond the span, the less is
/// won. Samples that are not valid do not count, nor do they in the stated uncertainty. Throws
/// std::invalid_argument when fewer than 8 others lie within the span.
RemovedDrift remove_drift(datasets::Channel& channel, const TimeSpan& quiet);

}  // namespace impactrig::acquisition
