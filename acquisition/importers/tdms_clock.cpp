// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/tdms_clock.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "datasets/units.hpp"

namespace impactrig::acquisition {

std::optional<TdmsTime> tdms_start(const TdmsProperties& properties) {
  const auto stated = properties.find("wf_start_time");
  if (stated == properties.end()) return std::nullopt;
  const auto* const time = std::get_if<TdmsTime>(&stated->second);
  if (time == nullptr || iso_text(*time).empty()) return std::nullopt;
  return *time;
}

double seconds_between(const TdmsTime& a, const TdmsTime& b) {
  return static_cast<double>(b.seconds - a.seconds) +
         std::ldexp(static_cast<double>(b.fraction), -64) -
         std::ldexp(static_cast<double>(a.fraction), -64);
}

std::optional<double> seconds_of_abscissa(const TdmsProperties& properties) {
  const std::string unit = text_of(properties, "wf_xunit_string");
  if (!unit.empty()) {
    if (datasets::quantity_of_unit(unit) == datasets::Quantity::frequency) return std::nullopt;
    const auto conversion = datasets::conversion(unit, "s");
    return conversion ? std::optional(conversion->factor) : std::nullopt;
  }
  const std::string name = text_of(properties, "wf_xname");
  const bool frequency = name == "Frequency" || name == "frequency";
  return frequency ? std::nullopt : std::optional(1.0);
}

namespace {

double in_seconds(const TdmsProperties& properties, const char* name) {
  const double value = number_of(properties, name).value_or(0.0);
  return std::isfinite(value) ? seconds_of_abscissa(properties).value_or(1.0) * value : 0.0;
}

}  // namespace

double tdms_step(const TdmsProperties& properties) {
  const double step = in_seconds(properties, "wf_increment");
  return seconds_of_abscissa(properties) ? std::max(0.0, step) : step;
}

double tdms_start_offset(const TdmsProperties& properties) {
  return in_seconds(properties, "wf_start_offset");
}

}  // namespace impactrig::acquisition
