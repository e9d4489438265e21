// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "acquisition/importers/tdms_scaling.hpp"

namespace impactrig::acquisition {

/// When a channel's first sample was taken (wf_start_time); none where that was not set.
std::optional<TdmsTime> tdms_start(const TdmsProperties& properties);

/// `b` - `a` [s].
double seconds_between(const TdmsTime& a, const TdmsTime& b);

/// What `wf_increment` counts: how many seconds its unit (wf_xunit_string) has; none where the
/// channel lies over anything else. Without a unit the abscissa's name (wf_xname) decides.
std::optional<double> seconds_of_abscissa(const TdmsProperties& properties);

/// From one sample to the next [s, or the unit of another abscissa]; 0 where nothing sound is
/// stated.
double tdms_step(const TdmsProperties& properties);

/// `wf_start_offset` likewise.
double tdms_start_offset(const TdmsProperties& properties);

}  // namespace impactrig::acquisition
