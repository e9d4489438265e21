// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/quoted_lines.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

namespace {

/// What stands between the quotes around a line, with quotes doubled in it; none where the line is
/// no text in quotes.
std::optional<std::string_view> within_quotes(std::string_view line) {
  line = trimmed(line);
  if (line.size() < 2 || line.front() != '"' || line.back() != '"') return std::nullopt;
  const std::string_view inner = line.substr(1, line.size() - 2);
  for (std::size_t i = inner.find('"'); i != inner.npos; i = inner.find('"', i + 2))
    if (i + 1 == inner.size() || inner[i + 1] != '"') return std::nullopt;
  return inner;
}

/// True for several numbers that cannot be one: "1,5" and "1,234.5" may be.
bool is_row_of_numbers(std::string_view text) {
  if (has_thousands_separators(text)) return false;
  return std::ranges::any_of(std::string_view("\t;,| "), [text](char delimiter) {
    const auto cells = cells_of(text, delimiter);
    const bool one_number = delimiter == ',' && cells.size() == 2 && text.find('.') == text.npos;
    return cells.size() > 1 && !one_number && std::ranges::all_of(cells, [](auto cell) {
             return number_in(cell, {'.', false}) || number_in(cell, {',', false});
           });
  });
}

std::string without_quotes_around(std::string_view part) {
  std::string text(part);
  const char* at = part.data();
  const char* const end = at + part.size();
  while (at != end) {
    const auto inner = within_quotes(take_line(at, end));
    if (!inner) continue;
    const auto place = [&](const char* character) {
      return static_cast<std::size_t>(character - part.data());
    };
    text[place(inner->data()) - 1] = ' ';
    text[place(inner->data() + inner->size())] = ' ';
    for (std::size_t i = inner->find('"'); i != inner->npos; i = inner->find('"', i + 2)) {
      // the first of two goes where a cell ends, the second where it begins: blanks within its
      // quotes would count
      const bool begins =
          i == 0 || std::string_view(",;\t|").find((*inner)[i - 1]) != std::string_view::npos;
      text[place(inner->data() + i) + (begins ? 0 : 1)] = ' ';
    }
  }
  return text;
}

/// Where a part that begins at `first` ends with a line, `last` at best, by units of as many bytes
/// as `line_end` has; npos where neither a line nor the text ends soon.
std::size_t end_with_line(std::string_view bytes, std::size_t first, std::size_t last,
                          std::string_view line_end) {
  constexpr std::size_t longest_line = std::size_t{1} << 20;
  const std::size_t unit = line_end.size();
  const std::string_view all = bytes.substr(first, last - first + longest_line);
  const std::size_t best = last - first;
  std::size_t at = all.substr(0, best).rfind(line_end);
  while (at != all.npos && at % unit != 0)
    at = at == 0 ? all.npos : all.substr(0, best).rfind(line_end, at - 1);
  if (at == all.npos) at = all.find(line_end, best < unit ? 0 : best - unit + 1);
  while (at != all.npos && at % unit != 0) at = all.find(line_end, at + 1);
  if (at != all.npos) return first + at + unit;
  return first + all.size() == bytes.size() ? bytes.size() : bytes.npos;
}

}  // namespace

bool has_quoted_lines(std::string_view head) {
  constexpr int lines_tried = 60;
  int rows = 0;
  const char* at = head.data();
  const char* const end = at + head.size();
  for (int i = 0; i < lines_tried && at != end; ++i) {
    const std::string_view line = take_line(at, end);
    if (at == end && i > 0 && !head.ends_with('\n')) break;  // may be cut off
    if (trimmed(line).empty()) continue;
    const auto inner = within_quotes(line);
    if (!inner) return false;
    std::string cells(*inner);
    std::erase(cells, '"');
    if (is_row_of_numbers(cells)) ++rows;
  }
  return rows > 1;
}

Rewriting without_quoted_lines(Rewriting of_bytes) {
  Rewriting rewriting = no_rewriting(of_bytes.mark);
  rewriting.line_end = of_bytes.line_end;
  rewriting.part = [part = std::move(of_bytes.part)](std::string_view bytes) {
    return without_quotes_around(part(bytes));
  };
  rewriting.end = [end = std::move(of_bytes.end), line_end = std::move(of_bytes.line_end)](
                      std::string_view bytes, std::size_t first, std::size_t last) {
    const std::size_t with_line = end_with_line(bytes, first, last, line_end);
    // a line without end is no row: it may keep its quotes
    return with_line != bytes.npos ? with_line : end(bytes, first, last);
  };
  return rewriting;
}

}  // namespace impactrig::acquisition
