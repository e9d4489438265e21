// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/LU>
#include <memory>
#include <span>
#include <vector>

#include "models/collocation/bar_motion.hpp"
#include "models/contact/contact_force.hpp"
#include "models/sample_impulses.hpp"
#include "models/sensitivities/motion_slope.hpp"
#include "models/sensitivities/rig_effect.hpp"
#include "models/simulation.hpp"
#include "models/stop/stopped_motion.hpp"

namespace impactrig::models {

/// Follows a CollocationRun from step to step with the derivatives of its motion by numbers of the
/// rig. Over a step the derivatives of the forces at the nodes solve the contact laws' linear
/// equations; how they carry the bar's motion on is the equations' own (ModalSensitivities,
/// FullSensitivities); the end of a phase moves its time. What a parameter itself changes is a
/// RigEffect.
class RunSensitivities {
 public:
  /// What decides where a step ends.
  enum class End { step, gap, change, hinge, time };

  virtual ~RunSensitivities() = default;
  RunSensitivities(const RunSensitivities&) = delete;
  RunSensitivities& operator=(const RunSensitivities&) = delete;

  /// The run begins, at first touch or before.
  virtual void start() = 0;

  /// At first touch, the struck point closing like this [m/s]; with room for so many samples.
  void begin(double speed, std::size_t samples);

  /// A contact begins, whose law takes `speed` unless that is too slow.
  void touch(int stop, const ContactForce& contact, double speed);

  /// The step at hand is solved, stop by stop. False where its slopes could not be.
  bool solve(std::span<const StopStep> steps);

  int count() const { return static_cast<int>(directions_.size()); }

  /// How much the Legendre series of the stops' forces' derivatives leave out of the solved step,
  /// at most [N a unit].
  double force_truncation(int i) const;

  /// The same of the power lost in the first stop's contact [W a unit].
  double dissipation_truncation(int i) const;

  /// By which its parameter changes the rig.
  double size(int i) const { return direction(i).effect->size(); }

  /// Within the solved step: the first contact's largest force and deepest penetration.
  void peak(double part);
  void deepest(double part, double dissipated);
  void sample(double first, double spacing, std::size_t count);

  /// The part of the step that is taken; `stop`: where that ends by an event.
  void take(double part, End end, int stop);

  virtual void change_hinge() {}  ///< as BarMotion::change_hinge() did

  /// The first stop's force changed its law at a time [s], where the last step taken ended, or the
  /// run begins.
  void note_change(double time);

  /// It jumped, at a touch or not, where the last step taken ended, or the run begins.
  void jump(bool at_touch);
  void separate(const Simulation& result);

  std::vector<Sensitivity> take_results();

 protected:
  /// `stopped`: the run's motion before a compliant stop, if that is met first.
  RunSensitivities(const Rig& rig, const SimulationOptions& options, const BarMotion& motion,
                   const StoppedMotion* stopped);

  /// What a point before a stop does, the gap apart.
  struct Passing {
    double displacement, velocity, acceleration;
  };

  using Spots = MotionSlope::Spots;

  /// Slopes by one parameter, those at stops by their numbers.
  struct Direction {
    std::unique_ptr<RigEffect> effect;
    std::vector<double> speed, first_speed;  // that the damping law takes, and of the first contact
    std::vector<NodeVector> force, series;   // at the nodes, and their Legendre series
    double time = 0.0;                       // of the time of the step's beginning
    double rest = 0.0;                       // of the displacement seen at first touch
    NodeVector dissipation;                  // at the first stop's nodes
    double impulse = 0.0, dissipated = 0.0;  // of the first stop's totals
    double compression = 0.0, dissipated_at_deepest = 0.0;
    SampleImpulses impulses;
    double force_at_end = 0.0;  // that the first stop shows where the last step taken ended
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

  /// The place within the step that is looked at.
  struct Place {
    double part = 0.0;
    std::vector<NodeVector> series;  // of the forces up to there
    std::vector<double> force;
  };

