// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace impactrig::models {

/// A touch slower than this part of the first approach speed is taken as that fast in μ = d / v⁻:
/// the law divides by v⁻, and a grazing touch followed by a push of the vibrating bar would
/// otherwise be damped without bound.
inline constexpr double grazing_fraction = 0.01;
inline constexpr double longest_default_run = 0.1;  // [s]
inline constexpr std::size_t most_episodes = 100'000;

}  // namespace impactrig::models
