// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "datasets/record.hpp"
#include "datasets/units.hpp"

/// The code numbers of universal dataset 58, for its importer and its exporter. Source: SDRC's page
/// on dataset 58.
namespace impactrig::acquisition {

/// The quantity of a specific data type (8 displacement, 13 excitation force, ...); `unknown` for 0
/// and 1, `other` for what is none of ours.
datasets::Quantity uff58_quantity(int specific_data_type);

/// The specific data type of a quantity; 1 ("general") where the standard has none.
int uff58_type(datasets::Quantity quantity);

/// "time response" for 1; "function type 99" for what is not in the standard.
std::string uff58_function_name(int function_type);

/// The function type of such a name; 0 ("general function") where there is none.
int uff58_function(std::string_view name);

/// True when an abscissa is a time: by its specific data type 17, else by its unit, else by the
/// function's type.
bool uff58_is_time(int specific_data_type, int function_type, std::string_view unit);

/// E13.5 holds six digits of an increment. What does not survive that is repeated in id line 5, in
/// full precision: "clock: start -0.001 s, interval 1.52587890625e-05 s".
std::string uff58_exact_clock(const datasets::SampleClock& clock);

/// Reads such a line into a clock that agrees with it to six digits; false when there is none or it
/// disagrees.
bool uff58_read_exact_clock(std::string_view id_line, datasets::SampleClock& clock);

}  // namespace impactrig::acquisition
