// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "datasets/record.hpp"

namespace impactrig::acquisition::tests {

/// A table with so many rows; `time` says when a row was taken.
template <typename Time>
std::string table(std::size_t rows, const Time& time) {
  std::string text = "Time [s],Force [N],Velocity [m/s]\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const std::string force =
        i % 1000 == 7 ? "" : fmt::format("{:.6f}", std::sin(0.01 * double(i)));
    text += fmt::format("{:.7f},{},{}\n", time(i), force, i);
  }
  return text;
}

inline double microseconds(std::size_t i) {
  return 1e-6 * static_cast<double>(i);
}

/// Steps that no clock explains.
inline double uneven(std::size_t i) {
  return 1e-6 * static_cast<double>(i) + (i % 2 == 0 ? 0.0 : 4e-7);
}

inline void expect_same(const datasets::Record& found, const datasets::Record& expected) {
  ASSERT_EQ(found.channels.size(), expected.channels.size());
  EXPECT_EQ(found.warnings, expected.warnings);
  EXPECT_EQ(found.attributes, expected.attributes);
  for (std::size_t c = 0; c < found.channels.size(); ++c) {
    const datasets::Channel& a = found.channels[c];
    const datasets::Channel& b = expected.channels[c];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.unit, b.unit);
    EXPECT_EQ(a.quantity, b.quantity);
    EXPECT_EQ(a.valid, b.valid);
    EXPECT_EQ(a.clock.start, b.clock.start);
    EXPECT_EQ(a.clock.interval, b.clock.interval);
    EXPECT_EQ(a.clock.times, b.clock.times);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!a.is_valid(i)) continue;
      ASSERT_EQ(a.value(i), b.value(i)) << a.name << " " << i;
    }
  }
}

}  // namespace impactrig::acquisition::tests
