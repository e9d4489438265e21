// SPDX-License-Identifier: BSD-3-Clause
#include "models/history_recorder.hpp"

#include <cmath>

namespace impactrig::models {

void begin_history(const Rig& rig, const HistoryRequest& wanted, double struck_speed,
                   double velocity_speed, double displacement_speed, History& history) {
  if (!(wanted.interval > 0.0)) return;
  const long before = static_cast<long>(std::ceil(wanted.lead / wanted.interval));
  history.interval = wanted.interval;
  history.start = -static_cast<double>(before) * wanted.interval;
  const double omega = std::sqrt(rig.gravity * rig.beam.first_moment() / rig.beam.hinge_inertia());
  for (long k = -before; k <= 0; ++k) {
    const double t = static_cast<double>(k) * wanted.interval;
    const double way = omega > 0.0 ? std::sin(omega * t) / omega : t;
    history.force.push_back(0.0);
    history.penetration.push_back(struck_speed * way);
    history.velocity.push_back(velocity_speed * std::cos(omega * t));
    history.displacement.push_back(displacement_speed * way);
  }
}

}  // namespace impactrig::models
