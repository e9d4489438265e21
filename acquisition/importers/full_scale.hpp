// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// Adds the channels of a sound file, "ch1", ..., whose samples are parts of full scale, and the
/// warning that their unit is not known. `of`: "a WAVE file".
void add_full_scale_channels(RecordingHead& head, std::string_view of, std::size_t channels,
                             std::uint64_t samples, double interval, double scale);

/// Whether a warning is that one: a map that states all full scales answers it.
bool tells_of_full_scale(std::string_view warning);

}  // namespace impactrig::acquisition
