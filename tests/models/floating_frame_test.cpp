// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/floating_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "models/integration/dop853.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;
using Complex = std::complex<double>;
using ComplexVector = Eigen::VectorXcd;

/// The bar once more, straight from Shen et al. (1)-(4): positions with H(x) by cumulative
/// quadrature, velocities by complex step, kinetic energy by integrating |dr/dt|², and Lagrange's
/// equations by differences of that. Shares the mode shapes with the code under test, nothing else.
class PlainBar {
 public:
  PlainBar(const Rig& rig, Basis basis, int modes, int axial_modes)
      : rig_(rig),
        bending_(modes),
        axial_(axial_modes) {
    const auto shapes = bending_modes(rig.beam, basis, modes);
    constexpr double points[5] = {-0.906179845938664, -0.538469310105683, 0.0, 0.538469310105683,
                                  0.906179845938664};
    constexpr double weights[5] = {0.236926885056189, 0.478628670499366, 0.568888888888889,
                                   0.478628670499366, 0.236926885056189};
    const int panels = 40;
    const double panel = rig.beam.length / panels;
    const auto outer = [&](double x) {
      Vector slope(modes);
      for (int k = 0; k < modes; ++k) slope[k] = shapes[static_cast<std::size_t>(k)].at(x).slope;
      return Eigen::MatrixXd(slope * slope.transpose());
    };
    const auto integral = [&](double from, double to) {
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(modes, modes);
      for (int g = 0; g < 5; ++g)
        sum += 0.5 * (to - from) * weights[g] *
               outer(0.5 * (from + to) + 0.5 * (to - from) * points[g]);
      return sum;
    };
    const auto section = [&](double x, double mass, const Eigen::MatrixXd& coupling) {
      Section s{x, mass, Vector(modes), Vector(axial_modes), coupling, 0.0};
      for (int k = 0; k < modes; ++k)
        s.bending[k] = shapes[static_cast<std::size_t>(k)].at(x).value;
      for (int k = 0; k < axial_modes; ++k)
        s.axial[k] = std::sqrt(2.0 / rig.beam.bar_mass()) *
                     std::sin((k + 0.5) * std::numbers::pi * x / rig.beam.length);
      return s;
    };
    Eigen::MatrixXd reached = Eigen::MatrixXd::Zero(modes, modes);
    for (int p = 0; p < panels; ++p) {
      for (int g = 0; g < 5; ++g) {
        const double x = panel * (p + 0.5 + 0.5 * points[g]);
        sections_.push_back(section(x, rig.beam.density * rig.beam.area * 0.5 * panel * weights[g],
                                    reached + integral(panel * p, x)));
      }
      reached += integral(panel * p, panel * (p + 1));
    }
    const auto point = [&](double x, double mass) {
      Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(modes, modes);
      const double step = x / panels;
      for (int p = 0; p < panels; ++p) coupling += integral(step * p, step * (p + 1));
      return section(x, mass, coupling);
    };
    struck_ = point(rig.contact.position, 0.0);
    for (const LumpedMass& lump : rig.beam.masses)
      sections_.push_back(point(lump.position, lump.mass));
    for (int k = 0; k < modes; ++k)
      stiffness_.push_back(std::pow(shapes[static_cast<std::size_t>(k)].angular_frequency(), 2));
  }

  /// Horizontal position of the struck point in the inertial frame.
  Complex struck(const ComplexVector& q) const { return position(struck_, q)[0]; }

  double kinetic(const Vector& q, const Vector& v) const {
    constexpr double h = 1e-30;
    const ComplexVector moved = q.cast<Complex>() + Complex(0.0, h) * v.cast<Complex>();
    double sum = 0.0;
    for (const Section& s : sections_) {
      const auto r = position(s, moved);
      sum += 0.5 * s.mass * (std::pow(r[0].imag() / h, 2) + std::pow(r[1].imag() / h, 2));
    }
    return sum;
  }

