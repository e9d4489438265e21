// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"

namespace impactrig::acquisition {

/// A part of a file, [first, last).
struct FilePart {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

/// An element at the top of a MAT-file of version 5.
struct MatElement {
  FilePart place;     ///< of the element with its tag
  FilePart packed{};  ///< of its deflated bytes, where it is compressed
  bool compressed = false;
};

/// A MAT-file with compressed arrays as if they were not: bytes() has what is needed to see which
/// arrays there are, the numbers of larger ones are inflated when they are copied, and not kept.
struct InflatedMat {
  std::unique_ptr<MappedFile> file;
  std::vector<FilePart> elements;  ///< in it
};

/// Throws datasets::InputError where more than 256 MB would have to be kept to see the arrays.
InflatedMat inflated_mat(std::unique_ptr<MappedFile> file, const std::vector<MatElement>& elements,
                         bool big_endian, const std::function<void(std::string)>& warn);

}  // namespace impactrig::acquisition
