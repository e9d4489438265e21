// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/number_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace impactrig::datasets {

std::string figures(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  double rounded = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return std::abs(rounded) >= std::pow(10.0, digits) && std::abs(rounded) < 1e6
             ? fmt::format("{:.0f}", rounded)
             : text;
}

std::string percent(double fraction) {
  return figures(100.0 * fraction, 2) + " %";
}

}  // namespace impactrig::datasets
