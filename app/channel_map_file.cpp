// SPDX-License-Identifier: BSD-3-Clause
#include "app/channel_map_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <set>

#include "app/files.hpp"
#include "datasets/input_error.hpp"
#include "fitting/conditioning_keys.hpp"
#include "fitting/sensor_keys.hpp"
#include "fitting/toml_reader.hpp"

namespace impactrig::app {

namespace {

using acquisition::ChannelMapping;
using fitting::TableReader;

void read_which(TableReader& table, ChannelMapping& mapping) {
  mapping.match = table.text("match").value_or("");
  if (const auto index = table.integer("index")) {
    if (!mapping.match.empty()) table.refuse("index", "stands beside match: one of them is enough");
    if (*index < 0) table.refuse("index", fmt::format("counts from 0, found {}", *index));
    mapping.index = static_cast<std::size_t>(*index);
  } else if (mapping.match.empty()) {
    mapping.match = table.required_text("match", "Force*");
  }
}

/// full_scale = "10 V": a number and the unit that the file's numbers then have.
void read_full_scale(TableReader& table, ChannelMapping& mapping) {
  const auto text = table.text("full_scale");
  if (!text) return;
  if (!mapping.unit.empty())
    table.refuse("full_scale", "states the unit too: leave the key unit away");
  double value = 0.0;
  const char* const end = text->data() + text->size();
  const auto [unit, error] = std::from_chars(text->data(), end, value);
  const char* first = unit;
  while (first != end && *first == ' ') ++first;
  if (error != std::errc{} || !(value > 0.0) || !std::isfinite(value) || first == end)
    table.refuse("full_scale",
                 fmt::format("expected a positive value with a unit, for example \"10 V\", found "
                             "\"{}\"",
                             *text));
  mapping.full_scale = value;
  mapping.unit = std::string(first, end);
}

void read_role(TableReader& table, ChannelMapping& mapping) {
  const auto role = table.text("role");
  if (!role) return;
  mapping.role = datasets::quantity_named(*role);
  if (!mapping.role)
    table.refuse("role", fmt::format("there is no quantity '{}'; known are force, velocity, "
                                     "displacement, acceleration, voltage, charge, pressure, "
                                     "strain, angle, temperature",
                                     *role));
}

void read_sensitivity(TableReader& table, ChannelMapping& mapping) {
  if (table.has("gain") && !table.has("sensitivity"))
    fitting::refuse_gain_without_sensitivity(table);
  if (!table.has("sensitivity")) return;
  if (!mapping.role || datasets::si_unit(*mapping.role).empty())
    table.refuse("sensitivity", "needs the role it is for, for example role = \"force\"");
  mapping.sensitivity =
      fitting::read_sensitivity(table, datasets::si_unit(*mapping.role), mapping.recorded_unit);
  if (!table.has("gain")) return;
  mapping.sensitivity = fitting::with_gain(table, *mapping.sensitivity, mapping.recorded_unit);
  mapping.recorded_unit = std::string("V");
}

ChannelMapping read_mapping(TableReader& table) {
  ChannelMapping mapping;
  mapping.line = table.raw().source().begin.line;
  read_which(table, mapping);
  mapping.name = table.text("name").value_or("");
  mapping.unit = table.text("unit").value_or("");
  read_full_scale(table, mapping);
  read_role(table, mapping);
  read_sensitivity(table, mapping);
  if (const auto polarity = table.integer("polarity")) {
    if (*polarity != 1 && *polarity != -1)
      table.refuse("polarity", fmt::format("must be 1 or -1, found {}", *polarity));
    mapping.polarity = *polarity;
  }
  if (const auto position = table.quantity("position", "m")) {
    if (!(position->value >= 0.0))
      table.refuse("position", "is counted from the hinge and cannot be negative");
    mapping.position = position->value;
  }
  if (table.has("delay")) mapping.delay = fitting::read_delay(table);
  table.finish();
  return mapping;
}

toml::table parse(const std::string& path) {
  const std::string text = read_text(path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    throw datasets::InputError(
        {.file = path, .line = error.source().begin.line, .column = error.source().begin.column},
        fmt::format("not a TOML file: {}", error.description()));
  }
}

}  // namespace

acquisition::ChannelMap read_channel_map(const std::string& path) {
  const toml::table document = parse(path);
  const std::set<std::string> overridden;
  TableReader root(document, path, "", overridden);
  acquisition::ChannelMap map;
  map.file = path;
  map.keep_others = root.choice("others", {"drop", "keep"}).value_or(0) == 1;
  for (TableReader& table : root.tables("channels")) map.channels.push_back(read_mapping(table));
  map.conditioning = fitting::read_conditioning(root);
  root.finish();
  if (map.channels.empty() && !map.keep_others)
    throw datasets::InputError(
        {.file = path}, "names no channel: begin one with [[channels]] and match = \"Force\"");
  return map;
}

}  // namespace impactrig::app
