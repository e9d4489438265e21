// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/dropouts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::RepairDropouts;
using namespace tests;

/// 0.44 m/s, thrown back to -0.2 m/s by a half-sine force of 200 us, then a vibration at 3 kHz.
double swing(double t) {
  const double done = std::clamp(t / 200e-6, 0.0, 1.0);
  const double turn = 0.5 * (1.0 - std::cos(std::numbers::pi * done));
  const double ringing =
      t > 200e-6 ? 0.05 * std::sin(2.0 * std::numbers::pi * 3e3 * (t - 200e-6)) : 0.0;
  return 0.44 + 9.81 * 0.01 * t - 0.64 * turn + ringing;
}

/// A laser's loss as measurement-chain.md describes it: towards zero, with a spike at each edge.
void lose(std::vector<double>& y, std::size_t begin, std::size_t end, double spike) {
  for (std::size_t i = begin; i < end; ++i) y[i] *= 0.02;
  y[begin] += spike;
  y[end - 1] -= spike;
}

TEST(RepairDropouts, FindsEveryLossAndBridgesIt) {
  const Sampling at;
  const double noise = 1.25e-3;
  for (const std::size_t length : {std::size_t{20}, std::size_t{60}, std::size_t{200}})
    for (const double time : {-0.7e-3, -0.3e-3, 0.6e-3, 2.0e-3})
      for (const double spike : {0.0, 0.5, 2.0}) {
        const std::vector<double> truth = sampled(at, swing);
        std::vector<double> y = truth;
        add_noise(y, noise, 7);
        const auto begin = static_cast<std::size_t>((time - at.start) / at.interval);
        lose(y, begin, begin + length, spike);
        auto velocity = velocity_of(at, y);
        const auto edit = repair_dropouts(velocity, {});
        SCOPED_TRACE(testing::Message() << length << " samples at " << time << ", spike " << spike);
        EXPECT_EQ(edit.parameters.at("found"), "1");
        ASSERT_EQ(velocity.valid.size(), at.samples);
        std::size_t marked = 0;
        for (std::size_t i = 0; i < at.samples; ++i) {
          const bool lost = i >= begin && i < begin + length;
          // The edges may take a sample or two of their neighbours along.
          if (lost) {
            ASSERT_EQ(velocity.valid[i], 0) << i;
          }
          if (i + 3 < begin || i > begin + length + 3) {
            ASSERT_EQ(velocity.valid[i], 1) << i;
          }
          marked += velocity.valid[i] == 0;
          if (lost) {
            // Over 200 us a vibration of 3 kHz and 0.05 m/s cannot be known from outside.
            const double known = time < 0.0 ? 6.0 * noise : 0.12;
            ASSERT_NEAR(velocity.value(i), truth[i], known) << i;
          } else if (velocity.valid[i] == 1) {
            ASSERT_EQ(velocity.value(i), y[i]) << i;
          }
        }
        EXPECT_LE(marked, length + 6);
      }
}

TEST(RepairDropouts, FindsSpikes) {
  const Sampling at;
  std::vector<double> y = sampled(at, swing);
  add_noise(y, 1.25e-3, 9);
  for (const std::size_t i : {std::size_t{300}, std::size_t{1100}, std::size_t{2500}}) y[i] += 0.3;
  y[3000] -= 0.4;
  y[3001] -= 0.3;
  auto velocity = velocity_of(at, y);
  EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "4");
  for (const std::size_t i :
       {std::size_t{300}, std::size_t{1100}, std::size_t{2500}, std::size_t{3000}})
    EXPECT_EQ(velocity.valid[i], 0) << i;
  EXPECT_EQ(velocity.valid[3001], 0);
  EXPECT_LE(std::ranges::count(velocity.valid, 0), 4 * 5 + 1);
}

