// SPDX-License-Identifier: BSD-3-Clause
// Shear and rotary inertia: against closed forms of Timoshenko's bar, in elements and in modes.
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <functional>
#include <vector>

#include "models/beams/assumed_modes.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/beams/linear_bar.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"
#include "tests/models/timoshenko_bar.hpp"
#include "tests/models/virtual_work.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::HasSubstr;
using testing::ThrowsMessage;

Eigen::VectorXd frequencies(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, mass)
      .eigenvalues()
      .cwiseMax(0.0)
      .cwiseSqrt();
}

LinearBar mesh(const Rig& rig, int elements) {
  return LinearBar(rig, bar_elements(rig.beam, rig.beam.length, {elements, 0}));
}

TEST(BarElement, IsHermitesWhereNothingShears) {
  const BarElement element{.length = 0.7, .bending_stiffness = 3.0, .line_density = 2.0};
  const double l = element.length;
  Eigen::Matrix4d m, k;
  m << 156.0, 22.0 * l, 54.0, -13.0 * l, 22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l, 54.0,
      13.0 * l, 156.0, -22.0 * l, -13.0 * l, -3.0 * l * l, -22.0 * l, 4.0 * l * l;
  k << 12.0, 6.0 * l, -12.0, 6.0 * l, 6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l, -12.0, -6.0 * l,
      12.0, -6.0 * l, 6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l;
  EXPECT_LT((element.mass().topLeftCorner<4, 4>() - 2.0 * l / 420.0 * m).norm(), 1e-15 * m.norm());
  EXPECT_LT((element.stiffness().topLeftCorner<4, 4>() - 3.0 / (l * l * l) * k).norm(),
            1e-14 * k.norm());
  for (const double xi : {0.0, 0.3, 1.0})
    EXPECT_LT((element.rotation(xi) - element.slope(xi)).norm(), 1e-15);
}

// The strain energy of the interpolated field is that of the matrix, w' is the derivative of w, and
// a rigid rotation is one.
TEST(BarElement, FieldAndMatrixAgree) {
  const BarElement element{
      .length = 0.7, .bending_stiffness = 3.0, .shear_compliance = 0.2, .rotary_inertia = 1.5};
  BarElement::Shape u, rigid;
  u << 0.3, -0.8, 1.1, 0.4, 0.7, -0.5, 0.6;
  rigid << 1.0, 2.0, 2.4, 2.0, 0.0, 0.0, 0.0;
  const double step = 1e-4;
  double energy = 0.0;
  const int panels = 2000;
  for (int i = 0; i < panels; ++i) {
    const double xi = (i + 0.5) / panels;
    const double bent =
        (element.rotation(xi + step) - element.rotation(xi - step)).dot(u) / (2.0 * step * 0.7);
    const double slope =
        (element.deflection(xi + step) - element.deflection(xi - step)).dot(u) / (2.0 * step * 0.7);
    EXPECT_NEAR(element.slope(xi).dot(u), slope, 1e-6);
    EXPECT_NEAR(element.deflection(xi).dot(rigid), 1.0 + 1.4 * xi, 1e-14);
    EXPECT_NEAR(element.rotation(xi).dot(rigid), 2.0, 1e-14);
    const double sheared = slope - element.rotation(xi).dot(u);
    energy += 0.5 * 0.7 / panels * (3.0 * bent * bent + sheared * sheared / 0.2);
  }
  EXPECT_NEAR(0.5 * u.dot(element.stiffness() * u) / energy, 1.0, 1e-6);
}

