// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "acquisition/exporters/outgoing.hpp"

namespace impactrig::acquisition {

/// Opens a file that was just written and tells, one sentence each, what its head does not give
/// back: channels (a table has one that it takes for the time), names, units, clocks. Samples are
/// not looked at.
std::vector<std::string> not_read_back(const OutgoingRecording& recording, const std::string& path);

}  // namespace impactrig::acquisition
