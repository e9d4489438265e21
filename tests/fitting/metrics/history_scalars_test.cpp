// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/history_scalars.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace impactrig::fitting {
namespace {

// A trough of straight lines, 10 deep: 5 % is crossed half a sample from either foot.
TEST(HistoryScalars, AreThoseOfATriangle) {
  const std::vector<double> x = {0, 0, -1, -5, -10, -5, -1, 0, 0};
  const HistoryScalars found = history_scalars(x, 2.0, 0.5);
  EXPECT_EQ(found.peak, -10.0);
  EXPECT_EQ(found.peak_time, 4.0);
  EXPECT_DOUBLE_EQ(found.impulse, -11.0);
  EXPECT_DOUBLE_EQ(found.duration, 0.5 * 5.0);
}

TEST(HistoryScalars, HaveNoDurationThatTheWindowCuts) {
  EXPECT_TRUE(std::isnan(history_scalars(std::vector<double>{1, 2, 0}, 0.0, 1.0).duration));
  EXPECT_TRUE(std::isnan(history_scalars(std::vector<double>{0, 2, 1}, 0.0, 1.0).duration));
  EXPECT_TRUE(std::isnan(history_scalars(std::vector<double>{0, 0}, 0.0, 1.0).duration));
}

TEST(HistoryScalars, NeedSamples) {
  EXPECT_THROW(history_scalars({}, 0.0, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace impactrig::fitting
