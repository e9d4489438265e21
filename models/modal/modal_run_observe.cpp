// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "models/modal/modal_run.hpp"

namespace impactrig::models {

double ModalRun::integral(const NodeVector& at_nodes, double part) const {
  const double h = tried_.step->h();
  if (part >= 1.0) return h * rule_.weights().dot(at_nodes);
  const NodeVector series = rule_.to_series() * at_nodes;
  return part * h * (rule_.restriction(part) * series)[0];
}

void ModalRun::observe_deepest(double part) {
  const double depth = motion_at(part).displacement;
  if (depth <= log_.episode().max_penetration) return;
  log_.deepest(depth, {totals_.impulse + integral(tried_.force, part),
                       totals_.dissipated + integral(tried_.dissipation, part)});
}

/// The force's maximum between two places of the step, where its exact rate changes sign.
void ModalRun::observe_peak(double low, double high) {
  const double h = tried_.step->h();
  const auto rate_at = [&](double place, double& force) {
    double acceleration = 0.0;
    const PointMotion p = motion_at(place, &acceleration);
    force = contact_.force(p.displacement, p.velocity);
    return contact_.force_rate(p.displacement, p.velocity, acceleration);
  };
  double force = 0.0;
  double at_low = rate_at(low, force);
  log_.peak(force, t_ + low * h);
  double at_high = rate_at(high, force);
  log_.peak(force, t_ + high * h);
  if (!(at_low > 0.0 && at_high < 0.0)) return;
  // regula falsi, the end that stays halved; the force is flat there: 1e-8 of the step is enough
  int stays = 0;
  for (int i = 0; i < 40 && high - low > 1e-8; ++i) {
    const double place = low + (high - low) * at_low / (at_low - at_high);
    const double rate = rate_at(place, force);
    ++evaluations_;
    log_.peak(force, t_ + place * h);
    if (std::abs(rate) < 1e-10 * (at_low - at_high)) return;
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
}

/// Peak force and deepest penetration of the part of the step that is taken, between its beginning,
/// the nodes and its end.
void ModalRun::observe_attempt() {
  if (contact_.phase() == Phase::free) return;
  const int s = rule_.nodes();
  const double part = tried_.part;
  const bool pressed = contact_.phase() == Phase::pressed;
  rates_.noalias() = rule_.rates() * tried_.force_series;
  PointMotion p0 = struck(state_);
  double before = 0.0;
  for (int i = 0; i <= s && before < part; ++i) {
    const bool inside = i < s && rule_.points()[i] < part;
    const double here = inside ? rule_.points()[i] : part;
    PointMotion p1 = tried_.at_end;
    if (inside)
      p1 = {tried_.displacement[i], tried_.velocity[i]};
    else if (part < 1.0)
      p1 = motion_at(part);
    // the series' rate may miss the sign where it is small: a maximum shared with the next interval
    // is seen by both
    if (pressed && rates_[i] >= 0.0 && rates_[i + 1] <= 0.0) {
      const double larger = std::max(contact_.force(p0.displacement, p0.velocity),
                                     contact_.force(p1.displacement, p1.velocity));
      if (larger > 0.95 * log_.episode().peak_force) observe_peak(before, here);
    }
    if (pressed)
      log_.peak(contact_.force(p1.displacement, p1.velocity), t_ + here * tried_.step->h());
    if (p0.velocity > 0.0 && p1.velocity <= 0.0) {
      double turn = before + (here - before) * p0.velocity / (p0.velocity - p1.velocity);
      double acceleration = 0.0;
      for (int k = 0; k < 2; ++k) {
        const PointMotion p = motion_at(turn, &acceleration);
        turn = std::clamp(turn - p.velocity / (acceleration * tried_.step->h()), before, here);
      }
      observe_deepest(turn);
    }
    before = here;
    p0 = p1;
  }
  if (p0.velocity > 0.0 && p0.displacement > log_.episode().max_penetration) observe_deepest(part);
}

/// From sample to sample by steps of their own, under the force as the attempt has it.
void ModalRun::sample_history() {
  History& history = result_.history;
  if (!(history.interval > 0.0)) return;
  const double h = tried_.step->h();
  const auto time = [&] {
    return history.start + history.interval * static_cast<double>(history.force.size());
  };
  const double last = t_ + tried_.part * h;
  if (time() > last) return;
  if (!sampling_ && history.interval <= ModalStep::longest(beam_))
    sampling_ = std::make_unique<ModalStep>(beam_, rule_, history.interval);
  const auto jump_to = [&](double t) {
    const double part = std::max(0.0, (t - t_) / h);
    const NodeVector series = rule_.restriction(part) * tried_.force_series;
    advance(beam_, part * h, series, state_, sampled_[0]);
  };
  sampled_[0] = sampled_[1] = state_;
  jump_to(time());
  const int s = rule_.nodes();
  const bool pressed = contact_.phase() == Phase::pressed;
  NodeVector force = NodeVector::Zero(s);
  NodeVector legendre(s);
  for (double t = time(); t <= last;) {
    const ModalState& now = sampled_[0];
    const PointMotion p = struck(now);
    // at a phase's end rounding may put the sample just beyond it, where the law would pull
    history.force.push_back(std::max(contact_.force(p.displacement, p.velocity), 0.0));
    history.penetration.push_back(p.displacement);
    history.velocity.push_back(velocity_row_.dot(now.rate));
    history.displacement.push_back(displacement_row_.dot(now.a));
    const double next = time();
    if (next > last) return;
    if (sampling_) {
      for (int i = 0; pressed && i < s; ++i) {
        shifted_legendre((t - t_ + rule_.points()[i] * history.interval) / h, legendre);
        force[i] = legendre.dot(tried_.force_series);
      }
      if (pressed)
        sampling_->advance(now, force, sampled_[1]);
      else
        sampling_->coast(now, sampled_[1]);
      std::swap(sampled_[0], sampled_[1]);
    } else {
      jump_to(next);
    }
    t = next;
  }
}

}  // namespace impactrig::models