// Where it must not act: the impact itself, at every sample rate and noise.
// What a decoder gives out without light is noise as often as zero, at any sample rate.
TEST(RepairDropouts, FindsBurstsOfNoise) {
  for (const double rate : {0.5e6, 2e6, 5e6}) {
    const Sampling at{-1e-3, 1.0 / rate, static_cast<std::size_t>(4e-3 * rate)};
    const auto length = static_cast<std::size_t>(250e-6 * rate);
    const auto begin = static_cast<std::size_t>(1.8e-3 * rate);
    std::vector<double> y = sampled(at, swing), burst(length);
    add_noise(y, 1.25e-3, 7);
    add_noise(burst, 0.5, 8);
    for (std::size_t i = 0; i < length; ++i) y[begin + i] += burst[i];
    auto velocity = velocity_of(at, y);
    const auto edit = repair_dropouts(velocity, {});
    SCOPED_TRACE(rate);
    EXPECT_EQ(edit.parameters.at("found"), "1");
    ASSERT_EQ(velocity.valid.size(), at.samples);
    for (std::size_t i = 0; i < at.samples; ++i) {
      if (i < begin + length && i >= begin + 3 && i + 3 < begin + length) {
        ASSERT_EQ(velocity.valid[i], 0) << i;
      }
      if (i + 3 < begin || i > begin + length + 3) {
        ASSERT_EQ(velocity.valid[i], 1) << i;
      }
    }
  }
}

TEST(RepairDropouts, TakesNoImpactForALoss) {
  for (const double interval : {1e-7, 1e-6, 5e-6, 20e-6, 50e-6, 100e-6, 500e-6})
    for (const double noise : {0.0, 1e-6, 1e-4, 1.25e-3, 5e-3, 20e-3})
      for (int seed = 1; seed <= 4; ++seed) {
        const Sampling at{.start = -200.0 * interval,
                          .interval = interval,
                          .samples = interval < 5e-7 ? 40000U : 4000U};
        std::vector<double> y = sampled(at, swing);
        add_noise(y, noise, static_cast<std::uint64_t>(seed));
        auto velocity = velocity_of(at, y);
        EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "0")
            << interval << " s, noise " << noise;
        EXPECT_TRUE(velocity.valid.empty());
        EXPECT_EQ(velocity.values(), y);
      }
}

// Within the contact the velocity itself changes by as much: there zero tells.
TEST(RepairDropouts, FindsAZeroWithinTheContact) {
  const Sampling at;
  for (const auto& [from, to] : {std::pair{20, 60}, {60, 110}, {140, 165}, {90, 180}, {150, 260}})
    for (int seed = 1; seed <= 5; ++seed) {
      const std::vector<double> truth = sampled(at, swing);
      std::vector<double> y = truth;
      const auto begin = static_cast<std::size_t>(1000 + from);
      const auto end = static_cast<std::size_t>(1000 + to);
      for (std::size_t i = begin; i < end; ++i) y[i] = 0.0;
      add_noise(y, 1.25e-3, static_cast<std::uint64_t>(seed));
      auto velocity = velocity_of(at, y);
      SCOPED_TRACE(testing::Message() << from << " to " << to << " us, seed " << seed);
      EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "1");
      ASSERT_EQ(velocity.valid.size(), at.samples);
      for (std::size_t i = begin; i < end; ++i) {
        // What happens to lie on its course within a tenth of what is off may stay at the ends.
        if (std::abs(truth[i]) > 0.05) {
          ASSERT_EQ(velocity.valid[i], 0) << i;
        }
      }
      EXPECT_LE(std::ranges::count(velocity.valid, 0), to - from + 6);
    }
}

// As the synthetic source and measurement-chain.md have it: 2 % of the speed, noisier by five
// times, a spike at either edge. Some of them end where the bar itself is at zero.
TEST(RepairDropouts, FindsANoisyLossWithinTheContact) {
  const Sampling at;
  const double noise = 1.25e-3;
  for (const auto& [from, to] : {std::pair{10, 60}, {20, 125}, {60, 180}, {122, 200}, {5, 190}})
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const std::vector<double> truth = sampled(at, swing);
      std::vector<double> y = truth, decoder(at.samples, 0.0);
      add_noise(y, noise, seed);
      add_noise(decoder, 5.0 * noise, 100 + seed);
      const auto begin = static_cast<std::size_t>(1000 + from);
      const auto end = static_cast<std::size_t>(1000 + to);
      for (std::size_t i = begin; i < end; ++i) y[i] = 0.02 * y[i] + decoder[i];
      y[begin] += 0.5;
      y[end - 1] -= 0.5;
      auto velocity = velocity_of(at, y);
      SCOPED_TRACE(testing::Message() << from << " to " << to << " us, seed " << seed);
      EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "1");
      ASSERT_EQ(velocity.valid.size(), at.samples);
      for (std::size_t i = begin; i < end; ++i) ASSERT_EQ(velocity.valid[i], 0) << i;
      EXPECT_LE(std::ranges::count(velocity.valid, 0), to - from + 6);
    }
}

