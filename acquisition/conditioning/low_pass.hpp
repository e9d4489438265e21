// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What a low-pass did to a channel.
struct LowPassed {
  datasets::Edit edit;
  double lost = 0.0;  ///< part of the largest departure from the median that is gone
};

/// zero_phase_low_pass() of a channel; invalid samples and such as are not finite are bridged by
/// straight lines before and stay, or become, marked. Throws std::invalid_argument besides when the
/// record is shorter than a period of the cutoff.
LowPassed low_pass(datasets::Channel& channel, const datasets::LowPass& filter);

}  // namespace impactrig::acquisition
