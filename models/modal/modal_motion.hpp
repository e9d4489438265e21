// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "models/collocation/bar_motion.hpp"
#include "models/modal/arrival.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_load.hpp"
#include "models/modal/modal_step.hpp"
#include "models/modal/third_order.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// A bar that moves little: its modes answer the contact force exactly, so that only the force
/// itself has to be resolved.
class ModalMotion : public BarMotion {
 public:
  ModalMotion(const ModalBar& bar, const Collocation& rule, const HistoryRequest& history);

  const Collocation& rule() const override { return rule_; }

  const StepLadder& ladder() const override { return bar_.ladder(); }

  /// At angle 0 the bar starts as it arrives, where arrives() says how.
  void start(double angle, double rate) override;

  void arrives(Arrival arrival) { arrival_ = std::move(arrival); }

  const std::optional<Arrival>& arrival() const { return arrival_; }

  void set_scales(const Scales&) override {}

  PointMotion struck(int stop) const override { return struck(stop, state_); }

  BeamEnergy energy() const override;

  RigidPart rigid_part() const override;

  double elastic_compliance() const override { return beam_.elastic_compliance(); }

  /// Against where a steady load holds the modes, ModalLoad::held().
  const ModalState& state() const { return state_; }

  const ModalLoad& load() const { return load_; }

  /// The point before a stop at the nodes of the step begun, free of forces of the stops.
  void coast(int stop, NodeVector& displacement, NodeVector& velocity) const;

  void expect_contact(int stop, double displacement) override;

  void expect_flight() override {
    if (first_contact_ == FirstContact::lasts) first_contact_ = FirstContact::over;
  }

  void begin_step(int level) override;
  void begin_part(double part) override;

  double step() const override { return step_->h(); }

  const Response& response(int point, int stop) const override {
    return step_->response(point, stop);
  }

  bool improve(std::span<StopStep> stops) override;

  void press(std::span<const StopStep>) override {}

  bool settled() const override { return true; }

  void finish(std::span<const StopStep> stops) override;

  const ModalStep& modal_step() const { return *step_; }

  bool resolves_vibration() const override {
    return beam_.omega().maxCoeff() * step() <= rule_.nodes();
  }

  double undamped_speed(int stop, double damping, double time) const override;

  PointMotion struck_at_end(int stop) const override { return struck(stop, end_); }

  double error() const override { return 0.0; }

  double damped(double part) const override;

  PointMotion struck_at(int stop, double part, double* acceleration) override;
  void sample(double first, double spacing, std::span<Sample> samples) override;

  bool parts_exact() const override { return true; }

  /// Every flight is stepped like a contact: linear also in the swing's angle.
  void step_flights() { flies_ = false; }

  /// What this leaves out is not estimated: third_order() stays as it is.
  void leave_judging() { judges_ = false; }

  /// Of the hinge, which has none here [N m]: what it would change is estimated.
  void judge_friction(double torque) { third_order_.set_friction(torque); }

  /// What cannot be more than this part of the energy is not looked at in judging.
  void judge_coarsely(double negligible) { negligible_ = negligible; }

  double clear_time(std::span<const double> gaps, double most) override;
  void fly(double time) override;
  void sample_flight(double first, double spacing, std::span<Sample> samples) override;
  PointMotion struck_in_flight(int stop, double time) override;

  bool asks_for_contact() const override {
    return judges_ && first_contact_ == FirstContact::lasts;
  }

  void see_contact(const ContactSlope& slope) override { contact_ = slope; }

  void take(double part) override;

  const ModalBeam& beam() const { return beam_; }

  const Eigen::VectorXd& velocity_row() const { return velocity_row_; }

  const Eigen::VectorXd& displacement_row() const { return displacement_row_; }

  /// Flights taken at once so far.
  struct Flights {
    long count = 0;
    double time = 0.0;  ///< [s]
  };

  const Flights& flights() const { return flights_; }

  /// How far vibration that a ReducedBar does not have could have moved the struck points and the
  /// velocity's spot until the contact last pressed: as far as what it has of it.
  struct LeftOut {
    double displacement = 0.0;  ///< of struck points [m]
    /// Force times their velocity, vibrations out of step with each other [W].
    double power = 0.0;
    /// Of the velocity's spot, all in step, as at touch [m/s]; 0 where no history is asked for.
    double shown = 0.0;
  };

  const LeftOut& left_out() const { return left_out_; }

  /// What terms of third order would have changed until the first contact ended.
  const ThirdOrder& third_order() const { return third_order_; }

 private:
  PointMotion struck(int stop, const ModalState& state) const {
    return {beam_.struck(stop).dot(state.a) + held_at_[static_cast<std::size_t>(stop)],
            beam_.struck(stop).dot(state.rate)};
  }

  bool presses(int stop) const { return !series_[static_cast<std::size_t>(stop)].isZero(0.0); }

  Sample look(const ModalState& state) const {
    Sample sample{struck(0, state), velocity_row_.dot(state.rate),
                  displacement_row_.dot(state.a) + displacement_held_};
    if (velocity_slope_.size() == 0) return sample;
    sample.velocity_slope = velocity_slope_.dot(state.rate);
    sample.displacement_slope = displacement_slope_.dot(state.a) + displacement_slope_held_;
    return sample;
  }

  const ModalState& with_held() const;
  BeamEnergy energy_of(const ModalState& state) const;
  void go_with_load(double time, ModalState& to, PointMotion* motion = nullptr,
                    double* acceleration = nullptr) const;
  double mean_force(double part) const;
  void note_left_out(double part);

  PointMotion jump(double part, ModalState& to, double* acceleration = nullptr) const;
  double work_on_stops(double part) const;
  double free_acceleration(int stop, const ModalState& state) const;
  bool ready_to_sample();
  void sample_watched(double first, double spacing, std::span<Sample> samples);
  void advance_sample(double from, double spacing);

  const ModalBar& bar_;
  const ModalBeam& beam_;
  const Collocation& rule_;
  Eigen::VectorXd velocity_row_, displacement_row_;      // of the lasers' spots
  Eigen::VectorXd velocity_slope_, displacement_slope_;  // along the bar there; empty: not asked
  double sampling_interval_;
  std::unique_ptr<ModalStep> sampling_;  // of the history's interval
  std::array<ModalState, 2> sampled_;

  ModalLoad load_;
  std::optional<Arrival> arrival_;
  std::vector<double> held_at_;  // points before stops, by the load [m]
  double displacement_held_ = 0.0, displacement_slope_held_ = 0.0;  // likewise of the history
  ModalState state_, end_, scratch_;
  const ModalStep* step_ = nullptr;
  NodeVector fallen_, fallen_rate_;  // of the pendulum's mode by the load, at the nodes
  int level_ = 0;                    // of that
  std::vector<NodeVector> series_;   // of the force of each stop
  bool flies_;
  bool watched_ = false;  // the flight that clear_time() told of: moves on as steps would
  Flights flights_;
  double dropped_ = 0.0;  // by flights, against what the modes have it [J]

  LeftOut left_out_;

  enum class FirstContact { to_come, lasts, over };

  BarStations::Slopes slopes_;  // in the state, where judged
  ThirdOrder third_order_;
  ContactSlope contact_;
  bool judges_ = true;
  double negligible_ = 0.0;
  FirstContact first_contact_ = FirstContact::to_come;
};

}  // namespace impactrig::models
