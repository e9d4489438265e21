// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "models/hinge_friction.hpp"
#include "models/implicit/chain_points.hpp"
#include "models/implicit/seen_points.hpp"
#include "models/sensitivities/motion_slope.hpp"

// Included by chain_motion_steps.hpp.
namespace impactrig::models {
namespace {

/// The derivative of a ChainMotion. Its linearised equations are those of the stages, of which the
/// residual is differentiated along the slope, and by the parameter at once, over the parameter's
/// stencil; the motion's own factored systems solve them by iteration.
template <typename Motion>
class ChainSlope final : public MotionSlope {
 public:
  ChainSlope(Motion& motion, const RigEffect& effect, const Solver& solver,
             const HistoryRequest& history)
      : motion_(motion),
        by_(stencil_of_motion(effect, solver)),
        friction_(ParameterStencil::places),
        turns_(ParameterStencil::places),
        moved_(motion.points_.stops.size()) {
    by_.for_each_place([&](std::size_t place) {
      const Rig rig = by_.rig_at(place);
      friction_[place] = rig.hinge.friction;
      if (rig.hinge.rotation) turns_[place].rotation = *rig.hinge.rotation;
      turns_[place].place = rig.contact.position;
    });
    const int n = motion.chain_.coordinates();
    q_ = v_ = at_q_ = at_v_ = Eigen::ArrayXd::Zero(n);
    a_ = previous_ = stage_q_ = stage_v_ = residual_ = there_ = run_residual_ = Stages::Zero(S, n);
    if (effect.keeps_bar()) return;
    bars_.resize(ParameterStencil::places);
    for (std::size_t place = 0; place < bars_.size(); ++place) {
      if (!by_.counts(place)) continue;
      const Rig rig = by_.rig_at(place);
      bars_[place] = std::make_unique<Bar>(rig, solver);
      const Bar& bar = *bars_[place];
      moved_.add(by_.weight(place), ChainPoints(bar.beam, bar.chain, motion.struck_, rig, history));
    }
  }

  void start(std::span<const Start> starts) override {
    Eigen::VectorXd beam_q(motion_.beam_.size()), beam_v(motion_.beam_.size());
    q_.setZero();
    v_.setZero();
    by_.for_each_place([&](std::size_t place) {
      const auto& beam = bars_.empty() ? motion_.beam_ : bars_[place]->beam;
      beam_q.setZero();
      beam_v.setZero();
      beam.set_steady_motion(starts[place].angle, starts[place].rate, beam_q, beam_v);
      motion_.chain_.from_beam(beam_q, at_q_);
      motion_.chain_.from_beam(beam_v, at_v_);
      if (motion_.rotation_) motion_.turn_as_hinge(turns_[place].place, at_q_, at_v_);
      turns_[place].from = starts[place].angle;
      q_ += by_.weight(place) * at_q_;
      v_ += by_.weight(place) * at_v_;
    });
    last_h_ = 0.0;
    if (motion_.rotation_) holds_.assign(ParameterStencil::places, motion_.hold_);
    change_hinge();
  }

  void begin_step(std::span<const NodeVector> forces) override {
    forces_ = forces;
    seen_ = false;
    motion_.place_stages();
    motion_.maps_.predict(previous_, last_h_ > 0.0 ? motion_.h_ / last_h_ : 0.0, 1.0, a_);
    if (motion_.rotation_) turn_hinges();
    if (motion_.held()) find_run_residual();
  }

  Change improve(std::span<const NodeVector> forces, std::span<Nodes> points) override {
    slopes_of_forces_ = forces;
    differentiate_residual();
    if (motion_.held()) constrain();
    motion_.solve(residual_);
    a_ -= residual_;
    for (std::size_t stop = 0; stop < points.size(); ++stop) look_at_nodes(stop, points[stop]);
    const double speed = std::sqrt((motion_.chain_.inertia() * v_.square()).sum());
    return {by_.size() * motion_.size_of(residual_), by_.size() * speed / motion_.speed_scale_,
            motion_.rounding() * by_.size() / by_.farthest()};
  }

