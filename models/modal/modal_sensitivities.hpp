// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/modal/modal_motion.hpp"
#include "models/modal/parameter_effect.hpp"
#include "models/simulation.hpp"
#include "models/stop/stopped_motion.hpp"

namespace impactrig::models {

/// Follows a run of small motion from step to step with the derivatives of its state by numbers of
/// the rig. Over a step the derivatives of the forces at the nodes solve the contact laws' linear
/// equations; the modes carry them on exactly; the end of a phase moves its time. The head of a
/// stop that gives way is one mode more, which that stop's force pushes away. What laws and
/// responses themselves change by is a ParameterEffect.
class ModalSensitivities {
 public:
  /// What decides where a step ends.
  enum class End { step, gap, change, time };

  /// `stopped`: the same motion before a stop that gives way; none: a rigid one.
  ModalSensitivities(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                     const ModalMotion& motion, const StoppedMotion* stopped);

  void begin();  ///< at first touch
  /// A contact begins, whose law takes `speed` unless that is too slow.
  void touch(int stop, const ContactForce& contact, double speed);

  /// The step at hand is solved, stop by stop.
  void solve(std::span<const StopStep> steps);

  int count() const { return static_cast<int>(directions_.size()); }

  /// How much the Legendre series of the stops' forces' derivatives leave out of the solved step,
  /// at most [N a unit].
  double force_truncation(int i) const;

  /// The same of the power lost in the first stop's contact [W a unit].
  double dissipation_truncation(int i) const;

  /// By which its parameter changes the rig.
  double size(int i) const { return at(i).effect.size(); }

  /// Within the solved step: the first contact's largest force and deepest penetration.
  void peak(double part);
  void deepest(double part, double dissipated);
  void sample(double first, double spacing, std::size_t count);

  /// The part of the step that is taken; `stop`: where that ends by an event.
  void take(double part, End end, int stop);
  void separate(const Simulation& result);

  std::vector<Sensitivity> take_results();

 private:
  /// Slopes by one parameter, those at stops by their numbers.
  struct Direction {
    Direction(const ModalSensitivities& all, const Solver& solver, RigParameter parameter);

    ParameterEffect effect;
    std::vector<double> speed, first_speed;  // that the damping law takes, and of the first contact
    std::vector<NodeVector> force, series;   // at the nodes, and their Legendre series
    ModalState state, end;                   // of the state, its time free to move
    double time = 0.0;                       // of that time
    NodeVector dissipation;                  // at the first stop's nodes
    double impulse = 0.0, dissipated = 0.0;  // of the first stop's totals
    double compression = 0.0, dissipated_at_deepest = 0.0;
    Sensitivity result;
  };

  /// The contact law at a node of the solved step.
  struct NodeLaw {
    double displacement, velocity, elastic;
    ContactForce::Response law;
  };

  /// A stop over the solved step.
  struct Pressed {
    const ContactForce* contact = nullptr;
    double gap = 0.0;
    std::vector<NodeLaw> laws;    // empty where nothing touches
    Eigen::Index first_row = -1;  // in the equations of the forces; none where it does not press
    NodeVector depth, rate;       // slopes at the nodes, in the direction at hand

    bool presses() const { return contact && contact->presses(); }
  };

  /// The state within the step and how it changes in time.
  struct Place {
    double part = 0.0;
    std::vector<NodeVector> series;  // of the forces up to there
    std::vector<double> force;
    ModalState state;
    Eigen::VectorXd acceleration;
  };

  struct Struck {
    double depth, rate;
  };

  /// What the point before a stop does, and the law where it presses.
  struct Seen {
    double depth, rate, acceleration;
    ContactForce::Response law = {};
  };

  const Direction& at(int i) const { return directions_[static_cast<std::size_t>(i)]; }

  void see_state();
  const ModalStep& step();
  void linearise();
  void solve(Direction& d);
  void find_free_slopes(Direction& d);
  double dissipation_slope(const Direction& d, const NodeLaw& there, double depth,
                           double rate) const;
  void look(double part);
  void accelerate();
  void state_here(Direction& d);
  Struck struck(const Direction& d, std::size_t stop, const ModalState& slope,
                const ModalState& state) const;
  double law_slope(const Direction& d, std::size_t stop, const Seen& seen) const;
  double end_shift(const Direction& d, End end, std::size_t stop) const;
  double integral(const NodeVector& at_nodes, double part) const;
  Seen see(std::size_t stop) const;
  double sensor_slope(const Direction& d) const;
  void note_sensor_peak();
  void show(Direction& d) const;
  void step_sample(double from, double spacing);
  NodeMatrix legendre_at(double from, double spacing) const;

  const Rig& rig_;
  const SimulationOptions& options_;
  const ModalMotion& motion_;
  const StoppedMotion* stopped_;
  std::optional<ModalBeam> with_head_;
  const ModalBeam& modes_;  // of the bar and of the head
  const Collocation& rule_;
  Eigen::VectorXd velocity_row_, displacement_row_;
  ParameterEffect::SensorRow sensor_row_;
  std::deque<Direction> directions_;
  double dissipated_at_deepest_ = 0.0;  // [J]

  // of the solved step
  ModalState state_;  // at its beginning
  std::vector<Pressed> stops_;
  std::vector<NodeVector> force_, series_;
  Eigen::MatrixXd jacobian_, inverse_;
  Eigen::VectorXd drive_, answer_;
  std::map<double, ModalStep> own_steps_;  // where the bar's do not know the head
  std::optional<ModalStep> sampling_;      // of the history's interval
  Place place_;
  std::vector<Seen> seen_;  // at the place
  std::vector<NodeVector> parts_;
  ModalState scratch_, there_;
};

}  // namespace impactrig::models
