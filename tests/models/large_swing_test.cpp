// SPDX-License-Identifier: BSD-3-Clause
// Swings of large angle, released from rest, against the pendulum of Jacobi's elliptic functions.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "models/make_beam.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;

/// The rigid bar let go at rest at an angle α from hanging [rad]: sin(θ/2) = k cd(ω t, k), k =
/// sin(α/2), ω² = 3 g / 2 L. Source: [DLMF2010], 22.19.
class Pendulum {
 public:
  Pendulum(const Rig& rig, double release)
      : modulus_(std::sin(0.5 * release)),
        omega_(std::sqrt(1.5 * rig.gravity / rig.beam.length)) {}

  double largest_rate() const { return 2.0 * modulus_ * omega_; }

  double period() const { return 4.0 * boost::math::ellint_1(modulus_) / omega_; }

  /// From hanging straight, as set_steady_motion() has it: negative before the first passage.
  double angle(double t) const {
    return -2.0 * std::asin(modulus_ * boost::math::jacobi_cd(modulus_, omega_ * t));
  }

  /// d/dt of the above, cd' = −(1 − k²) sd nd. Boost 1.74 loses four digits of dn next to its least
  /// value, so it is taken from sn.
  double rate(double t) const {
    const double k2 = modulus_ * modulus_;
    const double sn = boost::math::jacobi_sn(modulus_, omega_ * t);
    return 2.0 * modulus_ * omega_ * std::sqrt((1.0 - k2) / (1.0 - k2 * sn * sn)) * sn;
  }

 private:
  double modulus_;
  double omega_;
};

/// Largest distance of bar and pendulum over one swing there and back, in position [m] and velocity
/// [m/s] of the tip.
struct Distance {
  double position = 0.0;
  double velocity = 0.0;
};

Distance from_pendulum(const Rig& rig, const Solver& solver, double release, double tolerance) {
  const std::unique_ptr<BeamDynamics> beam = make_beam(rig, solver);
  const int n = beam->size();
  const Pendulum pendulum(rig, release);
  using State = std::vector<double>;
  State y(static_cast<std::size_t>(2 * n));
  Eigen::Map<Vector> q(y.data(), n), v(y.data() + n, n);
  beam->set_steady_motion(-release, 0.0, q, v);
  const auto slope = [&](const State& s, State& d, double) {
    const Eigen::Map<const Vector> sq(s.data(), n), sv(s.data() + n, n);
    std::copy(s.begin() + n, s.end(), d.begin());
    beam->acceleration(sq, sv, 0.0, Eigen::Map<Vector>(d.data() + n, n));
  };
  Distance distance;
  const auto look = [&](const State& s, double t) {
    const Eigen::Map<const Vector> sq(s.data(), n), sv(s.data() + n, n);
    const PointMotion tip = beam->point(rig.beam.length, sq, sv);
    const double angle = pendulum.angle(t);
    distance.position =
        std::max(distance.position, std::abs(tip.displacement - rig.beam.length * std::sin(angle)));
    distance.velocity =
        std::max(distance.velocity,
                 std::abs(tip.velocity - rig.beam.length * std::cos(angle) * pendulum.rate(t)));
  };
  namespace odeint = boost::numeric::odeint;
  const auto stepper =
      odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(tolerance, tolerance);
  const int samples = 400;
  odeint::integrate_const(stepper, slope, y, 0.0, pendulum.period(), pendulum.period() / samples,
                          look);
  return distance;
}

Rig swinging_rig() {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  return rig;
}

TEST(LargeSwing, OfTheRigidBarIsJacobisPendulum) {
  for (const double release : {0.3, 1.5, 2.9}) {
    const Rig rig = swinging_rig();
    const Distance distance = from_pendulum(rig, rigid(1e-6), release, 1e-14);
    // rounding, which grows like the time from one swing to another near the top: 1 / (π − α)
    const double rounding = 1e-13 / (std::numbers::pi - release);
    EXPECT_LT(distance.position, rounding) << release;
    EXPECT_LT(distance.velocity, 2.0 * Pendulum(rig, release).largest_rate() * rounding) << release;
  }
}

// Gravity bends and stretches the bar by its length times ρ g L / E and a number of the section,
// and so does the vibration its release sets off, at frequencies like √E: order 1 in 1 / E for
// positions, between 1/2 and 1 for velocities. The phase in which a vibration is met adds a scatter
// of a few percent of the order.
TEST(LargeSwing, OfAStiffeningBarBecomesJacobisPendulum) {
  for (const Solver& solver : {hybrid(Basis::cantilever, 1, 1e-6, 1.0),
                               hybrid(Basis::pinned_free, 1, 1e-6, 1.0), ancf(1, 1, 1e-6, 1.0)}) {
    SCOPED_TRACE(std::string(name(solver.model)) + " " + std::string(name(solver.basis)));
    ConvergenceStudy position, velocity;
    for (const double modulus : {1e8, 2e8, 4e8, 8e8, 1.6e9}) {
      Rig rig = swinging_rig();
      rig.beam.youngs_modulus = modulus;
      const Distance distance = from_pendulum(rig, solver, 2.0, 1e-9);
      position.add(1.0 / modulus, distance.position);
      velocity.add(1.0 / modulus, distance.velocity);
    }
    EXPECT_NEAR(position.order(), 1.0, 0.1);
    EXPECT_GT(position.correlation(), 0.99);
    EXPECT_GT(velocity.order(), 0.45);
    EXPECT_LT(velocity.order(), 1.0);
  }
}

// With restitution 0.8 the bar swings out to 98, 75 and 58 degrees after the first contacts. They
// end and begin at angle zero, so the time between is half a period whatever the contact did.
TEST(LargeSwing, BetweenTwoContactsLastsHalfAPeriod) {
  Rig rig = swinging_rig();
  rig.start.release_angle = 2.5;
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e6;
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.8;
  SimulationOptions exact;
  exact.exact = true;
  const double omega = std::sqrt(1.5 * rig.gravity / rig.beam.length);
  for (const double accuracy : {1e-4, 1e-8}) {
    Solver solver = rigid(accuracy);
    solver.duration = 3.0;
    const Simulation run = simulate(rig, solver, exact);
    ASSERT_EQ(run.episodes.size(), 4u);
    EXPECT_NEAR(run.episodes[0].approach_velocity /
                    (rig.contact.position * Pendulum(rig, 2.5).largest_rate()),
                1.0, accuracy);
    for (std::size_t i = 1; i < run.episodes.size(); ++i) {
      const Episode& before = run.episodes[i - 1];
      const double k = before.separation_velocity / (2.0 * omega * rig.contact.position);
      const double half_period = 2.0 * boost::math::ellint_1(k) / omega;
      EXPECT_NEAR((run.episodes[i].start - before.end) / half_period, 1.0, accuracy)
          << "swing " << i;
      EXPECT_NEAR(run.episodes[i].approach_velocity / before.separation_velocity, 1.0, accuracy);
    }
  }
}

}  // namespace
