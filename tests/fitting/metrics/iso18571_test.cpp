// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/iso18571.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "fitting/metrics/corridor.hpp"
#include "tests/fitting/metrics/check_signals.hpp"

namespace impactrig::fitting {
namespace {

using tests::CheckPair;
using tests::sampled;

constexpr double pi = std::numbers::pi;

double bell(double t, double height, double centre, double width) {
  const double x = (t - centre) / width;
  return height * std::exp(-0.5 * x * x);
}

using Function = std::function<double(double)>;

/// By τ = i / N.
const std::map<std::string, std::pair<Function, Function>> functions = {
    {"sine_scaled_shift",
     {[](double t) { return std::sin(6 * pi * t); },
      [](double t) { return 0.9 * std::sin(6 * pi * (t - 0.02)); }}},
    {"half_sine_pulse",
     {[](double t) { return t > 0.2 && t < 0.5 ? 1000 * std::sin(pi * (t - 0.2) / 0.3) : 0.0; },
      [](double t) {
        return t > 0.23 && t < 0.5 ? 1100 * std::sin(pi * (t - 0.23) / 0.27) : 0.0;
      }}},
    {"identical",
     {[](double t) { return std::exp(-4 * t) * std::sin(10 * pi * t); },
      [](double t) { return std::exp(-4 * t) * std::sin(10 * pi * t); }}},
    {"double_pulse",
     {[](double t) { return bell(t, 1, 0.3, 0.04) + bell(t, 0.5, 0.6, 0.05); },
      [](double t) { return bell(t, 1.1, 0.33, 0.045) + bell(t, 0.4, 0.66, 0.05); }}},
    {"ramp_ring",
     {[](double t) { return t + 0.05 * std::sin(40 * pi * t); },
      [](double t) { return 1.03 * t + 0.02; }}},
    {"too_late",
     {[](double t) { return bell(t, 1, 0.3, 0.05); },
      [](double t) { return bell(t, 1, 0.62, 0.05); }}}};

struct Expected {
  const char* signal;
  int samples;
  double rating, corridor, phase, magnitude, slope, correlation, magnitude_error, slope_error;
  std::ptrdiff_t shift;
  std::size_t path_length;
};

// Two implementations that know nothing of each other agree in these; every number of the table.
const std::vector<Expected> expected = {
    {"sine_scaled_shift", 200, 0.7124258359867095, 0.40034033678091885, 0.9, 0.9114485063717093,
     0.95, 1.0000000000000002, 0.04427574681414534, 0.1, 4, 244},
    {"sine_scaled_shift", 500, 0.7173967198714751, 0.400324264471802, 0.9, 0.936335070413771,
     0.9500000000000001, 0.9999999999999999, 0.03183246479311455, 0.09999999999999996, 10, 614},
    {"half_sine_pulse", 200, 0.9065140740457298, 0.9170942855872523, 0.925, 0.9327580079748737,
     0.8406237910792709, 0.9933170733250746, 0.033620996012563145, 0.31875241784145825, 3, 351},
    {"half_sine_pulse", 500, 0.9055221002683383, 0.917058503108071, 0.93, 0.9516737810694518,
     0.8118197140560974, 0.9933041711583142, 0.02416310946527412, 0.3763605718878052, 7, 885},
    {"identical", 200, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0, 200},
    {"identical", 500, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0, 500},
    {"double_pulse", 200, 0.8067385829599182, 0.7338216262215582, 0.825, 0.9024889824508493,
     0.8385606799056251, 0.9628041304510883, 0.04875550877457537, 0.32287864018874973, 7, 226},
    {"double_pulse", 500, 0.8104669172802084, 0.7336113997149694, 0.83, 0.9185762622467802,
     0.8365355247243226, 0.9630616211621496, 0.04071186887660987, 0.3269289505513549, 17, 582},
    {"ramp_ring", 200, 0.9222041747725453, 0.9605688669171005, 1.0, 0.9281273527933699,
     0.7617557872351556, 0.9925254801135853, 0.035936323603315036, 0.4764884255296888, 0, 315},
    {"ramp_ring", 500, 0.8743426307184042, 0.9606448437808254, 1.0, 0.9424473160390252,
     0.5079761499913449, 0.9925242762580908, 0.02877634198048742, 0.9840477000173102, 0, 881},
    {"too_late", 200, 0.26321434237912134, 0.6294756086800268, 0.0, 0.0, 0.0571204945355529,
     0.019745854441912576, 0.6712184805866742, 1.8857590109288942, 40, 191},
    {"too_late", 500, 0.26185374860123245, 0.6295292045813385, 0.0, 0.0, 0.050210333843485166,
     0.019745854485691217, 0.6417736959148704, 1.8995793323130297, 100, 481},
};

TEST(Iso18571, AgreesWithTheTableOfTwelveSignalPairs) {
  for (const Expected& e : expected) {
    const auto& [m, c] = functions.at(e.signal);
    CheckPair signals;
    for (int i = 0; i < e.samples; ++i) {
      const double tau = static_cast<double>(i) / e.samples;
      signals.measured.push_back(m(tau));
      signals.computed.push_back(c(tau));
    }
    const Iso18571 found = iso18571(signals.pair());
    const std::string what = std::string(e.signal) + " " + std::to_string(e.samples);
    const auto near = [&](double value, double wanted) {
      EXPECT_NEAR(value, wanted, std::max(1e-12, 1e-8 * std::abs(wanted))) << what;
    };
    near(found.rating, e.rating);
    near(found.corridor, e.corridor);
    near(found.phase, e.phase);
    near(found.magnitude, e.magnitude);
    near(found.slope, e.slope);
    near(found.correlation, e.correlation);
    near(found.magnitude_error, e.magnitude_error);
    near(found.slope_error, e.slope_error);
    EXPECT_EQ(found.shift, e.shift) << what;
    EXPECT_EQ(found.path_length, e.path_length) << what;
  }
}

struct AnnexRow {
  const char* name;
  double rating, corridor, phase, magnitude, slope;
};

// Scores printed in the annex of ISO/TS 18571:2024 to four decimals; its signals are not public.
const std::vector<AnnexRow> annex = {
    {"c_1_1__ac1__cae1", 0.9169, 0.956, 0.9518, 0.9524, 0.7683},
    {"c_1_3__ac3__cae1", 0.8045, 0.7263, 0.9401, 0.8977, 0.7321},
    {"c_2_1__an1__cae1", 0.6994, 0.5297, 0.7175, 0.8924, 0.8276},
    {"c_3_1__ds1__cae1", 0.9214, 0.8878, 0.9369, 0.9765, 0.9182},
    {"c_4_1__fo1__cae1", 0.5364, 0.4501, 0.6899, 0.6177, 0.4739},
    {"c_4_3__fo3__cae1", 0.7133, 0.6548, 0.9769, 0.7384, 0.5414},
    {"c_5_2__mo2__cae1", 0.2946, 0.2049, 0.4979, 0.0, 0.5652},
};

TEST(Iso18571, WeighsAsTheAnnexOfTheStandardDoes) {
  const auto& [m, c] = functions.at("double_pulse");
  const Iso18571 found = iso18571(sampled(300, 1.0 / 300, m, c).pair());
  const auto weighed = [](const auto& scores) {
    return 0.4 * scores.corridor + 0.2 * (scores.phase + scores.magnitude + scores.slope);
  };
  EXPECT_DOUBLE_EQ(found.rating, weighed(found));
  // four decimals of five numbers: 0.5e-4 (1 + 0.4 + 3 * 0.2)
  for (const AnnexRow& row : annex) EXPECT_NEAR(row.rating, weighed(row), 1e-4) << row.name;
}

TEST(Iso18571, GradesByTheLimitsOf2014) {
  EXPECT_EQ(iso18571_grade(1.0), "excellent");
  EXPECT_EQ(iso18571_grade(0.94), "good");
  EXPECT_EQ(iso18571_grade(0.8), "fair");
  EXPECT_EQ(iso18571_grade(0.58), "poor");
}

/// The warping of the standard with the whole matrix kept and walked back.
struct WholeMatrix {
  double error = 0.0;
  std::size_t length = 0;

