// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact/contact_force.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "models/contact/free_impact.hpp"

namespace impactrig::models {
namespace {

// Depths below it are as good as touch [m].
constexpr double least_depth = 1e-100;

// Of each half of free_impact(): where a root is looked for, and at the root.
constexpr int few_steps = 64, many_steps = 256;

/// Derivative at x > 0, of the fourth order in a thousandth of it.
template <typename Function>
double slope(const Function& f, double x) {
  const double h = 1e-3 * x;
  return (8.0 * (f(x + h) - f(x - h)) - (f(x + 2.0 * h) - f(x - 2.0 * h))) / (12.0 * h);
}

double sphere_stiffness(const Contact& contact) {
  Contact sphere = contact;
  sphere.law = "hertz-point";
  return std::get<PowerContact<>>(elastic_law(sphere)).factor;
}

}  // namespace

ContactForce::ContactForce(const Contact& contact, double mass)
    : law_(elastic_law(contact)),
      damping_(damping_law(contact.damping).text),
      factor_(damping_law(contact.damping).factor(contact.restitution)),
      mass_(contact.effective_mass.value_or(mass)),
      restitution_(contact.restitution),
      tension_(contact.tension),
      stated_speed_(contact.restitution_speed) {
  if (damping_.form == DampingForm::hertzian) sphere_stiffness_ = sphere_stiffness(contact);
  if (damping_.form == DampingForm::constant) stated_strength_ = contact.viscous;
  if (damping_.form == DampingForm::relaxing) stated_strength_ = contact.relaxation_time;
  if (stated_strength_) factor_ = *stated_strength_ > 0.0 ? 1.0 : 0.0;
}

ContactForce::ContactForce(const Rig& rig, int stop)
    : ContactForce(rig.contact_of(stop), rig.effective_mass(stop)) {}

void ContactForce::begin_episode(double approach_velocity) {
  if (damping_.speed == DampingSpeed::first && law_speed_ > 0.0) return;
  law_speed_ = stated_speed_.value_or(approach_velocity);
  strength_ = strength_at(law_speed_);
  if (damping_.form == DampingForm::implicit && !(strength_ * approach_velocity < 1.0))
    throw std::runtime_error(fmt::format(
        "contact.restitution_speed: the law '{}' has no force at {:.4g} m/s where its restitution "
        "is meant at {:.4g} m/s; state more than {:.4g} m/s, or none",
        damping_.name, approach_velocity, law_speed_, factor_ * approach_velocity));
  if (stated_strength_ || factor_ == 0.0) {
    strength_to_speed_ = 0.0;
    return;
  }
  switch (damping_.form) {
    case DampingForm::proportional:
    case DampingForm::implicit:
    case DampingForm::hertzian:
      strength_to_speed_ = -strength_ / law_speed_;
      return;
    case DampingForm::natural:
    case DampingForm::tangent:
    case DampingForm::closing:
      strength_to_speed_ = 0.0;
      return;
    case DampingForm::constant:
      strength_to_speed_ = slope([&](double v) { return strength_at(v); }, law_speed_);
      return;
    case DampingForm::relaxing:  // along e of strength and speed that stays
      strength_to_speed_ =
          -slope([&](double v) { return rebound(strength_, v, many_steps); }, law_speed_) /
          slope([&](double s) { return rebound(s, law_speed_, many_steps); }, strength_);
      return;
  }
}

double ContactForce::strength_at(double speed) const {
  if (stated_strength_) return *stated_strength_;
  if (factor_ == 0.0) return 0.0;
  switch (damping_.form) {
    case DampingForm::proportional:
    case DampingForm::implicit:
      return factor_ / speed;
    case DampingForm::hertzian:
      return factor_ * sphere_stiffness_ / speed;
    case DampingForm::natural:
    case DampingForm::tangent:
    case DampingForm::closing:
      return 2.0 * factor_ * std::sqrt(mass_);
    case DampingForm::constant:  // k = m v² / δ² takes the energy as deep as f_0 does
      return 2.0 * factor_ * mass_ * speed /
             models::penetration_storing(law_, 0.5 * mass_ * speed * speed);
    case DampingForm::relaxing:
      return relaxation_at(speed);
  }
  throw std::logic_error("ContactForce: damping form out of range");
}

/// What a free rigid impact rebounds with.
double ContactForce::rebound(double strength, double speed, int steps) const {
  ContactForce trial = *this;
  trial.strength_ = strength;
  return free_impact(trial, mass_, speed, steps).rebound_ratio;
}

/// τ at which that is the restitution asked for.
double ContactForce::relaxation_at(double speed) const {
  const auto excess = [&](double log_time, int steps) {
    return rebound(std::exp(log_time), speed, steps) - restitution_;
  };
  // e = 1 − 1.15 · 3/2 τ f'/f v and so on: within two decades of depth / speed
  const double depth = models::penetration_storing(law_, 0.5 * mass_ * speed * speed);
  const double guess = std::log((1.0 - restitution_) * depth / speed);
  const auto root_by = [&](int steps, int bits) {
    const auto rough = [&](double log_time) { return excess(log_time, steps); };
    double low = guess - 2.0, high = guess + 2.0;
    while (rough(low) < 0.0 && low > guess - 40.0) low -= 3.0;
    while (rough(high) > 0.0 && high < guess + 40.0) high += 3.0;
    std::uintmax_t most = 100;
    const auto root = boost::math::tools::toms748_solve(
        rough, low, high, boost::math::tools::eps_tolerance<double>(bits), most);
    return 0.5 * (root.first + root.second);
  };
  constexpr double near = 1e-3, there = 1e-11;  // of e
  constexpr double apart = 1e-3;                // of ln τ
  double log_time = root_by(few_steps, 30);
  double left = excess(log_time, many_steps);
  const double steepness =
      (excess(log_time + apart, few_steps) - excess(log_time - apart, few_steps)) / (2.0 * apart);
  for (int k = 0; k < 3 && std::abs(left) < near && std::abs(left) > there; ++k) {
    log_time -= left / steepness;
    left = excess(log_time, many_steps);
  }
  // of strong damping few steps know little
  if (!(std::abs(left) <= there)) left = excess(log_time = root_by(many_steps, 50), many_steps);
  if (!(std::abs(left) < 1e-5))
    throw std::runtime_error(fmt::format(
        "contact.restitution: no damping of the law '{}' rebounds with {:g}; with so much of it a "
        "contact that may pull holds the bar. Take contact.tension = \"clip\", a larger "
        "restitution, or state contact.relaxation_time",
        damping_.name, restitution_));
  return std::exp(log_time);
}

/// Of a depth > 0.
ContactForce::Weight ContactForce::weight(double depth) const {
  if (damping_.form == DampingForm::constant) return {1.0, 0.0};
  const double x = std::max(depth, least_depth);
  if (damping_.form == DampingForm::hertzian) return {x * std::sqrt(x), 1.5 * std::sqrt(x)};
  const ElasticState at = elastic_state(law_, x);
  switch (damping_.form) {
    case DampingForm::natural: {
      const double z = std::sqrt(2.0 * at.energy);
      if (z == 0.0) return {0.0, 0.0};  // of a steep law at touch, where it underflows
      const double g = at.force / z;
      return {g, (at.stiffness - g * g) / z};
    }
    case DampingForm::tangent: {
      const double root = std::sqrt(at.stiffness);
      return {root, at.curvature / (2.0 * root)};
    }
    case DampingForm::closing: {
      const double secant = at.force / x;
      const double root = std::sqrt(secant);
      return {root, (at.stiffness - secant) / (2.0 * x * root)};
    }
    case DampingForm::relaxing:
      return {at.stiffness, at.curvature};
    case DampingForm::proportional:
    case DampingForm::implicit:
    case DampingForm::constant:
    case DampingForm::hertzian:
      break;
  }
  throw std::logic_error("ContactForce: damping form out of range");
}

ContactForce::Response ContactForce::pressed(double penetration, double rate) const {
  const auto [size, stiffness] = force_and_stiffness(law_, std::abs(penetration));
  const double elastic = std::copysign(size, penetration);
  const double s = strength_;
  if (damping_.form == DampingForm::proportional) {
    const double pull = 1.0 + s * rate;
    return {elastic * pull, stiffness,      stiffness * pull,
            elastic * s,    elastic * rate, stiffness * s};
  }
  if (damping_.form == DampingForm::implicit) {
    const double pull = 1.0 - s * rate;
    if (!(pull > 0.0)) {
      const double nothing = std::numeric_limits<double>::quiet_NaN();
      return {nothing, stiffness, nothing, nothing, nothing, nothing, nothing};
    }
    const double by = 1.0 / pull;
    const double rise = elastic * by * by;
    return {elastic * by,
            stiffness,
            stiffness * by,
            rise * s,
            rise * rate,
            stiffness * s * by * by,
            2.0 * rise * s * s * by};
  }
  if (phase_ == Phase::opening) return {elastic, stiffness, stiffness};
  const Weight w = weight(std::abs(penetration));
  const double slope = std::copysign(w.slope, penetration);
  return {elastic + s * w.value * rate,
          stiffness,
          stiffness + s * slope * rate,
          s * w.value,
          w.value * rate,
          s * slope};
}

double ContactForce::force(double penetration, double rate) const {
  if (!presses()) return 0.0;
  if (damping_.form == DampingForm::proportional)
    return elastic(penetration) * (1.0 + strength_ * rate);
  return pressed(penetration, rate).force;
}

ContactForce::ForceAndLoss ContactForce::force_and_loss(double penetration, double rate) const {
  if (phase_ == Phase::free) return {};
  const double spring = elastic(penetration);
  if (phase_ == Phase::slack) return {0.0, -spring * rate};
  if (damping_.form == DampingForm::proportional) {
    const double damping = spring * strength_ * rate;
    return {spring + damping, damping * rate};
  }
  const double force = pressed(penetration, rate).force;
  return {force, (force - spring) * rate};
}

bool ContactForce::ends_smoothly() const {
  const bool steep = damping_.form == DampingForm::natural ||
                     damping_.form == DampingForm::tangent ||
                     damping_.form == DampingForm::relaxing;
  return !(steep && damped() && may_pull());
}

bool ContactForce::may_switch() const {
  if (phase_ == Phase::free) return false;
  if (damping_.form == DampingForm::closing) return true;
  return strength_ > 0.0 && tension_ == Tension::clip && damping_.form != DampingForm::implicit;
}

ContactForce::Switch ContactForce::switching(double penetration, double rate) const {
  const double sign = phase_ == Phase::pressed ? 1.0 : -1.0;
  if (damping_.form == DampingForm::closing) return {sign * rate, 0.0, sign, 0.0};
  if (damping_.form == DampingForm::proportional)
    return {sign * (1.0 + strength_ * rate), 0.0, sign * strength_,
            sign * strength_to_speed_ * rate};
  const Response law = pressed(penetration, rate);
  return {sign * law.force, sign * law.to_depth, sign * law.to_rate, sign * to_speed(law)};
}

ContactForce::Phase ContactForce::switched() const {
  if (phase_ != Phase::pressed) return Phase::pressed;
  return damping_.form == DampingForm::closing ? Phase::opening : Phase::slack;
}

bool ContactForce::differs(const ContactForce& other) const {
  const bool by_mass = damping_.speed == DampingSpeed::none ||
                       damping_.form == DampingForm::constant ||
                       damping_.form == DampingForm::relaxing;
  return law_ != other.law_ || factor_ != other.factor_ || restitution_ != other.restitution_ ||
         sphere_stiffness_ != other.sphere_stiffness_ || stated_speed_ != other.stated_speed_ ||
         stated_strength_ != other.stated_strength_ ||
         (by_mass && !stated_strength_ && damped() && mass_ != other.mass_);
}

double ContactForce::force_of_impact(double speed, double depth) const {
  if (factor_ == 0.0) return elastic(depth);
  ContactForce trial = *this;
  trial.law_speed_ = stated_speed_.value_or(speed);
  trial.strength_ = strength_at(trial.law_speed_);
  trial.set_phase(Phase::pressed);
  const double damped = trial.pressed(depth, speed).force;
  // an implicit law may have no force at this speed
  return std::isfinite(damped) ? damped
                               : elastic(depth) * (1.0 + factor_ / (1.0 - std::min(factor_, 0.9)));
}

double ContactForce::damping_share(double speed, double depth) const {
  return force_of_impact(speed, depth) / elastic(depth) - 1.0;
}

bool contacts_end_smoothly(const Rig& rig) {
  for (int stop = 0; stop < rig.stops(); ++stop)
    if (!ContactForce(rig, stop).ends_smoothly()) return false;
  return true;
}

}  // namespace impactrig::models
