// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "datasets/record.hpp"
#include "datasets/units.hpp"
#include "fitting/toml_reader.hpp"

namespace impactrig::fitting {

// Keys of a sensor, which the rig file and the map of a recording's channels share. All throw
// datasets::InputError.

/// delay = "2(1) us", or { value = "2 us", uncertainty = "1 us" }; zero when absent.
datasets::Delay read_delay(TableReader& table);

/// A sensitivity as recorded unit (V or pC) a physical unit, stated either way round ("4 pC/N",
/// "125 mm/s/V"); `recorded` becomes "V" or "pC".
datasets::UncertainValue read_sensitivity(TableReader& table, std::string_view physical,
                                          std::string& recorded);

/// A sensitivity in coulombs made one in volts by the key `gain`.
datasets::UncertainValue with_gain(TableReader& table, datasets::UncertainValue sensitivity);

[[noreturn]] void refuse_gain_without_sensitivity(const TableReader& table);

}  // namespace impactrig::fitting
