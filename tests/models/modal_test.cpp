// SPDX-License-Identifier: BSD-3-Clause
// What the small-motion solver is made of: each piece against a closed form or an integral of ours.
#include <gtest/gtest.h>

#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/beams/ancf.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/beams/linear_bar.hpp"
#include "models/collocation/collocation.hpp"
#include "models/integration/gauss.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"
#include "models/modal/mode_kernel.hpp"
#include "tests/models/reference/spherical_bessel.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

// Long double, by composite quadrature; at μ = 2πi k the first of them is zero, at −700 all there
// is lies in a hundredth of the way.
TEST(ExponentialMoments, AreThoseOfQuadrature) {
  using Long = std::complex<long double>;
  const GaussRule& gauss = gauss_legendre(20);
  for (const std::complex<double> mu :
       {std::complex(0.0, 0.0), std::complex(-1e-12, 1e-12), std::complex(0.0, 1.9e-3),
        std::complex(-2.1e-3, 0.0), std::complex(-1.6e-3, 1.6e-3), std::complex(0.0, 3.1e-3),
        std::complex(-0.02, 0.01), std::complex(-0.5, 0.0), std::complex(0.0, 1.0),
        std::complex(0.0, 2.0 * std::numbers::pi), std::complex(0.0, 60.0 * std::numbers::pi),
        std::complex(-3.0, 40.0), std::complex(-50.0, 0.0), std::complex(-30.0, 300.0),
        std::complex(-700.0, 0.0)}) {
    std::vector<std::complex<double>> moments(120);
    exponential_moments(mu, moments);
    const int panels = 60 + static_cast<int>(std::abs(mu));
    std::vector<Long> expected(moments.size());
    Eigen::VectorXd legendre(120);
    for (int p = 0; p < panels; ++p)
      for (std::size_t q = 0; q < gauss.points.size(); ++q) {
        const double x = (p + gauss.points[q]) / panels;
        shifted_legendre(x, legendre);
        const Long share = std::exp(Long(mu) * static_cast<long double>(x)) *
                           static_cast<long double>(gauss.weights[q] / panels);
        for (std::size_t n = 0; n < expected.size(); ++n)
          expected[n] += share * static_cast<long double>(legendre[static_cast<Eigen::Index>(n)]);
      }
    for (std::size_t n = 0; n < moments.size(); ++n)
      EXPECT_LT(std::abs(std::complex<double>(expected[n]) - moments[n]), 3e-15)
          << n << " of " << mu;
  }
}

// Real ones by real numbers; few of a fast decay by the recurrence upwards, all by that downwards.
TEST(ExponentialMoments, AreTheSameOfRealExponents) {
  for (const double mu : {0.0, -1e-12, -2.1e-3, -0.5, -50.0, -128.0, -300.0, -700.0}) {
    std::vector<std::complex<double>> expected(120);
    exponential_moments(std::complex<double>(mu), expected);
    for (const std::size_t count : {1U, 2U, 16U, 120U}) {
      std::vector<double> moments(count);
      exponential_moments(mu, moments);
      for (std::size_t n = 0; n < count; ++n)
        EXPECT_NEAR(moments[n], expected[n].real(), 1e-15) << n << " of " << mu;
    }
  }
}

TEST(SphericalBessel, AgreesWithBoost) {
  for (const double z :
       {0.0, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 3.141592653589793, 4.4934094579, 20.0, 180.0}) {
    std::vector<double> j(60);
    spherical_bessel(z, j);
    for (unsigned n = 0; n < j.size(); ++n)
      EXPECT_NEAR(j[n], boost::math::sph_bessel(n, z), 2e-14) << "j_" << n << "(" << z << ")";
  }
}

