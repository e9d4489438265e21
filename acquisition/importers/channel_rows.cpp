// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/channel_rows.hpp"

#include <algorithm>
#include <utility>

#include "acquisition/importers/date_columns.hpp"
#include "acquisition/importers/spool.hpp"
#include "acquisition/importers/text_dialect.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::size_t fewest_cells = 64;       ///< of a row
constexpr std::size_t fewest_cells_a_row = 8;  ///< of a row, for each of the rows
constexpr std::size_t most_names = 2;          ///< cells before the numbers: a name and a unit
constexpr std::size_t piece = std::size_t{1} << 20;           ///< [bytes]
constexpr std::size_t most_in_memory = std::size_t{1} << 25;  ///< [bytes]

/// Takes the cells of a line one after another.
class CellCursor {
 public:
  CellCursor(std::string_view line, char delimiter)
      : at_(line.data()),
        end_(line.data() + line.size()),
        delimiter_(delimiter) {
    skip_blanks();
    ended_ = at_ == end_;
  }

  bool ended() const { return ended_; }

  const char* at() const { return at_; }

  /// The next one as it is written, without blanks around it.
  std::string_view take() {
    const char* const start = at_;
    bool quoted = false;
    while (at_ != end_ && (quoted || !divides(*at_))) quoted = (*at_++ == '"') != quoted;
    const std::string_view cell = trimmed({start, static_cast<std::size_t>(at_ - start)});
    if (at_ != end_ && delimiter_ != ' ') ++at_;
    skip_blanks();
    ended_ = at_ == end_;
    return cell;
  }

 private:
  bool divides(char c) const { return delimiter_ == ' ' ? c == ' ' || c == '\t' : c == delimiter_; }

  void skip_blanks() {
    while (at_ != end_ && delimiter_ == ' ' && divides(*at_)) ++at_;
  }

  const char* at_;
  const char* end_;
  char delimiter_;
  bool ended_;
};

/// Lines that are neither empty nor remarks; none where there are more than may hold a channel
/// each.
std::optional<ChannelRows> few_lines(const TextFile& file, std::string_view text, int skipped) {
  ChannelRows found;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int i = 0; at != end; ++i) {
    const char* const start = at;
    const std::string_view line = take_line(at, end);
    file.release(start, at);
    if (trimmed(line).empty() || line == "\x1A") continue;  // which ended files of DOS
    const bool remark = i < skipped || line.starts_with('#') || line.starts_with('%');
    if (remark && !found.rows.empty()) continue;
    std::vector<std::string_view>& lines = remark ? found.head : found.rows;
    if (lines.size() == most_channel_rows) return std::nullopt;
    lines.push_back(line);
  }
  return found.rows.empty() ? std::nullopt : std::optional(std::move(found));
}

/// How many cells stand before the numbers of a row of at least `fewest`; none where it is no such
/// row.
std::optional<std::size_t> names_before(std::string_view row, const Dialect& dialect,
                                        std::size_t fewest) {
  CellCursor cells(row, dialect.delimiter);
  std::size_t count = 0;
  std::size_t names = 0;
  std::size_t numbers = 0;
  for (; count < fewest && !cells.ended(); ++count) {
    const std::string_view cell = without_quotes(cells.take());
    const bool number =
        number_in(cell, {dialect.decimal, false}) || grouped_number_in(cell, dialect.decimal);
    const bool missing = cell_value(cell, dialect.decimal) || marks_missing(cell);
    if (number)
      ++numbers;
    else if (count == names && count < most_names && !missing && !is_part_of_date(cell))
      ++names;
    else if (!missing)
      return std::nullopt;
  }
  return count == fewest && 2 * numbers > fewest ? std::optional(names) : std::nullopt;
}

/// Moves the lines above the rows that are too short for one to the head: titles.
void take_titles(std::size_t fewest, ChannelRows& found, char delimiter) {
  const auto is_row = [&](std::string_view line) {
    CellCursor cells(line, delimiter);
    std::size_t count = 0;
    for (; count < fewest && !cells.ended(); ++count) cells.take();
    return count == fewest;
  };
  const auto first = std::ranges::find_if(found.rows, is_row);
  found.head.insert(found.head.end(), found.rows.begin(), first);
  found.rows.erase(found.rows.begin(), first);
}

