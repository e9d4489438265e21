// SPDX-License-Identifier: BSD-3-Clause
// A bent bar thrown round its hinge: it turns by more than a radian and flexes by a third of its
// length meanwhile. ANCF against a chain of rigid links.
#include <gtest/gtest.h>

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <vector>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "tests/models/link_chain.hpp"
#include "tests/models/scenes.hpp"
#include "tests/support/convergence_study.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Vector = Eigen::VectorXd;
using State = std::vector<double>;
namespace odeint = boost::numeric::odeint;

constexpr double spin = 20.0;      // [rad/s]
constexpr double duration = 0.06;  // [s]
constexpr double bend = 1.0;       // [rad], between the ends of the bar at first

/// EI as of a bar whose first bending frequency is near the spin, EA from the ratio I / (A L²).
Rig thrown_rig(double extensibility) {
  Rig rig;
  rig.beam.length = 0.8;
  rig.beam.area = 1e-4;
  rig.beam.density = 1000.0;
  rig.beam.second_moment = extensibility * rig.beam.area * rig.beam.length * rig.beam.length;
  rig.beam.youngs_modulus = 0.2 / rig.beam.second_moment;
  rig.contact.position = 0.6;
  rig.gravity = 9.81;
  return rig;
}

/// Angle of the bent bar, ξ = x / L: curvature ~ ξ³ (1 − ξ)⁴, so that its ends are free of moment
/// and shear and nothing begins with a jump.
double start_angle(double xi) {
  const double a = xi * xi * xi * xi;
  return 280.0 * bend * a *
         (1.0 / 4.0 - xi * (4.0 / 5.0 - xi * (1.0 - xi * (4.0 / 7.0 - xi / 8.0))));
}

struct Start {
  double across = 0.0, along = 0.0;  // of a place of the bent bar [m]
};

