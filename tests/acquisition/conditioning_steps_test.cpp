// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "acquisition/conditioning/steps.hpp"
#include "datasets/input_error.hpp"
#include "datasets/sensor_response.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::ConditioningStep;
using datasets::Record;
using datasets::TimeSpan;
using namespace tests;

constexpr Sampling at;  // from -1 ms, 1 MHz, 4 ms

double force_at(double t) {
  return half_sine(t, 1500.0, 200e-6);
}

double velocity_at(double t) {
  const double done = std::clamp(t / 200e-6, 0.0, 1.0);
  return 0.44 - 0.32 * (1.0 - std::cos(std::numbers::pi * done));
}

Record shot() {
  auto force = sampled(at, [](double t) { return force_at(t) + 12.0; });
  add_noise(force, 2.0, 1);
  auto velocity = sampled(at, velocity_at);
  add_noise(velocity, 1e-3, 2);
  Record record = record_of({force_of(at, force), velocity_of(at, velocity)});
  record.channels[0].name = "Ref1";
  return record;
}

TEST(ApplySteps, FindsChannelsByNamePatternAndQuantity) {
  for (const char* name : {"Ref1", "ref1", "R*", "force", "0"}) {
    Record record = shot();
    apply_steps(std::vector<ConditioningStep>{{name, datasets::RemoveBaseline{}}}, record);
    EXPECT_NEAR(record.channels[0].value(100), shot().channels[0].value(100) - 12.0, 0.3) << name;
    ASSERT_EQ(record.provenance.edits.size(), 1U);
    EXPECT_EQ(record.provenance.edits[0].channel, "Ref1");
  }
  Record record = shot();
  apply_steps(std::vector<ConditioningStep>{{"*", datasets::LowPass{100e3, 4}}}, record);
  EXPECT_EQ(record.provenance.edits.size(), 2U);
}

// Touch is at 0: the quiet stretch is what lies before it.
TEST(ApplySteps, TakesWhatLiesBeforeTouchAsQuiet) {
  Record record = shot();
  apply_steps(std::vector<ConditioningStep>{{"force", datasets::RemoveDrift{}}}, record);
  const auto& parameters = record.provenance.edits.at(0).parameters;
  EXPECT_EQ(parameters.at("from"), "-0.001 s");
  EXPECT_NEAR(std::stod(parameters.at("to")), -50e-6, 5e-6);
}

TEST(ApplySteps, WarnsOfADecayThatIsAnother) {
  const Sampling long_rest{.start = -50e-3, .interval = 2e-5, .samples = 5000};
  const std::vector<TimeSpan> rest{{-50e-3, -0.5e-3}};
  const auto warnings_of = [&](std::optional<double> stated, double further) {
    auto values = sampled(long_rest, [&](double t) {
      const double since = t - long_rest.start;
      return 20.0 * std::exp(-since / 0.02) + further * std::exp(-since / 2e-3);
    });
    add_noise(values, 0.1, 1);
    Record record = record_of({force_of(long_rest, values)});
    apply_steps(std::vector<ConditioningStep>{{"Force", datasets::RemoveDecay{rest, stated}}},
                record);
    return record.warnings;
  };
  EXPECT_THAT(warnings_of({}, 0.0), testing::IsEmpty());
  EXPECT_THAT(warnings_of(0.02, 0.0), testing::IsEmpty());
  EXPECT_THAT(warnings_of({}, 4.0),
              testing::ElementsAre(testing::HasSubstr("do not follow one decay: another")));
  EXPECT_THAT(
      warnings_of(0.025, 0.0),
      testing::ElementsAre(testing::HasSubstr("leave time_constant out, or state it anew")));
}