  double press(std::span<const NodeVector> changes) override {
    motion_.respond([&](std::size_t stop) -> const NodeVector& { return changes[stop]; },
                    residual_);
    a_ += residual_;
    return by_.size() * motion_.size_of(residual_);
  }

  PointMotion struck(int stop) const override {
    const auto number = static_cast<std::size_t>(stop);
    PointMotion sum;
    for (const auto& [k, w] : motion_.points_.stops[number]) {
      sum.displacement -= w * q_[k];
      sum.velocity -= w * v_[k];
    }
    for (const auto& [k, w] : moved_.stops[number]) {
      sum.displacement -= w * motion_.q_[k];
      sum.velocity -= w * motion_.v_[k];
    }
    return sum;
  }

  void look(double part) override {
    if (!seen_) see_points();
    points_.look(part);
  }

  PointMotion struck_at_place(int stop) const override { return points_.struck(stop); }

  Spots spots() const override {
    Spots spots = points_.spots();
    if (motion_.rotation_) add_departure(spots);
    return spots;
  }

  void take(double shift) override {
    place_stages();
    for (int k = 0; k < q_.size(); ++k) {
      const Lanes a = motion_.a_.col(k);
      q_[k] = stage_q_(S - 1, k) + shift * (motion_.v_[k] + motion_.maps_.velocity_of(a)[S - 1]);
      v_[k] = stage_v_(S - 1, k) + shift * a[S - 1];
    }
    if (motion_.rotation_) end_at_hinge();
    std::swap(previous_, a_);
    last_h_ = motion_.h_;
    seen_ = false;
  }

  double hinge_shift() override;

  void change_hinge() override {
    if (!motion_.friction_.sticks()) return;
    holds_.assign(ParameterStencil::places, motion_.hold_);
    by_.for_each_place([&](std::size_t place) {
      holds_[place].stop(Hold::angle_of(motion_.q_ + by_.offset(place) * q_));
    });
  }

 private:
  static constexpr int S = Motion::stages;
  using Chain = typename Motion::ChainType;
  using Hold = typename Motion::HoldType;
  using Stages = StageArray<S>;
  using Lanes = Eigen::Array<double, S, 1>;

  /// The bar where the parameter is moved.
  struct Bar {
    Bar(const Rig& rig, const Solver& solver) : beam(rig, solver.elements), chain(beam) {}

    typename Chain::Beam beam;
    Chain chain;
  };

  /// A hinge that is turned as stated, where the parameter is moved.
  struct Turn {
    double from = 0.0;  ///< angle at the start [rad]
    HingeRotation rotation = {};
    double place = 0.0;  ///< of the struck point, from the hinge [m]

    double angle_at(double t) const { return from + rotation.angle_at(t); }
  };

  void place_stages() { motion_.maps_.place(q_, v_, a_, stage_q_, stage_v_); }

  /// As stated, at the stages of the step.
  void turn_hinges() {
    by_.for_each_place([&](std::size_t place) {
      const Turn& turn = turns_[place];
      Lanes angle, rate, acceleration;
      for (int i = 0; i < S; ++i) {
        const double t = motion_.t_ + motion_.h_ * motion_.nodes_[i];
        angle[i] = turn.angle_at(t);
        rate[i] = turn.rotation.rate_at(t);
        acceleration[i] = turn.rotation.acceleration_at(t);
      }
      holds_[place].turn(angle, rate, acceleration);
    });
  }

  /// The step that is taken ends at the hinge's very angle and rate.
  void end_at_hinge() {
    const double t = motion_.t_ + motion_.h_;
    residual_.row(0) = q_.transpose();
    residual_.row(1) = v_.transpose();
    q_.setZero();
    v_.setZero();
    by_.for_each_place([&](std::size_t place) {
      const double way = by_.offset(place);
      at_q_ = motion_.stage_q_.row(S - 1).transpose() + way * residual_.row(0).transpose();
      at_v_ = motion_.stage_v_.row(S - 1).transpose() + way * residual_.row(1).transpose();
      Hold::place(turns_[place].angle_at(t), turns_[place].rotation.rate_at(t), at_q_, at_v_);
      q_ += by_.weight(place) * at_q_;
      v_ += by_.weight(place) * at_v_;
    });
  }

