// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "models/modal/modal_flight.hpp"

namespace impactrig::models {
namespace {

// Of a step, how far looks at a flight have to lead: they cost that much less.
constexpr double look_share = 0.1;

}  // namespace

ModalMotion::ModalMotion(const ModalBar& bar, const Collocation& rule,
                         const HistoryRequest& history)
    : bar_(bar),
      beam_(bar.modes()),
      rule_(rule),
      sampling_interval_(history.interval),
      load_(beam_),
      flies_(!beam_.sprung() && !beam_.damped()),
      third_order_(beam_) {
  for (int stop = 0; stop < beam_.stops(); ++stop)
    held_at_.push_back(beam_.struck(stop).dot(load_.held()));
  const auto row = [&](double x) { return x > 0.0 ? beam_.point(x) : beam_.struck(); };
  if (!(history.interval > 0.0)) return;
  velocity_row_ = row(history.velocity_position);
  displacement_row_ = row(history.displacement_position);
  displacement_held_ = displacement_row_.dot(load_.held());
  if (!history.spot_slopes) return;
  const auto slope = [&](double x) {
    return beam_.point_slope(x > 0.0 ? x : beam_.struck_position());
  };
  velocity_slope_ = slope(history.velocity_position);
  displacement_slope_ = slope(history.displacement_position);
  displacement_slope_held_ = displacement_slope_.dot(load_.held());
}

void ModalMotion::start(double angle, double rate) {
  const bool arrives = arrival_ && angle == 0.0;
  if (arrives) angle = arrival_->angle;
  if (arrives) rate = arrival_->rate;
  state_.a = beam_.rigid() * angle;
  // in flight the weight bends the bar by the sine of the swing's angle
  if (flies_ && angle != 0.0) state_.a.tail(beam_.modes() - 1) *= std::sin(angle) / angle;
  state_.a -= load_.held();
  state_.rate = beam_.rigid() * rate;
  if (arrives) state_.a += arrival_->bending.a;
  if (arrives) state_.rate += arrival_->bending.rate;
  dropped_ = 0.0;
  flights_ = {};
  first_contact_ = FirstContact::to_come;
  left_out_ = {};
  scratch_ = end_ = state_;
  if (velocity_row_.size() > 0) sampled_[0] = sampled_[1] = state_;
  series_.assign(static_cast<std::size_t>(beam_.stops()), NodeVector::Zero(rule_.nodes()));
}

BeamEnergy ModalMotion::energy() const {
  BeamEnergy energy = energy_of(state_);
  energy.gravitational -= dropped_;
  return energy;
}

BeamEnergy ModalMotion::energy_of(const ModalState& state) const {
  if (!load_.acts()) return beam_.energy(state.a, state.rate);
  static thread_local Eigen::VectorXd a;  // asked for at every step: no allocation
  a = state.a + load_.held();
  BeamEnergy energy = beam_.energy(a, state.rate);
  energy.gravitational -= beam_.load().dot(a);
  return energy;
}

/// The state, where the modes are.
const ModalState& ModalMotion::with_held() const {
  if (!load_.acts()) return state_;
  static thread_local ModalState whole;
  whole = state_;
  whole.a += load_.held();
  return whole;
}

RigidPart ModalMotion::rigid_part() const {
  const ModalState& state = with_held();
  return beam_.rigid_part(state.a, state.rate);
}

void ModalMotion::expect_contact(int, double) {
  if (first_contact_ != FirstContact::to_come) return;
  first_contact_ = FirstContact::lasts;
  if (!judges_) return;
  const ModalState& state = with_held();
  beam_.stations().find_slopes(state.a, state.rate, slopes_);
  third_order_.touch(state, slopes_, negligible_);
}

void ModalMotion::begin_step(int level) {
  level_ = level;
  step_ = &bar_.step(rule_, level);
  if (!load_.acts()) return;
  fallen_.resize(rule_.nodes());
  fallen_rate_.resize(rule_.nodes());
  for (int i = 0; i < rule_.nodes(); ++i) {
    const ModalLoad::Fall fall = load_.fall(step() * rule_.points()[i]);
    fallen_[i] = fall.a;
    fallen_rate_[i] = fall.rate;
  }
}

void ModalMotion::coast(int stop, NodeVector& displacement, NodeVector& velocity) const {
  step_->coast(stop, state_, displacement, velocity);
  if (!load_.acts()) return;
  const double of_pendulum = beam_.struck(stop)[0];
  displacement.array() += held_at_[static_cast<std::size_t>(stop)] + of_pendulum * fallen_.array();
  velocity += of_pendulum * fallen_rate_;
}

/// What the load has done to the pendulum's mode, and so to the struck point, after a time.
void ModalMotion::go_with_load(double time, ModalState& to, PointMotion* motion,
                               double* acceleration) const {
  if (!load_.acts()) return;
  const ModalLoad::Fall fall = load_.fall(time);
  fall.add_to(to);
  const double of_pendulum = beam_.struck()[0];
  if (motion) {
    motion->displacement += of_pendulum * fall.a + held_at_[0];
    motion->velocity += of_pendulum * fall.rate;
  }
  if (!acceleration) return;
  const double omega = beam_.omega()[0];
  *acceleration +=
      of_pendulum * (load_.pull() - omega * omega * fall.a - beam_.damping()[0] * fall.rate);
}

void ModalMotion::begin_part(double) {
  throw std::logic_error("ModalMotion takes parts of a step exactly");
}

bool ModalMotion::improve(std::span<StopStep> stops) {
  const int count = static_cast<int>(stops.size());
  for (int point = 0; point < count; ++point) {
    StopStep& at = stops[static_cast<std::size_t>(point)];
    coast(point, at.displacement, at.velocity);
    for (int stop = 0; stop < count; ++stop) {
      const NodeVector& force = stops[static_cast<std::size_t>(stop)].force;
      if (force.isZero(0.0)) continue;
      const Response& response = step_->response(point, stop);
      at.displacement.noalias() += response.displacement_of_force * force;
      at.velocity.noalias() += response.velocity_of_force * force;
    }
  }
  return true;
}

void ModalMotion::finish(std::span<const StopStep> stops) {
  for (std::size_t k = 0; k < stops.size(); ++k) series_[k] = stops[k].force_series;
  if (stops[0].force.isZero(0.0))
    step_->coast(state_, end_);
  else
    step_->advance(state_, stops[0].force, end_);
  for (std::size_t k = 1; k < stops.size(); ++k)
    if (!stops[k].force.isZero(0.0)) step_->add(static_cast<int>(k), stops[k].force, end_);
  go_with_load(step(), end_);
}

/// About where the forces hold those modes.
double ModalMotion::undamped_speed(int stop, double damping, double time) const {
  const double resolved = rule_.nodes() / step();
  double squares = 0.0;
  for (Eigen::Index k = beam_.modes(); k-- > 0 && beam_.omega()[k] > resolved;) {
    const double omega = beam_.omega()[k];
    double pressing = 0.0;
    for (int other = 0; other < beam_.stops(); ++other)
      pressing +=
          beam_.struck(other)[k] * legendre_sum(series_[static_cast<std::size_t>(other)], 1.0);
    if (k == 0) pressing -= load_.pull();
    const double off = end_.a[k] + pressing / (omega * omega);
    const double square = std::pow(beam_.struck(stop)[k], 2);
    const double taken = std::min(1.0, 0.5 * damping * square * time);
    squares += square * taken * taken * (std::pow(end_.rate[k], 2) + std::pow(omega * off, 2));
  }
  return std::sqrt(squares);
}

/// The state within the solved step; tells how the struck point moves there.
PointMotion ModalMotion::jump(double part, ModalState& to, double* acceleration) const {
  const double h = part * step();
  PointMotion motion =
      advance(beam_, h, rule_.restricted(series_[0], part), state_, to, acceleration);
  go_with_load(h, to, &motion, acceleration);
  bool alone = true;
  for (int stop = 1; stop < beam_.stops(); ++stop) {
    if (!presses(stop)) continue;
    alone = false;
    add_force(beam_, stop, h, rule_.restricted(series_[static_cast<std::size_t>(stop)], part), to);
  }
  if (alone) return motion;
  if (acceleration) *acceleration = free_acceleration(0, to);
  return struck(0, to);
}

/// Of the point before a stop, without what forces do to it.
double ModalMotion::free_acceleration(int stop, const ModalState& state) const {
  const Eigen::VectorXd& row = beam_.struck(stop);
  return load_.pull() * row[0] - (row.array() * (beam_.omega().array().square() * state.a.array() +
                                                 beam_.damping().array() * state.rate.array()))
                                     .sum();
}

/// What the bar has less, but for the work of the stops, which twice the nodes see.
double ModalMotion::damped(double part) const {
  if (!beam_.damped()) return 0.0;
  static thread_local ModalState within;  // at every step: no allocation
  if (part < 1.0) {
    within = end_;
    jump(part, within);
  }
  const auto total = [&](const ModalState& state) {
    const BeamEnergy energy = energy_of(state);
    return energy.kinetic + energy.elastic + energy.spring + energy.gravitational;
  };
  return total(state_) - total(part < 1.0 ? within : end_) - work_on_stops(part);
}

double ModalMotion::work_on_stops(double part) const {
  bool pressed = false;
  for (int stop = 0; stop < beam_.stops(); ++stop) pressed = pressed || presses(stop);
  if (!pressed) return 0.0;
  const Collocation& fine = Collocation::of(most_nodes);
  std::optional<ModalStep> shorter;
  if (part < 1.0) shorter.emplace(beam_, fine, part * step());
  const ModalStep& whole = shorter ? *shorter : bar_.step(fine, level_);
  const auto force_of = [&](int stop) {
    NodeVector force(fine.nodes());
    for (int i = 0; i < fine.nodes(); ++i)
      force[i] = legendre_sum(series_[static_cast<std::size_t>(stop)], part * fine.points()[i]);
    return force;
  };
  double work = 0.0;
  NodeVector displacement, velocity;
  for (int point = 0; point < beam_.stops(); ++point) {
    if (!presses(point)) continue;
    whole.coast(point, state_, displacement, velocity);
    for (int i = 0; load_.acts() && i < fine.nodes(); ++i)
      velocity[i] += beam_.struck(point)[0] * load_.fall(part * step() * fine.points()[i]).rate;
    for (int stop = 0; stop < beam_.stops(); ++stop)
      velocity += whole.response(point, stop).velocity_of_force * force_of(stop);
    work += part * step() * fine.weights().dot(velocity.cwiseProduct(force_of(point)));
  }
  return work;
}

PointMotion ModalMotion::struck_at(int stop, double part, double* acceleration) {
  PointMotion motion = jump(part, scratch_, acceleration);
  if (stop > 0) motion = struck(stop, scratch_);
  if (!acceleration) return motion;
  if (stop > 0) *acceleration = free_acceleration(stop, scratch_);
  const Eigen::VectorXd& row = beam_.struck(stop);
  for (int other = 0; other < beam_.stops(); ++other)
    *acceleration -=
        row.dot(beam_.struck(other)) * legendre_sum(series_[static_cast<std::size_t>(other)], part);
  return motion;
}

void ModalMotion::take(double part) {
  bool pressed = false;
  for (int stop = 0; stop < beam_.stops(); ++stop) pressed = pressed || presses(stop);
  if (part < 1.0) {
    jump(part, scratch_);
    std::swap(state_, scratch_);
  } else {
    std::swap(state_, end_);
  }
  if (first_contact_ != FirstContact::to_come && bar_.is_reduced()) {
    if (pressed) note_left_out(part);
  }
  if (first_contact_ != FirstContact::lasts || !judges_) return;
  const ModalState& state = with_held();
  beam_.stations().find_slopes(state.a, state.rate, slopes_);
  third_order_.follow(state, slopes_, *step_, part, mean_force(part), contact_);
}

/// Of the first stop, over the first part of the step [N].
double ModalMotion::mean_force(double part) const {
  return part < 1.0 ? rule_.restricted(series_[0], part)[0] : series_[0][0];
}

/// What stands for modes that are left out errs by all of its vibration about where the forces hold
/// it; the bar's own modes do not err.
void ModalMotion::note_left_out(double part) {
  static thread_local Eigen::VectorXd pressing, off, off_rate;  // at every step: no allocation
  const Eigen::Index m = beam_.modes();
  const auto force_of = [&](int stop) {
    return legendre_sum(series_[static_cast<std::size_t>(stop)], part);
  };
  pressing.setZero(m);
  off.setZero(m);
  off_rate.setZero(m);
  for (int stop = 0; stop < beam_.stops(); ++stop)
    if (presses(stop)) pressing += force_of(stop) * beam_.struck(stop);
  for (Eigen::Index k = bar_.own_modes(); k < m; ++k) {
    off[k] = std::abs(state_.a[k] + pressing[k] / std::pow(beam_.omega()[k], 2));
    off_rate[k] = std::abs(state_.rate[k]);
  }
  const auto note = [](double& most, double value) { most = std::max(most, value); };
  for (int stop = 0; stop < beam_.stops(); ++stop) {
    const Eigen::VectorXd& row = beam_.struck(stop);
    note(left_out_.displacement, off.dot(row.cwiseAbs()));
    note(left_out_.power, force_of(stop) * off_rate.cwiseProduct(row).norm());
  }
  if (velocity_row_.size() > 0) note(left_out_.shown, off_rate.dot(velocity_row_.cwiseAbs()));
}

double ModalMotion::clear_time(std::span<const double> gaps, double most) {
  if (!flies_) return 0.0;
  watched_ = ModalFlight::may_reach(beam_, load_, state_, gaps);
  if (!watched_) return ModalFlight(beam_, load_, state_).clear_time(gaps);
  return ModalFlight::watched_time(beam_, load_, state_, gaps, look_share * step(), most);
}

void ModalMotion::fly(double time) {
  if (watched_) {
    load_.advance_freely(beam_, time, state_, scratch_);
  } else {
    ModalFlight(beam_, load_, state_).state_after(time, scratch_);
    dropped_ += ModalFlight::drop(beam_, load_, scratch_) - ModalFlight::drop(beam_, load_, state_);
  }
  std::swap(state_, scratch_);
  ++flights_.count;
  flights_.time += time;
}

void ModalMotion::sample_flight(double first, double spacing, std::span<Sample> samples) {
  if (watched_) return sample_watched(first, spacing, samples);
  const ModalFlight flight(beam_, load_, state_);
  const bool single = ready_to_sample() && flight.swing().is_short(spacing);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k > 0 && single) {
      sampling_->coast(sampled_[0], sampled_[1]);
      ModalFlight::swing_on(beam_, load_, sampled_[0], spacing, sampled_[1]);
      std::swap(sampled_[0], sampled_[1]);
    } else {
      flight.state_after(first + static_cast<double>(k) * spacing, sampled_[0]);
    }
    const auto on_circle = [&](const Eigen::VectorXd& row) {
      return ModalFlight::on_circle(beam_, load_, row, sampled_[0]);
    };
    samples[k] = {on_circle(beam_.struck()), on_circle(velocity_row_).velocity,
                  on_circle(displacement_row_).displacement};
    if (velocity_slope_.size() == 0) continue;
    samples[k].velocity_slope = on_circle(velocity_slope_).velocity;
    samples[k].displacement_slope = on_circle(displacement_slope_).displacement;
  }
}

