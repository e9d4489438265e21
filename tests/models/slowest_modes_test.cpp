// SPDX-License-Identifier: BSD-3-Clause
// The slowest modes of a mesh by Lanczos' method: against the dense eigenproblem of the same mesh.
#include "models/beams/slowest_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "tests/models/scenes.hpp"
#include "tests/models/timoshenko_bar.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

void expect_those_of_the_dense_problem(const Rig& rig, int elements, int held, int count) {
  const LinearBar bar(rig, bar_elements(rig.beam, rig.beam.length, {elements, 0}));
  const SmallMotion motion = bar.small_motion();
  const Eigen::Index n = bar.size() - held;
  const Eigen::MatrixXd mass = motion.mass.bottomRightCorner(n, n);
  const Eigen::MatrixXd stiffness = motion.stiffness.bottomRightCorner(n, n);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense(stiffness, mass);

  const SlowestModes modes = slowest_modes(bar, held, count);

  ASSERT_EQ(modes.omega.size(), count);
  ASSERT_EQ(modes.shapes.rows(), n);
  const Eigen::MatrixXd modal = modes.shapes.transpose() * mass * modes.shapes;
  EXPECT_LT((modal - Eigen::MatrixXd::Identity(count, count)).cwiseAbs().maxCoeff(), 1e-12);
  // what rounding of the matrices leaves of any square, by this method or the dense one
  const double rounding =
      10.0 * std::numeric_limits<double>::epsilon() * dense.eigenvalues()[n - 1];
  const int skipped = 1 - held;  // the rotation
  for (int k = 0; k < skipped; ++k) EXPECT_LT(modes.omega[k], 1e-3 * modes.omega[k + 1]);
  for (int k = skipped; k < count; ++k) {
    const Eigen::VectorXd shape = modes.shapes.col(k);
    const double square = modes.omega[k] * modes.omega[k];
    EXPECT_NEAR(square, dense.eigenvalues()[k], 1e-11 * square + rounding) << k;
    EXPECT_NEAR(square, shape.dot(stiffness * shape), 1e-11 * square + rounding) << k;
    EXPECT_NEAR(std::abs(dense.eigenvectors().col(k).dot(mass * shape)), 1.0, 1e-12) << k;
  }
}

Rig stepped(double second_moment, double area) {
  Rig rig = shearing(0.06);
  const Beam& beam = rig.beam;
  rig.beam.segments = {{0.3, beam.area, beam.second_moment, beam.shear_coefficient},
                       {beam.length - 0.3, area * beam.area, second_moment * beam.second_moment,
                        beam.shear_coefficient}};
  return rig;
}

TEST(SlowestModes, AreThoseOfTheDenseProblem) {
  for (const int held : {0, 1}) {
    expect_those_of_the_dense_problem(shearing(0.06), 36, held, 2 - held);
    expect_those_of_the_dense_problem(shearing(0.06), 96, held, 17 - held);
    expect_those_of_the_dense_problem(shearing(0.001), 96, held, 17 - held);  // hardly shears
    expect_those_of_the_dense_problem(stepped(30.0, 4.0), 96, held, 17 - held);
    expect_those_of_the_dense_problem(stepped(0.001, 0.02), 96, held, 17 - held);
    Rig slender = stepped(30.0, 4.0);
    slender.beam.theory = BeamTheory::euler_bernoulli;
    expect_those_of_the_dense_problem(slender, 96, held, 17 - held);
  }
}

TEST(SlowestModes, CanBeNearlyAllThereAre) {
  expect_those_of_the_dense_problem(shearing(0.06), 2, 0, 9);
}

}  // namespace
