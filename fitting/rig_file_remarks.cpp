// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/rig_file_remarks.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace impactrig::fitting {
namespace {

bool states(const toml::table& table, std::string_view key) {
  return static_cast<bool>(table.at_path(key));
}

/// Why a contact's damping does not follow from a restitution; empty where it does.
std::string damped_otherwise(const models::Contact& contact) {
  if (contact.takes_restitution()) return {};
  if (contact.viscous) return "its damping is that of `viscous`";
  if (contact.relaxation_time) return "its damping is that of `relaxation_time`";
  return "its damping is \"none\"";
}

/// `name`: "contact", "contacts.1". Of a further stop, what its own table states.
void remark_on_contact(const toml::table& table, const std::string& name,
                       const models::Contact& contact, std::vector<std::string>& remarks) {
  if (const std::string why = damped_otherwise(contact); !why.empty())
    for (const char* key : {"restitution", "restitution_speed", "effective_mass"})
      if (states(table, key))
        remarks.push_back(fmt::format("{}.{} has no effect: {}", name, key, why));
  if (states(table, "exponent") && contact.law != "goldsmith")
    remarks.push_back(
        fmt::format("{}.exponent has no effect: the law \"{}\" has none", name, contact.law));
}

}  // namespace

std::vector<std::string> remarks_on(const toml::table& document, const RigFile& file) {
  std::vector<std::string> remarks;
  if (const toml::table* contact = document["contact"].as_table())
    remark_on_contact(*contact, "contact", file.rig.contact, remarks);
  if (const toml::array* further = document["contacts"].as_array())
    for (std::size_t i = 0; i < std::min(further->size(), file.rig.further_stops.size()); ++i)
      if (const toml::table* contact = further->get(i)->as_table())
        remark_on_contact(*contact, fmt::format("contacts.{}", i + 1),
                          file.rig.further_stops[i].contact, remarks);
  if (states(document, "environment.gravity_direction") && file.rig.gravity == 0.0)
    remarks.emplace_back(
        "environment.gravity_direction has no effect: there is no environment.gravity");
  if (file.rig.stop && file.force && file.force->resonance)
    remarks.emplace_back(
        "sensors.force.resonance counts besides [stop], whose mass and stiffness ring too: where "
        "both are the sensor's, leave one of them out");
  return remarks;
}

}  // namespace impactrig::fitting
