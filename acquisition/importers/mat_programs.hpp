// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "acquisition/importers/named_arrays.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What a MAT-file of any version holds beside its arrays, by name.
struct MatFacts {
  std::function<std::optional<double>(const std::string&)> number;  ///< none: no single number
  std::function<std::string(const std::string&)> text;              ///< "" = there is none
};

/// Says of an array that it holds times where the program that wrote the MAT-file says so
/// elsewhere:
///
/// - catman, and what writes as it does: `Channel_1_Data` where `Unit` of `Channel_1_Header` is one
///   of time.
/// - Keysight Infiniium: `XInc` and `XOrg` in the unit of `XUnits`; no interval where that is
/// hertz.
/// - dSPACE ControlDesk: `X.Data`, or `X(1).Data`, beside `Y(1).Data`, ..., in the unit of
/// `X.Unit`.
void tell_times_of_program(const MatFacts& facts, NamedArray& array);

/// Gives a channel of an array what programs that write MAT-files say of it elsewhere in the file,
/// its clock where `no_clock` was found by names:
///
/// - Simcenter Testlab: `x_values.start_value` and `x_values.increment` beside `y_values.values`,
///   in the unit of `x_values.quantity.label`. Of the unit of the values its label says too little.
/// - Keysight Infiniium: `XOrg` and `XInc` in the unit of `XUnits`, which is hertz of a spectrum.
/// - Brüel & Kjær PULSE and catman: `SampleFrequency`, as text, of `Channel_1_Header` or else of
///   `File_Header`, of `Channel_1_Data`, with `SignalName` and `Unit` of `Channel_1_Header`.
/// - dSPACE ControlDesk: `Y(1).Name` of `Y(1).Data`.
void take_facts_of_program(const MatFacts& facts, bool no_clock, datasets::Channel& channel,
                           datasets::Record& record);

}  // namespace impactrig::acquisition
