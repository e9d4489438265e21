// SPDX-License-Identifier: BSD-3-Clause
// A bar that can stretch begins with the tension its weight and its turning give it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/make_beam.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;

/// How much further from the hinge a point is than on the bar as it is made, hanging [m].
double stretch_at(const AncfBeam& beam, double x, const Vector& q) {
  const AncfBeam::Row row = beam.row_at(x);
  const Eigen::Index n = beam.size() / 2;
  Eigen::Vector4d nodes = Eigen::Vector4d::Zero();
  const Eigen::Index first = 2 * static_cast<Eigen::Index>(row.element) - 1;
  for (int i = 0; i < 4; ++i)
    if (row.element > 0)
      nodes[i] = q[n + first + i];
    else if (i > 0)
      nodes[i] = q[n + i - 1];
  return -row.shape.dot(nodes);
}

// ρ A u'' E = −ρ A (g + ω² x): u = ρ/E [g (L x − x²/2) + ω² (L² x/2 − x³/6)]. The bar is thin:
// the element's own EI u_xx² is of the order of (radius / L)².
TEST(SteadyStart, IsTheStaticStretchOfAHangingAndTurningBar) {
  Rig rig = paper_rig();
  rig.beam.area *= 1e-4;
  rig.beam.second_moment *= 1e-8;
  rig.gravity = 9.81;
  const double rate = 4.0, length = rig.beam.length;
  AncfBeam beam(rig, {14, 2});
  Vector q(beam.size()), v(beam.size());
  beam.set_steady_motion(0.0, rate, q, v);
  for (const double x : {0.2, 0.69, 0.8}) {
    const double exact = rig.beam.density / rig.beam.youngs_modulus *
                         (rig.gravity * (length * x - 0.5 * x * x) +
                          rate * rate * (0.5 * length * length * x - x * x * x / 6.0));
    EXPECT_NEAR(stretch_at(beam, x, q) / exact, 1.0, 1e-6) << x;
  }
  EXPECT_DOUBLE_EQ(beam.struck_point(q, v).velocity, rate * rig.contact.position);
  EXPECT_DOUBLE_EQ(beam.struck_point(q, v).displacement, 0.0);
}

/// How far such a bar is stretched along, by the strain s + s²/2 of its slope s: EA times it times
/// 1 + s carries what hangs below, a cubic equation in 1 + s.
double slope_under(double load_of_stiffness) {
  double length = 1.0 + load_of_stiffness;  // above the answer: Newton's method comes down to it
  for (int k = 0; k < 100; ++k)
    length -= (0.5 * length * (length * length - 1.0) - load_of_stiffness) /
              (1.5 * length * length - 0.5);
  return length - 1.0;
}

// A bar of jelly hangs at a multiple of its length; the first step of Newton's method leads far
// beyond.
TEST(SteadyStart, IsThatOfABarThatItsWeightPullsToAMultipleOfItsLength) {
  Rig rig = paper_rig();
  rig.beam.area *= 1e-4;
  rig.beam.second_moment *= 1e-8;
  rig.beam.youngs_modulus = 1e3;
  rig.gravity = 9.81;
  const double length = rig.beam.length;
  AncfBeam beam(rig, {56, 8});
  Vector q(beam.size()), v(beam.size());
  beam.set_steady_motion(0.0, 0.0, q, v);
  constexpr int panels = 2000;  // of Simpson's rule
  double exact = 0.0;
  for (int k = 0; k <= panels; ++k) {
    const double weight = k == 0 || k == panels ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
    const double below = length * (1.0 - static_cast<double>(k) / panels);
    exact += weight * slope_under(rig.beam.density * rig.gravity * below / 1e3);
  }
  exact *= length / (3.0 * panels);
  EXPECT_GT(exact, 1.5 * length);
  EXPECT_NEAR(stretch_at(beam, length, q) / exact, 1.0, 1e-4);
}