TEST(Collocation, SeriesAndRatesAreThoseOfAPolynomial) {
  const Collocation& rule = Collocation::of(6);
  const auto polynomial = [](double x) { return 1.0 - 2.0 * x + 3.0 * std::pow(x, 5); };
  NodeVector values(6);
  for (int i = 0; i < 6; ++i) values[i] = polynomial(rule.points()[i]);
  const NodeVector series = rule.to_series() * values;
  Eigen::VectorXd legendre(6);
  for (const double x : {0.0, 0.3, 1.0}) {
    shifted_legendre(x, legendre);
    EXPECT_NEAR(legendre.dot(series), polynomial(x), 1e-13);
  }
  const Eigen::VectorXd rates = rule.rates() * series;
  EXPECT_NEAR(rates[0], -2.0, 1e-12);
  EXPECT_NEAR(rates[7], 13.0, 1e-12);
  const NodeVector part = rule.restricted(series, 0.25);
  shifted_legendre(0.4, legendre);
  EXPECT_NEAR(legendre.dot(part), polynomial(0.1), 1e-13);
}

/// A rigid bar whose weight is such that it swings at a frequency, and its hinge's damper such that
/// it loses speed at a rate.
Rig swinging_at(double omega, double damping) {
  Rig rig = paper_rig();
  rig.hinge.viscous = damping * rig.beam.hinge_inertia();
  rig.gravity = omega * omega * rig.beam.length / 1.5;
  return rig;
}

/// One mode of a given frequency and damping d [1/s].
struct Pendulum {
  explicit Pendulum(double omega, double damping = 0.0) : rig(swinging_at(omega, damping)) {}

  Rig rig;
  FloatingFrameBeam bar{rig, Basis::cantilever, 0, 0};
  ModalBeam modes{bar, rig};
};

TEST(ModalBeam, ARigidBarIsAPendulum) {
  const Pendulum pendulum(4.0);
  ASSERT_EQ(pendulum.modes.modes(), 1);
  EXPECT_NEAR(pendulum.modes.omega()[0], 4.0, 1e-12);
  EXPECT_NEAR(std::pow(pendulum.modes.struck()[0], 2), 1.0 / effective_mass(pendulum.rig), 1e-12);
}

// Exact frequencies [Blevins1979]; consistent cubic elements converge to them with the fourth power
// of their length, from above.
TEST(ModalBeam, AncfConvergesToThePinnedFreeFrequencies) {
  const Rig rig = paper_rig();
  const AncfBeam coarse(rig, {14, 2}), fine(rig, {28, 4});
  const ModalBeam few(coarse, rig), many(fine, rig);
  EXPECT_LT(many.omega()[0], 1e-3);  // weightless: it turns freely
  for (int k = 1; k <= 5; ++k) {
    const double exact = BendingMode(rig.beam, Basis::pinned_free, k).angular_frequency();
    const double error = many.omega()[k] / exact - 1.0;
    EXPECT_GT(error, -1e-9) << k;
    EXPECT_LT(error, 1e-4) << k;
    if (error < 1e-7) continue;  // its digits are rounding
    EXPECT_NEAR((few.omega()[k] / exact - 1.0) / error, 16.0, 1.5) << k;
  }
}

/// The largest share of its energy that bending stretches, of all motions of a bar's first two
/// elastic modes with this energy.
double most_stretching_of_two_modes(const ModalBeam& modes, double energy) {
  double most = 0.0;
  Eigen::VectorXd a = Eigen::VectorXd::Zero(modes.modes());
  for (int i = 0; i < 2000; ++i) {
    const double phase = std::numbers::pi * i / 2000.0;
    a[1] = std::sqrt(2.0 * energy) * std::cos(phase) / modes.omega()[1];
    a[2] = std::sqrt(2.0 * energy) * std::sin(phase) / modes.omega()[2];
    most = std::max(most, modes.stretching_energy(a) / energy);
  }
  return most;
}

// One element bends in two ways: some mixture of them is the worst there can be.
TEST(ModalBeam, CannotStretchMoreThanItSays) {
  Rig rig = paper_rig();
  rig.gravity = 0.0;
  const double energy = 0.07;
  const LinearBar one(rig, bar_elements(rig.beam, rig.beam.length, {1, 0}));
  const ModalBeam alone(one, rig);
  EXPECT_NEAR(most_stretching_of_two_modes(alone, energy) / alone.most_stretching(energy), 1.0,
              1e-4);
  const LinearBar eight(rig, bar_elements(rig.beam, rig.contact.position, {7, 1}));
  const ModalBeam modes(eight, rig);
  const ModalBeam softer(modes, {.stiffness = 0.25, .mass = 2.0});
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const ModalBeam* bar : {&modes, &softer})
    for (int i = 0; i < 2000; ++i) {
      Eigen::VectorXd a = Eigen::VectorXd::Zero(bar->modes());
      for (int k = 1; k < bar->modes(); ++k) a[k] = normal(random) / bar->omega()[k];
      a *= std::sqrt(2.0 * energy) / bar->omega().cwiseProduct(a).norm();
      EXPECT_LT(bar->stretching_energy(a), bar->most_stretching(energy) * energy);
    }
  EXPECT_NEAR(softer.most_stretching(energy) / modes.most_stretching(energy), 4.0, 1e-12);
}

