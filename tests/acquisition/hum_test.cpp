// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/hum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>

#include "tests/acquisition/marked_samples.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Channel;
using datasets::RemoveHum;
using datasets::TimeSpan;
using namespace tests;

constexpr double pi = std::numbers::pi;

/// 0.5 s before the trigger at 20 kHz, 0.2 s after it.
constexpr Sampling long_record{.start = -0.5, .interval = 50e-6, .samples = 14000};

double hum_at(double t, double frequency) {
  return 3.0 * std::sin(2.0 * pi * frequency * t + 0.7) +
         0.9 * std::cos(2.0 * pi * 3.0 * frequency * t - 0.2);
}

double pulse_at(double t) {
  return half_sine(t, 1500.0, 2e-3);
}

double largest_error(const Channel& channel, const std::vector<double>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    largest = std::max(largest, std::abs(channel.value(i) - truth[i]));
  return largest;
}

TEST(RemoveHum, FindsFrequencyAmplitudesAndPhases) {
  for (const double frequency : {50.0, 49.93, 60.0 * 0.9995}) {
    const auto truth = sampled(long_record, pulse_at);
    auto force = force_of(long_record, sampled(long_record, [&](double t) {
                            return pulse_at(t) + hum_at(t, frequency);
                          }));
    const RemoveHum hum{frequency > 55.0 ? 60.0 : 50.0, 5, {TimeSpan{-0.5, -1e-3}}};
    const auto edit = remove_hum(force, hum);
    EXPECT_LT(largest_error(force, truth), 2e-3) << frequency;  // of 3.9
    EXPECT_NEAR(std::stod(edit.parameters.at("frequency")), frequency, 1e-3);
  }
}

// Of a period or more: which of the two it is tells what is left over.
TEST(RemoveHum, FindsWhichMainsThereAreWhereNoneAreStated) {
  for (const double frequency : {50.0, 60.0})
    for (const double quiet : {0.02, 0.03, 0.05, 0.1, 0.4}) {
      SCOPED_TRACE(quiet);
      const Sampling at{.start = -quiet,
                        .interval = 50e-6,
                        .samples = static_cast<std::size_t>(20e3 * (quiet + 0.02))};
      auto values = sampled(at, [&](double t) { return pulse_at(t) + hum_at(t, frequency); });
      add_noise(values, 0.02, 3);
      Channel force = force_of(at, values);
      const auto edit = remove_hum(force, RemoveHum{.quiet = {TimeSpan{-quiet, -1e-3}}});
      EXPECT_NEAR(std::stod(edit.parameters.at("frequency")), frequency, 0.1);
      EXPECT_LT(largest_error(force, sampled(at, pulse_at)), 0.3);  // of 3.9
    }
}

TEST(RemoveHum, SaysWhereItIsAsLikelyOfTheOtherMains) {
  const Sampling at{.start = -0.02, .interval = 50e-6, .samples = 800};
  auto values =
      sampled(at, [](double t) { return pulse_at(t) + 3.0 * std::sin(2.0 * pi * 60.0 * t + 1.0); });
  add_noise(values, 0.3, 3);
  Channel force = force_of(at, values);
  const auto edit = remove_hum(force, RemoveHum{.quiet = {TimeSpan{-0.02, -1e-3}}});
  EXPECT_TRUE(edit.parameters.at("frequency").ends_with("of 50 and 60 Hz as likely as the other"));
}

/// 40 s before the trigger and 0.5 s after it.
constexpr Sampling very_long_record{.start = -40.0, .interval = 500e-6, .samples = 81000};

// Without noise nothing but rounding is left: 1e-9 of a turn over the quiet time.
TEST(RemoveHum, FindsALongHumToRounding) {
  for (const double frequency : {49.0312345678, 50.0, 50.0123456789, 50.9712345678}) {
    const auto truth =
        sampled(very_long_record, [](double t) { return half_sine(t, 1500.0, 0.2); });
    auto force = force_of(very_long_record, sampled(very_long_record, [&](double t) {
                            return half_sine(t, 1500.0, 0.2) + hum_at(t, frequency);
                          }));
    remove_hum(force, {50.0, 3, {TimeSpan{-40.0, -1e-3}}});
    EXPECT_LT(largest_error(force, truth), 1e-7) << frequency;  // of 3.9
  }
}

