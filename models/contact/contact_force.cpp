// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact/contact_force.hpp"

#include <algorithm>
#include <cmath>

#include "models/contact/damping_law.hpp"

namespace impactrig::models {

ContactForce::ContactForce(const Contact& contact)
    : law_(elastic_law(contact)),
      factor_(damping_law(contact.damping).factor(contact.restitution)) {}

double ContactForce::stored(double penetration) const {
  return std::visit([&](const auto& law) { return law.energy(penetration); }, law_);
}

double ContactForce::limit_penetration() const {
  return std::visit([](const auto& law) { return law.limit_penetration(); }, law_);
}

double ContactForce::force(double penetration, double rate) const {
  return phase_ == Phase::pressed ? elastic(penetration) * pull(rate) : 0.0;
}

double ContactForce::dissipation(double penetration, double rate) const {
  switch (phase_) {
    case Phase::free:
      return 0.0;
    case Phase::pressed:
      return elastic(penetration) * mu_ * rate * rate;
    case Phase::slack:
      return -elastic(penetration) * rate;
  }
  return 0.0;
}

ContactForce::Response ContactForce::pressed(double penetration, double rate) const {
  const auto [size, stiffness] = std::visit(
      [&](const auto& law) { return law.force_and_stiffness(std::abs(penetration)); }, law_);
  const double elastic = std::copysign(size, penetration);
  return {elastic * pull(rate), stiffness * pull(rate), elastic * mu_};
}

double ContactForce::force_rate(double penetration, double rate, double acceleration) const {
  if (phase_ != Phase::pressed) return 0.0;
  const double slope =
      std::visit([&](const auto& law) { return law.stiffness(penetration); }, law_);
  return slope * rate * pull(rate) + elastic(penetration) * mu_ * acceleration;
}

double penetration_storing(const ContactForce& contact, double energy) {
  // Newton's method for ln E of ln δ, which is nearly straight: E ~ δ² or so
  double depth = 1e-6;
  for (int i = 0; i < 60; ++i) {
    const double stored = contact.stored(depth);
    const double exponent = depth * contact.elastic(depth) / stored;
    const double factor = std::pow(energy / stored, 1.0 / exponent);
    depth *= std::clamp(factor, 1e-30, 1e30);
    if (std::abs(factor - 1.0) < 1e-14) break;
  }
  return depth;
}

}  // namespace impactrig::models
