// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "tests/models/reference/impact_run.hpp"

namespace impactrig::models {
namespace {

/// The polynomial of degree five through position, velocity and acceleration at both ends of a
/// step, over θ in [0, 1].
class Quintic {
 public:
  Quintic(const PointMotion& p0, double a0, const PointMotion& p1, double a1, double h)
      : c_{p0.displacement, h * p0.velocity, 0.5 * h * h * a0, 0.0, 0.0, 0.0} {
    const double way = p1.displacement - c_[0] - c_[1] - c_[2];
    const double speed = h * p1.velocity - c_[1] - 2.0 * c_[2];
    const double bend = h * h * a1 - 2.0 * c_[2];
    c_[3] = 10.0 * way - 4.0 * speed + 0.5 * bend;
    c_[4] = -15.0 * way + 7.0 * speed - bend;
    c_[5] = 6.0 * way - 3.0 * speed + 0.5 * bend;
  }

  double value(double t) const {
    return c_[0] + t * (c_[1] + t * (c_[2] + t * (c_[3] + t * (c_[4] + t * c_[5]))));
  }

  double slope(double t) const {
    return c_[1] + t * (2.0 * c_[2] + t * (3.0 * c_[3] + t * (4.0 * c_[4] + t * 5.0 * c_[5])));
  }

 private:
  std::array<double, 6> c_;
};

}  // namespace

/// Looks for the first end of the phase within the attempted step: a crossing by the step's end, or
/// a gap that closes and opens again (or a contact that opens and closes) inside the step.
bool ImpactRun::event_in_attempt(double& theta, bool& at_pull) {
  const Phase phase = contact_.phase();
  // the event is sign * displacement rising through zero
  const double sign = phase == Phase::free ? 1.0 : -1.0;
  theta = 2.0;
  const PointMotion to = struck(stepper_.attempted());
  if (const double turn = excursion_in_attempt(sign); turn <= 1.0) {
    theta = root_of_event(false, 0.0, turn);
    at_pull = false;
  } else if (sign * to.displacement > 0.0) {
    theta = root_of_event(false, 0.0, 1.0);
    at_pull = false;
  }
  if (contact_.may_switch() && contact_.switching(to.displacement, to.velocity).value < 0.0) {
    const double root = root_of_event(true, 0.0, 1.0);
    if (root < theta) {
      theta = root;
      at_pull = true;
    }
  }
  return theta <= 1.0;
}

/// Where sign * displacement has a maximum above zero inside the attempted step; 2 without one. The
/// quintic through displacement, velocity and acceleration at both ends shows without evaluations
/// where the point turns; the dense output decides when that is near zero.
double ImpactRun::excursion_in_attempt(double sign) {
  const double h = stepper_.step();
  const PointMotion p0 = struck(stepper_.state());
  const PointMotion p1 = struck(stepper_.attempted());
  const Quintic way(p0, acceleration(stepper_.state(), stepper_.slope()), p1,
                    acceleration(stepper_.attempted(), stepper_.attempted_slope()), h);
  constexpr int parts = 8;
  double range = 0.0;
  for (int i = 0; i <= parts; ++i)
    range = std::max(range, std::abs(way.value(static_cast<double>(i) / parts) - p0.displacement));
  for (int i = 0; i < parts; ++i) {
    double low = static_cast<double>(i) / parts;
    double high = static_cast<double>(i + 1) / parts;
    if (!(sign * way.slope(low) > 0.0 && sign * way.slope(high) <= 0.0)) continue;
    if (std::max(sign * way.value(low), sign * way.value(high)) < -0.1 * range) continue;
    low = std::max(0.0, low - 0.5 / parts);
    high = std::min(1.0, high + 0.5 / parts);
    const auto outside = [&](double theta) {
      stepper_.dense(theta, f_, scratch_);
      return -sign * gap_event(scratch_);
    };
    const auto [turn, value] = boost::math::tools::brent_find_minima(outside, low, high, 20);
    if (value < 0.0) return turn;
  }
  return 2.0;
}

double ImpactRun::root_of_event(bool pull, double low, double high) {
  const auto value = [&](double theta) {
    stepper_.dense(theta, f_, scratch_);
    return pull ? switch_event(scratch_) : gap_event(scratch_);
  };
  double at_low = value(low);
  const double at_high = value(high);
  // A phase begins on its own event, where the value is a zero of rounding with either sign: start
  // a little later.
  for (double ahead = 1e-4; at_low * at_high >= 0.0 && ahead < 1.0; ahead *= 2.0) {
    low = ahead * high;
    at_low = value(low);
  }
  if (at_low * at_high >= 0.0) return 0.0;  // it never left the event
  std::uintmax_t most = 60;
  const auto [a, b] = boost::math::tools::toms748_solve(
      value, low, high, at_low, at_high, boost::math::tools::eps_tolerance<double>(48), most);
  return 0.5 * (a + b);
}

/// Steps onto the event: the root of the dense output, then one secant correction with full steps,
/// so that the state there has the order of the method. Returns the error of that step: it ends in
/// the corner of the contact law, which the longer step may have jumped over with a lucky estimate.
double ImpactRun::land_on(double theta, bool pull) {
  const double whole = stepper_.step();
  double h = theta * whole;
  double error = stepper_.attempt(h, weights_, f_);
  const PointMotion p = struck(stepper_.attempted());
  if (!pull && p.velocity != 0.0) {
    const double correction = -p.displacement / p.velocity;
    if (std::abs(correction) < 0.01 * h) {
      h += correction;
      error = stepper_.attempt(h, weights_, f_);
    }
  }
  return error;
}

}  // namespace impactrig::models
