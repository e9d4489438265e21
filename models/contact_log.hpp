// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "models/beams/beam_dynamics.hpp"
#include "models/contact/contact_force.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// Running sums of a stop since first touch.
struct ContactTotals {
  double impulse = 0.0;     ///< [N s]
  double dissipated = 0.0;  ///< [J]
};

/// What happens at the stops, in the order it happens, whoever integrates: keeps the episodes and
/// the four restitutions, and moves the contact forces from phase to phase. Stops are numbered as
/// Episode::stop is.
class ContactLog {
 public:
  ContactLog(const Rig& rig, double accuracy, Simulation& result);

  /// The bar's energy at first touch.
  void begin(const BeamEnergy& energy);

  /// Times from first touch [s]; speed of the point before the stop, closing > 0 [m/s].
  void touch(int stop, double t, double speed, const ContactTotals& totals, ContactForce& contact);
  void separate(int stop, double t, double speed, const ContactTotals& totals,
                ContactForce& contact);

  /// The laws begin to pull at a stop, whose force is kept at zero [s].
  void slack(int stop, double t);

  /// A force reached where contacts may pull [N], [s].
  void lowest(double force, double t);

  double lowest_force() const { return lowest_force_; }  ///< of these; zero where none pulled [N]

  /// A depth reached; kept when it is the deepest of the stop's episode. Throws std::runtime_error
  /// when it is beyond the range of the elastic law.
  void deepest(int stop, double depth, const ContactTotals& totals, const ContactForce& contact);

  /// A force reached; kept when it is the largest of the stop's episode.
  void peak(int stop, double force, double t);

  /// The stop's last.
  const Episode& episode(int stop) const { return result_.episodes[last(stop).episode]; }

  /// Whether that is the first of the run.
  bool in_first_episode(int stop) const { return last(stop).episode == 0; }

  /// Since first touch, when the stop's episode was deepest [J].
  double dissipated_at_deepest(int stop) const { return last(stop).at_deepest.dissipated; }

  double first_speed() const { return result_.episodes.front().approach_velocity; }

  /// Sums up a stop at the end of the run.
  void conclude(int stop, double t, const ContactTotals& totals, const ContactForce& contact,
                double penetration);

  /// Sums up the run when all stops are, with the bar's energy then and its turning as a rigid body
  /// and what damping outside the contacts took [J].
  void conclude(double t, double damped, const BeamEnergy& energy, const RigidPart& rigid);

 private:
  /// Of a stop's last episode.
  struct Last {
    std::size_t episode = 0;
    ContactTotals at_start, at_deepest;
    bool slack = false;
  };

  const Last& last(int stop) const { return last_[static_cast<std::size_t>(stop)]; }

  Last& last(int stop) { return last_[static_cast<std::size_t>(stop)]; }

  StopTotals sum_up(int stop) const;
  void note_push(int stop, const ContactForce& contact);
  void tell_grazing();
  void tell_push();
  void tell_tension();
  void tell_limits(int stop, double depth);

  const Rig& rig_;
  double accuracy_;
  Simulation& result_;
  double energy_at_touch_ = 0.0;
  std::vector<Last> last_;  // of each stop
  long grazing_ = 0;
  double pushed_at_ = 0.0, worth_ = 0.0;  // [m/s]
  std::size_t slack_ = 0;                 // episodes in which the laws would have pulled
  double first_slack_ = 0.0;              // when first [s]
  double lowest_force_ = 0.0, lowest_at_ = 0.0;
};

/// Enters where the energy is at the end of a run, with what the audit holds already: initial,
/// minus the gravitational energy then, and all losses. `begun`: the bar's energy at first [J].
void close_audit(const Rig& rig, double begun, const BeamEnergy& energy, const RigidPart& rigid,
                 EnergyAudit& audit);

/// Warns where more is missing than the accuracy of the forces lets expect.
void warn_of_imbalance(double accuracy, Simulation& result);

/// Warns of a bar that cannot hang or stand as the run has it begin.
void warn_of_start(Simulation& result);

/// Whether the rigid part of a free bar's motion has carried the points before the stops further
/// than vibration can bring them together again, and its swing will not within the longest run.
/// `reach`: √(2 C) for each stop, C the elastic compliance of point and stop.
bool left_for_good(const Rig& rig, std::span<const double> reach, const RigidPart& rigid,
                   const BeamEnergy& energy);

}  // namespace impactrig::models
