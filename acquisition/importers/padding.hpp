// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// Zeros with which a recorder fills the begin and the end of a channel, where it was triggered
/// before its memory was full: many samples on end that are exactly 0 beside samples that go up and
/// down about some level and hardly repeat. A quiet signal before a pulse looks otherwise, as does
/// one on a coarse digitiser's level.
class PaddingCheck {
 public:
  /// The next samples of a channel.
  void add(const SampleBlock& block);

  /// How many zeros are padding; 0 where there is none.
  std::uint64_t begin() const;
  std::uint64_t end() const;

 private:
  static constexpr std::size_t most_beside = 256;  ///< samples beside that are looked at

  template <typename Sample>
  void look(std::span<const Sample> samples);

  std::uint64_t seen_ = 0;
  std::uint64_t leading_ = 0;
  std::uint64_t trailing_ = 0;
  std::uint64_t within_ = 0;                  ///< zeros that ended a block and were not the last
  std::vector<double> behind_;                ///< samples behind the leading zeros
  std::array<double, most_beside> before_{};  ///< the last ones before the trailing zeros, a ring
  std::uint64_t before_count_ = 0;
};

}  // namespace impactrig::acquisition
