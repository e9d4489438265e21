// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "datasets/number_text.hpp"
#include "models/simulation.hpp"

namespace impactrig::fitting {

using datasets::Impact;
using datasets::ImpactSignal;

namespace {

constexpr double any_restitution = 2.5;   ///< beyond it no restitution explains a ratio
constexpr double any_speed = 10.0;        ///< where the approach speed is the rig file's only
constexpr double any_other_speed = 30.0;  ///< than the rig file's, of a shot that fits itself
constexpr double alike = 1.8;             ///< between a ratio and a known factor: e is open

struct KnownFactor {
  double factor;
  std::string_view force, velocity;
};

constexpr std::array<KnownFactor, 5> known_factors{{
    {1e6, "mN for kN", "um/s for m/s"},
    {1e3, "N for kN, or mV for V", "mm/s for m/s"},
    {100.0, "a gain or range of 100", "cm/s for m/s"},
    {10.0, "kgf (9.81 N), or a gain or range of 10", "a decoder range of 10"},
    {4.448, "lbf (4.448 N)", "a decoder range of 4 or 5"},
}};

/// Times that were taken for others.
struct TimeFactor {
  double factor;
  std::string_view what;
};

constexpr std::array<TimeFactor, 4> time_factors{{{1e3, "ms taken for s"},
                                                  {1e6, "us taken for s"},
                                                  {1e-3, "s taken for ms"},
                                                  {1e-6, "s taken for us"}}};
constexpr double alike_contact = 4.0;  ///< between contacts of a rigid and of a flexible bar

bool within(double ratio, double limit) {
  return ratio > 1.0 / limit && ratio < limit;
}

/// "1000 times too large".
std::string times_off(double ratio) {
  const double factor = ratio > 1.0 ? ratio : 1.0 / ratio;
  return fmt::format("{} times too {}",
                     factor >= 100.0 ? fmt::format("{:.0f}", factor) : datasets::figures(factor, 2),
                     ratio > 1.0 ? "large" : "small");
}

/// The same "(nearly the factor of N for kN, or mV for V)".
std::string off_by(double ratio, bool force) {
  const double factor = ratio > 1.0 ? ratio : 1.0 / ratio;
  std::string text = times_off(ratio);
  const auto distance = [&](const KnownFactor& known) {
    return std::abs(std::log(factor / known.factor));
  };
  const auto* const known = std::ranges::min_element(known_factors, {}, distance);
  if (distance(*known) < std::log(alike))
    text += fmt::format(" (nearly the factor of {})", force ? known->force : known->velocity);
  return text;
}

/// Of the force over the first contact, as a sum of rectangles [N s].
double impulse_of(const ImpactSignal& force, double from, double to) {
  double sum = 0.0;
  for (std::size_t i = 0; i < force.values.size(); ++i) {
    const double t = force.time(i);
    if (t >= from && t <= to) sum += force.values[i] * force.interval;
  }
  return sum;
}

/// Of the struck point: the bar turns about its hinge as a whole before touch. None where the
/// velocity does not go down to 0 Hz, or shows nothing beyond its noise.
std::optional<double> measured_speed(const Impact& impact, const RigFile& file) {
  if (!impact.velocity || !(impact.approach_velocity > 3.0 * impact.velocity->noise))
    return std::nullopt;
  if (!file.velocity) return impact.approach_velocity;
  if (file.velocity->low_cut) return std::nullopt;
  const double spot = file.velocity->position;
  return spot > 0.0 ? impact.approach_velocity * file.rig.contact.position / spot
                    : impact.approach_velocity;
}

/// A velocity that shows nothing where the bar has to have come with `expected` [m/s] at the struck
/// point; "" where it shows something, or may not have to.
std::string silent_velocity(const Impact& impact, const RigFile& file, double expected) {
  constexpr double far_above_noise = 20.0;
  if (!impact.velocity || (file.velocity && file.velocity->low_cut)) return {};
  const double spot = file.velocity ? file.velocity->position : 0.0;
  const double there = spot > 0.0 ? expected * spot / file.rig.contact.position : expected;
  const double noise = impact.velocity->noise;
  if (!(there > far_above_noise * noise) || std::abs(impact.approach_velocity) > 3.0 * noise)
    return {};
  return fmt::format(
      "The velocity shows nothing before touch (noise of {:.2g} m/s), where the force's impulse "
      "needs a bar that arrives with {:.2g} m/s: the laser had no signal, the channel is another, "
      "or its decoder does not go down to 0 Hz (sensors.velocity.low_cut states that).",
      noise, there);
}

/// Over the time that the measured contact took.
std::optional<models::Simulation> predicted(const RigFile& file, double contact) {
  models::Rig rig = file.rig;
  models::Solver solver = file.solver;
  if (solver.model != models::BeamModel::rigid) solver.model = models::BeamModel::hybrid;
  solver.modes = 7;
  solver.axial_modes = 0;
  solver.accuracy = 1e-3;
  solver.duration = 1.5 * contact;
  solver.time_limit = 2.0;
  try {
    return models::simulate(rig, solver);
  } catch (const std::invalid_argument&) {
  } catch (const std::runtime_error&) {
  }
  return std::nullopt;  // the fit will say what is wrong
}

/// Until the contact of a rigid bar has ended.
std::optional<models::Simulation> rigid_contact(const RigFile& file) {
  models::Solver solver;
  solver.model = models::BeamModel::rigid;
  solver.accuracy = 1e-3;
  solver.time_limit = 2.0;
  try {
    models::Simulation run = models::simulate(file.rig, solver);
    if (!run.episodes.empty() && !run.episodes.front().open) return run;
  } catch (const std::invalid_argument&) {
  } catch (const std::runtime_error&) {
  }
  return std::nullopt;
}

/// The signal may end within a contact that lasts far too long.
double measured_impulse(const Impact& impact) {
  const ImpactSignal& force = *impact.force;
  const bool whole =
      !force.values.empty() && force.time(force.values.size() - 1) + force.interval >= impact.end;
  return whole || force.channel != impact.trigger ? impulse_of(force, impact.start, impact.end)
                                                  : impact.impulse;
}

/// Where the times are in another unit: contact and impulse are off by its factor alike.
std::optional<MomentumBalance> other_times(const Impact& impact, const RigFile& file,
                                           double measured, double speed) {
  const auto rigid = rigid_contact(file);
  if (!rigid) return std::nullopt;
  const models::Episode& contact = rigid->episodes.front();
  const double lasts = impact.end - impact.start, usual = contact.end - contact.start;
  MomentumBalance balance;
  balance.measured = measured;
  balance.expected = contact.impulse * speed / contact.approach_velocity;
  balance.ratio = balance.measured / balance.expected;
  for (const auto& [factor, what] : time_factors) {
    if (!within(lasts / usual / factor, alike_contact)) continue;
    if (!within(balance.ratio / factor, any_restitution)) continue;
    const bool longer = factor > 1.0;
    balance.plausible = false;
    balance.times = true;
    balance.sentence = fmt::format(
        "The contact lasts {:.2g} s where this rig takes about {:.2g} s, and the force's impulse, "
        "{:.3g} N s, is too {} by the same factor: the times seem to be {:.0f} times too {} ({}).",
        lasts, usual, measured, longer ? "large" : "small", longer ? factor : 1.0 / factor,
        longer ? "long" : "short", what);
    return balance;
  }
  return std::nullopt;
}

/// What of the two records is off by itself, where the rig states its approach speed.
std::string culprit(double impulse_ratio, double speed_ratio) {
  const bool force = !within(impulse_ratio, any_restitution);
  const bool velocity = !within(speed_ratio, any_restitution);
  std::string text;
  if (force)
    text += fmt::format(" Against the approach speed that the rig file states the force is {}.",
                        off_by(impulse_ratio, true));
  if (velocity)
    text += fmt::format(" The measured approach speed is {} against the rig file's.",
                        off_by(speed_ratio, false));
  return text;
}

}  // namespace

std::optional<MomentumBalance> momentum_balance(const Impact& impact, const RigFile& file) {
  if (!impact.force || !file.rig.has_stop()) return std::nullopt;
  const double contact = impact.end - impact.start;
  if (!(contact > 0.0)) return std::nullopt;
  const double impulse_measured = measured_impulse(impact);
  const auto measured = measured_speed(impact, file);
  if (auto times = other_times(impact, file, impulse_measured,
                               measured.value_or(models::touch_velocity(file.rig))))
    return times;
  const auto simulation = predicted(file, contact);
  if (!simulation || simulation->episodes.empty()) return std::nullopt;
  const double speed = simulation->episodes.front().approach_velocity;
  const double impulse = simulation->impulse;
  if (!(speed > 0.0) || !(impulse > 0.0)) return std::nullopt;

  const double speed_ratio = measured ? *measured / speed : 1.0;
  MomentumBalance balance;
  balance.measured = impulse_measured;
  balance.expected = impulse * speed_ratio;
  balance.ratio = balance.measured / balance.expected;
  if (!(balance.ratio > 0.0)) return std::nullopt;  // another flag: polarity
  balance.plausible = within(balance.ratio, measured ? any_restitution : any_speed);
  if (balance.plausible && !measured) {
    balance.sentence = silent_velocity(impact, file, speed * balance.ratio);
    balance.plausible = balance.sentence.empty();
    return balance;
  }
  if (balance.plausible && !within(speed_ratio, any_other_speed)) {
    balance.plausible = false;
    balance.sentence = fmt::format(
        "Force and velocity fit each other, but the measured approach speed, {:.3g} m/s, is {} "
        "against the {:.3g} m/s that the rig file states.",
        speed * speed_ratio, off_by(speed_ratio, false), speed);
  }
  if (balance.plausible || !balance.sentence.empty()) return balance;
  // of two records that do not fit, the one that fits the rig is in no other unit
  const bool velocity_alone = measured && within(impulse_measured / impulse, any_restitution) &&
                              !within(speed_ratio, any_restitution);
  balance.sentence = fmt::format(
      "The force's impulse, {} N s, is {} for a bar of this rig that arrives with {:.3g} m/s "
      "({}): {} N s are expected.",
      datasets::figures(balance.measured, 3),
      velocity_alone ? times_off(balance.ratio) : off_by(balance.ratio, true), speed * speed_ratio,
      measured ? "as measured" : "as the rig file says", datasets::figures(balance.expected, 3));
  if (measured) balance.sentence += culprit(balance.measured / impulse, speed_ratio);
  return balance;
}

}  // namespace impactrig::fitting
