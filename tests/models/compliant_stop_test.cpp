// SPDX-License-Identifier: BSD-3-Clause
// The stop on its sensor: manufactured motions of the head, two masses on springs, limits of a
// stiff and of a light stop, balances of momentum and energy, an explicit integration.
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/ensemble.hpp"
#include "models/integration/dop853.hpp"
#include "models/simulation.hpp"
#include "models/stop/stop_head.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

using Function = std::function<double(double)>;

double root(const Function& f, double low, double high) {
  std::uintmax_t most = 200;
  const auto close = [](double a, double b) { return std::abs(b - a) <= 1e-15 * std::abs(b); };
  const auto [a, b] = boost::math::tools::toms748_solve(f, low, high, close, most);
  return 0.5 * (a + b);
}

// Any polynomial x(t) is the motion under the polynomial m ẍ + c ẋ + k x, which the nodes hold
// exactly; the head must follow it, however it is damped and however often it could swing.
TEST(StopHead, FollowsAManufacturedPolynomial) {
  for (const auto nodes : {Collocation::Nodes::gauss, Collocation::Nodes::radau})
    for (const int s : {4, 8, 12})
      for (const double ratio : {0.0, 0.05, 0.999999, 1.0, 1.000001, 3.0, 50.0})
        for (const double phase : {1e-5, 0.03, 1.0, 7.0, 60.0, 290.0}) {
          const Collocation& rule = Collocation::of(s, nodes);
          Stop stop{.mass = 0.07, .stiffness = 3e8};
          const double omega = std::sqrt(stop.stiffness / stop.mass);
          stop.viscous = 2.0 * ratio * stop.mass * omega;
          const StopHead head(stop);
          const double h = phase / head.fastest();
          // x = Σ c_p P_p(t / h)
          const NodeVector c = NodeVector::LinSpaced(s, 1.0, -0.4);
          const auto motion = [&](double part) {
            NodeVector value(s), slope = NodeVector::Zero(s), bend = NodeVector::Zero(s);
            shifted_legendre(part, value);
            for (int p = 1; p < s; ++p) {
              slope[p] = (p > 1 ? slope[p - 2] : 0.0) + 2.0 * (2.0 * p - 1.0) * value[p - 1];
              bend[p] = (p > 1 ? bend[p - 2] : 0.0) + 2.0 * (2.0 * p - 1.0) * slope[p - 1];
            }
            return Eigen::Vector3d(c.dot(value), c.dot(slope) / h, c.dot(bend) / (h * h));
          };
          const HeadStep step(head, rule, h);
          ASSERT_TRUE(step.responds());
          NodeVector force(s), x, v;
          const Eigen::Vector3d begin = motion(0.0), end = motion(1.0);
          for (int i = 0; i < s; ++i) {
            const Eigen::Vector3d m = motion(rule.points()[i]);
            force[i] = stop.mass * m[2] + stop.viscous * m[1] + stop.stiffness * m[0];
          }
          const StopHead::State start{begin[0], begin[1]};
          step.coast(start, x, v);
          x += step.displacement_of_force() * force;
          v += step.velocity_of_force() * force;
          const StopHead::State last = step.advanced(start, force);
          // rounding of the force's share in what is followed
          const double scale = (force.cwiseAbs().maxCoeff() * h / stop.mass + std::abs(begin[1]));
          SCOPED_TRACE(testing::Message() << s << " nodes, ratio " << ratio << ", phase " << phase);
          for (int i = 0; i < s; ++i) {
            const Eigen::Vector3d m = motion(rule.points()[i]);
            EXPECT_NEAR(x[i], m[0], 1e-12 * scale * h);
            EXPECT_NEAR(v[i], m[1], 1e-12 * scale);
          }
          EXPECT_NEAR(last.displacement, end[0], 1e-12 * scale * h);
          EXPECT_NEAR(last.velocity, end[1], 1e-12 * scale);
        }
}

TEST(StopHead, KnowsNoResponseToAStepTooLong) {
  const StopHead head({.mass = 1.0, .stiffness = 1e8, .viscous = 0.0});
  EXPECT_TRUE(HeadStep(head, Collocation::of(8), 0.029).responds());
  EXPECT_FALSE(HeadStep(head, Collocation::of(8), 0.031).responds());
}