/// As steps would see it.
void ModalMotion::sample_watched(double first, double spacing, std::span<Sample> samples) {
  const bool single = ready_to_sample();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k > 0 && single) {
      sampling_->coast(sampled_[0], sampled_[1]);
      go_with_load(sampling_->h(), sampled_[1]);
      std::swap(sampled_[0], sampled_[1]);
    } else {
      load_.advance_freely(beam_, first + static_cast<double>(k) * spacing, state_, sampled_[0]);
    }
    samples[k] = look(sampled_[0]);
  }
}

PointMotion ModalMotion::struck_in_flight(int stop, double time) {
  if (watched_) {
    load_.advance_freely(beam_, time, state_, scratch_);
    return struck(stop, scratch_);
  }
  ModalFlight(beam_, load_, state_).state_after(time, scratch_);
  return ModalFlight::on_circle(beam_, load_, beam_.struck(stop), scratch_);
}

/// Whether sampling_ goes from one sample to the next.
bool ModalMotion::ready_to_sample() {
  const bool single = sampling_interval_ <= ladder().longest;
  if (!sampling_ && single)
    sampling_ = std::make_unique<ModalStep>(beam_, rule_, sampling_interval_);
  return single;
}

/// From sample to sample by steps of their own, under the forces as the step has them.
void ModalMotion::sample(double first, double spacing, std::span<Sample> samples) {
  if (!step_) {
    std::ranges::fill(samples, look(state_));
    return;
  }
  const bool single = ready_to_sample();
  jump(first, sampled_[0]);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double part = first + static_cast<double>(k) * spacing;
    if (k > 0 && single)
      advance_sample(part - spacing, spacing);
    else if (k > 0)
      jump(part, sampled_[0]);
    samples[k] = look(sampled_[0]);
  }
}

void ModalMotion::advance_sample(double from, double spacing) {
  const auto force_of = [&](int stop) {
    return rule_.values_between(series_[static_cast<std::size_t>(stop)], from, from + spacing);
  };
  if (presses(0))
    sampling_->advance(sampled_[0], force_of(0), sampled_[1]);
  else
    sampling_->coast(sampled_[0], sampled_[1]);
  for (int stop = 1; stop < beam_.stops(); ++stop)
    if (presses(stop)) sampling_->add(stop, force_of(stop), sampled_[1]);
  go_with_load(sampling_->h(), sampled_[1]);
  std::swap(sampled_[0], sampled_[1]);
}

}  // namespace impactrig::models
