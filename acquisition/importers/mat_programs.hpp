// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/importers/mat5.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Gives a channel of an array what programs that write MAT-files say of it elsewhere in the file,
/// where no clock was found by names:
///
/// - Simcenter Testlab: `x_values.start_value` and `x_values.increment` beside `y_values.values`,
///   in the unit of `x_values.quantity.label`. Of the unit of the values its label says too little.
/// - Brüel & Kjær PULSE: `File_Header.SampleFrequency`, as text, of `Channel_1_Data`, with
///   `SignalName` and `Unit` of `Channel_1_Header`.
void take_clock_of_program(const MatContents& contents, datasets::Channel& channel,
                           datasets::Record& record);

}  // namespace impactrig::acquisition
