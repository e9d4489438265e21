// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/direct_restitution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "fitting/direct_trial.hpp"

namespace impactrig::fitting {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::ImpactSignal;

namespace {

constexpr double quantile = 1.959963985;  // of the normal distribution, 97.5 %
constexpr int repetitions = 256;          // with noise of one channel added
constexpr double chain_doubt = 0.1;       // of the correction for the sensors' chain
constexpr double spot_tolerance = 2e-3;   // laser spot off the struck point, of its distance
constexpr std::uint64_t force_seed = 1, motion_seed = 2;

/// One of the numbers that a reading of the record gives.
using Number = std::function<double(const ContactPhases&)>;

double ratio_of_work(const ContactPhases& p) {
  return std::sqrt(std::max(0.0, p.work_out) / p.work_in);
}

/// All readings that are needed, made once for all numbers.
struct Readings {
  struct Pair {
    std::string source;
    ContactPhases up, down;
  };

  ContactPhases here;
  std::vector<ContactPhases> with_force_noise, with_motion_noise;
  std::array<ContactPhases, 2> node_delays;     // ±√3 u
  std::array<ContactPhases, 2> extreme_delays;  // ±1.96 u
  std::vector<Pair> pairs;                      // one standard uncertainty up and down
  ContactPhases unfiltered, fully_undone;
};

std::vector<ContactPhases> with_noise(const DirectReading& reading, bool of_force) {
  const ImpactSignal& signal = of_force ? reading.force() : reading.motion();
  const double sigma = std::max(signal.noise, signal.quantum / std::sqrt(12.0));
  std::vector<ContactPhases> readings;
  if (!(sigma > 0.0)) return readings;
  NoiseSource source(sigma, signal.noise_correlation, of_force ? force_seed : motion_seed);
  std::vector<double> noise(of_force ? reading.force_samples() : reading.motion_samples());
  for (int i = 0; i < repetitions; ++i) {
    source.fill(noise);
    Trial trial;
    (of_force ? trial.force_noise : trial.motion_noise) = &noise;
    trial.smooth_speed = of_force;
    readings.push_back(reading.phases(trial));
  }
  return readings;
}

/// How sure the velocity's zero is [m/s]: by how much it must be shifted for the penetration to end
/// at zero, or what the instants of touch and separation leave open of that.
double zero_error(const ContactPhases& p, const ImpactSignal& motion) {
  if (motion.quantity != datasets::Quantity::velocity) return 0.0;
  const double duration = p.separation - p.touch;
  const double closing = p.drift / duration;
  const double at_touch = p.approach * p.touch_error / duration;
  const double at_separation = p.rebound * p.separation_error / duration;
  const double noise =
      motion.noise * std::sqrt(motion.noise_correlation * motion.interval / duration);
  const double open = at_touch * at_touch + at_separation * at_separation + noise * noise;
  return std::sqrt(std::max(closing * closing, open) + motion.quantum * motion.quantum / 12.0);
}

Readings take_readings(const DirectReading& reading) {
  Readings r;
  r.here = reading.phases({});
  r.with_force_noise = with_noise(reading, true);
  r.with_motion_noise = with_noise(reading, false);
  const double delay =
      std::hypot(reading.force().delay_uncertainty, reading.motion().delay_uncertainty);
  const auto later = [&](double by) {
    Trial trial;
    trial.later = by;
    return reading.phases(trial);
  };
  const double node = std::sqrt(3.0) * delay;
  r.node_delays = {later(node), later(-node)};
  r.extreme_delays = {later(quantile * delay), later(-quantile * delay)};
  const auto pair = [&](const char* source, double Trial::*what, double by) {
    Trial up, down;
    up.*what += by;
    down.*what -= by;
    r.pairs.push_back({source, reading.phases(up), reading.phases(down)});
  };
  pair("force gain", &Trial::force_gain, reading.force().gain_uncertainty);
  pair("motion gain", &Trial::motion_gain, reading.motion().gain_uncertainty);
  pair("force baseline", &Trial::force_offset, reading.force_wander());
  pair("velocity zero", &Trial::speed_offset, zero_error(r.here, reading.motion()));
  pair("instant of touch", &Trial::touch, r.here.touch_error);
  pair("instant of separation", &Trial::separation, r.here.separation_error);
  Trial unfiltered, all;
  unfiltered.chain = ChainUndo::none;
  all.chain = ChainUndo::all;
  r.unfiltered = reading.phases(unfiltered);
  r.fully_undone = reading.resolved() ? r.here : reading.phases(all);
  return r;
}

double spread(const std::vector<ContactPhases>& readings, const Number& number) {
  double n = 0.0, mean = 0.0, squares = 0.0;
  for (const ContactPhases& phases : readings) {
    const double value = number(phases);
    if (!std::isfinite(value)) continue;
    n += 1.0;
    const double off = value - mean;
    mean += off / n;
    squares += off * (value - mean);
  }
  return n > 1.0 ? std::sqrt(squares / (n - 1.0)) : 0.0;
}

double finite_or_zero(double value) {
  return std::isfinite(value) ? value : 0.0;
}

/// Value, budget and interval of one number.
DirectEstimate estimate_of(const Readings& r, const Number& number) {
  DirectEstimate estimate;
  estimate.value = number(r.here);
  const auto change = [&](const ContactPhases& phases) {
    return finite_or_zero(number(phases) - estimate.value);
  };
  estimate.budget = {{"force noise", spread(r.with_force_noise, number)},
                     {"motion noise", spread(r.with_motion_noise, number)}};
  const double ahead = change(r.node_delays[0]), behind = change(r.node_delays[1]);
  const double delay = std::sqrt((ahead * ahead + behind * behind) / 6.0);
  for (const Readings::Pair& pair : r.pairs)
    estimate.budget.push_back(
        {pair.source, 0.5 * std::abs(finite_or_zero(number(pair.up) - number(pair.down)))});
  estimate.budget.push_back({"sensors' chain", chain_doubt * std::abs(change(r.unfiltered)) +
                                                   std::abs(change(r.fully_undone))});
  double others = 0.0;
  for (const Contribution& part : estimate.budget) others += part.std_error * part.std_error;
  estimate.budget.insert(estimate.budget.begin() + 2, {"relative delay", delay});
  estimate.std_error = std::sqrt(others + delay * delay);
  const double first = change(r.extreme_delays[0]), second = change(r.extreme_delays[1]);
  const double up = std::max({first, second, 0.0}), down = std::min({first, second, 0.0});
  const double rest = quantile * quantile * others;
  estimate.ci95 = {estimate.value - std::sqrt(rest + down * down),
                   estimate.value + std::sqrt(rest + up * up)};
  return estimate;
}

DirectEstimate absent(std::string why) {
  DirectEstimate estimate;
  estimate.absent = std::move(why);
  return estimate;
}

void all_absent(const std::string& why, DirectRestitution& result) {
  for (DirectEstimate* estimate :
       {&result.kinematic, &result.smoothed, &result.kinetic, &result.energetic,
        &result.hysteresis.dissipated, &result.hysteresis.max_penetration})
    *estimate = absent(why);
}

/// Why nothing can be read from a record; empty where something can.
std::string why_nothing(const Impact& impact, const RigFile& rig) {
  if (!impact.force)
    return "There is no force channel, which says when the contact begins and ends.";
  if (!impact.velocity && !impact.displacement)
    return "There is no velocity or displacement channel.";
  if (impact.velocity && rig.velocity && rig.velocity->low_cut)
    return "The velocity channel does not go down to 0 Hz, so that the speeds before and after the "
           "contact are lost; use a decoder range that does.";
  if (impact.has(ImpactFlag::inverted)) return "A channel has the wrong sign.";
  if (impact.has(ImpactFlag::missed_start)) return "The record begins after first touch.";
  if (impact.has(ImpactFlag::truncated_tail) || impact.has(ImpactFlag::too_short))
    return "The record ends before the contact does.";
  if (!(impact.end > impact.start)) return "The contact's end was not found.";
  return "";
}

void fill_loop(const DirectReading& reading, const ContactPhases& phases, Hysteresis& loop) {
  const ContactRecord record = reading.record({});
  const std::vector<double> depth = penetration_of(record, phases.touch);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double t = record.time(i);
    if (t < phases.touch - record.interval || t > phases.separation + record.interval) continue;
    loop.time.push_back(t - phases.touch);
    loop.penetration.push_back(depth[i]);
    loop.force.push_back(record.force[i]);
  }
}

void estimate_speeds(const DirectReading& reading, const Readings& readings,
                     DirectRestitution& result) {
  const ContactPhases& p = readings.here;
  const double near = 0.05 * (p.separation - p.touch);
  if (reading.motion_lost(p.separation - near, p.separation + near)) {
    result.kinematic = absent("Samples of the velocity about separation are lost.");
  } else {
    result.kinematic =
        estimate_of(readings, [](const ContactPhases& x) { return x.rebound / x.approach; });
  }
  if (!std::isfinite(p.smoothed)) {
    result.smoothed = absent("The record is too short after separation to average the vibration.");
    return;
  }
  result.smoothed =
      estimate_of(readings, [](const ContactPhases& x) { return x.smoothed / x.approach; });
  DirectEstimate& e = result.smoothed;
  const double swings = p.smoothed_error / p.approach;
  e.budget.push_back({"vibration", swings});
  e.std_error = std::hypot(e.std_error, swings);
  for (std::size_t side : {0U, 1U}) {
    const double half = std::hypot(e.ci95[side] - e.value, quantile * swings);
    e.ci95[side] = e.value + (side == 0 ? -half : half);
  }
}

/// What needs the force's size and the motion within the contact.
std::string why_no_work(const Impact& impact, const DirectReading& reading,
                        const ContactPhases& p) {
  if (impact.has(ImpactFlag::clipped))
    return "A channel reaches the end of its range in the contact: impulse and work are too small.";
  if (reading.force_lost(p.touch, p.separation) || reading.motion_lost(p.touch, p.separation))
    return "Samples within the contact are lost.";
  if (!std::isfinite(p.deepest))
    return "The speed does not change its sign within the contact, so that it has no deepest "
           "point; check where the laser points, its sign and its delay.";
  return "";
}

void estimate_work(const Readings& readings, DirectRestitution& result) {
  result.kinetic =
      estimate_of(readings, [](const ContactPhases& x) { return x.impulse_out / x.impulse_in; });
  result.energetic = estimate_of(readings, ratio_of_work);
  result.energetic.ci95[0] = std::max(0.0, result.energetic.ci95[0]);
  result.hysteresis.dissipated =
      estimate_of(readings, [](const ContactPhases& x) { return x.work_in - x.work_out; });
  result.hysteresis.max_penetration =
      estimate_of(readings, [](const ContactPhases& x) { return x.depth; });
}

void add_notes(const Impact& impact, const RigFile& rig, const DirectReading& reading,
               std::vector<std::string>& notes) {
  const double point = rig.rig.contact.position;
  const auto& sensor = impact.velocity ? rig.velocity : rig.displacement;
  const double spot = sensor ? sensor->position : 0.0;
  if (spot > 0.0 && point > 0.0 && std::abs(spot - point) > spot_tolerance * point)
    notes.push_back(fmt::format(
        "The laser points {:.0f} mm from the struck point, so that direct restitution, dissipated "
        "energy and penetration are of that spot and not of the contact.",
        1e3 * std::abs(spot - point)));
  if (rig.rig.stop)
    notes.push_back(
        "The stop gives way: the force sensor does not show the contact force, nor the laser the "
        "speed of penetration.");
  if (!impact.velocity)
    notes.push_back("There is no velocity channel; the displacement was differentiated.");
  if (!reading.resolved())
    notes.push_back(
        "The sample rate is too low to take the whole force chain off; of its fastest part only "
        "the delay was, and the rest stands in the budget.");
}

}  // namespace

DirectRestitution direct_restitution(const Impact& impact, const RigFile& rig) {
  DirectRestitution result;
  if (const std::string why = why_nothing(impact, rig); !why.empty()) {
    all_absent(why, result);
    return result;
  }
  const DirectReading reading(impact, rig);
  const ContactPhases here = reading.phases({});
  if (!std::isfinite(here.touch) || !(here.approach > 0.0)) {
    all_absent("First touch, separation or the approach speed cannot be told from the noise.",
               result);
    return result;
  }
  const Readings readings = take_readings(reading);
  result.touch = here.touch;
  result.deepest = here.deepest;
  result.separation = here.separation;
  add_notes(impact, rig, reading, result.notes);
  estimate_speeds(reading, readings, result);
  if (const std::string why = why_no_work(impact, reading, here); !why.empty()) {
    for (DirectEstimate* estimate :
         {&result.kinetic, &result.energetic, &result.hysteresis.dissipated,
          &result.hysteresis.max_penetration})
      *estimate = absent(why);
    return result;
  }
  estimate_work(readings, result);
  fill_loop(reading, here, result.hysteresis);
  return result;
}

}  // namespace impactrig::fitting