// A stiff bar's pendulum frequency, 1e6 times below its highest: the weight must not be lost in the
// rounding of the highest modes. Heavier at the tip by bending is beyond the digits compared.
TEST(ModalBeam, KeepsTheSlowSwingBesideTheFastestVibration) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  const AncfBeam mesh(rig, {56, 8});
  const ModalBeam modes(mesh, rig);
  EXPECT_NEAR(modes.omega()[0] / std::sqrt(1.5 * 9.81 / 0.8), 1.0, 1e-5);
}

/// After a blow, and its rate: ä + d ȧ + ω² a = 0, a(0) = 0, ȧ(0) = 1, in closed form.
double blow(double omega, double damping, double time, bool rate) {
  const long double w = omega, half = 0.5L * damping, t = time;
  const long double square = (w - half) * (w + half), root = std::sqrt(std::abs(square));
  const long double decay = std::exp(-half * t);
  long double answer = t, even = 1.0L;
  if (square > 0.0L) {
    answer = std::sin(root * t) / root;
    even = std::cos(root * t);
  } else if (square < 0.0L) {
    answer = std::sinh(root * t) / root;
    even = std::cosh(root * t);
  }
  return static_cast<double>(decay * (rate ? even - half * answer : answer));
}

/// ∫₀ᵗ k(t − s) F(s/h) ds by a fine composite rule.
double duhamel(double omega, double damping, double h, double t, const NodeVector& series,
               bool rate) {
  const GaussRule gauss = gauss_legendre(20);
  const int panels = 4 + static_cast<int>((omega + damping) * t);
  double sum = 0.0;
  Eigen::VectorXd legendre(series.size());
  for (int p = 0; p < panels; ++p)
    for (std::size_t q = 0; q < gauss.points.size(); ++q) {
      const double s = t * (p + gauss.points[q]) / panels;
      shifted_legendre(s / h, legendre);
      sum +=
          t / panels * gauss.weights[q] * blow(omega, damping, t - s, rate) * legendre.dot(series);
    }
  return sum;
}

/// Phase ωh and damping d h of a step.
class OneMode : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(OneMode, AnswersAPolynomialForceAsDuhamelsIntegral) {
  const double h = 1e-3;
  const double omega = GetParam().first / h, damping = GetParam().second / h;
  const Pendulum pendulum(omega, damping);
  const Collocation& rule = Collocation::of(8);
  const ModalStep step(pendulum.modes, rule, h);
  NodeVector series(8);
  series << 2.0, -1.0, 0.5, 0.3, -0.7, 0.2, 0.1, -0.4;
  NodeVector force(8);
  Eigen::VectorXd legendre(8);
  for (int i = 0; i < 8; ++i) {
    shifted_legendre(rule.points()[i], legendre);
    force[i] = legendre.dot(series);
  }
  const double r = pendulum.modes.struck()[0];
  const double most = std::abs(r) * h * h;
  ModalState from{Eigen::VectorXd::Constant(1, 0.3 * most),
                  Eigen::VectorXd::Constant(1, std::abs(r) * h)};
  ModalState to = from, again = from;
  step.advance(from, force, to);
  advance(pendulum.modes, h, series, from, again);
  const auto free = [&](double t) {
    const double answer = blow(omega, damping, t, false);
    return from.a[0] * (blow(omega, damping, t, true) + damping * answer) + from.rate[0] * answer;
  };
  const auto free_rate = [&](double t) {
    return from.rate[0] * blow(omega, damping, t, true) -
           from.a[0] * omega * omega * blow(omega, damping, t, false);
  };
  const double expected = free(h) - r * duhamel(omega, damping, h, h, series, false);
  EXPECT_NEAR(to.a[0], expected, 1e-12 * most);
  EXPECT_NEAR(again.a[0], expected, 1e-12 * most);
  const double rate = free_rate(h) - r * duhamel(omega, damping, h, h, series, true);
  EXPECT_NEAR(to.rate[0], rate, 1e-11 * most / h);
  EXPECT_NEAR(again.rate[0], rate, 1e-11 * most / h);
  const BarMotion::Response& response = step.response(0, 0);
  NodeVector displacement, velocity;
  step.coast(0, from, displacement, velocity);
  displacement += response.displacement_of_force * force;
  for (int i = 0; i < 8; ++i) {
    const double t = h * rule.points()[i];
    EXPECT_NEAR(displacement[i], r * (free(t) - r * duhamel(omega, damping, h, t, series, false)),
                1e-12 * std::abs(r) * most);
    EXPECT_NEAR(velocity[i], r * free_rate(t), 1e-11 * std::abs(r) * most / h);
    EXPECT_NEAR(response.velocity_of_force.row(i).dot(force),
                -r * r * duhamel(omega, damping, h, t, series, true),
                1e-11 * std::abs(r) * most / h);
  }
}

