// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "models/contact/damping_law.hpp"
#include "models/contact/elastic_law.hpp"

namespace impactrig::models {

/// Contact force of the episode at hand: an elastic law f_0(δ) and a damping law that adds to it as
/// its DampingForm says. Where the two together would pull, the force is kept at zero, or pulls,
/// as the contact's `tension` says.
///
/// Within a phase the force is a smooth function of δ and δ̇, also a little beyond the phase's end,
/// so that an integrator may step over the end before the event is located: while pressed f_0 is
/// continued as an odd function to δ < 0.
class ContactForce {
 public:
  enum class Phase {
    free,     ///< δ < 0, no force
    pressed,  ///< δ > 0, both laws act
    opening,  ///< δ > 0, the damping rests since it acts while closing only
    slack     ///< δ > 0, the laws would pull; the force is zero
  };

  /// `mass`: the effective mass that damping laws made of a damping ratio take [kg]. Throws
  /// std::invalid_argument as elastic_law() and damping_law() do.
  ContactForce(const Contact& contact, double mass);

  /// Of a stop of the rig; 0 is struck first.
  explicit ContactForce(const Rig& rig, int stop = 0);

  void set_phase(Phase phase) { phase_ = phase; }

  Phase phase() const { return phase_; }

  /// Whether the laws act.
  bool presses() const { return phase_ == Phase::pressed || phase_ == Phase::opening; }

  /// A new episode begins, at an approach speed [m/s, > 0]; the first one counts for laws that keep
  /// their speed.
  void begin_episode(double approach_velocity);

  const ElasticLaw& law() const { return law_; }

  DampingForm form() const { return damping_.form; }

  bool damped() const { return factor_ > 0.0; }

  bool may_pull() const { return tension_ == Tension::allow; }

  double damping_factor() const { return factor_; }  ///< d or ζ, as the form has it [-]

  /// s of the damping law in this episode, see DampingForm.
  double strength() const { return strength_; }

  /// The speed by which the damping law took its strength [m/s].
  double law_speed() const { return law_speed_; }

  /// Where that comes from: stated speeds do not change with the motion.
  bool speed_is_stated() const { return stated_speed_.has_value(); }

  /// Whether each contact's approach speed sets its damping.
  bool takes_own_speed() const {
    return damped() && damping_.speed == DampingSpeed::own && !speed_is_stated();
  }

  bool keeps_first_speed() const { return damping_.speed == DampingSpeed::first; }

  double elastic(double penetration) const {
    return penetration >= 0.0 ? elastic_force(law_, penetration)
                              : -elastic_force(law_, -penetration);
  }

  double stored(double penetration) const {
    return stored_energy(law_, penetration);
  }  ///< elastic energy [J]

  double force(double penetration, double rate) const;  ///< in this phase [N]

  struct ForceAndLoss {
    double force = 0.0;        ///< [N]
    double dissipation = 0.0;  ///< power lost in the contact [W]
  };

  ForceAndLoss force_and_loss(double penetration, double rate) const;  ///< in this phase

  double dissipation(double penetration, double rate) const {
    return force_and_loss(penetration, rate).dissipation;
  }

  /// Force while it presses, with its derivatives.
  struct Response {
    double force = 0.0;        ///< [N]
    double stiffness = 0.0;    ///< of the elastic law [N/m]
    double to_depth = 0.0;     ///< ∂f/∂δ [N/m]
    double to_rate = 0.0;      ///< ∂f/∂δ̇ [N s/m]
    double to_strength = 0.0;  ///< ∂f/∂s
    double mixed = 0.0;        ///< ∂²f/∂δ∂δ̇ [N s/m²]
    double bend = 0.0;         ///< ∂²f/∂δ̇² [N s²/m²]
  };

  Response pressed(double penetration, double rate) const;

  /// ∂f/∂v of the speed the damping law takes [N s/m].
  double to_speed(const Response& response) const {
    return response.to_strength * strength_to_speed_;
  }

  /// Whether the force's derivatives stay bounded where the gap opens. They do not where a contact
  /// may pull by a damping whose coefficient falls to zero with an infinite slope.
  bool ends_smoothly() const;

  /// Whether the phase may end before the gap opens.
  bool may_switch() const;

  /// A function that changes sign where it does, with its derivatives: > 0 before, < 0 after.
  struct Switch {
    double value = 0.0;
    double to_depth = 0.0, to_rate = 0.0, to_speed = 0.0;
  };

  Switch switching(double penetration, double rate) const;

  /// The phase beyond that.
  Phase switched() const;

  /// What presses in an impact of this speed [m/s], at this depth [m], before it has slowed down
  /// [N].
  double force_of_impact(double speed, double depth) const;

  /// Largest part of the force that is damping's in an impact of this speed [m/s] and depth [m], of
  /// the elastic force.
  double damping_share(double speed, double depth) const;

  /// Whether another contact, or one of another bar, presses otherwise.
  bool differs(const ContactForce& other) const;

  /// Whether it differs at most by the strength of its damping.
  bool differs_by_strength(const ContactForce& other) const {
    return law_ == other.law_ && damping_.form == other.damping_.form;
  }

  double limit_penetration() const { return models::limit_penetration(law_); }

 private:
  struct Weight {
    double value, slope;  // w of the damping s w(δ) δ̇, and dw/dδ
  };

  Weight weight(double depth) const;
  double strength_at(double speed) const;
  double rebound(double strength, double speed, int steps) const;
  double relaxation_at(double speed) const;

  ElasticLaw law_;
  DampingLawText damping_;
  double factor_;
  double mass_;
  double restitution_;
  Tension tension_;
  double sphere_stiffness_ = 0.0;  // K of DampingForm::hertzian [N/m^(3/2)]
  std::optional<double> stated_speed_, stated_strength_;
  double strength_ = 0.0, strength_to_speed_ = 0.0, law_speed_ = 0.0;
  Phase phase_ = Phase::free;
};

/// Penetration at which the elastic law has stored an energy [J]: how deep an elastic impact goes.
inline double penetration_storing(const ContactForce& contact, double energy) {
  return penetration_storing(contact.law(), energy);
}

/// Whether those at all stops do, as ContactForce::ends_smoothly() says.
bool contacts_end_smoothly(const Rig& rig);

}  // namespace impactrig::models
