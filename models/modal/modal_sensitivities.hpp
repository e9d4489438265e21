// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "models/modal/modal_motion.hpp"
#include "models/modal/parameter_effect.hpp"
#include "models/sensitivities/run_sensitivities.hpp"
#include "models/stop/stopped_motion.hpp"

namespace impactrig::models {

/// Derivatives of a run of small motion: the modes carry them on exactly. The head of a stop that
/// gives way is one mode more, which that stop's force pushes away. What modes and responses
/// themselves change by is a ParameterEffect.
class ModalSensitivities final : public RunSensitivities {
 public:
  /// `stopped`: the same motion before a stop that gives way; none: a rigid one.
  ModalSensitivities(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                     const ModalMotion& motion, const StoppedMotion* stopped);

  void start() override;

 private:
  /// A direction's modes.
  struct Modes {
    ParameterEffect& effect;
    double displacement_held;  // slope of what the displacement shows of where the load holds
    ModalState state, end;     // slopes of the state where the next step begins, and at the place
  };

  void see_state() override;

  void begin_more(int i) override;

  void prepare() override { linearise_laws(); }

  bool solve(int i) override;

  const BarMotion::Response& response(int point, int stop) override {
    return step().response(point, stop);
  }

  void go_to_place() override;
  Passing passing(std::size_t stop) const override;
  void follow_to_place(int i) override;
  PointMotion struck(int i, std::size_t stop) const override;
  PointMotion struck_at_place(int i, std::size_t stop) const override;
  Spots spots(int i) const override;
  void move_on(int i, double shift) override;
  void go_to_sample(double part, double spacing, bool first) override;

  const ModalStep& step();
  void add_load(const Modes& m, int number, Pressed& stop) const;
  void find_free_slopes(int i);
  void accelerate();
  PointMotion struck(const Modes& m, std::size_t stop, const ModalState& slope,
                     const ModalState& state) const;
  double sensor_slope(const Modes& m) const;
  void step_sample(double from, double spacing);
  NodeMatrix legendre_at(double from, double spacing) const;

  const ModalMotion& motion_;
  std::optional<ModalBeam> with_head_;
  const ModalBeam& modes_;  // of the bar and of the head
  ModalLoad load_;
  std::vector<double> held_at_;  // points before stops, by the load [m]
  double longest_sample_;        // [s]
  Eigen::VectorXd velocity_row_, displacement_row_;
  ParameterEffect::SensorRow sensor_row_;
  std::vector<Modes> of_;  // a direction each

  ModalState state_;  // where the step begins
  ModalState here_;   // at the place
  Eigen::VectorXd acceleration_;
  double velocity_rate_ = 0.0, displacement_rate_ = 0.0;  // of the spots, there
  Eigen::VectorXd answer_;
  std::map<double, ModalStep> own_steps_;  // where the bar's do not know the head
  std::optional<ModalStep> sampling_;      // of the history's interval
  std::vector<NodeVector> parts_;
  ModalState scratch_, there_;
};

}  // namespace impactrig::models
