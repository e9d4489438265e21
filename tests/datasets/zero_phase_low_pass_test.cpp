// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/zero_phase_low_pass.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace impactrig::datasets {
namespace {

constexpr std::size_t samples = 6000;

/// Smooth and without an end in sight: two sinusoids that have no common period, 1 at most.
std::vector<double> vibration(std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<double>(i);
    values.push_back(0.5 * std::sin(0.13 * x + 1.0) + 0.5 * std::cos(0.7 * x));
  }
  return values;
}

/// A record between its reflections about its end points: three times as long.
std::vector<double> prolonged(const std::vector<double>& values) {
  const std::size_t last = values.size() - 1;
  std::vector<double> longer;
  for (std::size_t i = last; i > 0; --i) longer.push_back(2.0 * values.front() - values[i]);
  longer.insert(longer.end(), values.begin(), values.end());
  for (std::size_t i = last; i > 0; --i) longer.push_back(2.0 * values.back() - values[i - 1]);
  return longer;
}

constexpr int orders[] = {1, 2, 4, 8};
constexpr double cutoffs[] = {0.01, 0.05, 0.1, 0.2, 0.25, 0.3, 0.38, 0.45};

// Reflections go as far as the filter remembers 1e-9: going on beyond changes no more than that.
TEST(ZeroPhaseLowPass, ReflectsAsFarAsItRemembers) {
  const std::vector<double> record = vibration(samples), longer = prolonged(record);
  for (const int order : orders)
    for (const double cutoff : cutoffs) {
      const auto once = zero_phase_low_pass(record, 1.0, {cutoff, order});
      const auto further = zero_phase_low_pass(longer, 1.0, {cutoff, order});
      double off = 0.0;
      for (std::size_t i = 0; i < samples; ++i)
        off = std::max(off, std::abs(once[i] - further[samples - 1 + i]));
      EXPECT_LT(off, 1e-9) << order << " " << cutoff;
    }
}

// The truth is what the filter makes of a record that goes on: 11.5 = ln 1e5 memories from an end
// of the part that was cut out nothing more than 1e-5 is left of the cut.
TEST(ZeroPhaseLowPass, ForgetsTheEndsWithinItsMemory) {
  const std::vector<double> record = vibration(3 * samples);
  const std::vector<double> part(record.begin() + samples, record.begin() + 2 * samples);
  for (const int order : orders)
    for (const double cutoff : cutoffs) {
      const LowPass filter{cutoff, order};
      const auto truth = zero_phase_low_pass(record, 1.0, filter);
      const auto found = zero_phase_low_pass(part, 1.0, filter);
      const auto reach = static_cast<std::size_t>(std::ceil(11.5 * low_pass_memory(filter, 1.0)));
      for (std::size_t i = reach; i < samples - reach; ++i)
        ASSERT_NEAR(found[i], truth[samples + i], 1e-5) << order << " " << cutoff << " " << i;
    }
}

}  // namespace
}  // namespace impactrig::datasets
