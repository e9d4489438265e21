// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "models/beams/floating_frame.hpp"
#include "models/hinge_friction.hpp"
#include "models/implicit/frame_bar.hpp"
#include "models/implicit/seen_points.hpp"
#include "models/sensitivities/motion_slope.hpp"

// Included by dense_motion.cpp.
namespace impactrig::models {
namespace {

/// The derivative of a DenseMotion. Accelerations of the stages, and what is seen of the bar, are
/// differentiated along the slope, and by the parameter at once, over the parameter's stencil; the
/// motion's own factored systems solve the linearised equations by iteration.
template <typename Motion>
class DenseSlope final : public MotionSlope {
 public:
  DenseSlope(Motion& motion, const RigEffect& effect, const Solver& solver,
             const HistoryRequest& history)
      : motion_(motion),
        by_(stencil_of_motion(effect, solver)),
        friction_slope_(
            by_.slope([&](std::size_t place) { return by_.rig_at(place).hinge.friction; })) {
    q_ = v_ = at_q_ = at_v_ = run_q_ = run_v_ = moved_q_ = moved_v_ = Vector::Zero(motion.n_);
    a_ = previous_ = stage_q_ = stage_v_ = residual_ = moved_stage_q_ = moved_stage_v_ = moved_a_ =
        moved_residual_ = Stages::Zero(motion.n_, S);
    moved_forces_ = motion.forces_;
    holding_ = NodeVector::Zero(S);
    turns_.resize(ParameterStencil::places);
    by_.for_each_place([&](std::size_t place) {
      if (motion.rotation_) turns_[place].rotation = *by_.rig_at(place).hinge.rotation;
    });
    if (effect.keeps_bar()) return;
    bars_.resize(ParameterStencil::places);
    for (std::size_t place = 0; place < bars_.size(); ++place)
      if (by_.counts(place))
        bars_[place] = std::make_unique<FrameBar>(by_.rig_at(place), solver, history);
  }

  void start(std::span<const Start> starts) override {
    q_.setZero();
    v_.setZero();
    by_.for_each_place([&](std::size_t place) {
      at_q_.setZero();
      at_v_.setZero();
      const auto [angle, rate] = starts[place];
      const FloatingFrameBeam& beam = *bar(place).beam;
      beam.set_steady_motion(angle, rate, at_q_, at_v_);
      if (motion_.rotation_) beam.set_hinge(angle, rate, at_q_, at_v_);
      turns_[place].from = angle;
      q_ += by_.weight(place) * at_q_;
      v_ += by_.weight(place) * at_v_;
    });
    last_h_ = 0.0;
    change_hinge();
  }

  void begin_step(std::span<const NodeVector> forces) override {
    forces_ = forces;
    seen_ = false;
    motion_.place_stages();
    if (last_h_ > 0.0)
      motion_.predict(previous_, motion_.h_ / last_h_, 1.0, 3, a_);
    else
      a_.setZero();
  }

  Change improve(std::span<const NodeVector> forces, std::span<Nodes> points) override {
    place_stages();
    differentiate(forces);
    motion_.correct(residual_, change_);
    a_ += change_;
    place_stages();
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k].displacement.resize(S);
      points[k].velocity.resize(S);
      for (int i = 0; i < S; ++i) {
        const PointMotion p =
            slope_before(static_cast<int>(k), motion_.stage_q_.col(i), motion_.stage_v_.col(i),
                         stage_q_.col(i), stage_v_.col(i));
        points[k].displacement[i] = p.displacement;
        points[k].velocity[i] = p.velocity;
      }
    }
    const double speed = std::sqrt(motion_.inertia_.dot(v_.cwiseAbs2()));
    return {by_.size() * motion_.size_of(change_), by_.size() * speed / motion_.speed_scale_,
            motion_.rounding() * by_.size() / by_.farthest()};
  }

  double press(std::span<const NodeVector> changes) override {
    change_.setZero(motion_.n_, S);
    for (std::size_t stop = 0; stop < changes.size(); ++stop)
      motion_.add_response(stop, changes[stop], change_);
    a_ += change_;
    return by_.size() * motion_.size_of(change_);
  }

  PointMotion struck(int stop) const override {
    return slope_before(stop, motion_.q_, motion_.v_, q_, v_);
  }

  void look(double part) override {
    if (!seen_) see_points();
    points_.look(part);
    if (motion_.rotation_) see_departure(part);
  }

  PointMotion struck_at_place(int stop) const override { return points_.struck(stop); }

  Spots spots() const override {
    Spots spots = points_.spots();
    spots.deflection = departure_.deflection;
    spots.extension = departure_.extension;
    return spots;
  }

  void take(double shift) override;

  double hinge_shift() override;

