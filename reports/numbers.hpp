// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/// How numbers look in a report: prefixes, rounding, ticks. All texts are UTF-8 and plain: no
/// markup.
namespace impactrig::reports {

/// A display unit: shown = factor * SI.
struct DisplayUnit {
  double factor = 1.0;
  std::string text;  ///< "µs"; "" when dimensionless
};

/// The SI prefix that brings `magnitude` (SI, >= 0) into [1, 1000), with kilo only from 2000 on,
/// where the unit takes one: "s", "N", "m/s", "N s", "J", not "1", "kg", "m^2". 0 and what is not
/// finite keep the unit.
DisplayUnit display_unit(double magnitude, std::string_view unit);

/// "m/s^2" -> "m/s²", "N s" -> "N·s", "1" -> "".
std::string pretty_unit(std::string_view unit);

/// Significant digits, no exponent between 1e-4 and 1e6, else "1.2·10⁻⁷"; true minus sign.
/// "–" for what is not finite: callers say why beside it.
std::string significant(double value, int digits);

/// With its unit: "343 µs".
std::string quantity(double value, std::string_view unit, int digits = 3);

/// A value with its standard error, both to two significant digits of the error.
struct RoundedValue {
  std::string value;
  std::string error;  ///< "" when there is none
  std::string unit;   ///< with prefix
};

/// `error` of 0 or not finite: four significant digits of the value and no error.
/// The prefix is that of the larger of value and error.
RoundedValue rounded(double value, double error, std::string_view unit);

/// `value` to the last place that two digits of `error` leave, in a given display unit.
std::string to_precision_of(double value, double error, const DisplayUnit& unit);

/// Numbers of one kind below each other: one unit, one number of decimals, so that they can be
/// compared at a glance. `digits` significant ones for the largest, "–" for what is not finite.
/// `at_least` [SI]: the unit is chosen as if the largest were this much.
struct NumberColumn {
  DisplayUnit unit;
  std::vector<std::string> cells;
};

NumberColumn number_column(const std::vector<double>& values, std::string_view unit, int digits,
                           double at_least = 0.0);

/// "23 %", "4.1 %", "0.31 %".
std::string percent(double fraction);

/// "1 537 024" with narrow no-break spaces.
std::string grouped(unsigned long long count);

/// Multiples of 1, 2 or 5 times a power of ten that span [low, high]: about `wanted` of them.
struct Ticks {
  std::vector<double> values;
  double step = 1.0;
  int decimals = 0;  ///< that show the step exactly
};

Ticks nice_ticks(double low, double high, int wanted);

/// "−0.5": a tick in the decimals of its axis.
std::string tick_text(double value, int decimals);

/// Indices, ascending, of what a plot `buckets` pixels wide needs: first and last sample, the
/// smallest and the largest of each bucket. All samples when there are at most 4 a bucket.
std::vector<std::size_t> min_max_indices(const std::vector<double>& values, std::size_t buckets);

}  // namespace impactrig::reports