// Before touch a velocity is the approach speed; without it no restitution is left.
TEST(ApplySteps, WarnsOfAnApproachThatIsTakenForAnOffset) {
  const TimeSpan rest{-1e-3, -0.5e-3};
  const auto warnings_of = [](const std::string& channel,
                              const datasets::ConditioningAction& action) {
    Record record = shot();
    apply_steps(std::vector<ConditioningStep>{{"velocity", datasets::Integrate{"way", {}, {}}},
                                              {channel, action}},
                record);
    return record.warnings;
  };
  const auto told = [](const std::string& start) {
    return testing::ElementsAre(testing::StartsWith("What comes off " + start));
  };
  EXPECT_THAT(warnings_of("Velocity", datasets::RemoveBaseline{}),
              told("'Velocity' is its course before touch (offset 0.4"));
  EXPECT_THAT(warnings_of("Velocity", datasets::RemoveDrift{}),
              told("'Velocity' is its course before touch (offset 0.4"));
  EXPECT_THAT(warnings_of("way", datasets::RemoveDrift{}),
              told("'way' is its course before touch (slope 0.4"));
  EXPECT_THAT(warnings_of("way", datasets::RemoveBaseline{}), testing::IsEmpty());
  EXPECT_THAT(warnings_of("Velocity", datasets::RemoveBaseline{rest}), testing::IsEmpty());
  EXPECT_THAT(warnings_of("Velocity", datasets::RemoveDrift{rest}), testing::IsEmpty());
  EXPECT_THAT(warnings_of("Ref1", datasets::RemoveDrift{}), testing::IsEmpty());
}

TEST(ApplySteps, SaysThatAnIntegralGoesOverWhatIsNotValid) {
  Record record = shot();
  record.channels[0].valid.assign(record.channels[0].size(), 1);
  for (std::size_t i = 1100; i < 1150; ++i) record.channels[0].valid[i] = 0;
  const ConditioningStep impulse{"force", datasets::Integrate{"impulse", {}, {}}};
  apply_steps(std::vector<ConditioningStep>{impulse}, record);
  EXPECT_THAT(record.warnings, testing::ElementsAre(testing::HasSubstr(
                                   "over 50 samples that are not valid, by straight lines")));
  record = shot();
  apply_steps(std::vector<ConditioningStep>{impulse}, record);
  EXPECT_THAT(record.warnings, testing::IsEmpty());
}

TEST(ApplySteps, RefusesAnIntegralThatIsZeroBeyondTheRecord) {
  for (const double time : {-2e-3, 1.0}) {
    Record record = shot();
    EXPECT_ANY_THROW(apply_steps(
        std::vector<ConditioningStep>{{"velocity", datasets::Integrate{"way", {}, time}}}, record))
        << time;
  }
}

TEST(ApplySteps, DoesThemInTheirOrder) {
  Record record = shot();
  apply_steps(std::vector<ConditioningStep>{{"velocity", datasets::Integrate{"way", {}, -1e-3}},
                                            {"way", datasets::Differentiate{"back"}},
                                            {"back", datasets::LowPass{20e3, 4}},
                                            {"back", datasets::Resample{200e3}}},
              record);
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[2].name, "way");
  EXPECT_EQ(record.channels[2].quantity, datasets::Quantity::displacement);
  EXPECT_EQ(record.channels[2].value(0), 0.0);
  EXPECT_EQ(record.channels[3].clock.interval, 1.0 / 200e3);
  EXPECT_NEAR(record.channels[3].value(100), 0.44, 3e-3);
  std::vector<std::string> what;
  for (const auto& edit : record.provenance.edits) what.push_back(edit.what);
  EXPECT_THAT(
      what, testing::ElementsAre("integrate", "differentiate", "low-pass, zero phase", "resample"));
}

// Whichever comes first knows of the other, though a step of a channel to come stands between.
TEST(ApplySteps, TakesHumAndDecayOffTogetherInAnyOrder) {
  const Sampling long_record{.start = -0.1, .interval = 50e-6, .samples = 6000};
  const std::vector<TimeSpan> quiet{{-0.1, -1e-3}, {10e-3, 0.2}};
  const auto pulse = [](double t) { return half_sine(t, 1500.0, 5e-3); };
  auto recorded = sampled(long_record, [&](double t) {
    return pulse(t) + 80.0 * std::exp(-(t + 0.1) / 40e-3) +
           6.0 * std::sin(2.0 * std::numbers::pi * 50.03 * t);
  });
  add_noise(recorded, 0.5, 3);
  const ConditioningStep hum{"force", datasets::RemoveHum{50.0, 3, quiet}};
  const ConditioningStep decay{"force", datasets::RemoveDecay{quiet, std::nullopt}};
  const ConditioningStep added{"force", datasets::Integrate{"impulse", {}, {}}};
  const ConditioningStep of_added{"impulse", datasets::RemoveDecay{quiet, 1.0}};
  for (const auto& steps : {std::vector<ConditioningStep>{hum, added, of_added, decay},
                            std::vector<ConditioningStep>{decay, added, of_added, hum}}) {
    Record record = record_of({force_of(long_record, recorded)});
    apply_steps(steps, record);
    double squares = 0.0;
    for (std::size_t i = 0; i < long_record.samples; ++i)
      squares += std::pow(record.channels[0].value(i) - pulse(long_record.time(i)), 2);
    // the noise, and what ten coefficients take of it or add
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(long_record.samples)), 0.5, 0.03);
  }
}

