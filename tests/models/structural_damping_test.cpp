// SPDX-License-Identifier: BSD-3-Clause
// Damping of the bar: logarithmic decrement, objectivity, virtual work, energy.
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "models/beams/ancf.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/integration/dop853.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/simulation.hpp"
#include "tests/models/plain_chain.hpp"
#include "tests/models/reference/impact_run.hpp"
#include "tests/models/scenes.hpp"
#include "tests/models/virtual_work.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

Rig damped_rig(double mass, double stiffness) {
  Rig rig = paper_rig();
  rig.beam.damping = {.mass = mass, .stiffness = stiffness};
  return rig;
}

Rig without_damping(Rig rig) {
  rig.beam.damping = {};
  return rig;
}

TEST(StructuralDamping, OfTheAncfBarIsThatOfAKelvinVoigtMaterial) {
  Rig rig = damped_rig(0.0, 3e-4);
  rig.beam.youngs_modulus = 1e6;
  AncfBeam beam(rig, {3, 2}), plain_beam(without_damping(rig), {3, 2});
  const PlainChain chain(rig, {3, 2});
  const int n = chain.dofs();
  // what an observer on the tangent sees: strain, and r_xx along and across it
  const auto seen = [&](const Vector& q, std::size_t e, double xi) {
    const auto x = chain.field(q.head(n), e, xi);
    const auto u = chain.field(q.tail(n), e, xi);
    const Eigen::Vector2d slope(x[1], u[1] - 1.0), bent(x[2], u[2]);
    const Eigen::Vector2d tangent = slope.normalized();
    return Eigen::Vector3d(0.5 * (slope.squaredNorm() - 1.0), bent.dot(tangent),
                           bent[1] * tangent[0] - bent[0] * tangent[1]);
  };
  for (double angle : {0.0, 1.3}) {
    const RandomState s = random_state(beam, 41, angle, 1e-3);
    const auto power = [&](const Vector& v, const Vector& w) {
      return chain.integral([&](std::size_t e, double xi) {
        const auto rate = [&](const Vector& along) {
          const auto central = [&](double h) -> Eigen::Vector3d {
            return (seen(s.q + h * along, e, xi) - seen(s.q - h * along, e, xi)) / (2.0 * h);
          };
          return Eigen::Vector3d((4.0 * central(1e-5) - central(2e-5)) / 3.0);
        };
        const Eigen::Vector3d stiffness(rig.beam.area, rig.beam.second_moment,
                                        rig.beam.second_moment);
        return -3e-4 * 1e6 * rate(v).dot(stiffness.cwiseProduct(rate(w)));
      });
    };
    EXPECT_NEAR(power_of_difference(beam, plain_beam, s.q, s.v, s.w) / power(s.v, s.w), 1.0, 1e-5);
    EXPECT_NEAR(beam.damping_power(s.q, s.v) / -power(s.v, s.v), 1.0, 1e-5);
  }
}

TEST(StructuralDamping, DoesNotBrakeTheRotationOfABentBar) {
  // the deformed bar spinning as one: no power, and no moment about the hinge in any motion
  Rig rig = damped_rig(0.0, 3e-4);
  rig.beam.youngs_modulus = 1e6;
  AncfBeam chain(rig, {3, 2}), loose(without_damping(rig), {3, 2});
  const int n = chain.size() / 2;
  const RandomState s = random_state(chain, 42, 0.7, 0.02);
  Vector straight(2 * n), unit(2 * n);
  chain.set_rigid_motion(0.0, 1.0, straight, unit);
  const Vector reference = -unit.head(n);
  Vector spin(2 * n);
  spin << reference - s.q.tail(n), s.q.head(n);
  EXPECT_LT(std::abs(chain.damping_power(s.q, spin)), 1e-12 * chain.damping_power(s.q, s.v));
  EXPECT_LT(std::abs(power_of_difference(chain, loose, s.q, s.v, spin)),
            1e-10 * chain.damping_power(s.q, s.v));

  FloatingFrameBeam frame(rig, Basis::pinned_free, 3, 1);
  Vector v = Vector::Zero(frame.size());
  v[0] = 5.0;
  EXPECT_EQ(frame.damping_power(random_state(frame, 43, 0.7, 0.02).q, v), 0.0);
}