/// Whether a remark above names columns: then the lines are samples.
bool names_columns(const std::vector<std::string_view>& head, char delimiter) {
  return std::ranges::any_of(head, [delimiter](std::string_view line) {
    return named_columns(line, {.delimiter = delimiter}) >= fewest_cells;
  });
}

}  // namespace

std::optional<ChannelRows> find_channel_rows(TextFile& file, const ImportOptions& options) {
  const auto lines = few_lines(file, file.text(), options.skip_lines.value_or(0));
  if (!lines) return std::nullopt;
  const std::size_t fewest = std::max(fewest_cells, fewest_cells_a_row * lines->rows.size());
  const auto holds = [&](char mark) {
    return std::ranges::any_of(lines->rows,
                               [mark](auto row) { return row.find(mark) != row.npos; });
  };
  for (const auto& [delimiter, decimal] : {std::pair{'\t', '.'},
                                           {'\t', ','},
                                           {';', '.'},
                                           {';', ','},
                                           {'|', '.'},
                                           {'|', ','},
                                           {',', '.'},
                                           {' ', '.'},
                                           {' ', ','}}) {
    if (options.delimiter.value_or(delimiter) != delimiter) continue;
    if (options.decimal.value_or(decimal) != decimal) continue;
    // blanks may separate thousands, or stand beside what divides the cells
    if (delimiter == ' ' && (holds('\t') || holds(';') || holds('|'))) continue;
    const Dialect dialect{.delimiter = delimiter, .decimal = decimal};
    ChannelRows found{
        .head = lines->head, .rows = lines->rows, .delimiter = delimiter, .decimal = decimal};
    take_titles(fewest, found, delimiter);
    if (found.rows.empty() || names_columns(found.head, delimiter)) continue;
    const auto first = names_before(found.rows.front(), dialect, fewest);
    const auto is_like_it = [&](auto row) { return names_before(row, dialect, fewest) == first; };
    if (first && std::ranges::all_of(found.rows, is_like_it)) return found;
  }
  return std::nullopt;
}

TurnedRows::TurnedRows(const TextFile& file, ChannelRows rows) : rows_(std::move(rows)) {
  std::size_t size = 0;
  std::string text;
  for (const std::string_view line : rows_.head) text.append(line) += '\n';
  std::vector<CellCursor> cursors;
  std::vector<const char*> kept;  // where what may still be mapped of each row begins
  for (const std::string_view row : rows_.rows) {
    size += row.size();
    cursors.emplace_back(row, rows_.delimiter);
    kept.push_back(row.data());
  }
  std::unique_ptr<Spool> spool;
  if (size > most_in_memory) spool = std::make_unique<Spool>(file.path());
  const auto goes_on = [](const CellCursor& cursor) { return !cursor.ended(); };
  while (std::ranges::any_of(cursors, goes_on)) {
    for (CellCursor& cursor : cursors) {
      if (&cursor != cursors.data()) text += rows_.delimiter;
      if (goes_on(cursor))
        text += cursor.take();
      else if (rows_.delimiter == ' ')
        text += "nan";
    }
    text += '\n';
    if (text.size() < piece || !spool) continue;
    spool->append(text);
    text.clear();
    for (std::size_t c = 0; c < cursors.size(); ++c)
      file.release(std::exchange(kept[c], cursors[c].at()), cursors[c].at());
  }
  if (!spool) {
    in_memory_ = std::move(text);
    return;
  }
  spool->append(text);
  on_disk_ = spool->map();
}

const char* TurnedRows::origin(const char* at) const {
  const char* line = text().data();
  const char* const end = line + text().size();
  std::size_t number = 0;
  for (const char* next = line; take_line(next, end), next != end && next <= at; line = next)
    ++number;
  if (number < rows_.head.size()) return rows_.head[number].data() + (at - line);
  CellCursor before({line, static_cast<std::size_t>(end - line)}, rows_.delimiter);
  std::size_t column = 0;
  while (column + 1 < rows_.rows.size() && (before.take(), before.at() <= at)) ++column;
  CellCursor cells(rows_.rows[column], rows_.delimiter);
  for (std::size_t k = rows_.head.size(); k < number && !cells.ended(); ++k) cells.take();
  return cells.at();
}

void TurnedRows::release(const char* first, const char* last) const {
  if (!on_disk_) return;
  const char* const start = on_disk_->bytes().data();
  on_disk_->release(static_cast<std::size_t>(first - start),
                    static_cast<std::size_t>(last - start));
}

}  // namespace impactrig::acquisition