// Elements a millionth as long as the others, as beyond a point struck all but at the tip: in a
// struck bar of rubber four of them made the peak force 42 % larger, for the bar began unstretched.
TEST(SteadyStart, IsTheSameWithElementsFarShorterThanOthers) {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 4e6;
  rig.beam.length = 5.5;
  rig.contact.position = rig.beam.length - 6e-6;
  rig.gravity = 9.81;
  const auto stretch = [&](int beyond) {
    AncfBeam beam(rig, {15, beyond});
    Vector q(beam.size()), v(beam.size());
    beam.set_steady_motion(0.0, 0.0, q, v);
    return stretch_at(beam, rig.contact.position, q);
  };
  const double plain = stretch(1);
  EXPECT_GT(plain, 0.05);
  for (const int beyond : {4, 10, 40}) EXPECT_NEAR(stretch(beyond) / plain, 1.0, 1e-7) << beyond;
}

// Nothing then accelerates but as a rigid bar does: towards the hinge by ω² r.
TEST(SteadyStart, LeavesNothingToRing) {
  const double rate = 0.6;
  for (const double youngs_modulus : {7e10, 1e6}) {
    Rig rig = paper_rig();
    rig.gravity = 9.81;
    rig.beam.youngs_modulus = youngs_modulus;
    AncfBeam beam(rig, {9, 3});
    const Eigen::Index n = beam.size() / 2;
    Vector q(2 * n), v(2 * n), a(2 * n);
    beam.set_rigid_motion(0.5 * std::numbers::pi, 0.0, q, v);
    const Vector reference = -q.head(n);
    beam.set_steady_motion(0.0, rate, q, v);
    beam.acceleration(q, v, 0.0, a);
    a.tail(n) -= rate * rate * (reference - q.tail(n));
    EXPECT_LT(a.norm(), 1e-6 * std::max(1.0, youngs_modulus / 1e6));  // rounding of EA
    beam.set_rigid_motion(0.0, rate, q, v);
    beam.acceleration(q, v, 0.0, a);
    EXPECT_GT(a.norm(), 5.0);

    const auto modes = [&] {
      Solver solver = hybrid(Basis::cantilever, 3, 1e-6, 1e-3);
      solver.axial_modes = 4;
      return make_beam(rig, solver);
    }();
    Vector x(modes->size()), rates(modes->size()), free(modes->size());
    modes->set_rigid_motion(0.0, rate, x, rates);
    modes->acceleration(x, rates, 0.0, free);
    const double ringing = free.norm();
    modes->set_steady_motion(0.0, rate, x, rates);
    modes->acceleration(x, rates, 0.0, free);
    EXPECT_LT(free.norm(), 1e-3 * ringing);  // strain by strain
  }
}

// Of Reissner's elements too.
TEST(SteadyStart, LeavesNothingToRingInABarThatShears) {
  const double rate = 0.6, angle = -0.3;
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.beam.youngs_modulus = 1e7;
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.886;
  rig.beam.poisson_ratio = 0.3;
  const std::unique_ptr<BeamDynamics> beam = make_beam(rig, ancf(5, 2, 1e-6, 1e-3));
  Vector q(beam->size()), v(beam->size()), a(beam->size());
  const auto along_bar = [&] {  // of the tip, beyond what a rigid bar does
    beam->acceleration(q, v, 0.0, a);
    const Eigen::Index tip = beam->size() - 3;
    return std::abs(-std::sin(angle) * a[tip] - std::cos(angle) * a[tip + 1] + 0.36 * 0.8);
  };
  beam->set_rigid_motion(angle, rate, q, v);
  EXPECT_GT(along_bar(), 5.0);
  beam->set_steady_motion(angle, rate, q, v);
  EXPECT_LT(along_bar(), 1e-3);
  EXPECT_NEAR(beam->struck_point(q, v).velocity, rate * 0.69 * std::cos(angle), 1e-12);
}

