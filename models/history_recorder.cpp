// SPDX-License-Identifier: BSD-3-Clause
#include "models/history_recorder.hpp"

#include <cmath>

#include "models/rigid_swing.hpp"

namespace impactrig::models {

long samples_before_touch(const HistoryRequest& wanted) {
  return static_cast<long>(std::ceil(wanted.lead / wanted.interval));
}

void begin_history(const Rig& rig, const HistoryRequest& wanted, double struck_speed,
                   double velocity_speed, double displacement_speed, History& history) {
  if (!(wanted.interval > 0.0)) return;
  const long before = samples_before_touch(wanted);
  history.interval = wanted.interval;
  history.start = -static_cast<double>(before) * wanted.interval;
  const RigidSwing swing(rig);
  const double rate = struck_speed / rig.contact.position;
  for (long k = -before; k <= 0; ++k) {
    const double t = static_cast<double>(k) * wanted.interval;
    const RigidSwing::State state = swing.near_touch(t, rate);
    history.force.push_back(0.0);
    history.penetration.push_back(struck_speed * state.angle / rate);
    history.velocity.push_back(velocity_speed * state.rate / rate);
    history.displacement.push_back(displacement_speed * state.angle / rate);
    if (!wanted.spot_slopes) continue;
    history.velocity_slope.push_back(state.rate);
    history.displacement_slope.push_back(state.angle);
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

std::size_t expected_samples(const History& begun, double duration) {
  constexpr double most = 1 << 20;
  const double count = (duration - begun.start) / begun.interval + 2.0;
  return static_cast<std::size_t>(count < most ? count : most);
}

void make_room(std::size_t samples, History& history) {
  for (const auto values :
       {&History::force, &History::penetration, &History::velocity, &History::displacement,
        &History::velocity_slope, &History::displacement_slope, &History::sensor_force})
    if (!(history.*values).empty()) (history.*values).reserve(samples);
  for (StopHistory& stop : history.further) {
    stop.force.reserve(samples);
    stop.penetration.reserve(samples);
  }
}

}  // namespace impactrig::models
