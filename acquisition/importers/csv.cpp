// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "acquisition/importers/channel_rows.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/csv_clock.hpp"
#include "acquisition/importers/csv_columns.hpp"
#include "acquisition/importers/csv_marked_rows.hpp"
#include "acquisition/importers/csv_roles.hpp"
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

constexpr std::size_t rows_at_once = 16384;

/// Where columns of times end before the rows do: at their first cell without one.
using TimeEnds = std::map<std::size_t, const char*>;

/// Those of `columns` that increase in all rows, up to their end if they have one, and the ends of
/// these and of `time`: reads the file through.
std::pair<std::vector<std::size_t>, TimeEnds> increasing_throughout(
    TextFile& file, const TableLayout& layout, const std::vector<std::string>& names,
    std::size_t time, std::vector<std::size_t> columns) {
  RowReader rows(file, layout, names);
  std::vector<double> last(names.size(), -std::numeric_limits<double>::infinity());
  TimeEnds ends;
  bool gap_in_time = false;
  /// False where the column does not increase, or goes on after a gap.
  const auto goes_on = [&](std::size_t c, const Column& piece) {
    bool increases = true;
    for (const double value : piece.values) {
      if (std::isnan(value))
        ends.try_emplace(c, piece.first_missing);
      else if (ends.contains(c))
        return false;
      else
        increases = value > std::exchange(last[c], value) && increases;
    }
    return increases || c == time;
  };
  while (!rows.at_end() && !columns.empty()) {
    std::vector<bool> needed(names.size(), false);
    needed[time] = true;
    for (const std::size_t c : columns) needed[c] = true;
    rows.read_only(needed);
    const char* const start = rows.at();
    const Table piece = rows.read(rows_at_once);
    if (!gap_in_time) gap_in_time = !goes_on(time, piece.columns[time]);
    std::erase_if(columns, [&](std::size_t c) {
      const bool drop = !goes_on(c, piece.columns[c]);
      if (drop) ends.erase(c);
      return drop;
    });
    file.release(start, rows.at());
  }
  if (gap_in_time || columns.empty()) ends.erase(time);
  return {std::move(columns), std::move(ends)};
}

/// True for times of which a step has fewer than three digits left in double precision.
bool rounds_steps(const Column& times) {
  if (times.values.size() < 2 || std::isnan(times.values.front())) return false;
  const double first = times.values.front();
  const std::size_t last = samples_before_end(times);
  if (last < 2) return false;
  const double step = (times.values[last - 1] - first) / static_cast<double>(last - 1);
  return std::abs(first) * std::numeric_limits<double>::epsilon() > 1e-3 * std::abs(step);
}

/// Octave writes one variable under the other, and of sparse matrices the places of their numbers
/// beside them.
void refuse_other_variables(const TextFile& file, std::string_view text) {
  if (!text.starts_with("# Created by Octave")) return;
  if (const std::size_t type = text.find("\n# type: sparse"); type != text.npos)
    throw InputError(file.position(text.data() + type + 1),
                     "a sparse matrix is no recording: save it as full(...) with -v7 in Octave");
  constexpr std::string_view begin = "\n# name: ";
  const std::size_t first = text.find(begin);
  const std::size_t next = first == text.npos ? first : text.find(begin, first + 1);
  if (next != text.npos)
    throw InputError(file.position(text.data() + next + 1),
                     "another variable begins here, and Octave's text format is read with one "
                     "alone: save them with -v7 in Octave");
}

/// Makes columns of lines that hold a channel each. The lines tell their dialect better than a few
/// columns.
struct Turned {
  Turned(TextFile& file, const ImportOptions& given) : options(given) {
    const std::string_view text = file.text();
    refuse_other_variables(file, text);
    constexpr auto few = static_cast<std::ptrdiff_t>(most_channel_rows);
    if (file.is_part() && std::ranges::count(text, '\n') <= few) file.want_whole();
    auto rows = find_channel_rows(file, given);
    if (!rows) return;
    channel_rows = rows->rows.size();
    options.delimiter = rows->delimiter;
    options.decimal = rows->decimal;
    file.turn(std::move(*rows));
  }

  ImportOptions options;
  std::size_t channel_rows = 0;  ///< of the file; 0 of columns
};

