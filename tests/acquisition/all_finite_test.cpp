// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/all_finite.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace impactrig::acquisition {
namespace {

template <typename Number>
class AllFinite : public testing::Test {};

using Numbers = testing::Types<float, double>;
TYPED_TEST_SUITE(AllFinite, Numbers);

// One strange sample anywhere is seen, whatever the length: also behind the last whole round.
TYPED_TEST(AllFinite, SeesOneStrangeSampleAnywhere) {
  using Limits = std::numeric_limits<TypeParam>;
  for (const std::size_t n : {1U, 31U, 32U, 33U, 64U, 65U, 200U}) {
    std::vector<TypeParam> samples(n, Limits::max());
    EXPECT_TRUE(all_finite(std::span<const TypeParam>(samples))) << n;
    for (std::size_t i = 0; i < n; ++i)
      for (const TypeParam strange :
           {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()}) {
        samples[i] = strange;
        EXPECT_FALSE(all_finite(std::span<const TypeParam>(samples))) << n << " " << i;
        samples[i] = Limits::lowest();
      }
  }
}

TYPED_TEST(AllFinite, TakesTheSmallestNumbersAndNone) {
  using Limits = std::numeric_limits<TypeParam>;
  EXPECT_TRUE(all_finite(std::span<const TypeParam>()));
  const std::vector<TypeParam> small(100, -Limits::denorm_min());
  EXPECT_TRUE(all_finite(std::span<const TypeParam>(small)));
  const std::vector<TypeParam> zeros(100, TypeParam(-0.0));
  EXPECT_TRUE(all_finite(std::span<const TypeParam>(zeros)));
}

}  // namespace
}  // namespace impactrig::acquisition
