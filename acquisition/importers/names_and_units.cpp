// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/names_and_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "acquisition/importers/column_keys.hpp"
#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/instrument_heads.hpp"
#include "acquisition/importers/labelled_lines.hpp"
#include "acquisition/importers/row_of_units.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Quantity;

namespace {

bool has_number(const HeadCells& cells, char decimal) {
  return std::any_of(cells.begin(), cells.end(), [decimal](std::string_view cell) {
    return number_in(cell, {decimal, false}).has_value();
  });
}

/// Takes Start and Increment out of names and units ("X,CH1,Start,Increment" above
/// "Sequence,Volt,-3e-07,5e-10").
void take_start_and_increment(HeadCells& names, HeadCells& units, char decimal, TableHead& head) {
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

/// True for a line of words that could name columns, but that does not fit them.
bool may_be_names_of_others(std::string_view line, const TableLayout& layout) {
  const std::string_view text = trimmed(without_comment_sign(line));
  const HeadCells words = cells_of(text, ' ');
  return words.size() > 1 && text.find_first_of(":=") == std::string_view::npos &&
         !has_number(words, layout.dialect.decimal) && head_cells(line, layout).empty();
}

void tell_of_misfit(const TableLayout& layout, std::size_t line, TableHead& head) {
  const std::string_view text = trimmed(layout.head[line]);
  head.warnings.push_back(fmt::format(
      "line {} above the rows ('{}') does not fit their {} column{}: they are numbered", line + 1,
      to_utf8(text.substr(0, 60)), layout.cells, layout.cells == 1 ? "" : "s"));
}

/// "D0-D7"
bool are_logic_lines(std::string_view name) {
  const std::size_t dash = name.find('-');
  return dash != name.npos && name.front() == 'D' && integer_in(name.substr(1, dash - 1)) &&
         name.substr(dash + 1).starts_with('D') && integer_in(name.substr(dash + 2));
}

/// "x-axis,1,2", as InfiniiVision oscilloscopes name their channels.
bool are_numbered_channels(const HeadCells& names) {
  return lowered(names.front()) == "x-axis" &&
         std::all_of(names.begin() + 1, names.end(), [](std::string_view name) {
           return name.empty() || integer_in(name).has_value() || are_logic_lines(name);
         });
}

/// Numbers and nothing else: neither names nor units.
bool has_numbers_alone(std::string_view line) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto may_be_word = [](char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '%' || (c & 0x80) != 0;
  };
  return std::ranges::any_of(line, is_digit) && std::ranges::none_of(line, may_be_word);
}

/// The words that a line begins with where it lists a channel.
constexpr auto channel_words = std::to_array<std::string_view>({"channel", "kanal", "ch"});

/// "force [N]" of "# 2: force [N]" and "Column 2 = force [N]", the name of column 2 where columns
/// count from `first`; `words` may stand before the number.
std::optional<std::string_view> listed_name(std::string_view line, std::size_t column, long first,
                                            std::span<const std::string_view> words) {
  std::string_view text = trimmed(without_comment_sign(line));
  const std::string begin = lowered(text.substr(0, 7));
  for (const std::string_view word : words)
    if (begin.starts_with(word)) {
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

/// "Ch 2: Force / N", with whatever number.
bool lists_a_channel(std::string_view line) {
  std::string_view text = trimmed(without_comment_sign(line));
  const std::string begin = lowered(text.substr(0, 7));
  const auto word = std::ranges::find_if(
      channel_words, [&](std::string_view each) { return begin.starts_with(each); });
  if (word == channel_words.end()) return false;
  text = trimmed(text.substr(word->size()));
  const std::size_t end = text.find_first_not_of("0123456789");
  return end != 0 && end != text.npos && end + 1 < text.size() &&
         std::string_view(":=").find(trimmed(text.substr(end)).front()) != std::string_view::npos;
}

/// Names in the last lines above the rows, one a line in the order of the columns: "# 1: time [ms]"
/// over "# 2: force [N]". None where they are not listed so.
HeadCells listed_names(const TableLayout& layout, const std::vector<std::size_t>& filled) {
  constexpr auto words = std::to_array<std::string_view>({"column", "spalte", "col"});
  if (layout.cells < 2 || filled.size() < layout.cells) return {};
  for (const long first : {1L, 0L}) {
    HeadCells names;
    for (std::size_t c = 0; c < layout.cells; ++c) {
      const std::size_t line = filled[filled.size() - layout.cells + c];
      const auto name = listed_name(layout.head[line], c, first, words);
      if (!name) break;
      names.push_back(*name);
    }
    if (names.size() == layout.cells) return names;
  }
  return {};
}

/// "Time,10:11:12,10:11:12": when each channel began.
bool are_dates_of_a_key(const HeadCells& cells) {
  return cells.size() > 1 && std::all_of(cells.begin() + 1, cells.end(),
                                         [](auto cell) { return date_time_in(cell).has_value(); });
}

/// "Unit:,N,g" and "VUnit,V,A"
bool are_units_of_a_key(const HeadCells& cells) {
  return cells.size() > 1 && is_unit_label(cells.front());
}

/// "X unit,s": a key of the times and its value, no cells over columns.
bool is_unit_of_axis(const HeadCells& cells) {
  return cells.size() > 1 &&
         (is_horizontal_unit_key(cells.front()) || is_vertical_unit_key(cells.front()));
}

/// Numbers of columns (positions, angles) beside the name of a time: "Time [ms],1,2,3".
bool may_name_by_number(const HeadCells& names, const TableLayout& layout) {
  if (names.size() < layout.cells || names.empty()) return false;
  const ColumnHead time = split_head(names.front());
  const bool has_unit = datasets::quantity_of_unit(time.unit) == Quantity::time;
  if (!is_time_name(time.name) || (!has_unit && (!time.unit.empty() || names.size() < 3)))
    return false;
  return std::all_of(names.begin() + 1, names.end(), [&layout](std::string_view name) {
    return integer_in(name) || !number_in(name, {layout.dialect.decimal, false});
  });
}

/// Whether a cell says what is measured: "Force", "Velocity [m/s]".
bool says_quantity(std::string_view cell) {
  const ColumnHead head = split_head(cell);
  return (!head.unit.empty() && is_unit(head.unit)) ||
         quantity_of_first_word(head.name) != Quantity::unknown;
}

/// Names of columns, of which a few may be numbers: "Time [ms],1,2,3", positions of sensors, and
/// "Force,Stroke,4712", the serial number of one, where a name says what is measured, or the line
/// below does.
bool may_be_names(const HeadCells& names, const TableLayout& layout, bool over_units = false) {
  if (!has_number(names, layout.dialect.decimal) || may_name_by_number(names, layout)) return true;
  std::size_t numbers = 0;
  for (const std::string_view name : names) {
    if (!number_in(name, {layout.dialect.decimal, false})) continue;
    if (!integer_in(name)) return false;
    ++numbers;
  }
  return names.size() >= layout.cells && names.size() > 2 * numbers &&
         (over_units || std::ranges::any_of(names, says_quantity)) &&
         !is_figure_word(names.front());
}

/// Names over units with a time among them, above further lines of each channel (sensors, serial
/// numbers): which of the filled lines holds the units; none where there are no such.
std::optional<std::size_t> find_units_of_time(const TableLayout& layout,
                                              const std::vector<std::size_t>& filled) {
  for (std::size_t i = filled.size(); i-- > 1;) {
    const HeadCells units = head_cells(layout.head[filled[i]], layout);
    const HeadCells names = head_cells(layout.head[filled[i - 1]], layout);
    if (units.size() >= layout.cells && names.size() >= layout.cells &&
        may_be_names(names, layout, true) && !has_number(units, layout.dialect.decimal) &&
        !is_unit_of_axis(units) && has_time_over_its_unit(names, units))
      return i;
  }
  return std::nullopt;
}

/// Names above units, in the last two lines; false where they are none.
bool take_names_over_units(const TableLayout& layout, const std::vector<std::size_t>& filled,
                           NamesAndUnits& found, TableHead& head) {
  if (filled.size() < 2) return false;
  const char decimal = layout.dialect.decimal;
  const HeadCells bottom = head_cells(layout.head[filled.back()], layout);
  const std::size_t above = filled[filled.size() - 2];
  HeadCells names = head_cells(layout.head[above], layout);
  HeadCells units = bottom;
  if (are_units_of_a_key(names) && !is_unit_row(bottom))
    return false;  // "X unit,s" over "Y unit,N"
  // "Unit,kN,mm/s" over rows whose first cell is empty
  if (!units.empty() && are_units_of_a_key(units)) units.front() = {};
  if (names.size() < layout.cells || (!may_be_names(names, layout, is_unit_row(units)) &&
                                      !(are_numbered_channels(names) && is_unit_row(bottom))))
    return false;
  take_start_and_increment(names, units, decimal, head);
  if (filled.size() > 2 && trimmed(layout.head.front()).starts_with("Vernier Format"))
    if (HeadCells long_names = head_cells(layout.head[filled[filled.size() - 3]], layout);
        long_names.size() == names.size())
      names = std::move(long_names);  // over the short ones: "Time", "T", "s"
  const bool as_wide =
      bottom.size() >= layout.cells || head.start || head.increment || are_numbered_channels(names);
  if (!as_wide ||
      !(is_unit_row(units) || is_sentence_row(units) || has_time_over_its_unit(names, units) ||
        (is_nearly_unit_row(units) && !is_nearly_unit_row(names)))) {
    head.start.reset();
    head.increment.reset();
    return false;
  }
  found = {names, units};
  head.names_line = static_cast<int>(above) + 1;
  head.units_line = static_cast<int>(filled.back()) + 1;
  return true;
}

/// Units below words that are names of no column, or of other columns; false for other lines.
bool take_units_under_a_misfit(const TableLayout& layout, const std::vector<std::size_t>& filled,
                               NamesAndUnits& found, TableHead& head) {
  if (layout.dialect.delimiter != ' ' || filled.size() < 2) return false;
  const HeadCells bottom = head_cells(layout.head[filled.back()], layout);
  const std::size_t above = filled[filled.size() - 2];
  if (!is_unit_row(bottom) || !may_be_names_of_others(layout.head[above], layout)) return false;
  tell_of_misfit(layout, above, head);
  found.units = bottom;
  head.units_line = static_cast<int>(filled.back()) + 1;
  return true;
}

/// Names in the last line, and units in that above it where a time is among them: "s,N" above
/// "time,force".
void take_names_alone(const TableLayout& layout, const std::vector<std::size_t>& filled,
                      NamesAndUnits& found, TableHead& head) {
  const HeadCells bottom = head_cells(layout.head[filled.back()], layout);
  if (bottom.empty() && may_be_names_of_others(layout.head[filled.back()], layout))
    tell_of_misfit(layout, filled.back(), head);
  // a shorter line is taken for names only when it cannot be a title or a key with its value
  const bool all_named = bottom.size() >= layout.cells || (bottom.size() > 1 && layout.cells > 2);
  if (bottom.empty() || !all_named) return;
  if (!may_be_names(bottom, layout)) return;
  if (are_dates_of_a_key(bottom) || are_units_of_a_key(bottom)) return;
  found.names = bottom;
  head.names_line = static_cast<int>(filled.back()) + 1;
  if (filled.size() < 2) return;
  const std::size_t above = filled[filled.size() - 2];
  const HeadCells over = head_cells(layout.head[above], layout);
  if (over.size() < layout.cells || !is_unit_row(over) ||
      !has_time_over_its_unit(found.names, over))
    return;
  found.units = over;
  head.units_line = static_cast<int>(above) + 1;
}

/// "Time","ms","Force","kN" over two columns: each name with its unit in the next cell.
bool take_names_beside_units(const TableLayout& layout, const std::vector<std::size_t>& filled,
                             NamesAndUnits& found, TableHead& head) {
  HeadCells cells =
      cells_of(without_comment_sign(layout.head[filled.back()], layout), layout.dialect.delimiter);
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
  if (layout.cells < 2 || cells.size() != 2 * layout.cells) return false;
  HeadCells names, units;
  for (std::size_t i = 0; i < cells.size(); ++i) (i % 2 == 0 ? names : units).push_back(cells[i]);
  const auto is_name = [](std::string_view cell) { return !cell.empty() && !is_unit(cell); };
  if (has_number(names, layout.dialect.decimal) || !std::ranges::all_of(names, is_name) ||
      !std::ranges::all_of(units, is_unit))
    return false;
  found = {names, units};
  head.names_line = head.units_line = static_cast<int>(filled.back()) + 1;
  return true;
}

/// "#timebase=40000000(ps),#voltbase=1000000(uV)", of Hantek: no names.
bool are_keys_with_values(std::string_view line, char delimiter) {
  const HeadCells cells = cells_of(line, delimiter);
  if (cells.size() > 1 && cells.front().size() > 1 && cells.front().ends_with('=')) return true;
  return trimmed(line).starts_with('#') && std::ranges::all_of(cells, [](std::string_view cell) {
           const std::size_t equals = cell.find('=');
           return equals != cell.npos && equals > 0 && equals + 1 < cell.size() &&
                  std::string_view("+-.0123456789").find(cell[equals + 1]) != cell.npos;
         });
}

/// Names in the table's own dialect, as many as there are columns.
bool are_names_in_dialect(std::string_view line, const TableLayout& layout) {
  HeadCells names = cells_of(without_comment_sign(line, layout), layout.dialect.delimiter);
  while (!names.empty() && names.back().empty()) names.pop_back();
  return names.size() >= layout.cells && names.size() <= layout.written_cells &&
         std::ranges::none_of(names, &std::string_view::empty) && may_be_names(names, layout) &&
         !are_keys_with_values(line, layout.dialect.delimiter);
}

/// Leaves out remarks between names and rows: a comment under names that are none, or words that
/// the delimiter does not divide, where these name neither a time nor a unit themselves.
void pass_over_remarks(const TableLayout& layout, std::vector<std::size_t>& filled) {
  if (layout.dialect.delimiter == ' ' || layout.cells < 2) return;
  const auto is_comment = [](std::string_view line) {
    return trimmed(line).starts_with('#') || trimmed(line).starts_with('%');
  };
  while (filled.size() > 1) {
    const std::string_view line = layout.head[filled.back()];
    const std::string_view above = layout.head[filled[filled.size() - 2]];
    const HeadCells cells = cells_of(without_comment_sign(line, layout), layout.dialect.delimiter);
    const bool remark = cells.size() < 2 || (is_comment(line) && !is_comment(above));
    const HeadCells words = head_cells(line, layout);
    if (!remark || !are_names_in_dialect(above, layout) || is_unit_row(words) ||
        name_a_time_or_unit(words))
      return;
    // a key with its value has fewer cells
    constexpr std::size_t more_than_keys = 4;
    const HeadCells names = cells_of(without_comment_sign(above, layout), layout.dialect.delimiter);
    if (!name_a_time_or_unit(names) && layout.written_cells < more_than_keys) return;
    filled.pop_back();
  }
}

/// The first of the cells is a word for figures of the columns: "Gain,10,100", "Sensitivity,4
/// pC/N".
bool begins_as_figures(std::string_view line, const TableLayout& layout) {
  const HeadCells cells = cells_of(line, layout.dialect.delimiter);
  if (cells.size() < 2 || cells.size() > layout.written_cells) return false;
  std::string_view word = cells.front();
  if (word.ends_with(':')) word.remove_suffix(1);
  return is_figure_word(word);
}

/// "Max,80,3" under names: figures of the columns, by a word for them in the first.
bool are_figures(std::string_view line, const TableLayout& layout) {
  if (!begins_as_figures(line, layout)) return false;
  const HeadCells cells = cells_of(line, layout.dialect.delimiter);
  const auto is_figure = [&](std::string_view cell) {
    return cell.empty() || cell_value(cell, layout.dialect.decimal).has_value();
  };
  return std::all_of(cells.begin() + 1, cells.end(), is_figure) && !cells[1].empty();
}

void tell_of_figures(const TableLayout& layout, std::size_t line, TableHead& head) {
  head.warnings.push_back(
      fmt::format("line {} under the names ('{}') holds figures of the columns: it is not used",
                  line + 1, to_utf8(trimmed(layout.head[line]).substr(0, 60))));
}

/// "Time [ms],Force [kN],Velocity [mm/s]": a time, and a unit in each cell but that over numbers of
/// the rows.
bool are_complete(const HeadCells& names) {
  bool time = false;
  for (const std::string_view cell : names) {
    const ColumnHead head = split_head(cell);
    if (cell.data() == names.front().data() && is_index_word(head.name)) continue;
    if (head.name.empty() || head.unit.empty() || !is_unit(head.unit)) return false;
    time = time ||
           (is_time_name(head.name) && datasets::quantity_of_unit(head.unit) == Quantity::time);
  }
  return time && names.size() > 1;
}

/// "Time,Force,Velocity": a time as the first of several, of which another says what it measures.
bool begin_with_time(const HeadCells& names) {
  return names.size() > 1 && is_time_name(split_head(names.front()).name) &&
         std::any_of(names.begin() + 1, names.end(), says_quantity);
}

/// Whether a line may hold names, or units, of its own: words for what is measured, a label.
bool may_be_other_names(const HeadCells& cells) {
  return is_unit_row(cells) || is_nearly_unit_row(cells) || is_sentence_row(cells) ||
         std::ranges::any_of(cells, says_quantity) ||
         (!cells.empty() && (is_unit_label(cells.front()) || is_name_label(cells.front())));
}

/// Leaves out what stands between names with a time, or their units, and the rows: sensors, serial
/// numbers, types, inputs. Tells of figures among it.
void pass_over_lines_under_time(const TableLayout& layout, std::vector<std::size_t>& filled,
                                TableHead& head) {
  const auto keep = [&](std::vector<std::size_t> kept) {
    for (const std::size_t line : filled)
      if (std::ranges::find(kept, line) == kept.end() &&
          begins_as_figures(layout.head[line], layout))
        tell_of_figures(layout, line, head);
    filled = std::move(kept);
  };
  if (const auto at = find_units_of_time(layout, filled))
    return keep({filled.begin(), filled.begin() + static_cast<std::ptrdiff_t>(*at) + 1});
  for (std::size_t i = filled.size(); i-- > 0;) {
    const HeadCells names =
        cells_of(without_comment_sign(layout.head[filled[i]], layout), layout.dialect.delimiter);
    if (!are_names_in_dialect(layout.head[filled[i]], layout)) continue;
    const bool complete = are_complete(names);
    if (!complete && !begin_with_time(names)) continue;
    if (i + 1 == filled.size()) return;
    std::vector<std::size_t> kept(filled.begin(),
                                  filled.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    for (std::size_t j = i + 1; j < filled.size() && !complete; ++j) {
      const HeadCells below = head_cells(layout.head[filled[j]], layout);
      const bool units = below.size() >= layout.cells && has_time_over_its_unit(names, below);
      if (units && j > i + 1) {
        kept.push_back(filled[j]);
        break;
      }
      if (may_be_other_names(below)) return;
    }
    return keep(std::move(kept));
  }
}

/// Passes over such lines between names (or their units) and rows, and tells of each.
void pass_over_figures(const TableLayout& layout, std::vector<std::size_t>& filled,
                       TableHead& head) {
  std::vector<std::size_t> others = filled;
  while (others.size() > 1 && are_figures(layout.head[others.back()], layout)) others.pop_back();
  if (others.size() == filled.size()) return;
  const std::string_view above = layout.head[others.back()];
  // a key with its value stands under another one
  const HeadCells names = cells_of(without_comment_sign(above, layout), layout.dialect.delimiter);
  if (!are_names_in_dialect(above, layout) ||
      !(name_a_time_or_unit(names) || is_unit_row(names) || are_units_of_a_key(names)))
    return;
  for (std::size_t i = others.size(); i < filled.size(); ++i)
    tell_of_figures(layout, filled[i], head);
  filled = std::move(others);
}

/// Names in lines "Ch1: Force / N" over "Ch2: Velocity / m/s" anywhere in the head, each with its
/// unit, one a column or one for each but the first, counted from 1 or from 0; none where the head
/// has a line of names, or lists more. Of several lists the last counts.
HeadCells listed_channels(const TableLayout& layout, const std::vector<std::size_t>& filled,
                          TableHead& head) {
  const auto is_listed = [&](std::size_t line) { return lists_a_channel(layout.head[line]); };
  const auto name_at = [&](std::size_t line, std::size_t channel, long first) -> std::string_view {
    const auto name = is_listed(line)
                          ? listed_name(layout.head[line], channel, first, channel_words)
                          : std::nullopt;
    if (!name) return {};
    const ColumnHead parts = split_head(*name);
    const bool has_both = !parts.name.empty() && !parts.unit.empty() && is_unit(parts.unit);
    const bool figure = is_figure_word(parts.name) || lowered(parts.name).starts_with("full scale");
    return has_both && !figure && !number_in(parts.name, {'.', false}) ? *name : std::string_view{};
  };
  const bool named = std::ranges::any_of(filled, [&](std::size_t line) {
    return !is_listed(line) && are_names_in_dialect(layout.head[line], layout);
  });
  if (named) return {};
  for (const long first : {1L, 0L})
    for (std::size_t at = filled.size(); at-- > 0;) {
      if (at > 0 && !name_at(filled[at - 1], 0, first - 1).empty()) continue;  // goes on from it
      std::vector<std::string_view> names;
      for (std::size_t i = at; i < filled.size(); ++i) {
        const std::string_view name = name_at(filled[i], i - at, first);
        if (name.empty()) break;
        names.push_back(name);
      }
      if (names.size() != layout.cells && names.size() + 1 != layout.cells) continue;
      head.names_line = static_cast<int>(filled[at]) + 1;
      HeadCells of_columns(layout.cells - names.size());
      of_columns.insert(of_columns.end(), names.begin(), names.end());
      return of_columns;
    }
  return {};
}

/// "Time,Force,Force" over ",hammer,bar", with units beside the upper names or below: names of the
/// lower line where the upper one has a name twice; none of other heads.
NamesAndUnits names_told_apart(const TableLayout& layout, const std::vector<std::size_t>& filled,
                               TableHead& head) {
  const auto cells_at = [&](std::size_t k) {
    HeadCells cells =
        cells_of(without_comment_sign(layout.head[filled[k]], layout), layout.dialect.delimiter);
    return cells.size() == layout.cells ? cells : HeadCells{};
  };
  for (std::size_t k = filled.size(); k-- > 1;) {
    const HeadCells upper = cells_at(k - 1), lower = cells_at(k);
    if (upper.size() < 3 || lower.empty() || !is_time_name(split_head(upper.front()).name) ||
        is_unit_row(lower) || is_sentence_row(lower) || has_time_over_its_unit(upper, lower) ||
        has_number(lower, layout.dialect.decimal))
      continue;
    NamesAndUnits found;
    bool told_apart = false;
    for (std::size_t c = 0; c < upper.size(); ++c) {
      const ColumnHead own = split_head(upper[c]);
      const bool repeated = std::ranges::count(upper, upper[c]) > 1;
      const bool alone = !lower[c].empty() && std::ranges::count(lower, lower[c]) == 1;
      told_apart = told_apart || repeated;
      if (own.name.empty() || (repeated && !alone)) return {};
      found.names.push_back(repeated ? lower[c] : upper[c]);
      const std::size_t unit = own.unit.empty() ? upper[c].npos : upper[c].rfind(own.unit);
      found.units.push_back(unit == upper[c].npos ? std::string_view{}
                                                  : upper[c].substr(unit, own.unit.size()));
    }
    if (!told_apart) continue;
    head.names_line = static_cast<int>(filled[k]) + 1;
    head.units_line = static_cast<int>(filled[k - 1]) + 1;
    if (k + 1 < filled.size())
      if (HeadCells below = cells_at(k + 1); has_time_over_its_unit(upper, below)) {
        found.units = std::move(below);
        head.units_line = static_cast<int>(filled[k + 1]) + 1;
      }
    return found;
  }
  return {};
}

}  // namespace

NamesAndUnits find_names_and_units(const TableLayout& layout, std::vector<std::size_t> filled,
                                   TableHead& head) {
  NamesAndUnits found;
  if (layout.key_cells > 0 || take_toa5(layout, filled, found.names, found.units, head))
    return found;
  if (found = labelled_names(layout, filled, head); !found.names.empty()) return found;
  if (found = labelled_names_over_times(layout, filled, head); !found.names.empty()) return found;
  if (found.names = listed_names(layout, filled); !found.names.empty()) {
    head.names_line = static_cast<int>(filled.back()) + 1;
    return found;
  }
  if (found.names = listed_channels(layout, filled, head); !found.names.empty()) return found;
  if (found = names_told_apart(layout, filled, head); !found.names.empty()) return found;
  while (filled.size() > 1 && lists_a_channel(layout.head[filled.back()])) filled.pop_back();
  pass_over_lines_under_time(layout, filled, head);
  while (filled.size() > 1 && has_numbers_alone(layout.head[filled.back()])) filled.pop_back();
  while (!filled.empty() &&
         are_keys_with_values(layout.head[filled.back()], layout.dialect.delimiter))
    filled.pop_back();
  pass_over_figures(layout, filled, head);
  pass_over_remarks(layout, filled);
  if (filled.empty() || take_names_beside_units(layout, filled, found, head) ||
      take_names_over_units(layout, filled, found, head) ||
      take_units_under_a_misfit(layout, filled, found, head))
    return found;
  take_names_alone(layout, filled, found, head);
  return found;
}

}  // namespace impactrig::acquisition
