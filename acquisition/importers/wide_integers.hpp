// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace impactrig::acquisition {

/// Integers of 64 bits that became doubles: counts those that a double may not hold exactly.
class WideIntegers {
 public:
  void look(std::span<const double> values) {
    constexpr double exact = 9007199254740992.0;  // 2^53
    for (const double value : values)
      if (std::abs(value) > exact) ++beyond_;
  }

  /// What there is to say of a channel; "" = nothing.
  std::string warning(std::string_view name) const;

 private:
  std::uint64_t beyond_ = 0;
};

}  // namespace impactrig::acquisition
