// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <type_traits>

#include "datasets/record.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition::tests::uff58 {

/// One dataset 58 from its parts; what a test does not name is a sound time record of a force in N.
struct Function {
  std::string identifier = "    58";
  std::string id1 = "Hammer";
  std::string date = "30-Apr-20 19:12:52";
  std::string id5 = "NONE";
  std::string dof =
      "    1         0    0         0 Stop               7  -3 NONE               0   0";
  int type = 2;
  long points = 3;
  int even = 1;
  std::string start = "  0.00000E+00";
  std::string increment = "  1.00000E-03";
  std::string abscissa = "        17    0    0    0 Time                 s                   ";
  std::string ordinate = "        13    0    0    0 Force                N                   ";
  std::string denominator = "         0    0    0    0 NONE                 NONE                ";
  std::string data = "  1.00000E+00 -2.00000E+00  3.00000E+00\n";
  std::string end = "    -1\n";

  std::string text() const {
    std::string out = "    -1\n" + identifier + "\n" + id1 + "\nNONE\n" + date + "\nNONE\n" + id5 +
                      "\n" + dof + "\n";
    out += fmt::format("{:10}{:10}{:10}{}{}  0.00000E+00\n", type, points, even, start, increment);
    out += abscissa + "\n" + ordinate + "\n" + denominator + "\n";
    out += "         0    0    0    0 NONE                 NONE                \n";
    return out + data + end;
  }
};

/// The identifier line of 58b.
inline std::string binary(int order, int format, long bytes) {
  return fmt::format("    58b{:6}{:6}{:12}{:12}     0     0           0           0", order, format,
                     11, bytes);
}

template <typename Number>
std::string bytes_of(std::initializer_list<Number> numbers, bool little) {
  std::string out;
  for (const Number number : numbers) {
    std::string raw(sizeof number, '\0');
    for (std::size_t i = 0; i < sizeof number; ++i) {
      const auto bits =
          std::bit_cast<std::conditional_t<sizeof number == 4, std::uint32_t, std::uint64_t>>(
              number);
      raw[little ? i : sizeof number - 1 - i] = static_cast<char>(bits >> (8 * i) & 0xFF);
    }
    out += raw;
  }
  return out;
}

/// "FILE:2:5 (byte 11)": where `mark` begins in a text, `offset` bytes on.
inline std::string place(const std::string& text, const std::string& mark, std::size_t offset = 0) {
  const std::size_t byte = text.find(mark) + offset;
  const std::string before = text.substr(0, byte);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  return fmt::format("FILE:{}:{} (byte {})", line, byte - (before.rfind('\n') + 1) + 1, byte);
}

inline datasets::Channel only_channel(const Function& function) {
  const datasets::Record record = imported(function.text());
  EXPECT_EQ(record.channels.size(), 1U);
  return record.channels.empty() ? datasets::Channel{} : record.channels.front();
}

}  // namespace impactrig::acquisition::tests::uff58
