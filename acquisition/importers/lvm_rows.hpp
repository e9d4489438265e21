// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/lvm_recording.hpp"
#include "acquisition/importers/lvm_text.hpp"

namespace impactrig::acquisition {

/// Reads the rows of segments: their values, or only how many they are. Throws
/// datasets::InputError.
class LvmRows {
 public:
  /// Both must live as long.
  LvmRows(LvmText& text, LvmRecording& recording) : text_(text), recording_(recording) {}

  /// From here on samples are counted and not kept.
  void only_count() { counting_ = true; }

  /// False when something was met that counting does not tell.
  bool plain() const { return plain_; }

  const char* first() const { return rows_first_; }  ///< of the rows read last

  std::uint64_t count() const { return count_; }  ///< of the rows read last

  /// Rows until a line of text or the end of the file. An empty cell is no sample: the column ends,
  /// or a value is missing when it goes on below.
  void read(LvmSegment& segment);

  /// Reads the values that were counted; `use(row)` is told before each row, `take(channel, value)`
  /// of each value.
  template <typename Use, typename Take>
  void read_counted(const LvmSegment& segment, const Use& use, const Take& take);

 private:
  /// Whether the header announces rows behind this one: without a line end it may be cut within
  /// its last number.
  static bool is_within_packet(const LvmSegment& segment, std::uint64_t row);
  /// A line that begins with text: a header's key, a special block.
  bool ends_rows(std::string_view line) const;
  /// Rows of a packet when channels have different numbers of samples in it, else 0. Packets that
  /// follow without a header then leave cells empty that are not missing.
  std::uint64_t packet_length(const LvmSegment& segment) const;
  void read_row(std::string_view line, LvmSegment& segment, std::uint64_t packet, std::uint64_t row,
                std::vector<std::uint64_t>& due, NumberList<double>& x);
  /// Reads a cell; false when it is empty. `at` is left at the separator behind it.
  bool take_cell(const char*& at, const char* last, const LvmSegment& segment, std::size_t column,
                 double& value) const;
  std::string culprit(const LvmSegment& segment, std::size_t column) const;
  /// Puts a value where its row says: rows in which it was missing are filled up.
  void take_value(LvmPart& part, double value, double x, std::uint64_t place);
  /// The first X stands for all where they are counted.
  void count_value(LvmPart& part, double value, double x, std::uint64_t place);
  /// An empty cell takes its separator at least: what lacks more was never written by LabVIEW.
  void charge(std::uint64_t missing);
  void take_comment(const LvmSegment& segment, std::string_view cell, std::uint64_t row);
  void share_x(LvmSegment& segment, NumberList<double>&& x);
  /// The one X column is that of the first channel with the most samples; the others begin at their
  /// own X0.
  void shift_x(LvmSegment& segment);

  static constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

  LvmText& text_;
  LvmRecording& recording_;
  bool counting_ = false;
  bool plain_ = true;
  std::uint64_t count_ = 0;
  std::uint64_t x_rows_ = 0;  ///< with an X, where they are counted
  std::uint64_t filled_ = 0;  ///< values that were missing
  const char* rows_first_ = nullptr;
  const char* rows_last_ = nullptr;
};

template <typename Use, typename Take>
void LvmRows::read_counted(const LvmSegment& segment, const Use& use, const Take& take) {
  const std::size_t channels = segment.parts.size();
  std::uint64_t row = 0;
  for (const char* at = rows_first_; at != rows_last_;) {
    const std::string_view line = take_line(at, rows_last_);
    if (text_.blank(line)) continue;
    if (!use(row++, at)) return;
    const char* cell = line.data();
    const char* const last = line.data() + line.size();
    for (std::size_t column = 0; cell <= last; ++column, ++cell) {
      const bool is_x = text_.multi ? column % 2 == 0 : column == 0;
      const std::size_t channel = text_.multi ? column / 2 : column - 1;
      if (column > 0 && channel >= channels) break;
      double value = nothing;
      if (take_cell(cell, last, segment, column, value) && !is_x) take(channel, value);
    }
  }
}

}  // namespace impactrig::acquisition
