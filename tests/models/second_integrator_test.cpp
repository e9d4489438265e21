// SPDX-License-Identifier: BSD-3-Clause
// The same bar and contact carried through time by Boost.Odeint instead of our integrator, with
// events found by halving steps: peak force and separation must not depend on who integrates.
#include <gtest/gtest.h>

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/contact/contact_force.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

struct FirstContact {
  double peak = 0.0;
  double separation = 0.0;
};

class OtherIntegrator {
 public:
  OtherIntegrator(const Rig& rig, BeamDynamics& beam)
      : beam_(beam),
        contact_(rig),
        n_(beam.size()) {
    state_.assign(static_cast<std::size_t>(2 * n_), 0.0);
    beam.set_steady_motion(0.0, rig.start.velocity / rig.contact.position, q(state_), v(state_));
    contact_.begin_episode(rig.start.velocity);
    contact_.set_phase(ContactForce::Phase::pressed);
  }

  FirstContact run(double step) {
    FirstContact found;
    // steps grow from the corner of the contact law, and are halved towards it at the end
    double h = 1e-4 * step;
    double t = 0.0;
    std::vector<double> forces(3, 0.0);
    while (h > 1e-13) {
      State next = state_;
      advance(next, h);
      if (moves(next).displacement <= 0.0) {
        h *= 0.5;
        continue;
      }
      if (force(next) < force(state_) && force(state_) > found.peak)
        found.peak = std::max(found.peak, highest_around(h));
      previous_ = state_;
      before_ = h;
      state_ = next;
      t += h;
      h = std::min(1.3 * h, step);
      if (moves(state_).velocity < 0.0)  // towards the end: not past the linear guess
        h = std::min(h,
                     std::max(0.5 * moves(state_).displacement / -moves(state_).velocity, 1e-13));
      if (h <= 1e-13) break;
    }
    const PointMotion last = moves(state_);
    found.separation = t - last.displacement / last.velocity;
    return found;
  }

 private:
  using State = std::vector<double>;

  Eigen::Map<Eigen::VectorXd> q(State& s) const { return {s.data(), n_}; }

  Eigen::Map<Eigen::VectorXd> v(State& s) const { return {s.data() + n_, n_}; }

  PointMotion moves(const State& s) const {
    return beam_.struck_point(Eigen::Map<const Eigen::VectorXd>(s.data(), n_),
                              Eigen::Map<const Eigen::VectorXd>(s.data() + n_, n_));
  }

  double force(const State& s) const {
    const PointMotion p = moves(s);
    return contact_.force(p.displacement, p.velocity);
  }

  void advance(State& s, double h) {
    boost::numeric::odeint::runge_kutta_fehlberg78<State> stepper;
    stepper.do_step(
        [&](const State& y, State& slope, double) {
          const Eigen::Map<const Eigen::VectorXd> yq(y.data(), n_);
          const Eigen::Map<const Eigen::VectorXd> yv(y.data() + n_, n_);
          Eigen::VectorXd a(n_);
          beam_.acceleration(yq, yv, force(y), a);
          slope.assign(y.begin() + n_, y.end());
          slope.insert(slope.end(), a.begin(), a.end());
        },
        s, 0.0, h);
  }

  /// Largest force from the previous state to a step h after the present one, by golden section.
  double highest_around(double h) {
    const State from = previous_.empty() ? state_ : previous_;
    const double length = previous_.empty() ? h : before_ + h;
    const auto at = [&](double t) {
      State s = from;
      advance(s, 0.5 * t);
      advance(s, 0.5 * t);
      return force(s);
    };
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    double low = 0.0, high = length;
    double a = high - golden * length, b = low + golden * length;
    double fa = at(a), fb = at(b);
    while (high - low > 1e-5 * length) {
      if (fa < fb) {
        low = a;
        a = b;
        fa = fb;
        b = low + golden * (high - low);
        fb = at(b);
      } else {
        high = b;
        b = a;
        fb = fa;
        a = high - golden * (high - low);
        fa = at(a);
      }
    }
    return std::max(fa, fb);
  }

  BeamDynamics& beam_;
  ContactForce contact_;
  int n_;
  State state_, previous_;
  double before_ = 0.0;
};

void expect_agreement(const Rig& rig, const Solver& solver, BeamDynamics& beam, double step) {
  const FirstContact other = OtherIntegrator(rig, beam).run(step);
  const Simulation run = simulate(rig, solver);
  EXPECT_NEAR(run.episodes.at(0).peak_force / other.peak, 1.0, 1e-8);
  EXPECT_NEAR(run.episodes.at(0).end / other.separation, 1.0, 1e-8);
}

TEST(SecondIntegrator, AgreesForHybridCoordinatesWithAxialModes) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  for (Basis basis : {Basis::cantilever, Basis::pinned_free}) {
    Solver solver = hybrid(basis, 3, 1e-12, 2.5e-4);
    solver.axial_modes = 1;
    FloatingFrameBeam beam(rig, basis, 3, 1);
    expect_agreement(rig, solver, beam, 4e-7);
  }
}

TEST(SecondIntegrator, AgreesForAncf) {
  const Rig rig = paper_rig();
  AncfBeam beam(rig, {3, 1});
  expect_agreement(rig, ancf(3, 1, 1e-12, 4e-4), beam, 4e-7);
}

TEST(SecondIntegrator, AgreesForARigidBar) {
  Rig rig = paper_rig();
  rig.contact.damping = "exact";
  rig.contact.restitution = 0.2;
  FloatingFrameBeam beam(rig, Basis::cantilever, 0, 0);
  expect_agreement(rig, rigid(1e-12), beam, 4e-7);
}

}  // namespace