// A laser that is lost at the end of its range, level, for longer than a spike; in flight and
// within the contact.
TEST(RepairDropouts, FindsALossAtTheEndOfTheRange) {
  const Sampling at;
  for (const std::size_t length : {20U, 40U, 120U, 250U})
    for (const std::size_t begin : {500U, 1060U, 1500U})
      for (const double level : {1.25, -1.25}) {
        if (begin == 1060U && length > 40U) continue;
        std::vector<double> y = sampled(at, swing);
        add_noise(y, 1.25e-3, 4);
        for (std::size_t i = begin; i < begin + length; ++i) y[i] = level;
        auto velocity = velocity_of(at, y);
        SCOPED_TRACE(testing::Message() << length << " samples of " << level << " at " << begin);
        EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "1");
        ASSERT_EQ(velocity.valid.size(), at.samples);
        for (std::size_t i = begin; i < begin + length; ++i) ASSERT_EQ(velocity.valid[i], 0) << i;
        EXPECT_LE(std::ranges::count(velocity.valid, 0), static_cast<long>(length) + 6);
      }
}

// Several of them, and a stray sample there.
TEST(RepairDropouts, FindsEachLossAtTheEndOfTheRange) {
  const Sampling at;
  std::vector<double> y = sampled(at, swing);
  add_noise(y, 1.25e-3, 4);
  for (const std::size_t begin : {400U, 1700U, 2600U})
    for (std::size_t i = begin; i < begin + 45; ++i) y[i] = 1.25;
  y[3300] = 1.25;
  auto velocity = velocity_of(at, y);
  EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "4");
  ASSERT_EQ(velocity.valid.size(), at.samples);
  for (const std::size_t begin : {400U, 1700U, 2600U})
    for (std::size_t i = begin; i < begin + 45; ++i) ASSERT_EQ(velocity.valid[i], 0) << i;
}

// What lies between is further from zero than what is to either side, so it is no loss.
TEST(RepairDropouts, TellsTwoLossesThatFollowEachOther) {
  const Sampling at;
  for (const std::size_t gap : {std::size_t{40}, std::size_t{100}, std::size_t{170}})
    for (const std::size_t first : {std::size_t{300}, std::size_t{1300}, std::size_t{2000}}) {
      constexpr std::size_t length = 110;
      std::vector<double> y = sampled(at, swing);
      add_noise(y, 1.25e-3, 11);
      const std::size_t second = first + length + gap;
      lose(y, first, first + length, 0.5);
      lose(y, second, second + length, -0.7);
      auto velocity = velocity_of(at, y);
      SCOPED_TRACE(testing::Message() << gap << " samples between, from " << first);
      EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "2");
      ASSERT_EQ(velocity.valid.size(), at.samples);
      for (std::size_t i = 0; i < length; ++i) {
        ASSERT_EQ(velocity.valid[first + i], 0) << i;
        ASSERT_EQ(velocity.valid[second + i], 0) << i;
      }
      for (std::size_t i = first + length + 3; i + 3 < second; ++i)
        ASSERT_EQ(velocity.valid[i], 1) << i;
    }
}

/// A bar that comes to rest, and is hit or bounces on after `rest` [s].
double stopped(double t, double rest) {
  if (t < 200e-6)
    return 0.44 *
           (1.0 - 0.5 * (1.0 - std::cos(std::numbers::pi * std::clamp(t / 200e-6, 0.0, 1.0))));
  if (t < 200e-6 + rest) return 0.0;
  return -0.1 * (1.0 - std::exp(-(t - 200e-6 - rest) / 60e-6));
}

