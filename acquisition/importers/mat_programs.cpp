// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mat_programs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;

namespace {

std::string text(const MatFacts& facts, const std::string& name) {
  return to_utf8(trimmed(facts.text(name)));
}

/// A single number, or the numbers of a text where they are one: "65536", "65536,0".
std::optional<double> number(const MatFacts& facts, const std::string& name) {
  if (const auto stored = facts.number(name)) return stored;
  const std::string all = text(facts, name);
  std::optional<double> same;
  for (const std::string_view cell : cells_of(all, ' ')) {
    const auto point = number_in(cell, {'.', false});
    const auto value = point ? point : number_in(cell, {',', false});
    if (!value || (same && *same != *value)) return std::nullopt;
    same = value;
  }
  return same;
}

/// "Signal_0" of "Signal_0.y_values.values" and "Signal_0.y_values.values:2".
void take_testlab(const MatFacts& facts, Channel& channel) {
  constexpr std::string_view values = ".y_values.values";
  const std::size_t end = channel.name.rfind(values);
  if (end == std::string::npos) return;
  const std::string_view rest = std::string_view(channel.name).substr(end + values.size());
  if (!rest.empty() && rest.front() != ':') return;
  const std::string axis = channel.name.substr(0, end) + ".x_values";
  const auto increment = number(facts, axis + ".increment");
  const std::string unit = text(facts, axis + ".quantity.label");
  if (increment && *increment > 0.0 && !unit.empty())
    set_axis(channel, number(facts, axis + ".start_value").value_or(0.0), *increment, unit);
}

/// "Function_1" of "Function_1.Data", what a spectrum is over in `XUnits`.
void take_infiniium(const MatFacts& facts, Channel& channel) {
  constexpr std::string_view data = ".Data";
  if (!channel.name.ends_with(data)) return;
  const std::string head = channel.name.substr(0, channel.name.size() - data.size());
  const std::string unit = lowered(text(facts, head + ".XUnits"));  // "Second", "Hertz"
  const Quantity along = datasets::quantity_of_unit(unit);
  if (along != Quantity::time && along != Quantity::frequency) return;
  if (const auto increment = number(facts, head + ".XInc"))
    set_axis(channel, number(facts, head + ".XOrg").value_or(0.0), *increment, unit);
}

/// "Channel_1_Header" of "Channel_1_Data"; "" of other names.
std::string header_beside(std::string_view array) {
  constexpr std::string_view data = "_Data";
  if (!array.starts_with("Channel_") || !array.ends_with(data)) return {};
  return fmt::format("{}_Header", array.substr(0, array.size() - data.size()));
}

void take_header_beside(const MatFacts& facts, bool no_clock, Channel& channel, Record& record) {
  const std::string head = header_beside(channel.name);
  if (head.empty()) return;
  for (const std::string& owner : {head, std::string("File_Header")}) {
    const auto rate = number(facts, owner + ".SampleFrequency");
    if (!no_clock || !rate || !(*rate > 0.0) || !std::isfinite(*rate)) continue;
    channel.clock.interval = 1.0 / *rate;
    record.attributes["time column"] =
        fmt::format("{}.SampleFrequency (an interval of {:.9g} s)", owner, channel.clock.interval);
    break;
  }
  const std::string unit = text(facts, head + ".Unit");
  if (channel.unit.empty() && !unit.empty()) set_unit(channel, unit);
  if (const std::string name = text(facts, head + ".SignalName"); !name.empty()) {
    channel.attributes["array"] = channel.name;
    channel.name = name;
  }
}

/// "rec.Y(1)" of "rec.Y(1).Data", where `axis` is Y.
std::optional<std::string_view> owner_of_data(std::string_view array, char axis) {
  constexpr std::string_view data = ".Data";
  if (!array.ends_with(data)) return std::nullopt;
  const std::string_view owner = array.substr(0, array.size() - data.size());
  std::string_view word = owner;
  if (word.ends_with(')')) word = word.substr(0, word.rfind('('));
  const std::size_t point = word.rfind('.');
  const bool is_axis =
      point != std::string_view::npos && word.substr(point + 1) == std::string(1, axis);
  return is_axis ? std::optional(owner) : std::nullopt;
}

void take_control_desk(const MatFacts& facts, Channel& channel) {
  const auto owner = owner_of_data(channel.name, 'Y');
  if (!owner) return;
  const std::string name = text(facts, fmt::format("{}.Name", *owner));
  if (name.empty()) return;
  channel.attributes["array"] = channel.name;
  channel.name = name;
}

}  // namespace

void tell_times_of_program(const MatFacts& facts, NamedArray& array) {
  const auto is_time = [](const std::string& unit) {
    return !unit.empty() && datasets::conversion(unit, "s").has_value();
  };
  if (const std::string head = header_beside(array.name); !head.empty()) {
    const std::string unit = text(facts, head + ".Unit");
    array.time = is_time(unit);
    if (array.time) take_unit(array, unit);
  }
  for (const std::string_view number : {".XInc", ".XOrg"})
    if (array.name.ends_with(number)) {
      const std::string_view head =
          std::string_view(array.name).substr(0, array.name.size() - number.size());
      const std::string unit = lowered(text(facts, fmt::format("{}.XUnits", head)));
      if (is_time(unit)) take_unit(array, unit);
      array.real = array.real && datasets::quantity_of_unit(unit) != Quantity::frequency;
    }
  if (const auto owner = owner_of_data(array.name, 'X')) {
    const std::string unit = text(facts, fmt::format("{}.Unit", *owner));
    if (!is_time(unit)) return;
    take_unit(array, unit);
    array.other_names.push_back(fmt::format("{}.time", owner->substr(0, owner->rfind('.'))));
  }
}

void take_facts_of_program(const MatFacts& facts, bool no_clock, Channel& channel, Record& record) {
  if (no_clock) take_testlab(facts, channel);
  take_infiniium(facts, channel);
  take_header_beside(facts, no_clock, channel, record);
  take_control_desk(facts, channel);
}

}  // namespace impactrig::acquisition
