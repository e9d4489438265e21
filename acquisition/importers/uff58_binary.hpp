// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "acquisition/importers/uff58_data.hpp"

namespace impactrig::acquisition {

/// Points side by side.
class Uff58Binary {
 public:
  Uff58Binary(const TextFile& file, const Uff58Form& form, const Uff58Extent& extent)
      : file_(file),
        form_(form),
        extent_(extent),
        at_(extent.start) {}

  const char* at() const { return at_; }

  std::uint64_t skip(std::uint64_t points);

  Uff58Block read(std::size_t most, std::uint64_t& left);

 private:
  std::size_t point_bytes() const;

  double number(const char* p, std::size_t size) const;

  /// Takes points of several numbers apart.
  void divide(std::size_t points, Uff58Block& block) const;

  const TextFile& file_;
  const Uff58Form& form_;
  const Uff58Extent& extent_;
  const char* at_;
};

}  // namespace impactrig::acquisition
