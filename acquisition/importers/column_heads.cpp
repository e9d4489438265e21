// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/column_heads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/instrument_heads.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Quantity;

namespace {

using Cells = std::vector<std::string_view>;

bool is_unit(std::string_view text) {
  return datasets::quantity_of_unit(to_utf8(text)) != Quantity::unknown;
}

/// What is between brackets, when the whole text is bracketed.
std::optional<std::string_view> bracketed(std::string_view text) {
  if (text.size() < 2 || text.back() != (text.front() == '[' ? ']' : ')')) return std::nullopt;
  if (text.front() != '[' && text.front() != '(') return std::nullopt;
  const std::string_view inner = text.substr(1, text.size() - 2);
  if (inner.find_first_of("[]()") != std::string_view::npos && text.front() == '(')
    return std::nullopt;
  return trimmed(inner);
}

std::string_view without_comment_sign(std::string_view line) {
  std::string_view text = trimmed(line);
  const bool comment = !text.empty() && (text.front() == '#' || text.front() == '%');
  while (!text.empty() && (text.front() == '#' || text.front() == '%')) text.remove_prefix(1);
  if (!comment && text.starts_with("//")) text.remove_prefix(2);
  // blanks are kept where the line is no comment: an empty first cell counts
  return comment || text.size() != trimmed(line).size() ? trimmed(text) : line;
}

void drop_empty_end(Cells& cells) {
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
}

/// A text divided where it has a tab or two blanks.
Cells divided_at_gaps(std::string_view text) {
  Cells cells;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    const bool ends = i == text.size() || text[i] == '\t' ||
                      (text[i] == ' ' && i + 1 < text.size() && text[i + 1] == ' ');
    if (!ends) continue;
    const std::string_view cell = trimmed(text.substr(start, i - start));
    if (!cell.empty()) cells.push_back(cell);
    start = i;
  }
  return cells;
}

/// A text divided at its blanks, but a unit stays with the name before it: "force [N]", "force /
/// N".
Cells divided_with_units(std::string_view text) {
  Cells words;
  std::size_t start = 0;
  int depth = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && (text[i] == '[' || text[i] == '(')) ++depth;
    if (i < text.size() && (text[i] == ']' || text[i] == ')')) --depth;
    if (i < text.size() && (depth > 0 || (text[i] != ' ' && text[i] != '\t'))) continue;
    if (i > start) words.push_back(text.substr(start, i - start));
    start = i + 1;
  }
  Cells cells;
  bool open = false;  // a slash was the word before
  for (const std::string_view word : words) {
    const bool is_slash = word == "/";
    const bool follows =
        open || is_slash || (bracketed(word) && !cells.empty() && !bracketed(cells.back()));
    if (follows && !cells.empty()) {
      const char* const first = cells.back().data();
      cells.back() = {first, static_cast<std::size_t>(word.data() + word.size() - first)};
    } else {
      cells.push_back(word);
    }
    open = is_slash;
  }
  return cells;
}

/// The cells of a head line. A comment may be divided otherwise than the data under it: what gives
/// as many cells as there are columns is taken. Blanks divide words too: where they are the
/// delimiter and nothing fits, there are no cells.
Cells head_cells(std::string_view line, const TableLayout& layout) {
  const std::string_view text = without_comment_sign(line);
  const auto divided = [&text](char delimiter) {
    Cells cells = cells_of(text, delimiter);
    drop_empty_end(cells);
    return cells;
  };
  const bool blank = layout.dialect.delimiter == ' ';
  Cells own = blank ? Cells{} : divided(layout.dialect.delimiter);
  // a semicolon may begin a remark where it divides cells too: it is no cell before the first then
  if (layout.dialect.delimiter == ';' && own.size() == layout.cells + 1 && own.front().empty() &&
      layout.written_cells == layout.cells)
    own.erase(own.begin());
  if (!blank && own.size() >= layout.cells) return own;
  const auto fits = [&layout](const Cells& cells) {
    return cells.size() <= layout.cells && cells.size() + layout.cells_beside() >= layout.cells &&
           std::none_of(cells.begin(), cells.end(), [](auto cell) { return cell.empty(); });
  };
  if (own.size() < 2)  // else its blanks are part of names
    for (const auto& divide : {divided_at_gaps, divided_with_units})
      if (Cells cells = divide(text); fits(cells)) return cells;
  for (const char other : {'\t', ';', ',', '|'})
    if (Cells cells = divided(other); fits(cells)) return cells;
  return own;
}