  void change_hinge() override {
    const HingeFriction& friction = motion_.friction_;
    if (bars_.empty() || !friction.acts()) return;
    by_.for_each_place([&](std::size_t place) {
      const double torque = by_.rig_at(place).hinge.friction;
      bars_[place]->beam->drive(
          {.held = friction.sticks(), .moment = friction.sticks() ? 0.0 : friction.moment(torque)});
    });
  }

 private:
  static constexpr int S = Motion::stages;
  using Vector = Eigen::VectorXd;
  using Stages = typename Motion::Stages;

  /// A hinge that is turned as stated, where the parameter is moved.
  struct Turn {
    double from = 0.0;  ///< angle at the start [rad]
    HingeRotation rotation = {};
  };

  FrameBar& bar(std::size_t place) const { return bars_.empty() ? motion_.bar_ : *bars_[place]; }

  void place_stages() { motion_.integrate(q_, v_, a_, stage_q_, stage_v_); }

  /// What the slopes leave of their equations, the derivative of the unbalanced forces.
  void differentiate(std::span<const NodeVector> forces) {
    slopes_of_forces_ = forces;
    residual_.setZero();
    by_.for_each_place([&](std::size_t place) {
      find_unbalanced(place);
      residual_ += by_.weight(place) * moved_residual_;
    });
  }

  /// At a place of the stencil; and what holds a held hinge there.
  void find_unbalanced(std::size_t place) {
    const double way = by_.offset(place);
    for (std::size_t k = 0; k < forces_.size(); ++k)
      moved_forces_.col(static_cast<Eigen::Index>(k)) = forces_[k] + way * slopes_of_forces_[k];
    moved_stage_q_ = motion_.stage_q_ + way * stage_q_;
    moved_stage_v_ = motion_.stage_v_ + way * stage_v_;
    moved_a_ = motion_.a_ + way * a_;
    FloatingFrameBeam& beam = *bar(place).beam;
    beam.unbalanced(moved_stage_q_, moved_stage_v_, moved_a_, moved_forces_, moved_residual_);
    if (!motion_.held()) return;
    for (int i = 0; i < S; ++i)
      holding_[i] =
          beam.hold_hinge(moved_a_.col(i), hinge_acceleration(place, i), moved_residual_.col(i));
  }

  double hinge_acceleration(std::size_t place, int stage) const {
    if (!motion_.rotation_) return 0.0;
    const double t = motion_.t_ + motion_.h_ * motion_.stages_.rule.points()[stage];
    return turns_[place].rotation.acceleration_at(t);
  }

  /// The step that is taken ends at the hinge's very angle and rate.
  void end_at_hinge() {
    const double t = motion_.t_ + motion_.h_;
    at_q_ = q_;
    at_v_ = v_;
    q_.setZero();
    v_.setZero();
    by_.for_each_place([&](std::size_t place) {
      const double way = by_.offset(place);
      const Turn& turn = turns_[place];
      moved_q_ = motion_.stage_q_.col(S - 1) + way * at_q_;
      moved_v_ = motion_.stage_v_.col(S - 1) + way * at_v_;
      bar(place).beam->set_hinge(turn.from + turn.rotation.angle_at(t), turn.rotation.rate_at(t),
                                 moved_q_, moved_v_);
      q_ += by_.weight(place) * moved_q_;
      v_ += by_.weight(place) * moved_v_;
    });
  }

  /// At a place of the step.
  void see_departure(double part) {
    motion_.move(part, motion_.q_, motion_.v_, motion_.a_, motion_.stage_v_, run_q_, run_v_);
    motion_.move(part, q_, v_, a_, stage_v_, at_q_, at_v_);
    departure_ = {};
    by_.for_each_place([&](std::size_t place) {
      const FrameBar& there = bar(place);
      moved_q_ = run_q_ + by_.offset(place) * at_q_;
      const auto departure = there.beam->departure(there.displacement_place, moved_q_);
      departure_.deflection += by_.weight(place) * departure.deflection;
      departure_.extension += by_.weight(place) * departure.extension;
    });
  }

  /// Of what is seen of a bar.
  template <typename Seen>
  PointMotion slope(const Seen& seen, ConstVector q, ConstVector v, ConstVector q_slope,
                    ConstVector v_slope) const {
    PointMotion sum;
    by_.for_each_place([&](std::size_t place) {
      const double way = by_.offset(place);
      moved_q_ = q + way * q_slope;
      moved_v_ = v + way * v_slope;
      const PointMotion p = seen(bar(place), moved_q_, moved_v_);
      sum.displacement += by_.weight(place) * p.displacement;
      sum.velocity += by_.weight(place) * p.velocity;
    });
    return sum;
  }

