// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "tests/acquisition/sigrok_bytes.hpp"

namespace impactrig::acquisition::tests {

/// A NumPy array as a file of its own; `descr` as Python writes it: "'<f8'".
inline std::string npy(const std::string& descr, const std::string& shape, const std::string& data,
                       bool by_columns = false, char version = 1) {
  std::string head = "{'descr': " + descr +
                     ", 'fortran_order': " + (by_columns ? "True" : "False") +
                     ", 'shape': " + shape + ", }";
  const std::size_t before = version == 1 ? 10 : 12;
  while ((before + head.size() + 1) % 64 != 0) head += ' ';
  head += '\n';
  const auto length = static_cast<std::uint32_t>(head.size());
  return std::string("\x93NUMPY") + version + '\0' +
         (version == 1 ? little(static_cast<std::uint16_t>(length)) : little(length)) + head + data;
}

/// A text as NumPy keeps it, in units of four bytes.
inline std::string utf32(const std::string& ascii, std::size_t length) {
  std::string bytes;
  for (std::size_t i = 0; i < length; ++i)
    bytes += little(static_cast<std::uint32_t>(i < ascii.size() ? ascii[i] : 0));
  return bytes;
}

inline std::vector<std::string> numpy_seeds() {
  const std::string six = little<double>({0.0, 1.5, 0.5, 2.5, 1.0, 3.5});
  return {
      npy("'<f8'", "(3, 2)", six),
      npy("'<f8'", "(3, 2)", six, true, 2),
      npy("[('t', '>f4'), (('title', 'shot'), '<i2', (2,)), ('s', [('q', '|u1')])]", "(2,)",
          std::string(18, '\1')),
      zip_archive({{"t.npy", npy("'<f8'", "(6,)", six)},
                   {"names.npy", npy("'<U2'", "(2,)", utf32("ab", 2) + utf32("c", 2)), true},
                   {"data.npy", npy("'<c16'", "(3,)", six), true},
                   {"fs.npy", npy("'<i8'", "()", little<std::int64_t>(1000))}}),
  };
}

}  // namespace impactrig::acquisition::tests
