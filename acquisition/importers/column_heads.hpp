// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

/// What the head of a text file says about a column.
struct ColumnHead {
  std::string name;         ///< "" = none
  std::string unit;         ///< as the file spells it, without brackets; "" = none
  std::string description;  ///< from a sentence row ("deacceleration - kg"); "" = none
};

/// What the head of a text file says.
struct TableHead {
  std::vector<ColumnHead> columns;                ///< may be fewer or more than the table has
  std::map<std::string, std::string> attributes;  ///< "Sample Interval" -> "4e-11"
  std::optional<double> start;      ///< of a Start cell, as some oscilloscopes write it [s]
  std::optional<double> increment;  ///< likewise [s]
  std::optional<double> interval;   ///< stated by a key: "Sampling rate [kHz]" -> "51.2" [s]
  double level = 1.0;               ///< what a 1 in the columns stands for [their units]
  std::string unusable_clock;       ///< a key by which none is stated: "'fs' as '0'"; "" = none is
  std::string started;              ///< ISO 8601; "" = not known
  int names_line = 0;               ///< from 1; 0 = there is none
  int units_line = 0;               ///< from 1; 0 = there is none
  std::vector<std::string> warnings;
};

/// Reads names, units, sentences and key-value lines above a table; `text` holds its rows.
TableHead read_head(const TableLayout& layout, std::string_view text);

/// "Force [N]", "CH 1 (V)", "acceleration(g)", "t / s", "t/ms", "Time in ms", "Time, ms", "Time_ms"
/// and "Time" as name and unit; of "force_N" and "v_tip_mm_s" the unit, too, is left in the name.
/// All but brackets count only before a unit that is understood.
ColumnHead split_head(std::string_view cell);

/// "µs" of what is left of it where a file's text was read in another code page: "?s",
/// "Âµs". No other letter before a unit is beyond ASCII. Other units as they are.
std::string with_mu(const std::string& unit);
/// How `text` spells a unit that with_mu() mended; "" where it did not.
std::string spoilt_unit(std::string_view text, const std::string& unit);

/// "V" of "CH1:V" and "2e-8" of "Analog:2e-8", as some oscilloscopes write values of their header.
std::string_view without_channel(std::string_view value);

/// "Time", "t", "Zeit", ...: what a column of times may be called.
bool is_time_name(std::string_view name);

/// ASCII letters in lower case.
std::string lowered(std::string_view text);

/// What the letters that a name begins with say it is ("velocity_tip", "Kraft 1"), in English or
/// German; unknown where they are no such word.
datasets::Quantity quantity_of_first_word(std::string_view name);

}  // namespace impactrig::acquisition
