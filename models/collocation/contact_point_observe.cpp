// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "models/collocation/contact_point.hpp"

namespace impactrig::models {
namespace {

// Of the largest force so far, less than which a step's is of no interest.
constexpr double near_largest = 0.9;
constexpr double rounded = 1.0 - 8.0 * std::numeric_limits<double>::epsilon();
// The force is flat at its maximum: a correction of its place by less, as a part of the step, need
// not be looked at.
constexpr double last_correction = 1e-6;
// Of the time until the first node: where a force is looked for that rises and falls before.
constexpr double earliest = 1e-12;

}  // namespace

double ContactPoint::integral(const NodeVector& at_nodes, double part) const {
  const double h = bar_.step();
  if (part >= 1.0) return h * rule_.weights().dot(at_nodes);
  const NodeVector series = rule_.to_series() * at_nodes;
  return part * h * rule_.restricted(series, part)[0];
}

void ContactPoint::observe_deepest(double part, double depth) {
  if (depth <= log_.episode(number_).max_penetration) return;
  log_.deepest(number_, depth,
               {totals_.impulse + integral(step_.force, part),
                totals_.dissipated + integral(step_.dissipation, part)},
               contact_);
  if (followed_ && log_.in_first_episode(number_))
    followed_->deepest(part, log_.dissipated_at_deepest(number_));
}

/// A force reached within the step; kept when it is the largest of its contact.
void ContactPoint::note_peak(double force, double part) {
  if (force <= log_.episode(number_).peak_force) return;
  log_.peak(number_, force, begun_ + part * bar_.step());
  peak_part_ = part;
}

/// Where the motion turns between two places of the step, and how deep it is there [m].
double ContactPoint::depth_of_turn(double before, const PointMotion& p0, double here,
                                   const PointMotion& p1, double& place) {
  const double h = bar_.step();
  place = before + (here - before) * p0.velocity / (p0.velocity - p1.velocity);
  double depth = 0.0, acceleration = 0.0;
  for (int k = 0; k < 2; ++k) {
    const PointMotion p = struck_at(place, &acceleration);
    const double next = std::clamp(place - p.velocity / (acceleration * h), before, here);
    depth = p.displacement + 0.5 * p.velocity * (next - place) * h;
    place = next;
  }
  return depth;
}

/// The deepest place between two where the motion turns, and of the first contact the shallowest.
void ContactPoint::observe_turn(double before, const PointMotion& p0, double here,
                                const PointMotion& p1) {
  if (p0.velocity < 0.0 && p1.velocity >= 0.0 && log_.in_first_episode(number_)) {
    double turn = before;
    shallowest_turn_ = std::min(shallowest_turn_, depth_of_turn(before, p0, here, p1, turn));
  }
  if (!(p0.velocity > 0.0 && p1.velocity <= 0.0)) return;
  const double h = bar_.step();
  // it slows down on the way, but for what the highest modes do
  if (p0.displacement + 2.0 * p0.velocity * (here - before) * h <
      log_.episode(number_).max_penetration)
    return;
  double turn = before;
  const double depth = depth_of_turn(before, p0, here, p1, turn);
  observe_deepest(turn, depth);
}

/// The force's exact rate at a place of the step [N/s], and the force there, which is noted.
double ContactPoint::rate_at(double place, double& force) {
  double acceleration = 0.0;
  const PointMotion p = struck_at(place, &acceleration);
  const ContactForce::Response law = contact_.pressed(p.displacement, p.velocity);
  force = law.force;
  note_peak(force, place);
  return law.to_depth * p.velocity + law.to_rate * acceleration;
}

/// The same near the force's maximum, where forces differ by their rounding: the last place is the
/// best one.
double ContactPoint::rate_near_peak(double place) {
  double force = 0.0;
  const double rate = rate_at(place, force);
  ++evaluations_;
  if (force >= rounded * log_.episode(number_).peak_force) peak_part_ = place;
  return rate;
}

/// The force's maximum between two places of the step by secants of its exact rate, from where the
/// rates of its series there say that it is [N]. False where they lead out of the interval.
bool ContactPoint::find_peak(double low, double at_low, double high, double at_high) {
  if (!(at_low > 0.0 && at_high < 0.0)) return false;
  double slope = (at_high - at_low) / ((high - low) * bar_.step());
  double place = low + (high - low) * at_low / (at_low - at_high);
  double rate = rate_near_peak(place);
  for (int i = 0; i < 6 && slope < 0.0; ++i) {
    const double way = -rate / slope;
    if (std::abs(way) < last_correction) {
      if (peak_part_ == place) peak_part_ += way;  // derivatives are not flat there
      return true;
    }
    if (!(place + way > low && place + way < high)) return false;
    const double before = rate;
    rate = rate_near_peak(place += way);
    slope = (rate - before) / way;
  }
  return false;
}

/// The force's maximum between two places of the step, where its exact rate changes sign. Tells
/// that rate at both.
ContactPoint::Rates ContactPoint::observe_peak(double low, double high) {
  double force = 0.0;
  double at_low = rate_at(low, force);
  double at_high = rate_at(high, force);
  const Rates rates{at_low, at_high};
  if (!(at_low > 0.0 && at_high < 0.0)) return rates;
  if (find_peak(low, at_low * bar_.step(), high, at_high * bar_.step())) return rates;
  // regula falsi, the end that stays halved
  int stays = 0;
  for (int i = 0; i < 40 && high - low > 1e-8; ++i) {
    const double place = low + (high - low) * at_low / (at_low - at_high);
    const double rate = rate_near_peak(place);
    if (std::abs(rate) < 1e-10 * (at_low - at_high)) return rates;
    if (rate > 0.0) {
      if (stays == 1) at_high *= 0.5;
      low = place;
      at_low = rate;
      stays = 1;
    } else {
      if (stays == -1) at_low *= 0.5;
      high = place;
      at_high = rate;
      stays = -1;
    }
  }
  return rates;
}

/// The force's maximum before a place near the step's beginning: damping may have its say in so
/// short a time that the nodes see only how the force falls. By golden sections of the time's
/// logarithm.
void ContactPoint::observe_early_peak(double high) {
  constexpr double golden = 0.6180339887498949;
  const auto force_at = [&](double logarithm) {
    const PointMotion p = struck_at(std::exp(logarithm));
    ++evaluations_;
    return contact_.force(p.displacement, p.velocity);
  };
  double low = std::log(earliest * high), up = std::log(high);
  double a = up - golden * (up - low), b = low + golden * (up - low);
  double at_a = force_at(a), at_b = force_at(b);
  for (int k = 0; k < 16; ++k) {
    if (at_a > at_b) {
      up = std::exchange(b, a);
      at_b = at_a;
      a = up - golden * (up - low);
      at_a = force_at(a);
    } else {
      low = std::exchange(a, b);
      at_a = at_b;
      b = low + golden * (up - low);
      at_b = force_at(b);
    }
  }
  observe_peak(std::exp(low), std::exp(up));
}

/// A force that begins with a jump is largest there.
void ContactPoint::observe_jump() {
  const PointMotion first = struck();
  note_peak(contact_.force(first.displacement, first.velocity), 0.0);
}

/// The lowest force where the contact may pull, at the nodes and at the end.
void ContactPoint::observe_pull(double part) {
  const double h = bar_.step();
  const PointMotion last = part < 1.0 ? struck_at(part) : step_.at_end;
  for (int i = 0; i < rule_.nodes(); ++i)
    if (rule_.points()[i] < part) log_.lowest(step_.force[i], begun_ + rule_.points()[i] * h);
  log_.lowest(contact_.force(last.displacement, last.velocity), begun_ + part * h);
}

/// Whether the step's force comes near the largest of its contact, as its nodes and its series see
/// it.
bool ContactPoint::may_be_largest() const {
  const double highest = std::max({step_.force.maxCoeff(), legendre_sum(step_.force_series, 0.0),
                                   legendre_sum(step_.force_series, 1.0)});
  return !(highest < near_largest * log_.episode(number_).peak_force);
}

/// Peak force and deepest penetration of the part of the step that is taken, between its beginning,
/// the nodes and its end.
void ContactPoint::observe(double begun, double part) {
  begun_ = begun;
  if (contact_.phase() == Phase::free) return;
  peak_part_ = -1.0;
  if (contact_.presses() && contact_.form() != DampingForm::proportional) observe_jump();
  if (contact_.presses() && contact_.may_pull()) observe_pull(part);
  const int s = rule_.nodes();
  const bool pressed = contact_.presses() && may_be_largest();
  double unsure = 0.0;  // of rates
  if (pressed) {
    rates_.noalias() = rule_.rates() * step_.force_series;
    unsure = s * s * step_.force_series.tail<2>().norm();
  } else {
    rising_ = false;
  }

  struct {
    double force, place;
    PointMotion motion;
  } highest = {near_largest * log_.episode(number_).peak_force, 0.0, {}};

  PointMotion p0 = struck();
  double before = 0.0, before_that = 0.0;
  for (int i = 0; i <= s && before < part; ++i) {
    const bool inside = i < s && rule_.points()[i] < part;
    const double here = inside ? rule_.points()[i] : part;
    PointMotion p1 = step_.at_end;
    if (inside)
      p1 = {step_.displacement[i], step_.velocity[i]};
    else if (part < 1.0)
      p1 = struck_at(part);
    // the series' rate may miss the sign where it is small: a maximum shared with the next interval
    // is seen by both, and the exact rate may place it in an interval beside
    if (pressed && (rising_ || (rates_[i] >= -unsure && rates_[i + 1] <= unsure))) {
      const double larger = std::max(contact_.force(p0.displacement, p0.velocity),
                                     contact_.force(p1.displacement, p1.velocity));
      const bool was_rising = std::exchange(rising_, false);
      if (larger > 0.95 * log_.episode(number_).peak_force &&
          (was_rising || !find_peak(before, rates_[i], here, rates_[i + 1]))) {
        const Rates exact = observe_peak(before, here);
        rising_ = exact.high > 0.0;
        if (exact.low < 0.0 && before > 0.0) observe_peak(before_that, before);
      }
    }
    if (pressed && i == 0 && rates_[0] < -unsure && rates_[1] < 0.0 &&
        contact_.force(p0.displacement, p0.velocity) < step_.force[0])
      observe_early_peak(here);
    if (pressed) {
      const double force = inside ? step_.force[i] : legendre_sum(step_.force_series, here);
      if (force > highest.force) highest = {force, here, p1};
    }
    observe_turn(before, p0, here, p1);
    before_that = before;
    before = here;
    p0 = p1;
  }
  if (highest.place > 0.0)
    note_peak(contact_.force(highest.motion.displacement, highest.motion.velocity), highest.place);
  if (p0.velocity > 0.0) observe_deepest(part, p0.displacement);
  if (followed_ && peak_part_ >= 0.0 && log_.in_first_episode(number_)) followed_->peak(peak_part_);
}

/// Where the step is cut, the law at the exact motion knows more than the force's series.
void ContactPoint::add_to_totals(double part) {
  if (part >= 1.0 || contact_.phase() == Phase::free) {
    totals_.impulse += integral(step_.force, part);
    totals_.dissipated += integral(step_.dissipation, part);
    return;
  }
  for (int i = 0; i < rule_.nodes(); ++i) {
    const PointMotion p = struck_at(part * rule_.points()[i]);
    const double weight = part * bar_.step() * rule_.weights()[i];
    const auto [force, lost] = contact_.force_and_loss(p.displacement, p.velocity);
    totals_.impulse += weight * force;
    totals_.dissipated += weight * lost;
  }
  evaluations_ += rule_.nodes();
}

void ContactPoint::keep_series(double part, bool ended) {
  if (!ended && contact_.presses())
    last_series_ = step_.force_series;
  else
    drop_series();
  if (ended) rising_ = false;
  last_h_ = bar_.step();
  last_part_ = part;
}

}  // namespace impactrig::models
