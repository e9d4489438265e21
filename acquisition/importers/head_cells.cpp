// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/head_cells.hpp"

#include <algorithm>
#include <cstddef>

#include "acquisition/importers/row_of_units.hpp"

namespace impactrig::acquisition {

namespace {

void drop_empty_end(HeadCells& cells) {
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
}

/// A text divided where it has a tab or two blanks.
HeadCells divided_at_gaps(std::string_view text) {
  HeadCells cells;
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
HeadCells divided_with_units(std::string_view text) {
  HeadCells words;
  std::size_t start = 0;
  int depth = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && (text[i] == '[' || text[i] == '(')) ++depth;
    if (i < text.size() && (text[i] == ']' || text[i] == ')')) --depth;
    if (i < text.size() && (depth > 0 || (text[i] != ' ' && text[i] != '\t'))) continue;
    if (i > start) words.push_back(text.substr(start, i - start));
    start = i + 1;
  }
  HeadCells cells;
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

}  // namespace

std::string_view without_comment_sign(std::string_view line) {
  std::string_view text = trimmed(line);
  const bool comment = !text.empty() && (text.front() == '#' || text.front() == '%');
  while (!text.empty() && (text.front() == '#' || text.front() == '%')) text.remove_prefix(1);
  if (!comment && text.starts_with("//")) text.remove_prefix(2);
  // "; Samplerate: 1 MHz", of sigrok, which divides nothing
  if (!comment && text.starts_with("; ") && text.find(';', 1) == text.npos &&
      text.find(':') != text.npos)
    text.remove_prefix(2);
  else if (!comment && text.starts_with(';') && text.find(';', 1) == text.npos &&
           std::ranges::count(text, ',') > 1)  // ";Headers, time,Ax,Ay" of Gulf Coast Data Concepts
    text.remove_prefix(1);
  // blanks are kept where the line is no comment: an empty first cell counts
  return comment || text.size() != trimmed(line).size() ? trimmed(text) : line;
}

std::string_view without_comment_sign(std::string_view line, const TableLayout& layout) {
  const std::string_view text = trimmed(line);
  const bool may_be_name = layout.dialect.delimiter == '\t' && text.starts_with("#\t");
  if (!may_be_name) return without_comment_sign(line);
  HeadCells cells = cells_of(text, '\t');
  drop_empty_end(cells);
  return cells.size() == layout.cells ? text.substr(1) : without_comment_sign(line);
}

HeadCells head_cells(std::string_view line, const TableLayout& layout) {
  const std::string_view text = without_comment_sign(line, layout);
  const auto divided = [&text](char delimiter) {
    HeadCells cells = cells_of(text, delimiter);
    drop_empty_end(cells);
    return cells;
  };
  const bool blank = layout.dialect.delimiter == ' ';
  HeadCells own = blank ? HeadCells{} : divided(layout.dialect.delimiter);
  // a semicolon may begin a remark where it divides cells too: it is no cell before the first then
  if (layout.dialect.delimiter == ';' && own.size() == layout.cells + 1 && own.front().empty() &&
      layout.written_cells == layout.cells)
    own.erase(own.begin());
  if (!blank && own.size() >= layout.cells) return own;
  const auto fits = [&layout](const HeadCells& cells) {
    return cells.size() <= layout.cells && cells.size() + layout.cells_beside() >= layout.cells &&
           std::none_of(cells.begin(), cells.end(), [](auto cell) { return cell.empty(); });
  };
  if (blank && trimmed(text).starts_with('"'))
    // in quotes, as R has them: without a name for the numbers of the rows
    if (HeadCells cells = divided(' ');
        fits(cells) || (cells.size() > 1 && cells.size() + 1 == layout.cells))
      return cells;
  if (own.size() < 2)  // else its blanks are part of names
    for (const auto& divide : {divided_at_gaps, divided_with_units})
      if (HeadCells cells = divide(text); fits(cells)) return cells;
  for (const char other : {'\t', ';', ',', '|'})
    if (HeadCells cells = divided(other); fits(cells)) return cells;
  return own;
}

}  // namespace impactrig::acquisition
