// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/large_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "acquisition/importers/time_axis.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

/// Rows read and handed over at once.
constexpr std::size_t rows_at_once = 16384;

/// For a count of rows that is not known.
constexpr std::uint64_t any_number = ~std::uint64_t{0} >> 12;

class LargeTableReader final : public RecordingReader {
 public:
  explicit LargeTableReader(LargeTable table) : table_(std::move(table)) {
    head_.record = std::move(table_.record);
    for (const std::size_t column : table_.columns)
      has_values_.push_back(column < table_.names.size() &&
                                    table_.first_rows.columns[column].missing <
                                        table_.first_rows.rows
                                ? Known::yes
                                : Known::not_yet);
    estimate(table_.first_rows, table_.first_bytes);
    table_.first_rows = {};
    for (std::size_t i = 0; i < table_.columns.size(); ++i) {
      head_.record.channels[i].clock = clock_;
      head_.samples.push_back(table_.columns[i] < table_.names.size() ? rows_ : 0);
    }
    head_.counted = false;
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    std::vector<Column> told(chosen.size());  // of each channel, what is missing; no values
    std::vector<std::size_t> columns;
    std::vector<std::size_t> filled;  // of the chosen, those with values
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      columns.push_back(table_.columns[chosen[i]]);
      if (has_values(chosen[i])) filled.push_back(i);
    }

    const Window window = window_of(wanted);
    TimeAxisCheck check = expected_times(wanted);
    std::string cut, comment, head, remarks;
    const std::uint64_t rows = pass(columns, window, [&](Table& piece, Piece part) {
      for (const std::size_t i : filled)
        hand_over(piece.columns[columns[i]], columns[i], part, i, told[i], sink);
      if (table_.time && !window.rows) check.add(part.of(piece.columns[*table_.time].values));
      if (cut.empty()) cut = cut_row(file(), piece);
      if (comment.empty()) comment = comment_between(file(), piece);
      if (head.empty()) head = head_between(file(), piece);
      if (remarks.empty()) remarks = remarks_behind(file(), piece);
    });

