// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/row_of_units.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <string>

#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Quantity;

namespace {

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

}  // namespace

bool is_unit(std::string_view text) {
  return datasets::quantity_of_unit(to_utf8(text)) != Quantity::unknown;
}

std::optional<std::string_view> bracketed(std::string_view text) {
  if (text.size() < 2 || text.back() != (text.front() == '[' ? ']' : ')')) return std::nullopt;
  if (text.front() != '[' && text.front() != '(') return std::nullopt;
  const std::string_view inner = text.substr(1, text.size() - 2);
  int depth = 0;  // "(m/(s^2))", but not "(a) (b)"
  for (const char c : inner) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (text.front() == '(' && (depth < 0 || c == '[' || c == ']')) return std::nullopt;
  }
  return trimmed(inner);
}

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

bool is_sentence_row(const HeadCells& cells) {
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

bool is_figure_word(std::string_view text) {
  constexpr auto words = std::to_array<std::string_view>(
      {"min", "max", "minimum", "maximum", "mean", "average", "avg", "mittelwert", "std", "stddev",
       "rms", "peak", "range", "scale", "sensitivity", "offset", "gain", "start", "coupling"});
  return std::ranges::find(words, lowered(text)) != words.end();
}

bool is_unit_row(const HeadCells& cells) {
  bool any = false;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::string_view cell = cells[c];
    if (cell.empty() || is_index_word(cell)) continue;
    const bool is_name = is_letter_of_a_name(cell, c == 0) || is_name_with_unit(cell);
    if (!bracketed(cell) && (is_name || !is_unit(with_mu(to_utf8(cell))))) return false;
    any = true;
  }
  return any;
}

bool is_nearly_unit_row(const HeadCells& cells) {
  if (std::ranges::any_of(cells, is_time_name)) return false;
  HeadCells units;
  std::ranges::copy_if(cells, std::back_inserter(units),
                       [](std::string_view cell) { return is_unit_row({cell}); });
  return units.size() >= 3 && 3 * (cells.size() - units.size()) <= units.size();
}

bool name_a_time_or_unit(const HeadCells& names) {
  return std::ranges::any_of(names, [](std::string_view cell) {
    const ColumnHead head = split_head(cell);
    return is_time_name(head.name) || (!head.unit.empty() && is_unit(head.unit));
  });
}

bool has_time_over_its_unit(const HeadCells& names, const HeadCells& units) {
  // "Zeit  1 - Standardmessrate"
  const auto is_time = [](std::string_view name) {
    return is_time_name(name) || is_time_name(name.substr(0, name.find("  ")));
  };
  for (std::size_t c = 0; c < std::min(names.size(), units.size()); ++c)
    if (is_time(names[c]) && !is_time_name(units[c]) &&
        datasets::quantity_of_unit(with_mu(to_utf8(bracketed(units[c]).value_or(units[c])))) ==
            Quantity::time)
      return true;
  return false;
}

}  // namespace impactrig::acquisition
