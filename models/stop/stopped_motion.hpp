// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>

#include "models/collocation/bar_motion.hpp"
#include "models/simulation.hpp"
#include "models/stop/stop_head.hpp"

namespace impactrig::models {

/// A bar that meets a compliant stop first: the struck point is seen from the stop's head, which
/// the same force pushes away. The head answers the polynomial of the force exactly, so that it is
/// the force alone that has to be resolved, as for the bar behind it.
class StoppedMotion final : public BarMotion {
 public:
  StoppedMotion(BarMotion& bar, const Stop& stop);

  const Collocation& rule() const override { return rule_; }

  const StepLadder& ladder() const override { return bar_.ladder(); }

  void start(double angle, double rate) override;

  bool began_steady() const override { return bar_.began_steady(); }

  void set_scales(const Scales& scales) override;
  double longest_step() const override;

  PointMotion struck(int stop) const override {
    return stop == 0 ? seen(bar_.struck(0), state_) : bar_.struck(stop);
  }

  BeamEnergy energy() const override;

  RigidPart rigid_part() const override { return bar_.rigid_part(); }

  bool sensor_may_rise() const override;

  double elastic_compliance() const override { return bar_.elastic_compliance() + compliance_; }

  void expect_contact(int stop, double displacement) override;
  void expect_flight() override;
  void begin_step(int level) override;
  void begin_part(double part) override;

  double step() const override { return bar_.step(); }

  const Response& response(int point, int stop) const override {
    return point == 0 && stop == 0 ? response_ : bar_.response(point, stop);
  }

  bool improve(std::span<StopStep> stops) override;

  void press(std::span<const StopStep> stops) override { bar_.press(stops); }

  bool settled() const override { return bar_.settled(); }

  void finish(std::span<const StopStep> stops) override;
  double damped(double part) const override;

  double hinge_change() override { return bar_.hinge_change(); }

  double hinge_lateness() const override { return bar_.hinge_lateness(); }

  void change_hinge() override { bar_.change_hinge(); }

  PointMotion struck_at_end(int stop) const override {
    return stop == 0 ? seen(bar_.struck_at_end(0), end_) : bar_.struck_at_end(stop);
  }

  double undamped_speed(int stop, double damping, double time) const override {
    return bar_.undamped_speed(stop, damping, time);
  }

  double error() const override;
  PointMotion struck_at(int stop, double part, double* acceleration) override;
  void sample(double first, double spacing, std::span<Sample> samples) override;

  bool parts_exact() const override { return bar_.parts_exact(); }

  void observe(double part) override;

  bool asks_for_contact() const override { return contact_damps_ || bar_.asks_for_contact(); }

  void see_contact(const ContactSlope& slope) override {
    contact_stiffness_ = std::max(slope.to_depth, 0.0);
    if (bar_.asks_for_contact()) bar_.see_contact(slope);
  }

  void take(double part) override;

  /// Every step is to be one that the head answers a force over.
  void keep_responding() { responds_always_ = true; }

  std::unique_ptr<MotionSlope> follow(const RigEffect& effect, const Solver& solver,
                                      const HistoryRequest& history) override;

  const StopHead::State& head() const { return state_; }

  const StopHead& free_head() const { return head_; }

  /// Of the step at hand.
  const HeadStep& head_step() const { return *step_; }

  struct Head {
    StopHead::State state;
    double force = 0.0;  ///< of the contact [N]
  };

  /// Within the solved step.
  Head head_within(double part) const {
    return {part < 1.0 ? head_at(part) : end_, forced_ ? force_at(part) : 0.0};
  }

  /// Where the step observed last has the largest force in the sensor so far, as a part of it.
  const std::optional<double>& peak_part() const { return peak_part_; }

  /// What the sensor carried so far, since the contact force's impulse began [N s].
  SensorForce sensor(double contact_impulse) const;

 private:
  using State = StopHead::State;

  static PointMotion seen(const PointMotion& bar, const State& head) {
    return {bar.displacement - head.displacement, bar.velocity - head.velocity};
  }

  static constexpr std::size_t kept_steps = 6;

  void prepare();
  State head_at(double part) const;

  double force_at(double part) const { return legendre_sum(force_series_, part); }

  NodeVector force_between(double begin, double end) const {
    return rule_.values_between(force_series_, begin, end);
  }

  /// The sensor at a place of the solved step.
  struct Look {
    double place = 0.0;
    State head;
    double force = 0.0, rate = 0.0;  // [N], [N/s]
  };

  Look look_at(double place, const State& head) const;
  Look look_from(const Look& look, double place) const;
  double least_of_interest() const;  // of forces that are looked for [N]
  void note(const Look& look);
  bool note_between(const Look& from, const Look& to);
  void observe_free(double part);
  void observe_forced(double part);

  BarMotion& bar_;
  const Collocation& rule_;
  StopHead head_;
  double compliance_;  // of the sensor's spring [m/N]
  double energy_scale_ = 1.0;
  // Of the sensor [N]: the least of what its spring and the contact hold all the energy with and
  // of what the impulse makes the head ring with.
  double force_scale_ = 1.0;

  State state_, end_;
  std::array<HeadStep, kept_steps> steps_;
  std::size_t next_step_ = 0;
  const HeadStep* step_ = nullptr;
  HeadStep sampling_;  // of the history's interval
  Response response_;
  bool in_contact_ = false;
  bool contact_damps_ = false;
  double contact_stiffness_ = 0.0;  // where the last step ended [N/m]
  bool responds_always_ = false;

  bool forced_ = false;                 // the solved step
  NodeVector force_series_;             // over the step
  NodeVector displacement_, velocity_;  // of the head at the nodes
  NodeVector power_;                    // that the damper takes, at the nodes [W]

  bool touched_ = false;
  long contacts_ = 0;
  double time_ = 0.0;  // from first touch [s]
  SensorForce sensor_;
  std::optional<double> peak_part_;
};

}  // namespace impactrig::models
