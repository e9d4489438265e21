// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/impact.hpp"

/// What a fit may take from a channel whose samples have been through filters. Without filters:
/// every sample that is valid.
namespace impactrig::fitting {

/// Of all its filters together, to either side of a sample [s].
double reach_of(const datasets::ImpactSignal& signal);

/// 1 where a sample, and all that a filter made it of, was recorded (n_samples): a filter put
/// something in the place of what is not valid, and went on beyond the record's ends.
std::vector<std::uint8_t> sound_samples(const datasets::ImpactSignal& signal);

/// One sample in so many is to be fitted: so far apart, their noise has power at all frequencies up
/// to half of their rate, since what a filter took above its pass band is filled by what is
/// mirrored there. Closer ones have noise that next to nothing is left of at some frequencies,
/// where rounding would count for a measurement.
std::size_t every_of(const datasets::ImpactSignal& signal);

/// A sentence on that, for what a fit leaves out.
std::string thinning_sentence(const datasets::ImpactSignal& signal);

}  // namespace impactrig::fitting
