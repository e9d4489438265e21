// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/diagnose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/fitting/diagnostics/noise.hpp"

namespace impactrig::fitting {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using tests::gaussian_noise;

constexpr std::size_t before = 1000, after = 1500;
constexpr double contact = 300e-6, interval = 1e-6;

double pulse(double t) {
  return t > 0.0 && t < contact ? 500.0 * std::pow(std::sin(std::numbers::pi * t / contact), 2.0)
                                : 0.0;
}

ChannelResiduals channel_of(const std::vector<double>& noise) {
  ChannelResiduals out;
  out.quantity = "force";
  out.unit = "N";
  out.interval = interval;
  out.start = -interval * static_cast<double>(before);
  out.phases = {139.5e-6, contact - 0.5e-6, {{599.5e-6, 699.5e-6}}};
  out.residual = noise;
  for (std::size_t i = 0; i < noise.size(); ++i)
    out.model.push_back(pulse(out.start + interval * static_cast<double>(i)));
  return out;
}

double at(const ChannelResiduals& channel, std::size_t i) {
  return channel.start + channel.interval * static_cast<double>(i);
}

const PhaseLevel& level(const ChannelDiagnostics& found, const std::string& phase) {
  for (const PhaseLevel& l : found.phases)
    if (l.phase == phase) return l;
  throw std::out_of_range(phase);
}

// 200 sound channels: at most 5 % of them, and a bound of four deviations more.
TEST(Diagnose, HoldsItsLevelWhateverTheColour) {
  for (const double memory : {0.0, 0.5, 0.9}) {
    int accused = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed)
      accused +=
          diagnose(channel_of(gaussian_noise(before + after, 9000 + seed, memory)), 0.05).sound ? 0
                                                                                                : 1;
    EXPECT_LE(accused, 10 + 4 * 3) << memory;
  }
}

TEST(Diagnose, CountsEachPhase) {
  const ChannelDiagnostics found = diagnose(channel_of(gaussian_noise(before + after, 1)), 0.05);
  EXPECT_EQ(level(found, "before touch").samples, 1000);
  EXPECT_EQ(level(found, "compression").samples, 140);
  EXPECT_EQ(level(found, "restitution").samples, 160);
  EXPECT_EQ(level(found, "later contacts").samples, 100);
  EXPECT_EQ(level(found, "free vibration").samples, 1100);
  EXPECT_TRUE(found.sound);
  EXPECT_EQ(found.sentence,
            "The force's residuals are what its noise before touch leads to expect.");
}

// Closed forms: of x² of a normal x, nine tenths are above its 55.4th percentile; of sin² above its
// 40.4th.
TEST(Diagnose, KnowsHowMuchIsInFewSamples) {
  ChannelResiduals channel = channel_of(gaussian_noise(before + after, 11));
  EXPECT_NEAR(level(diagnose(channel, 0.05), "free vibration").concentration, 0.4455, 0.02);
  for (std::size_t i = before + 300; i < channel.residual.size(); ++i)
    channel.residual[i] = 40.0 * std::sin(2e4 * std::numbers::pi * at(channel, i));
  EXPECT_NEAR(level(diagnose(channel, 0.05), "free vibration").concentration, 0.596, 0.01);
}

TEST(Diagnose, NamesADisturbanceThatNoModelMakes) {
  ChannelResiduals channel = channel_of(gaussian_noise(before + after, 12));
  channel.quantity = "velocity";
  for (std::size_t i = before + 900; i < before + 950; ++i)
    channel.residual[i] += i % 2 == 0 ? 60.0 : 30.0;
  const ChannelDiagnostics found = diagnose(channel, 0.05);
  EXPECT_FALSE(found.sound);
  EXPECT_LT(level(found, "free vibration").concentration, 50.0 / 1100.0);
  EXPECT_THAT(found.sentence, HasSubstr("% of the samples there; a laser's dropout"));
}

TEST(Diagnose, NamesThePhaseThatFails) {
  ChannelResiduals channel = channel_of(gaussian_noise(before + after, 2));
  std::vector<double> more = gaussian_noise(before + after, 3);
  for (std::size_t i = 0; i < more.size(); ++i)
    if (at(channel, i) >= 140e-6 && at(channel, i) < contact) channel.residual[i] += 3.0 * more[i];
  const ChannelDiagnostics found = diagnose(channel, 0.05);
  EXPECT_FALSE(found.sound);
  EXPECT_NEAR(level(found, "restitution").ratio, std::sqrt(10.0), 0.6);
  EXPECT_LT(level(found, "restitution").p_value, 1e-10);
  EXPECT_GT(level(found, "compression").p_value, 1e-3);
  EXPECT_THAT(found.sentence, HasSubstr("times the noise during restitution"));
  EXPECT_THAT(found.sentence, HasSubstr("contact.damping"));
}

TEST(Diagnose, NamesADelayAndWhatToDo) {
  ChannelResiduals channel = channel_of(gaussian_noise(before + after, 4));
  for (std::size_t i = 0; i < channel.residual.size(); ++i)
    channel.residual[i] += pulse(at(channel, i) - 1e-6) - pulse(at(channel, i));
  const ChannelDiagnostics found = diagnose(channel, 0.05);
  EXPECT_FALSE(found.sound);
  EXPECT_THAT(found.sentence, ContainsRegex("look like a delay of (1|0\\.9[0-9]?|1\\.[01]) us"));
  EXPECT_THAT(found.sentence, HasSubstr("(measured late)"));
  EXPECT_THAT(found.sentence, HasSubstr("sensors.force.delay"));
}