// Against the highest of 20000 looks at the motion itself, each a thousandth later than the last.
// They miss half the square of a thousandth of a period, 2e-5 of it.
TEST(StopHead, KnowsTheLargestForceOfItsFreeMotion) {
  for (const double ratio : {0.0, 0.05, 0.7, 0.999999, 1.0, 1.000001, 3.0, 50.0}) {
    Stop stop{.mass = 0.07, .stiffness = 3e8};
    const double omega = std::sqrt(stop.stiffness / stop.mass);
    stop.viscous = 2.0 * ratio * stop.mass * omega;
    const StopHead head(stop);
    for (int k = 0; k < 16; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.3) / 16.0;
      const StopHead::State state{std::cos(angle), omega * std::sin(angle)};
      double largest = std::max(head.sensor_force(state), 0.0);
      double time = 1e-6 / head.fastest();
      for (int i = 0; i < 20000; ++i, time *= 1.001)
        largest = std::max(largest, head.sensor_force(head.coasted(state, time)));
      SCOPED_TRACE(testing::Message() << "ratio " << ratio << ", " << k);
      const double scale = stop.stiffness * (1.0 + 2.0 * ratio);
      EXPECT_NEAR(std::max(head.largest_free_force(state), 0.0), largest, 2e-5 * scale);
    }
  }
}

Rig sprung(double stiffness, const Stop& stop) {
  Rig rig = paper_rig();
  rig.contact.law = "linear";
  rig.contact.stiffness = stiffness;
  rig.stop = stop;
  return rig;
}

/// A rigid bar as a mass M on the contact's spring, the head between that and the sensor's: linear
/// while they touch, z = (w, x, ẇ / Ω, ẋ / Ω) = Σ of exponentials; Ω keeps the matrix balanced.
class TwoMasses {
 public:
  explicit TwoMasses(const Rig& rig)
      : k_(rig.contact.stiffness),
        stop_(*rig.stop),
        unit_(std::sqrt((k_ + stop_.stiffness) / stop_.mass)) {
    const double square = unit_ * unit_;
    const double mass = effective_mass(rig);
    Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
    a(0, 2) = a(1, 3) = 1.0;
    a.row(2) << -k_ / mass / square, k_ / mass / square, 0.0, 0.0;
    a.row(3) << k_ / stop_.mass / square, -1.0, 0.0, -stop_.viscous / stop_.mass / unit_;
    const Eigen::EigenSolver<Eigen::Matrix4d> solver(a);
    roots_ = solver.eigenvalues();
    shapes_ = solver.eigenvectors();
    share_ =
        shapes_.partialPivLu().solve(Eigen::Vector4cd(0.0, 0.0, rig.start.velocity / unit_, 0.0));
  }

  /// (w, x, ẇ, ẋ)
  Eigen::Vector4d at(double t) const {
    Eigen::Vector4d z =
        (shapes_ * (roots_.array() * unit_ * t).exp().matrix().cwiseProduct(share_)).real();
    z.tail<2>() *= unit_;
    return z;
  }

  double force(double t) const { return k_ * (at(t)[0] - at(t)[1]); }

  double sensor(double t) const { return stop_.stiffness * at(t)[1] + stop_.viscous * at(t)[3]; }

  /// First zero of the force after the touch, looked for in steps much shorter than any period.
  double end() const {
    const double step = 0.05 / unit_ / roots_.cwiseAbs().maxCoeff();
    double t = step;
    while (force(t + step) > 0.0) t += step;
    return root([&](double x) { return force(x); }, t, t + step);
  }

  /// Largest value until a time, on a grid refined by a parabola, or at the end.
  static double largest(const Function& f, double until) {
    const int n = 20000;
    int best = 1;
    for (int i = 1; i <= n; ++i)
      if (f(until * i / n) > f(until * best / n)) best = i;
    if (best == n) return f(until);
    const double h = until / n;
    const double a = f(h * (best - 1)), b = f(h * best), c = f(h * (best + 1));
    return b + 0.125 * (c - a) * (c - a) / (2.0 * b - a - c);
  }

 private:
  double k_;
  Stop stop_;
  double unit_;  // Ω [rad/s]
  Eigen::Vector4cd roots_, share_;
  Eigen::Matrix4cd shapes_;
};

SimulationOptions small_motion(double interval = 0.0) {
  SimulationOptions options;
  options.motion = Motion::small;
  options.history.interval = interval;
  return options;
}

