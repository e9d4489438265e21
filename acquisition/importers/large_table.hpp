// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/csv_marked_rows.hpp"
#include "acquisition/importers/text_table.hpp"
#include "acquisition/recording_reader.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Files up to this size [bytes] are read whole at once: their rows are counted, and what a column
/// is, is decided by all of them.
constexpr std::size_t read_at_once = std::size_t{1} << 25;

/// Rows at the start of a larger file that say what its columns are.
constexpr std::size_t probed_rows = 100000;

/// For a head alone these rows take at most so many bytes, but two are read.
constexpr std::size_t probed_bytes = std::size_t{1} << 23;

/// A table of numbers in a text too large for memory: what its head and its first rows say.
struct LargeTable {
  std::shared_ptr<TextFile> file;
  TableLayout layout;
  std::vector<std::string> names;             ///< one a column
  Table first_rows{};                         ///< probed_rows of them; times not yet in seconds
  std::size_t first_bytes = 0;                ///< that they take
  std::optional<std::size_t> time{};          ///< the column of times
  std::function<void(Column&)> to_seconds{};  ///< makes seconds of it
  double stated_interval = 0.0;               ///< by the head, of these times [s]; 0: none
  datasets::SampleClock clock{};              ///< where there is no such column
  MarkedRows marked{};
  datasets::Record record{};           ///< channels without samples and clock
  std::vector<std::size_t> columns{};  ///< of the channels; beyond `names`: without values
  /// True: a column without a value in any row is a channel without samples, and a warning tells.
  bool empty_columns_end = false;
  /// Of samples, by the head, all of which are rows.
  std::optional<AnnouncedSamples> announced{};
  /// The last word on the clock of so many rows.
  std::function<void(std::uint64_t rows, datasets::SampleClock& clock, datasets::Record& record)>
      settle_clock{};

  /// Reads `first_rows`, once file, layout and names are known. Throws InputError where there is
  /// none.
  void read_first_rows(bool head_only);
};

/// Reads it by blocks. Rows and clock of the head are estimates from the first rows and the last,
/// or from the first alone where the text is_part(); what is read is what reading it whole would
/// give.
std::unique_ptr<RecordingReader> reader_of_large_table(LargeTable table);

}  // namespace impactrig::acquisition