  /// What the point before a stop does there, its gap closed at zero, and the law where it presses.
  struct Seen {
    double depth, rate, acceleration;
    ContactForce::Response law = {};
  };

  void add(std::unique_ptr<RigEffect> effect);

  Direction& direction(int i) { return directions_[static_cast<std::size_t>(i)]; }

  const Direction& direction(int i) const { return directions_[static_cast<std::size_t>(i)]; }

  /// Of the first guess from the free slopes at the nodes, or of what is left of the forces' own:
  /// Σ ∂f/∂(depth, rate) (depth, rate) + ∂f/∂p, a row for each pressed node, into `drive_`.
  void drive_laws(const Direction& d);

  /// That of the forces at the nodes which keeps them to the laws when points respond like this to
  /// them: `inverse_` of 1 − ∂f/∂F.
  void linearise_laws();

  /// Goes to a place of the solved step, stops' forces included.
  void look(double part);
  void see_points();  ///< at the place

  virtual const BarMotion::Response& response(int point, int stop) = 0;

  /// Before it is looked at: the run's own state where the next step begins.
  virtual void see_state() {}

  /// What does not depend on the direction, now that the laws are known at the nodes.
  virtual void prepare() = 0;

  /// Slopes of the forces at the nodes; of the first stop's point there too where it touches.
  virtual bool solve(int i) = 0;

  virtual void go_to_place() = 0;
  virtual Passing passing(std::size_t stop) const = 0;  ///< at the place
  virtual void follow_to_place(int i) = 0;

  /// Slopes of a point before a stop, those of the gap apart: where the next step begins, and at
  /// the place.
  virtual PointMotion struck(int i, std::size_t stop) const = 0;
  virtual PointMotion struck_at_place(int i, std::size_t stop) const = 0;
  virtual Spots spots(int i) const = 0;  ///< at the place, its time held

  /// The next step begins at the place, whose time has this slope more.
  virtual void move_on(int i, double shift) = 0;

  /// From one sample to the next, all slopes with the motion; by default as to any place.
  virtual void go_to_sample(double part, double spacing, bool first);

  virtual void begin_more(int) {}  ///< at first touch

  /// MotionSlope::hinge_shift(); small motion has no friction.
  virtual double hinge_shift(int) { return 0.0; }

  const Rig& rig_;
  const SimulationOptions& options_;
  const StoppedMotion* const stopped_;
  const Collocation& rule_;
  std::vector<Direction> directions_;
  // of the solved step
  std::vector<Pressed> stops_;
  std::vector<NodeVector> force_, series_;
  Eigen::MatrixXd inverse_;
  Eigen::VectorXd drive_;
  Place place_;
  std::vector<Seen> seen_;  // at the place

 private:
  double law_slope(const Direction& d, std::size_t stop, const Seen& seen) const;
  void find_dissipation(Direction& d);
  double dissipation_slope(const Direction& d, const NodeLaw& there, double depth,
                           double rate) const;
  PointMotion against_stop(int i, std::size_t stop) const;
  double end_shift(int i, End end, std::size_t stop);
  double integral(const NodeVector& at_nodes, double part) const;
  double shown_force(int i, std::size_t stop, double moved) const;
  double force_at_touch(int i) const;
  void show(int i);
  double impulse_at_place(int i) const;
  void look_beyond_jump();
  void find_sensor_peak();
  void see_sensor_peak_at_end(int i, double shift);
  void move_largest_at_end(int i, double shift, double part);

  const BarMotion& motion_;
  Eigen::MatrixXd jacobian_;
  double dissipated_at_deepest_ = 0.0;           // [J]
  double peak_part_ = -1.0, deepest_part_ = -1.0;  // of the step at hand; none
  bool jumped_ = false;                          // where the step at hand begins
  bool touches_ = false;                         // there
};

}  // namespace impactrig::models
