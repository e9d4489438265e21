// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/csv_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/stated_units.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Quantity;
using datasets::Record;
using datasets::SourcePosition;

namespace {

constexpr std::string_view stated_by_user = "stated", stated_by_file = "as the file says";

SourcePosition whole(const TextFile& file) {
  SourcePosition place;
  place.file = file.path();
  return place;
}

bool is_time_unit(const std::string& unit) {
  return !unit.empty() && datasets::quantity_of_unit(unit) == Quantity::time;
}

/// "ms" where a name should be, or one of Arduino's clocks; "" for other names.
std::string_view unit_of_time_alone(std::string_view name) {
  constexpr std::array<std::string_view, 7> units = {"s", "sec", "ms", "msec", "us", "µs", "ns"};
  if (std::ranges::find(units, name) != units.end()) return name;
  return name == "millis" ? "ms" : name == "micros" ? "us" : "";
}

bool holds_numbers(const TableLayout& layout, std::size_t column) {
  return !layout.holds_text(column) && layout.dates_at(column) == nullptr;
}

/// False for a column that its head calls something else.
bool may_be_time(const ColumnHead& head) {
  if (!head.unit.empty()) return false;
  const std::string name = lowered(head.name);
  if (name.starts_with("time - ")) return true;  // "Time - Voltage", of SignalExpress
  for (const std::string_view word :
       {"displacement", "distance", "position", "deflection", "force", "load", "velocity", "speed",
        "acc", "volt", "strain", "angle", "freq", "pressure"})
    if (name.find(word) != std::string::npos) return false;
  return true;
}

bool increases(std::span<const double> values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    if (!(values[i] > values[i - 1])) return false;
  return values.size() > 1;
}

/// 0, 1, 2, ... or 1, 2, 3, ...; `from_any`: or from any other whole number on.
bool counts(const std::vector<double>& values, bool from_any) {
  if (values.empty()) return false;
  const double first = values.front();
  if (first != 0.0 && first != 1.0 && !(from_any && first > 0.0 && first == std::floor(first)))
    return false;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] != values[i - 1] + 1.0) return false;
  return true;
}

/// "t" of "t_2", "Time" of "Time.1": pairs of columns in one table count their times.
std::string_view name_without_number(std::string_view name) {
  const std::size_t last = name.find_last_not_of("0123456789._-#() ");
  return name.substr(0, last == name.npos ? 0 : last + 1);
}

/// As a further one. Where the first time is one only since it increases, by the same name.
bool is_named_as_time(const ColumnHead& head, const ColumnHead& first_time) {
  const std::string name = lowered(head.name);
  if (is_time_name(name) || name.starts_with("time ") || name.starts_with("time_") ||
      name.starts_with("zeit "))
    return true;
  const std::string_view stem = name_without_number(first_time.name);
  const bool first_is_named = is_time_name(stem) || is_time_unit(first_time.unit);
  return head.name == first_time.name ||
         (first_is_named && !stem.empty() && name_without_number(head.name) == stem);
}

/// Columns behind the time that are times too, by their name ("Time B") or unit, and increase up to
/// their end.
std::vector<std::size_t> times_behind(std::size_t time, const std::vector<ColumnHead>& heads,
                                      const std::vector<Column>& columns) {
  std::vector<std::size_t> found;
  for (std::size_t c = time + 1; c < columns.size(); ++c) {
    const ColumnHead& head = heads[c];
    const bool is_time =
        is_time_unit(head.unit) || (head.unit.empty() && is_named_as_time(head, heads[time]));
    const std::span<const double> values(columns[c].values);
    if (is_time && increases(values.first(samples_before_end(columns[c])))) found.push_back(c);
  }
  return found;
}

/// A name that a column of row numbers may have.
bool is_counter_name(std::string_view name) {
  constexpr std::array<std::string_view, 19> words = {
      "",   "#",   "no",     "no.",     "nr",        "nr.",   "n",     "i",    "index", "idx",
      "id", "row", "sample", "samples", "sample no", "point", "count", "scan", "number"};
  return std::ranges::find(words, lowered(name)) != words.end();
}

