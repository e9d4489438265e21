// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mts_tables.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {
namespace {

/// A head and the rows below it.
struct Block {
  const char* begin = nullptr;
  std::size_t line = 0;        ///< of the text, which it begins with
  std::string_view last_head;  ///< the line above the rows: units, or names
  std::size_t rows = 0;
};

/// "Data Acquisition			Time:	267,00293	s	08.04.2014 09:42:07", in any
/// language.
bool begins_block(std::string_view line) {
  const auto cells = cells_of(line, '\t');
  for (std::size_t c = 1; c + 2 < cells.size(); ++c)
    if (cells[c].size() > 1 && cells[c].ends_with(':') && cells[c + 2] == "s" &&
        (number_in(cells[c + 1], {'.', false}) || number_in(cells[c + 1], {',', false})))
      return true;
  return false;
}

bool begins_with_number(std::string_view line) {
  const std::string_view text = trimmed(line);
  return !text.empty() && std::string_view("0123456789+-.,").find(text.front()) != text.npos;
}

std::vector<Block> blocks_of(std::string_view text) {
  std::vector<Block> blocks;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (std::size_t number = 0; at != end; ++number) {
    const char* const begin = at;
    const std::string_view line = take_line(at, end);
    if (begins_block(line))
      blocks.push_back({.begin = begin, .line = number, .last_head = {}, .rows = 0});
    else if (!blocks.empty() && begins_with_number(line))
      ++blocks.back().rows;
    else if (!blocks.empty() && blocks.back().rows == 0 && !trimmed(line).empty())
      blocks.back().last_head = trimmed(line);
  }
  std::erase_if(blocks, [](const Block& block) { return block.rows == 0; });
  return blocks;
}

}  // namespace

MtsTable mts_table(std::string_view text, std::size_t lines, std::optional<std::size_t> stated) {
  if (!text.starts_with("MTS793|")) return {};
  std::vector<Block> tables;  // blocks of the same columns in a row
  for (const Block& block : blocks_of(text))
    if (!tables.empty() && tables.back().last_head == block.last_head)
      tables.back().rows += block.rows;
    else
      tables.push_back(block);
  if (tables.size() < 2) return {};
  const auto last = std::ranges::find_if(tables, [=](const Block& t) { return t.line >= lines; });
  auto chosen = std::max_element(tables.begin(), last,
                                 [](const Block& a, const Block& b) { return a.rows < b.rows; });
  if (stated)
    chosen = std::find_if(tables.begin(), last, [&](const Block& t) { return t.line >= *stated; });
  if (chosen == last) return {};
  MtsTable found;
  found.skipped_lines = stated.value_or(chosen == tables.begin() ? 0 : chosen->line);
  if (!stated && chosen != tables.begin()) {
    const char* at = tables.front().begin;
    found.above = trimmed(take_line(at, text.data() + text.size()));
  }
  if (chosen + 1 != tables.end()) found.end = (chosen + 1)->begin;
  return found;
}

}  // namespace impactrig::acquisition