  Complex potential(const ComplexVector& q) const {
    Complex sum = 0.0;
    const double sine = std::sin(rig_.gravity_direction), cosine = std::cos(rig_.gravity_direction);
    for (const Section& s : sections_) {
      const auto r = position(s, q);
      sum += s.mass * rig_.gravity * (cosine * r[1] + sine * r[0]);
    }
    const double wave = std::sqrt(rig_.beam.youngs_modulus / rig_.beam.density);
    for (int k = 0; k < axial_; ++k)
      sum += 0.5 * std::pow(wave * (k + 0.5) * std::numbers::pi / rig_.beam.length, 2) * q[1 + k] *
             q[1 + k];
    for (int k = 0; k < bending_; ++k)
      sum += 0.5 * stiffness_[static_cast<std::size_t>(k)] * q[1 + axial_ + k] * q[1 + axial_ + k];
    return sum;
  }

  /// Left side less right side of Lagrange's equation of coordinate k under a horizontal force.
  double residual(int k, const Vector& q, const Vector& v, const Vector& a, double force) const {
    Vector unit = Vector::Zero(q.size());
    unit[k] = 1.0;
    // kinetic energy is quadratic in v: this difference is ∂T/∂v_k itself
    const auto momentum = [&](double t) {
      const Vector qt = q + t * v + 0.5 * t * t * a;
      const Vector vt = v + t * a;
      return 0.5 * (kinetic(qt, vt + unit) - kinetic(qt, vt - unit));
    };
    const auto moved = [&](double s) { return kinetic(q + s * unit, v); };
    const double momentum_rate = difference(momentum, 1e-3 / (1.0 + a.norm() / 10.0 + v.norm()));
    const double slope = difference(moved, 2e-3);
    constexpr double h = 1e-30;
    const ComplexVector nudged = q.cast<Complex>() + Complex(0.0, h) * unit.cast<Complex>();
    // closing is −X, so the stop pushes towards +X
    return momentum_rate - slope + potential(nudged).imag() / h - force * struck(nudged).imag() / h;
  }

 private:
  struct Section {
    double x, mass;
    Vector bending, axial;
    Eigen::MatrixXd coupling;
    double unused;
  };

  std::array<Complex, 2> position(const Section& s, const ComplexVector& q) const {
    const ComplexVector b = q.tail(bending_);
    Complex along = s.x;
    for (int k = 0; k < axial_; ++k) along += s.axial[k] * q[1 + k];
    for (int i = 0; i < bending_; ++i)
      for (int j = 0; j < bending_; ++j) along -= 0.5 * b[i] * s.coupling(i, j) * b[j];
    Complex across = 0.0;
    for (int k = 0; k < bending_; ++k) across += s.bending[k] * b[k];
    const Complex theta = q[0] - 0.5 * std::numbers::pi;  // as in the paper
    return {std::cos(theta) * along - std::sin(theta) * across,
            std::sin(theta) * along + std::cos(theta) * across};
  }

  /// First derivative at 0 with an error of order h⁶.
  template <typename Function>
  static double difference(const Function& f, double h) {
    const auto central = [&](double s) { return (f(s) - f(-s)) / (2.0 * s); };
    const double a = central(h), b = central(0.5 * h), c = central(0.25 * h);
    const double ab = (4.0 * b - a) / 3.0, bc = (4.0 * c - b) / 3.0;
    return (16.0 * bc - ab) / 15.0;
  }

  Rig rig_;
  int bending_, axial_;
  std::vector<Section> sections_;
  std::vector<double> stiffness_;
  Section struck_;
};

/// A soft bar, so that its deflections are large without its forces drowning everything else.
Rig soft_rig() {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 1e5;
  rig.gravity = 9.81;
  return rig;
}

Rig laden_rig() {
  Rig rig = soft_rig();
  rig.beam.masses = {{0.3, 0.4}, {0.8, 0.5}};
  rig.gravity_direction = -0.7;
  return rig;
}