std::optional<std::size_t> column_named(const std::vector<ColumnHead>& heads,
                                        const std::string& wanted) {
  for (std::size_t c = 0; c < heads.size(); ++c)
    if (heads[c].name == wanted) return c;
  for (std::size_t c = 0; c < heads.size(); ++c)
    if (lowered(heads[c].name) == lowered(wanted)) return c;
  const auto index = integer_in(wanted);
  if (index && *index >= 0 && static_cast<std::size_t>(*index) < heads.size())
    return static_cast<std::size_t>(*index);
  return std::nullopt;
}

/// The unit and quantity of a channel. A "kg" under an acceleration is the laboratory's kilo-g.
void set_unit(Channel& channel, const ColumnHead& head, Record& record) {
  channel.unit = head.unit;
  const std::string words = lowered(head.name + " " + head.description);
  if (head.unit == "kg" && words.find("accel") != std::string::npos) {
    channel.unit = "kg (kilo-g)";
    channel.attributes["unit in file"] = head.unit;
    const std::string note =
        "the unit 'kg' of an acceleration is read as kilo-g (1000 g); --units states another";
    if (std::find(record.warnings.begin(), record.warnings.end(), note) == record.warnings.end())
      record.warnings.push_back(note);
  }
  channel.quantity = datasets::quantity_of_unit(channel.unit);
  if (!head.description.empty()) channel.attributes["description"] = head.description;
}

/// "quantity of column 2: strain", as our own export says it where the unit does not.
void take_stated_quantity(const TableHead& head, std::size_t column, Channel& channel) {
  const auto found = head.attributes.find(fmt::format("quantity of column {}", column));
  if (found == head.attributes.end()) return;
  channel.quantity = datasets::quantity_named(found->second).value_or(channel.quantity);
}

/// "17-21 40", in order; none where it is anything else.
std::optional<std::vector<SampleRange>> runs_in(std::string_view text) {
  std::vector<SampleRange> runs;
  for (const std::string_view cell : cells_of(text, ' ')) {
    SampleRange run;
    const char* const end = cell.data() + cell.size();
    auto [at, error] = std::from_chars(cell.data(), end, run.first);
    if (error != std::errc{}) return std::nullopt;
    run.last = run.first;
    if (at != end && *at == '-') {
      const auto second = std::from_chars(at + 1, end, run.last);
      if (second.ec != std::errc{}) return std::nullopt;
      at = second.ptr;
    }
    const std::uint64_t behind = runs.empty() ? 0 : runs.back().last;
    if (at != end || run.first < behind || run.last < run.first ||
        run.last == std::numeric_limits<std::uint64_t>::max())
      return std::nullopt;
    ++run.last;
    runs.push_back(run);
  }
  return runs;
}

}  // namespace

std::size_t samples_before_end(const Column& column) {
  if (column.missing == 0) return column.values.size();
  const std::size_t present = column.values.size() - column.missing;
  const auto first = std::ranges::find(column.valid, 0);
  return first - column.valid.begin() == static_cast<std::ptrdiff_t>(present) ? present : 0;
}

std::vector<ClockColumns> CsvRoles::clocks(std::size_t columns) const {
  std::vector<ClockColumns> ranges;
  if (further_times.empty()) return {{time, 0, columns}};
  const auto any_channel = [this](std::size_t first, std::size_t end) {
    for (std::size_t c = first; c < end; ++c)
      if (is_channel(c)) return true;
    return false;
  };
  const bool stand_behind =
      any_channel(0, *time) && !any_channel(further_times.back() + 1, columns);
  std::vector<std::size_t> times = further_times;
  times.insert(times.begin(), *time);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const bool last = k + 1 == times.size();
    if (stand_behind)
      ranges.push_back({times[k], k == 0 ? 0 : times[k - 1] + 1, last ? columns : times[k] + 1});
    else
      ranges.push_back({times[k], k == 0 ? 0 : times[k], last ? columns : times[k + 1]});
  }
  return ranges;
}

