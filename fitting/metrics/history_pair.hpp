// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace impactrig::fitting {

/// Two histories of one quantity in one unit on the same uniform time base, sample by sample (n).
/// What this folder takes; its sums are plain sums over the samples (rectangle rule), and a number
/// that is not defined for a pair is NaN.
struct HistoryPair {
  std::span<const double> measured;  ///< m, the reference
  std::span<const double> computed;  ///< c
};

/// Throws std::invalid_argument unless both are of one length, at least `fewest`, and finite.
void require_comparable(const HistoryPair& pair, std::size_t fewest = 1);

/// max |x|; 0 without samples.
double peak_of(std::span<const double> x);

/// √Σ x², without overflow or underflow of the squares.
double norm_of(std::span<const double> x);

/// √Σ (c − m)².
double norm_of_difference(const HistoryPair& pair);

}  // namespace impactrig::fitting
