// SPDX-License-Identifier: BSD-3-Clause
#include "models/history_recorder.hpp"

#include <cmath>

#include "models/rigid_swing.hpp"

namespace impactrig::models {

void begin_history(const Rig& rig, const HistoryRequest& wanted, double struck_speed,
                   double velocity_speed, double displacement_speed, History& history) {
  if (!(wanted.interval > 0.0)) return;
  const long before = static_cast<long>(std::ceil(wanted.lead / wanted.interval));
  history.interval = wanted.interval;
  history.start = -static_cast<double>(before) * wanted.interval;
  const RigidSwing swing(rig);
  for (long k = -before; k <= 0; ++k) {
    const double t = static_cast<double>(k) * wanted.interval;
    const RigidSwing::State part = swing.near_touch(t, 1.0);
    history.force.push_back(0.0);
    history.penetration.push_back(struck_speed * part.angle);
    history.velocity.push_back(velocity_speed * part.rate);
    history.displacement.push_back(displacement_speed * part.angle);
  }
  for (const FurtherStop& stop : rig.further_stops) {
    const double speed =
        stop.direction() * struck_speed * stop.contact.position / rig.contact.position;
    StopHistory& at_stop = history.further.emplace_back();
    at_stop.force.resize(history.force.size(), 0.0);
    for (const double penetration : history.penetration)
      at_stop.penetration.push_back(penetration / struck_speed * speed - stop.gap);
  }
}

}  // namespace impactrig::models
