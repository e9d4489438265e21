// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "models/contact/contact_force.hpp"
#include "models/sensitivities/parameter_stencil.hpp"

namespace impactrig::models {

/// What a parameter changes of a stop: its contact law, by differences of that closed form or in
/// closed form itself, and how far it stands away. Derivatives are those with the motion held.
class LawEffect {
 public:
  LawEffect(const Rig& rig, int stop, const ParameterStencil& by);

  /// Of the gap to the straight bar [m a unit].
  double gap() const { return gap_; }

  /// The stop's contact begins, with a law that takes this speed [m/s].
  void begin_episode(double law_speed);

  void set_phase(ContactForce::Phase phase);

  /// Of the pressing force, which is `law` at this penetration and rate [N a unit].
  double of_force(double depth, double rate, const ContactForce::Response& law) const;

  /// Of ContactForce::switching(), dissipation() and stored().
  double of_switching(double depth, double rate) const;
  double of_dissipation(double depth, double rate) const;
  double of_stored(double depth) const;

 private:
  enum class Change { none, by_strength, by_factor, otherwise };

  template <typename Function>
  double slope(const Function& of_contact) const;

  const ParameterStencil& by_;
  double gap_;
  Change change_ = Change::none;
  double factor_;                       // of the stiffness
  double strength_ = 0.0;               // slope of the damping's s, where the force changes by it
  std::vector<ContactForce> contacts_;  // at the stencil's places; empty where none changes
};

}  // namespace impactrig::models
