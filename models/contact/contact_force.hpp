// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "models/contact/elastic_law.hpp"

namespace impactrig::models {

/// Contact force f = f_0(δ) (1 + μ δ̇) of the episode at hand, never tensile.
///
/// Within a phase the force is a smooth function of δ and δ̇, also a little beyond the phase's end,
/// so that an integrator may step over the end before the event is located: while pressed f_0 is
/// continued as an odd function to δ < 0.
class ContactForce {
 public:
  enum class Phase {
    free,     ///< δ < 0, no force
    pressed,  ///< δ > 0, 1 + μ δ̇ > 0
    slack     ///< δ > 0, 1 + μ δ̇ < 0: the law would pull; the force is zero
  };

  explicit ContactForce(const Contact& contact);

  /// Of the stop that is struck first.
  explicit ContactForce(const Rig& rig) : ContactForce(rig.contact) {}

  void set_phase(Phase phase) { phase_ = phase; }

  Phase phase() const { return phase_; }

  /// A new episode begins: μ = d / approach velocity [m/s, > 0].
  void begin_episode(double approach_velocity) { mu_ = factor_ / approach_velocity; }

  const ElasticLaw& law() const { return law_; }

  double damping_factor() const { return factor_; }  ///< d [-]

  double mu() const { return mu_; }  ///< [s/m]

  double elastic(double penetration) const {
    return penetration >= 0.0 ? force_0(penetration) : -force_0(-penetration);
  }

  double stored(double penetration) const;              ///< elastic energy [J]
  double force(double penetration, double rate) const;  ///< in this phase [N]
  double dissipation(double penetration,
                     double rate) const;  ///< power lost in the contact in this phase [W]

  /// Force while pressed, with its derivatives.
  struct Response {
    double force = 0.0;     ///< [N]
    double to_depth = 0.0;  ///< ∂f/∂δ [N/m]
    double to_rate = 0.0;   ///< ∂f/∂δ̇ [N s/m]
  };

  Response pressed(double penetration, double rate) const;

  /// df/dt while pressed, for finding the peak [N/s].
  double force_rate(double penetration, double rate, double acceleration) const;

  /// 1 + μ δ̇: changes sign between pressed and slack.
  double pull(double rate) const { return 1.0 + mu_ * rate; }

  double limit_penetration() const;

 private:
  double force_0(double penetration) const {
    return std::visit([&](const auto& law) { return law.force(penetration); }, law_);
  }

  ElasticLaw law_;
  double factor_;
  double mu_ = 0.0;
  Phase phase_ = Phase::free;
};

/// Penetration at which the elastic law has stored an energy [J]: how deep an elastic impact goes.
double penetration_storing(const ContactForce& contact, double energy);

}  // namespace impactrig::models