/// What the head of a file and its first rows say.
struct CsvHead {
  CsvHead(const std::string& path, const ImportOptions& options)
      : file(path, options.head_only, options.encoding),
        turned(file, options),
        layout(find_table(file, turned.options)),
        head(read_head(layout, text_of_rows(file, layout))),
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
    for (const DateColumns& date : layout.dates) {
      heads[date.last].unit = std::string("s");
      if (date.fraction > 0) heads[date.last].name = heads[date.last - 1].name;
    }
    roles = find_roles(file, layout, head, heads, rows, options);
    if (!roles.time && !roles.index && !head.interval) find_unusable_times();
    if (!roles.named_times.empty()) find_ends_of_times(rows, read_on);
    refuse_long_table(file, layout, text_of_rows(file, layout), heads, roles);
    record.warnings = head.warnings;
    if (!turned.options.delimiter && !turned.options.decimal)
      if (std::string commas =
              commas_that_may_be_decimal_marks(layout, head, text_of_rows(file, layout));
          !commas.empty())
        record.warnings.push_back(std::move(commas));
    tell_of_times(heads, roles, record);
    if (const std::string above = table_above(file, layout); !above.empty())
      record.warnings.push_back(above);
    if (const std::string rest = what_follows(file, layout); !rest.empty())
      record.warnings.push_back(rest);
    if (const std::string cut = cut_number(file, layout); !cut.empty())
      record.warnings.push_back(cut);
    tell_of_dates_and_text(layout, heads, roles, record);
    if (record.started.empty()) record.started = head.started;
    take_units_of_keys(head, roles, layout.dialect.delimiter, heads);
    describe(layout, head, heads, roles, record);
    if (turned.channel_rows > 0) tell_of_channel_rows(record);
  }

  /// Times in what is no unit of time: why there is no clock.
  void find_unusable_times() {
    for (const ColumnHead& column : heads)
      if (head.unusable_clock.empty() && is_time_name(column.name) && !column.unit.empty())
        head.unusable_clock = fmt::format("'{}' in '{}'", column.name, column.unit);
  }

  void tell_of_channel_rows(Record& record) const {
    for (const char* line : {"column names", "unit row", "first data line"})
      record.attributes.erase(line);
    record.attributes["channels in"] = "rows";
    const std::size_t channel_rows = turned.channel_rows;
    record.warnings.push_back(fmt::format(
        "the file is {} {} of many numbers: {} taken for a channel{}, not for a sample",
        channel_rows, channel_rows == 1 ? "line" : "lines", channel_rows == 1 ? "it is" : "each is",
        channel_rows == 1 ? "" : " (or the times of the others)"));
  }

  /// True where times are so large that doubles round what is between them: they are to be read
  /// again, counted from the first one.
  bool count_times(const Table& rows, Record& record) {
    if (!layout.counted.empty() || head.interval) return false;
    for (const ClockColumns& range : roles.clocks(heads.size())) {
      if (!range.time || layout.dates_at(*range.time) != nullptr) continue;
      const std::string_view first = first_cell(*range.time);
      if (!rounds_steps(rows.columns[*range.time]) || !decimal_difference(first, first, style()))
        continue;
      layout.counted.push_back({*range.time, first});
      record.warnings.push_back(fmt::format(
          "'{}' begins at {}, too far from 0 for its steps: times are counted from there",
          heads[*range.time].name, to_utf8(first)));
    }
    return !layout.counted.empty();
  }

  /// Where a row holds a sample of each channel.
  std::optional<AnnouncedSamples> announced() const {
    if (layout.key_cells > 0 || turned.channel_rows > 0 || !roles.further_times.empty()) return {};
    return announced_samples(head, layout.dialect);
  }

  NumberStyle style() const { return {layout.dialect.decimal, false}; }

  std::string_view first_cell(std::size_t column) {
    const std::string_view text = text_of_rows(file, layout);
    const char* at = layout.data;
    const auto cells = cells_of(take_line(at, text.data() + text.size()), layout.dialect.delimiter);
    const std::size_t cell = column + layout.key_cells;
    return cell < cells.size() ? cells[cell] : std::string_view{};
  }

  void find_ends_of_times(const Table& rows, bool read_on) {
    if (read_on) {
      auto [increasing, ends] =
          increasing_throughout(file, layout, names, *roles.time, roles.named_times);
      roles.take_further_times(std::move(increasing));
      if (!roles.further_times.empty()) time_ends = std::move(ends);
      return;
    }
    if (roles.further_times.empty()) return;
    for (const ClockColumns& range : roles.clocks(heads.size()))
      if (const Column& times = rows.columns[*range.time];
          times.missing > 0 && samples_before_end(times) > 0)
        time_ends[*range.time] = times.first_missing;
  }

  TextFile file;
  Turned turned;
  TableLayout layout;
  TableHead head;
  MarkedRows marked;
  std::size_t columns;
  std::vector<ColumnHead> heads;  ///< may be more than columns
  std::vector<std::string> names;
  CsvRoles roles;
  TimeEnds time_ends;  ///< where there are further times
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

