// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/wide_integers.hpp"

#include <fmt/format.h>

namespace impactrig::acquisition {

std::string WideIntegers::warning(std::string_view name) const {
  if (beyond_ == 0) return {};
  return fmt::format(
      "'{}': {} {} beyond 2^53, where doubles do not hold every integer: {} rounded to 16 digits",
      name, beyond_, beyond_ == 1 ? "sample is" : "samples are",
      beyond_ == 1 ? "it is" : "they are");
}

}  // namespace impactrig::acquisition