  /// As ChainMotion::add_departure(), differentiated.
  void add_departure(Spots& spots) const {
    const double t = motion_.t_ + std::max(points_.part(), 0.0) * motion_.h_;
    const double angle = motion_.turned_at(t);
    const double turned = by_.slope([&](std::size_t place) { return turns_[place].angle_at(t); });
    const auto p = points_.departing();
    const double sine = std::sin(angle), cosine = std::cos(angle), half = std::sin(0.5 * angle);
    const double x = motion_.points_.displacement_place, x_slope = moved_.displacement_place;
    spots.deflection = cosine * p.across_slope - sine * (p.along_slope + x_slope) -
                       turned * (sine * p.across + cosine * (p.along + x));
    spots.extension = sine * p.across_slope + cosine * p.along_slope +
                      turned * (cosine * p.across - sine * (p.along + x)) -
                      2.0 * half * half * x_slope;
  }

  /// The stages by so much of the parameter on.
  void move(double way) {
    moved_q_ = motion_.stage_q_ + way * stage_q_;
    moved_v_ = motion_.stage_v_ + way * stage_v_;
    moved_a_ = motion_.a_ + way * a_;
  }

  /// Of a hinge that is let go.
  void differentiate_residual() {
    place_stages();
    residual_.setZero();
    by_.for_each_place([&](std::size_t place) {
      const Chain& chain = bars_.empty() ? motion_.chain_ : bars_[place]->chain;
      const double way = by_.offset(place);
      move(way);
      chain.template residual<S>(moved_q_, moved_a_, there_);
      if (chain.damped()) chain.template add_damping<S>(moved_q_, moved_v_, there_);
      if (motion_.friction_.slides())
        chain.template add_hinge_moment<S>(motion_.friction_.moment(friction_[place]), moved_q_,
                                           there_);
      residual_ += by_.weight(place) * there_;
    });
    for (std::size_t stop = 0; stop < forces_.size(); ++stop) {
      for (const auto& [k, w] : motion_.points_.stops[stop])
        residual_.col(k) -= w * slopes_of_forces_[stop].array();
      for (const auto& [k, w] : moved_.stops[stop]) residual_.col(k) -= w * forces_[stop].array();
    }
  }

  /// That of the motion, its hinge let go.
  void find_run_residual() {
    const Chain& chain = motion_.chain_;
    chain.template residual<S>(motion_.stage_q_, motion_.a_, run_residual_);
    if (chain.damped())
      chain.template add_damping<S>(motion_.stage_q_, motion_.stage_v_, run_residual_);
    for (std::size_t stop = 0; stop < forces_.size(); ++stop)
      for (const auto& [k, w] : motion_.points_.stops[stop])
        run_residual_.col(k) -= w * forces_[stop].array();
  }

  /// Puts what holds the hinge into the residual's slope.
  void constrain() {
    unheld_ = residual_;
    by_.for_each_place([&](std::size_t place) {
      const double way = by_.offset(place);
      move(way);
      before_ = run_residual_ + way * unheld_;
      there_ = before_;
      holds_[place].constrain(moved_q_, moved_v_, moved_a_, there_);
      residual_ += by_.weight(place) * (there_ - before_);
    });
  }

  void look_at_nodes(std::size_t stop, Nodes& nodes) const {
    Lanes displacement = Lanes::Zero(), velocity = Lanes::Zero();
    for (const auto& [k, w] : motion_.points_.stops[stop]) {
      const Lanes a = a_.col(k);
      displacement -= w * (q_[k] + motion_.maps_.displacement_of(v_[k], a));
      velocity -= w * (v_[k] + motion_.maps_.velocity_of(a));
    }
    for (const auto& [k, w] : moved_.stops[stop]) {
      displacement -= w * motion_.stage_q_.col(k);
      velocity -= w * motion_.stage_v_.col(k);
    }
    nodes.displacement = displacement.matrix();
    nodes.velocity = velocity.matrix();
  }

