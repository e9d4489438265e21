// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/importer.hpp"
#include "tests/acquisition/scene.hpp"
#include "tests/support/places.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Impact;
using datasets::Quantity;
using datasets::Record;
using namespace tests;

/// Columns 0 (time) and `column` of a text file; blanks, tabs and commas separate.
Record columns_of(const std::string& path, int skip, int column, const std::string& unit) {
  std::ifstream in(path);
  std::string line;
  std::vector<double> times, values;
  for (int row = 0; std::getline(in, line); ++row) {
    if (row < skip) continue;
    std::ranges::replace(line, ',', ' ');
    std::istringstream cells(line);
    double time = 0.0, value = 0.0;
    cells >> time;
    for (int i = 0; i < column; ++i) cells >> value;
    times.push_back(time);
    values.push_back(value);
  }
  const Sampling at{
      .start = times.front(),
      .interval = (times.back() - times.front()) / static_cast<double>(times.size() - 1),
      .samples = times.size()};
  auto channel = channel_of("Acc", Quantity::acceleration, at, values);
  channel.unit = unit;
  return record_of({channel});
}

struct RealImpact {
  const char* file;
  int skip, column;
  const char* unit;
  double peak, peak_time, width, end, impulse;  ///< SI
};

// The figures were computed with NumPy: baseline = median of the first 250 (drop tower), 5 (shock)
// and 2000 samples (5 kg), peak = largest sample, half-peak and zero crossings by interpolation,
// impulse by numpy.trapz from the last sample at or below the baseline before the peak.
constexpr RealImpact real_impacts[] = {
    {"text/drop_tower_accel_1.csv", 2, 1, "kg (kilo-g)", 209899.0, 535e-6, 23.235e-6, 605.74e-6,
     9.2120},
    {"text/drop_tower_accel_1.csv", 2, 2, "kg (kilo-g)", 194203.7, 548e-6, 26.328e-6, 624.74e-6,
     9.1358},
    {"text/shock_base.txt", 1, 1, "g", 4699.32, 780.108e-6, 223.95e-6, 1008.27e-6, 1.11643},
    {"lvm/impact_5kg_headerless.lvm", 0, 1, "g", 48498.9, 14165e-6, 92.89e-6, 14267.6e-6, 5.0515},
};

TEST(FindImpacts, AgreesWithNumPyOnRealImpacts) {
  const std::string folder = impactrig::tests::shared_dir + "/recordings/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no third-party recordings here";
  for (const RealImpact& real : real_impacts) {
    SCOPED_TRACE(std::string(real.file) + " column " + std::to_string(real.column));
    const auto impacts =
        find_impacts(columns_of(folder + real.file, real.skip, real.column, real.unit));
    ASSERT_EQ(impacts.size(), 1u);  // all of them ring for a long time
    const Impact& impact = impacts[0];
    // The baselines differ by the foot of the pulse, up to 0.4 % of the peak; over the long foot
    // that makes up to 4 % of the impulse.
    EXPECT_NEAR(impact.peak, real.peak, 0.005 * real.peak);
    EXPECT_NEAR(impact.peak_time, real.peak_time, 1e-9);
    EXPECT_NEAR(impact.width, real.width, 0.005 * real.width);
    EXPECT_NEAR(impact.end, real.end, 2e-6);
    EXPECT_NEAR(impact.impulse, real.impulse, 0.04 * real.impulse);
    EXPECT_FALSE(impact.has(datasets::ImpactFlag::too_short));
    EXPECT_FALSE(impact.has(datasets::ImpactFlag::clipped));
    EXPECT_FALSE(impact.has(datasets::ImpactFlag::double_hit));
  }
}

// The whole way of a user's file: import, condition, find.
TEST(FindImpacts, FindsTheSameInAnImportedFile) {
  const std::string folder = impactrig::tests::shared_dir + "/recordings/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no third-party recordings here";
  const Record record = condition(import_recording(folder + "text/drop_tower_accel_1.csv"), {});
  EXPECT_EQ(record.channels.size(), 5u);  // a sixth is named and has no column
  for (const RealImpact& real : {real_impacts[0], real_impacts[1]}) {
    const auto impacts =
        find_impacts(record, {.trigger_channel = "accel " + std::to_string(real.column)});
    ASSERT_EQ(impacts.size(), 1u);
    EXPECT_NEAR(impacts[0].peak, real.peak, 0.005 * real.peak);
    EXPECT_NEAR(impacts[0].peak_time, real.peak_time, 1e-9);
  }
}

// Ten samples of a hammer at rest, cut from a longer record by its publisher.
TEST(FindImpacts, FindsNothingInAHammerAtRest) {
  const std::vector<double> force{0.914018, 0.537321, 0.616905, 0.895449, 0.574460,
                                  0.516099, 1.046658, 0.394070, 0.741586, 0.680572};
  const Sampling at{.start = 0.0, .interval = 3.90625e-5, .samples = force.size()};
  EXPECT_TRUE(find_impacts(record_of({force_of(at, force)})).empty());
}

}  // namespace
}  // namespace impactrig::acquisition
