// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

/// Bytes that are made when they are wanted.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual void copy(std::size_t offset, std::size_t count, void* to) = 0;
  /// True where going back takes long.
  virtual bool only_forward() const = 0;
};

/// A file's bytes, mapped (or unpacked in memory): a page is read when it is looked at, and given
/// back by release().
class MappedFile {
 public:
  /// Throws datasets::FileError when the file is missing, a directory or not readable.
  explicit MappedFile(std::string path);
  /// An open file, which is closed with this; `path` is what errors name.
  MappedFile(std::string path, int file);
  /// Bytes that were unpacked from a file, with the file's name.
  MappedFile(std::string path, std::string unpacked);
  /// Bytes that `source` makes; `shown`, which it holds, has those of them that are looked at.
  MappedFile(std::string path, std::string_view shown, std::unique_ptr<ByteSource> source);
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

  /// How many bytes of zero it ends with. Takes little memory, and no time for what the file system
  /// knows to be a hole. Throws as copy().
  std::size_t zeros_at_end() const;

  /// True where channels are better copied one after another than by turns.
  bool only_forward() const { return source_ && source_->only_forward(); }

  /// The place of a byte, for errors.
  datasets::SourcePosition byte_position(std::size_t offset) const;

 private:
  void map_or_close();
  void map();
  std::size_t end_of_data() const;

  std::string path_;
  std::string unpacked_;
  std::unique_ptr<ByteSource> source_;
  int file_ = -1;
  const char* bytes_ = "";
  std::size_t size_ = 0;
};

}  // namespace impactrig::acquisition
