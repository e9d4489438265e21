// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/frame_integrals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "models/integration/gauss.hpp"

namespace {

using namespace impactrig::models;
using Vector = Eigen::VectorXd;

/// A bar of powers of x, with two lumped masses, divided evenly: every integral has a closed form.
class FrameIntegralsOf : public testing::TestWithParam<int> {
 protected:
  static constexpr double length = 0.8, density = 1.7;  // [m], [kg/m]
  static constexpr double lumps[2][2] = {{0.3, 0.4}, {0.8, 0.5}};

  FrameIntegralsOf() {
    for (int e = 0; e < GetParam(); ++e)
      parts_.push_back({length * e / GetParam(), length / GetParam()});
    const GaussRule& rule = gauss_legendre(8);
    stations_.of_bar = 8 * GetParam();
    stations_.size = stations_.of_bar + 2;
    stations_.x = stations_.mass = Vector::Zero(stations_.size);
    Eigen::Index i = 0;
    for (const FramePart& part : parts_)
      for (std::size_t g = 0; g < rule.points.size(); ++g) {
        stations_.x[i] = part.x + part.length * rule.points[g];
        stations_.mass[i++] = density * part.length * rule.weights[g];
      }
    for (const auto& [x, mass] : lumps) {
      stations_.x[i] = x;
      stations_.mass[i++] = mass;
    }
    stations_.axial = stations_.x;
    stations_.bending.resize(stations_.size, 2);
    stations_.bending << power(stations_.x, 2), power(stations_.x, 3);
    places_ = gauss_points(parts_, points);
    Eigen::MatrixXd slopes(places_.size(), 2);
    slopes << 2.0 * power(places_, 1), 3.0 * power(places_, 2);
    bar_.emplace(stations_, parts_, points, slopes);
  }

  static Vector power(const Vector& x, int exponent) { return x.array().pow(exponent); }

  /// ∫ xⁿ dm.
  static double mass_of(int n) {
    double sum = density * std::pow(length, n + 1) / (n + 1);
    for (const auto& [x, mass] : lumps) sum += mass * std::pow(x, n);
    return sum;
  }

  /// g = xⁿ, whose running integral is xⁿ⁺¹ / (n + 1).
  Vector at_points(int n) const { return power(places_, n); }

  static constexpr int points = 5;
  std::vector<FramePart> parts_;
  FrameStations stations_;
  Vector places_;
  std::optional<FrameIntegrals> bar_;
};

TEST_P(FrameIntegralsOf, APowerOfX) {
  const FrameIntegrals& bar = *bar_;
  EXPECT_NEAR(bar.moment, mass_of(1), 1e-14);
  EXPECT_NEAR(bar.inertia, mass_of(2), 1e-14);
  EXPECT_NEAR(bar.axial[0], mass_of(1), 1e-14);
  EXPECT_NEAR(bar.axial_moment[0], mass_of(2), 1e-14);
  EXPECT_NEAR(bar.axial_bending(0, 1), mass_of(4), 1e-14);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(bar.bending[i], mass_of(2 + i), 1e-14);
    EXPECT_NEAR(bar.bending_moment[i], mass_of(3 + i), 1e-14);
    EXPECT_NEAR(bar.bending_bending(1, i), mass_of(5 + i), 1e-14);
  }
  // a polynomial through five points has any power up to the fourth
  for (int n = 0; n < points; ++n) {
    const Vector g = at_points(n);
    EXPECT_NEAR(bar.run.dot(g), mass_of(n + 1) / (n + 1), 1e-14) << n;
    EXPECT_NEAR(bar.run_moment.dot(g), mass_of(n + 2) / (n + 1), 1e-14) << n;
    EXPECT_NEAR(bar.run_axial.col(0).dot(g), mass_of(n + 2) / (n + 1), 1e-14) << n;
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(bar.run_bending.col(i).dot(g), mass_of(n + 3 + i) / (n + 1), 1e-14) << n;
      EXPECT_EQ(bar.bending_run.row(i), bar.run_bending.col(i).transpose());
    }
  }
}

TEST_P(FrameIntegralsOf, AProductOfRunningIntegrals) {
  Eigen::MatrixXd g(places_.size(), points), products(places_.size(), points);
  for (int n = 0; n < points; ++n) g.col(n) = at_points(n);
  products.setConstant(NAN);  // overwritten
  bar_->run_run.multiply(g, products);
  for (int n = 0; n < points; ++n)
    for (int k = 0; k < points; ++k)
      EXPECT_NEAR(g.col(k).dot(products.col(n)), mass_of(n + k + 2) / ((n + 1) * (k + 1)), 1e-14)
          << n << ", " << k;
}

INSTANTIATE_TEST_SUITE_P(Parts, FrameIntegralsOf, testing::Values(1, 2, 7));

}  // namespace
