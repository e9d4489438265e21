// SPDX-License-Identifier: BSD-3-Clause
// What is computed several numbers at a time, against the same one by one.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/lanes/advance_modes.hpp"
#include "models/lanes/lane_bessel.hpp"
#include "models/lanes/processor.hpp"
#include "models/modal/bar_cache.hpp"
#include "tests/models/reference/spherical_bessel.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;
using Two = LaneMath<2>;

TEST(LaneMath, LogarithmIsRightToAnUlp) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> wide(-600.0, 600.0), near(0.5, 2.0);
  for (int i = 0; i < 100000; ++i) {
    const Two::Real x = {std::exp(wide(random)), near(random)};
    const Two::Real logarithm = Two::log(x);
    for (int lane = 0; lane < 2; ++lane) {
      const long double truth = std::log(static_cast<long double>(x[lane]));
      ASSERT_NEAR(logarithm[lane], static_cast<double>(truth),
                  2.3e-16 * static_cast<double>(std::abs(truth)))
          << x[lane];
    }
  }
}

TEST(LaneMath, SineAndCosineAreRightToRounding) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> step(0.0, 400.0), wide(-1e5, 1e5);
  for (int i = 0; i < 100000; ++i) {
    const Two::Real x = {step(random), wide(random)};
    const auto [sine, cosine] = Two::sine_cosine(x);
    for (int lane = 0; lane < 2; ++lane) {
      const long double angle = x[lane];
      ASSERT_NEAR(sine[lane], static_cast<double>(std::sin(angle)), 1.5e-16) << x[lane];
      ASSERT_NEAR(cosine[lane], static_cast<double>(std::cos(angle)), 1.5e-16) << x[lane];
    }
  }
}

// Neighbours of any size: a lane's recurrence begins where the largest needs it to.
TEST(LaneBessel, AgreesWithTheSingleFunction) {
  constexpr int terms = 240;
  LaneBessel<2, 256> lanes;
  std::array<double, terms> single;
  const std::array<double, 11> places = {1e-9, 2e-4, 9.99e-4, 1.01e-3, 0.1, 1.0, 3.141592653589793,
                                         9.0,  31.0, 100.0,   179.0};
  for (const double left : places)
    for (const double right : places) {
      lanes.evaluate(Two::Real{left, right}, terms);
      for (int lane = 0; lane < 2; ++lane) {
        const double z = lane == 0 ? left : right;
        spherical_bessel(z, single);
        for (int n = 0; n < terms; ++n)
          ASSERT_NEAR(lanes[n][lane], single[static_cast<std::size_t>(n)], 3e-15)
              << n << " of " << left << ", " << right;
      }
    }
}

/// Modes and their motion by one kind of processor.
struct Moved {
  Eigen::VectorXd a, rate;
  PointMotion struck;
};

Moved moved(const ModalBeam& beam, double h, const NodeVector& series,
            void (*advance_by)(ModesUnderForce&)) {
  const Eigen::VectorXd a = Eigen::VectorXd::LinSpaced(beam.modes(), 1.0, -2.0);
  const Eigen::VectorXd rate = Eigen::VectorXd::LinSpaced(beam.modes(), -3.0, 5.0);
  Moved to{a, rate, {}};
  ModesUnderForce modes{.modes = beam.modes(),
                        .terms = static_cast<int>(series.size()),
                        .omega = beam.omega().data(),
                        .struck = beam.struck().data(),
                        .h = h,
                        .series = series.data(),
                        .a = a.data(),
                        .rate = rate.data(),
                        .end_a = to.a.data(),
                        .end_rate = to.rate.data()};
  advance_by(modes);
  to.struck = {modes.displacement, modes.velocity};
  return to;
}

TEST(Lanes, GiveTheSameOnEveryProcessor) {
  const Rig rig = paper_rig();
  const auto bar = make_modal_bar(rig, hybrid(Basis::pinned_free, 12, 1e-6, 1e-3));
  const ModalBeam& beam = bar->modes();
  const NodeVector series = Eigen::VectorXd::LinSpaced(8, 2.0, -1.0);
  for (const double h : {1e-7, 1e-5, 3e-4, 4e-3}) {
    const auto two = [](ModesUnderForce& modes) { ModeAdvance<2>(modes).advance(); };
    const Moved plain = moved(beam, h, series, two);
    const auto expect_same = [&](const Moved& other) {
      EXPECT_LE((other.a - plain.a).norm(), 1e-14 * plain.a.norm());
      EXPECT_LE((other.rate - plain.rate).norm(), 1e-14 * plain.rate.norm());
      EXPECT_NEAR(other.struck.displacement, plain.struck.displacement, 1e-14 * plain.a.norm());
    };
    if (processor() >= Processor::avx2) expect_same(moved(beam, h, series, advance_modes_avx2));
    if (processor() >= Processor::avx512) expect_same(moved(beam, h, series, advance_modes_avx512));
  }
}

