// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mat_programs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
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

/// "Channel_1" of "Channel_1_Data".
void take_pulse(const MatFacts& facts, Channel& channel, Record& record) {
  constexpr std::string_view data = "_Data";
  if (!channel.name.starts_with("Channel_") || !channel.name.ends_with(data)) return;
  const auto rate = number(facts, "File_Header.SampleFrequency");
  if (!rate || !(*rate > 0.0) || !std::isfinite(*rate)) return;
  channel.clock.interval = 1.0 / *rate;
  const std::string head = channel.name.substr(0, channel.name.size() - data.size()) + "_Header";
  const std::string unit = text(facts, head + ".Unit");
  if (channel.unit.empty() && !unit.empty()) set_unit(channel, unit);
  if (const std::string name = text(facts, head + ".SignalName"); !name.empty()) {
    channel.attributes["array"] = channel.name;
    channel.name = name;
  }
  record.attributes["time column"] =
      fmt::format("File_Header.SampleFrequency (an interval of {:.9g} s)", channel.clock.interval);
}

}  // namespace

void take_clock_of_program(const MatFacts& facts, Channel& channel, Record& record) {
  take_testlab(facts, channel);
  take_pulse(facts, channel, record);
}

}  // namespace impactrig::acquisition