/// Of three bending and two axial modes, by numbers of [-1, 1].
template <typename Draw>
Vector large_deflection(const Draw& draw) {
  Vector q(6);
  for (int i = 0; const double largest : {1.5, 0.02, 0.01, 0.1, 0.04, 0.02})
    q[i++] = largest * draw();
  return q;
}

class FloatingFrame : public testing::TestWithParam<Basis> {};

TEST_P(FloatingFrame, AccelerationsFulfilLagrangesEquationsAtLargeDeflections) {
  const Rig rig = laden_rig();
  FloatingFrameBeam beam(rig, GetParam(), 3, 2);
  const PlainBar plain(rig, GetParam(), 3, 2);
  std::mt19937 random(20061);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 6; ++trial) {
    const Vector q = large_deflection([&] { return unit(random); });
    Vector v(6), a(6);
    v << 5.0 * unit(random), 0.3 * unit(random), 0.3 * unit(random), unit(random), unit(random),
        unit(random);
    const double force = trial % 2 == 0 ? 0.0 : 30.0;
    beam.acceleration(q, v, force, a);
    double scale = 1.0;
    const Vector nothing = Vector::Zero(6);
    for (int k = 0; k < 6; ++k)
      scale = std::max(scale, std::abs(plain.residual(k, q, v, nothing, force)));
    for (int k = 0; k < 6; ++k)
      EXPECT_NEAR(plain.residual(k, q, v, a, force) / scale, 0.0, 1e-8)
          << "trial " << trial << ", coordinate " << k;
  }
}

TEST_P(FloatingFrame, UnbalancedForcesAreWhatLagrangesEquationsLack) {
  const Rig rig = laden_rig();
  FloatingFrameBeam beam(rig, GetParam(), 3, 2);
  const PlainBar plain(rig, GetParam(), 3, 2);
  std::mt19937 random(20062);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Eigen::MatrixXd q(6, 4), v(6, 4), a(6, 4), unbalanced(6, 4);
  const Vector forces = Eigen::Vector4d(0.0, 30.0, -5.0, 1.0);
  for (int k = 0; k < 4; ++k) {
    q.col(k) = large_deflection([&] { return unit(random); });
    for (int i = 0; i < 6; ++i) {
      v(i, k) = 2.0 * unit(random);
      a(i, k) = 10.0 * unit(random);
    }
  }
  beam.unbalanced(q, v, a, forces, unbalanced);
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 6; ++i)
      EXPECT_NEAR(unbalanced(i, k), -plain.residual(i, q.col(k), v.col(k), a.col(k), forces[k]),
                  1e-8 * unbalanced.col(k).norm())
          << "state " << k << ", coordinate " << i;
}

TEST_P(FloatingFrame, EnergiesAndPointsAgreeWithThePositionsThemselves) {
  const Rig rig = laden_rig();
  FloatingFrameBeam beam(rig, GetParam(), 3, 2);
  const PlainBar plain(rig, GetParam(), 3, 2);
  Vector q(6), v(6);
  q << 0.7, 0.01, -0.02, 0.09, -0.03, 0.01;
  v << -3.0, 0.2, 0.1, 0.8, -0.5, 1.0;
  const BeamEnergy energy = beam.energy(q, v);
  EXPECT_NEAR(energy.kinetic / plain.kinetic(q, v), 1.0, 1e-11);
  const Complex rest = plain.potential(ComplexVector::Zero(6));
  EXPECT_NEAR(
      (energy.elastic + energy.gravitational) / (plain.potential(q.cast<Complex>()) - rest).real(),
      1.0, 1e-11);
  constexpr double h = 1e-30;
  const Complex moved = plain.struck(q.cast<Complex>() + Complex(0.0, h) * v.cast<Complex>());
  EXPECT_NEAR(beam.struck_point(q, v).displacement, -moved.real(), 1e-12);
  EXPECT_NEAR(beam.struck_point(q, v).velocity, -moved.imag() / h, 1e-11);
  const PointMotion same = beam.point(rig.contact.position, q, v);
  EXPECT_EQ(same.displacement, beam.struck_point(q, v).displacement);
  // and a point a hair away, which takes the other way through the code
  const PointMotion near = beam.point(rig.contact.position + 1e-9, q, v);
  EXPECT_NEAR(near.displacement, same.displacement, 1e-8);
  EXPECT_NEAR(near.velocity, same.velocity, 1e-7);
}

