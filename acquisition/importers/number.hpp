// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace impactrig::acquisition {

/// How numbers are spelled in a text file.
struct NumberStyle {
  char decimal = '.';    ///< '.' or ','
  bool fortran = false;  ///< also "1.5+100": an exponent whose letter gave way to its third digit
};

namespace detail {

/// The general and slow way; `scan_number` found the extent [first, last).
bool convert_number(std::string_view text, NumberStyle style, double& value);

inline bool is_digit(char c) {
  return static_cast<unsigned char>(c - '0') < 10;
}

/// 10^0 ... 10^22 are the powers of ten that are exact in double precision.
inline constexpr double powers_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                           1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                           1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// Reads an exponent such as "E-05", "d+3" or (Fortran) "+100" at p and returns its end, or p.
inline const char* scan_exponent(const char* p, const char* last, bool fortran, int& exponent) {
  const char* q = p;
  if (q == last) return p;
  const char letter = static_cast<char>(*q | 0x20);
  if (letter == 'e' || letter == 'd') {
    ++q;
  } else if (!(fortran && (*q == '+' || *q == '-'))) {
    return p;
  }
  bool negative = false;
  if (q != last && (*q == '+' || *q == '-')) negative = *q++ == '-';
  if (q == last || !is_digit(*q)) return p;
  int magnitude = 0;
  for (; q != last && is_digit(*q); ++q)
    if (magnitude < 100000) magnitude = 10 * magnitude + (*q - '0');
  exponent = negative ? -magnitude : magnitude;
  return q;
}

}  // namespace detail

/// Reads the number that begins at `first` (sign, digits, decimal mark, exponent with E or D; no
/// blanks before) and returns the end of it, or `first` when there is none or it does not fit a
/// double. The value is correctly rounded.
///
/// Up to 2^53 as an integer and 22 as a power of ten, mantissa and power are exact and one IEEE
/// operation rounds once [Clinger1990]; everything else goes to std::from_chars.
inline const char* scan_number(const char* first, const char* last, NumberStyle style,
                               double& value) {
  const char* p = first;
  bool negative = false;
  if (p != last && (*p == '-' || *p == '+')) negative = *p++ == '-';
  std::uint64_t mantissa = 0;
  const char* const digits = p;
  while (p != last && detail::is_digit(*p))
    mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
  auto n_digits = p - digits;
  std::ptrdiff_t n_decimals = 0;
  if (p != last && *p == style.decimal) {
    const char* const decimals = ++p;
    while (p != last && detail::is_digit(*p))
      mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
    n_decimals = p - decimals;
    // "5," is no number in a file with decimal commas: the comma is then a list's
    if (n_decimals == 0 && style.decimal == ',') return first;
    n_digits += n_decimals;
  }
  if (n_digits == 0) return first;
  int exponent = 0;
  p = detail::scan_exponent(p, last, style.fortran, exponent);
  const std::ptrdiff_t power = exponent - n_decimals;
  // 18 digits cannot overflow the mantissa; 22: see powers_of_ten
  if (n_digits <= 18 && mantissa <= (std::uint64_t{1} << 53) && power >= -22 && power <= 22) {
    const double magnitude = power < 0
                                 ? static_cast<double>(mantissa) / detail::powers_of_ten[-power]
                                 : static_cast<double>(mantissa) * detail::powers_of_ten[power];
    value = negative ? -magnitude : magnitude;
    return p;
  }
  const std::string_view text(first, static_cast<std::size_t>(p - first));
  return detail::convert_number(text, style, value) ? p : first;
}

/// The number a text consists of, blanks around it allowed; none when it is anything else.
std::optional<double> number_in(std::string_view text, NumberStyle style = {});

/// The difference of two numbers as they are written, `text` minus `from`, rounded once; none where
/// one is no number or has too many digits. Numbers that share their first digits, as times since
/// 1970 do, lose nothing of it.
std::optional<double> decimal_difference(std::string_view text, std::string_view from,
                                         NumberStyle style = {});

/// The integer a text consists of, blanks around it allowed.
std::optional<long> integer_in(std::string_view text);

/// Without blanks, tabs, line ends and NULs at both ends.
std::string_view trimmed(std::string_view text);

}  // namespace impactrig::acquisition
