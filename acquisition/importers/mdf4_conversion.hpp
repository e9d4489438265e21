// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "acquisition/importers/mdf4_blocks.hpp"
#include "acquisition/importers/mdf4_records.hpp"

namespace impactrig::acquisition {

/// What a conversion (CC) makes of a number.
struct MdfConversion {
  double scale = 1.0;
  double offset = 0.0;
  MdfScaling function;  ///< instead of scale and offset where set
  std::string unit;
  std::string problem;  ///< why it cannot be applied
};

/// The conversion at a place: none, a straight line, a rational function, a formula, a table of
/// values or of ranges, whose upper ends depend on whether the numbers are `floating`. Texts, and
/// formulas that are not understood, are told as a problem. Throws datasets::InputError for damaged
/// ones.
MdfConversion read_mdf_conversion(MdfBlocks& blocks, std::uint64_t at, bool floating);

}  // namespace impactrig::acquisition
