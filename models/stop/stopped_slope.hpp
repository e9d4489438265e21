// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "models/sensitivities/motion_slope.hpp"
#include "models/stop/stop_head.hpp"
#include "models/stop/stopped_motion.hpp"

namespace impactrig::models {

/// The derivative of a StoppedMotion: that of the bar behind, and that of the head, which answers
/// the force's slopes exactly. What the parameter changes of the head itself is differentiated over
/// the parameter's stencil, of closed forms.
class StoppedSlope final : public MotionSlope {
 public:
  StoppedSlope(const StoppedMotion& motion, std::unique_ptr<MotionSlope> bar,
               const RigEffect& effect, const Solver& solver);

  void start(std::span<const Start> starts) override;
  void begin_step(std::span<const NodeVector> forces) override;
  Change improve(std::span<const NodeVector> forces, std::span<Nodes> points) override;
  double press(std::span<const NodeVector> changes) override;

  PointMotion struck(int stop) const override { return seen(stop, bar_->struck(stop), state_); }

  void look(double part) override;

  PointMotion struck_at_place(int stop) const override {
    return seen(stop, bar_->struck_at_place(stop), at_place_);
  }

  Spots spots() const override;
  void take(double shift) override;

  double hinge_shift() override { return bar_->hinge_shift(); }

  void change_hinge() override { bar_->change_hinge(); }

 private:
  using State = StopHead::State;

  /// The head at a place of the parameter's stencil.
  struct Changed {
    double weight;
    StopHead head;
    HeadStep step;  // the motion's
  };

  static PointMotion seen(int stop, const PointMotion& bar, const State& head) {
    if (stop > 0) return bar;
    return {bar.displacement - head.displacement, bar.velocity - head.velocity};
  }

  void go(double part);

  const StoppedMotion& motion_;
  std::unique_ptr<MotionSlope> bar_;
  std::vector<Changed> changed_;  // empty where the head stays as it is
  State state_, at_place_;
  double part_ = 0.0;     // that place
  NodeVector force_;      // slopes of the first stop's, at the nodes
  NodeVector run_force_;  // the run's own
  Nodes by_head_;         // what its change does to it at the nodes
};

}  // namespace impactrig::models