// A fit takes its prediction through the same.
TEST(ApplySteps, LeavesItsFiltersToTheImpact) {
  Record record = shot();
  const datasets::TimeSpan whole{record.channels[0].clock.time(0),
                                 record.channels[0].clock.time(record.channels[0].size() - 1)};
  apply_steps(std::vector<ConditioningStep>{{"force", datasets::LowPass{100e3, 3}},
                                            {"velocity", datasets::LowPass{50e3, 4}},
                                            {"velocity", datasets::Resample{250e3}}},
              record);
  const auto impacts = find_impacts(record);
  ASSERT_EQ(impacts.size(), 1U);
  ASSERT_EQ(impacts[0].force->filters.size(), 1U);
  const auto& low_pass = std::get<datasets::LowPass>(impacts[0].force->filters[0].action);
  EXPECT_EQ(low_pass.cutoff, 100e3);
  EXPECT_EQ(low_pass.order, 3);
  EXPECT_EQ(impacts[0].force->recorded.begin, whole.begin);
  EXPECT_EQ(impacts[0].force->recorded.end, whole.end);
  ASSERT_EQ(impacts[0].velocity->filters.size(), 2U);
  EXPECT_NEAR(impacts[0].velocity->filters[0].interval, 1e-6, 1e-15);
  EXPECT_EQ(std::get<datasets::Resample>(impacts[0].velocity->filters[1].action).rate, 250e3);
}

TEST(ApplySteps, TellsOfEachThatIsDone) {
  Record record = shot();
  std::vector<std::size_t> edits;
  const std::vector<ConditioningStep> steps = {{"force", datasets::RemoveBaseline{}},
                                               {"*", datasets::LowPass{100e3, 4}}};
  apply_steps(steps, record, {}, {}, [&] { edits.push_back(record.provenance.edits.size()); });
  EXPECT_EQ(edits, (std::vector<std::size_t>{1, 3}));
}

TEST(ApplySteps, WarnsOfAStepThatIsTakenAgain) {
  Record record = shot();
  const std::vector<ConditioningStep> wide{{"force", datasets::LowPass{300e3, 2}}};
  apply_steps(wide, record);
  apply_steps(std::vector<ConditioningStep>{{"force", datasets::LowPass{200e3, 2}}}, record);
  EXPECT_THAT(record.warnings, testing::IsEmpty());
  apply_steps(wide, record);
  EXPECT_THAT(
      record.warnings,
      testing::ElementsAre("'Ref1' has been through the low-pass at 300000 Hz before and is "
                           "again, which lowers the band."));
}

TEST(ApplySteps, WarnsOfAPeakThatALowPassLowers) {
  Record record = shot();
  apply_steps(std::vector<ConditioningStep>{{"force", datasets::LowPass{100e3, 4}}}, record);
  EXPECT_THAT(record.warnings, testing::IsEmpty());
  apply_steps(std::vector<ConditioningStep>{{"force", datasets::LowPass{4e3, 4}}}, record);
  ASSERT_EQ(record.warnings.size(), 1U);
  EXPECT_THAT(record.warnings[0], testing::StartsWith("The low-pass at 4000 Hz takes "));
}

// 200 us of force hold nothing above 250 kHz; at 10 kHz two samples are left of them.
TEST(ApplySteps, WarnsOfAPeakThatResamplingLowers) {
  Record record = shot();
  apply_steps(std::vector<ConditioningStep>{{"force", datasets::Resample{500e3}}}, record);
  EXPECT_THAT(record.warnings, testing::IsEmpty());
  apply_steps(std::vector<ConditioningStep>{{"force", datasets::Resample{10e3}}}, record);
  ASSERT_EQ(record.warnings.size(), 1U);
  EXPECT_THAT(record.warnings[0], testing::StartsWith("The resampling to 10000 Hz takes "));
  EXPECT_THAT(record.provenance.edits.back().parameters.at("largest departure"),
              testing::HasSubstr(" N, before 150"));
}

