// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/lvm_recording.hpp"
#include "acquisition/importers/lvm_text.hpp"

namespace impactrig::acquisition {

constexpr std::string_view lvm_first_word = "LabVIEW Measurement";
constexpr std::string_view lvm_end_of_header = "***End_of_Header***";

/// Cells of the header's lines by their key.
struct LvmHeader {
  std::map<std::string, std::vector<std::string_view>, std::less<>> lines;

  /// The cell of a column; for a key alone its first one that is not empty.
  std::string_view cell(std::string_view key, std::size_t column) const {
    const auto found = lines.find(key);
    return found != lines.end() && column < found->second.size() ? found->second[column]
                                                                 : std::string_view{};
  }

  std::string_view cell(std::string_view key) const {
    const auto found = lines.find(key);
    if (found == lines.end()) return {};
    for (std::size_t c = 1; c < found->second.size(); ++c)
      if (!found->second[c].empty()) return found->second[c];
    return {};
  }
};

/// Reads the header of a LabVIEW measurement file and those of its segments: how the cells are told
/// apart, the channels, and what becomes an attribute. Throws datasets::InputError.
class LvmHeads {
 public:
  /// All three must live as long.
  LvmHeads(LvmText& text, const ImportOptions& options, LvmRecording& recording)
      : text_(text),
        options_(options),
        recording_(recording) {}

  int special_blocks() const { return special_blocks_; }  ///< that were skipped

  void read_file_header();

  /// Empty lines, and special blocks, which are whatever a program wanted to keep.
  void skip_between();

  /// False when the file ends within the header; `number` is the segment's.
  bool read_segment_header(LvmHeader& header, int number);

  /// The time and the channels of a segment, from its header and the line of names behind it.
  void describe(const LvmHeader& header, LvmSegment& segment);

 private:
  /// "Separator<TAB>Tab" and "Separator,Comma" show it twice; the word decides.
  void find_separator(const char* start);
  void skip_special(const char* start);
  std::size_t y_column(std::size_t channel) const;
  /// Channels from the line of names; the header's lines have their values in the same columns.
  void name_columns(const LvmHeader& header, LvmSegment& segment);
  std::optional<double> finite(std::string_view cell) const;
  /// For files without Decimal_Separator: what the first numbers are written with.
  char decimal_of(const LvmHeader& header, std::size_t channels) const;

  LvmText& text_;
  const ImportOptions& options_;
  LvmRecording& recording_;
  int special_blocks_ = 0;
};

}  // namespace impactrig::acquisition
