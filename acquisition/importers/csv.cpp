// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/csv_columns.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/joined_readers.hpp"
#include "acquisition/importers/large_table.hpp"
#include "acquisition/importers/text_table.hpp"
#include "acquisition/importers/time_axis.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

/// Those of `columns` that increase in all rows without a gap: reads the file through.
std::vector<std::size_t> increasing_throughout(TextFile& file, const TableLayout& layout,
                                               const std::vector<std::string>& names,
                                               std::vector<std::size_t> columns) {
  constexpr std::size_t rows_at_once = 16384;
  RowReader rows(file, layout, names);
  std::vector<double> last(names.size(), -std::numeric_limits<double>::infinity());
  while (!rows.at_end() && !columns.empty()) {
    std::vector<bool> needed(names.size(), false);
    for (const std::size_t c : columns) needed[c] = true;
    rows.read_only(needed);
    const char* const start = rows.at();
    const Table piece = rows.read(rows_at_once);
    std::erase_if(columns, [&](std::size_t c) {
      if (piece.columns[c].missing > 0) return true;
      for (const double value : piece.columns[c].values)
        if (!(value > std::exchange(last[c], value))) return true;
      return false;
    });
    file.release(start, rows.at());
  }
  return columns;
}

/// What the head of a file and its first rows say.
struct CsvHead {
  CsvHead(const std::string& path, const ImportOptions& options)
      : file(path, options.head_only),
        layout(find_table(file, options)),
        head(read_head(layout)),
        marked(take_marked_rows(head)),
        // a delimiter at the end of each row ends the last cell; it begins another only where the
        // header names one
        columns(std::max(layout.cells, std::min(layout.written_cells, head.columns.size()))),
        heads(complete_heads(file, head, columns, options)) {
    for (std::size_t c = 0; c < columns; ++c) names.push_back(heads[c].name);
  }

  /// Decides by these rows what the columns are. `read_on`: they are the first rows only, and which
  /// columns are further times is for all to say.
  void settle(const Table& rows, const ImportOptions& options, bool read_on, Record& record) {
    record.attributes = head.attributes;
    for (const DateColumns& date : layout.dates) heads[date.last].unit = std::string("s");
    roles = find_roles(file, layout, head, heads, rows, options);
    if (read_on && !roles.named_times.empty())
      roles.take_further_times(increasing_throughout(file, layout, names, roles.named_times));
    record.warnings = head.warnings;
    if (const std::string rest = what_follows(file, layout); !rest.empty())
      record.warnings.push_back(rest);
    tell_of_dates_and_text(layout, heads, roles, record);
    take_units_of_keys(head, roles, layout.dialect.delimiter, heads);
    describe(layout, head, heads, roles, record);
  }

  TextFile file;
  TableLayout layout;
  TableHead head;
  MarkedRows marked;
  std::size_t columns;
  std::vector<ColumnHead> heads;  ///< may be more than columns
  std::vector<std::string> names;
  CsvRoles roles;
};

void tell_of_column_without_values(const ColumnHead& head, Record& record) {
  record.warnings.push_back(
      fmt::format("'{}' is named in the header but has no values", head.name));
}

/// The samples of a channel from its column.
void fill(const CsvHead& csv, Column&& column, Channel& channel, Record& record) {
  const std::size_t n = column.values.size();
  if (column.missing == n) {
    if (n > 0) record.warnings.push_back(fmt::format("'{}' has no value in any row", channel.name));
    channel.clock.times.clear();
    channel.raw = std::vector<double>{};
    return;
  }
  if (column.missing > 0)
    record.warnings.push_back(missing_values(csv.file, channel.name, column, n));
  channel.raw = std::move(column.values);
  channel.valid = std::move(column.valid);
}

/// The clock that a column of times stands for. What was said of another is not said again.
datasets::SampleClock clock_of_column(const CsvHead& csv, std::size_t column, Table& table,
                                      Record& record) {
  const ColumnHead& head = csv.heads[column];
  Column& times = table.columns[column];
  to_seconds(csv.file, head, time_conversion(csv.file, head, record), times);
  TimeAxis axis = time_axis(std::move(times.values));
  const bool said = std::ranges::find(record.warnings, axis.warning) != record.warnings.end();
  if (!axis.warning.empty() && !said) record.warnings.push_back(std::move(axis.warning));
  return std::move(axis.clock);
}

