// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/band_limited.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace impactrig::datasets {
namespace {

// Weights that are made once are those of each single value, reflections included.
TEST(BandLimited, AtItsSamplesIsWhatItIsThere) {
  for (const std::size_t samples : {1U, 2U, 50U, 1000U})
    for (const double stretch : {1.0, 1.7, 4.5, 5.0}) {
      SCOPED_TRACE(testing::Message() << samples << " " << stretch);
      std::vector<double> values;
      for (std::size_t i = 0; i < samples; ++i)
        values.push_back(std::sin(0.1 * static_cast<double>(i * i)) +
                         0.01 * static_cast<double>(i));
      const BandLimited signal(values, stretch);
      const std::vector<double> found = signal.at_samples();
      ASSERT_EQ(found.size(), samples);
      for (std::size_t i = 0; i < samples; ++i)
        EXPECT_EQ(found[i], signal(static_cast<double>(i))) << i;
    }
}

}  // namespace
}  // namespace impactrig::datasets