// Of two stretches apart the spectrum has side peaks 1/30 Hz apart, nearly as high as its peak; a
// hum half as strong is not far.
TEST(RemoveHum, FindsALongHumInStretchesApart) {
  const auto level = [](double t) { return t < -20.0 ? 5.0 + 0.3 * t : -7.0 + 0.1 * t; };
  for (int seed = 1; seed <= 20; ++seed) {
    auto values = sampled(very_long_record, [&](double t) {
      return level(t) + hum_at(t, 50.2468) + 1.2 * std::sin(2.0 * pi * 49.37 * t);
    });
    add_noise(values, 1.0, static_cast<std::uint64_t>(seed));
    auto force = force_of(very_long_record, values);
    const auto edit = remove_hum(force, {50.0, 3, {TimeSpan{-40.0, -37.0}, TimeSpan{-8.0, -5.0}}});
    EXPECT_NEAR(std::stod(edit.parameters.at("frequency")), 50.2468, 2e-3) << seed;
  }
}

// The stated error covers what is left: hum known to s over a long quiet time.
TEST(RemoveHum, StatesItsErrorHonestly) {
  int within = 0;
  constexpr int trials = 60;
  for (int seed = 1; seed <= trials; ++seed) {
    std::vector<double> noise(long_record.samples, 0.0);
    add_noise(noise, 2.0, static_cast<std::uint64_t>(seed));
    auto force = force_of(long_record, noise);
    auto& samples = std::get<std::vector<double>>(force.raw);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] += hum_at(long_record.time(i), 50.02);
    const auto edit = remove_hum(force, {50.0, 3, {TimeSpan{-0.5, -1e-3}}});
    const double stated = std::stod(edit.parameters.at("uncertainty"));
    const double left = largest_error(force, noise);
    if (left < 3.0 * stated) ++within;
    EXPECT_LT(stated, 0.5) << seed;
  }
  EXPECT_GE(within, trials - 3);
}

// Three periods do not tell the frequency, and no grid keeps to the stated one: in 60 records with
// mains of 50 Hz +- 50 mHz the hum under the contact lies within 1.96 stated errors of what is
// taken off as often as a normal error does, here at least 51 times (less: 0.1 %). Of errors that
// hold for 50 Hz alone 19 did.
TEST(RemoveHum, KnowsThatMainsAreNotQuiteAsStated) {
  const Sampling at_three{.start = -0.06, .interval = 1e-5, .samples = 9000};
  int within = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Noise noise(seed);
    const double frequency = 50.0 + 0.05 * noise();
    auto values = sampled(at_three, [&](double t) {
      return pulse_at(t) + 3.0 * std::sin(2.0 * pi * frequency * t + static_cast<double>(seed));
    });
    add_noise(values, 0.1, seed + 100);
    auto force = force_of(at_three, values);
    const auto edit = remove_hum(force, {50.0, 1, {TimeSpan{-0.06, -1e-3}}});
    const double truth =
        3.0 * std::sin(2.0 * pi * frequency * at_three.time(6100) + static_cast<double>(seed));
    const double error = values[6100] - force.value(6100) - truth;
    within += std::abs(error) < 1.96 * std::stod(edit.parameters.at("uncertainty"));
  }
  EXPECT_GE(within, 51);
}

/// Some periods of the mains before touch at 20 kHz, in noise x_t = memory x_{t-1} + e_t of 1 N.
struct ShortRecord {
  double periods = 1.0, memory = 0.0;

  double lead() const { return 0.02 * periods + 1e-3; }

  Sampling at() const {
    return {-lead(), 50e-6, static_cast<std::size_t>(std::lround((lead() + 0.01) / 50e-6))};
  }

  Channel with_hum(double amplitude, double frequency, Noise& noise) const {
    const double phase = 2.0 * pi * noise.uniform();
    auto values = sampled(at(), [&](double t) {
      return pulse_at(t) + amplitude * std::sin(2.0 * pi * frequency * t + phase);
    });
    double last = noise();
    for (double& value : values) {
      value += last;
      last = memory * last + std::sqrt(1.0 - memory * memory) * noise();
    }
    return force_of(at(), values);
  }
};