TEST(BarElement, HoldsEveryCubicDeflectionWithEveryQuadraticRotation) {
  const BarElement element{
      .length = 0.7, .bending_stiffness = 3.0, .shear_compliance = 0.2, .rotary_inertia = 1.5};
  BarElement::Matrix values;  // w at four places, θ at three
  for (int i = 0; i < 4; ++i) values.row(i) = element.deflection(i / 3.0).transpose();
  for (int i = 0; i < 3; ++i) values.row(4 + i) = element.rotation(i / 2.0).transpose();
  EXPECT_EQ(values.fullPivLu().rank(), 7);
  // elastic energy of the three inside apart from each other and from the nodes'
  const BarElement::Matrix k = element.stiffness();
  const auto energy = [&](const BarElement::Shape& u) { return 0.5 * u.dot(k * u); };
  for (int i = 4; i < 7; ++i) {
    const BarElement::Shape own = BarElement::Shape::Unit(i);
    const BarElement::Shape other = BarElement::Shape::Ones() - own;
    EXPECT_NEAR(energy(own + other) / (energy(own) + energy(other)), 1.0, 1e-14) << i;
  }
}

TEST(Timoshenko, ATipLoadBendsAndShearsACantilever) {
  const Rig rig = shearing(0.08);
  const Constants c(rig.beam);
  const double length = rig.beam.length;
  for (const int elements : {1, 7}) {
    const LinearBar bar = mesh(rig, elements);
    const Eigen::MatrixXd k = bar.small_motion().stiffness;
    const Eigen::Index n = k.rows() - 1;  // clamped: the section at the hinge does not turn
    const Eigen::Index tip = bar.places(bar.elements().size() - 1)[2] - 1;
    const Eigen::VectorXd load = Eigen::VectorXd::Unit(n, tip);
    const double expected = std::pow(length, 3) / (3.0 * c.bending) + length / c.shear;
    EXPECT_NEAR(k.bottomRightCorner(n, n).lu().solve(load)[tip] / expected, 1.0, 1e-12);
  }
}

// k = nπ/L: (κGA k² − ρA ω²)(EI k² + κGA − ρI ω²) = (κGA k)², both spectra.
TEST(Timoshenko, PinnedAtBothEndsHasTheClosedFormsOfBothSpectra) {
  const Rig rig = shearing(0.08);
  const Constants c(rig.beam);
  const auto error = [&](int elements, int number, bool second) {
    const LinearBar bar = mesh(rig, elements);
    const SmallMotion motion = bar.small_motion();
    const int tip = bar.places(bar.elements().size() - 1)[2];
    std::vector<int> kept;
    for (int i = 0; i < motion.mass.rows(); ++i)
      if (i != tip) kept.push_back(i);
    const auto held = [&](const Eigen::MatrixXd& matrix) -> Eigen::MatrixXd {
      return matrix(kept, kept);
    };
    const Eigen::VectorXd omega = frequencies(held(motion.stiffness), held(motion.mass));
    const double k = number * std::numbers::pi / rig.beam.length;
    const double a = c.line * c.rotary;
    const double b = c.line * (c.bending * k * k + c.shear) + c.rotary * c.shear * k * k;
    const double d = c.bending * c.shear * std::pow(k, 4);
    const double root = std::sqrt(b * b - 4.0 * a * d);
    const double exact =
        second ? std::sqrt((b + root) / (2.0 * a)) : std::sqrt(2.0 * d / (b + root));
    return ((omega.array() / exact) - 1.0).cwiseAbs().minCoeff();
  };
  for (int number = 1; number <= 4; ++number)
    EXPECT_NEAR(error(16, number, false) / error(32, number, false), 16.0, 2.0) << number;
  EXPECT_LT(error(32, 1, false), 1e-6);
  EXPECT_NEAR(error(16, 1, true) / error(32, 1, true), 16.0, 2.0);
}

