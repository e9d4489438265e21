// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include "fitting/wishes.hpp"
#include "models/contact/damping_law.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactSignal;

constexpr double unbounded = std::numeric_limits<double>::infinity();
// Of where it starts: zero has no logarithm.
constexpr double least_by_logarithm = 1e-6;

// What a channel is taken to be off, as parts of its largest value: standard deviations of normal
// priors, which keep what a few milliseconds hardly tell apart near zero. The force's baseline is
// off already; a vibrometer's zero is not seen before touch.
constexpr double force_offset_part = 0.02;
constexpr double velocity_offset_part = 0.1;
constexpr double drift_part = 0.02;  // over the record
constexpr double hum_part = 0.01;    // of mains hum and of its third harmonic

/// Dampers, springs and gaps: without them a rig is still one.
bool may_be_none(std::string_view name) {
  return name.starts_with("beam.damping.") || name.starts_with("hinge.") ||
         name == "stop.viscous" || name.ends_with(".gap");
}

Variable physics_variable(const PhysicalParameter& parameter, const RigFile& rig,
                          const std::vector<Impact>& impacts, int recording) {
  models::Rig copy = rig.rig;
  Variable v;
  v.physics = &parameter;
  v.recording = recording;
  v.name = parameter.name;
  v.unit = unit_in(copy, parameter);
  v.initial = parameter.of(copy);
  if (parameter.name == "start.velocity" && recording >= 0) {
    const double seen = impacts[static_cast<std::size_t>(recording)].approach_velocity;
    if (seen > 0.0) v.initial = seen;
  }
  v.lower = parameter.upper > 0.0         ? parameter.lower
            : may_be_none(parameter.name) ? 0.0
                                          : 0.05 * v.initial;
  v.upper = parameter.upper > 0.0 ? parameter.upper : 20.0 * v.initial;
  for (int stop = 0; stop < rig.rig.stops(); ++stop) {
    const models::Contact& contact = copy.contact_of(stop);
    if (&contact.restitution == &parameter.of(copy))
      v.lower = models::damping_law(contact.damping).text.smallest_restitution;
    if (&contact.position == &parameter.of(copy)) v.upper = rig.rig.beam.length;
  }
  return v;
}

/// Throws where the rig has not the stop that the parameter is of.
void require_stop(const PhysicalParameter& parameter, const models::Rig& rig) {
  models::Rig copy = rig;
  parameter.of(copy);
  if (copy.stop.has_value() == rig.stop.has_value() &&
      copy.further_stops.size() == rig.further_stops.size())
    return;
  throw std::invalid_argument(
      fmt::format("'{}' cannot be fitted with this rig: {}", parameter.name,
                  copy.stop.has_value() == rig.stop.has_value()
                      ? fmt::format("it has {} further stops", rig.further_stops.size())
                      : std::string("its stop is rigid; state stop.mass and stop.stiffness")));
}

/// Throws where a parameter of the damping is to be fitted that the force does not depend on.
void refuse_idle_damping(const models::Rig& rig, const FitOptions& options, const Wishes& wishes) {
  const auto is_free = [&](const std::string& name) {
    const ParameterSetting* const setting = options.setting_of(name);
    return wishes.asks_for(name) && !(setting && setting->fixed);
  };
  const auto refuse = [&](const std::string& name, const std::string& why) {
    throw std::invalid_argument(fmt::format("'{}' cannot be fitted: {}", name, why));
  };
  const std::string own(damping_parameter(rig.contact, options));
  for (const std::string_view one : damping_parameters) {
    const std::string name(one);
    if (name == own || !is_free(name)) continue;
    if (name != "contact.restitution")
      refuse(name, fmt::format("the damping law \"{}\" does not take it", rig.contact.damping));
    if (own.empty()) refuse(name, "contact.damping is \"none\", which has no restitution");
    refuse(name, fmt::format("the damping is that of {0}, which is stated or fitted, and no "
                             "restitution changes it; fit {0} instead",
                             own));
  }
  for (std::size_t i = 0; i < rig.further_stops.size(); ++i)
    if (const std::string name = fmt::format("contacts.{}.restitution", i + 1);
        is_free(name) && !rig.further_stops[i].contact.takes_restitution())
      refuse(name, "the damping of this stop takes none");
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
    offset.prior = {0.0, part * largest};
  }
  Variable& drift = add("drift", {Kind::line});
  drift.unit += "/s";
  drift.scale = 1.0 * largest;
  const double recorded = signal.interval * static_cast<double>(signal.values.size());
  drift.prior = {0.0, drift_part * largest / recorded};
  if (signal.quantity == datasets::Quantity::displacement) return;
  const double mains = 2.0 * std::numbers::pi * mains_frequency;
  for (const auto& [name, kind, order] : {std::tuple{"hum.sin", Kind::sine, 1.0},
                                          {"hum.cos", Kind::cosine, 1.0},
                                          {"hum.third_sin", Kind::sine, 3.0},
                                          {"hum.third_cos", Kind::cosine, 3.0}})
    add(name, {kind, order * mains}).prior = {0.0, hum_part * largest};
}

