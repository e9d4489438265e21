// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What a MAT-file of any version holds beside its arrays, by name.
struct MatFacts {
  std::function<std::optional<double>(const std::string&)> number;  ///< none: no single number
  std::function<std::string(const std::string&)> text;              ///< "" = there is none
};

/// Gives a channel of an array what programs that write MAT-files say of it elsewhere in the file,
/// where no clock was found by names:
///
/// - Simcenter Testlab: `x_values.start_value` and `x_values.increment` beside `y_values.values`,
///   in the unit of `x_values.quantity.label`. Of the unit of the values its label says too little.
/// - Brüel & Kjær PULSE: `File_Header.SampleFrequency`, as text, of `Channel_1_Data`, with
///   `SignalName` and `Unit` of `Channel_1_Header`.
void take_clock_of_program(const MatFacts& facts, datasets::Channel& channel,
                           datasets::Record& record);

}  // namespace impactrig::acquisition