bool has_number(const Cells& cells, char decimal) {
  return std::any_of(cells.begin(), cells.end(), [decimal](std::string_view cell) {
    return number_in(cell, {decimal, false}).has_value();
  });
}

/// "deacceleration - kg" divided at its dash; none without one.
std::optional<ColumnHead> sentence(std::string_view cell) {
  const std::size_t dash = cell.find(" -");
  if (dash == std::string_view::npos) return std::nullopt;
  const bool at_end = dash + 2 == cell.size();
  if (!at_end && cell[dash + 2] != ' ') return std::nullopt;
  ColumnHead head;
  head.description = to_utf8(trimmed(cell.substr(0, dash)));
  std::string_view unit = trimmed(cell.substr(dash + 2));
  const std::size_t comment = unit.find(" (");
  if (comment != std::string_view::npos) {
    head.description += " " + to_utf8(unit.substr(comment + 1));
    unit = trimmed(unit.substr(0, comment));
  }
  head.unit = to_utf8(unit);
  return head;
}

bool is_sentence_row(const Cells& cells) {
  bool any_unit = false;
  for (const std::string_view cell : cells) {
    if (cell.empty()) continue;
    const auto parts = sentence(cell);
    if (!parts) return false;
    any_unit = any_unit || (!parts->unit.empty() && is_unit(parts->unit));
  }
  return any_unit;
}

bool is_index_word(std::string_view text) {
  constexpr std::array<std::string_view, 9> words = {"sequence", "index",  "sample", "samples", "#",
                                                     "no.",      "number", "point",  "-"};
  return std::find(words.begin(), words.end(), lowered(text)) != words.end();
}

/// Letters that name a column rather than a farad, an are or the atomic mass unit; t first is no
/// tonne.
bool is_letter_of_a_name(std::string_view cell, bool first) {
  return cell.size() == 1 &&
         std::string_view(first ? "tFau" : "Fau").find(cell.front()) != cell.npos;
}

/// "F1 (N)": a name with its unit, though UDUNITS-2 would multiply them. "kg (kilo-g)" is none.
bool is_name_with_unit(std::string_view cell) {
  const std::string unit = cell.ends_with(')') ? split_head(cell).unit : std::string();
  return !unit.empty() &&
         datasets::quantity_of_unit(to_utf8(cell)) != datasets::quantity_of_unit(unit);
}

bool is_unit_row(const Cells& cells) {
  bool any = false;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::string_view cell = cells[c];
    if (cell.empty() || is_index_word(cell)) continue;
    const bool is_name = is_letter_of_a_name(cell, c == 0) || is_name_with_unit(cell);
    if (!bracketed(cell) && (is_name || !is_unit(cell))) return false;
    any = true;
  }
  return any;
}