  PointMotion slope_before(int stop, ConstVector q, ConstVector v, ConstVector q_slope,
                           ConstVector v_slope) const {
    return slope([stop](const FrameBar& there, ConstVector at_q,
                        ConstVector at_v) { return there.before(stop, at_q, at_v); },
                 q, v, q_slope, v_slope);
  }

  template <typename Look>
  PointCurve<S> curve(const Look& look) const;
  void see_points();

  Motion& motion_;
  ParameterStencil by_;
  std::vector<std::unique_ptr<FrameBar>> bars_;  // at the stencil's places; empty: all the same
  double friction_slope_;                        // of the hinge's
  std::span<const NodeVector> forces_, slopes_of_forces_;
  std::vector<Turn> turns_;                 // of the hinge, at the stencil's places
  FloatingFrameBeam::Departure departure_;  // slopes at the place looked at
  Vector q_, v_, at_q_, at_v_, run_q_, run_v_;
  mutable Vector moved_q_, moved_v_;  // scratch
  Stages a_, previous_, stage_q_, stage_v_, residual_, change_;
  // at a place of the stencil
  Stages moved_stage_q_, moved_stage_v_, moved_a_, moved_residual_;
  Eigen::MatrixXd moved_forces_;
  NodeVector holding_;  // moments [N m]
  double last_h_ = 0.0;
  bool seen_ = false;  // the points over the step at hand
  SeenPoints<S> points_;
};

/// Of the points over the step: those of the nodes' velocities, of which the acceleration is made.
template <typename Motion>
template <typename Look>
PointCurve<DenseSlope<Motion>::S> DenseSlope<Motion>::curve(const Look& look) const {
  PointCurve<S> curve;
  const PointMotion first = look(motion_.q_, motion_.v_, q_, v_);
  curve.displacement = first.displacement;
  curve.velocity = first.velocity;
  Eigen::Matrix<double, S, 1> gained;
  for (int i = 0; i < S; ++i)
    gained[i] =
        look(motion_.stage_q_.col(i), motion_.stage_v_.col(i), stage_q_.col(i), stage_v_.col(i))
            .velocity -
        first.velocity;
  curve.acceleration = motion_.stages_.to_velocity.partialPivLu().solve(gained) / motion_.h_;
  return curve.over(motion_.h_, motion_.stages_, motion_.to_series_);
}

template <typename Motion>
void DenseSlope<Motion>::see_points() {
  place_stages();
  points_.stops.clear();
  const auto slope_of = [&](const auto& seen) {
    return curve([&](ConstVector q, ConstVector v, ConstVector q_slope, ConstVector v_slope) {
      return slope(seen, q, v, q_slope, v_slope);
    });
  };
  const auto run_of = [&](double place) {
    return curve([&, place](ConstVector q, ConstVector v, ConstVector, ConstVector) {
      return motion_.bar_.beam->point(place, q, v);
    });
  };
  for (int k = 0; k < motion_.stops(); ++k)
    points_.stops.push_back(slope_of([k](const FrameBar& there, ConstVector q, ConstVector v) {
      return there.before(k, q, v);
    }));
  points_.velocity = slope_of([](const FrameBar& there, ConstVector q, ConstVector v) {
    return there.beam->point(there.velocity_place, q, v);
  });
  points_.displacement = slope_of([](const FrameBar& there, ConstVector q, ConstVector v) {
    return there.beam->point(there.displacement_place, q, v);
  });
  points_.run_velocity = run_of(motion_.bar_.velocity_place);
  points_.run_displacement = run_of(motion_.bar_.displacement_place);
  seen_ = true;
}

template <typename Motion>
void DenseSlope<Motion>::take(double shift) {
  place_stages();
  q_ = stage_q_.col(S - 1) + shift * motion_.stage_v_.col(S - 1);
  v_ = stage_v_.col(S - 1) + shift * motion_.a_.col(S - 1);
  if (motion_.rotation_) end_at_hinge();
  std::swap(previous_, a_);
  last_h_ = motion_.h_;
  seen_ = false;
}

template <typename Motion>
double DenseSlope<Motion>::hinge_shift() {
  place_stages();
  const bool sticks = motion_.friction_.sticks();
  double slope = 0.0;
  by_.for_each_place([&](std::size_t place) {
    if (sticks) find_unbalanced(place);
    slope += by_.weight(place) *
             (sticks ? holding_[S - 1]
                     : bar(place).beam->hinge_rate(motion_.stage_v_.col(S - 1) +
                                                   by_.offset(place) * stage_v_.col(S - 1)));
  });
  return motion_.h_ *
         motion_.friction_.shift(motion_.stages_.rule, motion_.hinge_, slope, friction_slope_);
}

}  // namespace
}  // namespace impactrig::models
