// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/lvm_heads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t end = line.find(separator);
    cells.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

/// Not the zero of LabVIEW's clock, 1904-01-01 UTC as its own zone has it: it is stated for
/// nothing.
bool is_stated(const LvmMoment& moment) {
  constexpr std::int64_t second_day_of_1904 = -2082758400;  // since 1970
  return moment.seconds > second_day_of_1904;
}

/// "2013/02/19" and "09:51:40,727189064" (or with a point).
std::optional<LvmMoment> moment_of(std::string_view date, std::string_view time) {
  const std::string day(date.substr(0, 32));
  const std::string hour(time.substr(0, 64));
  int y = 0;
  int mon = 0;
  int d = 0;
  int h = 0;
  int min = 0;
  int s = 0;
  int used = 0;
  if (std::sscanf(day.c_str(), "%4d/%2d/%2d", &y, &mon, &d) != 3 ||
      std::sscanf(hour.c_str(), "%2d:%2d:%2d%n", &h, &min, &s, &used) != 3)
    return std::nullopt;
  const std::chrono::year_month_day calendar{std::chrono::year{y},
                                             std::chrono::month{static_cast<unsigned>(mon)},
                                             std::chrono::day{static_cast<unsigned>(d)}};
  if (!calendar.ok() || y < 1 || h < 0 || h > 23 || min < 0 || min > 59 || s < 0 || s > 60)
    return std::nullopt;
  LvmMoment moment;
  const auto days = std::chrono::sys_days{calendar}.time_since_epoch().count();
  moment.seconds = (static_cast<std::int64_t>(days) * 24 + h) * 3600 + min * 60 + s;
  std::string rest = hour.substr(static_cast<std::size_t>(used));
  if (rest.size() > 1 && (rest[0] == '.' || rest[0] == ','))
    moment.fraction = number_in("0." + rest.substr(1)).value_or(0.0);
  return moment;
}

/// Whether these cells name columns. Writers leave the first cell empty where it has no column
/// (X_Columns No).
bool name_columns_of(const std::vector<std::string_view>& cells) {
  if (cells.front() == "X_Value") return true;
  const auto empty = [](std::string_view cell) { return cell.empty(); };
  const auto number = [](std::string_view cell) {
    return number_in(cell, {'.', false}) || number_in(cell, {',', false});
  };
  return cells.front().empty() && !std::ranges::all_of(cells, empty) &&
         std::ranges::none_of(cells, number);
}

/// The same as ISO 8601, with microseconds where the file has a fraction; "" when it is no time.
std::string iso_text(std::string_view date, std::string_view time) {
  const auto moment = moment_of(date, time);
  if (!moment) return {};
  const std::string day(trimmed(date));
  const std::string hour(trimmed(time));
  std::string text = fmt::format("{}-{}-{}T{}", day.substr(0, 4), day.substr(5, 2),
                                 day.substr(8, 2), hour.substr(0, 8));
  const bool plain = day.size() == 10 && hour.size() >= 8 && std::ranges::all_of(text, [](char c) {
                       return detail::is_digit(c) || c == '-' || c == ':' || c == 'T';
                     });
  if (!plain) return to_utf8(day + " " + hour);
  if (moment->fraction > 0.0) {
    const auto micro = static_cast<int>(moment->fraction * 1e6);
    text += fmt::format(".{:06}", std::min(micro, 999999));
  }
  return text;
}

}  // namespace

