// SPDX-License-Identifier: BSD-3-Clause
// What the full equations of hybrid coordinates are solved by: unbalanced forces and derivatives.
#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "models/beams/floating_frame.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// A soft bar with everything a hybrid bar can have, far from where it hangs.
Rig rich_rig() {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 1e5;
  rig.gravity = 9.81;
  rig.gravity_direction = -0.7;
  rig.beam.masses = {{0.3, 0.4}, {0.8, 0.5}};
  rig.beam.damping = {.mass = 3.0, .stiffness = 1e-3};
  rig.hinge = {.spring = 2.0, .viscous = 0.3};
  rig.further_stops = {{.contact = rig.contact, .side = StopSide::far}};
  rig.further_stops[0].contact.position = 0.4;
  return rig;
}

Rig shearing_rig() {
  Rig rig = rich_rig();
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.9;
  rig.beam.poisson_ratio = 0.3;
  return rig;
}

struct Scene {
  std::string name;
  Rig rig;
  int bending, axial;

  friend void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }
};

class FrameOf : public testing::TestWithParam<Scene> {
 protected:
  FrameOf() : n(beam.size()) {
    for (Vector* x : {&q, &v, &a}) *x = random_vector();
    q.tail(GetParam().bending) *= 0.05;
    q.segment(1, GetParam().axial) *= 0.02;
    v[0] *= 5.0;
    a *= 20.0;
  }

  Vector random_vector() {
    return Vector::NullaryExpr(
        n, [this] { return std::uniform_real_distribution(-1.0, 1.0)(random_); });
  }

  Vector unbalanced(const Vector& at_q, const Vector& at_v, const Vector& at_a,
                    const Matrix& forces) {
    Vector r(n);
    beam.unbalanced(at_q, at_v, at_a, forces, r);
    return r;
  }

  /// Derivative of f along each coordinate, with an error of the sixth order.
  Matrix differences(const std::function<Vector(const Vector&)>& f, double h) const {
    Matrix slopes(n, n);
    for (int i = 0; i < n; ++i) {
      const auto central = [&](double s) {
        return Vector((f(s * Vector::Unit(n, i)) - f(-s * Vector::Unit(n, i))) / (2.0 * s));
      };
      const Vector wide = central(h), middle = central(0.5 * h), near = central(0.25 * h);
      const Vector first = (4.0 * middle - wide) / 3.0, second = (4.0 * near - middle) / 3.0;
      slopes.col(i) = (16.0 * second - first) / 15.0;
    }
    return slopes;
  }

  FloatingFrameBeam beam{GetParam().rig, Basis::pinned_free, GetParam().bending, GetParam().axial};
  int n;
  Vector q, v, a;
  std::mt19937 random_{27};
  const Matrix free_ = Matrix::Zero(1, 2);
};

TEST_P(FrameOf, TangentIsTheDerivativeOfTheUnbalancedForces) {
  FloatingFrameBeam::Tangent tangent{Matrix(n, n), Matrix(n, n), Matrix(n, n)};
  beam.set_tangent(q, v, a, tangent);
  const Matrix mass =
      -differences([&](const Vector& d) { return unbalanced(q, v, a + d, free_); }, 1.0);
  const Matrix by_q =
      differences([&](const Vector& d) { return unbalanced(q + d, v, a, free_); }, 0.02);
  const Matrix by_v =
      differences([&](const Vector& d) { return unbalanced(q, v + d, a, free_); }, 0.02);
  EXPECT_LE((tangent.mass - mass).norm(), 1e-11 * mass.norm());
  EXPECT_LE((tangent.by_q - by_q).norm(), 1e-9 * by_q.norm());
  EXPECT_LE((tangent.by_v - by_v).norm(), 1e-9 * by_v.norm());
}

TEST_P(FrameOf, AccelerationsLeaveNothingUnbalanced) {
  const Matrix forces = (Matrix(1, 2) << 30.0, 20.0).finished();
  beam.acceleration(q, v, std::vector<double>{30.0, 20.0}, a);
  const double scale = unbalanced(q, v, Vector::Zero(n), forces).norm();
  EXPECT_LT(unbalanced(q, v, a, forces).norm(), 1e-12 * scale);
}