TEST(StructuralDamping, OfTheFrameActsOnEveryCoordinateAsRayleighSays) {
  // w'(α M + τ K) v
  Rig rig = damped_rig(4.0, 3e-5);
  rig.beam.youngs_modulus = 1e6;
  rig.beam.masses = {{0.8, 0.4}};
  FloatingFrameBeam beam(rig, Basis::cantilever, 3, 2),
      free(without_damping(rig), Basis::cantilever, 3, 2);
  const RandomState s = random_state(beam, 44, 0.7, 0.02);
  const auto stiff = [&](const Vector& a, const Vector& b) {
    return 0.5 * (beam.energy(a + b, s.v).elastic - beam.energy(a - b, s.v).elastic);
  };
  const double expected = -4.0 * mass_product(beam, s.q, s.v, s.w) - 3e-5 * stiff(s.v, s.w);
  EXPECT_NEAR(power_of_difference(beam, free, s.q, s.v, s.w) / expected, 1.0, 1e-9);
  EXPECT_NEAR(beam.damping_power(s.q, s.v) / -power_of_difference(beam, free, s.q, s.v, s.v), 1.0,
              1e-9);
}

/// Displacement of the tip after every period of a damped vibration that starts at rest in the
/// shape q, over its first value.
std::vector<double> decay(BeamDynamics& beam, const Vector& q, double period, int steps) {
  const int n = beam.size();
  const Dop853::RightHandSide f = [&](double, const Vector& y, Eigen::Ref<Vector> slope) {
    slope.head(n) = y.tail(n);
    beam.acceleration(y.head(n), y.tail(n), 0.0, slope.tail(n));
  };
  Vector y = Vector::Zero(2 * n);
  y.head(n) = q;
  Dop853 stepper(2 * n);
  stepper.start(0.0, y, f);
  const auto tip = [&](const Vector& state) {
    return beam.point(0.8, state.head(n), state.tail(n)).displacement;
  };
  std::vector<double> ratios;
  for (int turn = 0; turn < 3; ++turn) {
    for (int i = 0; i < steps; ++i) {
      stepper.attempt(period / steps, Vector::Ones(2 * n), f);
      stepper.accept();
    }
    ratios.push_back(tip(stepper.state()) / tip(y));
  }
  return ratios;
}

// A mode decays by e^{−2π ζ / √(1 − ζ²)} a period, ζ = (α / ω + τ ω) / 2.
TEST(StructuralDamping, GivesAModeItsLogarithmicDecrement) {
  const double pi = std::numbers::pi;
  for (const BarDamping damping :
       {BarDamping{60.0, 0.0}, BarDamping{0.0, 2e-5}, BarDamping{60.0, 2e-5}}) {
    Rig rig = paper_rig();
    rig.beam.damping = damping;
    const auto expect_decrement = [&](BeamDynamics& beam, const Vector& mode, double omega,
                                      int steps) {
      const double zeta = 0.5 * (damping.mass / omega + damping.stiffness * omega);
      ASSERT_GT(zeta, 0.005);
      const double period = 2.0 * pi / (omega * std::sqrt(1.0 - zeta * zeta));
      // so small that its square is beyond the digits compared; large enough to keep them
      const std::vector<double> ratios = decay(beam, 1e-7 * mode, period, steps);
      for (std::size_t turn = 0; turn < ratios.size(); ++turn)
        EXPECT_NEAR(std::log(ratios[turn]) / (-2.0 * pi * zeta / std::sqrt(1.0 - zeta * zeta) *
                                              static_cast<double>(turn + 1)),
                    1.0, 1e-5)
            << damping.mass << ' ' << damping.stiffness;
    };

    rig.contact.position = 0.4;  // two long elements: their fastest stretching is damped the most
    AncfBeam chain(rig, {1, 1});
    const int n = chain.size() / 2;
    const SmallMotion motion = chain.small_motion();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(motion.stiffness,
                                                                          motion.mass);
    Vector shape = Vector::Zero(2 * n);
    shape.head(n) = modes.eigenvectors().col(1);  // after the rigid rotation
    expect_decrement(chain, shape, std::sqrt(modes.eigenvalues()[1]), 1500);

    FloatingFrameBeam frame(rig, Basis::pinned_free, 2, 0);
    expect_decrement(frame, Vector::Unit(3, 1),
                     bending_modes(rig.beam, Basis::pinned_free, 1)[0].angular_frequency(), 100);
  }
}