  using Curve = PointCurve<S>;

  /// Σ w of coordinates over the step.
  static void add(const ChainPoints::Shares& shares, const Eigen::ArrayXd& q,
                  const Eigen::ArrayXd& v, const Stages& a, Curve& sum) {
    for (const auto& [k, w] : shares) {
      sum.displacement -= w * q[k];
      sum.velocity -= w * v[k];
      sum.acceleration -= w * a.col(k).matrix();
    }
  }

  /// Of slopes, the run's own by the slopes of the shares.
  Curve curve(const ChainPoints::Shares& shares, const ChainPoints::Shares& moved) const {
    Curve sum;
    add(shares, q_, v_, a_, sum);
    add(moved, motion_.q_, motion_.v_, motion_.a_, sum);
    return sum.over(motion_.h_, motion_.stages_, motion_.maps_.to_series());
  }

  Curve run_curve(const ChainPoints::Shares& shares) const {
    Curve sum;
    add(shares, motion_.q_, motion_.v_, motion_.a_, sum);
    return sum.over(motion_.h_, motion_.stages_, motion_.maps_.to_series());
  }

  /// Of the points over the step.
  void see_points() {
    const ChainPoints& points = motion_.points_;
    points_.stops.clear();
    for (std::size_t k = 0; k < points.stops.size(); ++k)
      points_.stops.push_back(curve(points.stops[k], moved_.stops[k]));
    points_.velocity = curve(points.velocity_spot, moved_.velocity_spot);
    points_.displacement = curve(points.displacement_spot, moved_.displacement_spot);
    points_.run_velocity = run_curve(points.velocity_spot);
    points_.run_displacement = run_curve(points.displacement_spot);
    if (motion_.rotation_) {
      points_.along = curve(points.along_spot, moved_.along_spot);
      points_.run_along = run_curve(points.along_spot);
    }
    seen_ = true;
  }

  Motion& motion_;
  ParameterStencil by_;
  std::vector<std::unique_ptr<Bar>> bars_;  // at the stencil's places; empty where all are the same
  std::vector<double> friction_;            // in the hinge, likewise
  std::vector<Turn> turns_;                 // of the hinge, likewise
  std::vector<Hold> holds_;                 // of a hinge that is held, likewise
  ChainPoints moved_;                       // slopes of the shares
  std::span<const NodeVector> forces_, slopes_of_forces_;
  Eigen::ArrayXd q_, v_, at_q_, at_v_;
  Stages a_, previous_, stage_q_, stage_v_, residual_, there_, run_residual_;
  Stages moved_q_, moved_v_, moved_a_, unheld_, before_;  // scratch
  double last_h_ = 0.0;
  bool seen_ = false;  // the points over the step at hand
  SeenPoints<S> points_;
};

template <typename Motion>
double ChainSlope<Motion>::hinge_shift() {
  differentiate_residual();
  const HingeFriction& friction = motion_.friction_;
  double slope = 0.0;
  by_.for_each_place([&](std::size_t place) {
    const double way = by_.offset(place);
    const Stages q = motion_.stage_q_ + way * stage_q_;
    const Chain& chain = bars_.empty() ? motion_.chain_ : bars_[place]->chain;
    const Lanes value = friction.sticks()
                            ? holds_[place].moment(q, run_residual_ + way * residual_)
                            : chain.template hinge_rate<S>(q, motion_.stage_v_ + way * stage_v_);
    slope += by_.weight(place) * value[S - 1];
  });
  const double torque = by_.slope([&](std::size_t place) { return friction_[place]; });
  return motion_.h_ * friction.shift(motion_.stages_.rule, motion_.hinge_, slope, torque);
}

}  // namespace
}  // namespace impactrig::models
