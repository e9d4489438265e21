// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_programs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/hdf5_pandas.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

namespace {

/// A step and a start along time, in a unit.
void state_clock(Hdf5Attributes& of, double step, double start, const std::string& unit) {
  of.numbers.emplace("dt", step);
  of.numbers.emplace("t0", start);
  if (unit.empty()) return;
  of.texts.emplace("dt_unit", unit);
  of.texts.emplace("t0_unit", unit);
}

/// Of a list of texts, or of one text; "" where there are fewer.
std::string nth(const Hdf5Attributes& attributes, const std::string& key, std::size_t which) {
  const auto list = attributes.lists.find(key);
  if (list != attributes.lists.end())
    return which < list->second.size() ? list->second[which] : std::string();
  const auto text = attributes.texts.find(key);
  return which == 0 && text != attributes.texts.end() ? text->second : std::string();
}

void take_igor(Hdf5Array& array) {
  Hdf5Attributes& own = array.attributes;
  const auto scaling = own.number_lists.find("IGORWaveScaling");
  if (scaling == own.number_lists.end()) return;
  const std::vector<double>& rows = scaling->second;
  if (array.shape.empty() || rows.size() != 2 * (array.shape.size() + 1)) return;
  const std::string of_numbers = nth(own, "IGORWaveUnits", 0);
  if (!of_numbers.empty()) own.texts.emplace("units", of_numbers);
  const auto longest = std::ranges::max_element(array.shape);
  const auto row = static_cast<std::size_t>(std::distance(array.shape.begin(), longest)) + 1;
  const double step = rows[2 * row], start = rows[2 * row + 1];
  const std::string unit = nth(own, "IGORWaveUnits", row);
  const bool scaled = step != 1.0 || start != 0.0;
  if (unit.empty() ? scaled : datasets::conversion(unit, "s").has_value())
    state_clock(own, step, start, unit);
}

/// "second" of "Second", where it has no meaning as it is written.
std::string understood(const std::string& unit) {
  using datasets::Quantity;
  const Quantity written = datasets::quantity_of_unit(unit);
  return written == Quantity::unknown || written == Quantity::other ? lowered(unit) : unit;
}

std::optional<double> number(const Hdf5Attributes& attributes, const std::string& key) {
  const auto found = attributes.numbers.find(key);
  if (found == attributes.numbers.end() || !std::isfinite(found->second)) return std::nullopt;
  return found->second;
}

void take_keysight(const Hdf5Attributes& channel, Hdf5Array& array) {
  Hdf5Attributes& own = array.attributes;
  const auto step = number(channel, "XInc"), start = number(channel, "XOrg");
  if (!step || !start) return;
  const std::string along = understood(nth(channel, "XUnits", 0));
  if (along.empty() || datasets::conversion(along, "s")) {
    const bool segment = number(channel, "NumSegments").value_or(0.0) > 0.0;
    const auto of_segment = number(own, "SegmentedXOrg");
    state_clock(own, *step, segment ? of_segment.value_or(*start) : *start, along);
  }
  const std::string unit = understood(nth(channel, "YUnits", 0));
  if (!unit.empty()) own.texts.emplace("units", unit);
  const auto level = number(channel, "YInc"), zero = number(channel, "YOrg");
  const bool levels = array.numbers == ArrayNumbers::i16 || array.numbers == ArrayNumbers::i32;
  if (!levels || !level || !zero) return;
  own.numbers.emplace("scale_factor", *level);
  own.numbers.emplace("add_offset", *zero);
}

bool is_octave(const Hdf5Listing& listing, const std::string& group) {
  const auto found = listing.groups.find(group);
  return found != listing.groups.end() && found->second.numbers.contains("OCTAVE_NEW_FORMAT");
}

/// "/run/t" of "/run/value/t/value": what Octave's variables hold is called value.
std::string octave_name(const Hdf5Listing& listing, const std::string& path) {
  constexpr std::string_view value = "/value";
  std::string name;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < path.size(); begin = end) {
    end = std::min(path.find('/', begin + 1), path.size());
    const std::string_view part = std::string_view(path).substr(begin, end - begin);
    if (part != value || !is_octave(listing, path.substr(0, begin))) name += part;
  }
  return name;
}

/// Names of Octave's variables; those of letters are no numbers, and what kind each is nobody asks.
void take_octave(Hdf5Listing& listing) {
  std::set<std::string> letters;
  std::erase_if(listing.texts, [&](const auto& text) {
    const std::string group = text.first.substr(0, text.first.rfind('/'));
    if (!text.first.ends_with("/type") || !is_octave(listing, group)) return false;
    if (text.second.ends_with("string")) letters.insert(group + "/value");
    return true;
  });
  for (Hdf5Array& array : listing.arrays)
    if (const std::string name = octave_name(listing, array.path); name != array.path)
      array.shown_as = to_utf8(name);
  std::erase_if(listing.arrays, [&](const Hdf5Array& array) {
    if (!letters.contains(array.path)) return false;
    listing.skipped.push_back(fmt::format("'{}' (text)", array.shown_as));
    return true;
  });
}

}  // namespace

void state_programs_words(Hdf5Listing& listing) {
  take_octave(listing);
  take_pandas(listing);
  for (Hdf5Array& array : listing.arrays) {
    take_igor(array);
    const std::size_t end = array.path.rfind('/');
    if (end == 0 || end == std::string::npos || array.is_field()) continue;
    const auto group = listing.groups.find(array.path.substr(0, end));
    if (group != listing.groups.end()) take_keysight(group->second, array);
  }
}

}  // namespace impactrig::acquisition