void CsvRoles::take_further_times(std::vector<std::size_t> increasing) {
  further_times.clear();
  std::size_t before = *time;
  for (const std::size_t c : increasing) {
    if (c > before + 1) further_times.push_back(c);
    before = c;
  }
  named_times = std::move(increasing);
}

MarkedRows take_marked_rows(TableHead& head) {
  constexpr std::string_view key = "invalid samples of column ";
  MarkedRows marked;
  for (auto entry = head.attributes.lower_bound(std::string(key));
       entry != head.attributes.end() && entry->first.starts_with(key);) {
    const auto column = integer_in(std::string_view(entry->first).substr(key.size()));
    auto runs = runs_in(entry->second);
    if (!column || *column < 0 || !runs) {
      ++entry;
      continue;
    }
    marked[static_cast<std::size_t>(*column)] = std::move(*runs);
    entry = head.attributes.erase(entry);
  }
  return marked;
}

void mark_rows(const MarkedRows& marked, std::size_t column, std::uint64_t first,
               std::size_t samples, std::vector<std::uint8_t>& valid) {
  const auto found = marked.find(column);
  if (found == marked.end()) return;
  const std::uint64_t end = first + samples;
  const auto& runs = found->second;
  auto run = std::ranges::upper_bound(runs, first, {}, &SampleRange::last);
  for (; run != runs.end() && run->first < end; ++run) {
    if (valid.empty()) valid.assign(samples, 1);
    const auto from = static_cast<std::ptrdiff_t>(std::max(run->first, first) - first);
    const auto to = static_cast<std::ptrdiff_t>(std::min(run->last, end) - first);
    std::fill(valid.begin() + from, valid.begin() + to, std::uint8_t{0});
  }
}

std::vector<ColumnHead> complete_heads(const TextFile& file, const TableHead& head,
                                       std::size_t columns, const ImportOptions& options) {
  std::vector<ColumnHead> heads = head.columns;
  heads.resize(std::max(heads.size(), columns));
  check_stated_units(options.units, heads.size(), "columns", file.path());
  for (std::size_t c = 0; c < heads.size(); ++c) {
    if (c < options.units.size() && !options.units[c].empty()) heads[c].unit = options.units[c];
    if (heads[c].unit.empty()) heads[c].unit = unit_of_time_alone(heads[c].name);
    if (heads[c].name.empty()) heads[c].name = fmt::format("column {}", c);
  }
  return heads;
}

void tell_of_times(const std::vector<ColumnHead>& heads, const CsvRoles& roles, Record& record) {
  for (const std::size_t c : roles.further_times) {
    const bool says_so = lowered(heads[c].name).find("time") != std::string::npos;
    if (says_so || is_named_as_time(heads[c], heads[*roles.time])) continue;
    record.warnings.push_back(fmt::format(
        "'{}' is taken as the times of the columns beside it, since its unit is one of time and it "
        "increases (--time-column '{}' gives all columns one time)",
        heads[c].name, heads[*roles.time].name));
  }
  const bool stated = roles.reason == stated_by_user || roles.reason == stated_by_file;
  std::size_t before = roles.time.value_or(0);
  for (std::size_t c = before + 1; roles.time && !stated && c < heads.size(); ++c) {
    const bool named = (heads[c].unit.empty() || is_time_unit(heads[c].unit)) &&
                       is_named_as_time(heads[c], heads[*roles.time]);
    if (named && c > before + 1 && roles.is_channel(c))
      record.warnings.push_back(
          fmt::format("'{}' is named as times of its own, but has gaps or does not increase: the "
                      "columns behind "
                      "it have the times before it",
                      heads[c].name));
    if (named) before = c;
  }
  if (roles.index && roles.samples_before > 0.0)
    record.warnings.push_back(fmt::format(
        "'{}' counts the samples from {} on: the clock begins as much later than the start in the "
        "head",
        heads[*roles.index].name, roles.samples_before));
  else if (roles.index && !roles.index_name_fits)
    record.warnings.push_back(fmt::format(
        "'{}' counts 0, 1, 2, ... or 1, 2, 3, ...: it is taken to count the samples and left out",
        heads[*roles.index].name));
}