void LvmHeads::read_file_header() {
  while (text_.at != text_.end &&
         std::string_view(" \t\r\n").find(*text_.at) != std::string_view::npos)
    ++text_.at;
  const char* const start = text_.at;
  std::string_view line = take_line(text_.at, text_.end);
  if (!trimmed(line).starts_with(lvm_first_word))
    throw InputError(text_.file.position(start),
                     fmt::format("expected '{}', found '{}'", lvm_first_word,
                                 to_utf8(trimmed(line).substr(0, 40))));
  find_separator(start);
  std::string date;
  std::string time;
  for (;;) {
    if (text_.at == text_.end)
      throw InputError(text_.file.position(text_.end),
                       fmt::format("the file ends within its header: no '{}'", lvm_end_of_header));
    const char* const begin = text_.at;
    line = take_line(text_.at, text_.end);
    const std::vector<std::string_view> cells = split(line, text_.separator);
    const std::string_view key = cells.front();
    const std::string_view value = cells.size() > 1 ? cells[1] : std::string_view{};
    if (key.starts_with(lvm_end_of_header)) break;
    if (key == "Channels" || key == "X_Value")
      throw InputError(text_.file.position(begin),
                       fmt::format("the file's header does not end before '{}': no '{}'", key,
                                   lvm_end_of_header));
    if (key == "Decimal_Separator" && !value.empty()) text_.decimal = value.front();
    if (key == "X_Columns") text_.multi = lowered(value) == "multi";
    if (key == "Multi_Headings") text_.one_heading = lowered(value) == "no";
    if (key == "Date") date = value;
    if (key == "Time") time = value;
    if (key == "Description") recording_.record().title = to_utf8(value);
    if (!key.empty()) recording_.say(key, value);
  }
  if (options_.decimal) text_.decimal = *options_.decimal;
  if (text_.decimal != '\0' && text_.decimal != '.' && text_.decimal != ',')
    throw InputError(text_.file.position(start),
                     fmt::format("Decimal_Separator is '{}', expected '.' or ','",
                                 to_utf8(std::string(1, text_.decimal))));
  if (text_.decimal == text_.separator)
    throw InputError(text_.file.position(start),
                     fmt::format("Separator and Decimal_Separator are both '{}': state --decimal",
                                 to_utf8(std::string(1, text_.decimal))));
  recording_.record().started = iso_text(date, time);
}

void LvmHeads::find_separator(const char* start) {
  constexpr std::string_view key = "Separator";
  std::string_view rest(start, static_cast<std::size_t>(text_.end - start));
  rest = rest.substr(0, 65536);
  const std::size_t first_end = rest.find_first_of("\r\n");
  const std::size_t after = rest.find_first_of("\t,;", lvm_first_word.size());
  if (after < first_end) text_.separator = rest[after];
  for (std::size_t found = rest.find("\nSeparator"); found != std::string_view::npos;
       found = rest.find("\nSeparator", found + 1)) {
    const std::string_view line = rest.substr(found + 1, rest.find('\n', found + 1) - found - 1);
    if (line.size() <= key.size()) continue;
    const char written = line[key.size()];
    const std::string_view word = trimmed(line.substr(key.size() + 1));
    text_.separator = written;
    if (word.starts_with("Tab")) text_.separator = '\t';
    if (word.starts_with("Comma")) text_.separator = ',';
    break;
  }
  if (options_.delimiter) text_.separator = *options_.delimiter;
}

void LvmHeads::skip_between() {
  while (text_.at != text_.end) {
    const char* const start = text_.at;
    const std::string_view line = take_line(text_.at, text_.end);
    if (line.starts_with("***Start_Special***")) {
      skip_special(start);
      continue;
    }
    if (text_.blank(line)) continue;
    text_.at = start;
    return;
  }
}

void LvmHeads::skip_special(const char* start) {
  ++special_blocks_;
  while (text_.at != text_.end)
    if (take_line(text_.at, text_.end).starts_with("***End_Special***")) return;
  if (text_.is_part) return;
  recording_.warn(
      fmt::format("the special block at {} does not end: the rest of the file is left out",
                  text_.file.position(start).text()));
}

bool LvmHeads::read_segment_header(LvmHeader& header, int number) {
  while (text_.at != text_.end) {
    const char* const start = text_.at;
    const std::string_view line = take_line(text_.at, text_.end);
    if (line.starts_with("***Start_Special***")) {
      skip_special(start);
      continue;
    }
    std::vector<std::string_view> cells = split(line, text_.separator);
    if (cells.front().starts_with(lvm_end_of_header)) return true;
    if (cells.front().empty()) continue;
    if (cells.front() == "X_Value" || number_in(cells.front(), {'.', false}))
      throw InputError(text_.file.position(start),
                       fmt::format("the header of segment {} does not end before this line: no "
                                   "'{}'",
                                   number, lvm_end_of_header));
    const std::string key = to_utf8(cells.front());
    constexpr std::array<std::string_view, 9> per_channel = {
        "Samples",     "Date",         "Time", "Y_Unit_Label", "Y_Dimension",
        "X_Dimension", "X_Unit_Label", "X0",   "Delta_X"};
    if (std::ranges::find(per_channel, key) == per_channel.end() && key != "Channels" &&
        cells.size() > 1)
      recording_.say(key, cells[1]);
    if (key == "Test_Name" && recording_.record().title.empty() && cells.size() > 1)
      recording_.record().title = to_utf8(cells[1]);
    header.lines.emplace(key, std::move(cells));
  }
  return false;
}