// Heads lighter and heavier than the bar, stops stiffer and softer than the contact, without and
// with damping below and above the critical.
TEST(CompliantStop, MovesARigidBarAsTwoMassesOnSprings) {
  for (const Stop& stop : {Stop{0.05, 2e8, 0.0}, Stop{0.05, 2e8, 900.0}, Stop{3.0, 1e7, 0.0},
                           Stop{0.4, 5e7, 3e4}, Stop{0.002, 6e8, 50.0}}) {
    const Rig rig = sprung(1e8, stop);
    const TwoMasses exact(rig);
    Solver solver = rigid(1e-10);
    const double end = exact.end();
    solver.duration = 0.999 * end;
    const Simulation inside = simulate(rig, solver, small_motion(end / 100.0));
    solver.duration = 1.05 * end;
    const Simulation run = simulate(rig, solver, small_motion());
    SCOPED_TRACE(testing::Message() << stop.mass << " kg, " << stop.viscous << " N s/m");
    const double peak = TwoMasses::largest([&](double t) { return exact.force(t); }, end);
    const History& history = inside.history;
    ASSERT_EQ(history.sensor_force.size(), history.force.size());
    ASSERT_GT(history.force.size(), 95U);
    for (std::size_t k = 0; k < history.force.size(); ++k) {
      const double t = history.interval * static_cast<double>(k);
      EXPECT_NEAR(history.force[k], exact.force(t), 1e-9 * peak) << t;
      EXPECT_NEAR(history.sensor_force[k], exact.sensor(t), 1e-9 * peak) << t;
      EXPECT_NEAR(history.velocity[k], exact.at(t)[2], 1e-9 * rig.start.velocity) << t;
    }
    const Episode& episode = run.episodes.front();
    EXPECT_NEAR(episode.end / end, 1.0, 1e-9);
    EXPECT_NEAR(episode.peak_force / peak, 1.0, 1e-9);
    EXPECT_NEAR(episode.max_penetration / (peak / 1e8), 1.0, 1e-9);
    const Eigen::Vector4d z = exact.at(end);
    EXPECT_NEAR(episode.separation_velocity, z[3] - z[2], 1e-9 * rig.start.velocity);
    EXPECT_NEAR(episode.impulse / (effective_mass(rig) * (rig.start.velocity - z[2])), 1.0, 1e-9);
    const Function sensor = [&](double t) { return exact.sensor(t); };
    EXPECT_NEAR(inside.sensor->peak_force / TwoMasses::largest(sensor, 0.999 * end), 1.0, 1e-9);
    EXPECT_NEAR(sensor(inside.sensor->peak_time) / inside.sensor->peak_force, 1.0, 1e-9);
  }
}

// The force of a head free again is A e^{-γt} cos(…): its largest value after the contact and the
// history agree, although steps of free flight are longer than its period.
TEST(CompliantStop, RingsOnWhenTheBarHasLeft) {
  const Rig rig = sprung(1e8, {.mass = 1.5, .stiffness = 4e8, .viscous = 2000.0});
  Solver solver = rigid(1e-9);
  solver.duration = 3e-3;
  const Simulation run = simulate(rig, solver, small_motion(1e-6));
  const StopHead head(*rig.stop);
  const double end = run.episodes.back().end;
  const History& h = run.history;
  const auto first = static_cast<std::size_t>(std::ceil(end / h.interval));
  // two samples tell amplitude and phase
  const double gamma = 0.5 * rig.stop->viscous / rig.stop->mass;
  const double omega = std::sqrt(rig.stop->stiffness / rig.stop->mass - gamma * gamma);
  const double decay = std::exp(-gamma * h.interval);
  const double advance = 2.0 * decay * std::cos(omega * h.interval);
  ASSERT_GT(h.sensor_force.size(), first + 1000);
  double scale = 0.0;
  for (std::size_t k = first; k < h.sensor_force.size(); ++k)
    scale = std::max(scale, std::abs(h.sensor_force[k]));
  EXPECT_GT(scale, 0.1 * run.peak_force);
  for (std::size_t k = first + 2; k < h.sensor_force.size(); ++k)
    EXPECT_NEAR(h.sensor_force[k],
                advance * h.sensor_force[k - 1] - decay * decay * h.sensor_force[k - 2],
                1e-11 * scale);
  const double seen = *std::ranges::max_element(h.sensor_force);
  EXPECT_GE(run.sensor->peak_force, seen);
  EXPECT_LE(run.sensor->peak_force, seen * (1.0 + 0.5 * std::pow(omega * h.interval, 2)));
}

