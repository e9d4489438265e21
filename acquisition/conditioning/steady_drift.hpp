// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// The straight line that a signal follows from the begin of its record to the end, but for pulses:
/// where it goes by more than 5 % of what the highest one does beside it, and leaves nothing but
/// noise, or 2 % of its way. None elsewhere. `grain`: grain_of() the signal.
std::optional<QuietFit> steady_drift(const Trace& trace, double grain);

}  // namespace impactrig::acquisition