/// Takes Start and Increment out of names and units ("X,CH1,Start,Increment" above
/// "Sequence,Volt,-3e-07,5e-10").
void take_start_and_increment(Cells& names, Cells& units, char decimal, TableHead& head) {
  for (const std::string_view word : {"start", "increment"}) {
    for (std::size_t i = 0; i < std::min(names.size(), units.size()); ++i) {
      const auto value = number_in(units[i], {decimal, false});
      if (lowered(names[i]) != word || !value) continue;
      (word == "start" ? head.start : head.increment) = *value;
      names.erase(names.begin() + static_cast<std::ptrdiff_t>(i));
      units.erase(units.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  }
}

void add_attribute(std::string_view line, const TableLayout& layout, bool keys, TableHead& head) {
  const std::string_view text = trimmed(without_comment_sign(line));
  if (text.empty()) return;
  std::string key;
  std::string value;
  const std::size_t cell_end = keys || layout.dialect.delimiter == ' '
                                   ? std::string_view::npos
                                   : text.find(layout.dialect.delimiter);
  const std::size_t colon = text.find_first_of(keys ? ":" : ":=");
  const std::size_t divider = cell_end != std::string_view::npos ? cell_end : colon;
  if (divider == std::string_view::npos || divider == 0) {
    std::string& rest = head.attributes["header"];
    if (!rest.empty()) rest += " | ";
    rest += to_utf8(text);
    return;
  }
  key = to_utf8(without_quotes(trimmed(text.substr(0, divider))));
  std::string_view rest = trimmed(text.substr(divider + 1));
  if (divider == colon)  // "XInc:,5e-7" above one column
    rest.remove_prefix(std::min(rest.find_first_not_of(",;\t "), rest.size()));
  while (!rest.empty() && rest.back() == layout.dialect.delimiter) rest.remove_suffix(1);
  while (!key.empty() && std::string_view(":= \t").find(key.back()) != key.npos) key.pop_back();
  value = to_utf8(trimmed(rest));
  if (!key.empty() && !value.empty()) head.attributes[key] = value;
}

/// True for a line of words that could name columns, but that does not fit them.
bool may_be_names(std::string_view line, const TableLayout& layout) {
  const std::string_view text = trimmed(without_comment_sign(line));
  const Cells words = cells_of(text, ' ');
  return words.size() > 1 && text.find_first_of(":=") == std::string_view::npos &&
         !has_number(words, layout.dialect.decimal) && head_cells(line, layout).empty();
}

void tell_of_misfit(const TableLayout& layout, std::size_t line, TableHead& head) {
  const std::string_view text = trimmed(layout.head[line]);
  head.warnings.push_back(fmt::format(
      "line {} above the rows ('{}') does not fit their {} column{}: they are numbered", line + 1,
      to_utf8(text.substr(0, 60)), layout.cells, layout.cells == 1 ? "" : "s"));
}

/// "x-axis,1,2", as InfiniiVision oscilloscopes name their channels.
bool are_numbered_channels(const Cells& names) {
  return lowered(names.front()) == "x-axis" &&
         std::all_of(names.begin() + 1, names.end(), [](std::string_view name) {
           return name.empty() || integer_in(name).has_value();
         });
}

/// Lines "Key :value" above a table of one column, as ISO 13499 (MME) has them: the last is no name
/// where its value is a number, or all others are keys too.
bool are_keys(const TableLayout& layout, const std::vector<std::size_t>& filled) {
  if (layout.cells != 1 || filled.empty()) return false;
  const auto value_of = [&](std::size_t line) -> std::optional<std::string_view> {
    const std::string_view text = trimmed(without_comment_sign(layout.head[line]));
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos || colon == 0) return std::nullopt;
    return trimmed(text.substr(colon + 1));
  };
  const auto last = value_of(filled.back());
  if (!last) return false;
  return number_in(*last, {layout.dialect.decimal, false}).has_value() ||
         (filled.size() > 2 && std::ranges::all_of(filled, [&](std::size_t line) {
            return value_of(line).has_value();
          }));
}

/// Numbers and nothing else: neither names nor units.
bool has_numbers_alone(std::string_view line) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto may_be_word = [](char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '%' || (c & 0x80) != 0;
  };
  return std::ranges::any_of(line, is_digit) && std::ranges::none_of(line, may_be_word);
}

/// "-----  -----" and "|---|---|".
bool is_rule(std::string_view line) {
  return line.find("--") != line.npos && line.find_first_not_of("-=+|:#% \t\r") == line.npos;
}

/// A unit of time under a name of times: what is under the other names are units too, understood or
/// not ("Voltage (unscaled)").
bool has_time_over_its_unit(const Cells& names, const Cells& units) {
  // "Zeit  1 - Standardmessrate"
  const auto is_time = [](std::string_view name) {
    return is_time_name(name) || is_time_name(name.substr(0, name.find("  ")));
  };
  for (std::size_t c = 0; c < std::min(names.size(), units.size()); ++c)
    if (is_time(names[c]) && !is_time_name(units[c]) &&
        datasets::quantity_of_unit(to_utf8(bracketed(units[c]).value_or(units[c]))) ==
            Quantity::time)
      return true;
  return false;
}

