// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Where records come from one at a time: an instrument, the synthetic rig, a replayed file. Downstream cannot tell.
class Source {
 public:
  virtual ~Source() = default;
  /// Waits for the next triggered record; none when the source is exhausted.
  /// Throws datasets::InputError or datasets::FileError.
  virtual std::optional<datasets::Record> next() = 0;
};

}  // namespace impactrig::acquisition