// F₁(k_s) → F_rigid with k / k_s.
TEST(CompliantStop, ApproachesTheRigidStopWithItsStiffness) {
  Rig rig = sprung(1e8, {.mass = 0.01});
  const Rig firm = [&] {
    Rig r = rig;
    r.stop.reset();
    return r;
  }();
  Solver solver = rigid(1e-11);
  solver.duration = 5e-4;
  const double limit = simulate(firm, solver, small_motion()).episodes.front().impulse;
  const double peak = simulate(firm, solver, small_motion()).peak_force;
  ConvergenceStudy of_peak;  // by k / k_s
  for (double stiffness = 1e11; stiffness < 2e14; stiffness *= 8.0) {
    rig.stop->stiffness = stiffness;
    const Simulation run = simulate(rig, solver, small_motion());
    of_peak.add(1e8 / stiffness, std::abs(run.peak_force / peak - 1.0));
    EXPECT_NEAR(run.episodes.front().impulse / limit, 1.0, 2.0 * 1e8 / stiffness);
    // the head rings with what a ramp of the force leaves, k v / ω
    const double ring = std::sqrt(1e8 / stiffness * rig.stop->mass / effective_mass(rig));
    EXPECT_NEAR(run.sensor->peak_force / run.peak_force, 1.0, 1.1 * ring);
  }
  EXPECT_NEAR(of_peak.order(), 1.0, 0.02);
}

// A head without mass is a spring in series: half a period of M on k k_s / (k + k_s).
TEST(CompliantStop, PutsTheSpringsOfALightHeadInSeries) {
  const double k = 1e8, behind = 3e8;
  Rig rig = sprung(k, {.mass = 1.0, .stiffness = behind});
  const double series = k * behind / (k + behind);
  const double mass = effective_mass(rig);
  const double peak = rig.start.velocity * std::sqrt(mass * series);
  const double duration = std::numbers::pi * std::sqrt(mass / series);
  Solver solver = rigid(1e-10);
  solver.duration = 1.1 * duration;
  double worst = 0.0;
  for (const double head : {1e-4, 1e-6, 1e-8}) {
    rig.stop->mass = head;
    const Simulation run = simulate(rig, solver, small_motion());
    // the head rings with k v / ω about what it is pushed
    const double ring = k * rig.start.velocity / std::sqrt((k + behind) / head);
    EXPECT_NEAR(run.peak_force, peak, 1.01 * ring) << head;
    EXPECT_NEAR(run.episodes.front().end, duration, 3.0 * std::sqrt(head / (k + behind))) << head;
    worst = ring / peak;
  }
  EXPECT_LT(worst, 1e-3);
}

/// Rigid bar, contact and head, z = (w, x, ẇ, ẋ, impulse, dissipated), small steps of an explicit
/// method of order 8, until they part.
struct Explicit {
  double end = 0.0, impulse = 0.0, dissipated = 0.0, peak = 0.0;
  double separation = 0.0;
};

Explicit explicit_impact(const Rig& rig, int steps_per_contact) {
  ContactForce contact(rig);
  contact.begin_episode(rig.start.velocity);
  contact.set_phase(ContactForce::Phase::pressed);
  const Stop& stop = *rig.stop;
  const double mass = effective_mass(rig);
  const Dop853::RightHandSide f = [&](double, const Eigen::VectorXd& z,
                                      Eigen::Ref<Eigen::VectorXd> slope) {
    const double force = contact.force(z[0] - z[1], z[2] - z[3]);
    slope[0] = z[2];
    slope[1] = z[3];
    slope[2] = -force / mass;
    slope[3] = (force - stop.stiffness * z[1] - stop.viscous * z[3]) / stop.mass;
    slope[4] = force;
    slope[5] = contact.dissipation(z[0] - z[1], z[2] - z[3]);
  };
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(6);
  Dop853 stepper(6);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(6);
  z[2] = rig.start.velocity;
  stepper.start(0.0, z, f);
  const double longest = 1e-4 / steps_per_contact;
  double h = 1e-4 * longest;  // the law has a corner at touch
  Explicit result;
  const auto gap = [&] { return stepper.attempted()[0] - stepper.attempted()[1]; };
  const auto force = [&] {
    const Eigen::VectorXd& y = stepper.attempted();
    return contact.force(y[0] - y[1], y[2] - y[3]);
  };
  for (;;) {
    stepper.attempt(h, weights, f);
    if (!(gap() > 0.0)) break;
    result.peak = std::max(result.peak, force());
    stepper.accept();
    h = std::min(1.2 * h, longest);
  }
  for (int i = 0; i < 30; ++i) {  // Newton onto the separation
    const Eigen::VectorXd& y = stepper.attempted();
    const double late = (y[0] - y[1]) / (y[2] - y[3]);
    if (std::abs(late) < 1e-17) break;
    h -= late;
    stepper.attempt(h, weights, f);
  }
  result.end = stepper.time() + h;
  result.impulse = stepper.attempted()[4];
  result.dissipated = stepper.attempted()[5];
  result.separation = stepper.attempted()[3] - stepper.attempted()[2];
  return result;
}

