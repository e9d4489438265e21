// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include "models/contact/damping_law.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactSignal;

constexpr double unbounded = std::numeric_limits<double>::infinity();

// What a channel may be off, as parts of its largest value: more than that is no zero error but a
// model that does not fit. The force's baseline is off already; a vibrometer's zero is not seen
// before touch.
constexpr double force_offset_part = 0.02;
constexpr double velocity_offset_part = 0.1;
constexpr double drift_part = 0.02;  // over the record
// Mains hum is taken to be of this order, likewise a part of the largest value: a few milliseconds
// of record hardly tell its fundamental from offset and drift.
constexpr double hum_part = 0.01;

std::vector<std::string> default_free(const RigFile& rig) {
  std::vector<std::string> free;
  if (rig.rig.contact.damping != "none") free.emplace_back("contact.restitution");
  free.emplace_back("contact.stiffness_factor");
  free.emplace_back("start.velocity");
  return free;
}

Variable physics_variable(const PhysicalParameter& parameter, const RigFile& rig,
                          const std::vector<Impact>& impacts, int recording) {
  models::Rig copy = rig.rig;
  Variable v;
  v.physics = &parameter;
  v.recording = recording;
  v.name = parameter.name;
  v.unit = parameter.unit;
  v.initial = parameter.of(copy);
  if (parameter.name == "start.velocity" && recording >= 0) {
    const double seen = impacts[static_cast<std::size_t>(recording)].approach_velocity;
    if (seen > 0.0) v.initial = seen;
  }
  if (!(v.initial != 0.0 && std::isfinite(v.initial)))
    throw std::invalid_argument(
        fmt::format("'{}' cannot be fitted with this rig: it has no value to start from", v.name));
  v.lower = parameter.upper > 0.0 ? parameter.lower : 0.05 * v.initial;
  v.upper = parameter.upper > 0.0 ? parameter.upper : 20.0 * v.initial;
  if (parameter.name == "contact.restitution")
    v.lower = models::damping_law(rig.rig.contact.damping).text.smallest_restitution;
  if (parameter.name == "contact.position") v.upper = rig.rig.beam.length;
  v.initial = std::clamp(v.initial, v.lower, v.upper);
  v.scale = parameter.unit == "1" ? 1.0 : v.initial;
  return v;
}

/// Adds what the channel shows besides the motion: offset, drift, and mains hum with its third
/// harmonic, which a saturated transformer makes.
void add_background(const ImpactSignal& signal, const Variable& blank, double mains_frequency,
                    double largest, std::vector<Variable>& variables) {
  using Kind = BackgroundShape::Kind;
  const auto add = [&](std::string_view name, BackgroundShape shape) -> Variable& {
    Variable v = blank;
    v.role = Variable::Role::background;
    v.background = shape;
    v.name += name;
    v.scale = 1e-3 * largest;
    variables.push_back(v);
    return variables.back();
  };
  Variable& offset = add("offset", {Kind::constant});
  if (signal.quantity != datasets::Quantity::displacement) {
    const double part =
        signal.quantity == datasets::Quantity::force ? force_offset_part : velocity_offset_part;
    offset.lower = -part * largest;
    offset.upper = part * largest;
  }
  Variable& drift = add("drift", {Kind::line});
  drift.unit += "/s";
  drift.scale = 1.0 * largest;
  const double recorded = signal.interval * static_cast<double>(signal.values.size());
  drift.upper = drift_part * largest / recorded;
  drift.lower = -drift.upper;
  if (signal.quantity == datasets::Quantity::displacement) return;
  const double mains = 2.0 * std::numbers::pi * mains_frequency;
  for (const auto& [name, kind, order] : {std::tuple{"hum.sin", Kind::sine, 1.0},
                                          {"hum.cos", Kind::cosine, 1.0},
                                          {"hum.third_sin", Kind::sine, 3.0},
                                          {"hum.third_cos", Kind::cosine, 3.0}})
    add(name, {kind, order * mains}).prior = {0.0, hum_part * largest};
}

