// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "acquisition/recording_spool.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Samples of a channel that an exporter holds at once.
constexpr std::size_t samples_at_once = 8192;

/// A channel on its way to a file: what is known of it, and its samples part by part.
struct OutgoingChannel {
  const datasets::Channel* head = nullptr;  ///< its samples and times are not looked at
  std::uint64_t size = 0;
  bool complex = false;
  bool uniform = true;  ///< false: parts have stated times
  bool marked = false;  ///< false: all samples are sound
  bool single = false;  ///< recorded in single precision
  /// Samples [first, first + count) as a channel of these only.
  std::function<datasets::Channel(std::uint64_t first, std::size_t count)> part;

  /// Hands all samples to `use(part, first)`, part by part.
  template <typename Use>
  void each(const Use& use) const {
    for (std::uint64_t first = 0; first < size; first += samples_at_once) {
      const std::uint64_t left = size - first;
      use(part(first, static_cast<std::size_t>(left < samples_at_once ? left : samples_at_once)),
          first);
    }
  }
};

/// A recording on its way to a file.
struct OutgoingRecording {
  const datasets::Record& record;  ///< likewise
  std::vector<OutgoingChannel> channels;
};

/// Of a record in memory, which must live as long.
OutgoingRecording outgoing(const datasets::Record& record);

/// Without the channels of a single number that stand beside others, as constants do, which a table
/// has no place for; a sentence tells which.
OutgoingRecording without_single_numbers(const OutgoingRecording& recording,
                                         std::vector<std::string>& warnings);

/// Of samples on the disk; `record` has no samples. Both must live as long.
OutgoingRecording outgoing(const datasets::Record& record, const SpooledRecording& samples);

}  // namespace impactrig::acquisition