// Of a short way the displacement's Taylor series says the same; a difference of two displacements
// has none of its digits left at the last of these.
TEST_P(FloatingFrame, AdvanceOfAPointHasAllDigitsOfTheWay) {
  FloatingFrameBeam beam(soft_rig(), GetParam(), 3, 2);
  Vector q(6), way(6);
  q << 0.7, 0.01, -0.02, 0.09, -0.03, 0.01;
  way << -0.3, 0.02, 0.01, 0.08, -0.05, 0.1;
  EXPECT_NEAR(beam.struck_advance(q, way),
              beam.struck_point(q + way, way).displacement - beam.struck_point(q, way).displacement,
              1e-14);
  const Vector none = Vector::Zero(6);
  for (const double part : {1e-6, 1e-11, 1e-16}) {
    const double remainder = part * part + 1e-14;
    EXPECT_NEAR(beam.struck_advance(q, part * way) / part /
                    (beam.struck_point(q, way).velocity +
                     0.5 * part * beam.struck_acceleration(q, way, none)),
                1.0, remainder);
    EXPECT_NEAR(beam.point_advance(0.3, q, part * way) / part /
                    (beam.point(0.3, q, way).velocity +
                     0.5 * part * beam.point_acceleration(0.3, q, way, none)),
                1.0, remainder);
  }
}

// Of a bar that moves little it is quadratic, and far smaller than a rounded place times the
// weight.
TEST_P(FloatingFrame, GravitationalEnergyOfASlowBarHasAllDigits) {
  Rig rig = soft_rig();
  rig.gravity = 9.81;
  rig.gravity_direction = 0.0;
  FloatingFrameBeam beam(rig, GetParam(), 3, 2);
  Vector q(6);
  q << 0.7, 0.0, 0.0, 0.09, -0.03, 0.01;
  const auto energy = [&](double part) {
    return beam.energy(part * q, Vector::Zero(6)).gravitational;
  };
  ASSERT_GT(energy(1e-4), 0.0);
  for (const double part : {1e-7, 1e-9, 1e-12})
    EXPECT_NEAR(energy(part) / (part * part) / (energy(1e-4) / 1e-8), 1.0, 1e-7) << part;
}

TEST_P(FloatingFrame, AccelerationOfTheStruckPointIsTheRateOfItsVelocity) {
  FloatingFrameBeam beam(soft_rig(), GetParam(), 3, 2);
  Vector q(6), v(6), a(6);
  q << 0.7, 0.01, -0.02, 0.09, -0.03, 0.01;
  v << -3.0, 0.2, 0.1, 0.8, -0.5, 1.0;
  a << 20.0, -3.0, 2.0, -9.0, 4.0, 5.0;
  const auto speed = [&](double t) {
    return beam.struck_point(q + t * v + 0.5 * t * t * a, v + t * a).velocity;
  };
  const auto central = [&](double h) { return (speed(h) - speed(-h)) / (2.0 * h); };
  EXPECT_NEAR(beam.struck_acceleration(q, v, a), (4.0 * central(5e-4) - central(1e-3)) / 3.0, 1e-8);
}

