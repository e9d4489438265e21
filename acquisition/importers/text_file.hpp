// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/importers/channel_rows.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/text_encoding.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

/// Bytes at the start of a large text that tell its head.
constexpr std::size_t telling_part = std::size_t{1} << 20;

/// A file's text, and what an error in it has to say about the place.
class TextFile {
 public:
  /// `head_only`: of a text too large for memory that would have to be rewritten, only the first
  /// lines are wanted. `code_page`: what is_code_page() knows; "" = UTF-8, UTF-16 or Windows-1252.
  /// Throws datasets::FileError when the file is missing, a directory or not readable.
  explicit TextFile(std::string path, bool head_only = false, std::string code_page = "");

  const std::string& path() const { return file_.path(); }

  /// The bytes as they are.
  std::string_view bytes() const { return file_.bytes(); }

  /// The text: without byte order mark and padding_of() it, line ends with \n, without quotes
  /// around whole lines, UTF-16 and a code page that is named turned into UTF-8 (a large one on the
  /// disk). Latin-1 is left as it is.
  /// Throws datasets::InputError for UTF-16 without a byte order mark.
  std::string_view text();

  /// Makes columns of lines that hold a channel each: text() is new then. Throws as TurnedRows.
  void turn(ChannelRows rows) { turned_ = std::make_unique<TurnedRows>(*this, std::move(rows)); }

  /// True where text() has only the first lines of the file.
  bool is_part() const { return expected_size_ > 0.0; }

  /// Not only the first lines are wanted.
  void want_whole() {
    head_only_ = false;
    text_.clear();
    expected_size_ = 0.0;
  }

  /// Where is_part(): what the last lines of the whole text are.
  std::string_view last_lines() const {
    return is_part() ? std::string_view(text_).substr(part_) : std::string_view();
  }

  /// Length of the whole text [bytes]: where text() is a part of it, as that lets expect.
  double expected_size() { return is_part() ? expected_size_ : static_cast<double>(text().size()); }

  /// Gives back the memory of a part of bytes() or of a text on the disk; it may still be looked
  /// at. Does nothing for a text in memory.
  void release(const char* first, const char* last) const;

  /// Copies a part of bytes(): for much, faster than looking at it.
  void copy(const char* first, std::size_t count, void* to) const {
    file_.copy(static_cast<std::size_t>(first - bytes().data()), count, to);
  }

  /// Line, column and byte of a character of text() or bytes(). Counts from the start of the file:
  /// for errors only.
  datasets::SourcePosition position(const char* at) const;
  /// The byte alone: after binary data, lines mean nothing.
  datasets::SourcePosition byte_position(const char* at) const;

 private:
  /// How the text is to be rewritten; none where it is a part of the bytes.
  std::optional<Rewriting> rewriting() const;

  /// The same but for quotes around whole lines.
  std::optional<Rewriting> rewriting_of_bytes() const;

  /// Where only the head is wanted: makes text_ the first and the last lines. False when the first
  /// line does not end soon enough.
  bool take_first_lines(const Rewriting& rewriting);

  MappedFile file_;
  std::size_t size_;  // without padding_of() it
  bool head_only_;
  std::string code_page_;
  double expected_size_ = 0.0;             // of the whole text, where text_ is a part of it
  std::string text_;                       // the text when it is not a part of the bytes
  std::size_t part_ = 0;                   // of it, where text() is a part
  std::unique_ptr<MappedFile> rewritten_;  // the same of a large one
  std::unique_ptr<TurnedRows> turned_;     // the text made of either, where rows were channels
};

/// The line that begins at `at`, without its end (\n or \r\n); `at` moves to the next line, at most
/// to `end`.
std::string_view take_line(const char*& at, const char* end);

/// The text up to the end of the last line that ends within `most` bytes; "" when none does.
std::string_view whole_lines(std::string_view text, std::size_t most);

/// Bytes of zero behind a text that is not UTF-16: what is left of a file whose writer had taken
/// room on the disk and was stopped.
std::size_t padding_of(std::string_view bytes);
std::size_t padding_of(const MappedFile& file);

}  // namespace impactrig::acquisition