// A force constant in time, in long double; steps end on events however close by.
TEST(Lanes, MoveTheModesAsExactlyOverAnyTime) {
  const auto bar = make_modal_bar(paper_rig(), hybrid(Basis::pinned_free, 5, 1e-6, 1e-3));
  const ModalBeam& beam = bar->modes();
  NodeVector series = NodeVector::Zero(6);
  series[0] = 3.0;
  ModalState from, to;
  from.a = to.a = Eigen::VectorXd::LinSpaced(beam.modes(), 1e-6, -2e-6);
  from.rate = to.rate = Eigen::VectorXd::LinSpaced(beam.modes(), -3e-3, 5e-3);
  for (const double h : {1e-18, 1e-14, 1e-12, 1e-9, 1e-6, 1e-4}) {
    advance(beam, h, series, from, to);
    for (int k = 1; k < beam.modes(); ++k) {
      const long double omega = beam.omega()[k], t = h, force = 3.0L * beam.struck()[k];
      const long double half = std::sin(0.5L * omega * t);
      const long double sine = std::sin(omega * t), cosine = std::cos(omega * t);
      const long double a = from.a[k] * cosine + from.rate[k] * sine / omega -
                            force * 2.0L * half * half / (omega * omega);
      const long double rate =
          from.rate[k] * cosine - from.a[k] * omega * sine - force * sine / omega;
      EXPECT_NEAR(to.a[k], static_cast<double>(a), 2e-15 * std::abs(from.a[k])) << h << ' ' << k;
      EXPECT_NEAR(to.rate[k], static_cast<double>(rate),
                  1e-14 * (std::abs(from.rate[k]) +
                           static_cast<double>(std::abs(from.a[k] * omega * sine))))
          << h << ' ' << k;
    }
  }
}

// Weight and spring bend the modes of every bar differently: what follows from another's modes is
// what the bar itself has.
TEST(BarFamily, GivesTheModesOfEachBar) {
  for (const Solver& solver : {hybrid(Basis::pinned_free, 12, 1e-6, 1e-3),
                               hybrid(Basis::cantilever, 7, 1e-6, 1e-3), ancf(7, 1, 1e-6, 1e-3)})
    for (const double spring : {0.0, 2000.0}) {
      Rig rig = paper_rig();
      rig.gravity = 9.81;
      rig.beam.youngs_modulus *= 0.03;  // weight tells
      rig.beam.density *= 1.7;
      rig.beam.area *= 0.8;
      rig.hinge.spring = spring;
      const auto itself = make_modal_bar(rig, solver);
      const auto derived = BarFamily(*BarFamily::representative(rig), solver).bar(rig);
      const ModalBeam& a = itself->modes();
      const ModalBeam& b = derived->modes();
      ASSERT_EQ(a.modes(), b.modes());
      EXPECT_NEAR(b.elastic_compliance() / a.elastic_compliance(), 1.0, 1e-13);
      for (int k = 0; k < a.modes(); ++k) {
        EXPECT_NEAR(b.omega()[k] / a.omega()[k], 1.0, 1e-10) << k;
        EXPECT_NEAR(std::abs(b.struck()[k] / a.struck()[k]), 1.0, 1e-9) << k;
        EXPECT_NEAR(std::abs(b.rigid()[k]), std::abs(a.rigid()[k]), 1e-9 * a.rigid().norm()) << k;
        EXPECT_NEAR(std::abs(b.point(0.3)[k]), std::abs(a.point(0.3)[k]),
                    1e-9 * a.point(0.3).norm())
            << k;
      }
      const Eigen::VectorXd turned = 0.01 * b.rigid();
      const Eigen::VectorXd also = 0.01 * a.rigid();
      const double weight = a.energy(also, also).gravitational;
      EXPECT_NEAR(b.energy(turned, turned).gravitational / weight, 1.0, 1e-9);
      EXPECT_NEAR(b.energy(turned, turned).spring, a.energy(also, also).spring, 1e-9 * weight);
      EXPECT_NEAR(b.shortening_energy(turned, turned, 0.0) / a.shortening_energy(also, also, 0.0),
                  1.0, 1e-9);
    }
}

TEST(BarFamily, HasNoBarsWithFurtherMasses) {
  Rig rig = paper_rig();
  rig.beam.masses = {{.position = 0.4, .mass = 0.1}};
  EXPECT_FALSE(BarFamily::representative(rig));
}

}  // namespace
}  // namespace impactrig::tests
