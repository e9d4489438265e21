// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/importers/uff58_data.hpp"

namespace impactrig::acquisition {

/// Bytes of the parts of one point. Uneven double data have a single precision abscissa by the
/// standard (the field E13.5 is a float), but several writers store it in double precision too.
struct Uff58PointLayout {
  std::size_t abscissa = 0;
  std::size_t number = 4;
  std::size_t numbers = 1;

  std::size_t size() const { return abscissa + number * numbers; }
};

/// As the header has it, or with an abscissa as wide as the other numbers.
Uff58PointLayout uff58_point_layout(const Uff58Form& form, bool wide_abscissa);

/// What the announced points and bytes, which are there, make of an ordinate type that they
/// contradict: the other precision where nothing else fits. Throws datasets::InputError where that
/// may be wrong.
Uff58PointLayout settle_uff58_layout(const TextFile& file, const char* start, const Uff58Form& form,
                                     std::uint64_t length, const Uff58PointLayout& layout,
                                     std::vector<std::string>& warnings);

/// Whether the first values are no measured numbers as the identifier line says their bytes lie,
/// and all are with the bytes the other way round.
bool uff58_looks_reversed(const Uff58Extent& extent, bool little_endian);

}  // namespace impactrig::acquisition