// Where it must not act: a bar at rest is no dropout, at any rate and for any time.
// The last value stands until there is light again: of 60 such losses within a contact, of up to
// 0.2 m/s, none was found.
TEST(RepairDropouts, FindsAValueThatIsHeld) {
  const Sampling at;
  for (const std::uint64_t seed : {1U, 2U, 3U})
    for (const std::size_t length : {std::size_t{20}, std::size_t{60}}) {
      std::vector<double> y = sampled(at, swing);
      add_noise(y, 1.5e-3, seed);
      const auto begin = static_cast<std::size_t>((60e-6 - at.start) / at.interval);
      for (std::size_t i = begin + 1; i < begin + length; ++i) y[i] = y[begin];
      auto velocity = velocity_of(at, y);
      EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "1");
      for (std::size_t i = 0; i < at.samples; ++i)
        ASSERT_EQ(velocity.valid.at(i) == 0, i > begin && i < begin + length) << i;
    }
}

// A recorder that shows each value twelve times, and one of steps so coarse that a bar at rest is
// between two of them.
TEST(RepairDropouts, TakesNoRepeatedValuesForALoss) {
  const Sampling at;
  std::vector<double> y = sampled(at, swing);
  add_noise(y, 1.5e-3, 4);
  std::vector<double> coarse = y;
  for (std::size_t i = 0; i < at.samples; ++i) y[i] = y[i - i % 12];
  auto repeated = velocity_of(at, y);
  EXPECT_EQ(repair_dropouts(repeated, {}).parameters.at("found"), "0");
  for (double& value : coarse) value = 0.02 * std::round(value / 0.02);
  auto stepped = velocity_of(at, coarse);
  EXPECT_EQ(repair_dropouts(stepped, {}).parameters.at("found"), "0");
}

TEST(RepairDropouts, TakesNoBarAtRestForALoss) {
  for (const double interval : {1e-6, 5e-6, 10e-6, 20e-6, 50e-6})
    for (const double rest : {30e-6, 100e-6, 250e-6, 1e-3, 1.0})
      for (const double noise : {0.0, 1e-4, 1.25e-3, 5e-3}) {
        const Sampling at{.start = -200.0 * interval, .interval = interval, .samples = 4000};
        std::vector<double> y = sampled(at, [&](double t) { return stopped(t, rest); });
        add_noise(y, noise, 3);
        auto velocity = velocity_of(at, y);
        EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "0")
            << interval << " s, at rest for " << rest << " s, noise " << noise;
      }
}

// Steps of a counter, and a decoder whose level changes for good.
TEST(RepairDropouts, TakesNoStepForALoss) {
  const Sampling at;
  std::vector<double> counter = sampled(at, [](double t) { return 0.44 * t; });
  round_to(counter, 1.3e-6);
  auto displacement = channel_of("x", datasets::Quantity::displacement, at, counter);
  EXPECT_EQ(repair_dropouts(displacement, {}).parameters.at("found"), "0");

  std::vector<double> y = sampled(at, swing);
  add_noise(y, 1.25e-3, 2);
  for (std::size_t i = 2200; i < y.size(); ++i) y[i] += 0.7;
  auto velocity = velocity_of(at, y);
  EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "0");
}

TEST(RepairDropouts, LeavesLossesThatAreLongerThanAskedFor) {
  const Sampling at;
  std::vector<double> y = sampled(at, swing);
  add_noise(y, 1.25e-3, 3);
  lose(y, 2500, 2700, 0.0);
  auto velocity = velocity_of(at, y);
  EXPECT_EQ(repair_dropouts(velocity, {100e-6}).parameters.at("found"), "0");
  EXPECT_EQ(repair_dropouts(velocity, {210e-6}).parameters.at("found"), "1");
}

TEST(RepairDropouts, AreForLasersOnly) {
  const Sampling at;
  auto force = force_of(at, std::vector<double>(at.samples, 0.0));
  try {
    repair_dropouts(force, {});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "channel 'Force' is a force, in which an impact itself is a spike; dropouts are "
                 "repaired in velocity and displacement");
  }
  auto velocity = velocity_of(at, std::vector<double>(at.samples, 0.0));
  EXPECT_THROW(repair_dropouts(velocity, {0.0}), std::invalid_argument);
  EXPECT_EQ(repair_dropouts(velocity, {}).parameters.at("found"), "0");
}

}  // namespace

}  // namespace impactrig::acquisition
