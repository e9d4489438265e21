// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "models/modal/modal_flight.hpp"

namespace impactrig::models {

ModalMotion::ModalMotion(const ModalBar& bar, const Collocation& rule,
                         const HistoryRequest& history)
    : bar_(bar),
      beam_(bar.modes()),
      rule_(rule),
      sampling_interval_(history.interval),
      flies_(!beam_.sprung()) {
  const auto row = [&](double x) { return x > 0.0 ? beam_.point(x) : beam_.struck(); };
  if (!(history.interval > 0.0)) return;
  velocity_row_ = row(history.velocity_position);
  displacement_row_ = row(history.displacement_position);
}

void ModalMotion::start(double angle, double rate) {
  state_.a = beam_.rigid() * angle;
  // in flight the weight bends the bar by the sine of the swing's angle
  if (flies_ && angle != 0.0) state_.a.tail(beam_.modes() - 1) *= std::sin(angle) / angle;
  state_.rate = beam_.rigid() * rate;
  dropped_ = 0.0;
  flights_ = {};
  scratch_ = end_ = sampled_[0] = sampled_[1] = state_;
  force_series_ = NodeVector::Zero(rule_.nodes());
}

BeamEnergy ModalMotion::energy() const {
  BeamEnergy energy = beam_.energy(state_.a, state_.rate);
  energy.gravitational -= dropped_;
  return energy;
}

void ModalMotion::begin_step(int level) {
  step_ = &bar_.step(rule_, level);
}

void ModalMotion::begin_part(double) {
  throw std::logic_error("ModalMotion takes parts of a step exactly");
}

bool ModalMotion::improve(const NodeVector& force, NodeVector& displacement, NodeVector& velocity) {
  const ModalStep::Response& response = step_->response();
  displacement.noalias() = response.displacement_of_a * state_.a;
  displacement.noalias() += response.displacement_of_rate * state_.rate;
  velocity.noalias() = response.velocity_of_a * state_.a;
  velocity.noalias() += response.displacement_of_a * state_.rate;
  if (!force.isZero(0.0)) {
    displacement.noalias() += response.of_force.displacement_of_force * force;
    velocity.noalias() += response.of_force.velocity_of_force * force;
  }
  return true;
}

void ModalMotion::finish(const NodeVector& force, const NodeVector& force_series) {
  force_series_ = force_series;
  if (force.isZero(0.0))
    step_->coast(state_, end_);
  else
    step_->advance(state_, force, end_);
}

/// The state within the solved step.
PointMotion ModalMotion::jump(double part, ModalState& to, double* acceleration) {
  const NodeVector series = rule_.restricted(force_series_, part);
  return advance(beam_, part * step(), series, state_, to, acceleration);
}

PointMotion ModalMotion::struck_at(double part, double* acceleration) {
  const PointMotion motion = jump(part, scratch_, acceleration);
  if (acceleration)
    *acceleration -= beam_.struck().squaredNorm() * legendre_sum(force_series_, part);
  return motion;
}

void ModalMotion::take(double part) {
  if (part < 1.0) {
    jump(part, scratch_);
    std::swap(state_, scratch_);
  } else {
    std::swap(state_, end_);
  }
  const bool pressed = !force_series_.isZero(0.0);
  note_shortening(pressed);
  if (pressed) neglected_ = shortening_;
}

/// A bar that bends and turns draws its points towards the hinge: the energy of that motion is what
/// the small motion leaves out, and what is left out after a contact no longer moves it. A flight
/// is as well seen from a frame that turns with the bar.
void ModalMotion::note_shortening(bool pressed) {
  const bool turns = flies_ && !pressed;
  const double frame = turns ? beam_.rigid_part(state_.a, state_.rate).angle : 0.0;
  shortening_ =
      std::max(shortening_, beam_.shortening_energy(state_.a, state_.rate, frame) / energy_scale_);
}

double ModalMotion::clear_time() const {
  return flies_ ? ModalFlight(beam_, state_).clear_time() : 0.0;
}

void ModalMotion::fly(double time) {
  ModalFlight(beam_, state_).state_after(time, scratch_);
  dropped_ += ModalFlight::drop(beam_, scratch_) - ModalFlight::drop(beam_, state_);
  std::swap(state_, scratch_);
  ++flights_.count;
  flights_.time += time;
  note_shortening(false);
}

void ModalMotion::sample_flight(double first, double spacing, std::span<Sample> samples) {
  const ModalFlight flight(beam_, state_);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    flight.state_after(first + static_cast<double>(k) * spacing, scratch_);
    const auto on_circle = [&](const Eigen::VectorXd& row) {
      return ModalFlight::on_circle(beam_, row, scratch_);
    };
    samples[k] = {on_circle(beam_.struck()), on_circle(velocity_row_).velocity,
                  on_circle(displacement_row_).displacement};
  }
}

/// From sample to sample by steps of their own, under the force as the step has it.
void ModalMotion::sample(double first, double spacing, std::span<Sample> samples) {
  if (!step_) {
    std::ranges::fill(samples, look(state_));
    return;
  }
  const bool single = sampling_interval_ <= ModalStep::longest(beam_);
  if (!sampling_ && single)
    sampling_ = std::make_unique<ModalStep>(beam_, rule_, sampling_interval_);
  const int s = rule_.nodes();
  const bool forced = !force_series_.isZero(0.0);
  NodeVector force = NodeVector::Zero(s);
  NodeVector legendre(s);
  jump(first, sampled_[0]);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double part = first + static_cast<double>(k) * spacing;
    if (k > 0) {
      if (single) {
        for (int i = 0; forced && i < s; ++i) {
          shifted_legendre(part - spacing + rule_.points()[i] * spacing, legendre);
          force[i] = legendre.dot(force_series_);
        }
        if (forced)
          sampling_->advance(sampled_[0], force, sampled_[1]);
        else
          sampling_->coast(sampled_[0], sampled_[1]);
        std::swap(sampled_[0], sampled_[1]);
      } else {
        jump(part, sampled_[0]);
      }
    }
    samples[k] = look(sampled_[0]);
  }
}

}  // namespace impactrig::models
