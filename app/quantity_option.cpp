// SPDX-License-Identifier: BSD-3-Clause
#include "app/quantity_option.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <stdexcept>
#include <utility>

#include "datasets/units.hpp"

namespace impactrig::app {
namespace {

std::optional<double> in_unit(const std::string& text, const std::string& unit) {
  try {
    return datasets::parse_quantity(text, unit).value;
  } catch (const std::invalid_argument&) {
    return {};
  }
}

}  // namespace

CLI::Validator with_unit(std::vector<std::string> units) {
  return CLI::Validator(
      [units = std::move(units)](std::string& text) {
        double number = 0.0;
        if (CLI::detail::lexical_cast(text, number)) return std::string();
        for (const std::string& unit : units) {
          const std::optional<double> value = in_unit(text, unit);
          if (!value) continue;
          text = fmt::format("{}", *value);
          return std::string();
        }
        return fmt::format("expected a number in {} or one with its unit, found {}",
                           fmt::join(units, ", "), text);
      },
      "");
}

}  // namespace impactrig::app
