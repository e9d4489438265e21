// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/rig_effect.hpp"

#include <array>
#include <utility>

#include "models/history_recorder.hpp"

namespace impactrig::models {
namespace {

constexpr std::array shown = {&History::force, &History::penetration, &History::velocity,
                              &History::displacement};

/// Whether the bars, and the points that are looked at, are the same.
bool same_bar(const Rig& one, const Rig& other) {
  for (int stop = 0; stop < one.stops(); ++stop)
    if (one.contact_of(stop).position != other.contact_of(stop).position) return false;
  return one.beam == other.beam && one.hinge == other.hinge && one.gravity == other.gravity &&
         one.gravity_direction == other.gravity_direction;
}

}  // namespace

RigEffect::RigEffect(const Rig& rig, RigParameter parameter)
    : RigEffect(ParameterStencil(rig, parameter)) {}

RigEffect::RigEffect(const Rig& rig, RigParameter parameter, const Solver& solver,
                     const HistoryRequest& history)
    : RigEffect(ParameterStencil(rig, parameter, solver, history)) {}

RigEffect::RigEffect(ParameterStencil by)
    : by_(std::move(by)),
      keeps_bar_(same_bar(by_.rig(), by_.rig_beside())),
      moves_friction_(by_.rig_beside().hinge.friction != by_.rig().hinge.friction),
      touch_speed_(by_.rig().has_stop() ? by_.slope([&](std::size_t place) {
        return touch_velocity(by_.rig_at(place));
      })
                                        : 0.0) {
  const Rig& rig = by_.rig();
  laws_.reserve(static_cast<std::size_t>(rig.stops()));
  for (int stop = 0; stop < rig.stops(); ++stop) laws_.emplace_back(rig, stop, by_);
}

bool RigEffect::has_slopes() const {
  if (!by_.keeps_elements()) return false;
  const Hinge &here = by_.rig().hinge, beside = by_.rig_beside().hinge;
  if (moves_friction_ && here.friction == 0.0) return false;
  return !here.rotation || here.rotation->time > 0.0 || beside.rotation == here.rotation ||
         beside.rotation->time == 0.0;
}

/// The pendulum's frequency where nothing holds it has no slope, its square has.
bool RigEffect::small_motion_knows() const {
  const Rig &here = by_.rig(), &beside = by_.rig_beside();
  const auto holds = [](const Rig& rig) {
    return rig.gravity_along() != 0.0 || rig.hinge.spring != 0.0;
  };
  return !(moves_friction_ && here.hinge.friction > 0.0) && holds(here) == holds(beside) &&
         beyond_small_motion(beside).empty();
}

/// Where nothing before touch changes.
History RigEffect::still(const HistoryRequest& wanted) const {
  History zero;
  const long before = samples_before_touch(wanted);
  zero.start = -static_cast<double>(before) * wanted.interval;
  zero.interval = wanted.interval;
  const std::vector<double> zeros(static_cast<std::size_t>(before) + 1, 0.0);
  for (const auto values : shown) zero.*values = zeros;
  zero.further.assign(laws_.size() - 1, {zeros, zeros});
  return zero;
}

History RigEffect::lead(const HistoryRequest& wanted, double speed, double slope) const {
  History sum;
  if (!(wanted.interval > 0.0)) return sum;
  if (slope == 0.0 && keeps_bar_ && !moves_gap()) return still(wanted);
  const auto add = [](std::vector<double>& to, double weight, const std::vector<double>& part) {
    to.resize(part.size(), 0.0);
    for (std::size_t k = 0; k < part.size(); ++k) to[k] += weight * part[k];
  };
  for (std::size_t place = 0; place < ParameterStencil::places; ++place) {
    if (!by_.counts(place)) continue;
    const Rig there = by_.rig_at(place);
    const double arriving = speed + by_.offset(place) * slope;
    const auto speed_at = [&](double x) {
      return x > 0.0 ? arriving * x / there.contact.position : arriving;
    };
    History lead;
    begin_history(there, wanted, arriving, speed_at(wanted.velocity_position),
                  speed_at(wanted.displacement_position), lead);
    sum.start = lead.start;
    sum.interval = lead.interval;
    const double weight = by_.weight(place);
    for (const auto values : shown) add(sum.*values, weight, lead.*values);
    sum.further.resize(lead.further.size());
    for (std::size_t k = 0; k < lead.further.size(); ++k) {
      add(sum.further[k].force, weight, lead.further[k].force);
      add(sum.further[k].penetration, weight, lead.further[k].penetration);
    }
  }
  return sum;
}

}  // namespace impactrig::models
