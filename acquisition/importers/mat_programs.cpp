// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mat_programs.hpp"

#include <fmt/format.h>

#include <algorithm>
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

std::string text(const MatContents& contents, const std::string& name) {
  const auto found = contents.texts.find(name);
  return found == contents.texts.end() ? std::string() : to_utf8(trimmed(found->second));
}

/// A single number, or the numbers of a text where they are one: "65536", "65536,0".
std::optional<double> number(const MatContents& contents, const std::string& name) {
  const auto found = std::ranges::find(contents.arrays, name, &MatArray::name);
  if (found != contents.arrays.end() && found->count == 1 && !found->complex) {
    double value = 0.0;
    StoredNumbers one(found->kind, contents.big_endian);
    one.add({found->offset, 1, size_of(found->kind)});
    read_numbers(*contents.file, one, 0, {&value, 1});
    return value;
  }
  const std::string all = text(contents, name);
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
void take_testlab(const MatContents& contents, Channel& channel) {
  constexpr std::string_view values = ".y_values.values";
  const std::size_t end = channel.name.rfind(values);
  if (end == std::string::npos) return;
  const std::string_view rest = std::string_view(channel.name).substr(end + values.size());
  if (!rest.empty() && rest.front() != ':') return;
  const std::string axis = channel.name.substr(0, end) + ".x_values";
  const auto increment = number(contents, axis + ".increment");
  const std::string unit = text(contents, axis + ".quantity.label");
  if (increment && *increment > 0.0 && !unit.empty())
    set_axis(channel, number(contents, axis + ".start_value").value_or(0.0), *increment, unit);
}

/// "Channel_1" of "Channel_1_Data".
void take_pulse(const MatContents& contents, Channel& channel, Record& record) {
  constexpr std::string_view data = "_Data";
  if (!channel.name.starts_with("Channel_") || !channel.name.ends_with(data)) return;
  const auto rate = number(contents, "File_Header.SampleFrequency");
  if (!rate || !(*rate > 0.0) || !std::isfinite(*rate)) return;
  channel.clock.interval = 1.0 / *rate;
  const std::string head = channel.name.substr(0, channel.name.size() - data.size()) + "_Header";
  const std::string unit = text(contents, head + ".Unit");
  if (channel.unit.empty() && !unit.empty()) set_unit(channel, unit);
  if (const std::string name = text(contents, head + ".SignalName"); !name.empty()) {
    channel.attributes["array"] = channel.name;
    channel.name = name;
  }
  record.attributes["time column"] =
      fmt::format("File_Header.SampleFrequency (an interval of {:.9g} s)", channel.clock.interval);
}

}  // namespace

void take_clock_of_program(const MatContents& contents, Channel& channel, Record& record) {
  take_testlab(contents, channel);
  take_pulse(contents, channel, record);
}

}  // namespace impactrig::acquisition
