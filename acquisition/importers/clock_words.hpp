// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

// What names say of times in files that have names but no convention for them (MAT, HDF5, the
// properties of TDMS).
namespace impactrig::acquisition {

/// Where the last '.' or '/' stands that is not within brackets at the end, as of "/run/v (m/s)".
std::size_t end_of_group(std::string_view name);

/// "fs" of "/run/fs_Hz" and "dt" of "run.dt (ms)", in lower case.
std::string last_word(std::string_view name);

// Of such words.
bool is_interval_word(std::string_view word);  ///< "dt"
bool is_rate_word(std::string_view word);      ///< "fs"
bool is_start_word(std::string_view word);     ///< "t0"

/// "us" of "run.time_us" and "N" of "/run/Force [N]"; "" where the name does not end so.
std::string unit_by_name(std::string_view name);

/// Whether an array is called what times are: "run.t", "Time".
bool is_named_as_time(std::string_view name);

/// The sample interval that a property of this name states, as "Sampling_Rate", "fs_Hz" or "dt
/// (ms)", as a number or a text that begins with one, with its unit or without [s, > 0]; none of
/// other names, and where it can be none.
std::optional<double> interval_by_name(std::string_view name, double value);
std::optional<double> interval_by_name(std::string_view name, std::string_view text);

}  // namespace impactrig::acquisition
