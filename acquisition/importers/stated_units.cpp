// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/stated_units.hpp"

#include <fmt/format.h>

#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

void check_stated_units(const std::vector<std::string>& units, std::size_t count,
                        std::string_view what, const std::string& path) {
  if (units.empty() || units.size() == count) return;
  datasets::SourcePosition place;
  place.file = path;
  throw datasets::InputError(
      place,
      fmt::format("{} unit{} stated but the file has {} {}{}", units.size(),
                  units.size() == 1 ? " is" : "s are", count, what,
                  units.size() < count ? ": state one for each, or nothing between two commas to "
                                         "leave what the file says"
                                       : ""));
}

void take_stated_units(const std::vector<std::string>& units, const std::string& path,
                       datasets::Record& record) {
  check_stated_units(units, record.channels.size(), "channels", path);
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (units[i].empty()) continue;
    record.channels[i].unit = units[i];
    record.channels[i].quantity = datasets::quantity_of_unit(units[i]);
  }
}

}  // namespace impactrig::acquisition