std::string commas_that_may_be_decimal_marks(const TableLayout& layout, const TableHead& head,
                                             std::string_view text) {
  constexpr long rows_tried = 40;
  constexpr long rows_that_count = 4;
  if (layout.dialect.delimiter != ',' || layout.written_cells != 2 || layout.key_cells > 0 ||
      layout.column_numbers || !head.columns.empty())
    return {};
  std::string_view example;
  long rows = 0;
  bool counts = true;  // 0, 1, 2, ...: the samples
  const char* at = layout.data;
  const char* const end = text.data() + text.size();
  for (long first = 0; at != end && rows < rows_tried;) {
    const std::string_view line = trimmed(take_line(at, end));
    if (line.empty() || line.starts_with('#') || line.starts_with('%')) continue;
    const auto cells = cells_of(line, ',');
    const auto number = cells.size() == 2 ? integer_in(cells[0]) : std::nullopt;
    if (!number || cells[1].empty() || !integer_in(cells[1]) ||
        cells[1].find_first_not_of("0123456789") != cells[1].npos)
      return {};
    if (rows == 0) example = line;
    if (rows == 0) first = *number;
    counts = counts && *number == first + rows++;
  }
  if (rows < 2 || (counts && rows >= rows_that_count)) return {};
  return fmt::format(
      "each row is two whole numbers under no names: the comma is taken for the end of a cell "
      "(--decimal , reads '{}' as one number)",
      to_utf8(example.substr(0, 40)));
}

void tell_of_dates_and_text(const TableLayout& layout, const std::vector<ColumnHead>& heads,
                            const CsvRoles& roles, Record& record) {
  for (const TextColumn& column : layout.text_columns)
    if (!column.example.empty())
      record.warnings.push_back(fmt::format("'{}' holds text ('{}'), no numbers: it is left out",
                                            heads[column.column].name,
                                            to_utf8(column.example.substr(0, 40))));
  for (const DateColumns& date : layout.dates) {
    const bool is_time =
        roles.time == date.last ||
        std::ranges::find(roles.further_times, date.last) != roles.further_times.end();
    if (!is_time)
      record.warnings.push_back(
          fmt::format("'{}' holds times of day, and '{}' is the time: it is left out",
                      heads[date.last].name, roles.time ? heads[*roles.time].name : "none"));
    if (record.started.empty()) record.started = date.base.iso();
  }
}

namespace {

/// The column that the user names. Throws InputError where there is none, or one of text.
std::size_t stated_time(const TextFile& file, const TableLayout& layout,
                        const std::vector<ColumnHead>& heads, std::size_t columns,
                        const std::string& name) {
  const auto found = column_named(heads, name);
  if (!found || *found >= columns) {
    std::string list;
    for (const ColumnHead& column : heads) list += (list.empty() ? "'" : ", '") + column.name + "'";
    throw InputError(whole(file), fmt::format("there is no column '{}' for the time; the columns "
                                              "are {}",
                                              name, list));
  }
  const DateColumns* const date = layout.dates_at(*found);
  const std::size_t time = date != nullptr ? date->last : *found;
  if (layout.holds_text(time))
    throw InputError(whole(file),
                     fmt::format("the column '{}' holds text, not the time", heads[time].name));
  return time;
}

/// By name, then by its dates, then by unit.
void take_time_by_heads(const TableLayout& layout, const std::vector<ColumnHead>& heads,
                        std::size_t columns, CsvRoles& roles) {
  for (std::size_t c = 0; c < columns && !roles.time; ++c)
    if (holds_numbers(layout, c) && is_time_name(heads[c].name) &&
        (heads[c].unit.empty() || is_time_unit(heads[c].unit))) {
      roles.time = c;
      roles.reason = "by its name";
    }
  if (!roles.time && !layout.dates.empty()) {
    roles.time = layout.dates.front().last;
    roles.reason = "holds times of day";
  }
  for (std::size_t c = 0; c < columns && !roles.time; ++c)
    if (holds_numbers(layout, c) && is_time_unit(heads[c].unit)) {
      roles.time = c;
      roles.reason = "by its unit";
    }
}

}  // namespace

