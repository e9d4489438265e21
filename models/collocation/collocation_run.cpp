// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/collocation_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "models/beams/bar_element.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/history_recorder.hpp"
#include "models/run_limits.hpp"

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
// A first contact smaller than this part of its scales is to be solved again; or one that ends
// slower than this part of its approach: errors of the way then count that much more as time.
constexpr double smallest_part = 0.01, slowest_part = 0.1;
// The same where the steps resolve all of the bar's vibration: their ends then err so little that
// this is below the accuracy anyway, but for what a law does that changes with the rate's sign,
// which nodes may miss. By this rule 194 contacts of hybrid bars that ended at 0.01 to 0.1 of their
// approach erred by 0.022 of the accuracy at most.
constexpr double slowest_resolved = 0.01;
// The energy of the first contact, as a multiple of what the bar first has to be stopped of.
constexpr double most_of_local = 30.0;
// Of the speed that the scales are made from.
constexpr double much_faster = 2.0;
// Of that speed: contacts follow each other down to the smallest numbers there are.
constexpr double at_rest = 1e-100;
// Of the time since the last contact, the longest step.
constexpr double share_of_flight = 0.5;
// A change of the force that its rounding explains, as a part of its scale.
constexpr double continuous = 1e-10;
// Events this close are one, as a part of the step.
constexpr double coincidence = 1e-9;
// Of the accuracy, what landing on an event may move it, as a part of a contact's time: a swing may
// be taken in steps that are longer than that by a factor of 10^4.
constexpr double share_of_landing = 0.01;
constexpr double finest_landing = 1e-15;
// That need not look how long it takes [s].
constexpr double short_run = 1e-3;

/// What of the bar the contact first has to stop: in how long a time, and with which energy. A
/// short bar as a whole; of a long one, what moves with the struck point in that time. A point
/// force meets an infinite beam's impedance 2 √2 m' (EI / m')^¼ √ω [Cremer2005, 5.2].
struct Loading {
  double time;    ///< [s]
  double energy;  ///< [J]
};

Loading loading(const Rig& rig, const Solver& solver, const ContactPoint& point, double approach,
                double kinetic) {
  const ContactForce& contact = point.contact();
  const double depth = point.depth();
  const double whole = depth / approach;
  double time = whole;
  if (solver.model != BeamModel::rigid) {
    const std::vector<BarElement> pieces = bar_pieces(rig.beam);
    const BarElement& piece = pieces[element_at(pieces, point.position())];
    const double line_mass = piece.line_density;
    const double wave = std::pow(piece.bending_stiffness / line_mass, 0.25);
    const double stiffness = contact.elastic(depth) / depth;
    const double mass = 2.0 * std::numbers::sqrt2 * line_mass * wave;  // times √time
    time = std::min(time, std::pow(mass / stiffness, 2.0 / 3.0));
  }
  // strong damping presses with full force earlier
  return {time / (1.0 + contact.damping_share(approach, depth)),
          kinetic * std::pow(time / whole, 2)};
}

/// How far the bar can go beyond a stop with an energy [J]. It turns about its hinge no further
/// than the point is far from it, or bends; spring and weight may hold it before the contact does.
double farthest(const Rig& rig, const Solver& solver, const ContactPoint& point, double energy) {
  const double x = point.position();
  const double hold =
      rig.hinge.spring + std::max(rig.gravity_along(), 0.0) * rig.beam.first_moment();
  const double bends = solver.model == BeamModel::rigid ? 0.0 : clamped_compliance(rig.beam, x);
  return std::min(x, std::sqrt(2.0 * energy * (x * x / hold + bends)));
}

bool opens(const ContactPoint& point) {
  return point.event() == ContactPoint::Event::gap && point.contact().presses();
}

/// What a contact's last step leaves out goes one way, unlike that of those before, and counts as
/// time the more the slower the bar leaves, so much after first touch. A contact slower than
/// slowest_part is solved again anyway.
double weight_of_end(ContactPoint& point, const Episode& contact, double part, double taken,
                     double end) {
  const double leaves = -point.struck_at(part).velocity / contact.approach_velocity;
  return std::max(1.0, taken / ((end - contact.start) * std::max(leaves, slowest_part)));
}

}  // namespace

