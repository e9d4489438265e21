// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "models/collocation/contact_point.hpp"

namespace impactrig::models {
namespace {

// How much deeper than the parabola through three places a dip may be, and of their values.
constexpr double safe_dips = 3.0, least_dip = 1e-3;
// Of the last terms of the velocity's series at the nodes, how much it may differ between them; how
// many times as close it is looked at there.
constexpr double unresolved = 4.0;
constexpr int closer_looks = 4;
// A correction by Halley's method that leaves only rounding, of the step: it leaves its own cube.
constexpr double last_correction = 1e-6;

/// Of the cubic from one value to another with these rates there, over an interval of length 1, a
/// zero within; NaN where Newton's method finds none.
double zero_of_cubic(double from, double rate_from, double to, double rate_to) {
  const double third = 2.0 * (from - to) + rate_from + rate_to;
  const double second = 3.0 * (to - from) - 2.0 * rate_from - rate_to;
  double place = from == 0.0 ? 1.0 : from / (from - to);
  for (int i = 0; i < 4; ++i) {
    const double value = ((third * place + second) * place + rate_from) * place + from;
    place -= value / ((3.0 * third * place + 2.0 * second) * place + rate_from);
  }
  return place > 0.0 && place < 1.0 ? place : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

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
    const bool inside = next > low && next < high;
    if (inside && std::abs(next - middle) < last_correction) return next;
    if (!inside) next = 0.5 * (low + high);
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
  const double h = bar_.step();
  const auto root = [&](double place, const PointMotion& p) {
    const double time = (place - before) * h;
    const double part =
        zero_of_cubic(at_low, p0.velocity * time, p.displacement, p.velocity * time);
    return root_of_gap(before, at_low, before + part * (place - before), place);
  };
  const auto still_enters = [&](const PointMotion& p) {
    return sign * p.displacement > 0.0 && sign * p.velocity < 0.0;
  };
  // a phase that began short of its zero, by what landing there leaves, is still on its way in
  if (still_enters(p0) && still_enters(p1)) return 2.0;
  if (sign * p1.displacement > 0.0) return root(here, p1);
  if (!(sign * p0.velocity > 0.0 && sign * p1.velocity < 0.0)) return 2.0;
  // it turned on the way; by its mean deceleration, was that beyond the gap's zero, or nearly?
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
  const PointMotion there = struck_at(place);
  return sign * there.displacement > 0.0 ? root(place, there) : 2.0;
}

/// Of the function whose sign tells where the laws begin or cease to act.
double ContactPoint::switch_at(double place) {
  const PointMotion p = struck_at(place);
  return contact_.switching(p.displacement, p.velocity).value;
}

/// Where the laws begin or cease to act, between a place before that and one beyond.
double ContactPoint::root_of_switch(double low, double high) {
  for (int k = 0; k < 60 && high - low > 1e-14; ++k) {
    const double middle = 0.5 * (low + high);
    (switch_at(middle) < 0.0 ? high : low) = middle;
  }
  return high;
}

/// The same by a dip below zero between places at which it is above; 2 where there is none.
/// `middle` is the lowest of the three.
double ContactPoint::switch_in_dip(const Look& first, const Look& middle, const Look& last) {
  const double left = middle.place - first.place, right = last.place - middle.place;
  const double falls = (first.value - middle.value) / left;
  const double rises = (last.value - middle.value) / right;
  const double bend = (falls + rises) / (left + right);
  const double slope = (rises * left - falls * right) / (left + right);
  const double dip = 0.25 * slope * slope / bend;  // of the parabola
  if (!(middle.value < safe_dips * dip + least_dip * (first.value + last.value))) return 2.0;
  constexpr double golden = 0.6180339887498949;
  double low = first.place, high = last.place;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = switch_at(a), at_b = switch_at(b);
  for (int k = 0; k < 30; ++k) {
    if (at_a < 0.0) return root_of_switch(first.place, a);
    if (at_b < 0.0) return root_of_switch(first.place, b);
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - golden * (high - low);
      at_a = switch_at(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + golden * (high - low);
      at_b = switch_at(b);
    }
  }
  return 2.0;
}

/// The same between a place at which it is above and the gap's zero; 2 where there is none. Where
/// damping falls faster than the elastic force, as Hertz's does before a linear one, what would
/// pull presses again just before, and looks beyond the gap do not tell.
double ContactPoint::switch_before_gap(double place, double gap) {
  constexpr int halvings = 10;  // what is nearer has no impulse
  if (!contact_.may_switch() || contact_.form() == DampingForm::proportional) return 2.0;
  for (double left = 0.5 * (gap - place); left > std::ldexp(gap - place, -halvings); left *= 0.5)
    if (switch_at(gap - left) < 0.0) return root_of_switch(place, gap - left);
  return 2.0;
}

/// Whether a few looks at the nodes and both ends tell that no phase ends between them.
bool ContactPoint::certainly_goes_on() const {
  const PointMotion first = struck(), &last = step_.at_end;
  const double fastest = std::max({step_.velocity.maxCoeff(), first.velocity, last.velocity});
  const double slowest = std::min({step_.velocity.minCoeff(), first.velocity, last.velocity});
  const bool flies = contact_.phase() == Phase::free;
  const double nearest = flies ? std::max(step_.displacement.maxCoeff(), last.displacement)
                               : -std::min(step_.displacement.minCoeff(), last.displacement);
  const double speed = flies ? fastest : -slowest;
  // a phase begins at the gap's zero, and leaves it
  const bool leaves = flies ? first.velocity <= 0.0 : first.velocity >= 0.0;
  const double begun = flies ? first.displacement : -first.displacement;
  if (!leaves && !(begun + speed * bar_.step() < 0.0)) return false;
  if (!(nearest + std::max(speed, 0.0) * bar_.step() < 0.0)) return false;
  if (!contact_.may_switch()) return true;
  if (contact_.form() != DampingForm::proportional) return false;
  const double a = contact_.switching(0.0, fastest).value;
  const double b = contact_.switching(0.0, slowest).value;
  // by nodes of a rule the parabola of a dip goes no deeper than 0.9 of what the looks differ by
  return std::min(a, b) > safe_dips * std::abs(a - b) + 2.0 * least_dip * std::max(a, b);
}

/// Whether what the nodes do not resolve of the motion may lead to where the laws begin or cease to
/// act, and back, between two of them.
bool ContactPoint::may_switch_unseen() const {
  if (!contact_.may_switch() || !bar_.parts_exact()) return false;
  const double unseen = unresolved * (rule_.to_series() * step_.velocity).tail<2>().norm();
  for (int i = 0; i < rule_.nodes(); ++i) {
    const ContactForce::Switch here = contact_.switching(step_.displacement[i], step_.velocity[i]);
    if (here.value < std::abs(here.to_rate) * unseen) return true;
  }
  return false;
}

ContactPoint::Look ContactPoint::look(double place, const PointMotion& p) const {
  const bool may_switch = contact_.may_switch();
  return {place, may_switch ? contact_.switching(p.displacement, p.velocity).value : 1.0};
}

/// Looks on, from the places seen to another; true where an event lies before it, the first.
bool ContactPoint::look_on(Seen& seen, double here, const PointMotion& p) {
  const double gap = gap_between(seen.last.place, seen.motion, here, p);
  const Look last = look(here, p);
  const Look &first = seen.first, &middle = seen.last;
  double change = 2.0;
  if (last.value < 0.0)
    change = root_of_switch(middle.place, here);
  else if (first.place < middle.place && first.value > middle.value && middle.value >= 0.0 &&
           middle.value < last.value)
    change = switch_in_dip(first, middle, last);
  if (gap < change && gap <= 1.0) change = switch_before_gap(middle.place, gap);
  seen = {middle, last, p};
  if (gap > 1.0 && change > 1.0) return false;
  event_ = gap <= change ? Event::gap : Event::change;
  event_part_ = std::min(gap, change);
  return true;
}

/// Looked for between the nodes and both ends.
void ContactPoint::find_event() {
  forget_event();
  if (certainly_goes_on()) return;
  const int s = rule_.nodes();
  const int parts = may_switch_unseen() ? closer_looks : 1;
  const PointMotion begun = struck();
  Seen seen{look(0.0, begun), look(0.0, begun), begun};
  for (int i = 0; i <= s; ++i) {
    const double before = seen.last.place, node = i < s ? rule_.points()[i] : 1.0;
    for (int k = 1; k < parts; ++k) {
      const double between = before + (node - before) * k / parts;
      if (look_on(seen, between, struck_at(between))) return;
    }
    const PointMotion p =
        i < s ? PointMotion{step_.displacement[i], step_.velocity[i]} : step_.at_end;
    if (look_on(seen, node, p)) return;
  }
}

double ContactPoint::lateness() const {
  const PointMotion& p = step_.at_end;
  return p.velocity != 0.0 ? p.displacement / (p.velocity * bar_.step()) : 0.0;
}

}  // namespace impactrig::models
