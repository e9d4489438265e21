// SPDX-License-Identifier: BSD-3-Clause
//
// How long the steps of a CollocationRun are, and what ends them.
#include "models/collocation/collocation_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace impactrig::models {
namespace {

// Of the accuracy asked for, what the force's series may leave out of a step's impulse. Where the
// bar answers that force exactly, what is left out changes sign too often to move it: the first
// contact then errs by 0.02 of the accuracy asked for in nine scenes out of ten and by less than
// all of it in the worst of 139 at eight accuracies. A contact that takes little of the energy,
// since the hinge holds the bar, meets steps too few for that: it erred by up to twice.
constexpr double step_share = 0.1, step_share_of_modes = 1.0;
// Of the step that would just be good enough, the next one. Newton's method leaves errors that no
// shorter step makes smaller: more caution would keep steps of the full equations short on them.
constexpr double step_safety = 0.9, step_safety_of_modes = 0.8;
// Of the time since the last contact, the longest step.
constexpr double share_of_flight = 0.5;
// Of the accuracy, what landing on an event may move it, as a part of a contact's time: a swing may
// be taken in steps that are longer than that by a factor of 10^4.
constexpr double share_of_landing = 0.01;
constexpr double finest_landing = 1e-15;
// Of derivatives, which a stencil's rounding keeps from more: steps asked to leave less out than
// that are shortened without end.
constexpr double finest_of_derivatives = 1e-10;

bool opens(const ContactPoint& point) {
  return point.event() == ContactPoint::Event::gap && point.contact().presses();
}

/// What a contact's last step leaves out goes one way, unlike that of those before, and counts as
/// time the more the slower the bar leaves, so much after first touch. A contact slower than
/// `slowest` is solved again anyway.
double weight_of_end(ContactPoint& point, const Episode& contact, double part, double taken,
                     double end, double slowest) {
  const double leaves = -point.struck_at(part).velocity / contact.approach_velocity;
  return std::max(1.0, taken / ((end - contact.start) * std::max(leaves, slowest)));
}

}  // namespace

/// What the derivatives of force and loss leave out, by which the parameters' own size would change
/// impulse and energy. They are less smooth than the force where it begins and ends.
double CollocationRun::derivative_error() const {
  double worst = 0.0;
  for (int i = 0; i < followed_->count(); ++i)
    worst = std::max({worst, followed_->force_truncation(i) * followed_->size(i) / impulse_scale_,
                      followed_->dissipation_truncation(i) * followed_->size(i) / energy_scale_});
  return worst * bar_.step() /
         std::max({solver_.accuracy, finest_of_derivatives, options_.sensitivity_accuracy});
}

/// The error of the step tried.
void CollocationRun::weigh(bool solved) {
  tried_.part = 1.0;
  const auto finite = [](const StopStep& step) {
    return step.force.allFinite() && step.displacement.allFinite() && step.velocity.allFinite();
  };
  if (!solved || !std::ranges::all_of(steps_, finite)) {
    tried_.error = std::numeric_limits<double>::infinity();
    return;
  }
  const bool modes = bar_.parts_exact() && solver_.model != BeamModel::rigid;  // that costs nothing
  const double share = modes && !held_ ? step_share_of_modes : step_share;
  const double tolerance = std::max(solver_.accuracy, Solver::finest_accuracy) * share;
  tried_.error = bar_.error() / (solver_.accuracy * step_share);
  for (const ContactPoint& point : points_) {
    tried_.error = std::max({point.force_error(impulse_scale_, energy_scale_) / tolerance,
                             tried_.error, point.motion_error()});
  }
  if (followed_ && tried_.error <= 1.0) {
    constexpr double unsolved = std::numeric_limits<double>::infinity();
    tried_.error = followed_->solve(steps_) ? std::max(tried_.error, derivative_error()) : unsolved;
  }
}

void CollocationRun::solve_attempt() {
  for (ContactPoint& point : points_) point.predict_force();
  weigh(solve());
}

