// SPDX-License-Identifier: BSD-3-Clause
//
// The contacts of a CollocationRun: where they begin, change and end.
#include "models/collocation/collocation_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/history_recorder.hpp"
#include "models/run_limits.hpp"

namespace impactrig::models {
namespace {

// A change of the force that its rounding explains, as a part of its scale.
constexpr double continuous = 1e-10;

}  // namespace

void CollocationRun::first_touch() {
  t_ = 0.0;
  // a damped swing before is not the impact's
  damped_ = 0.0;
  for (ContactPoint& point : points_) point.begin_totals();
  const BeamEnergy energy = bar_.energy();
  approach_ = bar_.struck(0).velocity;
  energy_scale_ = energy.kinetic;
  set_scales();
  limit_steps();
  log_.begin(energy);
  t_end_ = solver_.duration.value_or(longest_default_run);
  if (!(options_.history.interval > 0.0)) return;
  samples_.resize(1);
  bar_.sample(0.0, 0.0, samples_);
  laser_rest_ = samples_[0].displacement;
  slope_rest_ = samples_[0].displacement_slope;
  const auto speed_at = [&](double x) {
    return x > 0.0 ? approach_ * x / rig_.contact.position : approach_;
  };
  begin_history(rig_, options_.history, approach_, speed_at(options_.history.velocity_position),
                speed_at(options_.history.displacement_position), result_.history);
  if (rig_.stop) result_.history.sensor_force.resize(result_.history.force.size(), 0.0);
  if (solver_.duration)
    make_room(expected_samples(result_.history, *solver_.duration), result_.history);
}

void CollocationRun::touch(ContactPoint& point) {
  const bool first = result_.episodes.empty();
  if (first && point.number() > 0)
    throw std::runtime_error(fmt::format(
        "the bar met stop {} of [[contacts]] before that of [contact], which has to be struck "
        "first; name that stop there, or leave it a gap",
        point.number()));
  if (first)
    first_touch();
  else
    grow_scales();
  bar_.expect_contact(point.number(), point.gap());
  const double speed = point.struck().velocity;
  log_.touch(point.number(), t_, speed, point.totals(), point.contact());
  if (followed_) {
    if (first) followed_->begin(approach_, result_.history.force.capacity());
    followed_->touch(point.number(), point.contact(), speed);
  }
  note_jump(point, 0.0, {0.0, speed});  // not where rounding has left it: there laws may be steep
}

/// What a history shows at this point.
bool CollocationRun::records_jumps(const ContactPoint& point) const {
  return result_.history.interval > 0.0 && point.number() == 0 && !rig_.stop;
}

/// The phase that begins, the point moving like this, may begin with another force than the last
/// one ended with.
void CollocationRun::note_jump(const ContactPoint& point, double before,
                               const PointMotion& motion) {
  if (!records_jumps(point)) return;
  impulses_.note_change(t_);
  if (followed_) followed_->note_change(t_);
  History& history = result_.history;
  const double after = point.shown_force(motion);
  if (std::abs(after - before) <= continuous * point.force_scale()) return;
  history.jumps.push_back({t_, before, after});
  if (followed_) followed_->jump(motion.displacement == 0.0);
}

/// What the event at a stop changes; true where it calls for the first step of a phase.
bool CollocationRun::leave_event(ContactPoint& point) {
  using Event = ContactPoint::Event;
  ContactForce& contact = point.contact();
  const double before = records_jumps(point) ? point.shown_force(point.struck()) : 0.0;
  switch (point.event()) {
    case Event::none:
      return false;
    case Event::gap:
      if (contact.phase() == Phase::free) {
        if (over_at(point)) return false;
        touch(point);
        return true;
      }
      parted_ = t_;
      log_.separate(point.number(), t_, point.struck().velocity, point.totals(), contact);
      if (free()) bar_.expect_flight();
      if (followed_ && point.number() == 0 && log_.in_first_episode(0))
        followed_->separate(result_);
      note_jump(point, before, point.struck());
      return false;
    case Event::change:
      contact.set_phase(contact.switched());
      if (contact.phase() == Phase::slack) log_.slack(point.number(), t_);
      note_jump(point, before, point.struck());
      return true;
  }
  return false;
}

/// What the step's events change; `next` becomes the level of a phase's first step where one
/// begins.
void CollocationRun::leave_events(int& next) {
  double first = std::numeric_limits<double>::infinity();
  for (ContactPoint& point : points_)
    if (leave_event(point)) first = std::min(first, point.first_step());
  if (!std::isfinite(first)) return;
  next = bar_.ladder().level_below(share_of_contact() * first);
  refused_.forget();
}

}  // namespace impactrig::models
