// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/sensor_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace impactrig::fitting {

datasets::Delay read_delay(TableReader& table) {
  datasets::Delay delay;
  if (!table.has("delay")) return delay;
  if (table.raw().get("delay")->is_table()) {
    auto inner = *table.table("delay");
    delay.value = inner.quantity("value", "s").value_or(datasets::UncertainValue{}).value;
    delay.uncertainty =
        inner.quantity("uncertainty", "s").value_or(datasets::UncertainValue{}).value;
    inner.finish();
  } else {
    const auto value = *table.quantity("delay", "s");
    delay = {.value = value.value, .uncertainty = value.uncertainty};
  }
  if (!(delay.uncertainty >= 0.0)) table.refuse("delay", "its uncertainty must not be negative");
  return delay;
}

namespace {

/// As it is written, then as it is meant: of "10 mV/m/s^2", "10 mV/ms-2" and "8 Vs/m" all behind
/// the first stroke is the physical unit. By the rules of units "V/m/s" is V/(m s), which no sensor
/// has.
std::vector<std::string> readings_of(const std::string& text) {
  std::vector<std::string> readings = {text};
  std::string meant = text;
  const auto replace = [&meant](std::string_view from, std::string_view to) {
    for (std::size_t at = meant.find(from); at != std::string::npos;
         at = meant.find(from, at + to.size()))
      meant.replace(at, from.size(), to);
  };
  for (const std::string_view second : {"ms-2", "ms^-2", "ms\u207b\u00b2", "m/s/s"})
    replace(second, "m/s^2");
  replace("Vs", "V s");
  if (meant != text) readings.push_back(meant);
  const std::size_t stroke = meant.find('/');
  if (stroke != std::string::npos && meant[stroke + 1] != '(')
    readings.push_back(meant.substr(0, stroke + 1) + '(' + meant.substr(stroke + 1) + ')');
  return readings;
}

/// ", which has a comma in its number" where it is the number that is wrong; else "".
std::string what_is_wrong_with_its_number(const std::string& text) {
  try {
    datasets::parse_quantity(text, "V");
  } catch (const std::invalid_argument& error) {
    const std::string problem = error.what();
    const std::size_t has = problem.find("\" has ");
    if (has != std::string::npos)
      return ", which" + problem.substr(has + 1, problem.find(';') - has - 1);
  }
  return {};
}

std::string_view usual_sensitivity(std::string_view physical) {
  return physical == "N" ? "4 pC/N" : physical == "m/s^2" ? "100 mV/g" : "125 mm/s/V";
}

/// "MV" for "mV" would be a thousand million times too much.
void refuse_mega(const TableReader& table, const std::string& text) {
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  for (const std::string_view big : {"MV", "PC"})
    for (std::size_t at = text.find(big); at != std::string::npos; at = text.find(big, at + 1))
      if ((at == 0 || !is_letter(text[at - 1])) &&
          (at + 2 == text.size() || !is_letter(text[at + 2])))
        table.refuse("sensitivity",
                     fmt::format("\"{}\" is in {}: write {}", text,
                                 big == "MV" ? "megavolts" : "petacoulombs",
                                 big == "MV" ? "mV for millivolts" : "pC for picocoulombs"));
}

}  // namespace

datasets::UncertainValue read_sensitivity(TableReader& table, std::string_view physical,
                                          std::string& recorded) {
  const std::string text = *table.text("sensitivity");
  refuse_mega(table, text);
  for (const std::string& reading : readings_of(text))
    for (const char* electrical : {"V", "pC"})
      for (const bool inverted : {false, true}) {
        const std::string unit = inverted ? fmt::format("({})/{}", physical, electrical)
                                          : fmt::format("{}/({})", electrical, physical);
        datasets::UncertainValue value;
        try {
          value = datasets::parse_quantity(reading, unit);
        } catch (const std::invalid_argument&) {
          continue;  // of another dimension: the next way to state it
        }
        if (!(value.value > 0.0))
          table.refuse("sensitivity",
                       "must be greater than zero; a sensor that inverts has polarity = -1");
        recorded = electrical;
        if (!inverted) return value;
        return {1.0 / value.value, value.uncertainty / (value.value * value.value)};
      }
  table.refuse(
      "sensitivity",
      fmt::format("expected volts or coulombs a {}, for example \"{}\", found \"{}\"{}", physical,
                  usual_sensitivity(physical), text, what_is_wrong_with_its_number(text)));
}

namespace {

/// Of an amplifier of volts, 10 or "10".
datasets::UncertainValue read_factor(TableReader& table) {
  if (table.is_number("gain")) return {*table.number("gain"), 0.0};
  const std::string text = *table.text("gain");
  if (std::ranges::find(text, 'C') != text.end()) refuse_gain_without_sensitivity(table);
  if (text.ends_with("dB"))
    table.refuse("gain",
                 fmt::format("\"{}\" is a level: state the factor, which for 20 dB is 10", text));
  return *table.quantity("gain", "1");
}

datasets::UncertainValue read_charge_gain(TableReader& table) {
  if (table.is_number("gain"))
    table.refuse("gain",
                 "a sensor of charge needs the gain of its amplifier in volts a coulomb, "
                 "for example gain = \"1 mV/pC\"");
  return *table.quantity("gain", "V/pC");
}

}  // namespace

datasets::UncertainValue with_gain(TableReader& table, datasets::UncertainValue sensitivity,
                                   std::string_view recorded_unit) {
  const auto gain = recorded_unit == "V" ? read_factor(table) : read_charge_gain(table);
  if (!(gain.value > 0.0) || !std::isfinite(gain.value))
    table.refuse("gain", "must be greater than zero; an amplifier that inverts has polarity = -1");
  const double relative =
      std::hypot(gain.uncertainty / gain.value, sensitivity.uncertainty / sensitivity.value);
  const double value = gain.value * sensitivity.value;
  return {value, relative * value};
}

void refuse_gain_without_sensitivity(const TableReader& table) {
  table.refuse(
      "gain",
      "needs a sensitivity in coulombs, for example sensitivity = \"4 pC/N\"; of volts it is a "
      "factor, for example gain = 10");
}

}  // namespace impactrig::fitting
