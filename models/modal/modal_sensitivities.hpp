// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/modal/modal_motion.hpp"
#include "models/simulation.hpp"
#include "models/stencil.hpp"

namespace impactrig::models {

/// Follows a run of small motion from step to step with the derivatives of its state by numbers of
/// the rig. Over a step the derivatives of the force at the nodes solve the contact law's linear
/// equations; the modes carry them on exactly; the end of a phase moves its time. What the law and
/// the bar's responses themselves change by comes from differences of these closed forms (Stencil,
/// ModalSlope), never from those of a simulation.
class ModalSensitivities {
 public:
  /// What decides where a step ends.
  enum class End { step, gap, change, time };

  ModalSensitivities(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                     const ModalMotion& motion);

  void begin();  ///< at first touch
  /// A contact begins, whose law takes `speed` unless that is too slow.
  void touch(const ContactForce& contact, double speed, bool first);

  /// The step at hand is solved.
  void solve(const NodeVector& force, const NodeVector& displacement, const NodeVector& velocity);

  int count() const { return static_cast<int>(directions_.size()); }

  /// Legendre series of a derivative of the force over the solved step [N a unit].
  const NodeVector& force_series(int i) const { return at(i).force_series; }

  /// The same of the power lost in the contact [W a unit].
  NodeVector dissipation_series(int i) const { return rule_.to_series() * at(i).dissipation; }

  double size(int i) const { return at(i).size; }  ///< by which its parameter changes the rig

  /// Within the solved step: the first contact's largest force and deepest penetration.
  void peak(double part);
  void deepest(double part, double dissipated);
  void sample(double first, double spacing, std::size_t count);

  void take(double part, End end);
  void separate(const Simulation& result);

  std::vector<Sensitivity> take_results();

 private:
  /// How a parameter changes the contact's force, penetration and rate held.
  enum class LawChange { by_strength, by_factor, otherwise };

  struct Direction {
    RigParameter parameter;
    Stencil stencil;
    double size = 1.0;                   // of the parameter, as it matters
    double spacing = 0.0;                // of the stencil, in the parameter's unit
    std::vector<ContactForce> contacts;  // at its places; empty where the contact does not change
    LawChange law_change = LawChange::otherwise;
    double strength = 0.0;     // slope of the damping's s, where the force changes by it
    double start_speed = 0.0;  // slope of the angular rate at touch [rad/s a unit]
    ModalSlope slope;          // empty where the bar does not change
    double bar_spacing = 0.0;  // of the stencil along `slope`
    std::vector<ModalBeam> bars;
    std::map<double, ModalStep> steps;  // slopes of a step along `slope`, by its length
    Eigen::VectorXd velocity_row, displacement_row;

    ModalState state, end;  // slopes of the state, its time free to move
    double time = 0.0;      // slope of that time
    double speed = 0.0;     // slope of the speed the damping law takes
    double first_speed = 0.0;
    NodeVector force, force_series, dissipation;
    double impulse = 0.0, dissipated = 0.0;  // totals' slopes
    double compression = 0.0, dissipated_at_deepest = 0.0;
    Sensitivity result;
  };

  /// The state within the step and how it changes in time.
  struct Place {
    double part = 0.0;
    NodeVector series;  // of the force up to there
    double force = 0.0;
    ModalState state;
    Eigen::VectorXd acceleration;
  };

  struct Struck {
    double depth, rate;
  };

  /// The contact law at a node of the solved step.
  struct NodeLaw {
    double displacement, velocity, elastic;
    ContactForce::Response law;
  };

  /// The struck point and the sensors at a place; the first line and the law in contact only.
  struct Seen {
    double depth = 0.0, acceleration = 0.0;
    double rate = 0.0, displacement_rate = 0.0, velocity_rate = 0.0;
    ContactForce::Response law;
  };

  /// Slopes of what a bar's modes are made of.
  struct BarChange {
    SmallMotion motion;
    ViscousDamping damping;
    Eigen::VectorXd struck, velocity, displacement;  // rows of the points (n)

    void add(double weight, const SmallMotion& other, const ViscousDamping& resisting);
  };

  const Direction& at(int i) const { return directions_[static_cast<std::size_t>(i)]; }

  void find_contacts(const Rig& rig, Direction& d) const;
  void find_slope(const Rig& rig, const Solver& solver, const HistoryRequest& history,
                  Direction& d) const;
  BarChange change_of_bar(const Rig& rig, const Solver& solver, const HistoryRequest& history,
                          const Direction& d) const;
  template <typename Function>
  double slope_of(const Direction& d, double spacing, Function value_at) const;
  const ModalStep& slope_of_step(Direction& d, double h) const;
  void look(double part, Place& place) const;
  void accelerate(Place& place) const;
  void state_at(const Place& place, Direction& d, ModalState& to);
  Struck struck(const Direction& d, const ModalState& slope, const ModalState& state) const;
  double law_slope(const Direction& d, double depth, double rate,
                   const ContactForce::Response& law) const;
  double switch_slope(Direction& d, const ContactForce::Switch& there, double depth, double rate,
                      const Struck& slope) const;
  void solve(Direction& d);
  double dissipation_slope(Direction& d, const NodeLaw& there, double depth, double rate) const;
  double integral(const NodeVector& at_nodes, double part) const;
  void begin_history(const Rig& rig, const HistoryRequest& wanted, Direction& d) const;
  Seen see(const Place& place) const;
  void show(const Place& place, const Seen& seen, Direction& d) const;
  void step_sample(double from, double spacing);
  NodeMatrix legendre_at(double from, double spacing) const;

  const Rig& rig_;
  const SimulationOptions& options_;
  const ModalMotion& motion_;
  const ModalBeam& beam_;
  const Collocation& rule_;
  std::vector<Direction> directions_;

  const ContactForce* contact_ = nullptr;
  double dissipated_at_deepest_ = 0.0;  // [J]

  // of the solved step
  NodeVector force_, force_series_;
  std::vector<NodeLaw> laws_;  // empty where nothing touches
  NodeMatrix inverse_;
  std::optional<ModalStep> sampling_;  // of the history's interval
  Place place_;
  ModalState scratch_, there_;
};

}  // namespace impactrig::models
