// SPDX-License-Identifier: BSD-3-Clause
// NetCDF Users Guide, Appendix A: Attribute Conventions.
#include "acquisition/importers/hdf5_no_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/hdf5_arrays.hpp"

namespace impactrig::acquisition {

namespace {

/// The numbers of an attribute, whose name is in lower case: of several columns that of one where
/// it has one a column.
std::vector<double> numbers_of(const Hdf5Array& array, std::string_view name, std::uint64_t which,
                               std::uint64_t columns) {
  for (const auto& [key, value] : array.attributes.numbers)
    if (lowered(key) == name) return {value};
  for (const auto& [key, values] : array.attributes.number_lists)
    if (lowered(key) == name)
      return columns > 1 && values.size() == columns ? std::vector{values[which]} : values;
  return {};
}

double as_stored(const Hdf5Array& array, double number) {
  return array.numbers == ArrayNumbers::f32 ? static_cast<double>(static_cast<float>(number))
                                            : number;
}

}  // namespace

bool Hdf5NoValue::any() const {
  return !numbers.empty() || std::isfinite(least) || std::isfinite(most);
}

bool Hdf5NoValue::holds(double number) const {
  return number < least || number > most || std::ranges::find(numbers, number) != numbers.end();
}

std::string Hdf5NoValue::text() const {
  std::string list;
  for (const double number : numbers)
    list += fmt::format("{}{}", list.empty() ? "" : " or ", number);
  if (!list.empty()) list += ", which stands for none";
  if (std::isfinite(least) || std::isfinite(most))
    list += fmt::format("{}not between {} and {}", list.empty() ? "" : ", or ", least, most);
  return list;
}

Hdf5NoValue no_value_of(const Hdf5Array& array, std::uint64_t which, std::uint64_t columns) {
  Hdf5NoValue none;
  for (const std::string_view name : {"_fillvalue", "missing_value"})
    for (const double number : numbers_of(array, name, which, columns))
      if (const double stored = as_stored(array, number);
          std::isfinite(stored) && std::ranges::find(none.numbers, stored) == none.numbers.end())
        none.numbers.push_back(stored);
  const std::vector<double> least = numbers_of(array, "valid_min", which, columns);
  const std::vector<double> most = numbers_of(array, "valid_max", which, columns);
  const std::vector<double> range = numbers_of(array, "valid_range", 0, 1);
  if (least.size() == 1) none.least = as_stored(array, least.front());
  if (most.size() == 1) none.most = as_stored(array, most.front());
  if (range.size() == 2 && range.front() < range.back()) {
    none.least = as_stored(array, range.front());
    none.most = as_stored(array, range.back());
  }
  return none;
}

}  // namespace impactrig::acquisition
