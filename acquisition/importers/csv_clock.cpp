// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/csv_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "acquisition/importers/time_axis.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::Record;

namespace {

/// True for a number that may be a date as a spreadsheet or MATLAB counts days, in a column that is
/// called so.
bool may_count_days(std::string_view name, double first) {
  const std::string word = lowered(name);
  const bool date = std::ranges::any_of(
      std::array<std::string_view, 5>{"date", "datum", "timestamp", "time stamp", "zeitstempel"},
      [&](std::string_view begin) { return word.starts_with(begin); });
  const bool of_spreadsheet = first > 30000.0 && first < 70000.0;
  const bool of_matlab = first > 700000.0 && first < 770000.0;
  return date && (of_spreadsheet || of_matlab);
}

}  // namespace

datasets::UnitConversion time_conversion(const TextFile& file, const ColumnHead& head,
                                         std::optional<double> first, std::span<const double> times,
                                         Record& record) {
  std::string unit = head.unit;
  if (unit.empty() && lowered(head.name).starts_with("second")) unit = "s";
  if (unit.empty()) unit = unit_since_1970(first.value_or(0.0));
  if (unit != head.unit && !unit.empty() && unit != "s")
    record.warnings.push_back(
        fmt::format("the time column '{}' states no unit; by their size its numbers count {} since "
                    "1970 (--units states another)",
                    head.name, unit));
  const double step = times.size() > 1 ? times[1] - times[0] : 0.0;
  if (unit.empty() &&
      (may_count_days(head.name, first.value_or(0.0)) || may_count_days(first.value_or(0.0), step)))
    throw InputError(
        {.file = file.path()},
        fmt::format("the time column '{}' states no unit and begins with {:.9g}, which "
                    "may be a date in days, as spreadsheets and MATLAB count them, or "
                    "seconds: state it with --units (day or s in the column's place)",
                    head.name, *first));
  if (unit.empty()) {
    const bool states = head.name.ends_with(')') || head.name.ends_with(']');
    record.warnings.push_back(fmt::format(
        "the time column '{}' states no unit{}: it is taken as s (--units states another)",
        head.name, states ? " that is understood" : ""));
    unit = "s";
  }
  const auto conversion = datasets::conversion(unit, "s");
  if (!conversion)
    throw InputError(
        {.file = file.path()},
        fmt::format("the time column '{}' has the unit '{}', which is not one of time: "
                    "state it with --units",
                    head.name, unit));
  return *conversion;
}

void to_seconds(const TextFile& file, const ColumnHead& head,
                const datasets::UnitConversion& conversion, Column& column) {
  if (column.missing > 0)
    throw InputError(
        file.position(column.first_missing),
        fmt::format(
            "{}: a time is missing; state --time-column none and --sample-rate to do without "
            "this column",
            head.name));
  if (conversion.factor == 1.0 && conversion.offset == 0.0) return;
  // dividing keeps decimal digits where multiplying by 0.001 would not
  const double inverse = std::round(1.0 / conversion.factor);
  const bool divides = inverse >= 1.0 && std::abs(inverse * conversion.factor - 1.0) < 1e-15;
  for (double& time : column.values)
    time = (divides ? time / inverse : time * conversion.factor) + conversion.offset;
}

datasets::SampleClock clock_from_head(const TableHead& head, const CsvRoles& roles) {
  datasets::SampleClock clock;
  clock.start = head.start.value_or(0.0);
  clock.interval = head.increment ? *head.increment : head.interval.value_or(0.0);
  clock.start += roles.samples_before * clock.interval;
  return clock;
}

void compare_with_head(const TableHead& head, std::size_t rows, datasets::SampleClock& clock,
                       Record& record) {
  const auto stated = head.interval;
  if (!stated) return;
  const double deviation = std::abs(*stated - clock.interval);
  if (clock.uniform() && rows > 1) {
    // no further apart than the rounding of the times allows
    const double last = clock.time(rows - 1);
    const double rounding = 8.0 * std::numeric_limits<double>::epsilon() *
                            std::max(std::abs(clock.start), std::abs(last));
    if (deviation * static_cast<double>(rows - 1) <= rounding) clock.interval = *stated;
  }
  if (deviation > 1e-3 * *stated)
    record.warnings.push_back(
        fmt::format("the header states a sample interval of {:.9g} s but the time column steps by "
                    "{:.9g} s: the time column is used",
                    *stated, clock.interval));
}

}  // namespace impactrig::acquisition