void tell_of_values_without_time(const std::string& name, std::size_t count, Record& record) {
  if (count > 0)
    record.warnings.push_back(fmt::format("'{}': {} {} behind the last of its times {} left out",
                                          name, count, count == 1 ? "value" : "values",
                                          count == 1 ? "is" : "are"));
}

/// Leaves of a column, of times or of a channel, what has a time.
void end_column(std::size_t samples, Column& column) {
  column.values.resize(samples);
  if (column.valid.empty()) return;
  column.valid.resize(samples);
  column.missing = static_cast<std::size_t>(std::ranges::count(column.valid, 0));
  if (column.missing == 0) column.valid.clear();
}

std::size_t count_values(std::span<const double> values) {
  return static_cast<std::size_t>(
      std::ranges::count_if(values, [](double value) { return !std::isnan(value); }));
}

/// The clock that a column of times stands for. What was said of another is not said again.
datasets::SampleClock clock_of_column(CsvHead& csv, std::size_t column, Table& table,
                                      Record& record) {
  const ColumnHead& head = csv.heads[column];
  Column& times = table.columns[column];
  to_seconds(csv.file, head,
             time_conversion(csv.file, head, number_in(csv.first_cell(column), csv.style()),
                             times.values, record),
             times);
  const std::size_t rows = times.values.size();
  const bool of_head = column == csv.roles.time && csv.head.interval;
  TimeAxis axis = time_axis(std::move(times.values), of_head ? *csv.head.interval : 0.0);
  if (rows == 1 && of_head) {
    axis.clock.interval = *csv.head.interval;
    return std::move(axis.clock);
  }
  const bool said = std::ranges::find(record.warnings, axis.warning) != record.warnings.end();
  if (!axis.warning.empty() && !said) record.warnings.push_back(std::move(axis.warning));
  return std::move(axis.clock);
}

Record read_whole(CsvHead& csv, const ImportOptions& options) {
  Table table = read_table(csv.file, csv.layout, csv.names);
  const auto stated = announced_samples(csv.head, csv.layout.dialect);
  if (csv.layout.cut && stated && table.rows + 1 == stated->count) {  // the last is whole
    csv.layout.cut = nullptr;
    table = read_table(csv.file, csv.layout, csv.names);
  }
  Record record;
  csv.settle(table, options, false, record);
  if (csv.count_times(table, record)) table = read_table(csv.file, csv.layout, csv.names);
  const CsvRoles& roles = csv.roles;
  for (std::string told :
       {cut_row(csv.file, table), comment_between(csv.file, table), head_between(csv.file, table),
        remarks_behind(csv.file, table), missing_rows(csv.announced(), table.rows)})
    if (!told.empty()) record.warnings.push_back(std::move(told));

  const std::vector<ClockColumns> clocks = roles.clocks(csv.heads.size());
  for (const ClockColumns& range : clocks) {
    datasets::SampleClock clock = clock_from_head(csv.head, roles);
    std::size_t samples = table.rows;
    if (range.time) {
      if (csv.time_ends.contains(*range.time)) {
        samples = samples_before_end(table.columns[*range.time]);
        end_column(samples, table.columns[*range.time]);
      }
      clock = clock_of_column(csv, *range.time, table, record);
      if (range.time == roles.time) compare_with_head(csv.head, samples, clock, record);
    }
    for (std::size_t c = range.first; c < range.end; ++c) {
      if (!roles.is_channel(c)) continue;
      Channel channel = channel_of(csv.head, c, csv.heads[c], record);
      channel.clock = clock;
      if (c >= csv.columns) tell_of_column_without_values(csv.heads[c], record);
      Column column = c < csv.columns ? std::move(table.columns[c]) : Column{};
      if (samples < column.values.size()) {
        tell_of_values_without_time(
            channel.name, count_values(std::span(column.values).subspan(samples)), record);
        end_column(samples, column);
      }
      fill(csv, std::move(column), channel, record);
      mark_rows(csv.marked, c, 0, channel.size(), channel.valid);
      record.channels.push_back(std::move(channel));
    }
  }
  return record;
}

