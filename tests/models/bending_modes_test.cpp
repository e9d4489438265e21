// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/bending_modes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "models/integration/gauss.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using impactrig::tests::paper_rig;

const Beam beam = paper_rig().beam;

/// √(EI / ρA) / L² [rad/s]
double unit_frequency() {
  return std::sqrt(beam.youngs_modulus * beam.second_moment / (beam.density * beam.area)) /
         (beam.length * beam.length);
}

TEST(BendingModes, OfThePinnedFreeBarHaveThePublishedFrequencies) {
  // roots of tan z = tanh z: check values beam_impact_modal of the project's reference pages
  const double roots[] = {3.926602312047919,  7.068582745628732,  10.210176122813031,
                          13.351768777754094, 16.49336143134641,  19.634954084936208,
                          22.776546738526,    25.918139392115794, 29.059732045705587,
                          32.201324699295384};
  const auto modes = bending_modes(beam, Basis::pinned_free, 10);
  for (std::size_t k = 0; k < 10; ++k)
    EXPECT_NEAR(modes[k].angular_frequency() / (roots[k] * roots[k] * unit_frequency()), 1.0,
                1e-13);
  EXPECT_NEAR(modes[0].angular_frequency(), 902.002049122184, 1e-8 * 902.0);
  EXPECT_NEAR(modes[9].angular_frequency(), 60662.6201343189, 1e-8 * 60662.0);
}

TEST(BendingModes, OfTheCantileverHaveThePublishedFrequencies) {
  // roots of cos z cosh z = −1, which these meet to rounding; [Blevins1979] has their first digits
  const double roots[] = {1.875104068711961, 4.694091132974175, 7.854757438237613,
                          10.995540734875467, 14.137168391046471};
  const auto modes = bending_modes(beam, Basis::cantilever, 5);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_NEAR(modes[k].angular_frequency() / (roots[k] * roots[k] * unit_frequency()), 1.0,
                1e-13);
}

TEST(BendingModes, OfThePinnedFreeBarHaveTheKnownAmplitudeAtTheStruckPoint) {
  const double amplitudes[] = {0.7400478886498589, 0.09280391026663588, 0.4591769664364381,
                               0.8535070594834642, 1.0434504474090402,  1.0108036292767772,
                               0.7724010145686818, 0.37907595189580856, 0.09234469893562927,
                               0.5522890583329767};
  const auto modes = bending_modes(beam, Basis::pinned_free, 10);
  for (std::size_t k = 0; k < 10; ++k)
    EXPECT_NEAR(std::abs(modes[k].at(0.69).value), amplitudes[k], 1e-10);
}

class BendingModesOf : public testing::TestWithParam<Basis> {};

TEST_P(BendingModesOf, HaveUnitModalMassAndAreOrthogonalUpToModeForty) {
  const auto modes = bending_modes(beam, GetParam(), 40);
  const GaussRule rule = gauss_legendre(160);
  const double line_density = beam.density * beam.area;
  const double bending_stiffness = beam.youngs_modulus * beam.second_moment;
  for (std::size_t i = 0; i < modes.size(); ++i)
    for (std::size_t j = i; j < modes.size(); ++j) {
      double mass = 0.0;
      double stiffness = 0.0;
      for (std::size_t g = 0; g < rule.points.size(); ++g) {
        const ModeShape a = modes[i].at(rule.points[g] * beam.length);
        const ModeShape b = modes[j].at(rule.points[g] * beam.length);
        mass += line_density * beam.length * rule.weights[g] * a.value * b.value;
        stiffness += bending_stiffness * beam.length * rule.weights[g] * a.curvature * b.curvature;
      }
      const double omegas = modes[i].angular_frequency() * modes[j].angular_frequency();
      EXPECT_NEAR(mass, i == j ? 1.0 : 0.0, 1e-12) << i << ' ' << j;
      EXPECT_NEAR(stiffness / omegas, i == j ? 1.0 : 0.0, 1e-12) << i << ' ' << j;
    }
}

