// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/csv_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::Record;

namespace {

/// The unit in which a number counts the time since 1970, so that it is in the years 2000 to 2060;
/// "" for numbers of other sizes, and for seconds.
std::string unit_since_1970(double time) {
  constexpr double year = 365.25 * 86400.0;
  for (const auto& [unit, seconds] : {std::pair{"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}})
    if (time * seconds > 30.0 * year && time * seconds < 90.0 * year) return unit;
  return {};
}

}  // namespace

datasets::UnitConversion time_conversion(const TextFile& file, const ColumnHead& head,
                                         std::optional<double> first, Record& record) {
  std::string unit = head.unit;
  if (unit.empty() && lowered(head.name).starts_with("second")) unit = "s";
  if (unit.empty()) unit = unit_since_1970(first.value_or(0.0));
  if (unit != head.unit && !unit.empty() && unit != "s")
    record.warnings.push_back(
        fmt::format("the time column '{}' states no unit; by their size its numbers count {} since "
                    "1970 (--units states another)",
                    head.name, unit));
  if (unit.empty()) {
    record.warnings.push_back(fmt::format(
        "the time column '{}' states no unit: it is taken as s (--units states another)",
        head.name));
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