TEST(StructuralDamping, MassPartBrakesARigidBarAgainstTheGround) {
  // after a contact without loss the rate decays as e^{−α t}
  Rig rig = damped_rig(2.0, 1.0);  // a rigid bar has no use for the second
  rig.beam.masses = {{0.8, 0.3}};
  Solver solver = rigid(1e-11);
  solver.duration = 0.3;
  const Simulation run = simulate(rig, solver);
  const double flight = 0.3 - run.episodes[0].end;
  EXPECT_NEAR(run.energy.rigid_rotation,
              0.5 * rig.beam.hinge_inertia() *
                  std::pow(run.episodes[0].separation_velocity / 0.69, 2) * std::exp(-4.0 * flight),
              1e-10);
  EXPECT_NEAR(run.energy.damped / run.energy.initial, 1.0 - std::exp(-4.0 * 0.3), 1e-3);
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-9);
  // and its swing before: φ = −α cos would not lose any
  rig.hinge.spring = 5.0;
  rig.start.release_angle = 0.1;
  const double free_rate = 0.1 * std::sqrt(5.0 / rig.beam.hinge_inertia());
  EXPECT_LT(touch_velocity(rig), 0.8 * 0.69 * free_rate);
}

TEST(StructuralDamping, ChangesTheImpactAlikeInBothModels) {
  Rig rig = paper_rig();
  const Solver many = hybrid(Basis::pinned_free, 40, 1e-7, 5e-4);
  const Simulation bare = simulate(rig, many);
  rig.beam.damping = {.mass = 20.0, .stiffness = 1e-5};
  const Simulation limit = simulate(rig, many);
  EXPECT_GT(std::abs(limit.peak_force / bare.peak_force - 1.0), 0.01);
  EXPECT_GT(limit.energy.damped, 0.1 * limit.energy.initial);
  const Simulation fewer = simulate(rig, hybrid(Basis::pinned_free, 20, 1e-7, 5e-4));
  const Simulation fine = simulate(rig, ancf(28, 4, 1e-7, 5e-4));
  EXPECT_NEAR(fine.peak_force / limit.peak_force, 1.0, 1e-3);
  EXPECT_LT(std::abs(fine.peak_force / limit.peak_force - 1.0),
            std::abs(fine.peak_force / fewer.peak_force - 1.0));
  EXPECT_NEAR(fine.energy.damped / limit.energy.damped, 1.0, 0.01);
}

TEST(StructuralDamping, ClosesTheEnergyBalanceInEveryModel) {
  Rig rig = damped_rig(20.0, 1e-6);
  rig.gravity = 9.81;
  rig.beam.masses = {{0.8, 0.2}, {0.33, 0.1}};
  rig.hinge = {.spring = 2e3, .viscous = 0.8};
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  for (const Solver& solver :
       {hybrid(Basis::pinned_free, 6, 1e-11, 2e-3), hybrid(Basis::cantilever, 6, 1e-11, 2e-3),
        ancf(6, 2, 1e-11, 2e-3)}) {
    const Simulation run = simulate(rig, solver);
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-9) << name(solver.model);
    EXPECT_GT(run.energy.damped, 0.01 * run.energy.initial);
  }
}

TEST(StructuralDamping, StrongOneDoesNotMakeTheStepsUnstable) {
  // the fastest vibration is over-critical, ζ about 20: steps that were chosen by its frequency
  // alone would be rejected by the dozen
  const Rig rig = damped_rig(0.0, 1e-4);
  const Solver solver = ancf(4, 2, 1e-3, 3e-4);
  AncfBeam beam(rig, solver.elements);
  const SimulationOptions options;
  const Simulation run = ImpactRun(rig, solver, options, beam).simulate();
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-5);
  EXPECT_LT(run.cost.rejected, run.cost.steps / 10);
}

// What a mode keeps of C = α M + τ K + c hᵀ h and what is left out are all of it.
TEST(StructuralDamping, OfModesAndTheirCouplingIsAllThereIs) {
  Rig rig = damped_rig(30.0, 2e-6);
  rig.gravity = 9.81;
  rig.beam.masses = {{0.8, 0.4}};
  rig.hinge = {.spring = 500.0, .viscous = 0.3};
  const AncfBeam mesh(rig, {5, 2});
  const ModalBeam modes(mesh, rig);
  const SmallMotion motion = mesh.small_motion();
  const Eigen::MatrixXd whole =
      30.0 * motion.mass + 2e-6 * motion.stiffness + 0.3 * motion.hinge * motion.hinge.transpose();
  const Vector a = Vector::LinSpaced(modes.modes(), 1.0, -0.4);
  Vector drag;
  modes.coupled_drag(a, drag);
  EXPECT_GT(drag.norm(), 1e-9 * (whole * modes.shapes()).norm()) << "nothing is coupled";
  const Vector expected = modes.shapes().transpose() * (whole * (modes.shapes() * a));
  const Vector found = modes.damping().cwiseProduct(a) + drag;
  for (Eigen::Index i = 0; i < a.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-9 * (whole * modes.shapes()).norm()) << i;
}