/// Where the first phases end within the step.
void CollocationRun::find_events() {
  tried_.end = End::step;
  if (!std::isfinite(tried_.error)) {
    for (ContactPoint& point : points_) point.forget_event();
    return;
  }
  double first = 2.0;
  for (ContactPoint& point : points_) {
    point.find_event();
    first = std::min(first, point.event_part());
  }
  if (first > 1.0) return;
  tried_.end = End::event;
  tried_.part = first;
  for (ContactPoint& point : points_)
    if (point.event_part() > first + coincidence) point.forget_event();
  if (!bar_.parts_exact()) return;
  const double taken = first * bar_.step();
  for (ContactPoint& point : points_)
    if (opens(point))
      tried_.error *= weight_of_end(point, log_.episode(point.number()), first, taken, t_ + taken,
                                    slowest_part);
}

/// The step ends where friction in the hinge changes before any other event. False where it should
/// not have begun as it did: then friction has changed, and the step is to be tried again.
bool CollocationRun::begun_rightly() {
  if (!(tried_.error <= 1.0)) return true;
  const double part = bar_.hinge_change();
  if (part == 0.0) {
    change_hinge();
    return false;
  }
  if (part > 1.0 || (tried_.end == End::event && tried_.part <= part)) return true;
  tried_.end = End::hinge;
  tried_.part = part;
  for (ContactPoint& point : points_) point.forget_event();
  return true;
}

void CollocationRun::change_hinge() {
  bar_.change_hinge();
  if (followed_) followed_->change_hinge();
}

/// Solves the step again so that it ends on its event: the polynomials within a step are of lower
/// order than its end. False when the shorter step cannot be solved.
bool CollocationRun::land_on_event() {
  const auto gap = std::ranges::find(points_, ContactPoint::Event::gap, &ContactPoint::event);
  double part = tried_.part;
  const double close = std::clamp(share_of_landing * solver_.accuracy * contact_time_ / bar_.step(),
                                  finest_landing, coincidence);
  for (int correction = 0; correction < 5; ++correction) {
    if (!(part > 0.0)) return false;
    bar_.begin_part(part);
    solve_attempt();
    if (!(tried_.error <= 1.0)) return false;
    if (tried_.end == End::run) return true;
    const bool hinge = tried_.end == End::hinge;
    if (!hinge && gap == points_.end()) return true;
    const double late = hinge ? bar_.hinge_lateness() : gap->lateness();
    if (std::abs(late) < close || std::abs(late) > 0.1) return true;
    part = 1.0 - late;
  }
  return true;
}

int CollocationRun::level_after_rejection(int level) const {
  const double order = rule_.nodes() + 1.0;
  const double safety = bar_.parts_exact() ? step_safety_of_modes : step_safety;
  const double factor = std::isfinite(tried_.error)
                            ? std::max(0.1, safety * std::pow(tried_.error, -1.0 / order))
                            : 0.25;
  const int by_error = std::max(level + 1, bar_.ladder().level_below(factor * bar_.step()));
  if (std::ranges::none_of(points_, opens)) return by_error;
  // hardly beyond the contact's end, where the law does not go on smoothly, or all of that way
  return level_until_event() > level ? level_until_event() : by_error;
}

int CollocationRun::level_until_event() const {
  return bar_.ladder().level_below(tried_.part * bar_.step()) - 1;
}

/// A step far beyond a contact's end is right at its own end, but in between only as good as few
/// nodes before that of the contact make it.
bool CollocationRun::ends_far_beyond_contact() const {
  return tried_.end == End::event && tried_.part < 0.5 && bar_.parts_exact() &&
         level_until_event() > level_ && std::ranges::any_of(points_, opens);
}

int CollocationRun::next_level() const {
  const double order = rule_.nodes() + 1.0;
  const double safety = bar_.parts_exact() ? step_safety_of_modes : step_safety;
  const double growth = std::clamp(safety * std::pow(std::max(tried_.error, 1e-12), -1.0 / order),
                                   0.2, StepLadder::largest_growth);
  return bar_.ladder().level_below(std::min(growth * bar_.step(), longest_step()));
}

/// A flight much longer than a contact is crossed in steps that grow with it.
double CollocationRun::longest_step() const {
  if (result_.episodes.empty() || !free()) return longest_;
  const double of_flight = share_of_flight * (t_ - parted_);
  return std::min(std::max(longest_, of_flight), bar_.ladder().longest);
}

}  // namespace impactrig::models
