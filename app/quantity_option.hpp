// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace impactrig::app {

/// Of an option whose number is in `units` (of the first that fits, all SI): it may also be typed
/// with a unit, as "51.2 kHz" or "5 ms". To be given to transform(), before what checks the number.
CLI::Validator with_unit(std::vector<std::string> units);

}  // namespace impactrig::app
