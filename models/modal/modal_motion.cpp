// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_motion.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace impactrig::models {

ModalMotion::ModalMotion(const ModalBar& bar, const Collocation& rule,
                         const HistoryRequest& history)
    : bar_(bar),
      beam_(bar.modes()),
      rule_(rule),
      sampling_interval_(history.interval) {
  const auto row = [&](double x) { return x > 0.0 ? beam_.point(x) : beam_.struck(); };
  if (!(history.interval > 0.0)) return;
  velocity_row_ = row(history.velocity_position);
  displacement_row_ = row(history.displacement_position);
}

void ModalMotion::start(double angle, double rate) {
  state_.a = beam_.rigid() * angle;
  state_.rate = beam_.rigid() * rate;
  scratch_ = end_ = sampled_[0] = sampled_[1] = state_;
  force_series_ = NodeVector::Zero(rule_.nodes());
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
  // a bar that bends and turns draws its points towards the hinge; the energy of that motion is
  // what the small motion leaves out, and what is left out after a contact no longer moves it
  shortening_ =
      std::max(shortening_, beam_.shortening_energy(state_.a, state_.rate) / energy_scale_);
  if (!force_series_.isZero(0.0)) neglected_ = shortening_;
}

/// From sample to sample by steps of their own, under the force as the step has it.
void ModalMotion::sample(double first, double spacing, std::span<Sample> samples) {
  const auto look = [&](const ModalState& state) {
    return Sample{struck(state), velocity_row_.dot(state.rate), displacement_row_.dot(state.a)};
  };
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