CollocationRun::CollocationRun(const Rig& rig, const Solver& solver,
                               const SimulationOptions& options, BarMotion& bar)
    : rig_(rig),
      solver_(solver),
      options_(options),
      bar_(bar),
      rule_(bar.rule()),
      steps_(static_cast<std::size_t>(rig.stops())),
      together_(steps_.size()),
      log_(rig, solver.accuracy, result_) {
  result_.solver = solver;
  points_.reserve(steps_.size());
  for (int stop = 0; stop < rig.stops(); ++stop) {
    points_.emplace_back(rig, stop, bar, steps_[points_.size()], log_);
    const double compliance = stop == 0
                                  ? bar.elastic_compliance()
                                  : models::elastic_compliance(rig.beam, points_.back().position());
    elastic_reach_.push_back(std::sqrt(2.0 * compliance));
    gaps_.push_back(points_.back().gap());
  }
}

/// What the derivatives of force and loss leave out, by which the parameters' own size would change
/// impulse and energy. They are less smooth than the force where it begins and ends.
double CollocationRun::derivative_error() const {
  double worst = 0.0;
  for (int i = 0; i < followed_->count(); ++i)
    worst = std::max({worst, followed_->force_truncation(i) * followed_->size(i) / impulse_scale_,
                      followed_->dissipation_truncation(i) * followed_->size(i) / energy_scale_});
  return worst * bar_.step() / std::max(solver_.accuracy, Solver::finest_accuracy);
}

void CollocationRun::propose() {
  bar_.begin_step(level_);
  for (ContactPoint& point : points_) point.predict_force();
}

bool CollocationRun::solve() {
  if (!solve_step()) return false;
  for (StopStep& step : steps_) step.force_series = rule_.to_series() * step.force;
  bar_.finish(steps_);
  for (ContactPoint& point : points_) point.complete();
  return true;
}

StopStep& CollocationRun::solution(long evaluations) {
  points_.front().evaluated(evaluations);
  return steps_.front();
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
      tried_.error *= weight_of_end(point, log_.episode(point.number()), first, taken, t_ + taken);
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

void CollocationRun::take_attempt() {
  ++result_.cost.steps;
  const double h = bar_.step();
  for (ContactPoint& point : points_) point.observe(t_, tried_.part);
  const auto struck_at = [&](ContactPoint& point, double place) {
    return point.struck_at(place / h);
  };
  sample_history(
      tried_.part * h,
      [&](double first, double spacing) {
        bar_.sample(first / h, spacing / h, samples_);
        if (followed_) followed_->sample(first / h, spacing / h, samples_.size());
      },
      struck_at);
  for (ContactPoint& point : points_) point.add_to_totals(tried_.part);
  damped_ += bar_.damped(tried_.part);
  bar_.observe(tried_.part);
  if (followed_) follow_step();
  if (!result_.episodes.empty() && result_.episodes.front().open)
    resolved_ = resolved_ && bar_.resolves_vibration();
  if (bar_.asks_for_contact()) bar_.see_contact(points_.front().slope_at(tried_.part));
  bar_.take(tried_.part);
  if (!bar_.parts_exact() && free()) grow_scales();
  for (ContactPoint& point : points_)
    point.keep_series(tried_.part, point.event() != ContactPoint::Event::none);
  t_ += tried_.part * h;
}

/// Its end moves with the first event there.
void CollocationRun::follow_step() {
  using Following = RunSensitivities::End;
  using Event = ContactPoint::Event;
  const auto ended = std::ranges::find_if(
      points_, [](const ContactPoint& point) { return point.event() != Event::none; });
  if (tried_.end == End::run)
    followed_->take(tried_.part, Following::time, 0);
  else if (tried_.end == End::hinge)
    followed_->take(tried_.part, Following::hinge, 0);
  else if (ended == points_.end())
    followed_->take(tried_.part, Following::step, 0);
  else
    followed_->take(tried_.part, ended->event() == Event::gap ? Following::gap : Following::change,
                    ended->number());
}

/// The samples that fall into a time from here on: looked at by `look(first, spacing)` before the
/// first stop and by `struck_at(point, place)` before others [s].
void CollocationRun::sample_history(
    double time, const std::function<void(double, double)>& look,
    const std::function<PointMotion(ContactPoint&, double)>& struck_at) {
  History& history = result_.history;
  if (!(history.interval > 0.0)) return;
  const double next =
      history.start + history.interval * static_cast<double>(history.force.size()) - t_;
  // a sample on the very end belongs to the step, whichever way it is rounded
  const double reach = time + 1e-9 * history.interval;
  if (next > reach) return;
  const double first = std::max(0.0, next);
  samples_.resize(static_cast<std::size_t>((reach - next) / history.interval) + 1);
  look(first, history.interval);
  for (const BarMotion::Sample& sample : samples_) {
    history.force.push_back(points_.front().shown_force(sample.struck));
    history.penetration.push_back(sample.struck.displacement);
    history.velocity.push_back(sample.velocity);
    history.displacement.push_back(sample.displacement - laser_rest_);
    if (options_.history.spot_slopes) {
      history.velocity_slope.push_back(sample.velocity_slope);
      history.displacement_slope.push_back(sample.displacement_slope - slope_rest_);
    }
    if (rig_.stop) history.sensor_force.push_back(sample.sensor_force);
  }
  for (std::size_t i = 0; i < history.further.size(); ++i)
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      const PointMotion p =
          struck_at(points_[i + 1], first + static_cast<double>(k) * history.interval);
      history.further[i].force.push_back(points_[i + 1].shown_force(p));
      history.further[i].penetration.push_back(p.displacement);
    }
}

