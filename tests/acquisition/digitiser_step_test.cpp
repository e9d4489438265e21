// SPDX-License-Identifier: BSD-3-Clause
//
// The digitiser's step of a record whose filters leave nothing to see of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/steps.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::ConditioningAction;
using datasets::Record;
using namespace tests;

constexpr Sampling at;        // from -1 ms, 1 MHz, 4 ms
constexpr double step = 4.0;  // [N]

Record shot(double noise) {
  auto force = sampled(at, [](double t) { return half_sine(t, 1500.0, 200e-6); });
  add_noise(force, noise, 1);
  round_to(force, step);
  return record_of({force_of(at, force)});
}

const std::vector<ConditioningAction> filters{datasets::LowPass{50e3, 4},
                                              datasets::Resample{300e3}};

TEST(DigitiserStep, IsNotedWhereNoiseDoesNotReachTheNextOne) {
  for (const ConditioningAction& filter : filters) {
    Record record = shot(0.1 * step);
    apply_steps(std::vector<datasets::ConditioningStep>{{"Force", filter}}, record);
    EXPECT_EQ(record.provenance.edits.at(0).parameters.at("digitiser step"), "4 N");
    EXPECT_DOUBLE_EQ(find_impacts(record).at(0).force->quantum, step);
  }
}

// Noise that does is white, and what filters leave of it shows.
TEST(DigitiserStep, IsNotNotedWhereNoiseHidesIt) {
  for (const ConditioningAction& filter : filters) {
    Record record = shot(1.0 * step);
    apply_steps(std::vector<datasets::ConditioningStep>{{"Force", filter}}, record);
    EXPECT_FALSE(record.provenance.edits.at(0).parameters.contains("digitiser step"));
    EXPECT_EQ(find_impacts(record).at(0).force->quantum, 0.0);
  }
}

TEST(DigitiserStep, IsToldInTheUnitOfTheChannel) {
  Record record = shot(0.1 * step);
  datasets::Channel& force = record.channels[0];
  std::vector<double> kilonewtons = force.values();
  for (double& value : kilonewtons) value *= 1e-3;
  force = force_of(at, kilonewtons);
  force.unit = "kN";
  apply_steps(std::vector<datasets::ConditioningStep>{{"Force", filters[0]}}, record);
  EXPECT_EQ(record.provenance.edits.at(0).parameters.at("digitiser step"), "0.004 kN");
  EXPECT_NEAR(find_impacts(record).at(0).force->quantum, step, 1e-9);
}

// Filters keep what is noted before; in another unit it says nothing.
TEST(DigitiserStep, IsOfTheUnitItWasNotedIn) {
  Record record = shot(0.1 * step);
  apply_steps(std::vector<datasets::ConditioningStep>{{"Force", filters[0]},
                                                      {"Force", datasets::Resample{200e3}}},
              record);
  EXPECT_DOUBLE_EQ(find_impacts(record).at(0).force->quantum, step);
  for (const char* damaged : {"inf N", "nan N", "N", "", "4", "1e999 N"}) {
    for (datasets::Edit& edit : record.provenance.edits)
      edit.parameters["digitiser step"] = damaged;
    EXPECT_EQ(find_impacts(record).at(0).force->quantum, 0.0) << damaged;
  }
  for (datasets::Edit& edit : record.provenance.edits) edit.parameters["digitiser step"] = "4 N";
  record.channels[0].unit = "kN";
  EXPECT_EQ(find_impacts(record).at(0).force->quantum, 0.0);
}

}  // namespace
}  // namespace impactrig::acquisition
