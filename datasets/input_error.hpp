// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace impactrig::datasets {

/// A place in a file, as a text editor or a hex viewer counts it.
struct SourcePosition {
  std::string file;          ///< as the user named it
  std::uint32_t line = 0;    ///< from 1; 0 where lines mean nothing (binary, whole file)
  std::uint32_t column = 0;  ///< from 1; 0 where not known
  std::optional<std::uint64_t> byte = std::nullopt;  ///< from 0

  /// "run07.csv:12:9 (byte 431)", leaving out what is not known.
  std::string text() const;
};

/// Thrown by every reader of a file or a configuration: its content is not what it must be.
/// what() reads "run07.csv:12:9 (byte 431): velocity: expected a number, found 'n/a'": place, then
/// one sentence that says what was found, what was expected and, where it helps, what to do.
class InputError : public std::runtime_error {
 public:
  InputError(SourcePosition where, std::string_view problem);

  const SourcePosition& where() const noexcept { return where_; }

  const std::string& problem() const noexcept { return problem_; }

 private:
  SourcePosition where_;
  std::string problem_;
};

/// Thrown when a file cannot be opened, read or written: its content is not to blame.
class FileError : public std::runtime_error {
 public:
  FileError(std::string_view file, std::string_view problem);
};

}  // namespace impactrig::datasets