// At an angle the weight pulls along the bar by its cosine.
TEST(SteadyStart, HangsAtAnAngle) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  Solver solver = hybrid(Basis::cantilever, 2, 1e-6, 1e-3);
  solver.axial_modes = 1;
  const std::unique_ptr<BeamDynamics> beam = make_beam(rig, solver);
  Vector hanging(beam->size()), slanting(beam->size()), v(beam->size());
  beam->set_steady_motion(0.0, 0.0, hanging, v);
  beam->set_steady_motion(-1.0, 0.0, slanting, v);
  EXPECT_NEAR(slanting[1] / hanging[1], std::cos(1.0), 1e-12);
}

// A bar of jelly that its weight would crush begins as it is made.
TEST(SteadyStart, GivesUpOnABarThatIsCrushed) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.gravity_direction = std::numbers::pi;                   // it stands on its hinge
  for (const double modulus : {2e4, 3e3, 1e3, 200.0, 1.0}) {  // its weight presses with 2e4 Pa
    rig.beam.youngs_modulus = modulus;
    const AncfBeam beam(rig, {6, 2});
    Vector q(beam.size()), v(beam.size()), rigid_q(beam.size()), rigid_v(beam.size());
    EXPECT_FALSE(beam.set_steady_motion(0.0, 0.6, q, v)) << modulus;
    beam.set_rigid_motion(0.0, 0.6, rigid_q, rigid_v);
    EXPECT_EQ(q, rigid_q);
    EXPECT_EQ(v, rigid_v);
  }
}

// Ten times as stiff as its weight needs it begins so without a word, a hundredth with one.
TEST(SteadyStart, TellsOfABarThatIsCrushed) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.gravity_direction = std::numbers::pi;
  rig.start.velocity = 0.01;
  const double pressure = rig.gravity * rig.beam.density * rig.beam.length;
  for (const double stiffer : {10.0, 0.01}) {
    rig.beam.youngs_modulus = stiffer * pressure;
    Solver solver;
    solver.model = BeamModel::ancf;
    solver.elements = {4, 2};
    solver.duration = 1e-4;
    SimulationOptions options;
    options.motion = Motion::full;
    const Simulation run = simulate(rig, solver, options);
    const bool told = std::ranges::any_of(run.warnings, [](const std::string& warning) {
      return warning.find("tear or crush") != std::string::npos;
    });
    EXPECT_EQ(told, stiffer < 1.0) << stiffer;
  }
}

// With it the first contact is that of a bar that cannot ring, to the order of the strain.
TEST(SteadyStart, BringsFullEquationsAndSmallMotionTogether) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  SimulationOptions full, small;
  full.motion = Motion::full;
  small.motion = Motion::small;
  const Solver solver = ancf(14, 2, 1e-8, 5e-4);
  const Episode a = simulate(rig, solver, full).episodes.at(0);
  const Episode b = simulate(rig, solver, small).episodes.at(0);
  EXPECT_NEAR(b.impulse / a.impulse, 1.0, 3e-7);  // 1.6e-6 without
  EXPECT_NEAR(b.end / a.end, 1.0, 3e-7);
}

// The energy of the tension stays as it is: ρ² g² A L³ / (6 E), here a million times what the
// slow bar brings.
TEST(SteadyStart, CountsItsTensionNeitherAsVibrationNorAsWhatCameIntoPlay) {
  Rig rig = paper_rig();
  rig.beam.youngs_modulus = 1e9;
  rig.gravity = 9.81;
  rig.start.velocity = 1e-5;
  SimulationOptions options;
  options.motion = Motion::full;
  const EnergyAudit energy = simulate(rig, ancf(14, 2, 1e-6, 1e-3), options).energy;
  const double stretch = std::pow(rig.beam.density * rig.gravity, 2) * rig.beam.area *
                         std::pow(rig.beam.length, 3) / (6.0 * rig.beam.youngs_modulus);
  EXPECT_GT(stretch, 1e6 * energy.initial);
  EXPECT_NEAR(energy.elastic_at_start / stretch, 1.0, 1e-3);
  EXPECT_GT(energy.vibration, 0.0);
  EXPECT_LT(energy.vibration, energy.initial);
  EXPECT_GT(std::abs(energy.unbalanced()), 0.5 * std::abs(energy.imbalance));
}

}  // namespace