// Of a rail at 1200 of 1500 N the filter makes a crest of about 1200 N.
TEST(ApplySteps, WarnsOfARailThatAFilterHides) {
  const std::vector<datasets::ConditioningAction> filters{datasets::LowPass{20e3, 4},
                                                          datasets::Resample{40e3}};
  for (const auto& filter : filters)
    for (const bool clipped : {false, true}) {
      Record record = shot();
      for (double& value : std::get<std::vector<double>>(record.channels[0].raw))
        if (clipped) value = std::min(value, 1200.0);
      apply_steps(std::vector<ConditioningStep>{{"force", filter}}, record);
      const auto hidden = testing::Contains(
          testing::HasSubstr("hides that 'Ref1' was clipped: peak and impulse are too small"));
      if (clipped)
        EXPECT_THAT(record.warnings, hidden) << filter.index();
      else
        EXPECT_THAT(record.warnings, testing::Not(hidden)) << filter.index();
    }
}

// The flag was gone from what was imported, and with it all word of the loss.
TEST(ApplySteps, WarnsOfDropoutsThatAFilterHides) {
  for (const bool lost : {false, true}) {
    Record record = shot();
    auto& velocity = std::get<std::vector<double>>(record.channels[1].raw);
    if (lost)
      for (std::size_t i = 2200; i < 2260; ++i) velocity[i] *= 0.02;
    apply_steps(std::vector<ConditioningStep>{{"velocity", datasets::LowPass{20e3, 4}}}, record);
    const auto hidden =
        testing::Contains(testing::HasSubstr("has dropouts that nobody marked: what it made of"));
    if (lost)
      EXPECT_THAT(record.warnings, hidden);
    else
      EXPECT_THAT(record.warnings, testing::Not(hidden));
  }
}

// Whatever rounds the top off: filters, a course taken off, one after the other.
TEST(ApplySteps, KeepsTheFlagOfAClippedTop) {
  const datasets::TimeSpan quiet{-0.9e-3, -0.1e-3};
  const std::vector<std::vector<datasets::ConditioningAction>> cases{
      {datasets::LowPass{20e3, 4}},
      {datasets::Resample{40e3}},
      {datasets::RemoveDrift{quiet}},
      {datasets::RemoveDecay{{quiet}, 5e-3}},
      {datasets::UndoLowCut{100.0, quiet}},
      {datasets::RemoveDrift{quiet}, datasets::LowPass{20e3, 4}, datasets::Resample{40e3}}};
  for (const auto& actions : cases)
    for (const bool clipped : {false, true}) {
      Record record = shot();
      auto& force = std::get<std::vector<double>>(record.channels[0].raw);
      for (double& value : force)
        if (clipped) value = std::min(value, 1200.0);
      std::vector<ConditioningStep> steps;
      for (const auto& action : actions) steps.push_back({"force", action});
      apply_steps(steps, record);
      const auto impacts = find_impacts(record);
      ASSERT_EQ(impacts.size(), 1U);
      EXPECT_EQ(impacts[0].has(datasets::ImpactFlag::clipped), clipped)
          << actions.front().index() << " of " << actions.size();
    }
}

TEST(ApplySteps, WarnsOfGapsThatResamplingBridges) {
  Record record = shot();
  auto& force = record.channels[0];
  std::vector<double> values, times;
  for (std::size_t i = 0; i < at.samples; ++i) {
    if (i >= 1100 && i < 1150) continue;
    times.push_back(at.time(i));
    values.push_back(force.value(i));
  }
  force.clock.times = times;
  force.raw = values;
  apply_steps(std::vector<ConditioningStep>{{"force", datasets::Resample{1e6}}}, record);
  EXPECT_THAT(record.warnings,
              testing::ElementsAre("'Ref1' has 1 gap in its times, 5.1e-05 s long: 50 of the "
                                   "resampled values lie in it and are marked invalid."));
}

