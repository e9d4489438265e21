// SPDX-License-Identifier: BSD-3-Clause
// Where the models of the bar are the same and where they part.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <vector>

#include "models/simulation.hpp"
#include "tests/models/link_chain.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;

/// The paper's bar struck at its tip by a linear spring so soft that many modes are at rest under
/// its force; with a linear law the force of small motion is proportional to the speed.
Rig smooth_rig() {
  Rig rig = paper_rig();
  rig.contact.position = rig.beam.length;
  rig.contact.law = "linear";
  rig.contact.stiffness = 2e5;
  return rig;
}

double peak(const Rig& rig, Solver solver, Motion motion) {
  solver.accuracy = 1e-12;
  SimulationOptions options;
  options.motion = motion;
  return simulate(rig, solver, options).episodes.at(0).peak_force;
}

constexpr double long_enough = 0.01;  // [s], contacts of the smooth rig last 7.4 ms

double modal_peak(Basis basis, int modes) {
  return peak(smooth_rig(), hybrid(basis, modes, 1e-12, long_enough), Motion::small);
}

double ancf_peak(int elements) {
  return peak(smooth_rig(), ancf(elements, 0, 1e-12, long_enough), Motion::small);
}

/// Of infinitely many modes k: those left out yield like Σ 1/ω_k², ω_k ~ (k + shift)², that is like
/// (n + shift + 1/2)⁻³ when all of them yield alike, as they do at the tip.
double limit_of_modes(double half, double all, int modes, double shift) {
  const double ratio = std::pow((modes + shift + 0.5) / (0.5 * modes + shift + 0.5), 3);
  return all + (all - half) / (ratio - 1.0);
}

TEST(ModelAgreement, SmallMotionOfAllModelsHasOneLimit) {
  const double pinned = limit_of_modes(modal_peak(Basis::pinned_free, 30),
                                       modal_peak(Basis::pinned_free, 60), 60, 0.25);
  const double clamped = limit_of_modes(modal_peak(Basis::cantilever, 30),
                                        modal_peak(Basis::cantilever, 60), 60, -0.5);
  ConvergenceStudy modes, elements;
  for (const int n : {8, 12, 16, 24, 32})
    modes.add(1.0 / (n + 0.75), modal_peak(Basis::pinned_free, n) / pinned - 1.0);
  EXPECT_NEAR(modes.order(), 3.0, 0.05);
  EXPECT_GT(modes.correlation(), 0.9999);
  // An element is right about the static compliance. What errs is the ringing of first touch, k⁻⁶
  // in mode k: its frequencies are off by (k h)⁴, their phases by k⁶ h⁴, which all modes up to k =
  // h^−2/3 share alike: order 10/3, with scatter from the phases beyond.
  for (const int n : {8, 12, 16, 24, 32, 48, 64})
    elements.add(1.0 / n, ancf_peak(n) / pinned - 1.0);
  EXPECT_NEAR(elements.order(), 10.0 / 3.0, 0.4);
  EXPECT_GT(elements.correlation(), 0.98);
  // the last mesh by that order from the first one's 4e-5, and scatter; the modes by what their
  // tail has beyond n⁻³, 1 / n² of the 1e-6 extrapolated
  EXPECT_NEAR(ancf_peak(64) / pinned, 1.0, 1e-7);
  EXPECT_NEAR(clamped / pinned, 1.0, 5e-9);
}

TEST(ModelAgreement, FullEquationsLeaveSmallMotionWithTheSquareOfTheSpeed) {
  for (const Solver& solver :
       {hybrid(Basis::pinned_free, 4, 1e-12, long_enough),
        hybrid(Basis::cantilever, 4, 1e-12, long_enough), ancf(4, 0, 1e-12, long_enough)}) {
    SCOPED_TRACE(testing::Message() << name(solver.model) << ' ' << name(solver.basis));
    ConvergenceStudy study;
    for (const double speed : {0.2, 0.4, 0.8, 1.6}) {
      Rig rig = smooth_rig();
      rig.start.velocity = speed;
      study.add(speed,
                std::abs(peak(rig, solver, Motion::full) / peak(rig, solver, Motion::small) - 1.0));
    }
    // the next term is the square of the first, 4e-6 of it or less; rounding 1e-12 of 6e-9
    EXPECT_NEAR(study.order(), 2.0, 1e-3);
  }
}

/// A first contact.
struct Caught {
  double peak = 0.0;     // [N]
  double end = 0.0;      // [s]
  double impulse = 0.0;  // [N s]
  double bend = 0.0;     // of the last link against the first at the peak [rad]
};

/// The chain of rigid links caught by the rig's linear spring at the end of a link.
Caught caught_chain(const Rig& rig, int links, double step) {
  LinkChain chain(rig, links);
  const int at = static_cast<int>(std::lround(rig.contact.position / chain.link()));
  const double stiffness = rig.contact.stiffness;
  LinkChain::State y(static_cast<std::size_t>(2 * links), 0.0);
  for (std::size_t i = static_cast<std::size_t>(links); i < y.size(); ++i)
    y[i] = -rig.start.velocity / rig.contact.position;
  boost::numeric::odeint::runge_kutta_fehlberg78<LinkChain::State> stepper;
  const auto slope = [&](const LinkChain::State& s, LinkChain::State& d, double) {
    chain.slope(s, d, at, -stiffness * chain.point(s, at).across);
  };
  Caught caught;
  double before = 0.0, last = 0.0;
  for (double t = step;; t += step) {
    stepper.do_step(slope, y, 0.0, step);
    const LinkChain::Point p = chain.point(y, at);
    const double force = -stiffness * p.across;
    if (force < 0.0) {
      caught.end = t - p.across / p.across_rate;
      return caught;
    }
    if (last > before && last > force) {
      // of the parabola through the last three
      const double curvature = before - 2.0 * last + force;
      const double top = last - 0.125 * (force - before) * (force - before) / curvature;
      if (top > caught.peak) {
        caught.peak = top;
        caught.bend = y[static_cast<std::size_t>(links - 1)] - y[0];
      }
    }
    caught.impulse += step * force;
    before = last;
    last = force;
  }
}

