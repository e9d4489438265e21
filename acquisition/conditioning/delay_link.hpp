// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Terms that link a bar's motion to its force, at most.
inline constexpr int most_terms = 4;

/// Samples that a delay can be estimated from, at least.
inline constexpr std::size_t least_samples = 24;

/// Both channels pass a low-pass at so much of the sample rate.
inline constexpr double compared_band = 0.1;

/// Samples of a segment, low-passed.
struct Signal {
  double start = 0.0, interval = 0.0;
  std::vector<double> values;
  /// How much of each sound samples have made, of weights that sum up to 1; empty: all.
  std::vector<double> sound = {};

  double time(std::size_t i) const { return start + interval * static_cast<double>(i); }

  /// Whether sound samples have made most of a value.
  bool counts(std::size_t i) const { return sound.empty() || sound[i] >= 0.5; }

  /// Whether the two values about t count.
  bool counts_at(double t) const;

  /// The cubic through the four samples about t; the record must reach one sample further.
  double at(double t) const;
};

/// How the channel follows from the reference.
struct Link {
  Signal channel;
  std::vector<Signal> basis;  ///< as many as there may be terms
  int degree = 1;             ///< of the polynomial beside them
  bool expansion = false;     ///< the number of terms is open
  int integrations = 0;       ///< that the one term is of the reference
  double noise_power = 0.0;   ///< of the reference before it is integrated [unit² s]
  Signal reference;           ///< before it is integrated
  /// What a stretch of an integrated reference in which no sample counts may have added behind it.
  std::vector<Signal> gaps = {};
  std::vector<std::uint8_t> counting = {};  ///< samples of the channel that count

  std::size_t counted() const;

  /// Marks the samples that count where the channel is so much later: no more than half of any of
  /// the two may be made of lines that bridge invalid samples. Of a force that drives a bar what is
  /// behind a gap depends on all of it.
  void count_at(double delay);
};

/// How often a displacement is differentiated; none for what is no motion.
std::optional<int> derivative_of(datasets::Quantity quantity);

/// What estimate_delay() fits. Throws std::invalid_argument as it does.
Link link_between(const datasets::Channel& reference, const datasets::Channel& channel,
                  const datasets::TimeSpan& window, double range);

}  // namespace impactrig::acquisition
