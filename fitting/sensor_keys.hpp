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
/// "125 mm/s/V"), also as laboratories write it ("10 mV/m/s^2"); `recorded` becomes "V" or "pC".
datasets::UncertainValue read_sensitivity(TableReader& table, std::string_view physical,
                                          std::string& recorded);

/// A sensitivity in volts behind an amplifier of the key `gain`, which is there: of one in coulombs
/// "1 mV/pC", of one in volts (IEPE) the factor 10.
datasets::UncertainValue with_gain(TableReader& table, datasets::UncertainValue sensitivity,
                                   std::string_view recorded_unit);

[[noreturn]] void refuse_gain_without_sensitivity(const TableReader& table);

}  // namespace impactrig::fitting
