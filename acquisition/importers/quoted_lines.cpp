// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/quoted_lines.hpp"

#include <algorithm>
#include <optional>
#include <string>

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

Rewriting quoted_lines_rewriting(std::size_t mark) {
  return {.mark = mark,
          .part = without_quotes_around,
          .end = [](std::string_view all, std::size_t first, std::size_t last) {
            const std::size_t before = all.substr(first, last - first).rfind('\n');
            if (before != all.npos) return first + before + 1;
            const std::size_t behind = all.find('\n', last);
            return behind == all.npos ? all.size() : behind + 1;
          }};
}

}  // namespace impactrig::acquisition
