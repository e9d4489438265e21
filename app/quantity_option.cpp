// SPDX-License-Identifier: BSD-3-Clause
#include "app/quantity_option.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "datasets/units.hpp"

namespace impactrig::app {

CLI::Validator with_unit(std::string unit) {
  return CLI::Validator(
      [unit = std::move(unit)](std::string& text) {
        double number = 0.0;
        if (CLI::detail::lexical_cast(text, number)) return std::string();
        try {
          text = fmt::format("{}", datasets::parse_quantity(text, unit).value);
          return std::string();
        } catch (const std::invalid_argument&) {
          return fmt::format("expected a number in {} or one with its unit, found {}", unit, text);
        }
      },
      "");
}

}  // namespace impactrig::app
