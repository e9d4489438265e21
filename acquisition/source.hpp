// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Where records come from one at a time: an instrument, the synthetic rig, a replayed file.
/// Downstream cannot tell.
class Source {
 public:
  virtual ~Source() = default;
  /// Waits for the next triggered record; none when the source is exhausted.
  /// Throws datasets::InputError or datasets::FileError.
  virtual std::optional<datasets::Record> next() = 0;
};

/// A kind of source, as `impactrig sources` lists it.
struct SourceDescription {
  std::string_view id;
  std::string_view description;  ///< one line
};

inline constexpr std::array<SourceDescription, 2> sources{{
    {"synthetic", "the rig of a rig file, simulated, with sensors, noise and digitiser"},     //
    {"replay", "recordings of any known format, one after the other, as fast as asked for"},  //
}};

}  // namespace impactrig::acquisition