// A right model behind a digitiser whose step is ten times the noise: what is left follows the
// model's slope, within half a step.
TEST(Diagnose, ForgivesACoarseDigitiser) {
  const double step = 10.0;
  ChannelResiduals channel = channel_of(gaussian_noise(before + after, 5));
  for (std::size_t i = 0; i < channel.residual.size(); ++i) {
    if (at(channel, i) > 0.0) channel.model[i] += 4.4;  // shown as 0 where nothing else moves
    const double truth = channel.model[i] + 0.2 * channel.residual[i];
    channel.residual[i] = step * std::round(truth / step) - channel.model[i];
  }
  channel.quantum = step;
  const ChannelDiagnostics found = diagnose(channel, 0.05);
  EXPECT_TRUE(found.coarse);
  EXPECT_TRUE(found.sound) << found.sentence;
  EXPECT_THAT(found.sentence, HasSubstr("digitiser's step"));
  channel.quantum = 0.0;
  EXPECT_FALSE(diagnose(channel, 0.05).sound && diagnose(channel, 0.05).judged);
  for (std::size_t i = 0; i < channel.residual.size(); ++i)
    channel.residual[i] += 0.1 * channel.model[i];
  channel.quantum = step;
  EXPECT_FALSE(diagnose(channel, 0.05).sound);
}

TEST(Diagnose, DoesNotJudgeWithoutNoiseToCompareWith) {
  ChannelResiduals channel = channel_of(gaussian_noise(before + after, 6));
  channel.residual.erase(channel.residual.begin(), channel.residual.begin() + 960);
  channel.model.erase(channel.model.begin(), channel.model.begin() + 960);
  channel.start += 960.0 * interval;
  const ChannelDiagnostics found = diagnose(channel, 0.05);
  EXPECT_FALSE(found.judged);
  EXPECT_THAT(found.sentence, HasSubstr("record a longer pre-trigger"));
}

// A unit mistaken by nine orders, samples that are no numbers, an impact without an end.
TEST(Diagnose, SurvivesWhatIsFarOff) {
  ChannelResiduals channel = channel_of(gaussian_noise(before + after, 7));
  for (std::size_t i = 0; i < channel.residual.size(); ++i)
    if (at(channel, i) >= 0.0) channel.residual[i] += 1e9 * pulse(at(channel, i));
  channel.residual[before + 50] = std::numeric_limits<double>::infinity();
  channel.model[before + 60] = std::numeric_limits<double>::quiet_NaN();
  channel.phases = {};
  const ChannelDiagnostics found = diagnose(channel, 0.05);
  EXPECT_FALSE(found.sound);
  EXPECT_GE(found.p_value, 0.0);
  EXPECT_GT(level(found, "free vibration").ratio, 1e9);
  EXPECT_NEAR(found.discrepancy.largest, 5e11, 1e10);
}

// Of samples that rest on a step hardly any is fitted: a longer pre-trigger would not help.
TEST(Diagnose, DoesNotJudgeAgainstStepsThatHideTheNoise) {
  ChannelResiduals channel = channel_of(std::vector<double>(before + after, 0.0));
  channel.quantum = 1.0;
  for (std::size_t i = 0; i + 1 < before; ++i)
    channel.residual[i] = std::numeric_limits<double>::quiet_NaN();
  const ChannelDiagnostics found = diagnose(channel, 0.05);
  EXPECT_FALSE(found.judged);
  EXPECT_THAT(found.sentence, HasSubstr("rests on the digitiser's steps"));
}

TEST(Diagnose, DoesNotJudgeAgainstNoNoise) {
  ChannelResiduals channel = channel_of(std::vector<double>(before + after, 0.0));
  for (std::size_t i = 0; i < channel.residual.size(); ++i)
    channel.residual[i] = 1e-14 * static_cast<double>(i % 7) + 0.01 * channel.model[i];
  const ChannelDiagnostics found = diagnose(channel, 0.05);
  EXPECT_FALSE(found.judged);
  EXPECT_THAT(found.sentence, HasSubstr("show no noise"));
}

// Of few samples that follow each other a half more than the noise may be chance; it is not small.
TEST(Diagnose, SaysHowLargeResidualsAreThatOnlyFollowEachOther) {
  ChannelDiagnostics found;
  found.judged = true;
  found.sound = false;
  found.level = 0.05;
  found.whiteness.p_value = 1e-9;
  found.phases.resize(2);
  found.phases[0].ratio = 1.04;
  found.phases[1].ratio = 1.03;
  ChannelResiduals force;
  force.quantity = "force";
  EXPECT_THAT(diagnosis_sentence(force, found), HasSubstr("are hardly larger than the noise, but"));
  found.phases[1].ratio = 1.52;
  EXPECT_THAT(diagnosis_sentence(force, found),
              HasSubstr("are up to 1.52 times the noise, which so few samples may be by chance, "
                        "but follow each other"));
}

}  // namespace
}  // namespace impactrig::fitting