/// How fast the straight bar's point before a stop moves when the struck point closes at approach_.
double CollocationRun::speed_before(const ContactPoint& point) const {
  return point.number() == 0 ? approach_ : approach_ * point.position() / rig_.contact.position;
}

void CollocationRun::set_scales() {
  constexpr double endless = std::numeric_limits<double>::infinity();
  BarMotion::Scales scales{.energy = endless, .contact_time = endless};
  held_ = false;
  for (ContactPoint& point : points_) {
    const double speed = speed_before(point);
    point.set_scales(energy_scale_, speed, farthest(rig_, solver_, point, energy_scale_),
                     solver_.accuracy);
    held_ = held_ || point.takes_little(energy_scale_);
    const Loading load = loading(rig_, solver_, point, speed, energy_scale_);
    point.set_local_energy(load.energy);
    scales.contact_time = std::min(scales.contact_time, load.time);
    scales.energy = std::min(scales.energy, load.energy);
    scales.damping =
        std::max(scales.damping, point.contact().damping_share(speed, point.depth()) / speed);
  }
  if (!std::isfinite(energy_scale_ + points_.front().force_scale()) || energy_scale_ <= 0.0 ||
      !(points_.front().depth() > 0.0))
    throw std::runtime_error(fmt::format(
        "an impact at {:g} m/s has an energy of {:g} J and would press with {:g} N: numbers out of "
        "all range; look at start, beam and contact",
        approach_, energy_scale_, points_.front().force_scale()));
  bar_.set_scales(scales);
  contact_time_ = scales.contact_time;
  // a bar that turns past its stop, or of which hardly more than the struck point is stopped
  const ContactPoint& first = points_.front();
  impulse_scale_ =
      2.0 / approach_ *
      std::min({energy_scale_, most_of_local * scales.energy, first.force_scale() * first.depth()});
  // of a force that rises from none
  impulse_scale_ *= std::pow(share_of_contact(), 2);
}

/// Of the time of the first contact, what a run sees that is cut before.
double CollocationRun::share_of_contact() const {
  return std::min(1.0, solver_.duration.value_or(contact_time_) / contact_time_);
}