TEST_P(FrameOf, StatesAtOnceAreThoseOneAfterTheOther) {
  const Matrix q3 = q * Eigen::RowVector3d(1.0, -0.5, 0.1),
               v3 = v * Eigen::RowVector3d(0.2, 2.0, 0.0),
               a3 = a * Eigen::RowVector3d(-1.0, 0.0, 3.0);
  const Matrix forces = (Matrix(3, 2) << 3.0, 0.0, 0.0, 7.0, 2.0, 1.0).finished();
  Matrix r(n, 3);
  beam.unbalanced(q3, v3, a3, forces, r);
  Vector energies(3);
  beam.kinetic(q, v3, energies);
  for (int k = 0; k < 3; ++k) {
    const Vector alone = unbalanced(q3.col(k), v3.col(k), a3.col(k), forces.row(k));
    EXPECT_LT((r.col(k) - alone).norm(), 1e-13 * alone.norm()) << k;
    const double energy = beam.energy(q, v3.col(k)).kinetic;
    EXPECT_NEAR(energies[k], energy, 1e-13 * energy) << k;
  }
}

// A force does the work that its point goes.
TEST_P(FrameOf, StopsPressOnWhatMovesTheirPoints) {
  Matrix pressed(n, 2);
  beam.set_pressed(q, pressed);
  for (int i = 0; i < n; ++i) {
    const Vector unit = Vector::Unit(n, i);
    EXPECT_NEAR(pressed(i, 0), -beam.struck_point(q, unit).velocity, 1e-13);
    EXPECT_NEAR(pressed(i, 1), beam.point(0.4, q, unit).velocity, 1e-13);  // from behind
  }
}

TEST_P(FrameOf, AHeldHingeIsBalancedByTheMomentThatHoldsIt) {
  constexpr double stated = 4.0;
  beam.drive({.held = true, .acceleration = stated});
  beam.acceleration(q, v, 0.0, a);
  EXPECT_NEAR(beam.hinge_rate(a), stated, 1e-9);
  Vector r = unbalanced(q, v, a, free_);
  const double scale = r.norm();
  ASSERT_GT(scale, 0.1);
  EXPECT_NEAR(beam.hold_hinge(a, stated, r), beam.holding_moment(),
              1e-11 * std::abs(beam.holding_moment()));
  EXPECT_LT(r.norm(), 1e-11 * scale);

  FloatingFrameBeam::Tangent tangent{Matrix(n, n), Matrix(n, n), Matrix(n, n)};
  beam.set_tangent(q, v, a, tangent);
  beam.hold_hinge(tangent);
  const auto held = [&](const Vector& at_q, const Vector& at_v, const Vector& at_a) {
    Vector left = unbalanced(at_q, at_v, at_a, free_);
    beam.hold_hinge(at_a, stated, left);
    return left;
  };
  const Matrix mass = -differences([&](const Vector& d) { return held(q, v, a + d); }, 1.0);
  const Matrix by_q = differences([&](const Vector& d) { return held(q + d, v, a); }, 0.02);
  const Matrix by_v = differences([&](const Vector& d) { return held(q, v + d, a); }, 0.02);
  EXPECT_LE((tangent.mass - mass).norm(), 1e-11 * mass.norm());
  EXPECT_LE((tangent.by_q - by_q).norm(), 1e-9 * by_q.norm());
  EXPECT_LE((tangent.by_v - by_v).norm(), 1e-9 * by_v.norm());
}

INSTANTIATE_TEST_SUITE_P(Bars, FrameOf,
                         testing::Values(Scene{"Rigid", rich_rig(), 0, 0},
                                         Scene{"Stretching", rich_rig(), 0, 2},
                                         Scene{"Bending", rich_rig(), 5, 0},
                                         Scene{"Both", rich_rig(), 4, 2},
                                         Scene{"Shearing", shearing_rig(), 3, 1}),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
