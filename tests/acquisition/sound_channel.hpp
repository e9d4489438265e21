// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/importer.hpp"

namespace impactrig::acquisition::tests {

/// The only channel of a recording that an importer read without a warning.
inline const datasets::Channel& sound_channel(const datasets::Record& record,
                                              std::string_view importer) {
  EXPECT_EQ(record.provenance.importer, importer);
  EXPECT_THAT(record.warnings, testing::IsEmpty());
  EXPECT_EQ(record.channels.size(), 1U);
  if (record.channels.empty()) throw std::runtime_error("there is no channel");
  return record.channels.front();
}

/// Name and unit of a channel; start and interval of its clock [s].
inline void expect_head(const datasets::Channel& channel, std::string_view name,
                        std::string_view unit, double start, double interval) {
  EXPECT_EQ(channel.name, name);
  EXPECT_EQ(channel.unit, unit);
  EXPECT_EQ(channel.clock.start, start);
  EXPECT_EQ(channel.clock.interval, interval);
}

/// Asks for a window [s], of these channels.
inline ImportOptions part(double from, double to, std::vector<std::string> channels = {}) {
  ImportOptions options;
  options.from = from;
  options.to = to;
  options.channels = std::move(channels);
  return options;
}

/// Asks for what a channel has from a time [s] on.
inline ImportOptions part_from(double from, std::string channel) {
  return part(from, std::numeric_limits<double>::infinity(), {std::move(channel)});
}

}  // namespace impactrig::acquisition::tests