/// "force [N]" of "# 2: force [N]" and "Column 2 = force [N]", the name of column 2 where columns
/// count from `first`.
std::optional<std::string_view> listed_name(std::string_view line, std::size_t column, long first) {
  std::string_view text = trimmed(without_comment_sign(line));
  const std::string words = lowered(text.substr(0, 7));
  for (const std::string_view word : {"column", "spalte", "col"})
    if (words.starts_with(word)) {
      text = trimmed(text.substr(word.size()));
      break;
    }
  const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  if (integer_in(text.substr(0, end)) != first + static_cast<long>(column)) return std::nullopt;
  text = trimmed(text.substr(end));
  if (text.size() < 2 || std::string_view(":=.)-").find(text.front()) == text.npos)
    return std::nullopt;
  return trimmed(text.substr(1));
}

/// Names in the last lines above the rows, one a line in the order of the columns: "# 1: time [ms]"
/// over "# 2: force [N]". None where they are not listed so.
Cells listed_names(const TableLayout& layout, const std::vector<std::size_t>& filled) {
  if (layout.cells < 2 || filled.size() < layout.cells) return {};
  for (const long first : {1L, 0L}) {
    Cells names;
    for (std::size_t c = 0; c < layout.cells; ++c) {
      const std::size_t line = filled[filled.size() - layout.cells + c];
      const auto name = listed_name(layout.head[line], c, first);
      if (!name) break;
      names.push_back(*name);
    }
    if (names.size() == layout.cells) return names;
  }
  return {};
}

/// "Time,10:11:12,10:11:12": when each channel began.
bool are_dates_of_a_key(const Cells& cells) {
  return cells.size() > 1 && std::all_of(cells.begin() + 1, cells.end(),
                                         [](auto cell) { return date_time_in(cell).has_value(); });
}

/// "Unit:,N,g"
bool are_units_of_a_key(const Cells& cells) {
  std::string key = lowered(cells.front());
  if (key.ends_with(':')) key.pop_back();
  return cells.size() > 1 && (key == "unit" || key == "units");
}

/// Numbers of columns (positions, angles) beside the name of a time: "Time [ms],1,2,3".
bool may_name_by_number(const Cells& names, const TableLayout& layout) {
  if (names.size() < layout.cells || names.empty()) return false;
  const ColumnHead time = split_head(names.front());
  const bool has_unit = datasets::quantity_of_unit(time.unit) == Quantity::time;
  if (!is_time_name(time.name) || (!has_unit && (!time.unit.empty() || names.size() < 3)))
    return false;
  return std::all_of(names.begin() + 1, names.end(), [&layout](std::string_view name) {
    return integer_in(name) || !number_in(name, {layout.dialect.decimal, false});
  });
}

/// Names over units with a time among them, above further lines of each channel (sensors, serial
/// numbers): which of the filled lines holds the units; none where there are no such.
std::optional<std::size_t> find_units_of_time(const TableLayout& layout,
                                              const std::vector<std::size_t>& filled) {
  for (std::size_t i = filled.size(); i-- > 1;) {
    const Cells units = head_cells(layout.head[filled[i]], layout);
    const Cells names = head_cells(layout.head[filled[i - 1]], layout);
    if (units.size() >= layout.cells && names.size() >= layout.cells &&
        !has_number(names, layout.dialect.decimal) && !has_number(units, layout.dialect.decimal) &&
        has_time_over_its_unit(names, units))
      return i;
  }
  return std::nullopt;
}