/// A bar that moves so much faster than at first touch, as after a long swing, that errors count by
/// what it does now: by the first contact's scales they would be made small without end. One that
/// is slower keeps the scales that are.
void CollocationRun::grow_scales() {
  if (result_.episodes.empty() || result_.episodes.front().open) return;
  const double kinetic = bar_.energy().kinetic;
  if (!(kinetic > much_faster * much_faster * energy_scale_)) return;
  smallness_ = smallness();
  approach_ *= std::sqrt(kinetic / energy_scale_);
  energy_scale_ = kinetic;
  set_scales();
  limit_steps();
}

void CollocationRun::limit_steps() {
  longest_ = std::min(100.0 * points_.front().depth() / approach_, bar_.ladder().longest);
}

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

/// Whether the run ends where this point meets its stop's plane: the bar has come to rest, or it
/// crosses the plane on the hinge's other side, where there is no stop.
bool CollocationRun::over_at(const ContactPoint& point) {
  if (!result_.episodes.empty() && point.struck().velocity < at_rest * approach_) {
    done_ = true;
    result_.termination = "the bar has come to rest at the stop";
    return true;
  }
  if (!(bar_.rigid_part().along < 0.0)) return false;
  if (result_.episodes.empty())
    throw std::runtime_error(
        "the bar swings round, away from the stop, and does not strike it; look at "
        "start.release_angle and environment.gravity_direction");
  done_ = true;
  result_.termination = "the bar has turned half round, away from the stop";
  result_.warnings.push_back(
      result_.termination +
      "; what comes later is not in the result: it would strike the stop from behind.");
  return true;
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
  note_jump(point, 0.0);
}

/// What a history shows at this point.
bool CollocationRun::records_jumps(const ContactPoint& point) const {
  return result_.history.interval > 0.0 && point.number() == 0 && !rig_.stop;
}

/// The phase that begins may begin with another force than the last one ended with.
void CollocationRun::note_jump(const ContactPoint& point, double before) {
  if (!records_jumps(point)) return;
  History& history = result_.history;
  const double after = point.shown_force(point.struck());
  if (std::abs(after - before) <= continuous * point.force_scale()) return;
  history.jumps.push_back({t_, before, after});
  if (followed_) followed_->jump();
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
  return bar_.ladder().level_below(
      std::min({growth * bar_.step(), longest_step(), bar_.longest_step()}));
}