void LvmHeads::describe(const LvmHeader& header, LvmSegment& segment) {
  segment.moment = moment_of(header.cell("Date"), header.cell("Time"));
  if (segment.first == 1 && segment.moment)
    recording_.record().started = iso_text(header.cell("Date"), header.cell("Time"));
  name_columns(header, segment);
}

std::size_t LvmHeads::y_column(std::size_t channel) const {
  return text_.multi ? 2 * channel + 1 : channel + 1;
}

void LvmHeads::name_columns(const LvmHeader& header, LvmSegment& segment) {
  const char* const start = text_.at;
  std::vector<std::string_view> names = split(take_line(text_.at, text_.end), text_.separator);
  if (!name_columns_of(names))
    throw InputError(text_.file.position(start),
                     fmt::format("expected the line of names that begins with 'X_Value', found "
                                 "'{}'",
                                 to_utf8(names.front().substr(0, 40))));
  segment.comment = names.size() > 1 && names.back() == "Comment";
  if (segment.comment) names.pop_back();
  std::size_t channels = text_.multi ? names.size() / 2 : names.size() - 1;
  const auto declared = integer_in(header.cell("Channels"));
  const bool trailing = !segment.comment && names.size() > 1 && names.back().empty();
  if (trailing && declared && *declared >= 0 && static_cast<std::size_t>(*declared) < channels)
    channels = static_cast<std::size_t>(*declared);
  if (!header.cell("Channels").empty() &&
      (!declared || *declared < 0 || static_cast<std::size_t>(*declared) != channels))
    recording_.warn(
        fmt::format("segment {} declares {} channels and names {}: those named are read",
                    segment.first, to_utf8(header.cell("Channels").substr(0, 40)), channels));
  if (text_.decimal == '\0') text_.decimal = decimal_of(header, channels);
  for (std::size_t c = 0; c < channels; ++c) {
    const std::size_t column = y_column(c);
    LvmPart part;
    part.name = column < names.size() ? to_utf8(names[column]) : std::string();
    if (part.name.empty()) part.name = fmt::format("column {}", column);
    part.unit = to_utf8(header.cell("Y_Unit_Label", column));
    part.y_dimension = to_utf8(header.cell("Y_Dimension", column));
    part.x_dimension = to_utf8(header.cell("X_Dimension", column));
    part.x_unit = to_utf8(header.cell("X_Unit_Label", column));
    part.x0 = finite(header.cell("X0", column));
    const auto moment = moment_of(header.cell("Date", column), header.cell("Time", column));
    if (moment && is_stated(*moment) && segment.moment && is_stated(*segment.moment))
      part.later = *moment - *segment.moment;
    part.delta_text = to_utf8(header.cell("Delta_X", column));
    part.delta = finite(header.cell("Delta_X", column));
    if (part.delta && !(*part.delta > 0.0)) part.delta.reset();
    const auto said = integer_in(header.cell("Samples", column));
    if (said && *said >= 0) part.said = static_cast<std::uint64_t>(*said);
    segment.parts.push_back(std::move(part));
  }
}

std::optional<double> LvmHeads::finite(std::string_view cell) const {
  const auto value = number_in(cell, {text_.decimal, false});
  return value && std::isfinite(*value) ? value : std::nullopt;
}

char LvmHeads::decimal_of(const LvmHeader& header, std::size_t channels) const {
  if (text_.separator == ',') return '.';
  const char* at = text_.at;
  const auto row = split(take_line(at, text_.end), text_.separator);
  for (std::size_t c = 0; c < channels; ++c) {
    const std::size_t column = y_column(c);
    for (const std::string_view cell : {header.cell("Delta_X", column), header.cell("X0", column),
                                        column < row.size() ? row[column] : std::string_view{}}) {
      if (cell.find('.') != std::string_view::npos) return '.';
      if (cell.find(',') != std::string_view::npos) return ',';
    }
  }
  return '.';
}

}  // namespace impactrig::acquisition
