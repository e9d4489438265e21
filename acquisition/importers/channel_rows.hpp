// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/mapped_file.hpp"

namespace impactrig::acquisition {

class TextFile;

constexpr std::size_t most_channel_rows = 64;  ///< lines that may hold a channel each

/// Lines of a text that hold a channel each, as LabVIEW's "Write To Spreadsheet File" and NumPy's
/// savetxt() write arrays.
struct ChannelRows {
  /// Lines above that are remarks or titles, or that the user skips.
  std::vector<std::string_view> head;
  std::vector<std::string_view> rows;  ///< parts of the file's text
  char delimiter = '\t';               ///< ' ' = any run of blanks and tabs
  char decimal = '.';
};

/// Few lines of many numbers, behind a name and a unit at most; none where the text may be columns.
std::optional<ChannelRows> find_channel_rows(TextFile& file, const ImportOptions& options);

/// The text with a column for each of the rows: their cells as they are written, one line for each
/// sample. A large one is kept on the disk.
class TurnedRows {
 public:
  /// Throws datasets::FileError when what is too large for memory cannot be kept.
  TurnedRows(const TextFile& file, ChannelRows rows);

  std::string_view text() const { return on_disk_ ? on_disk_->bytes() : in_memory_; }

  /// Where a character of text() stands in the rows.
  const char* origin(const char* at) const;

  /// Gives back the memory of a part of text(); it may still be looked at.
  void release(const char* first, const char* last) const;

 private:
  ChannelRows rows_;
  std::string in_memory_;
  std::unique_ptr<MappedFile> on_disk_;
};

}  // namespace impactrig::acquisition