/// A flight much longer than a contact is crossed in steps that grow with it.
double CollocationRun::longest_step() const {
  if (result_.episodes.empty() || !free()) return longest_;
  const double of_flight = share_of_flight * (t_ - parted_);
  return std::min(std::max(longest_, of_flight), bar_.ladder().longest);
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
      note_jump(point, before);
      return false;
    case Event::change:
      contact.set_phase(contact.switched());
      if (contact.phase() == Phase::slack) log_.slack(point.number(), t_);
      note_jump(point, before);
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

void CollocationRun::reject(int level) {
  ++result_.cost.rejected;
  level_ = level;
  rejected_ = true;
}

void CollocationRun::judge(bool solved) {
  weigh(solved);
  find_events();
  if (!begun_rightly())
    reject(level_);
  else if (tried_.error <= 1.0)
    take_or_land();
  else
    take_shorter();
  done_ = done_ || out_of_time();
}

/// The contacts that are over stand; throws where none is.
void CollocationRun::stop_without_headway() {
  const std::string stopped = fmt::format(
      "the integration stopped {:g} s after first touch: steps of {:g} s make no headway", t_,
      bar_.step());
  if (result_.episodes.empty() || result_.episodes.front().open)
    throw std::runtime_error(stopped + "; ask for less accuracy");
  result_.termination = stopped;
  result_.warnings.push_back(
      stopped +
      "; what comes later is not in the result. Ask for less accuracy, or state a shorter "
      "solver.duration.");
  done_ = true;
}

void CollocationRun::take_shorter() {
  if (level_ >= StepLadder::levels - 1) {
    stop_without_headway();
    return;
  }
  refused_.refuse(level_);
  reject(level_after_rejection(level_));
}

void CollocationRun::take_or_land() {
  int next = refused_.after(level_, next_level());
  if (rejected_) next = std::max(next, level_);
  rejected_ = false;
  if (const double left = t_end_ - t_; tried_.part * bar_.step() >= left) {
    tried_.part = left / bar_.step();
    tried_.end = End::run;
    for (ContactPoint& point : points_) point.forget_event();
  }
  if (points_.size() > 1 && tried_.end == End::event && tried_.part < coincidence) {
    // as good as due when the step began, with what happened then at another stop
    ++result_.cost.rejected;
    next = level_;
    leave_events(next);
    level_ = next;
    return;
  }
  if (ends_far_beyond_contact()) {
    reject(level_until_event());
    return;
  }
  if (tried_.end != End::step && !bar_.parts_exact() && !land_on_event()) {
    reject(level_ + 2);
    return;
  }
  take_attempt();
  if (tried_.end == End::run) result_.termination = "the duration asked for was reached";
  if (tried_.end == End::hinge) change_hinge();
  leave_events(next);
  level_ = next;
  if (done_) return;
  done_ = ends_early() || tried_.end == End::run;
  while (!done_ && leap()) done_ = ends_early() || tried_.end == End::run;
}

bool CollocationRun::free() const {
  return std::ranges::all_of(
      points_, [](const ContactPoint& point) { return point.phase() == Phase::free; });
}

/// Flight without a look at the stops while no gap can close; false where that is not longer than a
/// step.
bool CollocationRun::leap() {
  if (!free() || result_.episodes.empty()) return false;
  const double left = t_end_ - t_;
  const double time = std::min(bar_.clear_time(gaps_, left), left);
  if (!(time > bar_.step())) return false;
  ++result_.cost.steps;
  sample_history(
      time, [&](double first, double spacing) { bar_.sample_flight(first, spacing, samples_); },
      [](ContactPoint& point, double place) { return point.struck_in_flight(place); });
  bar_.fly(time);
  for (ContactPoint& point : points_) point.drop_series();
  t_ += time;
  if (time >= left) {
    tried_.end = End::run;
    result_.termination = "the duration asked for was reached";
  }
  return true;
}

/// Whether the time allowed is over. Throws when no contact is over by then.
bool CollocationRun::out_of_time() {
  if (!looks_.due()) return false;
  if (!time_limit_) {
    // the clock of its thread costs a short run more than it could tell
    const std::chrono::duration<double> so_far = std::chrono::steady_clock::now() - started_;
    if (so_far.count() < std::min(short_run, solver_.time_limit)) return false;
    time_limit_.emplace(solver_.time_limit);
  }
  if (!time_limit_->over()) return false;
  const bool any = !result_.episodes.empty() && !result_.episodes.front().open;
  const std::string reached = fmt::format(
      "{:.3g} s of processor time, what was left of solver.time_limit, took the simulation to {:g} "
      "s {}",
      std::max(solver_.time_limit, 0.0), t_,
      result_.episodes.empty() ? "of the swing before first touch" : "after first touch");
  const std::string remedy =
      "State a shorter solver.duration, fewer elements or modes (an element much shorter than the "
      "others vibrates fast), a larger solver.accuracy, or a longer solver.time_limit.";
  if (!any)
    throw std::runtime_error(
        fmt::format("{}, before the first contact was over. {}", reached, remedy));
  result_.termination = reached;
  result_.warnings.push_back(fmt::format("{}; what comes later{} is not in the result. {}", reached,
                                         rig_.stop ? ", be it more in the sensor," : "", remedy));
  return true;
}

/// Whether nothing more can happen at the stop. Throws when a released bar does not reach it.
bool CollocationRun::ends_early() {
  if (result_.episodes.empty()) {
    const RigidPart rigid = bar_.rigid_part();
    if (rigid.rate < -0.1 * approach_ / rig_.contact.position)
      throw std::runtime_error(fmt::format(
          "the bar turned back {:g} rad before it touched the stop: released, it bends, and what "
          "that takes is missing; release it from further away",
          -rigid.angle));
    return false;
  }
  if (solver_.duration) return false;
  const bool left = free() && left_for_good(rig_, elastic_reach_, bar_.rigid_part(), bar_.energy());
  if (left && !bar_.sensor_may_rise()) {
    result_.termination = "the bar has left the stop for good";
    return true;
  }
  if (tried_.end == End::run && left) {
    result_.termination = fmt::format("{:g} s after first touch the bar had left the stop for good",
                                      longest_default_run);
  } else if (tried_.end == End::run) {
    result_.termination = fmt::format(
        "{:g} s after first touch the bar was still within reach of the stop", longest_default_run);
    result_.warnings.push_back(
        result_.termination +
        "; later contacts are not in the result. State solver.duration to go on.");
  }
  return false;
}

void CollocationRun::begin() {
  started_ = std::chrono::steady_clock::now();
  looks_ = {};
  time_limit_.reset();
  // steps of the full equations are long, and so may be what goes before them
  if (!bar_.parts_exact()) time_limit_.emplace(solver_.time_limit);
  if (follows_swing(rig_, options_)) {
    bar_.start(-*rig_.start.release_angle, 0.0);
    if (followed_) followed_->start();
    approach_ = touch_velocity(rig_);
    const double rate = approach_ / rig_.contact.position;
    energy_scale_ = 0.5 * rig_.beam.hinge_inertia() * rate * rate;
    set_scales();
    t_end_ = std::numeric_limits<double>::infinity();
    longest_ = bar_.ladder().longest;
    level_ = bar_.ladder().level_below(1e-3 * *rig_.start.release_angle / rate);
    return;
  }
  bar_.start(0.0, touch_velocity(rig_) / rig_.contact.position);
  if (followed_) followed_->start();
  touch(points_.front());
  double first = points_.front().first_step();
  for (ContactPoint& point : points_) {
    const PointMotion p = point.struck();
    if (point.phase() != Phase::free || p.displacement < 0.0 || p.velocity < 0.0) continue;
    touch(point);
    first = std::min(first, point.first_step());
  }
  level_ = bar_.ladder().level_below(share_of_contact() * first);
}

void CollocationRun::complete() {
  begin();
  while (!done_) {
    propose();
    judge(solve());
  }
}

double CollocationRun::smallness() const {
  if (smallness_) return *smallness_;
  if (result_.episodes.empty() || result_.episodes.front().open) return 1.0;
  const Episode& first = result_.episodes.front();
  double part = std::min(std::abs(first.impulse) / impulse_scale_,
                         first.peak_force / points_.front().force_scale());
  // of what pulling takes back, pushing may leave next to nothing
  const double pulled = -log_.lowest_force() * (first.end - first.start);
  if (pulled > 0.0) part = std::min(part, std::abs(first.impulse) / pulled);
  const double slow = std::abs(first.separation_velocity) / first.approach_velocity;
  const bool smooth = std::ranges::none_of(points_, [](const ContactPoint& point) {
    return point.contact().form() == DampingForm::closing;
  });
  const double of_end = resolved_ && smooth && slow >= slowest_resolved ? 1.0 : slow / slowest_part;
  return std::min({1.0, part / smallest_part, of_end});
}

Simulation CollocationRun::conclude() {
  for (const ContactPoint& point : points_) {
    log_.conclude(point.number(), t_, point.totals(), point.contact(), point.struck().displacement);
    result_.cost.evaluations += point.evaluations();
  }
  log_.conclude(t_, damped_, bar_.energy(), bar_.rigid_part());
  if (free() && !result_.episodes.empty() && bar_.sensor_may_rise())
    result_.warnings.push_back(
        fmt::format("the run ended {:.4g} s after first touch, before the sensor carried most; "
                    "state a longer solver.duration to see that.",
                    t_));
  result_.cost.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  return std::move(result_);
}

}  // namespace impactrig::models
