// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/collocation.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

namespace {

using namespace impactrig::models;
using testing::AllOf;
using testing::Ge;
using testing::Le;

using Function = std::function<double(double)>;

NodeVector series_of(const Function& f, int nodes) {
  const Collocation& rule = Collocation::of(nodes);
  NodeVector values(nodes);
  for (int i = 0; i < nodes; ++i) values[i] = f(rule.points()[i]);
  return rule.to_series() * values;
}

/// The terms that so many nodes lack, of the series of 16.
double left_out(const Function& f, int nodes) {
  return series_of(f, most_nodes).tail(most_nodes - nodes).norm();
}

TEST(Truncation, IsTheSizeOfWhatASmoothFunctionLacks) {
  for (const double rate : {0.5, 1.0, 2.0, 4.0}) {
    const Function f = [rate](double x) { return std::exp(rate * x); };
    EXPECT_THAT(truncation(series_of(f, 6)) / left_out(f, 6), AllOf(Ge(1.0), Le(30.0))) << rate;
  }
}

// Even or odd about the step's middle: every other term is none.
TEST(Truncation, IsNoLessWhereEveryOtherTermIsNone) {
  const Function even = [](double x) { return std::cos(3.0 * (x - 0.5)); };
  const Function odd = [](double x) { return std::sin(3.0 * (x - 0.5)); };
  for (const Function& f : {even, odd})
    for (const int nodes : {5, 6, 7, 8})
      EXPECT_GE(truncation(series_of(f, nodes)), left_out(f, nodes)) << nodes;
}

// A force that bends slowly, and on it a vibration of two to three periods a step.
TEST(Truncation, IsNotMadeSmallByALargeSmoothPart) {
  for (const double angle : {12.0, 14.0, 16.0, 18.0})
    for (const double phase : {0.0, 0.8, 1.6, 2.4}) {
      const Function f = [=](double x) {
        return x - 1e-3 * x * x + 1e-6 * std::sin(angle * x + phase);
      };
      EXPECT_GE(truncation(series_of(f, 6)), 0.3 * left_out(f, 6)) << angle << ", " << phase;
    }
}

}  // namespace