Rig damped_impact() {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.7;
  rig.stop = Stop{.mass = 0.05, .stiffness = 2e8, .viscous = 300.0};
  return rig;
}

TEST(CompliantStop, MeetsAnExplicitIntegrationWithinTheAccuracy) {
  const Rig rig = damped_impact();
  const Explicit exact = explicit_impact(rig, 3000), coarser = explicit_impact(rig, 1500);
  EXPECT_NEAR(coarser.impulse / exact.impulse, 1.0, 1e-11);
  EXPECT_NEAR(coarser.end / exact.end, 1.0, 1e-11);
  for (const double accuracy : {1e-3, 1e-5, 1e-7, 1e-9}) {
    Solver solver = rigid(accuracy);
    solver.duration = 1.2 * exact.end;
    const Simulation run = simulate(rig, solver, small_motion());
    const Episode& episode = run.episodes.front();
    EXPECT_NEAR(episode.end / exact.end, 1.0, accuracy);
    EXPECT_NEAR(episode.impulse / exact.impulse, 1.0, accuracy);
    EXPECT_NEAR(episode.peak_force / exact.peak, 1.0, std::max(accuracy, 1e-6));  // by its steps
    EXPECT_NEAR(episode.dissipated / exact.dissipated, 1.0, 3.0 * accuracy);
    EXPECT_NEAR(episode.separation_velocity / exact.separation, 1.0, 3.0 * accuracy);
  }
}

struct Bar {
  const char* name;
  Solver solver;
  Motion motion;
};

std::vector<Bar> bars(double accuracy, double duration) {
  Solver stiff = rigid(accuracy);
  stiff.duration = duration;
  return {{"rigid, small", stiff, Motion::small},
          {"rigid, full", stiff, Motion::full},
          {"hybrid, small", hybrid(Basis::cantilever, 5, accuracy, duration), Motion::small},
          {"hybrid, full", hybrid(Basis::cantilever, 5, accuracy, duration), Motion::full},
          {"ancf, small", ancf(7, 1, accuracy, duration), Motion::small},
          {"ancf, full", ancf(7, 1, accuracy, duration), Motion::full}};
}

// With the damper, dissipation in the contact and contacts against a moving head.
TEST(CompliantStop, KeepsTheEnergyInBalance) {
  const Rig rig = damped_impact();
  for (const Bar& bar : bars(1e-8, 2e-3)) {
    SimulationOptions options;
    options.motion = bar.motion;
    const Simulation run = simulate(rig, bar.solver, options);
    EXPECT_LT(std::abs(run.energy.imbalance), 1e-7) << bar.name;
    EXPECT_GT(run.energy.damped, 1e-3 * run.energy.initial) << bar.name;
    EXPECT_GT(run.energy.dissipated, 1e-2 * run.energy.initial) << bar.name;
    EXPECT_GT(run.energy.stop, 0.0) << bar.name;
  }
}

// Without a damper the sensor's impulse is that of its history, by the trapezoidal rule on a smooth
// function: ∫S dt = ∫F dt − m ẋ.
TEST(CompliantStop, KeepsTheMomentumInBalance) {
  Rig rig = damped_impact();
  rig.stop->viscous = 0.0;
  for (const Bar& bar : bars(1e-8, 4e-4)) {
    SimulationOptions options;
    options.motion = bar.motion;
    options.history.interval = 1e-8;
    const Simulation run = simulate(rig, bar.solver, options);
    const std::vector<double>& force = run.history.sensor_force;
    ASSERT_EQ(force.size(), 40001U) << bar.name;
    double sum = -0.5 * force.back();
    for (const double f : force) sum += f;
    EXPECT_NEAR(run.sensor->impulse, sum * 1e-8, 1e-6 * run.impulse) << bar.name;
    const double highest = *std::ranges::max_element(force);
    EXPECT_GE(run.sensor->peak_force, highest * (1.0 - 1e-9)) << bar.name;
    EXPECT_LE(run.sensor->peak_force, highest * (1.0 + 1e-5)) << bar.name;
    EXPECT_GT(std::abs(run.sensor->peak_force / run.peak_force - 1.0), 1e-3) << bar.name;
  }
}

