// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/sensor_keys.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

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

datasets::UncertainValue read_sensitivity(TableReader& table, std::string_view physical,
                                          std::string& recorded) {
  const std::string text = *table.text("sensitivity");
  for (const char* electrical : {"V", "pC"})
    for (const bool inverted : {false, true}) {
      const std::string unit = inverted ? fmt::format("({})/{}", physical, electrical)
                                        : fmt::format("{}/({})", electrical, physical);
      datasets::UncertainValue value;
      try {
        value = datasets::parse_quantity(text, unit);
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
  table.refuse("sensitivity",
               fmt::format("expected volts or coulombs a {}, for example \"{}\", found \"{}\"",
                           physical, physical == "N" ? "4 pC/N" : "125 mm/s/V", text));
}

datasets::UncertainValue with_gain(TableReader& table, datasets::UncertainValue sensitivity) {
  const auto gain = *table.quantity("gain", "V/pC");
  const double relative =
      std::hypot(gain.uncertainty / gain.value, sensitivity.uncertainty / sensitivity.value);
  const double value = gain.value * sensitivity.value;
  return {value, relative * value};
}

void refuse_gain_without_sensitivity(const TableReader& table) {
  table.refuse("gain", "needs a sensitivity in coulombs, for example sensitivity = \"4 pC/N\"");
}

}  // namespace impactrig::fitting
