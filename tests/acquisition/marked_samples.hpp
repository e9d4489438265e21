// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "datasets/record.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::tests {

/// Marks a part of the samples [begin, end) as not valid, in stretches of `shortest` to `longest`,
/// as a sensor's dropouts would be. They keep what was recorded.
inline void mark_stretches(datasets::Channel& channel, double part, std::size_t begin,
                           std::size_t end, Noise& noise, std::size_t shortest = 10,
                           std::size_t longest = 60) {
  channel.valid.resize(channel.size(), 1);
  auto left = static_cast<std::size_t>(part * static_cast<double>(end - begin));
  while (left > 0) {
    const auto more = static_cast<double>(longest - shortest) * noise.uniform();
    const std::size_t length = shortest + static_cast<std::size_t>(more);
    const auto room = static_cast<double>(end - begin - length);
    std::size_t i = begin + static_cast<std::size_t>(noise.uniform() * room);
    for (const std::size_t to = i + length; i < to && left > 0; ++i) {
      left -= channel.valid[i];
      channel.valid[i] = 0;
    }
  }
}

/// As many single samples, anywhere in there.
inline void mark_single(datasets::Channel& channel, double part, std::size_t begin, std::size_t end,
                        Noise& noise) {
  mark_stretches(channel, part, begin, end, noise, 1, 1);
}

}  // namespace impactrig::tests
