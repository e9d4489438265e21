// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/date_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/head_cells.hpp"
#include "acquisition/importers/text_dialect.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

using Cells = std::vector<std::string_view>;

/// The text from one cell to another.
std::string_view joined(const Cells& cells, std::size_t first, std::size_t last) {
  if (cells[first].empty() || cells[last].empty()) return {};  // an empty one is nowhere
  const char* const begin = cells[first].data();
  const char* const end = cells[last].data() + cells[last].size();
  return {begin, static_cast<std::size_t>(end - begin)};
}

bool are_digits(std::string_view cell, std::size_t count) {
  return cell.size() == count && std::ranges::all_of(cell, detail::is_digit);
}

/// True where the cell behind a time is as many digits in each row as a fraction of a second has.
bool may_be_fraction(const std::vector<Cells>& rows, std::size_t column) {
  for (const std::size_t digits : {3U, 6U, 7U, 9U})
    if (std::ranges::all_of(rows, [=](const Cells& row) {
          return column >= row.size() || are_digits(row[column], digits);
        }))
      return true;
  return false;
}

/// The columns that one date and time takes, from `first` on.
std::optional<DateColumns> widest_from(const Cells& row, std::size_t first) {
  constexpr std::size_t most_cells = 3;  // "3/1/2024", "1:00:00.5", "PM"
  std::optional<DateColumns> widest;
  for (std::size_t last = first; last < std::min(row.size(), first + most_cells); ++last) {
    if (!is_part_of_date(row[last])) break;
    const auto base = date_time_in(joined(row, first, last));
    if (base) widest = DateColumns{first, last, *base};
  }
  return widest;
}

constexpr std::int64_t second = 1'000'000'000;  // [ns]

/// "sec" of "header.stamp.sec" and "tv_sec": a counter's name and whose it is.
struct CountName {
  explicit CountName(std::string_view name) {
    const ColumnHead head = split_head(name);  // "Time [us]"
    if (!head.unit.empty() && head.name != name &&
        datasets::quantity_of_unit(head.unit) == datasets::Quantity::time) {
      of = name.substr(0, head.name.size());
      word = head.unit;
      return;
    }
    const std::size_t mark = name.find_last_of("._/ ");
    of = name.substr(0, mark == name.npos ? 0 : mark);
    word = lowered(name.substr(mark == name.npos ? 0 : mark + 1));
  }

