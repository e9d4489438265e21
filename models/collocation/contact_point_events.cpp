// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "models/collocation/contact_point.hpp"

namespace impactrig::models {

/// Between two places of the step on either side of a closing or opening of the gap, the first with
/// this displacement.
double ContactPoint::root_of_gap(double low, double at_low, double guess, double high) {
  const double h = bar_.step();
  double middle = guess > low && guess < high ? guess : 0.5 * (low + high);
  const double sign =
      at_low != 0.0 ? (at_low < 0.0 ? 1.0 : -1.0) : (contact_.phase() == Phase::free ? 1.0 : -1.0);
  for (int i = 0; i < 60; ++i) {
    double acceleration = 0.0;
    const PointMotion p = struck_at(middle, &acceleration);
    (sign * p.displacement > 0.0 ? high : low) = middle;
    // Halley's method
    const double newton = p.displacement / (p.velocity * h);
    double next = middle - newton / (1.0 - 0.5 * newton * h * acceleration / p.velocity);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - middle) < 1e-13) return next;
    middle = next;
  }
  return middle;
}

/// Where the gap closes or opens between two looks at the struck point; 2 where it does not.
double ContactPoint::gap_between(double before, const PointMotion& p0, double here,
                                 const PointMotion& p1) {
  // the event is sign * displacement rising through zero
  const double sign = contact_.phase() == Phase::free ? 1.0 : -1.0;
  // a phase begins at zero, whatever rounding leaves of it
  const double at_low = before > 0.0 ? p0.displacement : 0.0;
  const auto root = [&](double place, double displacement) {
    const double chord = before + (place - before) * at_low / (at_low - displacement);
    return root_of_gap(before, at_low, chord, place);
  };
  if (sign * p1.displacement > 0.0) return root(here, p1.displacement);
  if (!(sign * p0.velocity > 0.0 && sign * p1.velocity < 0.0)) return 2.0;
  // it turned on the way; by its mean deceleration, was that beyond the gap's zero, or nearly?
  const double h = bar_.step();
  const double turn = p0.velocity / (p0.velocity - p1.velocity);
  const double way = 0.5 * turn * (here - before) * h * p0.velocity;
  if (!(sign * p0.displacement + 2.0 * std::abs(way) > 0.0)) return 2.0;
  double place = before + turn * (here - before);
  double acceleration = 0.0;
  for (int k = 0; k < 3; ++k) {
    const PointMotion p = struck_at(place, &acceleration);
    if (acceleration == 0.0) break;
    place = std::clamp(place - p.velocity / (acceleration * h), before, here);
  }
  const double there = struck_at(place).displacement;
  return sign * there > 0.0 ? root(place, there) : 2.0;
}

/// Likewise where the laws begin or cease to act.
double ContactPoint::switch_between(double before, double here, const PointMotion& p1) {
  if (!contact_.may_switch()) return 2.0;
  const auto beyond = [&](const PointMotion& p) {
    return contact_.switching(p.displacement, p.velocity).value < 0.0;
  };
  if (!beyond(p1)) return 2.0;
  double low = before, high = here;
  for (int k = 0; k < 60 && high - low > 1e-14; ++k) {
    const double middle = 0.5 * (low + high);
    (beyond(struck_at(middle)) ? high : low) = middle;
  }
  return high;
}

/// Looked for between the nodes and both ends.
void ContactPoint::find_event() {
  forget_event();
  const int s = rule_.nodes();
  double before = 0.0;
  PointMotion p0 = struck();
  for (int i = 0; i <= s; ++i) {
    const double here = i < s ? rule_.points()[i] : 1.0;
    const PointMotion p1 =
        i < s ? PointMotion{step_.displacement[i], step_.velocity[i]} : step_.at_end;
    const double gap = gap_between(before, p0, here, p1);
    const double change = switch_between(before, here, p1);
    if (gap <= 1.0 || change <= 1.0) {
      event_ = gap <= change ? Event::gap : Event::change;
      event_part_ = std::min(gap, change);
      return;
    }
    before = here;
    p0 = p1;
  }
}

double ContactPoint::lateness() const {
  const PointMotion& p = step_.at_end;
  return p.velocity != 0.0 ? p.displacement / (p.velocity * bar_.step()) : 0.0;
}

}  // namespace impactrig::models
