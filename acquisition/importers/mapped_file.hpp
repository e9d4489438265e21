// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

/// A file's bytes, mapped (or unpacked in memory): a page is read when it is looked at, and given
/// back by release().
class MappedFile {
 public:
  /// Throws datasets::FileError when the file is missing, a directory or not readable.
  explicit MappedFile(std::string path);
  /// Bytes that were unpacked from a file, with the file's name.
  MappedFile(std::string path, std::string unpacked);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const std::string& path() const { return path_; }

  std::string_view bytes() const { return {bytes_, size_}; }

  /// Gives back the memory of the pages that lie wholly within [first, last). They may still be
  /// looked at: they are then read again.
  void release(std::size_t first, std::size_t last) const;

  /// Copies bytes that lie in the file: for many, faster than looking at mapped pages, each of
  /// which the system has to find. Throws datasets::FileError when the file has become shorter.
  void copy(std::size_t offset, std::size_t count, void* to) const;

  /// The place of a byte, for errors.
  datasets::SourcePosition byte_position(std::size_t offset) const;

 private:
  void map();

  std::string path_;
  std::string unpacked_;
  int file_ = -1;
  const char* bytes_ = "";
  std::size_t size_ = 0;
};

}  // namespace impactrig::acquisition