// Every bar to its accuracy, judged by a run 100 times as accurate.
TEST(CompliantStop, IsAsAccurateAsAskedFor) {
  Rig rig = damped_impact();
  for (const double accuracy : {1e-3, 1e-5, 1e-7})
    for (const Bar& bar : bars(accuracy, 3e-4)) {
      SimulationOptions options;
      options.motion = bar.motion;
      Solver tight = bar.solver;
      tight.accuracy = 0.01 * accuracy;
      const Simulation run = simulate(rig, bar.solver, options);
      const Simulation judge = simulate(rig, tight, options);
      SCOPED_TRACE(testing::Message() << bar.name << ", " << accuracy);
      const Episode &a = run.episodes.front(), &b = judge.episodes.front();
      EXPECT_NEAR(a.peak_force / b.peak_force, 1.0, accuracy);
      EXPECT_NEAR(a.impulse / b.impulse, 1.0, accuracy);
      EXPECT_NEAR((a.end - a.start) / (b.end - b.start), 1.0, accuracy);
      EXPECT_NEAR(run.sensor->peak_force / judge.sensor->peak_force, 1.0, accuracy);
      EXPECT_NEAR(run.energy.damped / judge.energy.damped, 1.0, 10.0 * accuracy);
    }
}

// A heavy head on a stiff sensor rings many times under a soft contact, one on a soft spring takes
// little of the energy: what its sensor then carries is far below what its spring would hold all of
// the energy with.
TEST(CompliantStop, ASensorThatCarriesLittleIsAsAccurateAsAskedFor) {
  Rig rig = paper_rig();
  rig.contact.law = "hertz-point";
  rig.contact.counter_modulus = 8e7;
  rig.contact.damping = "viscous";
  rig.contact.restitution = 0.56;
  rig.start.velocity = 0.004;
  for (const Stop& stop : {Stop{6.7, 2.3e11, 600.0}, Stop{0.7, 1e10, 0.0}, Stop{50.0, 1e8, 0.0},
                           Stop{200.0, 1e5, 0.0}})
    for (const double accuracy : {1e-3, 3e-4, 1e-4, 1e-5}) {
      rig.stop = stop;
      SCOPED_TRACE(testing::Message() << stop.mass << " kg, " << accuracy);
      const Simulation run = simulate(rig, rigid(accuracy), small_motion());
      const Simulation judge = simulate(rig, rigid(1e-3 * accuracy), small_motion());
      EXPECT_NEAR(run.sensor->peak_force / judge.sensor->peak_force, 1.0, accuracy);
    }
}

// The full equations of a bar that moves little have the same impact.
TEST(CompliantStop, IsTheSameForSmallMotionAndTheFullEquations) {
  Rig rig = damped_impact();
  rig.start.velocity = 1e-3;
  rig.contact.law = "linear";
  rig.contact.stiffness = 1e8;
  const std::vector<Bar> all = bars(1e-8, 4e-4);
  for (std::size_t i = 0; i < all.size(); i += 2) {
    SimulationOptions options;
    options.motion = Motion::small;
    const Simulation small = simulate(rig, all[i].solver, options);
    options.motion = Motion::full;
    const Simulation full = simulate(rig, all[i + 1].solver, options);
    EXPECT_NEAR(full.peak_force / small.peak_force, 1.0, 1e-6) << all[i].name;
    EXPECT_NEAR(full.sensor->peak_force / small.sensor->peak_force, 1.0, 1e-6) << all[i].name;
    EXPECT_NEAR(full.episodes.front().impulse / small.episodes.front().impulse, 1.0, 1e-6);
  }
}