TEST(Timoshenko, ElementsConvergeToThePinnedFreeFrequencies) {
  for (const double radius : {0.015, 0.06}) {
    const Rig rig = shearing(radius);
    const std::vector<double> exact = pinned_free_frequencies(rig.beam, 4);
    ASSERT_EQ(exact.size(), 4u);
    const LinearBar coarse = mesh(rig, 16), fine = mesh(rig, 32);
    const ModalBeam few(coarse, rig), many(fine, rig);
    for (int k = 1; k <= 4; ++k) {
      const double omega = exact[static_cast<std::size_t>(k) - 1];
      const double error = many.omega()[k] / omega - 1.0;
      EXPECT_GT(error, -1e-9) << radius << ' ' << k;
      EXPECT_LT(error, 1e-4) << radius << ' ' << k;
      if (error < 1e-7) continue;  // its digits are rounding
      EXPECT_NEAR((few.omega()[k] / omega - 1.0) / error, 16.0, 2.0) << radius << ' ' << k;
    }
  }
}

// What shear and rotary inertia take of a slender bar's frequency is of the order (r/L)².
TEST(Timoshenko, IsEulerBernoulliForASlenderBar) {
  const auto lowered = [](double radius) {
    const Rig rig = shearing(radius);
    return 1.0 - pinned_free_frequencies(rig.beam, 1)[0] /
                     BendingMode(rig.beam, Basis::pinned_free, 1).angular_frequency();
  };
  EXPECT_NEAR(lowered(0.016) / lowered(0.008), 4.0, 0.02);
  EXPECT_NEAR(lowered(0.008) / lowered(0.004), 4.0, 0.005);
  Rig rig = shearing(0.015);
  rig.beam.shear_coefficient = 1e9;
  const LinearBar bar = mesh(rig, 8);
  std::vector<int> nodes = {0};
  for (std::size_t e = 0; e < 8; ++e) {
    nodes.push_back(bar.places(e)[2]);
    nodes.push_back(bar.places(e)[3]);
  }
  const Eigen::MatrixXd stiff = bar.small_motion().stiffness(nodes, nodes);
  rig.beam.theory = BeamTheory::euler_bernoulli;
  EXPECT_LT((stiff - mesh(rig, 8).small_motion().stiffness).norm(), 1e-6 * stiff.norm());
}

TEST(AssumedModes, OfABarThatShearsHaveItsFrequencies) {
  const Rig rig = shearing(0.06);
  const std::vector<double> exact = pinned_free_frequencies(rig.beam, 5);
  const AssumedModes modes(rig.beam, Basis::pinned_free, 5);
  for (int k = 0; k < 5; ++k) {
    const double error = modes.omega()[k] / exact[static_cast<std::size_t>(k)] - 1.0;
    EXPECT_GT(error, 0.0) << k;
    EXPECT_LT(error, 1e-4 * std::pow((k + 1) / 5.0, 3)) << k;
  }
  // clamped shapes in a frame that turns: many make the pinned bar's
  const FloatingFrameBeam clamped(rig, Basis::cantilever, 12, 0);
  const ModalBeam turned(clamped, rig);
  EXPECT_NEAR(turned.omega()[1] / exact[0], 1.0, 3e-4);
}

/// 1 / ω² of a bar's elastic modes, weighed by the struck point: what a static force bends there.
double modal_compliance(const ModalBeam& modes) {
  double sum = 0.0;
  for (int k = 1; k < modes.modes(); ++k) sum += std::pow(modes.struck()[k] / modes.omega()[k], 2);
  return sum;
}

TEST(ElasticCompliance, OfABarThatShearsIsTheSumOfItsModes) {
  for (const double position : {0.3, 0.8}) {
    Rig rig = shearing(0.06);
    rig.contact.position = position;
    rig.beam.masses = {{0.55, 3.0}};  // on a node, like the struck point
    const LinearBar bar(
        rig, bar_elements(rig.beam, position, {position < 0.8 ? 40 : 80, position < 0.8 ? 40 : 0}));
    const ModalBeam modes(bar, rig);
    EXPECT_NEAR(elastic_compliance(rig.beam, position) / modal_compliance(modes), 1.0, 1e-6);
  }
}

