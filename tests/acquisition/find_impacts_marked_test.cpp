// SPDX-License-Identifier: BSD-3-Clause
// Samples that are not valid are bridged by lines, which are no noise and no level.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "tests/acquisition/half_sine_contact.hpp"
#include "tests/acquisition/marked_samples.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Channel;
using datasets::Impact;
using datasets::ImpactFlag;
using namespace tests;

constexpr Sampling at;  // from -1 ms, 1 MHz, 4 ms
constexpr std::size_t before_touch = 950;
constexpr double force_noise = 2.0, velocity_noise = 2e-3;
constexpr int records = 100;

/// A force of 1500 N on a level and its velocity, in white noise.
struct Shot {
  Channel force, velocity;
  double level = 0.0;

  explicit Shot(Noise& noise, double step = 0.0) : level(20.0 * noise.uniform()) {
    auto newtons = sampled(at, [&](double t) { return level + pulse(t) * pulse(t) / 1500.0; });
    for (double& value : newtons) value += force_noise * noise();
    auto metres = sampled(at, [](double t) {  // as the integral of the force has it
      const double part = std::clamp(t / duration, 0.0, 1.0);
      return 0.5 - 0.8 * (part - std::sin(2.0 * pi * part) / (2.0 * pi));
    });
    for (double& value : metres) value += velocity_noise * noise();
    if (step > 0.0) round_to(newtons, step), round_to(metres, 1e-3 * step);
    force = force_of(at, std::move(newtons));
    velocity = velocity_of(at, std::move(metres));
  }

  void mark(double part, Noise& noise) {
    mark_stretches(force, part, 0, before_touch, noise);
    mark_stretches(velocity, part, 0, before_touch, noise);
  }
};

// Of the 475 samples that tell about 285 count: means are known to 1/√285 of the noise, noise to
// 1/√570 of itself. Means over lines too were off by 2.7 times as much; noise was 10 % less and
// hung together over 7 samples.
TEST(FindImpacts, KnowsNoiseAndLevelsByWhatIsValid) {
  double noise_sum = 0.0, correlation = 0.0, level = 0.0, approach = 0.0;
  for (int seed = 1; seed <= records; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    Shot shot(noise);
    shot.mark(0.4, noise);
    const auto impacts = find_impacts(record_of({shot.force, shot.velocity}));
    ASSERT_EQ(impacts.size(), 1u) << seed;
    const Impact& impact = impacts.front();
    noise_sum += impact.force->noise / force_noise + impact.velocity->noise / velocity_noise;
    correlation += impact.force->noise_correlation + impact.velocity->noise_correlation;
    level += std::pow(impact.force->baseline - shot.level, 2);
    approach += std::pow(impact.approach_velocity - 0.5, 2);
  }
  EXPECT_NEAR(noise_sum / (2.0 * records), 1.0, 0.02);
  EXPECT_LT(correlation / (2.0 * records), 1.5);
  EXPECT_LT(std::sqrt(approach / records), 1.3 * velocity_noise / std::sqrt(285.0));
  EXPECT_LT(std::sqrt(level / records), 1.6 * force_noise / std::sqrt(285.0));  // some are lines
}

// Of 6 N: what bridges the gaps lies beside its grid. Levels were off by 1.5 N.
TEST(FindImpacts, SeesTheStepsOfADigitiserBesideGaps) {
  double level = 0.0, start = 0.0;
  for (int seed = 1; seed <= records; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    Shot shot(noise, 6.0);
    shot.mark(0.05, noise);
    const auto impacts = find_impacts(record_of({shot.force}));
    ASSERT_EQ(impacts.size(), 1u) << seed;
    level += std::pow(impacts.front().force->baseline - shot.level, 2);
    const auto jumps = find_impacts(record_of({shot.velocity}));
    ASSERT_EQ(jumps.size(), 1u) << seed;
    start += std::pow(jumps.front().start, 2);
  }
  EXPECT_LT(std::sqrt(level / records), 0.4);
  EXPECT_LT(std::sqrt(start / records), 40e-6);  // without marks 21 us, before 97 us
}

// A recorder that marks what is beyond its range marks nothing lower. Of 100 shots with a fifth of
// all samples marked 36 have the highest one among these.
TEST(ClippedFlag, IsSilentOnMarksThatHaveNothingToDoWithTheRange) {
  int clipped = 0;
  for (int seed = 1; seed <= records; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    Shot shot(noise);
    mark_single(shot.force, 0.2, 0, at.samples, noise);
    const auto impacts = find_impacts(record_of({shot.force}));
    ASSERT_EQ(impacts.size(), 1u) << seed;
    clipped += impacts.front().has(ImpactFlag::clipped);
    EXPECT_TRUE(impacts.front().has(ImpactFlag::dropout)) << seed;
  }
  EXPECT_EQ(clipped, 0);
}

// Marked stretches of 10 to 60 samples somewhere over the crest, as it was recorded. Those that end
// equally high on both flanks, but for noise, are what a recorder with room above its range marks.
TEST(ClippedFlag, IsSilentOnMostMarksOverACrest) {
  int clipped = 0;
  for (int seed = 1; seed <= records; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    Shot shot(noise);
    const double length = 10.0 + 50.0 * noise.uniform();
    const auto begin = static_cast<std::size_t>(1100.0 - length * noise.uniform());
    shot.force.valid.assign(at.samples, 1);
    std::fill_n(shot.force.valid.begin() + static_cast<std::ptrdiff_t>(begin),
                static_cast<std::size_t>(length), std::uint8_t{0});
    clipped += find_impacts(record_of({shot.force})).at(0).has(ImpactFlag::clipped);
  }
  EXPECT_LE(clipped, 15);
}

// A recorder that marks all above 1200 N, with room beyond, and one whose amplifier ends there.
TEST(ClippedFlag, FiresWhereNoisyTopsAreMarked) {
  for (const bool room : {true, false})
    for (int seed = 1; seed <= records; ++seed) {
      Noise noise(static_cast<std::uint64_t>(seed));
      const auto truth = sampled(at, [](double t) { return pulse(t) * pulse(t) / 1500.0; });
      auto newtons = truth;
      for (double& value : newtons) value = std::min(value, room ? 9e9 : 1200.0) + 2.0 * noise();
      Channel force = force_of(at, std::move(newtons));
      for (const double value : truth) force.valid.push_back(value > 1200.0 ? 0 : 1);
      EXPECT_TRUE(find_impacts(record_of({force})).at(0).has(ImpactFlag::clipped))
          << room << " " << seed;
    }
}

}  // namespace

}  // namespace impactrig::acquisition