  WholeMatrix(const std::vector<double>& m, const std::vector<double>& c) {
    const int size = static_cast<int>(m.size()), band = (size + 9) / 10;
    const double far = std::numeric_limits<double>::infinity();
    std::vector<std::vector<double>> cost(m.size(), std::vector<double>(m.size(), far));
    const auto at = [&](int i, int j) {
      return i < 0 || j < 0 ? far : cost[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    };
    const auto away = [&](int i, int j) {
      return c[static_cast<std::size_t>(i)] - m[static_cast<std::size_t>(j)];
    };
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) {
        if (std::abs(i - j) >= band) continue;
        const double before = std::min({at(i - 1, j), at(i, j - 1), at(i - 1, j - 1)});
        cost[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
            away(i, j) * away(i, j) + (i + j == 0 ? 0.0 : before);
      }
    double above = 0.0, below = 0.0;
    for (int i = size - 1, j = size - 1; i >= 0 && j >= 0;) {
      above += std::abs(away(i, j));
      below += std::abs(m[static_cast<std::size_t>(j)]);
      ++length;
      const double best = std::min({at(i - 1, j), at(i, j - 1), at(i - 1, j - 1)});
      if (i + j == 0) break;
      const bool up = at(i - 1, j) == best, left = at(i, j - 1) == best;
      if (up || !left) --i;
      if (!up) --j;
    }
    error = above / below;
  }
};

// Few different values, so that costs tie all over; lengths on both sides of every tenth.
TEST(Iso18571, WarpsInTwoRowsAsWithTheWholeMatrix) {
  std::mt19937 generator(18571);
  std::uniform_int_distribution<int> level(-2, 2), length(2, 90);
  for (int trial = 0; trial < 400; ++trial) {
    const int samples = length(generator);
    CheckPair signals;
    for (int i = 0; i < samples; ++i) {
      signals.measured.push_back(level(generator));
      signals.computed.push_back(level(generator));
    }
    const Iso18571 found = iso18571(signals.pair());
    const auto cut = [&](const std::vector<double>& x, bool late) {
      const std::ptrdiff_t away = std::abs(found.shift);
      return late ? std::vector<double>(x.begin() + away, x.end())
                  : std::vector<double>(x.begin(), x.end() - away);
    };
    const auto m = cut(signals.measured, found.shift < 0);
    if (std::ranges::all_of(m, [](double x) { return x == 0.0; })) continue;
    const WholeMatrix whole(m, cut(signals.computed, found.shift > 0));
    EXPECT_NEAR(found.magnitude_error, whole.error, 1e-13 * (1.0 + whole.error))
        << "trial " << trial;
    EXPECT_EQ(found.path_length, whole.length) << "trial " << trial << ", seed 18571";
  }
}

// A late copy, zeros around it: found to the sample, and nothing else is wrong.
TEST(Iso18571, FindsAShiftAndItsSign) {
  for (const std::ptrdiff_t shift : {7, -7}) {
    const double late = 0.01 * static_cast<double>(shift);
    const auto copy = [](double t) { return tests::pulse(t, 100.0, 0.395, 0.2); };
    const CheckPair signals = sampled(100, 0.01, copy, [&](double t) { return copy(t - late); });
    const Iso18571 found = iso18571(signals.pair());
    EXPECT_EQ(found.shift, shift);
    EXPECT_DOUBLE_EQ(found.phase, 1.0 - 0.07 / 0.2);
    EXPECT_NEAR(found.magnitude, 1.0, 1e-12);
    EXPECT_NEAR(found.slope, 1.0, 1e-12);
  }
}

TEST(Iso18571, ShiftsByAFifthAtMost) {
  const CheckPair signals = sampled(
      50, 1.0, [](double t) { return bell(t, 1, 15, 4); },
      [](double t) { return bell(t, 1, 28, 4); });
  const Iso18571 found = iso18571(signals.pair());
  EXPECT_EQ(found.shift, 10);
  EXPECT_EQ(found.phase, 0.0);
}

// Of two shifts with equal correlations the smaller wins, and of +n and -n the left (late) one.
TEST(Iso18571, PrefersSmallShiftsAndTheLateOne) {
  const auto wave = [](double t) { return std::sin(2 * pi * t / 20.0); };
  const CheckPair half = sampled(200, 1.0, wave, [&](double t) { return wave(t - 10.0); });
  EXPECT_EQ(iso18571(half.pair()).shift, 10);
}

TEST(Iso18571, OfConstantsIsOneWhereTheyAreEqual) {
  const std::vector<double> two(20, 2.0), three(20, 3.0), zero(20, 0.0);
  EXPECT_EQ(iso18571({two, two}).rating, 1.0);
  const Iso18571 other = iso18571({two, three});
  EXPECT_EQ(other.correlation, 0.0);
  EXPECT_EQ(other.shift, 0);
  EXPECT_EQ(other.phase, 1.0);
  EXPECT_EQ(other.corridor, 0.0);  // on the outer width
  EXPECT_NEAR(other.magnitude_error, 0.5, 1e-15);
  EXPECT_EQ(other.slope, 1.0);  // both are level
  EXPECT_EQ(iso18571({zero, zero}).rating, 1.0);
  EXPECT_EQ(iso18571({zero, two}).magnitude, 0.0);
  EXPECT_EQ(iso18571({zero, two}).corridor, 0.0);
}

// Moved by one sample both are level at 0.1; the sum of that many is not always as many times 0.1.
TEST(Iso18571, KnowsAConstantSegment) {
  for (std::size_t samples = 20; samples < 120; ++samples) {
    std::vector<double> m(samples, 0.1), c(samples, 0.1), other(samples, 0.3);
    m.front() = 1.0;
    c.back() = 2.0;
    other.back() = 2.0;
    EXPECT_EQ(iso18571({m, c}).correlation, 1.0) << samples;
    EXPECT_EQ(iso18571({m, c}).shift, -1) << samples;
    // of different constants 0, which is more than unmoved
    EXPECT_EQ(iso18571({m, other}).correlation, 0.0) << samples;
    EXPECT_EQ(iso18571({m, other}).shift, -1) << samples;
  }
}

// A third of the way from the inner to the outer width leaves (2/3)^2.
TEST(Corridor, FallsWithTheSquareBetweenItsWidths) {
  const std::vector<double> m = {0.0, 10.0, 0.0, 0.0, 0.0};
  const std::vector<double> c = {0.49, 12.0, 0.5, -5.0, 5.1};
  // 0.49: inside; 2: (3 / 4.5)^2; 0.5: on the inner width, 1; 5: on the outer one, 0; 5.1: outside
  EXPECT_NEAR(corridor_score({m, c}), (1.0 + 4.0 / 9.0 + 1.0) / 5.0, 1e-15);
}

TEST(Iso18571, NeedsTwoSamples) {
  const std::vector<double> one = {1.0}, two = {1.0, 2.0};
  EXPECT_THROW(iso18571({one, one}), std::invalid_argument);
  EXPECT_EQ(iso18571({two, two}).rating, 1.0);
}

}  // namespace
}  // namespace impactrig::fitting