// What a fit accounts for as filters stays in: only the delay beside them comes off the clock.
TEST(ApplySteps, AlignLeavesKnownFiltersIn) {
  SensorSet sensors;
  sensors.force.emplace();
  sensors.force->quantity = datasets::Quantity::force;
  sensors.force->resonance = datasets::Resonance{20e3, 20.0};
  sensors.velocity.emplace();
  sensors.velocity->quantity = datasets::Quantity::velocity;
  sensors.velocity->high_cut = datasets::BandLimit{50e3, 2};
  for (const double delay : {0.0, 4e-6}) {
    Record record = shot();
    auto force = datasets::sensor_response(*sensors.force, sampled(at, force_at), 1e-6);
    auto velocity = datasets::sensor_response(
        *sensors.velocity, sampled(at, [&](double t) { return velocity_at(t - delay); }), 1e-6);
    add_noise(force, 1.0, 4);
    add_noise(velocity, 1e-4, 5);
    record.channels[0].raw = force;
    record.channels[1].raw = velocity;
    const std::vector<ConditioningStep> align{{"velocity", datasets::AlignTo{"force", 50e-6}}};
    apply_steps(align, record, sensors);
    const datasets::Delay found = *record.channels[1].delay;
    EXPECT_NEAR(found.value, delay, 3.0 * found.uncertainty);
    EXPECT_LT(found.uncertainty, 1.0e-6);
  }
}

// The force's clock is 40 us late, the velocity's 0.4 us: both are right afterwards.
TEST(ApplySteps, AlignTakesKnownDelaysOffBoth) {
  Record record = shot();
  record.channels[0].clock.start += 40e-6;
  record.channels[0].delay = datasets::Delay{40e-6, 0.3e-6, false};
  record.channels[1].clock.start += 0.4e-6;
  record.channels[1].delay = datasets::Delay{0.4e-6, 0.1e-6, false};
  apply_steps(std::vector<ConditioningStep>{{"velocity", datasets::AlignTo{"force", 50e-6}}},
              record);
  EXPECT_NEAR(record.channels[0].clock.start, -1e-3, 1e-12);
  EXPECT_NEAR(record.channels[1].clock.start, -1e-3, 3.0 * record.channels[1].delay->uncertainty);
  for (const datasets::Channel& channel : record.channels) EXPECT_TRUE(channel.delay->removed);
}

std::string refusal(const ConditioningStep& step, Record record = shot()) {
  try {
    apply_steps(std::vector<ConditioningStep>{{"force", datasets::RemoveBaseline{}}, step}, record);
  } catch (const datasets::InputError& error) {
    return error.what();
  }
  return {};
}

TEST(ApplySteps, SaysWhichStepFailsAndWhy) {
  EXPECT_EQ(refusal({"Acc", datasets::LowPass{1e3, 4}}),
            "shot.csv: conditioning step 2: there is no channel 'Acc'; the channels are 'Ref1', "
            "'Velocity'");
  EXPECT_EQ(refusal({"force", datasets::RepairDropouts{}}),
            "shot.csv: conditioning step 2: channel 'Ref1' is a force, in which an impact itself "
            "is a spike; dropouts are repaired in velocity and displacement");
  EXPECT_EQ(refusal({"velocity", datasets::AlignTo{"Velocity", 1e-6}}),
            "shot.csv: conditioning step 2: channel 'Velocity' is to be aligned to itself");
  EXPECT_EQ(refusal({"velocity", datasets::Integrate{"Ref1", {}, {}}}),
            "shot.csv: conditioning step 2: there is a channel 'Ref1' already; state another name");
  Record quiet = record_of({velocity_of(at, std::vector<double>(at.samples, 1.0))});
  try {
    apply_steps(std::vector<ConditioningStep>{{"velocity", datasets::RemoveBaseline{}}}, quiet);
    FAIL();
  } catch (const datasets::InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "shot.csv: conditioning step 1: no impact is found, so what is quiet is not known; "
        "state quiet = { from = \"...\", to = \"...\" }");
  }
  quiet.channels.push_back(force_of(at, std::vector<double>(at.samples, 0.0)));
  try {
    apply_steps(std::vector<ConditioningStep>{{"velocity", datasets::AlignTo{"force", 50e-6}}},
                quiet);
    FAIL();
  } catch (const datasets::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "shot.csv: conditioning step 1: no impact is found, by which channels could be "
                 "aligned; choose another --trigger or --threshold");
  }
}

}  // namespace

}  // namespace impactrig::acquisition
