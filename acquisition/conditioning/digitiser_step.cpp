// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/digitiser_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {
namespace {

constexpr const char* key = "digitiser step";
constexpr double reaching = 0.6;  // of a step, noise that reaches to the next

/// The number in "0.012 N", where that is the unit; else 0.
double number_in(const std::string& text, const std::string& unit) {
  const char* const end = text.data() + text.size();
  double value = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  const bool told = error == std::errc{} && std::isfinite(value);
  return told && std::string(rest, end) == " " + unit ? value : 0.0;
}

}  // namespace

void note_digitiser_step(std::span<const double> values, std::span<const std::uint8_t> valid,
                         const datasets::Channel& channel, datasets::Edit& edit) {
  const double step = quantum_of(values, valid);
  if (step_noise(values, valid) < reaching * step)
    edit.parameters[key] = fmt::format("{:.6g} {}", step, channel.unit);
}

double noted_digitiser_step(const datasets::Record& record, const datasets::Channel& channel) {
  double step = 0.0;
  for (const datasets::Edit* const edit : edits_of(record, channel)) {
    const auto noted = edit->parameters.find(key);
    if (noted != edit->parameters.end())
      step = std::max(step, number_in(noted->second, channel.unit));
  }
  return step;
}

}  // namespace impactrig::acquisition