Record read_whole(CsvHead& csv, const ImportOptions& options) {
  Table table = read_table(csv.file, csv.layout, csv.names);
  Record record;
  csv.settle(table, options, false, record);
  const CsvRoles& roles = csv.roles;
  if (const std::string cut = cut_row(csv.file, table); !cut.empty())
    record.warnings.push_back(cut);

  datasets::SampleClock clock = clock_from_head(csv.head);
  if (roles.time) {
    clock = clock_of_column(csv, *roles.time, table, record);
    compare_with_head(csv.head, table.rows, clock, record);
  }
  for (std::size_t c = 0; c < csv.heads.size(); ++c) {
    if (std::ranges::find(roles.further_times, c) != roles.further_times.end())
      clock = clock_of_column(csv, c, table, record);
    if (!roles.is_channel(c)) continue;
    Channel channel = channel_of(csv.head, c, csv.heads[c], record);
    channel.clock = clock;
    if (c >= csv.columns) tell_of_column_without_values(csv.heads[c], record);
    fill(csv, c < csv.columns ? std::move(table.columns[c]) : Column{}, channel, record);
    mark_rows(csv.marked, c, 0, channel.size(), channel.valid);
    record.channels.push_back(std::move(channel));
  }
  return record;
}

/// The channels in columns from `first` on, before `end`, by the times of one column.
LargeTable table_of_clock(std::shared_ptr<CsvHead> csv, std::optional<std::size_t> time,
                          std::size_t first, std::size_t end, LargeTable table) {
  table.time = time;
  if (time) {
    const ColumnHead& head = csv->heads[*time];
    table.to_seconds = [csv, &head, conversion = time_conversion(csv->file, head, table.record)](
                           Column& times) { to_seconds(csv->file, head, conversion, times); };
  }
  if (time && time == csv->roles.time)
    table.settle_clock = [csv](std::uint64_t count, datasets::SampleClock& clock, Record& record) {
      compare_with_head(csv->head, count, clock, record);
    };
  for (std::size_t c = first; c < end; ++c) {
    if (!csv->roles.is_channel(c)) continue;
    table.record.channels.push_back(channel_of(csv->head, c, csv->heads[c], table.record));
    table.columns.push_back(c);
    if (c >= csv->columns) tell_of_column_without_values(csv->heads[c], table.record);
  }
  return table;
}

/// A large file: its first rows say what it holds, the rest is read by blocks.
std::unique_ptr<RecordingReader> open_large(std::shared_ptr<CsvHead> csv,
                                            const ImportOptions& options) {
  LargeTable table;
  table.file = std::shared_ptr<TextFile>(csv, &csv->file);
  table.layout = csv->layout;
  table.names = csv->names;
  table.read_first_rows(options.head_only);
  Record record;
  csv->settle(table.first_rows, options, !options.head_only, record);
  table.clock = clock_from_head(csv->head);
  table.marked = csv->marked;
  table.empty_columns_end = true;

  // one reader a clock, each with the columns up to the next one
  std::vector<std::size_t> ends = csv->roles.further_times;
  ends.push_back(csv->heads.size());
  std::vector<std::unique_ptr<RecordingReader>> readers;
  std::optional<std::size_t> time = csv->roles.time;
  std::size_t first = 0;
  for (const std::size_t end : ends) {
    readers.push_back(reader_of_large_table(table_of_clock(csv, time, first, end, table)));
    time = first = end;
  }
  auto reader = join_readers(std::move(record), std::move(readers));
  return options.head_only ? reader_of_head(reader->head()) : std::move(reader);
}

}  // namespace

int recognises_csv(std::string_view file_name, std::string_view head) {
  if (looks_like_utf16(head)) return 10;
  std::size_t strange = 0;
  for (const char c : head) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte == 0) return 0;
    if (byte < 0x20 && c != '\t' && c != '\r' && c != '\n' && c != '\f' && c != '\v') ++strange;
  }
  if (strange * 100 > head.size()) return 0;
  const std::string name = lowered(file_name);
  for (const std::string_view ending : {".csv", ".txt", ".tsv", ".dat", ".asc", ".prn"})
    if (name.ends_with(ending)) return 20;
  return head.find_first_of("0123456789") != std::string_view::npos ? 10 : 0;
}

std::unique_ptr<RecordingReader> open_csv(const std::string& path, const ImportOptions& options) {
  auto csv = std::make_shared<CsvHead>(path, options);
  if (csv->file.bytes().size() > read_at_once) return open_large(std::move(csv), options);
  return reader_of(read_whole(*csv, options));
}

std::unique_ptr<RecordingReader> open_csv_by_blocks(const std::string& path,
                                                    const ImportOptions& options) {
  return open_large(std::make_shared<CsvHead>(path, options), options);
}

}  // namespace impactrig::acquisition
