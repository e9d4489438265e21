// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/csv_roles.hpp"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <span>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/time_words.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::Quantity;
using datasets::Record;

namespace {

constexpr std::string_view stated_by_user = "stated", stated_by_file = "as the file says";

bool is_time_unit(const std::string& unit) {
  return !unit.empty() && datasets::quantity_of_unit(unit) == Quantity::time;
}

bool holds_numbers(const TableLayout& layout, std::size_t column) {
  return !layout.holds_text(column) && layout.dates_at(column) == nullptr;
}

/// Whether a column goes on in steps of the interval that a head states.
bool steps_by(const Column& column, std::optional<double> interval) {
  const auto& values = column.values;
  if (!interval || values.size() < 2 || column.missing > 0) return false;
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  return std::abs(step - *interval) < 1e-3 * *interval &&
         std::abs(values[1] - values[0] - step) < 0.5 * step;
}

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}

/// False for a column that its head calls something else.
bool may_be_time(const ColumnHead& head) {
  if (!head.unit.empty() || datasets::quantity_of_unit(head.name) == Quantity::frequency)
    return false;
  const std::string name = lowered(head.name);
  if (name.starts_with("time - ")) return true;  // "Time - Voltage", of SignalExpress
  for (const std::string_view word :
       {"displacement", "distance", "position",   "deflection", "force",  "load",
        "velocity",     "speed",    "acc",        "volt",       "strain", "angle",
        "freq",         "pressure", "extension",  "elongation", "stroke", "travel",
        "depth",        "temperat", "wavelength", "lux",        "node",   "alpha"})
    if (name.find(word) != std::string::npos) return false;
  return name != "f" && (name.size() < 2 || !is_letter(name[1]) ||
                         quantity_of_first_word(name) == Quantity::unknown);
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

/// The time of the next column by its name: "t_acc" of "acc", "tA" of "A".
bool is_time_of_next(std::string_view name, std::string_view next) {
  if (next.empty() || !name.ends_with(next)) return false;
  const std::string_view front = name.substr(0, name.size() - next.size());
  const bool capital = next.front() >= 'A' && next.front() <= 'Z';
  return front == "t_" || front == "t " || (front == "t" && capital);
}

/// As a further one. Where the first time is one only since it increases, by the same name.
bool is_named_as_time(std::size_t column, const std::vector<ColumnHead>& heads, std::size_t time) {
  const ColumnHead& head = heads[column];
  const std::string name = lowered(head.name);
  if ((is_time_name(name) && name != "x-axis") || name.starts_with("time ") ||
      name.starts_with("time_") || name.starts_with("zeit "))
    return true;
  if (column + 1 < heads.size() && is_time_of_next(head.name, heads[column + 1].name)) return true;
  const ColumnHead& first_time = heads[time];
  const std::string_view stem = name_without_number(first_time.name);
  const bool first_is_named = is_time_name(stem) || is_time_unit(first_time.unit);
  return head.name == first_time.name ||
         (first_is_named && !stem.empty() && name_without_number(head.name) == stem);
}

/// Columns behind the time that are times too, by their name ("Time B", "t_acc") or unit, and
/// increase up to their end.
std::vector<std::size_t> times_behind(std::size_t time, const std::vector<ColumnHead>& heads,
                                      const std::vector<Column>& columns) {
  std::vector<std::size_t> found;
  for (std::size_t c = time + 1; c < columns.size(); ++c) {
    const ColumnHead& head = heads[c];
    const bool is_time =
        is_time_unit(head.unit) || (head.unit.empty() && is_named_as_time(c, heads, time));
    const std::span<const double> values(columns[c].values);
    if (is_time && increases(values.first(samples_before_end(columns[c])))) found.push_back(c);
  }
  return found;
}

/// A name that a column of row numbers may have.
bool is_counter_name(std::string_view name) {
  constexpr std::array<std::string_view, 20> words = {
      "",   "#",   "no",     "no.",     "nr",        "nr.",   "n",     "i",    "index",  "idx",
      "id", "row", "sample", "samples", "sample no", "point", "count", "scan", "number", "record"};
  return std::ranges::find(words, lowered(name)) != words.end();
}

/// "NO." in a row of units.
bool is_counter_unit(const std::string& unit) {
  return is_counter_name(unit) && datasets::quantity_of_unit(unit) == Quantity::unknown;
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

/// The column that the user names. Throws InputError where there is none, or one of text.
std::size_t stated_time(const TextFile& file, const TableLayout& layout,
                        const std::vector<ColumnHead>& heads, std::size_t columns,
                        const std::string& name) {
  const auto found = column_named(heads, name);
  if (!found || *found >= columns) {
    std::string list;
    for (const ColumnHead& column : heads) list += (list.empty() ? "'" : ", '") + column.name + "'";
    throw InputError({.file = file.path()},
                     fmt::format("there is no column '{}' for the time; the columns "
                                 "are {}",
                                 name, list));
  }
  const DateColumns* const date = layout.dates_at(*found);
  const std::size_t time = date != nullptr ? date->last : *found;
  if (layout.holds_text(time))
    throw InputError({.file = file.path()},
                     fmt::format("the column '{}' holds text, not the time", heads[time].name));
  return time;
}

/// A first column without a name or a value, over which keys with a value a channel stand.
bool is_blank_under_keys(const TableHead& head, const std::vector<Column>& columns) {
  const bool unnamed = head.columns.empty() || head.columns.front().name.empty();
  const bool keys = std::ranges::any_of(head.attributes, [](const auto& attribute) {
    const std::string key = lowered(attribute.first);
    return key == "vunit" || key == "tracename" || key == "vertical units";
  });
  return unnamed && keys && columns.size() > 1 && !columns.front().values.empty() &&
         columns.front().missing == columns.front().values.size();
}

/// By name, then by its dates, then by unit.
void take_time_by_heads(const TableLayout& layout, const std::vector<ColumnHead>& heads,
                        const std::vector<Column>& columns, CsvRoles& roles) {
  for (std::size_t c = 0; c < columns.size() && !roles.time; ++c)
    if (holds_numbers(layout, c) && is_time_name(heads[c].name) &&
        (heads[c].unit.empty() || is_time_unit(heads[c].unit))) {
      roles.time = c;
      roles.reason = "by its name";
    }
  if (!roles.time && !layout.dates.empty()) {
    roles.time = layout.dates.front().last;
    const DateColumns& date = layout.dates.front();
    using Written = DateColumns::Written;
    roles.reason = date.written == Written::whole_seconds ? "seconds and what is behind them"
                   : date.written == Written::numbers     ? "hour, minute and second"
                   : date.base.elapsed                    ? "holds durations"
                                                          : "holds times of day";
  }
  // a date in days that does not change is none before the times
  for (const bool rises : {true, false})
    for (std::size_t c = 0; c < columns.size() && !roles.time; ++c)
      if (holds_numbers(layout, c) && is_time_unit(heads[c].unit) &&
          (!rises ||
           increases(
               std::span<const double>(columns[c].values).first(samples_before_end(columns[c]))))) {
        roles.time = c;
        roles.reason = "by its unit";
      }
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

CsvRoles find_roles(const TextFile& file, const TableLayout& layout, const TableHead& head,
                    const std::vector<ColumnHead>& heads, const Table& table,
                    const ImportOptions& options) {
  CsvRoles roles;
  for (const TextColumn& column : layout.text_columns) roles.text.push_back(column.column);
  for (const DateColumns& date : layout.dates)
    for (std::size_t c = date.first; c <= date.last; ++c) roles.dates.push_back(c);
  const auto& columns = table.columns;
  roles.first_is_blank = is_blank_under_keys(head, columns);
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
  // "Time (samples)"
  const bool counts_samples =
      is_time_name(heads.front().name) && counts_no_time(heads.front().unit);
  const bool first_counts =
      columns.size() > 1 &&
      (heads.front().unit.empty() || counts_samples || is_counter_unit(heads.front().unit)) &&
      counts(columns.front().values, head.increment.has_value()) &&
      (unnamed || counts_samples || is_counter_name(heads.front().name) ||
       may_be_time(heads.front()));
  roles.index_name_fits = unnamed || counts_samples || is_counter_name(heads.front().name);
  // parts of a record count from its start, where the head states that
  if (first_counts && columns.front().values.front() > 1.0)
    roles.samples_before = columns.front().values.front();
  if (options.time_column) {
    if (first_counts) roles.index = 0;
    return roles;
  }
  take_time_by_heads(layout, heads, columns, roles);
  if (roles.time && *roles.time > 0 && first_counts && roles.index_name_fits &&
      !head.columns.empty())
    roles.index = 0;
  if (!roles.time && first_counts) {
    roles.index = 0;
    if (unnamed && columns.size() > 2 && holds_numbers(layout, 1) &&
        steps_by(columns[1], head.interval)) {
      roles.time = 1;
      roles.reason = "behind the numbers of the samples, in steps of the interval that is stated";
    }
  } else if (!roles.time && columns.size() > 1 && may_be_time(heads.front()) &&
             increases(std::span<const double>(columns.front().values)
                           .first(samples_before_end(columns.front())))) {
    roles.time = 0;
    roles.reason = "the first column, since it increases throughout";
  }
  if (roles.time) roles.take_further_times(times_behind(*roles.time, heads, columns));
  return roles;
}

void tell_of_times(const std::vector<ColumnHead>& heads, const CsvRoles& roles, Record& record) {
  for (const std::size_t c : roles.further_times) {
    const bool says_so = lowered(heads[c].name).find("time") != std::string::npos;
    if (says_so || is_named_as_time(c, heads, *roles.time)) continue;
    record.warnings.push_back(fmt::format(
        "'{}' is taken as the times of the columns beside it, since its unit is one of time and it "
        "increases (--time-column '{}' gives all columns one time)",
        heads[c].name, heads[*roles.time].name));
  }
  const bool stated = roles.reason == stated_by_user || roles.reason == stated_by_file;
  std::size_t before = roles.time.value_or(0);
  for (std::size_t c = before + 1; roles.time && !stated && c < heads.size(); ++c) {
    const bool named = (heads[c].unit.empty() || is_time_unit(heads[c].unit)) &&
                       is_named_as_time(c, heads, *roles.time);
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

}  // namespace impactrig::acquisition
