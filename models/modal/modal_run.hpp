// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/contact_log.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// simulate() for a bar that moves little: its modes answer the contact force exactly, so that only
/// the force itself has to be resolved. Over a step the force is a polynomial through its values at
/// Gauss nodes, which satisfy the contact law with the motion they cause (Newton); steps are as
/// long as the force's Legendre series converges, and end where a phase of the contact ends. In
/// free flight nothing is evaluated but the gap.
class ModalRun {
 public:
  ModalRun(const Rig& rig, const Solver& solver, const SimulationOptions& options,
           const ModalBar& bar);
  Simulation simulate();

  /// What the small motion left out, as a part of the bar's kinetic energy: of the order of the
  /// relative error of peak force, duration and impulse. After simulate().
  double neglected() const { return neglected_; }

 private:
  using Phase = ContactForce::Phase;

  enum class Event { none, gap, pull, end };

  /// A step tried: what it would make of the force and the struck point, σ in [0, 1].
  struct Attempt {
    int level = 0;
    const ModalStep* step = nullptr;
    NodeVector force, displacement, velocity, dissipation;  // at the nodes
    NodeVector force_series;
    ModalState end;
    PointMotion at_end;
    double error = 0.0;  ///< to be compared with 1
    Event event = Event::none;
    double part = 1.0;  ///< of the step that is taken: up to the event
  };

  PointMotion struck(const ModalState& state) const {
    return {beam_.struck().dot(state.a), beam_.struck().dot(state.rate)};
  }

  /// The struck point within the attempt.
  PointMotion motion_at(double part, double* acceleration = nullptr);

  void attempt(int level);
  bool solve_force(const NodeVector& displacement, const NodeVector& velocity);
  void predict_force(double h);
  double truncation(const NodeVector& series) const;
  double force_error() const;
  double motion_error() const;
  void find_event();
  double root_of_gap(double low, double high);
  void take_attempt();
  void touch();
  void observe_attempt();
  void observe_peak(double low, double high);
  void observe_deepest(double part);
  void sample_history();
  double integral(const NodeVector& at_nodes, double part) const;
  void observe_shortening();
  void integrate();

  const Rig& rig_;
  const Solver& solver_;
  const SimulationOptions& options_;
  const ModalBar& bar_;
  const ModalBeam& beam_;
  ContactForce contact_;
  const Collocation& rule_;
  Eigen::VectorXd velocity_row_, displacement_row_;  // of the lasers' spots
  double longest_ = 0.0;                             // step [s]

  double t_ = 0.0, t_end_ = 0.0;
  ModalState state_, scratch_;
  std::unique_ptr<ModalStep> sampling_;  // of the history's interval
  std::array<ModalState, 2> sampled_;
  Attempt tried_;
  Eigen::VectorXd rates_;   // of the attempt's force, as of Collocation::rates()
  NodeVector last_series_;  // of the force over the last step; empty after an event
  double last_h_ = 0.0;

  double approach_ = 0.0, impulse_scale_ = 0.0, force_scale_ = 0.0;
  ContactTotals totals_;
  double elastic_reach_;  // √(2 C): how far √energy can move the struck point elastically [m/√J]
  double neglected_ = 0.0;
  long evaluations_ = 0;
  Simulation result_;
  ContactLog log_;
};

}  // namespace impactrig::models