/// The last two filled lines above the rows, as names and units or as names alone. Lines of numbers
/// below them are passed over (offsets of the channels).
void find_names_and_units(const TableLayout& layout, std::vector<std::size_t> filled, Cells& names,
                          Cells& units, TableHead& head) {
  if (layout.key_cells > 0 || take_toa5(layout, filled, names, units, head)) return;
  if (names = listed_names(layout, filled); !names.empty()) {
    head.names_line = static_cast<int>(filled.back()) + 1;
    return;
  }
  if (const auto at = find_units_of_time(layout, filled)) filled.resize(*at + 1);
  while (filled.size() > 1 && has_numbers_alone(layout.head[filled.back()])) filled.pop_back();
  if (filled.empty()) return;
  const char decimal = layout.dialect.decimal;
  const Cells bottom = head_cells(layout.head[filled.back()], layout);
  const int bottom_line = static_cast<int>(filled.back()) + 1;
  if (filled.size() > 1) {
    const std::size_t above = filled[filled.size() - 2];
    names = head_cells(layout.head[above], layout);
    units = bottom;
    if (names.size() >= layout.cells &&
        (!has_number(names, decimal) || may_name_by_number(names, layout) ||
         (are_numbered_channels(names) && is_unit_row(bottom)))) {
      take_start_and_increment(names, units, decimal, head);
      const bool as_wide = bottom.size() >= layout.cells || head.start || head.increment;
      if (as_wide &&
          (is_unit_row(units) || is_sentence_row(units) || has_time_over_its_unit(names, units))) {
        head.names_line = static_cast<int>(above) + 1;
        head.units_line = bottom_line;
        return;
      }
      head.start.reset();
      head.increment.reset();
    }
  }
  names.clear();
  units.clear();
  if (layout.dialect.delimiter == ' ' && filled.size() > 1 && is_unit_row(bottom) &&
      may_be_names(layout.head[filled[filled.size() - 2]], layout)) {
    tell_of_misfit(layout, filled[filled.size() - 2], head);
    units = bottom;
    head.units_line = bottom_line;
    return;
  }
  if (bottom.empty() && may_be_names(layout.head[filled.back()], layout))
    tell_of_misfit(layout, filled.back(), head);
  // a shorter line is taken for names only when it cannot be a title or a key with its value
  const bool all_named = bottom.size() >= layout.cells || (bottom.size() > 1 && layout.cells > 2);
  if (bottom.empty() || !all_named) return;
  if (has_number(bottom, decimal) && !may_name_by_number(bottom, layout)) return;
  if (are_dates_of_a_key(bottom) || are_units_of_a_key(bottom)) return;
  names = bottom;
  head.names_line = bottom_line;
  if (filled.size() < 2) return;
  const std::size_t above = filled[filled.size() - 2];
  const Cells over = head_cells(layout.head[above], layout);  // "s,N" above "time,force"
  if (over.size() < layout.cells || !is_unit_row(over) || !has_time_over_its_unit(names, over))
    return;
  units = over;
  head.units_line = static_cast<int>(above) + 1;
}

/// "1", "2", ... or "0", "1", ...: the first cells of the first rows.
bool begin_with_their_numbers(const TableLayout& layout, std::string_view text) {
  constexpr int rows_tried = 3;
  const char* at = layout.data;
  const char* const end = text.data() + text.size();
  std::optional<long> first;
  int rows = 0;
  while (at != end && rows < rows_tried) {
    const Cells cells = cells_of(take_line(at, end), layout.dialect.delimiter);
    const auto number = cells.empty() ? std::nullopt : integer_in(cells.front());
    if (!number || (first ? *number != *first + rows : *number != 0 && *number != 1)) return false;
    if (!first) first = *number;
    ++rows;
  }
  return rows > 1;
}

/// Rows may begin with their numbers, under no name of their own: the names are those of the other
/// columns then, as R writes tables. Where else names are fewer than columns, they may not be over
/// their own.
void compare_names_with_columns(const TableLayout& layout, std::string_view text, Cells& names,
                                TableHead& head) {
  if (names.empty() || names.size() >= layout.cells || layout.dialect.delimiter == ' ') return;
  if (names.size() + 1 == layout.cells && layout.dates.empty() &&
      begin_with_their_numbers(layout, text)) {
    names.insert(names.begin(), std::string_view());
    return;
  }
  head.warnings.push_back(
      fmt::format("line {} names {} of {} columns: the first ones are taken to be meant",
                  head.names_line, names.size(), layout.cells));
}