// A head somewhat heavier than the bar sends it back slowly and comes after it half a period later.
TEST(CompliantStop, MeetsTheBarAgain) {
  Rig rig = sprung(1e8, {});
  const double bar = effective_mass(rig), head = 1.2 * bar;
  rig.stop = Stop{.mass = head, .stiffness = 1e5, .viscous = 0.0};
  Solver solver = rigid(1e-9);
  solver.duration = 0.05;
  const Simulation run = simulate(rig, solver, small_motion());
  ASSERT_EQ(run.episodes.size(), 2U);
  // elastic impact of two free bodies, but for the head's spring: √(k_s / k)
  const double v = rig.start.velocity;
  EXPECT_NEAR(run.episodes[0].impulse / (2.0 * bar * head / (bar + head) * v), 1.0, 0.02);
  EXPECT_NEAR(run.episodes[0].separation_velocity / v, 1.0, 0.02);
  // x = A sin ωt meets the bar that leaves with v (head − bar) / (head + bar)
  const double omega = std::sqrt(1e5 / head);
  const double speed = 2.0 * bar / (bar + head) * v, away = (head - bar) / (bar + head) * v;
  const double meeting =
      root([&](double t) { return speed / omega * std::sin(omega * t) + away * t; },
           std::numbers::pi / omega, 1.5 * std::numbers::pi / omega);
  EXPECT_NEAR(run.episodes[1].start / meeting, 1.0, 0.05);
  EXPECT_LT(std::abs(run.energy.imbalance), 1e-8);
}

/// A head so light that it flies off at first touch and meets the bar again, several times, until
/// both sink in upon its spring.
Rig light_head_on_a_soft_spring(double speed) {
  Rig rig = sprung(1e8, {.mass = 1e-4, .stiffness = 2e5, .viscous = 1.0});
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.3;
  rig.start.velocity = speed;
  rig.gravity = 9.81;
  return rig;
}

// Small motion was judged by its first contact alone, microseconds in which the bar hardly turns,
// and was off by 29 times this accuracy in what the sensor carries a thousand times later.
TEST(CompliantStop, SmallMotionIsJudgedByWhatTheSensorCarriesLater) {
  const double accuracy = 1e-7;
  const auto run = [](double speed, double asked, Motion motion) {
    SimulationOptions options;
    options.motion = motion;
    Solver solver = rigid(asked);
    solver.duration = 6e-3;
    return simulate(light_head_on_a_soft_spring(speed), solver, options);
  };
  const Simulation full = run(40.0, 1e-10, Motion::full), small = run(40.0, 1e-10, Motion::small);
  ASSERT_GT(full.episodes.size(), 2U);
  ASSERT_GT(full.sensor->peak_time, 100.0 * full.episodes.front().end);
  const double error = std::abs(small.sensor->peak_force / full.sensor->peak_force - 1.0);
  EXPECT_GE(small.neglected, error);
  const Simulation chosen = run(40.0, accuracy, Motion::by_accuracy);
  EXPECT_NEAR(chosen.sensor->peak_force / full.sensor->peak_force, 1.0, accuracy);
  EXPECT_TRUE(run(0.1, 1e-5, Motion::by_accuracy).small_motion);
}

/// Ten times as heavy as the bar, which leaves long before its sensor carries most.
Rig heavy_head() {
  Rig rig = sprung(1e8, {});
  rig.stop = Stop{.mass = 10.0 * effective_mass(rig), .stiffness = 1e5, .viscous = 40.0};
  return rig;
}

// Its sensor's peak was 0.3 of what a longer run has: the run ended when the bar had left.
TEST(CompliantStop, ARunThatChoosesItsEndSeesTheSensorsLargestForce) {
  const Rig rig = heavy_head();
  for (const Bar& bar : bars(1e-6, 0.05)) {
    SCOPED_TRACE(bar.name);
    SimulationOptions options;
    options.motion = bar.motion;
    Solver free = bar.solver;
    free.duration.reset();
    const Simulation longer = simulate(rig, bar.solver, options);
    const Simulation run = simulate(rig, free, options);
    EXPECT_EQ(run.termination, "the bar has left the stop for good");
    EXPECT_LT(run.duration, 0.03);
    EXPECT_NEAR(run.sensor->peak_force / longer.sensor->peak_force, 1.0, 2e-6);
    EXPECT_THAT(run.warnings, Not(Contains(HasSubstr("before the sensor carried most"))));
    EXPECT_THAT(longer.warnings, Not(Contains(HasSubstr("before the sensor carried most"))));
    free.duration = 0.005;
    EXPECT_THAT(simulate(rig, free, options).warnings,
                Contains(HasSubstr("the run ended 0.005 s after first touch, before the sensor "
                                   "carried most; state a longer solver.duration")));
  }
}