TEST(Beam, HasTheRotaryInertiaOfItsSections) {
  const Beam beam = shearing(0.06).beam;
  Beam plain = beam;
  plain.theory = BeamTheory::euler_bernoulli;
  EXPECT_NEAR(beam.hinge_inertia() / plain.hinge_inertia(), 1.0 + 3.0 * 0.0036 / 4.0 / 0.64, 1e-14);
  EXPECT_DOUBLE_EQ(beam.first_moment(), plain.first_moment());
  const Rig rig = shearing(0.06);
  const LinearBar bar = mesh(rig, 3);
  const SmallMotion motion = bar.small_motion();
  EXPECT_NEAR(motion.rigid.dot(motion.mass * motion.rigid) / beam.hinge_inertia(), 1.0, 1e-14);
}

// The frame's forces do no work that its energy does not show: dE/dt along a motion of the free
// bar.
TEST(FloatingFrame, KeepsTheEnergyOfABarThatShears) {
  Rig rig = shearing(0.06);
  rig.beam.youngs_modulus = 1e7;
  rig.gravity = 9.81;
  rig.hinge.spring = 3.0;
  for (const Basis basis : {Basis::cantilever, Basis::pinned_free}) {
    FloatingFrameBeam beam(rig, basis, 3, 1);
    const RandomState s = random_state(beam, 7, 0.8, 0.02);
    Vector a(beam.size());
    beam.acceleration(s.q, s.v, 0.0, a);
    const auto energy = [&](double time) {
      const BeamEnergy e = beam.energy(s.q + time * s.v, s.v + time * a);
      return e.kinetic + e.elastic + e.spring + e.gravitational;
    };
    const double step = 1e-5;
    const double scale = beam.energy(s.q, s.v).kinetic / 0.1;
    EXPECT_NEAR((energy(step) - energy(-step)) / (2.0 * step) / scale, 0.0, 1e-6);
  }
}

TEST(Simulate, BarsThatShearAgreeWhateverTheirModel) {
  const Rig rig = shearing(0.03);
  const Simulation mesh = simulate(rig, ancf(48, 8, 1e-4, 1e-3));
  const Simulation modes = simulate(rig, hybrid(Basis::pinned_free, 40, 1e-4, 1e-3));
  ASSERT_TRUE(mesh.small_motion);
  EXPECT_NEAR(modes.peak_force / mesh.peak_force, 1.0, 5e-3);
  SimulationOptions exact;
  exact.exact = true;
  const Simulation full = simulate(rig, hybrid(Basis::pinned_free, 12, 1e-6, 1e-3), exact);
  const Simulation small = simulate(rig, hybrid(Basis::pinned_free, 12, 1e-4, 1e-3));
  ASSERT_TRUE(small.small_motion);
  EXPECT_NEAR(full.peak_force / small.peak_force, 1.0, 1e-4);
  EXPECT_LT(std::abs(full.energy.imbalance), 1e-6);
}

// An undamped rigid bar rebounds as fast as it came.
TEST(Simulate, ARigidBarHasRotaryInertia) {
  const Rig rig = shearing(0.1);
  const Simulation run = simulate(rig, rigid(1e-8));
  EXPECT_NEAR(run.impulse / (2.0 * effective_mass(rig) * rig.start.velocity), 1.0, 1e-7);
  Rig plain = rig;
  plain.beam.theory = BeamTheory::euler_bernoulli;
  EXPECT_GT(effective_mass(rig), 1.01 * effective_mass(plain));
}

TEST(Validate, RefusesShearThatCannotBe) {
  Rig rig = shearing(0.015);
  rig.beam.shear_coefficient = 0.0;
  EXPECT_THAT([&] { validate(rig, Solver{}); },
              ThrowsMessage<std::invalid_argument>(
                  "beam.shear_coefficient: must be greater than zero, found 0"));
  rig = shearing(0.015);
  rig.beam.poisson_ratio = 0.7;
  EXPECT_THAT([&] { validate(rig, Solver{}); },
              ThrowsMessage<std::invalid_argument>(
                  "beam.poisson_ratio: must lie between -1 and 0.5, found 0.7"));
}

}  // namespace
