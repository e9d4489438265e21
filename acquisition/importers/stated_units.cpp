// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/stated_units.hpp"

#include <fmt/format.h>

#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

void take_stated_units(const std::vector<std::string>& units, const std::string& path,
                       datasets::Record& record) {
  if (units.size() > record.channels.size()) {
    datasets::SourcePosition place;
    place.file = path;
    throw datasets::InputError(
        place, fmt::format("{} units are stated but the file has {} channels", units.size(),
                           record.channels.size()));
  }
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (units[i].empty()) continue;
    record.channels[i].unit = units[i];
    record.channels[i].quantity = datasets::quantity_of_unit(units[i]);
  }
}

}  // namespace impactrig::acquisition