// As often as a normal error does, less what a binomial law leaves of 200 with 1e-4, the amplitude
// lies within 1.96 stated errors. Sinusoids and a line through a record of some ten correlation
// times take slow noise with them: of the residuals' own 155 to 178 held in noise of 0.9.
TEST(RemoveHum, StatesItsErrorHonestlyInColouredNoise) {
  constexpr int trials = 200;
  for (const double periods : {1.5, 3.0, 10.0})
    for (const double memory : {0.0, 0.6, 0.9}) {
      int within = 0;
      for (std::uint64_t seed = 1; seed <= trials; ++seed) {
        Noise noise(seed);
        const ShortRecord record{periods, memory};
        auto force = record.with_hum(6.0, 50.0, noise);
        const auto edit = remove_hum(force, {50.0, 3, {TimeSpan{-record.lead(), -1e-3}}});
        const std::string text = edit.parameters.at("amplitude 1");
        const std::string before = "uncertain by ";
        const double stated = std::stod(text.substr(text.find(before) + before.size()));
        within += std::abs(std::stod(text) - 6.0) < 1.96 * stated;
      }
      EXPECT_GE(within, 177) << periods << " " << memory;
    }
}

// Of 200 records of one period in noise of 0.9 without hum 50 had some.
TEST(RemoveHum, FindsHardlyAnyInColouredNoise) {
  for (const double periods : {1.0, 1.5})
    for (const double memory : {0.6, 0.9}) {
      int found = 0;
      for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        Noise noise(seed);
        const ShortRecord record{periods, memory};
        auto force = record.with_hum(0.0, 50.0, noise);
        const auto edit = remove_hum(force, {50.0, 3, {TimeSpan{-record.lead(), -1e-3}}});
        found += !edit.parameters.contains("found");
      }
      EXPECT_LE(found, 10) << periods << " " << memory;
    }
}

// What hum is told by does not depend on where the clock has its zero: over less than two periods a
// line is nearer to a sine than to a cosine.
TEST(RemoveHum, FindsTheSameWhereverTheClockBegins) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const ShortRecord record{1.0, 0.0};
    int found = 0;
    for (int k = 0; k < 8; ++k) {
      Noise noise(seed);
      auto force = record.with_hum(0.5, 50.0, noise);
      const double later = k * 0.0025;
      force.clock.start += later;
      const auto edit =
          remove_hum(force, {50.0, 1, {TimeSpan{later - record.lead(), later - 1e-3}}});
      found += !edit.parameters.contains("found");
    }
    EXPECT_TRUE(found == 0 || found == 8) << seed << " " << found;
  }
}

// Five in a hundred samples are marked: means of those between weigh by how many they are. All
// weighed alike, amplitudes were off by 1.4 times as much.
TEST(RemoveHum, WeighsWhatLiesBetweenMarksByItsSamples) {
  const Sampling at_three{.start = -0.06, .interval = 1e-5, .samples = 7000};
  const auto error_with = [&](double part) {
    double squares = 0.0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      Noise noise(seed);
      auto values =
          sampled(at_three, [](double t) { return 3.0 * std::sin(2.0 * pi * 50.0 * t + 1.0); });
      for (double& value : values) value += 2.0 * noise();
      auto force = force_of(at_three, values);
      mark_single(force, part, 0, 5900, noise);
      const auto edit = remove_hum(force, {50.0, 1, {TimeSpan{-0.06, -1e-3}}});
      squares += std::pow(std::stod(edit.parameters.at("amplitude 1")) - 3.0, 2) / 200.0;
    }
    return std::sqrt(squares);
  };
  EXPECT_LT(error_with(0.05), 1.15 * error_with(0.0));
}

TEST(RemoveHum, TakesNothingOffWhereThereIsNone) {
  std::vector<double> noise(long_record.samples, 0.0);
  add_noise(noise, 2.0, 5);
  auto force = force_of(long_record, noise);
  const auto edit = remove_hum(force, {50.0, 5, {TimeSpan{-0.5, -1e-3}}});
  EXPECT_EQ(force.values(), noise);
  EXPECT_EQ(edit.parameters.at("found"), "nothing above the noise, so nothing was taken off");
}

