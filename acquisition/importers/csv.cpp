// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/csv_columns.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/text_table.hpp"
#include "acquisition/importers/time_axis.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

/// Files up to this size [bytes] are read whole at once: their rows are counted, and what a column
/// is, is decided by all of them.
constexpr std::size_t read_at_once = std::size_t{1} << 25;

/// Rows read and handed over at once of larger files.
constexpr std::size_t rows_at_once = 16384;

/// Rows at the start of a larger file that say what its columns are.
constexpr std::size_t probed_rows = 100000;

/// For a count of rows that is not known.
constexpr std::uint64_t any_number = ~std::uint64_t{0} >> 12;

/// What the head of a file and its first rows say.
struct CsvHead {
  CsvHead(const std::string& path, const ImportOptions& options)
      : file(path),
        layout(find_table(file, options)),
        head(read_head(layout)),
        marked(take_marked_rows(head)),
        // a delimiter at the end of each row ends the last cell; it begins another only where the
        // header names one
        columns(std::max(layout.cells, std::min(layout.written_cells, head.columns.size()))),
        heads(complete_heads(file, head, columns, options)) {
    for (std::size_t c = 0; c < columns; ++c) names.push_back(heads[c].name);
  }

  /// Decides by these rows what the columns are.
  void settle(const Table& rows, const ImportOptions& options, Record& record) {
    record.attributes = head.attributes;
    roles = find_roles(file, heads, rows, options);
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

Record read_whole(CsvHead& csv, const ImportOptions& options) {
  Table table = read_table(csv.file, csv.layout, csv.names);
  Record record;
  csv.settle(table, options, record);
  const CsvRoles& roles = csv.roles;
  if (const std::string cut = cut_row(csv.file, table); !cut.empty())
    record.warnings.push_back(cut);

  datasets::SampleClock clock = clock_from_head(csv.head);
  if (roles.time) {
    const ColumnHead& head = csv.heads[*roles.time];
    Column& times = table.columns[*roles.time];
    to_seconds(csv.file, head, time_conversion(csv.file, head, record), times);
    TimeAxis axis = time_axis(std::move(times.values));
    if (!axis.warning.empty()) record.warnings.push_back(std::move(axis.warning));
    clock = std::move(axis.clock);
    compare_with_head(csv.head, table.rows, clock, record);
  }
  for (std::size_t c = 0; c < csv.heads.size(); ++c) {
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

/// A large file: its first rows say what it holds, the rest is read by blocks.
class LargeCsv final : public RecordingReader {
 public:
  LargeCsv(std::unique_ptr<CsvHead> csv, const ImportOptions& options) : csv_(std::move(csv)) {
    const CsvRoles& roles = csv_->roles;
    Record& record = head_.record;
    RowReader rows(csv_->file, csv_->layout, csv_->names);
    Table probe = rows.read(probed_rows);
    csv_->settle(probe, options, record);
    if (roles.time) conversion_ = time_conversion(csv_->file, csv_->heads[*roles.time], record);
    estimate(probe, static_cast<std::size_t>(rows.at() - csv_->layout.data));
    for (std::size_t c = 0; c < csv_->heads.size(); ++c) {
      if (!roles.is_channel(c)) continue;
      record.channels.push_back(channel_of(csv_->head, c, csv_->heads[c], record));
      record.channels.back().clock = clock_;
      columns_.push_back(c);
      head_.samples.push_back(c < csv_->columns ? rows_ : 0);
      if (c >= csv_->columns) tell_of_column_without_values(csv_->heads[c], record);
    }
    head_.counted = false;
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    std::vector<Column> told(chosen.size());  // of each channel, what is missing; no values
    std::vector<std::size_t> columns;
    for (const std::size_t index : chosen) columns.push_back(columns_[index]);

    TimeAxisCheck check = expected_times(wanted);
    std::string cut;
    const std::uint64_t rows = pass(columns, wanted, [&](Table& piece, Piece part) {
      for (std::size_t i = 0; i < columns.size(); ++i)
        if (columns[i] < csv_->columns)
          hand_over(piece.columns[columns[i]], columns[i], part, i, told[i], sink);
      if (roles().time) check.add(part.of(piece.columns[*roles().time].values));
      if (cut.empty()) cut = cut_row(csv_->file, piece);
    });

    Record record = head_.record;
    record.channels.clear();
    if (!cut.empty()) record.warnings.push_back(cut);
    const datasets::SampleClock clock =
        settled_clock(wanted, check, rows, chosen.size(), sink, record);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      record.channels.push_back(head_.record.channels[chosen[i]]);
      record.channels.back().clock = clock;
      const std::string missing =
          missing_values(csv_->file, record.channels.back().name, told[i], rows);
      if (!missing.empty()) record.warnings.push_back(missing);
    }
    return record;
  }

 private:
  /// Rows [first, last) of a table.
  struct Piece {
    std::size_t first = 0;
    std::size_t last = 0;
    std::uint64_t row = 0;  ///< of the file, which row 0 of the table is

    template <typename T>
    std::span<const T> of(const std::vector<T>& values) const {
      return std::span<const T>(values).subspan(first, last - first);
    }
  };

  const CsvRoles& roles() const { return csv_->roles; }

  /// The time column in seconds.
  std::vector<double>& times_of(Table& table) const {
    const std::size_t time = *roles().time;
    to_seconds(csv_->file, csv_->heads[time], conversion_, table.columns[time]);
    return table.columns[time].values;
  }

  /// Rows and clock from the first rows and the last.
  void estimate(Table& probe, std::size_t probed_bytes) {
    const std::string_view text = csv_->file.text();
    const auto all = static_cast<double>(text.data() + text.size() - csv_->layout.data);
    const double share = static_cast<double>(probe.rows) / static_cast<double>(probed_bytes);
    rows_ = static_cast<std::uint64_t>(std::max(1.0, std::round(all * share)));
    clock_ = clock_from_head(csv_->head);
    if (!roles().time) return;
    const std::vector<double> first = times_of(probe);
    RowReader end(csv_->file, csv_->layout, csv_->names);
    end.seek(std::max(start_of_last_lines(text, 3), csv_->layout.data));
    Table last = end.read(3);
    first_ = first.front();
    last_ = last.rows > 0 ? times_of(last).back() : first.back();
    const double step = (first.back() - first_) / static_cast<double>(first.size() - 1);
    const double by_time = std::round((last_ - first_) / step) + 1.0;
    // rows grow longer with their numbers: where the times agree roughly, they count better
    if (std::abs(by_time / static_cast<double>(rows_) - 1.0) < 0.5)
      rows_ = static_cast<std::uint64_t>(by_time);
    TimeAxisCheck check(first_, first.back(), first.size());
    check.add(first);
    clock_ = check.axis().clock;
    if (rows_ > 1) clock_.interval = (last_ - first_) / static_cast<double>(rows_ - 1);
    sorted_ = std::ranges::is_sorted(first) && increases_throughout();
  }

  /// Looks at rows all over the file: times that go back anywhere for long are seen.
  bool increases_throughout() {
    constexpr std::size_t places = 256;
    const std::string_view text = csv_->file.text();
    const char* const end = text.data() + text.size();
    const auto bytes = static_cast<std::size_t>(end - csv_->layout.data);
    RowReader rows(csv_->file, csv_->layout, csv_->names);
    double before = first_;
    for (std::size_t i = 1; i < places; ++i) {
      const char* at = csv_->layout.data + bytes / places * i;
      take_line(at, end);
      rows.seek(at);
      Table row = rows.read(1);
      if (row.rows == 0) break;
      const double time = times_of(row).front();
      if (time < before) return false;
      before = time;
    }
    return last_ >= before;
  }

  static const char* start_of_last_lines(std::string_view text, int lines) {
    std::size_t at = text.size();
    while (at > 0 && (text[at - 1] == '\n' || text[at - 1] == '\r')) --at;
    for (; lines > 0 && at > 0; --lines) at = text.rfind('\n', at - 1);
    return text.data() + at + 1;
  }

  /// The times that are to be expected in the window.
  TimeAxisCheck expected_times(const Selection& wanted) const {
    const SampleRange range = samples_within(clock_, rows_, wanted);
    if (range.last == range.first) return {first_, first_, 0};
    if (range.first == 0 && range.last == rows_) return {first_, last_, rows_};
    return {clock_.time(range.first), clock_.time(range.last - 1), range.last - range.first};
  }

  /// Reads rows with these columns and the time, hands those in the window to `use` piece by piece,
  /// and returns how many they are.
  template <typename Use>
  std::uint64_t pass(const std::vector<std::size_t>& columns, const Selection& wanted,
                     const Use& use) {
    RowReader rows(csv_->file, csv_->layout, csv_->names);
    std::vector<bool> needed(csv_->columns, false);
    for (const std::size_t column : columns)
      if (column < csv_->columns) needed[column] = true;
    if (roles().time) needed[*roles().time] = true;
    rows.read_only(needed);
    const bool by_time = roles().time && wanted.has_window() && sorted_;
    // rows that are marked by their number have to be counted
    if (by_time && csv_->marked.empty()) rows.seek(row_before(wanted.from));
    std::uint64_t before = 0;
    std::uint64_t used = 0;
    while (!rows.at_end()) {
      const char* const start = rows.at();
      Table piece = rows.read(rows_at_once);
      Piece part{0, piece.rows, before};
      if (roles().time) {
        const std::vector<double>& times = times_of(piece);
        if (by_time) {
          part.first = static_cast<std::size_t>(std::ranges::lower_bound(times, wanted.from) -
                                                times.begin());
          part.last =
              static_cast<std::size_t>(std::ranges::upper_bound(times, wanted.to) - times.begin());
        }
      } else {
        const SampleRange range = samples_within(clock_, any_number, wanted);
        part.first =
            static_cast<std::size_t>(std::clamp(range.first, before, before + piece.rows) - before);
        part.last =
            static_cast<std::size_t>(std::clamp(range.last, before, before + piece.rows) - before);
      }
      part.last = std::max(part.first, part.last);
      const bool past = part.last < piece.rows && used + (part.last - part.first) > 0;
      if (part.last > part.first || piece.cut_row != nullptr) use(piece, part);
      used += part.last - part.first;
      before += piece.rows;
      csv_->file.release(start, rows.at());
      if (past) break;
    }
    return used;
  }

  /// The start of a row whose time is before `time`, not many rows away: times increase.
  const char* row_before(double time) {
    const std::string_view text = csv_->file.text();
    const char* low = csv_->layout.data;
    const char* high = text.data() + text.size();
    RowReader rows(csv_->file, csv_->layout, csv_->names);
    while (high - low > (1 << 16)) {
      const char* middle = low + (high - low) / 2;
      const char* const line = static_cast<const char*>(
          std::memchr(middle, '\n', static_cast<std::size_t>(high - middle)));
      if (line == nullptr) break;
      rows.seek(line + 1);
      Table row = rows.read(1);
      if (row.rows == 1 && times_of(row).front() < time)
        low = line + 1;
      else
        high = middle;
    }
    return low;
  }

  void hand_over(Column& values, std::size_t column, Piece part, std::size_t index, Column& told,
                 SampleSink& sink) const {
    SampleBlock block;
    block.raw = part.of(values.values);
    if (values.missing > 0) {
      if (told.missing == 0) told.first_missing = values.first_missing;
      told.missing += static_cast<std::size_t>(std::ranges::count(part.of(values.valid), 0));
    }
    mark_rows(csv_->marked, column, part.row, values.values.size(), values.valid);
    if (!values.valid.empty()) block.valid = part.of(values.valid);
    if (block.size() > 0) sink.take(index, block);
  }

  /// The clock of the rows read. Where the times were not the ones expected, or are not uniform,
  /// their column is read again.
  datasets::SampleClock settled_clock(const Selection& wanted, TimeAxisCheck& check,
                                      std::uint64_t rows, std::size_t channels, SampleSink& sink,
                                      Record& record) {
    if (!roles().time) {
      datasets::SampleClock clock = clock_;
      clock.start +=
          clock.interval * static_cast<double>(samples_within(clock, any_number, wanted).first);
      return clock;
    }
    const std::size_t time = *roles().time;
    if (!check.as_expected()) {
      check = TimeAxisCheck(check.first(), check.last(), rows);
      pass({}, wanted,
           [&](Table& piece, Piece part) { check.add(part.of(piece.columns[time].values)); });
    }
    TimeAxis axis = check.axis();
    if (!axis.warning.empty()) record.warnings.push_back(axis.warning);
    if (!check.uniform())
      pass({}, wanted, [&](Table& piece, Piece part) {
        for (std::size_t i = 0; i < channels; ++i)
          sink.take_times(i, part.of(piece.columns[time].values));
      });
    compare_with_head(csv_->head, rows, axis.clock, record);
    return axis.clock;
  }

  std::unique_ptr<CsvHead> csv_;
  datasets::UnitConversion conversion_;
  std::vector<std::size_t> columns_;  // of the channels
  std::uint64_t rows_ = 0;            // estimated
  datasets::SampleClock clock_;       // likewise
  double first_ = 0.0;                // time of the first row and of the last [s]
  double last_ = 0.0;
  bool sorted_ = false;  // the first rows' times increase
  RecordingHead head_;
};

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
  auto csv = std::make_unique<CsvHead>(path, options);
  if (csv->file.bytes().size() > read_at_once)
    return std::make_unique<LargeCsv>(std::move(csv), options);
  return reader_of(read_whole(*csv, options));
}

std::unique_ptr<RecordingReader> open_csv_by_blocks(const std::string& path,
                                                    const ImportOptions& options) {
  return std::make_unique<LargeCsv>(std::make_unique<CsvHead>(path, options), options);
}

}  // namespace impactrig::acquisition
