// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <span>
#include <vector>

#include "models/modal/modal_load.hpp"
#include "models/modal/modal_step.hpp"
#include "models/sensitivities/rig_effect.hpp"

namespace impactrig::models {

/// What a parameter of the rig changes of a run of small motion, the run's own course apart:
/// besides what any RigEffect knows the modes, by their perturbation, and their responses.
class ParameterEffect : public RigEffect {
 public:
  /// `modes`: of the bar and, last, of the head of a stop that gives way.
  ParameterEffect(const Rig& rig, const Solver& solver, const HistoryRequest& history,
                  RigParameter parameter, const ModalBeam& bar, const ModalBeam& modes,
                  const Collocation& rule);

  /// Of the angular rate at touch [rad/s a unit].
  double start_rate() const { return start_rate_; }

  bool moves_modes() const { return !groups_.empty(); }

  /// How the modes change; where moves_modes(), like what follows.
  const ModalSlope& modes() const { return slope_; }

  const Eigen::VectorXd& struck(int stop) const {
    return stop == 0 ? slope_.struck : slope_.further[static_cast<std::size_t>(stop - 1)];
  }

  /// Of what the lasers see of the modes (m).
  const Eigen::VectorXd& velocity_row() const { return velocity_row_; }

  const Eigen::VectorXd& displacement_row() const { return displacement_row_; }

  /// Of where the load holds the modes (m), and the points before the stops [m].
  const Eigen::VectorXd& held() const { return held_; }

  double held_at(int stop) const { return held_at_[static_cast<std::size_t>(stop)]; }

  /// Of ModalLoad::fall().
  ModalLoad::Fall fall(double time) const;

  /// Of the step of this length.
  const ModalStep& step(double h);

  /// Of the state after a time h, from this state and under these forces, given by the coefficients
  /// of their Legendre series over h, stop by stop. Added to `to`.
  void add_advance(double h, std::span<const NodeVector> series, const ModalState& from,
                   ModalState& to);

  /// What the sensor of a stop that gives way makes of the head's mode: force over coordinate and
  /// over rate.
  struct SensorRow {
    double of_a = 0.0, of_rate = 0.0;

    static SensorRow of(const Stop& stop);
  };

  const SensorRow& sensor_row() const { return sensor_row_; }

 private:
  /// Modes that may be moved equally far.
  struct Group {
    std::vector<Eigen::Index> modes;  // their numbers
    double spacing;                   // along the slope
    std::vector<ModalBeam> moved;     // at the stencil's places
  };

  void find_bar(const Rig& rig, const Solver& solver, const HistoryRequest& history,
                const ModalBeam& bar);
  void keep_bar(const ModalBeam& bar);
  void find_head();
  Eigen::VectorXd spacings() const;
  void move_modes();
  ModalStep step_of(const Group& group, double h) const;
  void find_held(const Eigen::VectorXd& held);

  const ModalBeam& modes_;
  const Collocation& rule_;
  double start_rate_;
  ModalSlope slope_;
  SensorRow sensor_row_;
  Eigen::VectorXd velocity_row_, displacement_row_;
  std::vector<Group> groups_;     // empty where the modes do not change
  std::vector<ModalLoad> loads_;  // at the stencil's places; empty where the pendulum's does not
  double load_spacing_ = 0.0;
  Eigen::VectorXd held_;
  std::vector<double> held_at_;
  std::map<double, ModalStep> steps_;
  ModalState from_, there_;
};

}  // namespace impactrig::models
