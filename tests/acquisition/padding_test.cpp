// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/padding.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/acquisition/scene.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

std::vector<double> noise(std::size_t count, double level, double step) {
  std::vector<double> values(count, level);
  impactrig::tests::add_noise(values, 1.0, 7);
  for (double& value : values) value = step * std::round(value / step);
  return values;
}

/// Padding at the begin and the end, as samples of a type come by blocks.
template <typename Sample>
std::pair<std::uint64_t, std::uint64_t> padding_of(const std::vector<double>& values,
                                                   std::size_t block) {
  const std::vector<Sample> samples(values.begin(), values.end());
  PaddingCheck check;
  for (std::size_t i = 0; i < samples.size(); i += block) {
    SampleBlock part;
    part.raw = std::span(samples).subspan(i, std::min(block, samples.size() - i));
    check.add(part);
  }
  return {check.begin(), check.end()};
}

using Ends = std::pair<std::uint64_t, std::uint64_t>;

TEST(Padding, IsZerosBesideNoise) {
  for (const double level : {0.0, 5.0}) {
    std::vector<double> values = noise(1000, level, 0.5);
    std::fill_n(values.begin(), 300, 0.0);
    std::fill(values.end() - 200, values.end(), 0.0);
    for (const std::size_t block : {7U, 100U, 300U, 2000U}) {
      SCOPED_TRACE(fmt::format("level {}, blocks of {}", level, block));
      const auto [begin, end] = padding_of<double>(values, block);
      EXPECT_GE(begin, 300U);  // the noise may be 0 itself
      EXPECT_LE(begin, 302U);
      EXPECT_GE(end, 200U);
      EXPECT_LE(end, 202U);
    }
    for (double& value : values) value *= 2.0;
    EXPECT_GE(padding_of<std::int16_t>(values, 1000).first, 300U);
  }
}

TEST(Padding, IsNoQuietSignalBeforeAPulse) {
  std::vector<double> pulse(600, 0.0);
  for (std::size_t i = 0; i < 300; ++i)
    pulse[300 + i] = 2000.0 * std::sin(std::numbers::pi * static_cast<double>(i) / 300.0);
  EXPECT_EQ(padding_of<double>(pulse, 600), Ends(0, 0));
  for (double& value : pulse) value = std::round(value / 8.0);  // 8 bits
  EXPECT_EQ(padding_of<std::int16_t>(pulse, 600), Ends(0, 0));
  EXPECT_EQ(padding_of<double>(std::vector<double>(600, 0.0), 100), Ends(0, 0));
  EXPECT_EQ(padding_of<double>(noise(1000, 0.0, 4.0), 1000), Ends(0, 0));  // rests on one step
  std::vector<double> few = noise(1000, 5.0, 0.5);
  std::fill_n(few.begin(), 20, 0.0);
  EXPECT_EQ(padding_of<double>(few, 1000), Ends(0, 0));
}

TEST(Padding, IsToldWithTheOptionsThatLeaveItOut) {
  std::vector<double> values = noise(200, 5.0, 0.01);
  std::fill_n(values.begin(), 50, 0.0);
  std::fill(values.end() - 40, values.end(), 0.0);
  std::string text = "t [s],F [N]\n";
  for (std::size_t i = 0; i < values.size(); ++i)
    text += fmt::format("{:.3f},{}\n", 0.001 * static_cast<double>(i) - 0.1, values[i]);
  EXPECT_THAT(tests::imported(text).warnings,
              testing::ElementsAre(
                  "'F': the first 50 and the last 40 of 200 samples are exactly 0, and no other "
                  "stretch is: its recorder seems to have filled them in; --from -0.05 --to 0.059 "
                  "leaves them out"));
}

}  // namespace
}  // namespace impactrig::acquisition
