// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <system_error>

#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

bool same_word(std::string_view cell, std::string_view lower) {
  return std::equal(cell.begin(), cell.end(), lower.begin(), lower.end(), [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == static_cast<unsigned char>(b);
  });
}

/// What stands for "no value": nothing, a dash, what meters show for it, not-a-number as C, MATLAB
/// and old Microsoft libraries print it.
bool is_missing(std::string_view cell) {
  if (cell.empty() || cell == "-" || same_word(cell, "n/a") || same_word(cell, "ol")) return true;
  if (cell.front() == '-' || cell.front() == '+') cell.remove_prefix(1);
  for (const std::string_view word :
       {"nan", "nan(ind)", "nan(snan)", "1.#qnan", "1.#ind", "#nan", "qnan"})
    if (same_word(cell, word)) return true;
  return false;
}

/// "+  25.0", as loggers write numbers of a fixed width.
std::optional<double> signed_before_blanks(std::string_view cell, char decimal) {
  if (cell.size() < 3 || (cell[0] != '+' && cell[0] != '-') || cell[1] != ' ') return std::nullopt;
  const std::string_view digits = trimmed(cell.substr(1));
  if (digits.front() == '+' || digits.front() == '-') return std::nullopt;
  const auto value = number_in(digits, {decimal, false});
  return value && cell[0] == '-' ? std::optional(-*value) : value;
}

/// "0x1F", as oscilloscopes write the lines of a logic pod.
std::optional<double> hexadecimal_in(std::string_view cell) {
  if (!cell.starts_with("0x") && !cell.starts_with("0X")) return std::nullopt;
  std::uint64_t lines = 0;
  const char* const end = cell.data() + cell.size();
  const auto read = std::from_chars(cell.data() + 2, end, lines, 16);
  return read.ec == std::errc{} && read.ptr == end ? std::optional(static_cast<double>(lines))
                                                   : std::nullopt;
}

/// "inf" in its spellings.
std::optional<double> infinity_in(std::string_view cell) {
  const bool negative = !cell.empty() && cell.front() == '-';
  if (!cell.empty() && (cell.front() == '-' || cell.front() == '+')) cell.remove_prefix(1);
  for (const std::string_view word : {"inf", "infinity", "1.#inf", "\u221E"})
    if (same_word(cell, word))
      return negative ? -std::numeric_limits<double>::infinity()
                      : std::numeric_limits<double>::infinity();
  return std::nullopt;
}

}  // namespace

std::string_view without_quotes(std::string_view cell) {
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
    cell.remove_prefix(1);
    cell.remove_suffix(1);
  }
  return trimmed(cell);
}

bool marks_missing(std::string_view cell) {
  std::string_view text = without_quotes(cell);
  if (text.empty()) return false;
  for (const char filling : {'-', '+', '*', '#', '?'})
    if (text.find_first_not_of(filling) == std::string_view::npos) return true;
  if (text.front() == '-' || text.front() == '+') text.remove_prefix(1);
  constexpr std::array<std::string_view, 24> words = {
      "ovl",         "ovld",       "ovf",       "ovfl",       "ovr",     "over",
      "overflow",    "overload",   "overrange", "over range", "under",   "underflow",
      "under range", "underrange", "clip",      "clipped",    "open",    "#n/a",
      "#nv",         "na",         "null",      "none",       "missing", "burnout"};
  return std::ranges::any_of(words, [&](std::string_view word) { return same_word(text, word); });
}

// SCPI-99, volume 1, 7.2.1.4 (infinity) and 7.2.1.5 (not a number)
bool stands_for_no_value(double value) {
  const double size = std::abs(value);
  return size == 9.9e37 || size == 9.91e37 || size == 9.99999e99;
}

