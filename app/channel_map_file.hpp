// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "acquisition/channel_map.hpp"

namespace impactrig::app {

/// Reads the map of a recording's channels (docs/importing.md). Throws datasets::FileError and
/// datasets::InputError with the key and its place.
acquisition::ChannelMap read_channel_map(const std::string& path);

}  // namespace impactrig::app