CsvRoles find_roles(const TextFile& file, const TableLayout& layout, const TableHead& head,
                    const std::vector<ColumnHead>& heads, const Table& table,
                    const ImportOptions& options) {
  CsvRoles roles;
  for (const TextColumn& column : layout.text_columns) roles.text.push_back(column.column);
  for (const DateColumns& date : layout.dates)
    for (std::size_t c = date.first; c <= date.last; ++c) roles.dates.push_back(c);
  const auto& columns = table.columns;
  if (options.time_column && *options.time_column != "none") {
    roles.time = stated_time(file, layout, heads, columns.size(), *options.time_column);
    roles.reason = stated_by_user;
    return roles;
  }
  const auto stated = head.attributes.find(std::string(time_column_key));
  if (!options.time_column && stated != head.attributes.end()) {
    if (stated->second == no_time_column) return roles;
    if (stated->second == only_first_is_time && holds_numbers(layout, 0)) {
      roles.time = 0;
      roles.reason = stated_by_file;
      return roles;
    }
  }
  const bool unnamed = head.columns.empty() || head.columns.front().name.empty();
  const bool first_counts =
      columns.size() > 1 && heads.front().unit.empty() &&
      counts(columns.front().values, head.increment.has_value()) &&
      (unnamed || is_counter_name(heads.front().name) || may_be_time(heads.front()));
  roles.index_name_fits = unnamed || is_counter_name(heads.front().name);
  // parts of a record count from its start, where the head states that
  if (first_counts && columns.front().values.front() > 1.0)
    roles.samples_before = columns.front().values.front();
  if (options.time_column) {
    if (first_counts) roles.index = 0;
    return roles;
  }
  take_time_by_heads(layout, heads, columns.size(), roles);
  if (roles.time && *roles.time > 0 && first_counts && unnamed && !head.columns.empty())
    roles.index = 0;
  if (!roles.time && first_counts) {
    roles.index = 0;
  } else if (!roles.time && columns.size() > 1 && may_be_time(heads.front()) &&
             increases(std::span<const double>(columns.front().values)
                           .first(samples_before_end(columns.front())))) {
    roles.time = 0;
    roles.reason = "the first column, since it increases throughout";
  }
  if (roles.time) roles.take_further_times(times_behind(*roles.time, heads, columns));
  return roles;
}

void take_units_of_keys(const TableHead& head, const CsvRoles& roles, char delimiter,
                        std::vector<ColumnHead>& heads) {
  std::size_t channels = 0;
  for (std::size_t c = 0; c < heads.size(); ++c) channels += roles.is_channel(c) ? 1 : 0;
  for (const auto& [key, value] : head.attributes) {
    const std::string word = lowered(key);
    constexpr std::array<std::string_view, 7> vertical_words = {
        "vertical units", "vertical unit", "y units", "y unit", "yunits", "vunit", "unitname"};
    constexpr std::array<std::string_view, 6> horizontal_words = {
        "horizontal units", "horizontal unit", "x units", "x unit", "xunits", "hunit"};
    const bool vertical = std::ranges::find(vertical_words, word) != vertical_words.end();
    const bool horizontal = std::ranges::find(horizontal_words, word) != horizontal_words.end();
    auto units = values_of_key(value, delimiter);
    if (units.empty() || (delimiter == '\t' && units.size() != channels)) units = {value};
    const bool one_each = (word == "unit" || word == "units") && units.size() == channels;
    if (horizontal && roles.time && heads[*roles.time].unit.empty())
      heads[*roles.time].unit = unit_of_times(without_channel(units.front()));
    if (!vertical && !one_each) continue;
    std::size_t channel = 0;
    for (std::size_t c = 0; c < heads.size(); ++c) {
      if (!roles.is_channel(c)) continue;
      if (heads[c].unit.empty() && (units.size() == 1 || channel < units.size()))
        heads[c].unit = without_channel(units[units.size() == 1 ? 0 : channel]);
      ++channel;
    }
  }
}

