// SPDX-License-Identifier: BSD-3-Clause
// Figures in order of whatever is recorded.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Impact;
using datasets::Record;
using namespace tests;

/// Noise, random walks, spikes, heavy tails, squares: things no impact test records.
std::vector<double> garbage(std::size_t n, Noise& random) {
  std::vector<double> values(n);
  const int kind = static_cast<int>(6.0 * random.uniform());
  double walk = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double u = random();
    walk += u;
    switch (kind) {
      case 0:
        values[i] = u;
        break;
      case 1:
        values[i] = walk;
        break;
      case 2:
        values[i] = random.uniform() < 0.01 ? 100.0 * u : 0.0;
        break;
      case 3:
        values[i] = std::exp(3.0 * u);
        break;
      case 4:
        values[i] = static_cast<double>(i / (1 + n / 7) % 2);
        break;
      default:
        values[i] = u > 1.0 ? 1.0 : -1.0;
        break;
    }
  }
  if (random.uniform() < 0.3) round_to(values, 0.5);
  return values;
}

TEST(FindImpacts, GivesFiniteFiguresInOrderForAnything) {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Noise random(seed);
    const auto n = static_cast<std::size_t>(std::pow(10.0, 3.3 * random.uniform()));
    const Sampling at{
        .start = 0.0, .interval = std::pow(10.0, -7.0 + 4.0 * random.uniform()), .samples = n};
    const std::vector<double> values = garbage(n, random);
    DetectionOptions options;
    if (random.uniform() < 0.3) options.threshold = random.uniform();
    if (random.uniform() < 0.3) options.pre_trigger = 0.0;
    if (random.uniform() < 0.3) options.post_trigger = 10.0 * at.interval * random.uniform();
    for (const Record& record : {record_of({force_of(at, values), velocity_of(at, values)}),
                                 record_of({velocity_of(at, values)})}) {
      double before = -INFINITY;
      for (const Impact& impact : find_impacts(record, options)) {
        EXPECT_GE(impact.start, before);
        before = impact.start;
        EXPECT_GE(impact.end, impact.start);
        EXPECT_GE(impact.width, 0.0);
        for (const double figure : {impact.start, impact.end, impact.peak, impact.width,
                                    impact.impulse, impact.approach_velocity})
          EXPECT_TRUE(std::isfinite(figure));
        if (!impact.velocity) continue;  // the window was too short for a sample
        EXPECT_GE(impact.velocity->noise, 0.0);
        EXPECT_GE(impact.velocity->noise_correlation, 1.0);
      }
    }
  }
}

TEST(FindImpacts, EndsWithinTheRecord) {
  std::vector<double> force(200, 0.0);
  for (std::size_t i = 100; i < 199; ++i) force[i] = 1000.0 + static_cast<double>(i % 2);
  force[197] = 1100.0;  // the line through the last two samples above points beyond the record
  const Sampling at{.start = 0.0, .interval = 1e-6, .samples = force.size()};
  const auto impacts = find_impacts(record_of({force_of(at, force)}));
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_LE(impacts[0].end, at.time(199));
}

}  // namespace

}  // namespace impactrig::acquisition