/// Integral of the bent bar's direction, by Gauss points on panels of a tenth of a wave or less.
Start start_at(const Rig& rig, double xi) {
  constexpr double points[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
  constexpr double weights[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const int panels = 200;
  const double panel = xi / panels;
  Start start;
  for (int p = 0; p < panels; ++p)
    for (int g = 0; g < 3; ++g) {
      const double angle = start_angle(panel * (p + 0.5 + 0.5 * points[g]));
      start.across += rig.beam.length * panel * weights[g] * std::sin(angle);
      start.along += rig.beam.length * panel * weights[g] * std::cos(angle);
    }
  return start;
}

struct Tip {
  double across = 0.0, along = 0.0;
};

Tip chain_tip(int links) {
  LinkChain chain(thrown_rig(1.0), links);
  State y(static_cast<std::size_t>(2 * links), spin);
  for (int i = 0; i < links; ++i) y[static_cast<std::size_t>(i)] = start_angle((i + 0.5) / links);
  const auto slope = [&](const State& s, State& d, double) { chain.slope(s, d); };
  odeint::integrate_adaptive(
      odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(1e-11, 1e-11), slope, y, 0.0,
      duration, 1e-4);
  const LinkChain::Point p = chain.point(y, links);
  return {p.across, p.along};
}

Tip ancf_tip(double extensibility, int elements) {
  const Rig rig = thrown_rig(extensibility);
  AncfBeam beam(rig, {3 * elements / 4, elements / 4});
  const int n = beam.size();
  const int m = n / 2;
  State y(static_cast<std::size_t>(2 * n));
  Eigen::Map<Vector> q(y.data(), n), v(y.data() + n, n);
  // X and Y = −x + U of the nodes, turning about the hinge as a rigid body
  for (int node = 0; node <= elements; ++node) {
    const double xi = static_cast<double>(node) / elements;
    const double angle = start_angle(xi);
    const int slope = 2 * node;
    q[slope] = std::sin(angle);
    q[m + slope] = 1.0 - std::cos(angle);
    v[slope] = spin * std::cos(angle);
    v[m + slope] = spin * std::sin(angle);
    if (node == 0) continue;
    const Start start = start_at(rig, xi);
    q[slope - 1] = start.across;
    q[m + slope - 1] = rig.beam.length * xi - start.along;
    v[slope - 1] = spin * start.along;
    v[m + slope - 1] = spin * start.across;
  }
  const auto slope = [&](const State& s, State& d, double) {
    const Eigen::Map<const Vector> sq(s.data(), n), sv(s.data() + n, n);
    std::copy(s.begin() + n, s.end(), d.begin());
    beam.acceleration(sq, sv, 0.0, Eigen::Map<Vector>(d.data() + n, n));
  };
  odeint::integrate_adaptive(
      odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(1e-10, 1e-10), slope, y, 0.0,
      duration, 1e-6);
  return {q[m - 2], rig.beam.length - q[n - 2]};
}

/// The continuous model by finite differences, no elements: masses ρA h at places r_i, links of
/// strain ½ (|Δr|² / h² − 1) and EA, curvature Δ²r / h² and EI at every place between. Error ~ h².
Tip differences_tip(double extensibility, int links) {
  const Rig rig = thrown_rig(extensibility);
  const double h = rig.beam.length / links;
  const double stretching = rig.beam.youngs_modulus * rig.beam.area;
  const double bending = rig.beam.youngs_modulus * rig.beam.second_moment;
  const double node = rig.beam.density * rig.beam.area * h;
  using Places = Eigen::Matrix2Xd;  // across and along (2, links + 1)
  const int size = 2 * (links + 1);
  State y(static_cast<std::size_t>(2 * size), 0.0);
  Eigen::Map<Places> r(y.data(), 2, links + 1), u(y.data() + size, 2, links + 1);
  for (int i = 1; i <= links; ++i) {
    const Start start = start_at(rig, static_cast<double>(i) / links);
    r.col(i) << start.across, start.along;
    u.col(i) << spin * start.along, -spin * start.across;
  }
  const auto slope = [&](const State& s, State& d, double) {
    const Eigen::Map<const Places> place(s.data(), 2, links + 1);
    std::copy(s.begin() + size, s.end(), d.begin());
    Eigen::Map<Places> a(d.data() + size, 2, links + 1);
    a.setZero();
    for (int i = 0; i < links; ++i) {
      const Eigen::Vector2d t = (place.col(i + 1) - place.col(i)) / h;
      const Eigen::Vector2d tension = stretching * 0.5 * (t.squaredNorm() - 1.0) * t;
      a.col(i) += tension;
      a.col(i + 1) -= tension;
      if (i == 0) continue;
      const Eigen::Vector2d moment =
          bending / (h * h * h) * (place.col(i + 1) - 2.0 * place.col(i) + place.col(i - 1));
      a.col(i - 1) -= moment;
      a.col(i) += 2.0 * moment;
      a.col(i + 1) -= moment;
    }
    a /= node;
    a.col(links) *= 2.0;  // half a mass
    a.row(1).array() += rig.gravity;
    a.col(0).setZero();
  };
  odeint::integrate_adaptive(
      odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(1e-10, 1e-10), slope, y, 0.0,
      duration, 1e-6);
  return {r(0, links), r(1, links)};
}

double distance(const Tip& a, const Tip& b) {
  return std::hypot(a.across - b.across, a.along - b.along);
}

/// The tip had the bar kept its first shape.
Tip stiff_tip() {
  LinkChain chain(thrown_rig(1.0), 64);
  State y(128, spin);
  for (std::size_t i = 0; i < 64; ++i)
    y[i] = start_angle((static_cast<double>(i) + 0.5) / 64.0) + spin * duration;
  const LinkChain::Point p = chain.point(y, 64);
  return {p.across, p.along};
}

TEST(AncfLargeRotation, FollowsTheInextensibleChainWithOrderOneInExtensibility) {
  const double length = thrown_rig(1.0).beam.length;
  const Tip coarse = chain_tip(16), medium = chain_tip(32), fine = chain_tip(64);
  // good to 2e-5 m, as 128 links show
  const Tip chain{extrapolated(coarse.across, medium.across, fine.across),
                  extrapolated(coarse.along, medium.along, fine.along)};
  EXPECT_GT(distance(chain, stiff_tip()), 0.3 * length) << "the scene does not show what it is for";
  ConvergenceStudy study;
  for (const double extensibility : {1e-4, 2.5e-5, 6.25e-6}) {
    const double difference = distance(ancf_tip(extensibility, 12), chain);
    study.add(extensibility, difference);
    // The spin stretches the bar by ρ ω² L² / 3 E = 27 of these, twice that as it sets in with a
    // jump; as much again for what the bar does with another length.
    EXPECT_LT(difference, 110.0 * extensibility * length) << extensibility;
  }
  // the stretch rings, and its phase at the end depends on EA
  EXPECT_NEAR(study.order(), 1.0, 0.15);
  EXPECT_GT(study.correlation(), 0.99);
}

TEST(AncfLargeRotation, AgreesWithDifferencesOfItsContinuousEquations) {
  const double extensibility = 1e-4;
  const Tip first = differences_tip(extensibility, 16), second = differences_tip(extensibility, 32),
            third = differences_tip(extensibility, 64),
            fourth = differences_tip(extensibility, 128);
  const auto limit = [](const Tip& coarse, const Tip& medium, const Tip& fine) {
    return Tip{extrapolated(coarse.across, medium.across, fine.across),
               extrapolated(coarse.along, medium.along, fine.along)};
  };
  const Tip continuous = limit(second, third, fourth);
  // halving h takes at least a factor 16 off what extrapolation leaves of h⁴ and more: 1e-6 m
  const double uncertainty = distance(continuous, limit(first, second, third)) / 15.0;
  EXPECT_LT(uncertainty, 2e-6);
  EXPECT_LT(distance(ancf_tip(extensibility, 24), continuous), 2.0 * uncertainty);
  // a coarser mesh is told from it
  EXPECT_GT(distance(ancf_tip(extensibility, 8), continuous), 20.0 * uncertainty);
}

}  // namespace
