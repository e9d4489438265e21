// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/importers/mdf4_blocks.hpp"

namespace impactrig::acquisition {

/// An array (CA) that each record holds, of numbers or of structures; arrays of arrays are one with
/// the dimensions of both.
struct MdfArray {
  struct Dimension {
    std::uint64_t size = 0;
    std::int64_t bytes = 0;  ///< from one element to the next
    std::int64_t bits = 0;   ///< from one's invalidation bit to the next's
  };

  /// How far an element lies from the first.
  struct Element {
    std::string indices;     ///< "[1][0]", from 0
    std::int64_t bytes = 0;  ///< in the record
    std::int64_t bits = 0;   ///< among the invalidation bits
  };

  std::vector<Dimension> dimensions{};
  std::uint64_t elements = 1;  ///< 1000 at most
  std::uint64_t members = 0;   ///< where the channels (CN) of a structure begin; 0 numbers
  std::string problem{};       ///< why its elements are not told apart: "its array has ..."

  /// `i` counts from 0, the last index fastest.
  Element element(std::uint64_t i) const;
};

/// The array that a channel at hand is composed of. Throws datasets::InputError for what is none.
MdfArray mdf_array(MdfBlocks& blocks, std::uint64_t at);

}  // namespace impactrig::acquisition