/// The same scene by the full equations and by small motion, whose estimate has to cover what they
/// differ by.
void expect_small_motion_within_its_estimate(const Rig& rig, const Solver& solver) {
  SimulationOptions full, small;
  full.motion = Motion::full;
  small.motion = Motion::small;
  const Simulation a = simulate(rig, solver, full);
  const Simulation b = simulate(rig, solver, small);
  EXPECT_LT(std::abs(b.energy.imbalance), 1e-8);
  EXPECT_LT(b.neglected, 1e-4);
  const Episode &first = a.episodes.at(0), &other = b.episodes.at(0);
  EXPECT_NEAR(other.peak_force / first.peak_force, 1.0, b.neglected);
  EXPECT_NEAR(other.impulse / first.impulse, 1.0, b.neglected);
  EXPECT_NEAR((other.end - other.start) / (first.end - first.start), 1.0, b.neglected);
  EXPECT_GT(a.energy.damped, 1e-3 * a.energy.initial);
  EXPECT_NEAR(b.energy.damped / a.energy.damped, 1.0, 1e-3);
}

// The last damping lets the higher modes creep back instead of vibrating.
TEST(StructuralDamping, IsInSmallMotion) {
  for (const BarDamping damping : {BarDamping{30.0, 0.0}, BarDamping{0.0, 1e-7},
                                   BarDamping{30.0, 2e-6}, BarDamping{0.0, 1e-4}}) {
    Rig rig = damped_rig(damping.mass, damping.stiffness);
    rig.gravity = 9.81;
    rig.contact.damping = "lankarani-nikravesh";
    rig.contact.restitution = 0.5;
    for (const Solver& solver :
         {hybrid(Basis::cantilever, 6, 1e-9, 1e-3), hybrid(Basis::pinned_free, 6, 1e-9, 1e-3),
          ancf(6, 2, 1e-9, 1e-3)}) {
      SCOPED_TRACE(testing::Message() << damping.mass << " " << damping.stiffness << " "
                                      << name(solver.model) << " " << name(solver.basis));
      expect_small_motion_within_its_estimate(rig, solver);
    }
    rig.beam.theory = BeamTheory::timoshenko;
    rig.beam.shear_coefficient = 0.9;
    SCOPED_TRACE(testing::Message() << "shear " << damping.mass << " " << damping.stiffness);
    expect_small_motion_within_its_estimate(rig, ancf(6, 2, 1e-9, 1e-3));
  }
}

TEST(StructuralDamping, IsInSmallMotionBeforeSeveralStopsAndOneThatGivesWay) {
  for (const double retardation : {1e-6, 1e-4}) {
    SCOPED_TRACE(testing::Message() << retardation);
    Rig rig = damped_rig(30.0, retardation);
    rig.further_stops.push_back({.contact = rig.contact, .gap = 1e-5});
    rig.further_stops[0].contact.position = 0.4;
    expect_small_motion_within_its_estimate(rig, hybrid(Basis::cantilever, 6, 1e-9, 1e-3));
    rig.further_stops.clear();
    rig.stop = Stop{.mass = 0.05, .stiffness = 2e8, .viscous = 50.0};
    expect_small_motion_within_its_estimate(rig, hybrid(Basis::cantilever, 6, 1e-9, 1e-3));
  }
}

TEST(StructuralDamping, WithoutAStopIsBeyondSmallMotion) {
  SimulationOptions small;
  small.motion = Motion::small;
  for (Rig rig : {damped_rig(1e-3, 0.0), damped_rig(0.0, 1e-12)}) {
    rig.contact.law = "none";
    rig.gravity = 9.81;
    rig.start.release_angle = 0.1;
    const Solver solver = ancf(4, 2, 1e-3, 2e-4);
    EXPECT_FALSE(simulate(rig, solver).small_motion);
    EXPECT_THAT([&] { simulate(rig, solver, small); },
                testing::ThrowsMessage<std::invalid_argument>(
                    "small motion was asked for, but it does not know beam.damping without a stop; "
                    "ask for the full equations"));
  }
}

}  // namespace