TEST_P(BendingModesOf, MeetTheirBoundaryConditions) {
  for (const BendingMode& mode : bending_modes(beam, GetParam(), 40)) {
    const double beta = std::sqrt(mode.angular_frequency() / unit_frequency()) / beam.length;
    const double size = 2.0 / std::sqrt(beam.bar_mass());
    const ModeShape hinge = mode.at(0.0);
    const ModeShape tip = mode.at(beam.length);
    EXPECT_NEAR(hinge.value, 0.0, 1e-14 * size);
    if (GetParam() == Basis::cantilever)
      EXPECT_NEAR(hinge.slope, 0.0, 1e-13 * size * beta);
    else
      EXPECT_NEAR(hinge.curvature, 0.0, 1e-13 * size * beta * beta);
    EXPECT_NEAR(tip.curvature, 0.0, 1e-13 * size * beta * beta);
    EXPECT_NEAR(std::abs(tip.value), size, 1e-14 * size);
    // no shear force at the tip: the curvature leaves zero with the square of the distance, since
    // its second derivative there is β⁴ φ
    const double h = 1e-3 / beta;
    EXPECT_NEAR(mode.at(beam.length - h).curvature / (0.5 * h * h * std::pow(beta, 4) * tip.value),
                1.0, 1e-2);
  }
}

TEST_P(BendingModesOf, HaveSlopesAndCurvaturesThatAreDerivatives) {
  for (const BendingMode& mode : bending_modes(beam, GetParam(), 12)) {
    const double beta = std::sqrt(mode.angular_frequency() / unit_frequency()) / beam.length;
    const double h = 1e-3 / beta;
    const auto difference = [&](double x, auto part) {
      const auto central = [&](double s) {
        return (part(mode.at(x + s)) - part(mode.at(x - s))) / (2.0 * s);
      };
      return (4.0 * central(0.5 * h) - central(h)) / 3.0;
    };
    for (double x : {0.1, 0.333, 0.69, 0.79}) {
      const ModeShape shape = mode.at(x);
      EXPECT_NEAR(difference(x, [](const ModeShape& s) { return s.value; }), shape.slope,
                  1e-10 * beta);
      EXPECT_NEAR(difference(x, [](const ModeShape& s) { return s.slope; }), shape.curvature,
                  1e-10 * beta * beta);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothBases, BendingModesOf,
                         testing::Values(Basis::cantilever, Basis::pinned_free),
                         [](const auto& instance) {
                           return instance.param == Basis::cantilever ? "Cantilever" : "PinnedFree";
                         });

TEST(BendingModes, OfThePinnedFreeBarCarryNoMomentOfMomentum) {
  const GaussRule rule = gauss_legendre(160);
  for (const BendingMode& mode : bending_modes(beam, Basis::pinned_free, 40)) {
    double moment = 0.0;
    for (std::size_t g = 0; g < rule.points.size(); ++g)
      moment += rule.weights[g] * rule.points[g] * mode.at(rule.points[g] * beam.length).value;
    EXPECT_NEAR(moment, 0.0, 1e-13);
  }
}

TEST(ElasticCompliance, IsTheStrainEnergyOfTheBarUnderAForceAndItsInertiaLoad) {
  // Bending moment from the free end's side: the unit force at a, less the load 3 a x / L³ of the
  // rigid rotation it causes; C = ∫ M² / EI dx.
  const double length = beam.length;
  const GaussRule rule = gauss_legendre(12);
  for (double a : {0.2, 0.5, 0.69, 0.8}) {
    double expected = 0.0;
    for (const auto& [from, to] : {std::pair{0.0, a}, std::pair{a, length}})
      for (std::size_t g = 0; g < rule.points.size(); ++g) {
        const double x = from + (to - from) * rule.points[g];
        const double load =
            (std::pow(length, 3) - std::pow(x, 3)) / 3.0 - x * (length * length - x * x) / 2.0;
        const double moment = std::max(a - x, 0.0) - 3.0 * a / std::pow(length, 3) * load;
        expected += (to - from) * rule.weights[g] * moment * moment /
                    (beam.youngs_modulus * beam.second_moment);
      }
    EXPECT_NEAR(elastic_compliance(beam, a) / expected, 1.0, 1e-12) << "a = " << a;
    // and the sum over the modes of what each gives way, which grows towards it as 1 / n³
    double sum = 0.0;
    for (const BendingMode& mode : bending_modes(beam, Basis::pinned_free, 100))
      sum += std::pow(mode.at(a).value / mode.angular_frequency(), 2);
    EXPECT_LT(sum, expected);
    EXPECT_NEAR(sum / expected, 1.0, 3e-5) << "a = " << a;
  }
}

}  // namespace