    Record record = head_.record;
    record.channels.clear();
    const std::string fewer =
        wanted.has_window() ? std::string() : missing_rows(table_.announced, rows);
    for (const std::string& passed : {cut, comment, head, remarks, fewer})
      if (!passed.empty()) record.warnings.push_back(passed);
    const datasets::SampleClock clock =
        window.rows ? clock_from_row(window.rows->first, record)
                    : settled_clock(window, check, rows, filled, sink, record);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      record.channels.push_back(head_.record.channels[chosen[i]]);
      Channel& channel = record.channels.back();
      channel.clock = clock;
      const std::string missing = missing_values(file(), channel.name, told[i], rows);
      if (!missing.empty()) record.warnings.push_back(missing);
      if (columns[i] < table_.names.size() && !has_values(chosen[i]))
        record.warnings.push_back(fmt::format("'{}' has no value in any row", channel.name));
    }
    return record;
  }

 private:
  enum class Known { not_yet, yes, no };

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

  /// The rows wanted: by their numbers where these tell, else by their times.
  struct Window {
    const Selection& wanted;
    std::optional<SampleRange> rows;
  };

  /// The times of all rows.
  struct AllTimes {
    TimeAxis axis;
    bool uniform = false;
    std::uint64_t rows = 0;
  };

  TextFile& file() const { return *table_.file; }

  /// False for a column that is empty in every row. Where it is in the first rows, all are read.
  bool has_values(std::size_t channel) {
    const std::size_t column = table_.columns[channel];
    if (column >= table_.names.size()) return false;
    if (!table_.empty_columns_end || has_values_[channel] == Known::yes) return true;
    if (has_values_[channel] == Known::no) return false;
    RowReader rows(file(), table_.layout, table_.names);
    std::vector<bool> needed(table_.names.size(), false);
    needed[column] = true;
    rows.read_only(needed);
    bool found = false;
    while (!rows.at_end() && !found) {
      const char* const start = rows.at();
      const Table piece = rows.read(rows_at_once);
      found = piece.columns[column].missing < piece.rows;
      file().release(start, rows.at());
    }
    has_values_[channel] = found ? Known::yes : Known::no;
    return found;
  }

  Window window_of(const Selection& wanted) {
    if (!wanted.has_window()) return {wanted, {}};
    if (!table_.time) return {wanted, samples_within(clock_, any_number, wanted)};
    // rounded times do not tell the step of a few rows, nor which row is the first
    if (!rounded_ || !all_times().uniform) return {wanted, {}};
    return {wanted, samples_within(all_times().axis.clock, all_times().rows, wanted)};
  }

  const AllTimes& all_times() {
    if (all_times_) return *all_times_;
    const Selection everything;
    TimeAxisCheck check(first_, last_, rows_, table_.stated_interval);
    const auto look = [&](Table& piece, Piece part) {
      check.add(part.of(piece.columns[*table_.time].values));
    };
    pass({}, {everything, {}}, look);
    if (!check.as_expected()) {
      check = TimeAxisCheck(check.first(), check.last(), check.samples(), table_.stated_interval);
      pass({}, {everything, {}}, look);
    }
    all_times_ = AllTimes{check.axis(), check.uniform(), check.samples()};
    return *all_times_;
  }

  /// The clock of rows chosen by their numbers.
  datasets::SampleClock clock_from_row(std::uint64_t first, Record& record) {
    datasets::SampleClock clock = clock_;
    if (table_.time) {
      const AllTimes& all = all_times();
      clock = all.axis.clock;
      if (!all.axis.warning.empty()) record.warnings.push_back(all.axis.warning);
      if (table_.settle_clock) table_.settle_clock(all.rows, clock, record);
    }
    clock.start += clock.interval * static_cast<double>(first);
    return clock;
  }

  /// The time column in seconds.
  std::vector<double>& times_of(Table& table) const {
    Column& times = table.columns[*table_.time];
    table_.to_seconds(times);
    return times.values;
  }

  /// Rows and clock from the first rows and the last.
  void estimate(Table& probe, std::size_t bytes_of_rows) {
    const std::string_view text = text_of_rows(file(), table_.layout);
    const double all =
        (file().is_part() ? file().expected_size() : static_cast<double>(text.size())) -
        static_cast<double>(table_.layout.data - text.data());
    const double share = static_cast<double>(probe.rows) / static_cast<double>(bytes_of_rows);
    rows_ = static_cast<std::uint64_t>(std::max(1.0, std::round(all * share)));
    clock_ = table_.clock;
    if (!table_.time) return;
    const std::vector<double> first = times_of(probe);
    if (file().is_part()) {
      TimeAxisCheck check(first.front(), first.back(), first.size(), table_.stated_interval);
      check.add(first);
      clock_ = check.axis().clock;
      if (const auto time = time_of_last_lines()) count_by_time(first, *time);
      return;
    }
    RowReader end(file(), table_.layout, table_.names);
    end.seek(std::max(start_of_last_lines(text, 3), table_.layout.data));
    Table last = end.read(3);
    first_ = first.front();
    last_ = last.rows > 0 ? times_of(last).back() : first.back();
    count_by_time(first, last_);
    TimeAxisCheck check(first_, first.back(), first.size(), table_.stated_interval);
    check.add(first);
    clock_ = check.axis().clock;
    if (rows_ > 1) clock_.interval = (last_ - first_) / static_cast<double>(rows_ - 1);
    rounded_ = (check.uniform() && !check.axis().warning.empty()) ||
               std::ranges::adjacent_find(first) != first.end();
    sorted_ = std::ranges::is_sorted(first) && increases_throughout();
  }

  /// Rows grow longer with their numbers: where times agree roughly, they count better.
  void count_by_time(const std::vector<double>& first, double last) {
    const double step = (first.back() - first.front()) / static_cast<double>(first.size() - 1);
    const double by_time = std::round((last - first.front()) / step) + 1.0;
    if (std::abs(by_time / static_cast<double>(rows_) - 1.0) < 0.5)
      rows_ = static_cast<std::uint64_t>(by_time);
  }

  /// Of a file of which only its ends were rewritten; none where rows do not end it.
  std::optional<double> time_of_last_lines() {
    const std::string_view lines = file().last_lines();
    RowReader end(file(), table_.layout, table_.names);
    end.seek_last(
        lines.substr(static_cast<std::size_t>(start_of_last_lines(lines, 3) - lines.data())));
    try {
      Table last = end.read(3);
      if (last.rows > 0) return times_of(last).back();
    } catch (const datasets::InputError&) {  // a remark below the table, for example
    }
    return std::nullopt;
  }

  /// Looks at rows all over the file: times that go back anywhere for long are seen.
  bool increases_throughout() {
    constexpr std::size_t places = 256;
    const std::string_view text = text_of_rows(file(), table_.layout);
    const char* const end = text.data() + text.size();
    const auto bytes = static_cast<std::size_t>(end - table_.layout.data);
    RowReader rows(file(), table_.layout, table_.names);
    double before = first_;
    const char* released = text.data();
    for (std::size_t i = 1; i < places; ++i) {
      const char* at = table_.layout.data + bytes / places * i;
      take_line(at, end);
      rows.seek(at);
      Table row = rows.read(1);
      if (row.rows == 0) break;
      const double time = times_of(row).front();
      if (time < before) return false;
      before = time;
      // the system may have mapped much around a row
      file().release(std::exchange(released, rows.at()), rows.at());
    }
    return last_ >= before;
  }

  static const char* start_of_last_lines(std::string_view text, int lines) {
    std::size_t at = text.size();
    while (at > 0 && (text[at - 1] == '\n' || text[at - 1] == '\r')) --at;
    for (; lines > 0 && at > 0; --lines) {
      const std::size_t feed = text.rfind('\n', at - 1);
      if (feed == std::string_view::npos) return text.data();
      at = feed;
    }
    return text.data() + std::min(at + 1, text.size());
  }

  /// The times that are to be expected in the window.
  TimeAxisCheck expected_times(const Selection& wanted) const {
    const SampleRange range = samples_within(clock_, rows_, wanted);
    const double stated = table_.stated_interval;
    if (range.last == range.first) return {first_, first_, 0, stated};
    if (range.first == 0 && range.last == rows_) return {first_, last_, rows_, stated};
    return {clock_.time(range.first), clock_.time(range.last - 1), range.last - range.first,
            stated};
  }

  /// Reads rows with these columns and the time, hands those in the window to `use` piece by piece,
  /// and returns how many they are.
  template <typename Use>
  std::uint64_t pass(const std::vector<std::size_t>& columns, const Window& window,
                     const Use& use) {
    RowReader rows(file(), table_.layout, table_.names);
    std::vector<bool> needed(table_.names.size(), false);
    for (const std::size_t column : columns)
      if (column < table_.names.size()) needed[column] = true;
    if (table_.time) needed[*table_.time] = true;
    rows.read_only(needed);
    const Selection& wanted = window.wanted;
    const bool by_time = table_.time && !window.rows && wanted.has_window() && sorted_;
    // rows that are marked by their number have to be counted
    if (by_time && table_.marked.empty()) rows.seek(row_before(wanted.from));
    std::uint64_t before = 0;
    std::uint64_t used = 0;
    while (!rows.at_end()) {
      const char* const start = rows.at();
      Table piece = rows.read(rows_at_once);
      Piece part{0, piece.rows, before};
      if (table_.time) times_of(piece);
      if (by_time) {
        const std::vector<double>& times = piece.columns[*table_.time].values;
        part.first =
            static_cast<std::size_t>(std::ranges::lower_bound(times, wanted.from) - times.begin());
        part.last =
            static_cast<std::size_t>(std::ranges::upper_bound(times, wanted.to) - times.begin());
      } else if (window.rows) {
        const std::uint64_t end = before + piece.rows;
        part.first = static_cast<std::size_t>(std::clamp(window.rows->first, before, end) - before);
        part.last = static_cast<std::size_t>(std::clamp(window.rows->last, before, end) - before);
      }
      part.last = std::max(part.first, part.last);
      const bool past = part.last < piece.rows && used + (part.last - part.first) > 0;
      if (part.last > part.first || piece.cut_row != nullptr) use(piece, part);
      used += part.last - part.first;
      before += piece.rows;
      file().release(start, rows.at());
      if (past) break;
    }
    return used;
  }

  /// The start of a row whose time is before `time`, not many rows away: times increase.
  const char* row_before(double time) {
    const std::string_view text = text_of_rows(file(), table_.layout);
    const char* low = table_.layout.data;
    const char* high = text.data() + text.size();
    RowReader rows(file(), table_.layout, table_.names);
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
      if (told.missing == 0) {
        told.first_missing = values.first_missing;
        told.mark = values.mark;
      }
      told.missing += static_cast<std::size_t>(std::ranges::count(part.of(values.valid), 0));
    }
    mark_rows(table_.marked, column, part.row, values.values.size(), values.valid);
    if (!values.valid.empty()) block.valid = part.of(values.valid);
    if (block.size() > 0) sink.take(index, block);
  }

  /// The clock of the rows read. Where the times were not the ones expected, or are not uniform,
  /// their column is read again.
  datasets::SampleClock settled_clock(const Window& window, TimeAxisCheck& check,
                                      std::uint64_t rows, const std::vector<std::size_t>& channels,
                                      SampleSink& sink, Record& record) {
    if (!table_.time) return clock_;
    const std::size_t time = *table_.time;
    if (!check.as_expected()) {
      check = TimeAxisCheck(check.first(), check.last(), rows, table_.stated_interval);
      pass({}, window,
           [&](Table& piece, Piece part) { check.add(part.of(piece.columns[time].values)); });
    }
    TimeAxis axis = check.axis();
    if (!axis.warning.empty()) record.warnings.push_back(axis.warning);
    if (!check.uniform())
      pass({}, window, [&](Table& piece, Piece part) {
        for (const std::size_t i : channels)
          sink.take_times(i, part.of(piece.columns[time].values));
      });
    if (table_.settle_clock) table_.settle_clock(rows, axis.clock, record);
    return axis.clock;
  }

  LargeTable table_;
  std::vector<Known> has_values_;  // of the channels
  std::optional<AllTimes> all_times_;
  std::uint64_t rows_ = 0;       // estimated
  datasets::SampleClock clock_;  // likewise
  double first_ = 0.0;           // time of the first row and of the last [s]
  double last_ = 0.0;
  bool sorted_ = false;   // the first rows' times increase
  bool rounded_ = false;  // several rows may share a time, or seem to
  RecordingHead head_;
};

}  // namespace

void LargeTable::read_first_rows(bool head_only) {
  RowReader rows(*file, layout, names);
  std::size_t most = probed_rows;
  if (head_only) {
    const char* end = layout.data;
    const std::string_view text = file->text();
    take_line(end, text.data() + text.size());
    const auto row_bytes = std::max<std::size_t>(1, static_cast<std::size_t>(end - layout.data));
    most = std::clamp<std::size_t>(probed_bytes / row_bytes, 2, probed_rows);
  }
  first_rows = rows.read(most);
  if (first_rows.rows == 0)
    throw datasets::InputError(file->position(layout.data), "there is no row of values");
  first_bytes = static_cast<std::size_t>(rows.at() - layout.data);
}

std::unique_ptr<RecordingReader> reader_of_large_table(LargeTable table) {
  return std::make_unique<LargeTableReader>(std::move(table));
}

}  // namespace impactrig::acquisition
