// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/wishes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace impactrig::fitting {
namespace {

std::vector<std::string> default_free(const RigFile& rig, const FitOptions& options) {
  std::vector<std::string> free;
  if (const std::string_view damping = damping_parameter(rig.rig.contact, options);
      !damping.empty())
    free.emplace_back(damping);
  free.emplace_back("contact.stiffness_factor");
  free.emplace_back("start.velocity");
  return free;
}

/// Goes over what is there already.
void add(const ParameterSetting& more, ParameterSetting& setting) {
  setting.name = more.name;
  if (more.initial) setting.initial = more.initial;
  if (more.lower) setting.lower = more.lower;
  if (more.upper) setting.upper = more.upper;
  if (more.prior) setting.prior = more.prior;
  if (more.shared) setting.shared = more.shared;
  if (more.tie) setting.tie = more.tie;
  setting.fixed = setting.fixed || more.fixed;
  setting.by_logarithm = setting.by_logarithm || more.by_logarithm;
}

/// Names of what each recording has of its own.
std::string own_of(const std::vector<Variable>& variables) {
  std::vector<std::string> keys;
  std::string text;
  for (const Variable& v : variables) {
    const std::string key = parameter_key(v.name).key;
    if (v.recording < 0 || std::ranges::find(keys, key) != keys.end()) continue;
    keys.push_back(key);
    text += fmt::format("{}{}", text.empty() ? "" : ", ", key);
  }
  return text;
}

}  // namespace

std::string_view damping_parameter(const models::Contact& contact, const FitOptions& options) {
  const auto asked = [&](std::string_view name) {
    const auto is = [&](const std::string& other) { return parameter_key(other).key == name; };
    return std::ranges::any_of(options.free, is) ||
           std::ranges::any_of(options.settings, [&](const ParameterSetting& setting) {
             return !setting.fixed && is(setting.name);
           });
  };
  if (contact.damping == "none") return "";
  if (contact.damping == "viscous" && (contact.viscous || asked("contact.viscous")))
    return "contact.viscous";
  if (contact.damping == "kuwabara-kono" &&
      (contact.relaxation_time || asked("contact.relaxation_time")))
    return "contact.relaxation_time";
  return "contact.restitution";
}

Wishes::Wishes(const RigFile& rig, const FitOptions& options) : options_(options) {
  const std::vector<std::string> free =
      options.free.empty() ? default_free(rig, options) : options.free;
  for (const std::string& name : free) {
    if (std::ranges::count(free, name) > 1)
      throw std::invalid_argument(
          fmt::format("'{}' is named twice among the free parameters", name));
    asked_.push_back(parameter_key(name));
    unit_of(name);
  }
  for (const ParameterSetting& setting : options.settings) {
    unit_of(setting.name);
    if (!setting.fixed) asked_.push_back(parameter_key(setting.name));
  }
  for (const ParameterKey& key : asked_)
    if (std::ranges::find(names_, key.key) == names_.end()) names_.push_back(key.key);
}

bool Wishes::asks_for(std::string_view name, int recording) const {
  return std::ranges::any_of(asked_, [&](const ParameterKey& key) {
    return key.key == name &&
           (recording == all_recordings || key.recording == 0 || key.recording == recording + 1);
  });
}

bool Wishes::fixes(const Variable& v) const {
  const std::optional<ParameterSetting> setting = of(v);
  return setting && setting->fixed;
}

bool Wishes::shares(std::string_view name, bool by_itself) const {
  const ParameterSetting* setting = options_.setting_of(name);
  return setting && setting->shared ? *setting->shared : by_itself;
}

std::optional<ParameterSetting> Wishes::of(const Variable& v) const {
  const std::string key = parameter_key(v.name).key;
  std::optional<ParameterSetting> stated;
  if (const ParameterSetting* of_all = options_.setting_of(key)) stated = *of_all;
  if (v.recording < 0) return stated;
  if (const ParameterSetting* own =
          options_.setting_of(fmt::format("{}[{}]", key, v.recording + 1))) {
    if (!stated) stated.emplace();
    add(*own, *stated);
  }
  return stated;
}

bool Wishes::names_one_of(std::string_view name) const {
  return std::ranges::any_of(numbered_names(), [&](const std::string& numbered) {
    return parameter_key(numbered).key == name;
  });
}

std::vector<std::string> Wishes::numbered_names() const {
  std::vector<std::string> names = options_.free;
  for (const ParameterSetting& setting : options_.settings) {
    names.push_back(setting.name);
    if (setting.tie) names.push_back(setting.tie->to);
  }
  std::erase_if(names, [](const std::string& name) { return parameter_key(name).recording == 0; });
  return names;
}

void Wishes::refuse_strangers(const std::vector<Variable>& variables, int recordings) const {
  for (const std::string& name : numbered_names()) {
    const auto [key, recording] = parameter_key(name);
    const std::string own = "each recording's own are " + own_of(variables);
    if (recording > recordings)
      throw std::invalid_argument(fmt::format(
          "there is no '{}': there {}; {}", name,
          recordings == 1 ? "is one recording" : fmt::format("are {} recordings", recordings),
          own));
    if (std::ranges::any_of(variables, [&](const Variable& v) {
          return v.recording < 0 && parameter_key(v.name).key == key;
        }))
      throw std::invalid_argument(fmt::format(
          "there is no '{}': {} is shared by all recordings, unless --own {} (fit.{}.shared = "
          "false) gives each its own; {}",
          name, key, key, key, own));
  }
}

}  // namespace impactrig::fitting
