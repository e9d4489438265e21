// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/other_model.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "datasets/input_error.hpp"
#include "fitting/mesh_choice.hpp"
#include "fitting/toml_reader.hpp"
#include "fitting/wishes.hpp"
#include "models/contact/damping_law.hpp"
#include "models/contact/elastic_law.hpp"

namespace impactrig::fitting {
namespace {

constexpr const char* begins_at = "0.5";  // a restitution of which nothing is known

/// What the rig file states, with what was set over it, and what the candidate changes of that.
class Keys {
 public:
  Keys(const RigFile& own, const std::vector<Override>& changes)
      : stated_(toml::parse(own.text)),
        changes_(changes) {}

  bool stated(const std::string& key) const { return bool(stated_.at_path(key)); }

  /// As a text, with or without quotes; none where it is not changed.
  std::optional<std::string> changed(std::string_view key) const {
    std::optional<std::string> value;
    for (const auto& [name, text] : changes_)
      if (name == key) value = text;
    if (value && value->size() > 1 && value->front() == '"' && value->back() == '"')
      value = value->substr(1, value->size() - 2);
    return value;
  }

 private:
  toml::table stated_;
  const std::vector<Override>& changes_;
};

/// Keys of the old laws that the new ones do not take.
std::vector<std::string> left_over(const Keys& keys) {
  std::vector<std::string> without;
  const auto drop = [&](const std::string& key) {
    if (keys.stated(key) && !keys.changed(key)) without.push_back(key);
  };
  if (const auto damping = keys.changed("contact.damping")) {
    models::damping_law(*damping);
    if (*damping != "viscous") drop("contact.viscous");
    if (*damping != "kuwabara-kono") drop("contact.relaxation_time");
  }
  if (const auto law = keys.changed("contact.law"))
    if (!models::elastic_law_entry(*law).text.needs.stiffness) drop("contact.stiffness");
  return without;
}

bool fits_damping(const FitOptions& options) {
  const ParameterSetting* const e = options.setting_of("contact.restitution");
  if (e && e->fixed) return false;
  return options.free.empty() || std::ranges::any_of(options.free, [](const std::string& name) {
           return std::ranges::find(damping_parameters, name) != damping_parameters.end();
         });
}

/// Whether the new damping law is made of a restitution that neither the file nor the change has.
bool lacks_restitution(const Keys& keys, const std::vector<std::string>& without) {
  const auto damping = keys.changed("contact.damping");
  if (!damping || *damping == "none") return false;
  return std::ranges::none_of(damping_parameters, [&](std::string_view parameter) {
    const std::string key(parameter);
    return keys.changed(key) ||
           (keys.stated(key) && std::ranges::find(without, key) == without.end());
  });
}

void refuse_what_is_no_model(const std::vector<Override>& changes) {
  for (const auto& [key, value] : changes)
    for (const std::string_view table : {"fit", "title", "schema", "conditioning"})
      if (key == table || key.starts_with(fmt::format("{}.", table)))
        throw std::invalid_argument(fmt::format(
            "{} is no part of a model; all models are fitted in the same way to the same samples",
            key));
}

}  // namespace

Candidate other_model(const RigFile& own, const std::vector<Override>& overrides,
                      const std::string& label, const std::vector<Override>& changes,
                      const FitOptions& options) {
  refuse_what_is_no_model(changes);
  Candidate candidate{.label = label, .rig = {}};
  const Keys keys(own, changes);
  std::vector<Override> all = overrides;
  all.insert(all.end(), changes.begin(), changes.end());
  const std::vector<std::string> without = left_over(keys);
  for (const std::string& key : without)
    candidate.note += fmt::format("{}without {}, of the law it replaces",
                                  candidate.note.empty() ? "" : "; ", key);
  if (lacks_restitution(keys, without) && fits_damping(options)) {
    all.emplace_back("contact.restitution", begins_at);
    candidate.note += fmt::format("{}contact.restitution begins at {}",
                                  candidate.note.empty() ? "" : "; ", begins_at);
  }
  try {
    candidate.rig = read_rig_file(own.path, all, without);
    choose_mesh(candidate.rig, finest_mesh_of_fits);
  } catch (const UnknownName& error) {
    throw std::invalid_argument(error.problem());
  } catch (const datasets::InputError& error) {
    candidate.failure = error.problem();
  }
  return candidate;
}

}  // namespace impactrig::fitting