/// A date and time in several cells may have one name: it is that of the last of them.
void spread_names(const TableLayout& layout, Cells& names) {
  if (names.empty()) return;
  for (const DateColumns& date : layout.dates)
    for (std::size_t c = date.first; c < date.last && names.size() < layout.cells; ++c)
      names.insert(names.begin() + static_cast<std::ptrdiff_t>(std::min(c, names.size())),
                   std::string_view());
}

std::vector<ColumnHead> heads_of(const Cells& names, const Cells& units) {
  std::vector<ColumnHead> heads;
  const bool sentences = !units.empty() && is_sentence_row(units) && !is_unit_row(units);
  for (std::size_t c = 0; c < std::max(names.size(), units.size()); ++c) {
    ColumnHead column = c < names.size() ? split_head(names[c]) : ColumnHead{};
    if (integer_in(column.name)) column.name = "CH " + column.name;
    const std::string_view unit = c < units.size() ? units[c] : std::string_view{};
    if (sentences) {
      const ColumnHead said = sentence(unit).value_or(ColumnHead{});
      column.unit = said.unit;
      column.description = said.description;
    } else if (is_index_word(unit)) {
      column.description = to_utf8(unit);
    } else if (!unit.empty()) {
      column.unit = to_utf8(bracketed(unit).value_or(unit));
    }
    heads.push_back(std::move(column));
  }
  return heads;
}

/// A unit that stands for nothing else behind "in", a dash, a comma, a slash: "C" may be a channel.
bool is_plain_unit(std::string_view text) {
  constexpr std::string_view letters = "sNVgm";
  if (text.size() == 1) return letters.find(text.front()) != std::string_view::npos;
  const Quantity quantity = datasets::quantity_of_unit(to_utf8(text));
  return quantity != Quantity::unknown && quantity != Quantity::other;
}

/// "Time in ms", "Time - ms", "Time, ms", "t/ms", "v/mm/s", and of times "Time_ms".
std::optional<ColumnHead> unit_behind_a_word(std::string_view text) {
  const auto divided = [text](std::size_t name, std::size_t unit) {
    return ColumnHead{to_utf8(trimmed(text.substr(0, name))), to_utf8(trimmed(text.substr(unit))),
                      ""};
  };
  if (text.starts_with("in ") && is_plain_unit(text.substr(3))) return divided(0, 3);
  for (const std::string_view word : {" in ", " - ", ", "}) {
    const std::size_t at = text.rfind(word);
    if (at != std::string_view::npos && at > 0 &&
        is_plain_unit(trimmed(text.substr(at + word.size()))))
      return divided(at, at + word.size());
  }
  const std::size_t slash = text.find('/');
  // "m/s" and "mV/g" are units, "t/ms" is a time though it could be tonnes
  if (slash != std::string_view::npos && slash > 0 && !is_plain_unit(text) &&
      !is_plain_unit(text.substr(0, slash)) && is_plain_unit(text.substr(slash + 1)))
    return divided(slash, slash + 1);
  const std::size_t line = text.rfind('_');
  if (line == std::string_view::npos) return std::nullopt;
  constexpr std::array<std::string_view, 6> times = {"time", "t",       "timestamp",
                                                     "zeit", "elapsed", "elapsed_time"};
  const bool is_time = std::ranges::find(times, lowered(text.substr(0, line))) != times.end() &&
                       datasets::quantity_of_unit(to_utf8(text.substr(line + 1))) == Quantity::time;
  return is_time ? std::optional(divided(line, line + 1)) : std::nullopt;
}

/// What stood within quotes, as RFC 4180 has it: doubled quotes stand for one; breaks become
/// blanks.
std::string one_line(std::string_view cell) {
  std::string text;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const bool breaks = cell[i] == '\r' || cell[i] == '\n';
    if (cell.substr(i, 2) == "\"\"") ++i;
    if (!breaks)
      text += cell[i];
    else if (!text.empty() && text.back() != ' ')
      text += ' ';
  }
  return text;
}

}  // namespace