namespace {

/// Digits in groups of three.
struct GroupedDigits {
  std::string_view separator;
  std::string digits;     ///< with the sign, without separators
  std::string_view rest;  ///< decimal mark and decimals, or nothing
};

std::optional<GroupedDigits> grouped_digits(std::string_view cell) {
  std::string_view rest = trimmed(without_quotes(cell));
  GroupedDigits found;
  if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) {
    if (rest.front() == '-') found.digits = '-';
    rest.remove_prefix(1);
  }
  const auto take_digits = [&] {
    std::size_t count = 0;
    while (count < rest.size() && detail::is_digit(rest[count])) ++count;
    found.digits += rest.substr(0, count);
    rest.remove_prefix(count);
    return count;
  };
  if (rest.starts_with('0')) return std::nullopt;
  const std::size_t first = take_digits();
  if (first == 0 || first > 3) return std::nullopt;
  constexpr std::array<std::string_view, 9> separators = {
      ",", ".", "'", " ", "\u2019", "\u00A0", "\u202F", "\u2009", "\xA0"};
  const auto* const separator = std::ranges::find_if(
      separators, [rest](std::string_view mark) { return rest.starts_with(mark); });
  if (separator == separators.end()) return std::nullopt;
  found.separator = *separator;
  while (rest.starts_with(found.separator)) {
    rest.remove_prefix(found.separator.size());
    if (take_digits() != 3) return std::nullopt;
  }
  found.rest = rest;
  if (rest.empty()) return found;
  const bool decimals = (rest.front() == '.' || rest.front() == ',') &&
                        rest.front() != found.separator.front() &&
                        std::ranges::all_of(rest.substr(1), detail::is_digit);
  return decimals ? std::optional(std::move(found)) : std::nullopt;
}

}  // namespace

bool has_thousands_separators(std::string_view cell) {
  return grouped_digits(cell).has_value();
}

std::optional<double> grouped_number_in(std::string_view cell, char decimal) {
  const auto grouped = grouped_digits(cell);
  if (!grouped || grouped->separator.front() == decimal) return std::nullopt;
  if (!grouped->rest.empty() && grouped->rest.front() != decimal) return std::nullopt;
  const bool may_be_decimal = grouped->separator == "," || grouped->separator == ".";
  if (may_be_decimal && grouped->rest.empty()) return std::nullopt;
  return number_in(grouped->digits + std::string(grouped->rest), {decimal, false});
}

std::optional<double> cell_value(std::string_view cell, char decimal) {
  const std::string_view text = without_quotes(cell);
  if (is_missing(text)) return nothing;
  if (const auto value = number_in(text, {decimal, false})) return value;
  if (const auto value = signed_before_blanks(text, decimal)) return value;
  if (const auto value = hexadecimal_in(text)) return value;
  constexpr std::string_view minus = "\u2212";  // as typography has it
  if (!text.starts_with(minus)) return infinity_in(text);
  const std::string usual = "-" + std::string(text.substr(minus.size()));
  const auto value = number_in(usual, {decimal, false});
  return value ? value : infinity_in(usual);
}

std::string delimiter_name(char delimiter) {
  switch (delimiter) {
    case ',':
      return "comma";
    case ';':
      return "semicolon";
    case '\t':
      return "tab";
    case ' ':
      return "blank";
    case '|':
      return "bar";
    default:
      return std::string(1, delimiter);
  }
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  const std::string_view blanks = " \t";
  std::size_t start = 0;
  bool quoted = false;
  if (delimiter == ' ') {
    line = trimmed(line);
    if (line.empty()) return cells;
  }
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    const bool ends = i == line.size() ||
                      (!quoted && (delimiter == ' ' ? blanks.find(line[i]) != std::string_view::npos
                                                    : line[i] == delimiter));
    if (!ends) continue;
    const std::string_view cell = line.substr(start, i - start);
    if (delimiter != ' ' || !cell.empty()) cells.push_back(without_quotes(trimmed(cell)));
    start = i + 1;
  }
  return cells;
}

}  // namespace impactrig::acquisition
