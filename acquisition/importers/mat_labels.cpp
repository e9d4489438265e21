// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mat_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "acquisition/importers/clock_words.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::array<std::string_view, 8> unit_words = {"unit",   "units", "Unit",   "Units",
                                                        "y_unit", "yunit", "YUnits", "YUnit"};
// of lists, as plain() has them
constexpr auto name_lists = std::to_array<std::string_view>(
    {"colheaders", "colnames", "names", "labels", "columns", "channels", "channelnames",
     "channellabels", "channames", "chnames", "signalnames", "variablenames", "headers"});
constexpr auto unit_lists =
    std::to_array<std::string_view>({"unit", "units", "yunit", "yunits", "channelunits",
                                     "chanunits", "chunits", "signalunits", "engunits"});

/// "run." of "run.data"; "" at the top.
std::string_view structure_of(std::string_view name) {
  const std::size_t point = name.rfind('.');
  return point == std::string_view::npos ? std::string_view{} : name.substr(0, point + 1);
}

/// "runtimeunit" of "Run.TimeUnit" and "run.time_unit".
std::string plain(std::string_view name) {
  std::string result = lowered(name);
  std::erase_if(result, [](char c) { return c == '_'; });
  return result;
}

}  // namespace

bool is_told_of_small(std::uint64_t rows, std::uint64_t columns) {
  constexpr std::uint64_t fewest = 16;
  const auto [channels, samples] = std::minmax(rows, columns);
  return channels > 1 && samples > channels && samples >= fewest;
}

std::string told_of_small(std::string_view name, std::uint64_t rows, std::uint64_t columns) {
  return fmt::format(
      "'{}' is one channel, column behind column: of {} x {} numbers nothing tells that they are "
      "samples of several (times of that length, an interval or a rate do)",
      name, rows, columns);
}

MatLabels::MatLabels(const MatContents& contents) : contents_(contents) {
  for (const auto& [name, text] : contents_.texts) texts_.emplace(plain(name), text);
  for (const MatArray& array : contents_.arrays) {
    ++arrays_[plain(array.name)];
    const bool vector = array.count > 2 && std::min(array.rows, array.columns) == 1;
    if (vector && is_named_as_time(array.name)) lengths_of_times_.insert(array.count);
    const std::string word = array.count == 1 ? last_word(array.name) : std::string();
    tells_rate_ = tells_rate_ || is_rate_word(word) || is_interval_word(word);
    if (array.count < 2 || is_named_as_time(array.name)) continue;
    const auto [first, is_new] = only_.try_emplace(structure_of(array.name), array.name);
    if (!is_new) first->second = {};
  }
}

std::string MatLabels::stated_unit(const std::string& name, bool any_case) const {
  std::string_view text;
  if (const auto exact = contents_.texts.find(name); exact != contents_.texts.end())
    text = exact->second;
  else if (const auto alike = texts_.find(plain(name)); any_case && alike != texts_.end())
    text = alike->second;
  const std::string unit = to_utf8(text);
  return datasets::quantity_of_unit(unit) == datasets::Quantity::unknown ? std::string() : unit;
}

std::string MatLabels::unit_of(std::string_view array) const {
  const std::string_view structure = structure_of(array);
  const bool time = is_named_as_time(array);
  std::vector<std::string> names = {fmt::format("{}_unit", array), fmt::format("{}_units", array)};
  if (time)
    for (const std::string_view word : {"time_unit", "time_units"})
      names.push_back(fmt::format("{}{}", structure, word));
  if (!structure.empty())  // of a timeseries
    names.push_back(fmt::format("{}{}", structure, time ? "TimeInfo.Units" : "DataInfo.Units"));
  const auto same = arrays_.find(plain(array));
  const bool only_one = same == arrays_.end() || same->second == 1;
  for (const std::string& name : names)
    if (std::string own = stated_unit(name, only_one); !own.empty()) return own;
  if (structure.empty()) return {};
  const auto only_array = only_.find(structure);
  if (only_array == only_.end() || only_array->second != array) return {};
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

bool MatLabels::rows_are_samples(std::uint64_t rows, std::uint64_t columns, bool named) const {
  constexpr std::uint64_t fewest = 8, many_times = 4;
  const auto [channels, samples] = std::minmax(rows, columns);
  if (channels == samples) return false;
  if (lengths_of_times_.contains(samples)) return true;
  return samples >= fewest && samples / many_times >= channels && (named || tells_rate_);
}

std::vector<std::string> MatLabels::channels_of(std::string_view array,
                                                std::uint64_t channels) const {
  for (const std::string_view word : name_lists) {
    std::vector<std::string> names =
        texts_of(fmt::format("{}{}", structure_of(array), word), channels);
    const std::set<std::string> different(names.begin(), names.end());
    if (!names.empty() && different.size() == names.size()) return names;
  }
  return {};
}

std::vector<std::string> MatLabels::units_of(std::string_view array, std::uint64_t channels) const {
  for (const std::string_view word : unit_lists) {
    std::vector<std::string> units =
        texts_of(fmt::format("{}{}", structure_of(array), word), channels);
    if (!units.empty()) return units;
  }
  return {};
}

/// A cell array or lines of just so many texts; empty where there is none.
std::vector<std::string> MatLabels::texts_of(const std::string& cells, std::uint64_t count) const {
  const auto text = [&](std::uint64_t i) {
    return texts_.find(plain(fmt::format("{}{{{}}}", cells, i)));
  };
  if (text(count + 1) != texts_.end()) return {};
  std::vector<std::string> found;
  for (std::uint64_t i = 1; i <= count; ++i) {
    if (text(i) == texts_.end() || text(i)->second.empty()) return {};
    found.push_back(to_utf8(text(i)->second));
  }
  return found;
}

}  // namespace impactrig::acquisition