std::string_view without_channel(std::string_view value) {
  const std::size_t colon = value.find(':');
  const bool is_channel =
      colon != std::string_view::npos &&
      (value.substr(0, colon) == "Analog" ||
       (value.starts_with("CH") && integer_in(value.substr(2, colon - 2)).has_value()));
  return is_channel ? trimmed(value.substr(colon + 1)) : value;
}

bool is_time_name(std::string_view name) {
  constexpr std::array<std::string_view, 16> words = {
      "time",       "t",         "zeit",   "temps",       "tiempo", "tempo",
      "seconds",    "second",    "x-axis", "elapsed",     "x_time", "time_s",
      "time stamp", "timestamp", "x [s]",  "elapsed time"};
  return std::find(words.begin(), words.end(), lowered(name)) != words.end();
}

std::string lowered(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

ColumnHead split_head(std::string_view cell) {
  if (cell.find_first_of("\r\n") != cell.npos || cell.find("\"\"") != cell.npos)
    return split_head(one_line(cell));
  std::string_view text = trimmed(cell);
  while (!text.empty() && (text.back() == ',' || text.back() == ';'))
    text = trimmed(text.substr(0, text.size() - 1));
  ColumnHead head;
  head.name = to_utf8(text);
  if (text.empty()) return head;
  const char close = text.back();
  if (close == ']' || close == ')') {
    const std::size_t open = text.rfind(close == ']' ? '[' : '(');
    if (open != std::string_view::npos && open > 0) {
      const std::string_view unit = trimmed(text.substr(open + 1, text.size() - open - 2));
      const auto index = close == ']' ? integer_in(unit) : std::nullopt;  // "Y[0]"; "strain [1]"
      const bool counts = index && (index != 1 || text[open - 1] != ' ');
      if (close == ']' ? !counts : is_unit(unit)) {
        head.name = to_utf8(trimmed(text.substr(0, open)));
        head.unit = to_utf8(unit);
        constexpr std::string_view no_break = "\u00A0";
        if (head.name.ends_with(no_break)) head.name.resize(head.name.size() - no_break.size());
      }
    }
    return head;
  }
  const std::size_t slash = text.rfind(" / ");  // as DIN 461 labels an axis: t / s
  if (slash != std::string_view::npos && is_unit(text.substr(slash + 3))) {
    head.name = to_utf8(trimmed(text.substr(0, slash)));
    head.unit = to_utf8(trimmed(text.substr(slash + 3)));
    return head;
  }
  return unit_behind_a_word(text).value_or(head);
}

TableHead read_head(const TableLayout& layout, std::string_view text) {
  TableHead head;
  std::vector<std::size_t> filled;  // head lines with text
  for (std::size_t i = 0; i < layout.head.size(); ++i)
    if (!trimmed(layout.head[i]).empty() && !is_rule(layout.head[i])) filled.push_back(i);
  Cells names;
  Cells units;
  if (take_keys_over_values(layout, filled, head)) filled.clear();
  const bool keys = are_keys(layout, filled);
  if (!keys && !take_graphtec(layout, filled, head))
    find_names_and_units(layout, filled, names, units, head);
  if (names.size() > layout.cells) take_keys_among_names(names, head);
  spread_names(layout, names);
  compare_names_with_columns(layout, text, names, head);
  if (layout.column_numbers)
    head.warnings.push_back(
        fmt::format("line {} ('{}') is taken to number the columns, not for a row of them",
                    layout.head.size(), to_utf8(trimmed(layout.head.back()).substr(0, 40))));
  if (head.columns.empty()) head.columns = heads_of(names, units);
  if (!layout.key_lines.empty()) take_keys_beside_rows(layout, head);
  for (const std::size_t i : filled) {
    const int line = static_cast<int>(i) + 1;
    const bool only_numbers = layout.column_numbers && i + 1 == layout.head.size();
    if (line != head.names_line && line != head.units_line && !only_numbers)
      add_attribute(layout.head[i], layout, keys, head);
  }
  if (keys) take_column_of_keys(layout.dialect, head);
  take_names_of_keys(layout, head);
  find_interval(layout.dialect, head);
  return head;
}

}  // namespace impactrig::acquisition