// A spring throws the bar at a head that nothing damps, again and again, out of step with it.
TEST(CompliantStop, MembersOfEnsemblesTellOfASensorsForceThatIsNotKnown) {
  Rig rig = sprung(1e8, {.mass = 0.02, .stiffness = 4e5});
  rig.hinge.spring = 3e3;
  rig.start.velocity = 0.5;
  Solver solver = rigid(1e-6);  // of 264.49 N 264.48 to 264.52, between 3e-6 and 2e-7
  solver.duration = 0.7;
  EnsembleOptions options;
  options.simulation.motion = Motion::small;
  const auto told = Contains(HasSubstr("the sensor carries most"));
  EXPECT_THAT(simulate(rig, solver, options.simulation).warnings, told);
  const std::vector<Rig> rigs = {rig};
  EXPECT_THAT(simulate_ensemble(rigs, solver, options)[0].simulation.warnings, told);
}

// A run that chooses its end sees every contact of a longer one: the head, swung in far, may still
// reach a bar that has left.
TEST(CompliantStop, LetsNoRunEndWhileTheHeadMayReachTheBar) {
  Rig rig = sprung(1e8, {});
  rig.stop = Stop{.mass = 1.3 * effective_mass(rig), .stiffness = 1e5, .viscous = 0.0};
  for (const Bar& bar : bars(1e-6, 0.08)) {
    SimulationOptions options;
    options.motion = bar.motion;
    Solver free = bar.solver;
    free.duration.reset();
    const Simulation longer = simulate(rig, bar.solver, options);
    const Simulation run = simulate(rig, free, options);
    EXPECT_EQ(run.termination, "the bar has left the stop for good") << bar.name;
    EXPECT_LT(run.duration, 0.08) << bar.name;
    EXPECT_GT(longer.episodes.size(), 1U) << bar.name;
    EXPECT_EQ(run.episodes.size(), longer.episodes.size()) << bar.name;
  }
}

TEST(CompliantStop, IsRefusedWithoutMassOrStiffness) {
  const auto sentence = [](const Stop& stop) -> std::string {
    try {
      simulate(sprung(1e8, stop), rigid(1e-4));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(sentence({0.0, 1e8, 0.0}), "stop.mass: must be greater than zero, found 0 kg");
  EXPECT_EQ(sentence({0.1, -1.0, 0.0}), "stop.stiffness: must be greater than zero, found -1 N/m");
  EXPECT_EQ(sentence({0.1, 1e8, -2.0}),
            "stop.viscous: must be finite and not negative, found -2 N.s/m");
}

/// Long, soft and heavy, it bounces from a stop that rings far faster than it flies.
Rig bar_that_bounces_from_a_fast_head() {
  Rig rig;
  const double width = 0.0455320927, height = 0.1705923108;
  rig.beam = {.length = 77.8483838,
              .area = width * height,
              .second_moment = width * std::pow(height, 3) / 12.0,
              .youngs_modulus = 1.332273270e8,
              .density = 2156.635038};
  rig.contact.position = 9.648221555;
  rig.contact.counterface = Counterface::cylinder;
  rig.contact.radius = 0.5 * height;
  rig.contact.counter_radius = 0.0032855326904186882;
  rig.contact.length = 0.0341707340;
  rig.contact.modulus = 1.332273270e8;
  rig.contact.counter_modulus = 3.015406596e8;
  rig.contact.law = "goldsmith";
  rig.contact.damping = "tangent";
  rig.contact.restitution = 0.29407979;
  rig.start.velocity = 0.01267734617;
  rig.hinge.friction = 0.2494582244;
  rig.stop = Stop{.mass = 2082.86551, .stiffness = 4.17707554e8, .viscous = 3.3048681e6};
  rig.gravity = 9.81;
  return rig;
}

// The end of a flight is found to 1e-9 of its long steps: a touch may begin short of the head.
TEST(CompliantStop, ATouchThatBeginsShortOfTheHeadLasts) {
  const Rig rig = bar_that_bounces_from_a_fast_head();
  const Simulation coarse = simulate(rig, hybrid(Basis::pinned_free, 2, 3e-8, 60.0));
  const Simulation fine = simulate(rig, hybrid(Basis::pinned_free, 2, 1e-8, 60.0));
  ASSERT_EQ(coarse.episodes.size(), fine.episodes.size());
  ASSERT_GT(fine.episodes.size(), 5U);
  for (std::size_t i = 0; i + 1 < fine.episodes.size(); ++i)
    EXPECT_GT(fine.episodes[i].impulse, 0.0) << i;
  EXPECT_NEAR(coarse.episodes[0].impulse / fine.episodes[0].impulse, 1.0, 3e-8);
  EXPECT_LT(std::abs(fine.energy.imbalance), 1e-8);
}

}  // namespace
