// SPDX-License-Identifier: BSD-3-Clause
#include "reports/sensitivities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <string_view>

namespace impactrig::reports {
namespace {

using models::Sensitivity;
using models::Simulation;

constexpr std::array of_contact = {
    Observable{"peak", "N", "peak_force", "peak_force_n",
               [](const Simulation& s) { return s.episodes.front().peak_force; },
               [](const Sensitivity& s) { return s.peak_force; }},
    Observable{"depth", "m", "max_penetration", "max_penetration_m",
               [](const Simulation& s) { return s.episodes.front().max_penetration; },
               [](const Sensitivity& s) { return s.max_penetration; }},
    Observable{"duration", "s", "duration", "duration_s",
               [](const Simulation& s) { return s.episodes.front().end; },
               [](const Sensitivity& s) { return s.duration; }},
    Observable{"impulse", "N s", "impulse", "impulse_ns",
               [](const Simulation& s) { return s.episodes.front().impulse; },
               [](const Sensitivity& s) { return s.impulse; }},
    Observable{"out", "m/s", "separation_velocity", "separation_velocity_m_s",
               [](const Simulation& s) { return s.episodes.front().separation_velocity; },
               [](const Sensitivity& s) { return s.separation_velocity; }},
    Observable{"kinematic", "1", "restitution_kinematic", "restitution_kinematic",
               [](const Simulation& s) { return s.restitution.kinematic; },
               [](const Sensitivity& s) { return s.restitution.kinematic; }},
    Observable{"kinetic", "1", "restitution_kinetic", "restitution_kinetic",
               [](const Simulation& s) { return s.restitution.kinetic; },
               [](const Sensitivity& s) { return s.restitution.kinetic; }},
    Observable{"energetic", "1", "restitution_energetic", "restitution_energetic",
               [](const Simulation& s) { return s.restitution.energetic; },
               [](const Sensitivity& s) { return s.restitution.energetic; }},
};

constexpr Observable of_sensor{"sensor",
                               "N",
                               "sensor_peak_force",
                               "sensor_peak_force_n",
                               [](const Simulation& s) { return s.sensor->peak_force; },
                               [](const Sensitivity& s) { return s.sensor_peak_force; }};

constexpr int width = 12;  // of a column of numbers
// Relative slopes below are differences of equal numbers.
constexpr double rounding = 1e-11;

/// NaN of none.
double largest(const std::vector<double>& values) {
  double most = values.empty() ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

std::string cell(double number) {
  return std::isfinite(number) ? fmt::format(" {:>{}.4g}", number, width)
                               : fmt::format(" {:>{}}", "-", width);
}

/// Behind a name.
std::string in_brackets(std::string_view unit) {
  return unit == "1" ? std::string() : fmt::format(" [{}]", unit);
}

/// A line of heads, then one a parameter.
template <typename Head, typename Label, typename Number>
std::string table(const std::vector<Observable>& columns,
                  const std::vector<SensitivityEntry>& entries, const Head& head,
                  const Label& label, const Number& number) {
  std::size_t longest = 0;
  for (const SensitivityEntry& entry : entries) longest = std::max(longest, label(entry).size());
  std::string text = fmt::format("  {:<{}}", "", longest);
  for (const Observable& column : columns) text += fmt::format(" {:>{}}", head(column), width);
  text += "\n";
  for (const SensitivityEntry& entry : entries) {
    if (!entry.not_known.empty()) continue;
    text += fmt::format("  {:<{}}", label(entry), longest);
    for (const Observable& column : columns) text += cell(number(column, entry));
    text += "\n";
  }
  return text;
}

/// The names of those that are not known, by the reason.
std::map<std::string, std::vector<std::string_view>> refused(
    const std::vector<SensitivityEntry>& entries) {
  std::map<std::string, std::vector<std::string_view>> names;
  for (const SensitivityEntry& entry : entries)
    if (!entry.not_known.empty()) names[entry.not_known].push_back(entry.parameter.name);
  return names;
}

}  // namespace

std::vector<Observable> observables(const Simulation& simulation) {
  if (simulation.episodes.empty()) return {};
  std::vector<Observable> all(of_contact.begin(), of_contact.end());
  if (simulation.sensor) all.push_back(of_sensor);
  return all;
}

bool changes_nothing(const Simulation& simulation, const SensitivityEntry& entry) {
  if (!entry.not_known.empty()) return false;
  bool known = false;
  const auto acts_on = [&](double value, double slope) {
    if (!std::isfinite(slope)) return false;
    known = true;
    return std::abs(slope * entry.parameter.value) > rounding * std::abs(value);
  };
  for (const Observable& observable : observables(simulation))
    if (acts_on(observable.value(simulation), observable.slope(entry.slope))) return false;
  for (const auto channel : {&models::History::velocity, &models::History::displacement,
                             &models::History::deflection, &models::History::force})
    if (acts_on(largest(simulation.history.*channel), largest(entry.slope.history.*channel)))
      return false;
  return known;
}

double relative_slope(const Observable& observable, const Simulation& simulation,
                      const SensitivityEntry& entry) {
  const double value = observable.value(simulation);
  if (value == 0.0 || entry.parameter.value == 0.0) return std::numeric_limits<double>::quiet_NaN();
  return observable.slope(entry.slope) * entry.parameter.value / value;
}

std::string sensitivities_text(const Simulation& simulation,
                               const std::vector<SensitivityEntry>& entries) {
  std::string text;
  for (const auto& [sentence, names] : refused(entries))
    text += fmt::format("\nno derivatives by {}: {}\n", fmt::join(names, ", "), sentence);
  const std::vector<Observable> columns = observables(simulation);
  if (columns.empty())
    return text +
           "\nNothing struck, nothing to differentiate but histories: -o writes these with their "
           "derivatives\n";
  if (std::ranges::all_of(entries, [](const auto& entry) { return !entry.not_known.empty(); }))
    return text;
  text += fmt::format(
      "\nSensitivities of the first contact, {}, d ln y / d ln p: percent of y a percent of p\n",
      simulation.small_motion ? "small motion" : "full equations");
  text += table(
      columns, entries, [](const Observable& column) { return std::string(column.head); },
      [](const SensitivityEntry& entry) { return entry.parameter.name; },
      [&](const Observable& column, const SensitivityEntry& entry) {
        return relative_slope(column, simulation, entry);
      });
  text += "\nand d y / d p in SI units\n";
  return text + table(
                    columns, entries,
                    [](const Observable& column) { return column.head + in_brackets(column.unit); },
                    [](const SensitivityEntry& entry) {
                      return entry.parameter.name + in_brackets(entry.parameter.unit);
                    },
                    [](const Observable& column, const SensitivityEntry& entry) {
                      return column.slope(entry.slope);
                    });
}

}  // namespace impactrig::reports
