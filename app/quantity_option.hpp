// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace impactrig::app {

/// Of an option whose number is in a unit: it may also be typed with another, as "51.2 kHz" or
/// "5 ms". To be given to transform(), before what checks the number.
CLI::Validator with_unit(std::string unit);

}  // namespace impactrig::app