/// Background, gain and delay of one channel.
void add_channel_variables(const ImpactSignal& signal, int recording, double mains_frequency,
                           const std::vector<std::string>& asked,
                           std::vector<Variable>& variables) {
  const std::string key = fmt::format("sensors.{}.", datasets::name(signal.quantity));
  const auto wanted = [&](std::string_view what) {
    return std::ranges::find(asked, fmt::format("{}{}", key, what)) != asked.end();
  };
  double largest = 0.0;
  for (const double value : signal.values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  if (!(largest > 0.0)) largest = 1.0;
  Variable blank;
  blank.quantity = signal.quantity;
  blank.recording = recording;
  blank.name = key;
  blank.unit = std::string(datasets::si_unit(signal.quantity));
  blank.lower = -unbounded;
  blank.upper = unbounded;
  add_background(signal, blank, mains_frequency, largest, variables);
  if (signal.gain_uncertainty > 0.0 || wanted("gain")) {
    Variable gain = blank;
    gain.role = Variable::Role::gain;
    gain.name += "gain";
    gain.unit = "1";
    gain.initial = 1.0;
    gain.lower = 0.2;
    gain.upper = 5.0;
    gain.scale = 1e-2;
    if (signal.gain_uncertainty > 0.0) gain.prior = {1.0, signal.gain_uncertainty};
    variables.push_back(gain);
  }
  if (signal.delay_uncertainty > 0.0 || wanted("delay")) {
    Variable delay = blank;
    delay.role = Variable::Role::delay;
    delay.name += "delay";
    delay.unit = "s";
    delay.initial = signal.delay;
    delay.scale = 1e-6;
    if (signal.delay_uncertainty > 0.0) delay.prior = {signal.delay, signal.delay_uncertainty};
    variables.push_back(delay);
  }
}

void refuse_unknown(const std::vector<std::string>& asked) {
  for (const std::string& name : asked) {
    if (std::ranges::count(asked, name) > 1)
      throw std::invalid_argument(
          fmt::format("'{}' is named twice among the free parameters", name));
    if (name == "impact.time") continue;
    bool of_channel = false;
    for (const char* channel : {"force", "velocity", "displacement"})
      for (const char* what : {"offset", "drift", "gain", "delay"})
        of_channel = of_channel || name == fmt::format("sensors.{}.{}", channel, what);
    if (!of_channel) physical_parameter(name);
  }
}

}  // namespace

double BackgroundShape::at(double t) const {
  switch (kind) {
    case Kind::constant:
      return 1.0;
    case Kind::line:
      return t;
    case Kind::sine:
      return std::sin(angular_frequency * t);
    case Kind::cosine:
      return std::cos(angular_frequency * t);
  }
  return 0.0;
}

bool is_fitted(const Impact& impact, const std::optional<ImpactSignal>& signal,
               const FitOptions& options) {
  if (!signal || signal->values.empty()) return false;
  using enum datasets::Quantity;
  const bool wanted = signal->quantity == force ? options.use_force
                      : signal->quantity == velocity
                          ? options.use_velocity
                          : options.use_displacement || (!impact.force && !impact.velocity);
  const auto [least, most] = std::ranges::minmax(signal->values);
  return wanted && least != most;
}

std::vector<Variable> make_variables(const std::vector<Impact>& impacts, const RigFile& rig,
                                     const FitOptions& options) {
  const std::vector<std::string> asked = options.free.empty() ? default_free(rig) : options.free;
  refuse_unknown(asked);
  if (rig.rig.contact.damping == "none" &&
      std::ranges::find(asked, "contact.restitution") != asked.end())
    throw std::invalid_argument(
        "'contact.restitution' cannot be fitted: contact.damping is \"none\", which has no "
        "restitution");
  const int shots = static_cast<int>(impacts.size());
  std::vector<Variable> variables;
  for (const std::string& name : asked) {
    if (name.starts_with("sensors.") || name == "impact.time") continue;
    const PhysicalParameter& parameter = physical_parameter(name);
    if (parameter.of_shot)
      for (int shot = 0; shot < shots; ++shot)
        variables.push_back(physics_variable(parameter, rig, impacts, shot));
    else
      variables.push_back(physics_variable(parameter, rig, impacts, -1));
  }
  for (int shot = 0; shot < shots; ++shot) {
    const Impact& impact = impacts[static_cast<std::size_t>(shot)];
    Variable touch;
    touch.role = Variable::Role::touch;
    touch.recording = shot;
    touch.name = "impact.time";
    touch.unit = "s";
    touch.initial = impact.start;
    touch.lower = -unbounded;
    touch.upper = unbounded;
    touch.scale = 1e-6;
    variables.push_back(touch);
    for (const auto* signal : {&impact.force, &impact.velocity, &impact.displacement})
      if (is_fitted(impact, *signal, options))
        add_channel_variables(**signal, shot, rig.mains_frequency, asked, variables);
  }
  for (Variable& v : variables) {
    v.value = v.initial;
    if (shots > 1 && v.recording >= 0) v.name += fmt::format("[{}]", v.recording + 1);
  }
  return variables;
}

}  // namespace impactrig::fitting
