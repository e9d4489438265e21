// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace impactrig::acquisition {

/// A file that appears under its name only when it is complete: path.part until finish(), removed
/// when that is not reached.
class OutputFile {
 public:
  /// Throws datasets::FileError, as every function here, when the file cannot be written.
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);

  template <typename... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(buffer_), format, std::forward<Args>(args)...);
    if (buffer_.size() > 1 << 16) flush();
  }

  /// Flushes, closes and renames.
  void finish();

 private:
  void flush();
  [[noreturn]] void fail();

  std::string path_;
  std::string part_;
  std::FILE* file_ = nullptr;
  fmt::memory_buffer buffer_;
};

}  // namespace impactrig::acquisition
