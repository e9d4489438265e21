// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace impactrig::datasets {

/// A unit as a laboratory writes it ("[ m/s² ]", "mm/sec (peak)", "мм/с"), as UDUNITS-2 may read
/// it: with and without what stands in parentheses at its end. Empty where no unit can be meant.
std::vector<std::string> spellings_of(std::string_view unit);

/// "gravity" for "g" and "lbf" for "lb": what UDUNITS-2 takes for masses, as laboratories may mean
/// them. The same text where there is none.
std::string with_weights_for_masses(std::string_view spelling);

/// "in/sec" of "IN/SEC": many a universal file has units in capitals alone. "" where there is no
/// such text; "NM" may be a torque.
std::string in_small_letters(std::string_view unit);

/// "um/m", "strain", "ue": ratios that are strains, whatever UDUNITS-2 takes them for.
bool is_strain(std::string_view unit);

}  // namespace impactrig::datasets
