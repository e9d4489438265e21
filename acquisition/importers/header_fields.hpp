// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "acquisition/importers/stored_numbers.hpp"
#include "datasets/record.hpp"

/// What the headers of binary recordings have in common: texts of a fixed width, numbers in single
/// precision, a clock, samples that may be cut off.
namespace impactrig::acquisition {

/// Channels of one file: more (segments of a sequence, as a rule) are an error.
inline constexpr std::uint64_t most_channels = 10000;

/// Text of a fixed width: up to the first NUL, without blanks around it, as UTF-8.
std::string fixed_text(std::string_view field);

/// A number that went through single precision as it was meant: of all numbers that round to the
/// same single precision the one with the fewest digits (9.99999972e-10 is 1e-9). A number that
/// needs double precision is left as it is.
double meant_by_float(double value);

/// An oscilloscope's input, written one way: "CH1", "Ch1", "1" and "C1" become "CH 1"; anything
/// else stays.
std::string input_name(std::string_view label);

/// Sets name and value unless the text is empty.
void set_attribute(datasets::Channel& channel, std::string_view name, std::string_view text);
void set_attribute(datasets::Record& record, std::string_view name, std::string_view text);

/// Unit and the quantity it stands for.
void set_unit(datasets::Channel& channel, std::string_view unit);

/// Attribute of a channel: what its file states as its clock and can be none, "a sample interval of
/// 0 s".
inline constexpr std::string_view unusable_clock = "unusable clock in file";

/// Sets that attribute where the interval, in a unit of time, is not a number above 0.
void tell_unusable_interval(datasets::Channel& channel, double interval, std::string_view unit);

/// Likewise of a rate [Hz].
void tell_unusable_rate(datasets::Channel& channel, double rate);

/// The clock, or, where `unit` is none of time, the abscissa. Numbers that cannot be are left out:
/// the interval is then 0.
void set_axis(datasets::Channel& channel, double start, double interval, std::string_view unit);

/// Scale and offset. Throws datasets::InputError when one of them is no number.
void set_scale(datasets::Channel& channel, double scale, double offset, const MappedFile& file,
               std::uint64_t place);

/// A scale of 0, by which every sample would be the offset, leaves the numbers as they are stored,
/// without a unit; a warning says so.
void undo_zero_scale(datasets::Channel& channel, datasets::Record& record);

/// "2022-04-12T13:31:47.25Z" of seconds since 1970 UTC; "" outside of the years 1970 to 2200.
std::string iso_time_utc(double seconds);

/// "2022-04-12T13:31:47.25"; "" when it is no date.
std::string iso_time(int year, int month, int day, int hour, int minute, double second);

/// Numbers side by side at `offset`, `announced` or as many as the file holds; a warning tells when
/// it holds fewer.
StoredNumbers numbers_at(const MappedFile& file, std::uint64_t offset, std::uint64_t announced,
                         NumberKind kind, bool big_endian, std::string_view channel,
                         datasets::Record& record);

/// The sentence of a recording that is cut off within its samples.
std::string cut_off(std::string_view channel, std::uint64_t there, std::uint64_t announced);

}  // namespace impactrig::acquisition