using Phase = std::pair<double, double>;

INSTANTIATE_TEST_SUITE_P(Undamped, OneMode,
                         testing::Values(Phase{0.0, 0.0}, Phase{1e-7, 0.0}, Phase{1e-4, 0.0},
                                         Phase{0.1, 0.0}, Phase{2.0, 0.0}, Phase{30.0, 0.0},
                                         Phase{300.0, 0.0}));

INSTANTIATE_TEST_SUITE_P(Damped, OneMode,
                         testing::Values(Phase{0.0, 5.0}, Phase{0.0, 1e-9}, Phase{1e-4, 1e-5},
                                         Phase{1e-4, 1e-2}, Phase{0.1, 0.01}, Phase{2.0, 0.3},
                                         Phase{30.0, 1.0}, Phase{300.0, 20.0}));

// About critical damping, two exponentials differ by less and less.
INSTANTIATE_TEST_SUITE_P(Creeping, OneMode,
                         testing::Values(Phase{2.0, 4.0}, Phase{2.0, 4.0 - 1e-12},
                                         Phase{2.0, 4.0 + 1e-12}, Phase{2.0, 4.0 + 1e-9},
                                         Phase{2.0, 4.0 - 1e-7}, Phase{2.0, 4.0 - 4e-7},
                                         Phase{2.0, 4.001}, Phase{2.0, 40.0}, Phase{30.0, 70.0},
                                         Phase{30.0, 300.0}));

// The mode's start, e^{−λt} with λh of 129 to 1e4, is over early in the step; what follows may
// last.
INSTANTIATE_TEST_SUITE_P(StartingEarly, OneMode,
                         testing::Values(Phase{0.0, 129.0}, Phase{100.0, 213.0},
                                         Phase{100.0, 300.0}, Phase{1.0, 500.0}, Phase{100.0, 2e3},
                                         Phase{300.0, 3e3}, Phase{0.0, 1e4}, Phase{1e3, 1e4},
                                         Phase{900.0, 3e3}));

TEST(ModalStep, IsAsLongAsVibrationAndCreepAllow) {
  const Pendulum vibrating(1e5), creeping(1e5, 1e7), critical(1e5, 2e5);
  const double longest = ModalStep::longest(vibrating.modes);
  EXPECT_NEAR(ModalStep::longest(critical.modes) / longest, 1.0, 1e-6);
  EXPECT_NEAR(ModalStep::longest(creeping.modes) / longest, 50.0 + std::sqrt(2499.0), 1e-4);
}

TEST(ModalStep, RefusesAStepItsSeriesCannotHold) {
  const Pendulum pendulum(1e6);
  EXPECT_THROW(ModalStep(pendulum.modes, Collocation::of(8), 1e-3), std::logic_error);
  EXPECT_NO_THROW(
      ModalStep(pendulum.modes, Collocation::of(8), ModalStep::longest(pendulum.modes)));
}

}  // namespace
