// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace impactrig::acquisition {

/// A date, a time of day, or both, as a table states them.
struct DateTime {
  bool has_date = false;
  bool has_time = false;
  bool elapsed = false;       ///< a duration: time since a 0 that is not told
  bool before_zero = false;   ///< a clock's time with a sign, "-00:00:00.1"
  std::array<int, 3> date{};  ///< its numbers as they stand
  /// Days since 1970-01-01 with the day before the month, and with the month before the day. Both
  /// are the same where the text leaves no choice; none where it is no date or may be several (a
  /// year of two digits beside slashes or dashes).
  std::array<std::optional<std::int32_t>, 2> days{};
  std::int64_t nanoseconds = 0;  ///< since midnight, in UTC where the zone is stated
  std::int64_t period = 0;       ///< [ns] after which such times start again; 0: they do not
  std::optional<int> zone{};     ///< minutes east of UTC

  /// "2024-03-01T12:00:00.5+01:00" in the zone stated; "" where the day is not known.
  std::string iso() const;
};

/// Reads "2024-03-01 12:00:00.5", "2024-03-01T12:00:00,5Z", "20240301T120000.5", "01.03.2024
/// 12:00", "3/1/2024 1:00:00 PM", "01-Mar-2024 12:00:00", "12:00:00.5 01.03.2024", "12:00:00:500"
/// (three, six or nine digits) and "30:15.3" (minutes and seconds); blanks, quotes, commas,
/// semicolons, tabs and bars may stand between date and time; and durations as pandas ("0 days
/// 00:00:00.5") and MATLAB
/// ("0.5 sec") write them, and times of a clock before its zero ("-00:00:00.1"). A time is rounded
/// to nanoseconds. None for anything else.
std::optional<DateTime> date_time_in(std::string_view text);

/// Whole seconds as a clock counts them: since 1970 UTC, or, of less than 1e8 (1973), since another
/// time. None for anything else.
std::optional<DateTime> whole_seconds_in(std::string_view text);

/// A clock whose hour, minute and second are numbers of their own, and year, month and day before
/// them: three numbers or six. None where they are no such time.
std::optional<DateTime> clock_of_numbers(std::span<const double> numbers);

/// Seconds from one to the other. Times without a date start again after their period: one that is
/// before the first is of the next day (hour). Where day and month cannot be told apart and one
/// order gives less than twelve days, that is taken. None where both give more, or the year is not
/// clear and the dates differ, or one states what the other does not.
std::optional<double> seconds_between(const DateTime& from, const DateTime& to);

}  // namespace impactrig::acquisition