TEST_P(FloatingFrame, FreeSwingConservesItsEnergyWithTheOrderOfTheMethod) {
  const Rig rig = soft_rig();
  FloatingFrameBeam beam(rig, GetParam(), 2, 0);
  const int n = beam.size();
  const Dop853::RightHandSide f = [&](double, const Vector& y, Eigen::Ref<Vector> slope) {
    slope.head(n) = y.tail(n);
    beam.acceleration(y.head(n), y.tail(n), 0.0, slope.tail(n));
  };
  const auto total = [&](const Vector& y) {
    const BeamEnergy e = beam.energy(y.head(n), y.tail(n));
    return e.kinetic + e.elastic + e.gravitational;
  };
  Vector start = Vector::Zero(2 * n);
  beam.set_rigid_motion(-1.2, 2.0, start.head(n), start.tail(n));
  ConvergenceStudy study;
  for (int steps = 8; steps <= 40; steps += 4) {
    Dop853 stepper(2 * n);
    stepper.start(0.0, start, f);
    for (int i = 0; i < steps; ++i) {
      stepper.attempt(0.6 / steps, Vector::Ones(2 * n), f);
      stepper.accept();
    }
    const double error = std::abs(total(stepper.state()) / total(start) - 1.0);
    if (error < 1e-12) break;  // rounding
    study.add(0.6 / steps, error);
  }
  ASSERT_GE(study.size(), 4u);
  EXPECT_GT(study.order(), 7.5);
  EXPECT_GT(study.correlation(), 0.97);
}

TEST_P(FloatingFrame, RigidMotionTurnsEveryPointAtTheSameRate) {
  FloatingFrameBeam beam(paper_rig(), GetParam(), 4, 1);
  Vector q(6), v(6);
  beam.set_rigid_motion(-0.3, 2.5, q, v);
  for (double x : {0.1, 0.4, 0.69, 0.8}) {
    const PointMotion p = beam.point(x, q, v);
    EXPECT_NEAR(p.displacement, -x * std::sin(0.3), 1e-15);
    EXPECT_NEAR(p.velocity, 2.5 * x * std::cos(0.3), 1e-14);
  }
  beam.set_rigid_motion(1e-3, 2.5, q, v);
  const RigidPart rigid = beam.rigid_part(q, v);
  EXPECT_NEAR(rigid.angle, std::sin(1e-3), 1e-15);
  EXPECT_NEAR(rigid.rate, 2.5, 1e-13);
  beam.set_rigid_motion(-2.5, 2.5, q, v);
  EXPECT_NEAR(beam.rigid_part(q, v).along, std::cos(2.5), 1e-14);
}

INSTANTIATE_TEST_SUITE_P(BothBases, FloatingFrame,
                         testing::Values(Basis::cantilever, Basis::pinned_free),
                         [](const auto& instance) {
                           return instance.param == Basis::cantilever ? "Cantilever" : "PinnedFree";
                         });

TEST(FloatingFrameRigid, SwingsWithThePeriodOfTheEllipticIntegral) {
  // a quarter period from rest at angle α: √(2 L / 3 g) K(sin(α / 2))
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  FloatingFrameBeam beam(rig, Basis::cantilever, 0, 0);
  const Dop853::RightHandSide f = [&](double, const Vector& y, Eigen::Ref<Vector> slope) {
    slope[0] = y[1];
    beam.acceleration(y.head(1), y.tail(1), 0.0, slope.tail(1));
  };
  for (double angle : {0.1, 1.0, 2.8}) {
    Vector y(2);
    beam.set_rigid_motion(-angle, 0.0, y.head(1), y.tail(1));
    const double quarter = std::sqrt(2.0 * rig.beam.length / (3.0 * rig.gravity)) *
                           std::comp_ellint_1(std::sin(0.5 * angle));
    Dop853 stepper(2);
    stepper.start(0.0, y, f);
    const int steps = 200;
    for (int i = 0; i < steps; ++i) {
      stepper.attempt(quarter / steps, Vector::Ones(2), f);
      stepper.accept();
    }
    const PointMotion p = beam.struck_point(stepper.state().head(1), stepper.state().tail(1));
    EXPECT_NEAR(p.displacement, 0.0, 1e-12) << "angle " << angle;
    EXPECT_NEAR(p.velocity,
                rig.contact.position *
                    std::sqrt(3.0 * rig.gravity / rig.beam.length * (1.0 - std::cos(angle))),
                1e-11);
  }
}

}  // namespace