/// Ends a table before the line where its times end, and tells of values behind.
void end_table(CsvHead& csv, const ClockColumns& range, const char* end, bool head_only,
               LargeTable& table) {
  while (end > csv.layout.data && end[-1] != '\n') --end;
  table.layout.end = end;
  table.read_first_rows(head_only);
  if (head_only) return;
  RowReader rows(csv.file, csv.layout, csv.names);
  std::vector<bool> needed(csv.names.size(), false);
  for (const std::size_t c : table.columns)
    if (c < needed.size()) needed[c] = true;
  rows.read_only(needed);
  rows.seek(end);
  std::vector<std::size_t> counts(csv.names.size(), 0);
  while (!rows.at_end()) {
    const char* const start = rows.at();
    const Table piece = rows.read(rows_at_once);
    for (std::size_t c = 0; c < counts.size(); ++c)
      counts[c] += count_values(piece.columns[c].values);
    csv.file.release(start, rows.at());
  }
  for (std::size_t c = range.first; c < std::min(range.end, counts.size()); ++c)
    tell_of_values_without_time(csv.heads[c].name, counts[c], table.record);
}

/// The channels by the times of one column.
LargeTable table_of_clock(std::shared_ptr<CsvHead> csv, const ClockColumns& range,
                          LargeTable table) {
  const std::optional<std::size_t> time = range.time;
  table.time = time;
  if (time) {
    const ColumnHead& head = csv->heads[*time];
    const auto conversion =
        time_conversion(csv->file, head, number_in(csv->first_cell(*time), csv->style()),
                        table.first_rows.columns[*time].values, table.record);
    table.to_seconds = [csv, &head, conversion](Column& times) {
      to_seconds(csv->file, head, conversion, times);
    };
  }
  if (time && time == csv->roles.time) table.stated_interval = csv->head.interval.value_or(0.0);
  if (time && time == csv->roles.time)
    table.settle_clock = [csv](std::uint64_t count, datasets::SampleClock& clock, Record& record) {
      compare_with_head(csv->head, count, clock, record);
    };
  for (std::size_t c = range.first; c < range.end; ++c) {
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
  if (csv->count_times(table.first_rows, record)) {
    table.layout = csv->layout;
    table.read_first_rows(options.head_only);
  }
  table.clock = clock_from_head(csv->head, csv->roles);
  table.marked = csv->marked;
  table.empty_columns_end = true;
  table.announced = csv->announced();

  std::vector<std::unique_ptr<RecordingReader>> readers;  // one a clock
  for (const ClockColumns& range : csv->roles.clocks(csv->heads.size())) {
    LargeTable own = table_of_clock(csv, range, table);
    if (range.time)
      if (const auto found = csv->time_ends.find(*range.time); found != csv->time_ends.end())
        end_table(*csv, range, found->second, options.head_only, own);
    readers.push_back(reader_of_large_table(std::move(own)));
  }
  auto reader = join_readers(std::move(record), std::move(readers));
  return options.head_only ? reader_of_head(reader->head()) : std::move(reader);
}

}  // namespace

int recognises_csv(std::string_view file_name, std::string_view head) {
  if (looks_like_utf16(head)) return 10;
  const std::size_t padding = padding_of(head);
  if (padding > 0) head.remove_suffix(padding);
  if (padding > 0 && head.find_first_of("\r\n") == std::string_view::npos) return 0;
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
