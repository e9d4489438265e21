// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "acquisition/recording_reader.hpp"

namespace impactrig::app {

/// Samples that a reading of what is wanted gives, of all channels.
std::uint64_t samples_of(const acquisition::RecordingHead& head,
                         const acquisition::Selection& wanted);

/// What is conditioned is held in memory, with a few copies of each channel: throws
/// datasets::InputError for more than 64 million samples. `remedy` says how to ask for less:
/// "--from and --to say which".
void refuse_too_many_to_condition(const std::string& path, std::uint64_t samples,
                                  std::string_view remedy);

}  // namespace impactrig::app