// The first nonlinear term: c in peak = (1 + c v²) times that of small motion. The chain bends and
// turns exactly, and so does ANCF. Hybrid coordinates keep the foreshortening to that order, but
// take v'' for the curvature, Shen et al. (8), and the energy ½ EI v'² v''² they leave out is of
// that order too: their term is theirs, and not even the same in both frames.
TEST(ModelAgreement, TheFirstNonlinearTermIsTheChainsInAncfOnly) {
  std::vector<double> of_chain;
  for (const int links : {6, 12, 24}) {
    Rig rig = smooth_rig();
    const double step = 8e-6;  // a radian of the fastest vibration of 24 links
    rig.start.velocity = 8.0;
    const double fast = caught_chain(rig, links, step).peak / 8.0;
    rig.start.velocity = 0.01;
    const double slow = caught_chain(rig, links, step).peak / 0.01;
    of_chain.push_back((fast / slow - 1.0) / 64.0);
  }
  const double chain = extrapolated(of_chain[0], of_chain[1], of_chain[2]);
  const auto term = [](const Rig& still, const Solver& solver) {
    Rig rig = still;
    rig.start.velocity = 0.8;
    return (peak(rig, solver, Motion::full) / peak(rig, solver, Motion::small) - 1.0) / 0.64;
  };
  Rig taut = smooth_rig();  // ten times the EA, the same EI
  taut.beam.youngs_modulus *= 10.0;
  taut.beam.second_moment *= 0.1;
  const Solver elements = ancf(16, 0, 1e-12, long_enough);
  const double stretching = term(smooth_rig(), elements);
  const double stretching_less = term(taut, elements);
  const double inextensible = stretching_less + (stretching_less - stretching) / 9.0;
  // the chain's extrapolation is good to 2 %: 8, 16 and 32 links give -1.654e-7 (s/m)^2
  EXPECT_NEAR(inextensible / chain, 1.0, 0.03);
  for (const Basis basis : {Basis::pinned_free, Basis::cantilever}) {
    const double of_modes = term(smooth_rig(), hybrid(basis, 6, 1e-12, long_enough));
    EXPECT_GT(of_modes / chain, 3.0) << name(basis);
  }
}

/// A bar that bends by 45 degrees when a spring catches it.
Rig soft_rig(double extensibility) {
  Rig rig;
  rig.beam.length = 0.8;
  rig.beam.area = 1e-4;
  rig.beam.density = 1000.0;
  rig.beam.second_moment = extensibility * rig.beam.area * rig.beam.length * rig.beam.length;
  rig.beam.youngs_modulus = 0.2 / rig.beam.second_moment;
  rig.contact = paper_rig().contact;
  rig.contact.position = 0.6;
  rig.contact.law = "linear";
  rig.contact.stiffness = 300.0;
  rig.start.velocity = 24.0;
  rig.gravity = 0.0;
  return rig;
}

TEST(ModelAgreement, InALargeDeformationAncfIsWithTheChainAndTheOthersAreNot) {
  const Rig rig = soft_rig(1.0);
  const Caught coarse = caught_chain(rig, 8, 2e-5), medium = caught_chain(rig, 16, 2e-5),
               fine = caught_chain(rig, 32, 2e-5);
  const Caught chain{extrapolated(coarse.peak, medium.peak, fine.peak),
                     extrapolated(coarse.end, medium.end, fine.end),
                     extrapolated(coarse.impulse, medium.impulse, fine.impulse), fine.bend};
  const auto apart = [&](double extensibility, const Solver& solver, Motion motion) {
    SimulationOptions options;
    options.motion = motion;
    const Episode first = simulate(soft_rig(extensibility), solver, options).episodes.at(0);
    return std::max({std::abs(first.peak_force / chain.peak - 1.0),
                     std::abs(first.end / chain.end - 1.0),
                     std::abs(first.impulse / chain.impulse - 1.0)});
  };
  // the spin of 40 rad/s stretches the bar by 110 of these, twice that as it rings, and every
  // figure takes its share; mesh and chain are good to 1e-3
  for (const double extensibility : {1e-4, 1e-5})
    EXPECT_LT(apart(extensibility, ancf(12, 4, 1e-7, 0.1), Motion::full),
              400.0 * extensibility + 1e-3);
  EXPECT_LT(chain.bend, -0.7) << "the scene does not show what it is for";
  for (const Basis basis : {Basis::pinned_free, Basis::cantilever})
    EXPECT_GT(apart(1e-4, hybrid(basis, 8, 1e-7, 0.1), Motion::full), 0.05) << name(basis);
  EXPECT_GT(apart(1e-4, hybrid(Basis::pinned_free, 8, 1e-7, 0.1), Motion::small), 0.1);
}

}  // namespace
