// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace impactrig::acquisition {

/// True where no sample is infinite or not a number. Every sample of every recording passes here:
/// it takes as little as reading them from the processor's cache.
bool all_finite(std::span<const float> samples);
bool all_finite(std::span<const double> samples);

}  // namespace impactrig::acquisition
