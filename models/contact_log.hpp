// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/beams/beam_dynamics.hpp"
#include "models/contact/contact_force.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// Running sums since first touch.
struct ContactTotals {
  double impulse = 0.0;     ///< [N s]
  double dissipated = 0.0;  ///< [J]
  double damped = 0.0;      ///< in bar, hinge and stop, not in the contact [J]
};

/// What happens at the stop, in the order it happens, whoever integrates: keeps the episodes and
/// the four restitutions, and moves the contact force from phase to phase.
class ContactLog {
 public:
  ContactLog(const Rig& rig, double accuracy, Simulation& result)
      : rig_(rig),
        accuracy_(accuracy),
        result_(result) {}

  /// The bar's energy at first touch.
  void begin(const BeamEnergy& energy);

  /// Times from first touch [s]; speed of the struck point, closing > 0 [m/s].
  void touch(double t, double speed, const ContactTotals& totals, ContactForce& contact);
  void separate(double t, double speed, const ContactTotals& totals, ContactForce& contact);

  /// A depth reached; kept when it is the deepest of the episode. Throws std::runtime_error when it
  /// is beyond the range of the elastic law.
  void deepest(double depth, const ContactTotals& totals, const ContactForce& contact);

  /// A force reached; kept when it is the largest of the episode.
  void peak(double force, double t);

  const Episode& episode() const { return result_.episodes.back(); }

  /// Since first touch, when the episode was deepest [J].
  double dissipated_at_deepest() const { return at_deepest_.dissipated; }

  double first_speed() const { return result_.episodes.front().approach_velocity; }

  /// Sums up at the end of the run, with the bar's energy then and its turning as a rigid body.
  void conclude(double t, const ContactTotals& totals, const ContactForce& contact,
                double penetration, const BeamEnergy& energy, const RigidPart& rigid);

 private:
  const Rig& rig_;
  double accuracy_;
  Simulation& result_;
  double energy_at_touch_ = 0.0;
  ContactTotals at_start_, at_deepest_;  // of the episode
  long grazing_ = 0;
};

/// Enters where the energy is at the end of a run, with what the audit holds already: initial,
/// minus the gravitational energy then, and all losses. `begun`: the bar's energy at first [J].
void close_audit(const Rig& rig, double begun, const BeamEnergy& energy, const RigidPart& rigid,
                 EnergyAudit& audit);

/// Warns where more is missing than the accuracy of the forces lets expect.
void warn_of_imbalance(double accuracy, Simulation& result);

/// Whether the rigid part of a free bar's motion has carried the struck point further than its
/// vibration and the stop's can bring them together again, and its swing will not within the
/// longest run. `reach`: √(2 C), C the elastic compliance of point and stop.
bool left_for_good(const Rig& rig, double reach, const RigidPart& rigid, const BeamEnergy& energy);

}  // namespace impactrig::models