void describe(const TableLayout& layout, const TableHead& head,
              const std::vector<ColumnHead>& heads, const CsvRoles& roles, Record& record) {
  auto& says = record.attributes;
  const auto line = [](int number) {
    return number > 0 ? fmt::format("line {}", number) : std::string("none");
  };
  says["delimiter"] = delimiter_name(layout.dialect.delimiter);
  says["decimal"] = std::string(1, layout.dialect.decimal);
  says["column names"] = line(head.names_line);
  says["unit row"] = line(head.units_line);
  says["first data line"] = fmt::format("{}", layout.head.size() + 1);
  says["time column"] =
      roles.time ? fmt::format("{} ({})", heads[*roles.time].name, roles.reason) : "none";
  std::string further;
  for (const std::size_t c : roles.further_times)
    further += (further.empty() ? "" : ", ") + heads[c].name;
  if (!further.empty()) says["further time columns"] = further;
  if (roles.index) says["index column"] = heads[*roles.index].name;
}

datasets::UnitConversion time_conversion(const TextFile& file, const ColumnHead& head,
                                         Record& record) {
  std::string unit = head.unit;
  if (unit.empty() && lowered(head.name).starts_with("second")) unit = "s";
  if (unit.empty()) {
    record.warnings.push_back(fmt::format(
        "the time column '{}' states no unit: it is taken as s (--units states another)",
        head.name));
    unit = "s";
  }
  const auto conversion = datasets::conversion(unit, "s");
  if (!conversion)
    throw InputError(
        whole(file),
        fmt::format("the time column '{}' has the unit '{}', which is not one of time: "
                    "state it with --units",
                    head.name, unit));
  return *conversion;
}

void to_seconds(const TextFile& file, const ColumnHead& head,
                const datasets::UnitConversion& conversion, Column& column) {
  if (column.missing > 0)
    throw InputError(
        file.position(column.first_missing),
        fmt::format(
            "{}: a time is missing; state --time-column none and --sample-rate to do without "
            "this column",
            head.name));
  if (conversion.factor == 1.0 && conversion.offset == 0.0) return;
  // dividing keeps decimal digits where multiplying by 0.001 would not
  const double inverse = std::round(1.0 / conversion.factor);
  const bool divides = inverse >= 1.0 && std::abs(inverse * conversion.factor - 1.0) < 1e-15;
  for (double& time : column.values)
    time = (divides ? time / inverse : time * conversion.factor) + conversion.offset;
}

datasets::SampleClock clock_from_head(const TableHead& head, const CsvRoles& roles) {
  datasets::SampleClock clock;
  clock.start = head.start.value_or(0.0);
  clock.interval = head.increment ? *head.increment : head.interval.value_or(0.0);
  clock.start += roles.samples_before * clock.interval;
  return clock;
}

void compare_with_head(const TableHead& head, std::size_t rows, datasets::SampleClock& clock,
                       Record& record) {
  const auto stated = head.interval;
  if (!stated) return;
  const double deviation = std::abs(*stated - clock.interval);
  if (clock.uniform() && rows > 1) {
    // no further apart than the rounding of the times allows
    const double last = clock.time(rows - 1);
    const double rounding = 8.0 * std::numeric_limits<double>::epsilon() *
                            std::max(std::abs(clock.start), std::abs(last));
    if (deviation * static_cast<double>(rows - 1) <= rounding) clock.interval = *stated;
  }
  if (deviation > 1e-3 * *stated)
    record.warnings.push_back(
        fmt::format("the header states a sample interval of {:.9g} s but the time column steps by "
                    "{:.9g} s: the time column is used",
                    *stated, clock.interval));
}

Channel channel_of(const TableHead& head, std::size_t column, const ColumnHead& says,
                   Record& record) {
  Channel channel;
  channel.name = says.name;
  set_unit(channel, says, record);
  take_stated_quantity(head, column, channel);
  set_attribute(channel, unusable_clock, head.unusable_clock);
  return channel;
}

}  // namespace impactrig::acquisition
