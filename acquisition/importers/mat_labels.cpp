// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mat_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "acquisition/importers/clock_words.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::array<std::string_view, 6> unit_words = {"unit",  "units",  "Unit",
                                                        "Units", "y_unit", "yunit"};
constexpr std::array<std::string_view, 9> list_words = {
    "colheaders",    "names",          "labels",         "columns", "channels",
    "channel_names", "channel_labels", "variable_names", "headers"};

/// "run." of "run.data"; "" at the top.
std::string_view structure_of(std::string_view name) {
  const std::size_t point = name.rfind('.');
  return point == std::string_view::npos ? std::string_view{} : name.substr(0, point + 1);
}

}  // namespace

MatLabels::MatLabels(const MatContents& contents) : contents_(contents) {
  for (const MatArray& array : contents_.arrays) {
    if (array.count < 2 || is_named_as_time(array.name)) continue;
    const auto [first, is_new] = only_.try_emplace(structure_of(array.name), array.name);
    if (!is_new) first->second = {};
  }
}

std::string MatLabels::unit_of(std::string_view array) const {
  const auto stated = [this](const std::string& name) {
    const auto found = contents_.texts.find(name);
    const std::string unit =
        found == contents_.texts.end() ? std::string() : to_utf8(found->second);
    return datasets::quantity_of_unit(unit) == datasets::Quantity::unknown ? std::string() : unit;
  };
  for (const std::string_view ending : {"_unit", "_units"})
    if (std::string own = stated(fmt::format("{}{}", array, ending)); !own.empty()) return own;
  const std::string_view structure = structure_of(array);
  if (is_named_as_time(array))
    for (const std::string_view word : {"time_unit", "time_units"})
      if (std::string own = stated(fmt::format("{}{}", structure, word)); !own.empty()) return own;
  if (structure.empty()) return {};
  // of a timeseries
  const std::string_view info = is_named_as_time(array) ? "TimeInfo.Units" : "DataInfo.Units";
  if (std::string own = stated(fmt::format("{}{}", structure, info)); !own.empty()) return own;
  const auto only = only_.find(structure);
  if (only == only_.end() || only->second != array) return {};
  for (const std::string_view word : unit_words) {
    const auto found = contents_.texts.find(fmt::format("{}{}", structure, word));
    if (found == contents_.texts.end()) continue;
    const std::string unit = to_utf8(found->second);
    const datasets::Quantity quantity = datasets::quantity_of_unit(unit);
    const bool may_be =
        quantity != datasets::Quantity::unknown && quantity != datasets::Quantity::time;
    return may_be ? unit : std::string();
  }
  return {};
}

std::vector<std::string> MatLabels::channels_of(std::string_view array,
                                                std::uint64_t channels) const {
  for (const std::string_view word : list_words) {
    std::vector<std::string> names =
        texts_of(fmt::format("{}{}", structure_of(array), word), channels);
    const std::set<std::string> different(names.begin(), names.end());
    if (!names.empty() && different.size() == names.size()) return names;
  }
  return {};
}

std::vector<std::string> MatLabels::units_of(std::string_view array, std::uint64_t channels) const {
  for (const std::string_view word : unit_words) {
    std::vector<std::string> units =
        texts_of(fmt::format("{}{}", structure_of(array), word), channels);
    if (!units.empty()) return units;
  }
  return {};
}

/// A cell array or lines of just so many texts; empty where there is none.
std::vector<std::string> MatLabels::texts_of(const std::string& cells, std::uint64_t count) const {
  const auto text = [&](std::uint64_t i) {
    return contents_.texts.find(fmt::format("{}{{{}}}", cells, i));
  };
  if (text(count + 1) != contents_.texts.end()) return {};
  std::vector<std::string> found;
  for (std::uint64_t i = 1; i <= count; ++i) {
    if (text(i) == contents_.texts.end() || text(i)->second.empty()) return {};
    found.push_back(to_utf8(text(i)->second));
  }
  return found;
}

}  // namespace impactrig::acquisition