double largest_of(const ImpactSignal& signal) {
  double largest = 0.0;
  for (const double value : signal.values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest > 0.0 ? largest : 1.0;
}

/// Background, gain, delay and chain of one channel.
void add_channel_variables(const ImpactSignal& signal, int recording, const RigFile& rig,
                           const Wishes& wishes, std::vector<Variable>& variables) {
  const std::string key = fmt::format("sensors.{}.", datasets::name(signal.quantity));
  Variable blank;
  blank.quantity = signal.quantity;
  blank.recording = recording;
  blank.name = key;
  blank.unit = std::string(datasets::si_unit(signal.quantity));
  blank.lower = -unbounded;
  blank.upper = unbounded;
  add_background(signal, blank, rig.mains_frequency, largest_of(signal), variables);
  if (signal.gain_uncertainty > 0.0 || wishes.asks_for(key + "gain", recording)) {
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
  if (signal.delay_uncertainty > 0.0 || wishes.asks_for(key + "delay", recording)) {
    Variable delay = blank;
    delay.role = Variable::Role::delay;
    delay.name += "delay";
    delay.unit = "s";
    delay.initial = signal.delay;
    delay.scale = 1e-6;
    if (signal.delay_uncertainty > 0.0) delay.prior = {signal.delay, signal.delay_uncertainty};
    variables.push_back(delay);
  }
  for (const std::string& name : wishes.names()) {
    const auto wanted = sensor_key(name);
    if (!wanted || wanted->quantity != signal.quantity || !wishes.asks_for(name, recording))
      continue;
    const ChainParameter* chain = find_chain_parameter(wanted->what);
    if (!chain) continue;
    auto sensor = sensor_of(rig, signal.quantity);
    Variable v = blank;
    v.role = Variable::Role::chain;
    v.chain = chain;
    v.name = name;
    v.unit = chain->unit;
    v.initial = sensor ? chain->of(*sensor) : 0.0;
    if (chain->name == "position" && v.initial == 0.0) v.initial = rig.rig.contact.position;
    v.lower = 0.05 * v.initial;
    v.upper = chain->name == "position" ? rig.rig.beam.length : 20.0 * v.initial;
    variables.push_back(v);
  }
}

/// Physics shared by the recordings, or of each.
void add_physics(const std::vector<Impact>& impacts, const RigFile& rig, const Wishes& wishes,
                 std::vector<Variable>& variables) {
  for (const std::string& name : wishes.names()) {
    const PhysicalParameter* parameter = find_physical_parameter(name);
    if (!parameter) continue;
    require_stop(*parameter, rig.rig);
    if (wishes.shares(name, !parameter->of_shot)) {
      variables.push_back(physics_variable(*parameter, rig, impacts, -1));
      continue;
    }
    for (int shot = 0; shot < static_cast<int>(impacts.size()); ++shot)
      if (wishes.asks_for(name, shot))
        variables.push_back(physics_variable(*parameter, rig, impacts, shot));
  }
}

/// A groove is wider than the bar: where one of the two radii is fitted, the other one bounds it.
void keep_in_groove(const models::Contact& contact, const Wishes& wishes,
                    std::vector<Variable>& variables) {
  constexpr double play = 1e-6;  // of the radius
  const bool both =
      wishes.asks_for("contact.radius") && wishes.asks_for("contact.counterface.radius");
  if (contact.counterface != models::Counterface::groove || both) return;
  for (Variable& v : variables) {
    if (v.name == "contact.counterface.radius") v.lower = (1.0 + play) * contact.radius;
    if (v.name == "contact.radius") v.upper = (1.0 - play) * contact.counter_radius;
  }
}

Variable first_touch(const Impact& impact, int shot) {
  Variable touch;
  touch.role = Variable::Role::touch;
  touch.recording = shot;
  touch.name = "impact.time";
  touch.unit = "s";
  touch.initial = impact.start;
  touch.lower = -unbounded;
  touch.upper = unbounded;
  touch.scale = 1e-6;
  return touch;
}

/// One of the measuring chain for all recordings, the first one: of a sensor's calibration, which
/// is not drawn anew for each shot, unless that is wished otherwise or one recording's own is
/// named; of a background where it is wished.
void share(const Wishes& wishes, std::vector<Variable>& variables) {
  std::vector<Variable> kept;
  for (Variable& v : variables) {
    const bool calibration = v.is_of_sensor();
    if (v.role != Variable::Role::physics && v.role != Variable::Role::touch && v.recording >= 0 &&
        wishes.shares(v.name, calibration && !wishes.names_one_of(v.name))) {
      if (std::ranges::find(kept, v.name, &Variable::name) != kept.end()) continue;
      v.recording = -1;
    }
    kept.push_back(v);
  }
  variables = std::move(kept);
}

/// What the user states of a variable, and a scale that goes with it.
void set_up(const std::optional<ParameterSetting>& setting, Variable& v) {
  const double by_itself = v.initial;
  if (setting) {
    if (setting->initial) v.initial = *setting->initial;
    if (setting->prior) v.prior = setting->prior;
    if (setting->lower) v.lower = *setting->lower;
    if (setting->upper) v.upper = *setting->upper;
  }
  const bool from_rig = v.role == Variable::Role::physics || v.role == Variable::Role::chain;
  if (from_rig && v.initial == 0.0 && v.prior && (*v.prior)[0] > 0.0) v.initial = (*v.prior)[0];
  if (from_rig && !(v.initial != 0.0 && std::isfinite(v.initial)))
    throw std::invalid_argument(
        fmt::format("'{}' cannot be fitted with this rig: it has no value to start from{}", v.name,
                    v.physics ? fmt::format("; state fit.{}.initial", v.physics->name) : ""));
  if (from_rig && v.initial < 0.0)
    throw std::invalid_argument(
        fmt::format("'{}' cannot begin at {:g}: it may not be below zero", v.name, v.initial));
  if (from_rig && by_itself == 0.0 && !setting->lower) v.lower = 0.0;
  if (from_rig && by_itself == 0.0 && !setting->upper) v.upper = 100.0 * v.initial;
  if (!(v.lower < v.upper))
    throw std::invalid_argument(
        fmt::format("'{}' has no room between its bounds {:g} and {:g}", v.name, v.lower, v.upper));
  if (setting && setting->initial && !(v.initial >= v.lower && v.initial <= v.upper))
    throw std::invalid_argument(
        fmt::format("'{}' cannot begin at {:g}, outside its bounds {:g} and {:g}", v.name,
                    v.initial, v.lower, v.upper));
  v.initial = std::clamp(v.initial, v.lower, v.upper);
  if (from_rig) v.scale = v.unit == "1" && v.initial < 5.0 ? 1.0 : v.initial;
  v.value = v.initial;
  v.by_logarithm = setting && setting->by_logarithm;
  if (v.by_logarithm && !(v.initial > 0.0 && v.lower >= 0.0))
    throw std::invalid_argument(fmt::format(
        "'{}' cannot be fitted by its logarithm: it, or its lower bound, may not be below zero",
        v.name));
  if (v.by_logarithm) v.lower = std::max(v.lower, least_by_logarithm * v.initial);
}

/// A tied number has no place of its own for anything else that is stated.
void refuse_idle_settings(const ParameterSetting& setting) {
  const std::string& to = setting.tie->to;
  if (setting.name == to) throw std::invalid_argument(fmt::format("'{}' is tied to itself", to));
  const char* idle = setting.prior                    ? "prior"
                     : setting.lower || setting.upper ? "bounds"
                     : setting.initial                ? "initial value"
                     : setting.by_logarithm           ? "scale"
                                                      : nullptr;
  if (idle)
    throw std::invalid_argument(
        fmt::format("'{}' is tied to '{}', so that its {} would not be used; state it of '{}'",
                    setting.name, to, idle, to));
}

/// Whether a name is that of a variable: of its recording, or else of the one that is looked from.
bool is_named(const Variable& v, const std::string& name, int from) {
  if (v.name == name) return true;
  const ParameterKey wanted = parameter_key(name);
  const int recording = wanted.recording > 0 ? wanted.recording - 1 : from;
  return v.recording >= 0 && v.recording == recording && parameter_key(v.name).key == wanted.key;
}

/// Finds what a tie names: of the recording it names, else in the same recording, or shared.
void tie_up(const Wishes& wishes, std::vector<Variable>& variables) {
  for (Variable& v : variables) {
    const std::optional<ParameterSetting> setting = wishes.of(v);
    if (!setting || !setting->tie) continue;
    refuse_idle_settings(*setting);
    const Tie& tie = *setting->tie;
    for (std::size_t i = 0; i < variables.size(); ++i)
      if (is_named(variables[i], tie.to, v.recording)) v.tie = {i, tie.factor, tie.offset};
    if (!v.tie)
      throw std::invalid_argument(fmt::format(
          "'{}' is tied to '{}', which is not among the free parameters", v.name, tie.to));
    if (&variables[v.tie->to] == &v) {
      if (parameter_key(setting->name).recording > 0)
        throw std::invalid_argument(fmt::format("'{}' is tied to itself", v.name));
      v.tie.reset();  // the one of all recordings' own that the others go with
      continue;
    }
    v.prior.reset();
  }
  for (Variable& v : variables) {
    if (!v.tie) continue;
    const Variable& other = variables[v.tie->to];
    if (other.tie)
      throw std::invalid_argument(
          fmt::format("'{}' is tied to '{}', which is tied itself; tie both to the same one",
                      v.name, other.name));
    v.initial = v.value = v.tie->factor * other.value + v.tie->offset;
  }
}

/// What a further stop has from [contact] goes with that in a fit, unless something else is stated
/// of it.
FitOptions with_inherited(const RigFile& rig, const FitOptions& options, int recordings) {
  const Wishes wishes(rig, options);
  FitOptions all = options;
  for (const std::string& name : rig.inherited) {
    const std::string of_first = "contact." + name.substr(std::string_view("contacts.1.").size());
    if (wishes.asks_for(name) || wishes.names_one_of(name) || options.setting_of(name)) continue;
    const ParameterSetting* first = options.setting_of(of_first);
    if (first && first->fixed) continue;
    const Tie same = first && first->tie ? *first->tie : Tie{.to = of_first};
    const auto tie = [&](const std::string& one) { all.setting(one).tie = same; };
    bool each = true;
    for (int k = 0; k < recordings; ++k) each = each && wishes.asks_for(of_first, k);
    if (each && wishes.asks_for(of_first)) {
      tie(name);
      if (!wishes.shares(of_first, true)) all.setting(name).shared = false;
      continue;
    }
    for (int k = 0; k < recordings; ++k)
      if (wishes.asks_for(of_first, k)) tie(fmt::format("{}[{}]", name, k + 1));
  }
  return all;
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
  const int shots = static_cast<int>(impacts.size());
  const FitOptions all = with_inherited(rig, options, shots);
  const Wishes wishes(rig, all);
  refuse_idle_damping(rig.rig, options, wishes);
  std::vector<Variable> variables;
  add_physics(impacts, rig, wishes, variables);
  keep_in_groove(rig.rig.contact, wishes, variables);
  for (int shot = 0; shot < shots; ++shot) {
    const Impact& impact = impacts[static_cast<std::size_t>(shot)];
    variables.push_back(first_touch(impact, shot));
    for (const auto* signal : {&impact.force, &impact.velocity, &impact.displacement})
      if (is_fitted(impact, *signal, options))
        add_channel_variables(**signal, shot, rig, wishes, variables);
  }
  share(wishes, variables);
  wishes.refuse_strangers(variables, shots);
  std::erase_if(variables, [&](const Variable& v) { return wishes.fixes(v); });
  for (Variable& v : variables) {
    if (shots > 1 && v.recording >= 0) v.name += fmt::format("[{}]", v.recording + 1);
    set_up(wishes.of(v), v);
  }
  tie_up(wishes, variables);
  return variables;
}

}  // namespace impactrig::fitting
