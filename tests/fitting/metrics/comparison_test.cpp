// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/metrics/inequality.hpp"
#include "tests/fitting/metrics/check_signals.hpp"

namespace impactrig::fitting {
namespace {

using tests::check_signals;
using tests::CheckPair;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Expected {
  const char* signal;
  std::size_t samples;
  MagnitudePhase sprague_geers, geers_1984, russell;
  double theil_u, whang, zilliacus, rss_factor, weighted_integrated_factor, correlation, r_squared;
  double rmse, of_peak, of_range, of_rms, residual_mean, residual_deviation, t;
  double peak_ratio, impulse_ratio;
};

// Independently computed; every number of the table "waveform metrics on six signal pairs".
const std::vector<Expected> expected = {
    {"damped_sine",
     201,
     {0.11103390419451453, 0.046157104274010825, 0.12024560763553295},
     {0.11103390419451453, 0.010495079545379649, 0.11152880603386947},
     {0.08313387281647885, 0.046157104274010825, 0.08426950553353042},
     0.0894396998784802,
     0.09851922858265824,
     0.2107571920587288,
     0.18881023882445372,
     0.16522676433522884,
     0.9889287164577127,
     0.9618844068181251,
     0.05281738094201269,
     0.07472100581618933,
     0.05074891553131645,
     0.18881023882445375,
     -0.005084561756407943,
     0.07473394691596259,
     -0.9645697461194862,
     1.092380889414044,
     1.050508666487317},
    {"haversine_pulse",
     401,
     {0.01702676186196528, 0.030307096514232003, 0.034762490109700846},
     {0.01702676186196528, 0.004529291790084433, 0.017618884857555587},
     {0.0144232806407379, 0.030307096514232003, 0.02974543970797637},
     0.04832953233145978,
     0.04668756244510931,
     0.09196018870826353,
     0.09748196010082748,
     0.09394076781070873,
     0.9935800586639424,
     0.9828876304650903,
     229.7528583515775,
     0.051056190744795005,
     0.051056190744795005,
     0.09748196010082746,
     0.010584898632288424,
     0.050009311839385,
     4.2384592415450255,
     1.0666666666666669,
     0.9696935091949029},
    {"scaled_1p2",
     101,
     {0.19999999999999996, 0.0, 0.19999999999999996},
     {0.19999999999999996, 0.0, 0.19999999999999996},
     {0.13566260200007305, 0.0, 0.12022785066944591},
     0.09090909090909091,
     0.0909090909090909,
     0.19999999999999998,
     0.19999999999999996,
     0.16666666666666666,
     1.0,
     0.9599993470572232,
     0.14703673683878465,
     0.12240569885057397,
     0.061202849425287,
     0.19999999999999996,
     -0.0004945448212894164,
     0.12301520085697668,
     -0.04040243732810374,
     1.2,
     1.2000000000000008},
    {"sign_flip",
     101,
     {0.0, 1.0, 1.0},
     {0.0, 2.0, 2.0},
     {0.0, 1.0, 0.8862269254527579},
     1.0,
     1.0,
     2.0,
     2.0,
     1.0,
     -1.0,
     -3.0000652942776824,
     1.4703673683878469,
     1.22405698850574,
     0.6120284942528701,
     2.0,
     0.004945448212894093,
     1.230152008569767,
     0.04040243732810314,
     -1.0,
     -1.0},
    {"quarter_shift",
     1000,
     {0.0, 0.5, 0.5},
     {0.0, 0.9999999999999999, 0.9999999999999999},
     {0.0, 0.5, 0.44311346272637897},
     0.7071067811865475,
     0.7071067811865476,
     1.4142135623730951,
     1.4142135623730951,
     0.849727718814649,
     6.508855954212578e-17,
     -1.0,
     1.0,
     1.0,
     0.5,
     1.414213562373095,
     0.0,
     1.0005003753127737,
     0.0,
     -1.0,
     nan},
    {"offset",
     301,
     {0.04128698055338842, 0.003921624053587249, 0.04147280914567456},
     {0.04128698055338842, 7.5892030361846e-05, 0.04128705030413466},
     {0.03380035638573436, 0.003921624053587249, 0.030155728212131437},
     0.021142842430268705,
     0.02210129336281292,
     0.0452016005600727,
     0.04315860898479927,
     0.04144737213737443,
     1.0,
     0.9789176416473888,
     0.1000000000000001,
     0.0333335345602164,
     0.05000052410355434,
     0.04315860898479928,
     -0.033333534560216385,
     8.601616632754352e-18,
     -6.7233316124592056e+16,
     1.0333335345602164,
     1.0452016005600728},
};

void expect_equal(const MagnitudePhase& found, const MagnitudePhase& wanted,
                  const std::string& what) {
  EXPECT_NEAR(found.magnitude, wanted.magnitude, 1e-10) << what;
  EXPECT_NEAR(found.phase, wanted.phase, 1e-10) << what;
  EXPECT_NEAR(found.comprehensive, wanted.comprehensive, 1e-10) << what;
}

// 1e-9 relative or 1e-10 absolute is what the table claims.
void expect_near(double found, double wanted, const std::string& what) {
  EXPECT_NEAR(found, wanted, std::max(1e-10, 1e-9 * std::abs(wanted))) << what;
}

TEST(Comparison, AgreesWithTheTableOfSixSignalPairs) {
  for (const Expected& e : expected) {
    const CheckPair signals = check_signals(e.signal);
    const Comparison found = compare_histories(signals.pair(), 0.0, 1.0);
    const std::string signal = e.signal;
    EXPECT_EQ(found.samples, e.samples) << signal;
    expect_equal(found.sprague_geers, e.sprague_geers, signal + " Sprague-Geers");
    expect_equal(found.geers_1984, e.geers_1984, signal + " Geers");
    expect_equal(found.russell, e.russell, signal + " Russell");
    expect_near(found.theil_u, e.theil_u, signal + " Theil");
    expect_near(found.whang, e.whang, signal + " Whang");
    expect_near(found.zilliacus, e.zilliacus, signal + " Zilliacus");
    expect_near(found.rss_factor, e.rss_factor, signal + " RSS");
    expect_near(found.weighted_integrated_factor, e.weighted_integrated_factor, signal + " WIFac");
    expect_near(found.correlation, e.correlation, signal + " Pearson");
    expect_near(found.r_squared, e.r_squared, signal + " R2");
    expect_near(found.error.rmse, e.rmse, signal + " RMSE");
    expect_near(found.error.of_peak, e.of_peak, signal + " RMSE of peak");
    expect_near(found.error.of_range, e.of_range, signal + " RMSE of range");
    expect_near(found.error.of_rms, e.of_rms, signal + " RMSE of RMS");
    expect_near(found.residuals.mean, e.residual_mean, signal + " mean residual");
    expect_near(found.residuals.deviation, e.residual_deviation, signal + " residual deviation");
    // of a constant offset s is rounding, and t with it
    if (signal != "offset") expect_near(found.residuals.t, e.t, signal + " t");
    expect_near(found.computed.peak / found.measured.peak, e.peak_ratio, signal + " peak ratio");
    if (std::isnan(e.impulse_ratio))
      EXPECT_TRUE(std::isnan(impulse_ratio(signals.pair()))) << signal;
    else
      expect_near(impulse_ratio(signals.pair()), e.impulse_ratio, signal + " impulse ratio");
  }
}

TEST(Comparison, OfAHistoryWithItselfFindsNothing) {
  for (const Expected& e : expected) {
    const CheckPair signals = check_signals(e.signal);
    const Comparison same = compare_histories({signals.measured, signals.measured}, 0.0, 1.0);
    for (const MagnitudePhase& pair : {same.sprague_geers, same.geers_1984, same.russell}) {
      EXPECT_EQ(pair.magnitude, 0.0) << e.signal;
      EXPECT_EQ(pair.phase, 0.0) << e.signal;
      EXPECT_EQ(pair.comprehensive, 0.0) << e.signal;
    }
    EXPECT_EQ(same.knowles_gear.magnitude, 0.0) << e.signal;
    for (const double zero : {same.theil_u, same.whang, same.zilliacus, same.rss_factor,
                              same.weighted_integrated_factor, same.error.rmse, same.residuals.mean,
                              same.residuals.deviation})
      EXPECT_EQ(zero, 0.0) << e.signal;
    EXPECT_NEAR(same.correlation, 1.0, 1e-15) << e.signal;
    EXPECT_EQ(same.r_squared, 1.0) << e.signal;
    ASSERT_TRUE(same.iso18571 && same.cora);
    EXPECT_NEAR(same.iso18571->rating, 1.0, 1e-15) << e.signal;
    EXPECT_NEAR(same.cora->rating, 1.0, 1e-14) << e.signal;
    EXPECT_TRUE(roadside_accepts(same.sprague_geers, same.residuals));
  }
}

// What has no unit does not change with the unit: a power of two scales without rounding.
TEST(Comparison, DoesNotDependOnTheUnit) {
  const CheckPair newtons = check_signals("haversine_pulse");
  CheckPair scaled = newtons;
  for (double& value : scaled.measured) value *= 1024.0;
  for (double& value : scaled.computed) value *= 1024.0;
  const Comparison a = compare_histories(newtons.pair(), 0.0, 1e-6);
  const Comparison b = compare_histories(scaled.pair(), 0.0, 1e-6);
  EXPECT_EQ(a.sprague_geers.comprehensive, b.sprague_geers.comprehensive);
  EXPECT_EQ(a.russell.comprehensive, b.russell.comprehensive);
  EXPECT_EQ(a.knowles_gear.comprehensive, b.knowles_gear.comprehensive);
  EXPECT_EQ(a.iso18571->rating, b.iso18571->rating);
  EXPECT_EQ(a.cora->rating, b.cora->rating);
  EXPECT_EQ(a.weighted_integrated_factor, b.weighted_integrated_factor);
  EXPECT_EQ(a.residuals.t_effective, b.residuals.t_effective);
  EXPECT_EQ(a.measured.duration, b.measured.duration);
  EXPECT_EQ(1024.0 * a.error.rmse, b.error.rmse);
  EXPECT_EQ(1024.0 * a.measured.impulse, b.measured.impulse);
}

TEST(Comparison, LeavesOutRatingsThatWouldTakeTooLong) {
  const CheckPair signals = check_signals("offset");
  const Comparison found = compare_histories(signals.pair(), 0.0, 1.0, 300);
  EXPECT_FALSE(found.iso18571);
  EXPECT_FALSE(found.cora);
  EXPECT_NEAR(found.error.rmse, 0.1, 1e-12);
}

std::string complaint(const std::vector<double>& m, const std::vector<double>& c,
                      double interval = 1.0) {
  try {
    compare_histories({m, c}, 0.0, interval);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Comparison, RefusesWhatCannotBeCompared) {
  EXPECT_EQ(complaint({1, 2, 3}, {1, 2}),
            "histories to be compared must be of one length, found 3 and 2 samples");
  EXPECT_EQ(complaint({1}, {1}), "at least 2 samples are needed, found 1");
  EXPECT_EQ(complaint({1, 2}, {1, nan}), "histories to be compared must be finite");
  EXPECT_EQ(complaint({0, 0}, {1, 2}),
            "the measured history is zero throughout, and nothing can be told in parts of it");
  EXPECT_EQ(complaint({1, 2}, {1, 2}, 0.0), "a sample interval must be greater than zero");
}

TEST(Comparison, OfConstantsSaysWhatIsNotDefined) {
  const std::vector<double> two = {2, 2, 2, 2}, three = {3, 3, 3, 3}, zero = {0, 0, 0, 0};
  const Comparison found = compare_histories({two, three}, 0.0, 1.0);
  EXPECT_NEAR(found.sprague_geers.magnitude, 0.5, 1e-15);
  EXPECT_EQ(found.sprague_geers.phase, 0.0);
  EXPECT_TRUE(std::isnan(found.correlation));
  EXPECT_TRUE(std::isnan(found.r_squared));
  EXPECT_TRUE(std::isnan(found.error.of_range));
  EXPECT_TRUE(std::isnan(found.residuals.t));
  EXPECT_TRUE(std::isnan(found.measured.duration));
  const Comparison silent = compare_histories({two, zero}, 0.0, 1.0);
  EXPECT_EQ(silent.sprague_geers.magnitude, -1.0);
  EXPECT_EQ(silent.sprague_geers.phase, 0.5);
  EXPECT_TRUE(std::isnan(silent.russell.magnitude));
  EXPECT_EQ(silent.theil_u, 1.0);
  EXPECT_EQ(silent.whang, 1.0);
  EXPECT_EQ(silent.weighted_integrated_factor, 1.0);
}

TEST(Comparison, HoldsSquaresThatWouldOverflow) {
  CheckPair huge = check_signals("damped_sine"), tiny = huge;
  for (std::vector<double>* values : {&huge.measured, &huge.computed})
    for (double& value : *values) value *= 0x1p600;
  for (std::vector<double>* values : {&tiny.measured, &tiny.computed})
    for (double& value : *values) value *= 0x1p-600;
  for (const CheckPair& signals : {huge, tiny}) {
    EXPECT_NEAR(sprague_geers(signals.pair()).comprehensive, 0.12024560763553295, 1e-10);
    EXPECT_NEAR(theil_u(signals.pair()), 0.0894396998784802, 1e-10);
    EXPECT_NEAR(correlation(signals.pair()), 0.9889287164577127, 1e-10);
    EXPECT_NEAR(weighted_integrated_factor(signals.pair()), 0.16522676433522884, 1e-10);
  }
}

TEST(Roadside, PracticeSetsLimitsToEachPart) {
  ResidualAnalysis residuals;
  residuals.mean = -0.05;
  residuals.deviation = 0.35;
  EXPECT_TRUE(roadside_accepts({-0.4, 0.0, 0.4}, residuals));
  EXPECT_FALSE(roadside_accepts({-0.41, 0.0, 0.4}, residuals));
  EXPECT_FALSE(roadside_accepts({0.3, 0.3, 0.42}, residuals));
  residuals.mean = 0.051;
  EXPECT_FALSE(roadside_accepts({0.0, 0.0, 0.0}, residuals));
  residuals = {};
  residuals.deviation = 0.36;
  EXPECT_FALSE(roadside_accepts({0.0, 0.0, 0.0}, residuals));
}

}  // namespace
}  // namespace impactrig::fitting