  /// What it counts [ns]; 0 of other words.
  std::int64_t unit() const {
    struct Word {
      std::string_view word;
      std::int64_t unit;
    };

    constexpr auto units = std::to_array<Word>(
        {{"s", second}, {"ms", 1'000'000}, {"us", 1'000}, {"\u00b5s", 1'000}, {"ns", 1}});
    const auto alone = std::ranges::find(units, word, &Word::word);
    if (alone != units.end()) return alone->unit;
    constexpr auto words = std::to_array<Word>({{"sec", second},
                                                {"second", second},
                                                {"msec", 1'000'000},
                                                {"millisec", 1'000'000},
                                                {"millisecond", 1'000'000},
                                                {"usec", 1'000},
                                                {"microsec", 1'000},
                                                {"microsecond", 1'000},
                                                {"nsec", 1},
                                                {"nanosec", 1},
                                                {"nanosecond", 1}});
    const std::string_view stem =
        word.ends_with('s') ? std::string_view(word).substr(0, word.size() - 1) : word;
    const auto found = std::ranges::find(words, stem, &Word::word);
    return found == words.end() ? 0 : found->unit;
  }

  std::string_view of;
  std::string word;
};

/// What a unit of the column `c` is where its head calls it so and nothing else ("ms" over rows, or
/// over its unit) [ns]; 0 where it does not.
std::int64_t fraction_unit(const TableLayout& layout, std::size_t c) {
  if (layout.head.empty()) return 0;
  const auto word_in = [&](std::string_view line) {
    const auto cells = cells_of(line, layout.dialect.delimiter);
    return c < cells.size() ? std::string(cells[c]) : std::string();
  };
  const std::string word = word_in(layout.head.back());
  if (layout.head.size() > 1) {
    const std::string above = word_in(layout.head[layout.head.size() - 2]);
    if (!above.empty() && above != word) return 0;
  }
  const bool capitals = word.size() <= 4 && word != lowered(word);  // "mS" and "MS" may be others
  const CountName behind(word);
  const std::int64_t unit = behind.of.empty() && !capitals ? behind.unit() : 0;
  return unit < second ? unit : 0;
}

/// Takes a column behind a date and time in whole seconds that counts what is behind them, in all
/// rows looked at: a clock of milliseconds since the start soon has more than a second.
void take_fraction(const std::vector<std::string_view>& lines, const TableLayout& layout,
                   DateColumns& date) {
  const std::size_t c = date.last + 1;
  const std::int64_t unit = fraction_unit(layout, c);
  if (unit == 0 || !date.base.has_time) return;
  std::optional<std::int64_t> first;
  for (std::size_t i = layout.head.size(); i < lines.size(); ++i) {
    const Cells row = cells_of(lines[i], layout.dialect.delimiter);
    const auto time =
        c < row.size() ? date_time_in(joined(row, date.first, date.last)) : std::nullopt;
    if (!time) continue;  // no row, or one that is cut off or spoilt
    const auto count = integer_in(row[c]);
    if (!count || *count < 0 || *count >= second / unit || time->nanoseconds % second != 0) return;
    if (!first) first = *count;
  }
  if (!first) return;
  date.base.nanoseconds += *first * unit;
  date.fraction = unit;
  date.last = c;
}

/// Several clocks of one kind count from one time: the first row's of the first column, or where
/// there is no date the earliest one, as what is before it is of the next day.
void share_base(std::vector<DateColumns>& dates) {
  for (DateColumns& date : dates) {
    const DateTime& first = dates.front().base;
    if (seconds_between(first, date.base) && !first.has_date &&
        date.base.nanoseconds < first.nanoseconds)
      dates.front().base = date.base;
  }
  for (DateColumns& date : dates)
    if (seconds_between(dates.front().base, date.base)) date.base = dates.front().base;
}

}  // namespace

bool is_part_of_date(std::string_view cell) {
  for (const std::string_view word : {"AM", "PM", "am", "pm", "a.m.", "p.m."})
    if (cell == word) return true;
  return date_time_in(cell).has_value();
}

std::vector<DateColumns> find_date_columns(const TextFile& file,
                                           const std::vector<std::string_view>& lines,
                                           const TableLayout& layout, std::size_t named) {
  constexpr std::size_t rows_tried = 40;
  std::vector<Cells> rows;
  for (std::size_t i = layout.head.size(); i < lines.size() && rows.size() < rows_tried; ++i)
    if (!trimmed(lines[i]).empty()) rows.push_back(cells_of(lines[i], layout.dialect.delimiter));
  std::vector<DateColumns> found;
  const Cells& row = rows.front();
  for (std::size_t c = 0; c < row.size(); ++c) {
    auto date = widest_from(row, c);
    if (!date) continue;
    c = date->last;
    const bool divides = layout.dialect.delimiter == ',' && date->base.has_time &&
                         date->base.nanoseconds % second == 0 && c + 1 < row.size() &&
                         may_be_fraction(rows, c + 1);
    if (divides && named < row.size()) {
      if (named + 1 != row.size())
        throw InputError(file.position(row[date->first].data()),
                         fmt::format("'{}': the comma may be the decimal mark of the seconds or "
                                     "divide cells; a line of names above the rows would tell",
                                     to_utf8(joined(row, date->first, c + 1))));
      date = DateColumns{date->first, c + 1, *date_time_in(joined(row, date->first, c + 1))};
      c = date->last;
    } else {
      take_fraction(lines, layout, *date);
      c = date->last;
    }
    found.push_back(*date);
  }
  for (DateColumns& date : found)
    if (date.base.elapsed || date.base.before_zero) date.base.nanoseconds = 0;
  // a date alone says nothing about the time between two rows; a spoilt row may be the first and
  // longer than the others
  std::erase_if(found, [&layout](const DateColumns& date) {
    return !date.base.has_time || date.last >= layout.cells;
  });
  share_base(found);
  return found;
}

namespace {

using Names = Cells;

/// Whole seconds in column `c` and what is behind them in the next.
std::optional<DateColumns> seconds_at(const std::vector<std::string_view>& lines,
                                      const TableLayout& layout, const Names& names,
                                      std::size_t c) {
  if (c + 1 >= std::min(names.size(), layout.cells)) return std::nullopt;
  const CountName whole(names[c]), behind(names[c + 1]);
  const std::int64_t unit = behind.unit();
  const bool of_one = whole.of == behind.of || behind.of.empty();
  if (whole.unit() != second || unit == 0 || unit == second || !of_one) return std::nullopt;
  std::optional<DateTime> base;
  for (std::size_t i = layout.head.size(); i < lines.size(); ++i) {
    if (is_skipped_line(lines[i])) continue;
    const Cells row = cells_of(lines[i], layout.dialect.delimiter);
    if (c + 1 >= row.size() || row[c].empty() || row[c + 1].empty())
      continue;  // cut off or spoilt: reading it says so
    const auto seconds = whole_seconds_in(row[c]);
    const auto count = integer_in(row[c + 1]);
    if (!seconds || !count || *count < 0 || *count >= second / unit) return std::nullopt;
    if (base) continue;
    base = *seconds;
    base->nanoseconds += *count * unit;
  }
  if (!base) return std::nullopt;
  return DateColumns{.first = c,
                     .last = c + 1,
                     .base = *base,
                     .fraction = unit,
                     .written = DateColumns::Written::whole_seconds};
}

/// Whether names from column `c` on are those of a clock's parts, in this order.
template <std::size_t N>
bool are_parts(const Names& names, std::size_t c, const std::array<std::string_view, N>& parts) {
  if (c + parts.size() > names.size()) return false;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const ColumnHead head = split_head(names[c + k]);  // "Hour [h]"; "h [mm]" is none
    if (!head.name.empty() && !head.unit.empty() &&
        datasets::quantity_of_unit(head.unit) != datasets::Quantity::time)
      return false;
    const std::string word = " " + lowered(head.name.empty() ? head.unit : head.name) + " ";
    if (word.size() == 2 || parts[k].find(word) == parts[k].npos) return false;
  }
  return true;
}

/// Whether column `c` holds a date without a time, by the first row.
bool is_date(const std::vector<std::string_view>& lines, const TableLayout& layout, std::size_t c) {
  for (std::size_t i = layout.head.size(); i < lines.size(); ++i) {
    if (is_skipped_line(lines[i])) continue;
    const Cells row = cells_of(lines[i], layout.dialect.delimiter);
    const auto date = c < row.size() ? date_time_in(row[c]) : std::nullopt;
    return date && date->has_date && !date->has_time;
  }
  return false;
}

/// "h,m,s", which may be a height, a mass and a stroke.
bool are_letters(const Names& names, std::size_t c) {
  return std::ranges::all_of(std::span(names).subspan(c, 3),
                             [](std::string_view name) { return name.size() == 1; });
}

/// Whether a time of day is less than the one before for a new day or date.
bool wraps(const DateTime& before, const DateTime& time) {
  constexpr std::int64_t hour = 3600 * second;
  return time.has_date || (before.nanoseconds > 23 * hour && time.nanoseconds < hour);
}

/// Whether a column other than a clock's is a time by its name.
bool names_time_beside(const Names& names, const DateColumns& clock) {
  for (std::size_t c = 0; c < names.size(); ++c)
    if ((c < clock.first || c > clock.last) && is_time_name(split_head(names[c]).name)) return true;
  return false;
}

/// Hours, minutes and seconds from column `c` on, with a date before them, and with a fraction of
/// whole seconds behind them.
std::optional<DateColumns> parts_at(const std::vector<std::string_view>& lines,
                                    const TableLayout& layout, const Names& names, std::size_t c) {
  constexpr std::string_view hours = " hour hours hr h hh stunde stunden std ";
  constexpr std::string_view minutes = " minute minutes min mm m mn minuten ";
  constexpr std::string_view seconds = " second seconds sec s ss sekunde sekunden sek ";
  constexpr std::array time = {hours, minutes, seconds};
  constexpr std::array date_and_time = {std::string_view(" year years yr yyyy yy jahr "),
                                        std::string_view(" month months mon mm monat "),
                                        std::string_view(" day days dd tag "),
                                        hours,
                                        minutes,
                                        seconds};
  const bool dated = are_parts(names, c, date_and_time);
  if (!dated && !are_parts(names, c, time)) return std::nullopt;
  DateColumns clock{.first = c,
                    .last = c + (dated ? date_and_time.size() : time.size()) - 1,
                    .base = {},
                    .written = DateColumns::Written::numbers};
  if (clock.last >= layout.cells) return std::nullopt;  // more names than columns
  if (!dated && c > 0 && is_date(lines, layout, c - 1)) clock.first = c - 1;
  const std::size_t next = clock.last + 1;
  std::int64_t unit = 0;
  if (next < std::min(names.size(), layout.cells)) {
    const CountName behind(names[next]);
    unit = behind.of.empty() && behind.unit() != second ? behind.unit() : 0;
  }
  std::optional<std::int64_t> fraction;  // of the first row
  std::optional<DateTime> base, before;
  bool minute_changes = false;
  constexpr std::int64_t minute = 60 * second;
  for (std::size_t i = layout.head.size(); i < lines.size(); ++i) {
    if (is_skipped_line(lines[i])) continue;
    const Cells row = cells_of(lines[i], layout.dialect.delimiter);
    if (row.size() <= clock.last) continue;
    const auto cells = std::span(row).subspan(clock.first, clock.last - clock.first + 1);
    if (std::ranges::any_of(cells, &std::string_view::empty)) continue;  // reading it says so
    const auto at = clock.read(joined(row, clock.first, clock.last), layout.dialect);
    if (!at) return std::nullopt;
    if (unit > 0) {
      const auto count = next < row.size() ? integer_in(row[next]) : std::nullopt;
      const bool fits =
          count && *count >= 0 && *count < second / unit && at->nanoseconds % second == 0;
      if (!fits) unit = 0;
      if (fits && !base) fraction = *count;
    }
    if (!base) base = at;
    if (before && !(seconds_between(*before, *at).value_or(-1.0) >= 0.0)) return std::nullopt;
    if (before && at->nanoseconds < before->nanoseconds && !wraps(*before, *at))
      return std::nullopt;
    minute_changes =
        minute_changes || (before && at->nanoseconds / minute != before->nanoseconds / minute);
    before = at;
  }
  if (!base || (!dated && are_letters(names, c) && !minute_changes)) return std::nullopt;
  clock.base = *base;
  if (unit > 0 && fraction) {
    clock.base.nanoseconds += *fraction * unit;
    clock.fraction = unit;
    clock.last = next;
  }
  return clock;
}

}  // namespace

std::vector<DateColumns> find_counted_clocks(const std::vector<std::string_view>& lines,
                                             const TableLayout& layout, bool stated) {
  if (layout.head.empty() || layout.key_cells > 0) return {};
  const Names names =
      cells_of(without_comment_sign(layout.head.back(), layout), layout.dialect.delimiter);
  std::vector<DateColumns> found;
  for (std::size_t c = 0; c < names.size(); ++c) {
    auto clock = stated ? std::nullopt : parts_at(lines, layout, names, c);
    if (clock && names_time_beside(names, *clock)) clock.reset();
    if (!clock) clock = seconds_at(lines, layout, names, c);
    if (!clock) continue;
    c = clock->last;
    found.push_back(*clock);
  }
  return found;
}

}  // namespace impactrig::acquisition
