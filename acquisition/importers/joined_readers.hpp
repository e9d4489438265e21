// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "acquisition/recording_reader.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// One recording of the channels of several readers, in their order, each with its own clock.
/// `says` is what holds for all of them: title, attributes, warnings; its channels are not used.
/// Readers are read one after the other, those without a channel that is asked for not at all; what
/// one warns of is not said again for another.
std::unique_ptr<RecordingReader> join_readers(
    datasets::Record says, std::vector<std::unique_ptr<RecordingReader>> readers);

}  // namespace impactrig::acquisition
