// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/uff58_codes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/importers/number.hpp"

namespace impactrig::acquisition {

using datasets::Quantity;

namespace {

struct SpecificType {
  int code;
  Quantity quantity;
};

/// In the order in which a quantity's code is chosen for writing: the first one counts.
constexpr std::array<SpecificType, 19> specific_types = {{
    {8, Quantity::displacement},   //
    {11, Quantity::velocity},      //
    {12, Quantity::acceleration},  //
    {13, Quantity::force},         // excitation force
    {9, Quantity::force},          // reaction force
    {15, Quantity::pressure},      //
    {21, Quantity::pressure},      // sound pressure
    {2, Quantity::pressure},       // stress
    {3, Quantity::strain},         //
    {5, Quantity::temperature},    //
    {17, Quantity::time},          //
    {18, Quantity::frequency},     //
    {6, Quantity::other},          // heat flux
    {16, Quantity::other},         // mass
    {19, Quantity::other},         // revolutions per minute
    {20, Quantity::other},         // order
    {22, Quantity::other},         // sound intensity
    {23, Quantity::other},         // sound power
    {1, Quantity::unknown},        // general
}};

constexpr std::array<std::string_view, 29> function_names = {"general function",
                                                             "time response",
                                                             "auto spectrum",
                                                             "cross spectrum",
                                                             "frequency response function",
                                                             "transmissibility",
                                                             "coherence",
                                                             "auto correlation",
                                                             "cross correlation",
                                                             "power spectral density",
                                                             "energy spectral density",
                                                             "probability density function",
                                                             "spectrum",
                                                             "cumulative frequency distribution",
                                                             "peaks valley",
                                                             "stress/cycles",
                                                             "strain/cycles",
                                                             "orbit",
                                                             "mode indicator function",
                                                             "force pattern",
                                                             "partial power",
                                                             "partial coherence",
                                                             "eigenvalue",
                                                             "eigenvector",
                                                             "shock response spectrum",
                                                             "finite impulse response filter",
                                                             "multiple coherence",
                                                             "order function",
                                                             "phase compensation"};

constexpr std::string_view start_key = "clock: start ";
constexpr std::string_view interval_key = " s, interval ";

}  // namespace

Quantity uff58_quantity(int specific_data_type) {
  for (const SpecificType& type : specific_types)
    if (type.code == specific_data_type) return type.quantity;
  return Quantity::unknown;
}

int uff58_type(Quantity quantity) {
  if (quantity == Quantity::other || quantity == Quantity::unknown) return 1;
  for (const SpecificType& type : specific_types)
    if (type.quantity == quantity) return type.code;
  return 1;
}

std::string uff58_function_name(int function_type) {
  if (function_type >= 0 && static_cast<std::size_t>(function_type) < function_names.size())
    return std::string(function_names[static_cast<std::size_t>(function_type)]);
  return fmt::format("function type {}", function_type);
}

int uff58_function(std::string_view name) {
  const auto* const found = std::find(function_names.begin(), function_names.end(), name);
  return found == function_names.end() ? 0 : static_cast<int>(found - function_names.begin());
}

bool uff58_is_time(int specific_data_type, int function_type, std::string_view unit) {
  if (specific_data_type == 17) return true;
  if (specific_data_type > 1) return false;
  const Quantity by_unit = datasets::quantity_of_unit(unit);
  if (by_unit == Quantity::time) return true;
  if (!unit.empty() && by_unit != Quantity::unknown) return false;
  for (const std::string_view turns : {"rev", "Rev", "REV", "revs", "Revs", "order", "orders"})
    if (unit == turns) return false;
  return function_type <= 1;
}

std::string uff58_exact_clock(const datasets::SampleClock& clock) {
  return fmt::format("{}{}{}{} s", start_key, clock.start, interval_key, clock.interval);
}

bool uff58_read_exact_clock(std::string_view id_line, datasets::SampleClock& clock) {
  const std::string_view line = trimmed(id_line);
  const std::size_t middle = line.find(interval_key);
  if (!line.starts_with(start_key) || middle == std::string_view::npos || !line.ends_with(" s"))
    return false;
  const auto start = number_in(line.substr(start_key.size(), middle - start_key.size()));
  const auto interval = number_in(
      line.substr(middle + interval_key.size(), line.size() - 2 - middle - interval_key.size()));
  if (!start || !interval || !(*interval >= 0.0)) return false;  // 0: of one sample
  // somebody may have resampled and kept the line: record 7 decides then
  const bool agrees = std::abs(*start - clock.start) <= 1e-5 * std::abs(*start) &&
                      std::abs(*interval - clock.interval) <= 1e-5 * *interval;
  if (!agrees) return false;
  clock.start = *start;
  clock.interval = *interval;
  return true;
}

}  // namespace impactrig::acquisition
