// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/stored_numbers.hpp"

namespace impactrig::acquisition {

/// What the elements of a NumPy array are, or one field of theirs.
struct NumpyField {
  std::string name;          ///< "", "force", within records "sensor.force", of a list "shot:2"
  char kind = 'f';           ///< NumPy's letter: f, i, u, b, c, U, S, M, m, O, V
  std::uint64_t size = 0;    ///< [bytes]
  std::uint64_t offset = 0;  ///< within an element [bytes]
  bool big_endian = false;
};

/// The head of a NumPy array in a file (.npy).
struct NumpyHead {
  std::vector<NumpyField> fields;
  std::uint64_t element_size = 0;  ///< [bytes]
  bool by_columns = false;         ///< "Fortran order"
  std::vector<std::uint64_t> shape;
  std::uint64_t data = 0;  ///< offset of the first element
};

/// Reads a head at the cursor, which stands behind it then. `what` names the array in errors.
/// Source: NumPy, "A Simple File Format for NumPy Arrays" (NEP 1; versions 1 to 3). Throws
/// datasets::InputError.
NumpyHead read_numpy_head(ByteCursor& at, const std::string& what);

}  // namespace impactrig::acquisition