TEST(RemoveHum, UsesSeveralQuietStretchesOfDifferentLevels) {
  auto force = force_of(long_record, sampled(long_record, [](double t) {
                          return pulse_at(t) + hum_at(t, 50.0) + (t > 1e-3 ? 25.0 : 0.0);
                        }));
  remove_hum(force, {50.0, 3, {TimeSpan{-0.5, -1e-3}, TimeSpan{5e-3, 0.2}}});
  for (std::size_t i = 0; i < long_record.samples; ++i) {
    const double t = long_record.time(i);
    ASSERT_NEAR(force.value(i), pulse_at(t) + (t > 1e-3 ? 25.0 : 0.0), 2e-3) << t;
  }
}

// Hum and drift are the same there, and multiples took the place of the mains: what came off half a
// period of 4 N was off by 6.6 N where 0.3 N was stated.
TEST(RemoveHum, RefusesAStretchTooShortToTell) {
  for (const double quiet : {0.5e-3, 9.7e-3, 13e-3}) {
    const Sampling at{.start = -quiet, .interval = 1e-6, .samples = 25000};
    std::vector<double> values =
        sampled(at, [](double t) { return pulse_at(t) + hum_at(t, 50.0); });
    add_noise(values, 0.1, 2);
    auto force = force_of(at, values);
    try {
      remove_hum(force, {50.0, 5, {TimeSpan{-quiet, -10e-6}}});
      ADD_FAILURE() << quiet;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("of a period of the mains, which does not tell"),
                std::string::npos);
    }
  }
}

TEST(RemoveHum, IgnoresInvalidSamples) {
  const auto truth = sampled(long_record, pulse_at);
  auto force = force_of(
      long_record, sampled(long_record, [](double t) { return pulse_at(t) + hum_at(t, 50.0); }));
  force.valid.assign(long_record.samples, 1);
  auto& samples = std::get<std::vector<double>>(force.raw);
  for (std::size_t i = 1000; i < 1200; ++i) {
    samples[i] = -400.0;
    force.valid[i] = 0;
  }
  remove_hum(force, {50.0, 3, {TimeSpan{-0.5, -1e-3}}});
  EXPECT_EQ(force.value(1100), -400.0);
  for (std::size_t i = 1200; i < long_record.samples; ++i)
    ASSERT_NEAR(force.value(i), truth[i], 2e-3);
}

TEST(RemoveHum, MarksWhatWasNotFinite) {
  auto values = sampled(long_record, [](double t) { return pulse_at(t) + hum_at(t, 50.0); });
  values[1000] = values[12000] = NAN;
  auto force = force_of(long_record, values);
  remove_hum(force, {50.0, 3, {TimeSpan{-0.5, -1e-3}}});
  for (std::size_t i = 0; i < long_record.samples; ++i)
    ASSERT_EQ(force.is_valid(i), i != 1000 && i != 12000) << i;
}

TEST(RemoveHum, FindsNoneInAConstant) {
  for (const double level : {0.0, 2.5}) {
    auto force = force_of(long_record, std::vector<double>(long_record.samples, level));
    const auto edit = remove_hum(force, {50.0, 2, {TimeSpan{-0.5, -1e-3}}});
    EXPECT_TRUE(edit.parameters.contains("found")) << level;
    EXPECT_FALSE(edit.parameters.contains("frequency")) << level;
  }
}

TEST(RemoveHum, RefusesWhatIsNoHum) {
  auto force = force_of(long_record, std::vector<double>(long_record.samples, 0.0));
  const std::vector<TimeSpan> quiet{{-0.5, 0.0}};
  EXPECT_THROW(remove_hum(force, {0.0, 3, quiet}), std::invalid_argument);
  EXPECT_THROW(remove_hum(force, {50.0, 0, quiet}), std::invalid_argument);
  EXPECT_THROW(remove_hum(force, {4000.0, 2, quiet}), std::invalid_argument);
  EXPECT_THROW(remove_hum(force, {50.0, 3, {TimeSpan{-0.5, -0.4995}}}), std::invalid_argument);
}

}  // namespace

}  // namespace impactrig::acquisition
