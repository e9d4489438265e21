// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/lvm_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>
#include <utility>

#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

constexpr std::size_t most_comments = 1'000'000;  ///< [bytes]

/// The place of a number's last digit: 1e-6 of "0.000020", 1e-11 of "1.953125E-5"; 0 of an integer,
/// which is taken as exact.
double last_place(std::string_view text, char decimal) {
  const std::size_t letter = text.find_first_of("eE");
  const auto exponent =
      letter == std::string_view::npos ? 0L : integer_in(text.substr(letter + 1)).value_or(0);
  const std::size_t mark = text.substr(0, letter).find(decimal);
  const std::size_t digits_end = std::min(letter, text.size());
  if (mark == std::string_view::npos) return 0.0;
  const std::size_t decimals = digits_end - mark - 1;
  const long place = exponent - static_cast<long>(decimals);
  if (place < -300 || place > 300) return 0.0;
  return place >= -22 && place <= 0 ? 1.0 / detail::powers_of_ten[-place]
                                    : std::pow(10.0, static_cast<double>(place));
}

/// By the headers alone: the X column is that of `owner`.
bool has_other_steps(const LvmPart& part, const LvmPart& owner) {
  return part.delta && owner.delta && std::abs(*part.delta - *owner.delta) > 1e-3 * *owner.delta;
}

}  // namespace

void LvmRows::read(LvmSegment& segment) {
  const std::size_t channels = segment.parts.size();
  const std::uint64_t packet = packet_length(segment);
  std::vector<std::uint64_t> due(channels, 0);  // samples that rows up to now ought to have
  NumberList<double> x(recording_.spool());     // the only X column
  if (!counting_)
    for (LvmPart& part : segment.parts) part.keep_in(recording_.spool());
  std::uint64_t row = 0;
  std::size_t cells_before = 0;
  rows_first_ = text_.at;
  rows_last_ = text_.end;
  if (packet != 0) plain_ = false;
  const char* released = text_.at;
  while (text_.at != text_.end && (plain_ || !counting_)) {
    const char* const start = text_.at;
    const std::string_view line = take_line(text_.at, text_.end);
    if (text_.blank(line)) continue;
    if (ends_rows(line)) {
      text_.at = rows_last_ = start;
      break;
    }
    if ((counting_ || recording_.spool() != nullptr) && start - released > (1 << 22)) {
      text_.file.release(released, start);
      released = start;
    }
    const auto cells = static_cast<std::size_t>(std::ranges::count(line, text_.separator)) + 1;
    const bool whole_line = line.data() + line.size() != text_.end;
    if (!whole_line &&
        (cells < cells_before || is_within_packet(segment, row) ||
         ends_in_cut_number({rows_first_, text_.end}, text_.separator, text_.decimal))) {
      recording_.warn(fmt::format("the file ends within the row at {}: this row is left out",
                                  text_.file.position(start).text()));
      rows_last_ = start;
      break;
    }
    cells_before = cells;
    read_row(line, segment, packet, row, due, x);
    ++row;
  }
  count_ = row;
  if (!text_.multi) share_x(segment, std::move(x));
}

bool LvmRows::is_within_packet(const LvmSegment& segment, std::uint64_t row) {
  std::uint64_t said = 0;
  for (const LvmPart& part : segment.parts) said = std::max(said, part.said.value_or(0));
  return said > 0 && (row + 1) % said != 0;
}

bool LvmRows::ends_rows(std::string_view line) const {
  const std::string_view cell = trimmed(line.substr(0, line.find(text_.separator)));
  if (cell.empty() || cell_value(cell, text_.decimal)) return false;
  const auto letter = static_cast<unsigned char>(cell.front());
  return std::isalpha(letter) != 0 || cell.starts_with("***");
}

std::uint64_t LvmRows::packet_length(const LvmSegment& segment) const {
  std::uint64_t most = 0;
  bool differ = false;
  for (const LvmPart& part : segment.parts) {
    if (!part.said || *part.said == 0) return 0;
    differ = differ || *part.said != *segment.parts.front().said;
    most = std::max(most, *part.said);
  }
  return differ && text_.one_heading ? most : 0;
}

void LvmRows::read_row(std::string_view line, LvmSegment& segment, std::uint64_t packet,
                       std::uint64_t row, std::vector<std::uint64_t>& due, NumberList<double>& x) {
  const char* at = line.data();
  const char* const last = line.data() + line.size();
  const std::size_t channels = segment.parts.size();
  double pair_x = nothing;
  for (std::size_t column = 0; at <= last; ++column) {
    const char* stop = at;
    double value = nothing;
    const bool is_x = text_.multi ? column % 2 == 0 : column == 0;
    const std::size_t channel = text_.multi ? column / 2 : column - 1;
    const bool beyond = column > 0 && channel >= channels;
    if (beyond) {
      take_comment(segment, {at, static_cast<std::size_t>(last - at)}, row);
      return;
    }
    const bool there = take_cell(stop, last, segment, column, value);
    if (is_x && there && channels > 0) {
      LvmPart& part = segment.parts[text_.multi ? channel : 0];
      const std::string_view cell(at, static_cast<std::size_t>(stop - at));
      part.check.see(value, last_place(trimmed(cell), text_.decimal), part.delta.value_or(0.0));
    }
    if (is_x && text_.multi) pair_x = value;
    if (is_x && !text_.multi && there && counting_) {
      if (x_rows_++ != row) plain_ = false;
      if (row == 0) x.push_back(value);
    } else if (is_x && !text_.multi && there) {
      if (x.size() < row) charge(row - x.size());
      x.append(row - x.size(), nothing);
      x.push_back(value);
    }
    if (!is_x) {
      const bool expected = packet == 0 || row % packet < *segment.parts[channel].said;
      if (there)
        take_value(segment.parts[channel], value, pair_x, packet == 0 ? row : due[channel]);
      if (packet != 0 && (there || expected)) ++due[channel];
    }
    if (stop == last) return;
    at = stop + 1;
  }
}

bool LvmRows::take_cell(const char*& at, const char* last, const LvmSegment& segment,
                        std::size_t column, double& value) const {
  while (at != last && *at != text_.separator && (*at == ' ' || *at == '\t')) ++at;
  if (at == last || *at == text_.separator) return false;
  const char* const start = at;
  const char* q = scan_number(at, last, {text_.decimal, false}, value);
  while (q != at && q != last && (*q == ' ' || *q == '\r') && *q != text_.separator) ++q;
  if (q != at && (q == last || *q == text_.separator)) {
    at = q;
    return true;
  }
  while (at != last && *at != text_.separator) ++at;
  const std::string_view cell =
      trimmed(std::string_view(start, static_cast<std::size_t>(at - start)));
  const auto unusual = cell_value(cell, text_.decimal);
  if (!unusual)
    throw InputError(text_.file.position(start),
                     fmt::format("{}: expected a number, found '{}'", culprit(segment, column),
                                 to_utf8(cell.substr(0, 40))));
  value = *unusual;
  return true;
}

std::string LvmRows::culprit(const LvmSegment& segment, std::size_t column) const {
  const bool is_x = text_.multi ? column % 2 == 0 : column == 0;
  if (is_x) return "X_Value";
  return segment.parts[text_.multi ? column / 2 : column - 1].name;
}

void LvmRows::take_value(LvmPart& part, double value, double x, std::uint64_t place) {
  if (counting_) return count_value(part, value, x, place);
  const std::uint64_t n = part.values.size();
  if (n < place) {
    const std::uint64_t lacking = place - n;
    charge(lacking);
    part.missing += lacking;
    if (part.invalid.empty()) part.invalid.append(n, 0);
    part.values.append(lacking, nothing);
    part.invalid.append(lacking, 1);
    if (!part.x.empty()) part.x.append(place - part.x.size(), nothing);
  }
  const bool missing = std::isnan(value);
  if (missing && part.invalid.empty()) part.invalid.append(part.values.size(), 0);
  part.values.push_back(value);
  if (!part.invalid.empty()) part.invalid.push_back(missing ? 1 : 0);
  if (missing) ++part.missing;
  if (text_.multi && (!std::isnan(x) || !part.x.empty())) {
    part.x.append(part.values.size() - 1 - part.x.size(), nothing);
    part.x.push_back(x);
  }
}

void LvmRows::count_value(LvmPart& part, double value, double x, std::uint64_t place) {
  if (place != part.counted || std::isnan(value)) plain_ = false;
  if (text_.multi && !std::isnan(x)) {
    if (part.counted_x++ != part.counted) plain_ = false;
    if (part.x.empty()) part.x.push_back(x);
  } else if (part.counted_x > 0) {
    plain_ = false;
  }
  ++part.counted;
}

void LvmRows::charge(std::uint64_t missing) {
  filled_ += missing;
  if (filled_ > text_.file.text().size())
    throw InputError(text_.file.position(text_.at),
                     "more values are missing than the file has characters");
}

void LvmRows::take_comment(const LvmSegment& segment, std::string_view cell, std::uint64_t row) {
  cell = trimmed(cell);
  while (!cell.empty() && cell.back() == text_.separator) cell.remove_suffix(1);
  if (cell.empty()) return;
  if (!segment.comment && cell_value(cell, text_.decimal)) {
    recording_.warn("rows have more cells than there are names: the rest is left out");
    return;
  }
  std::string& text = recording_.record().attributes["comments"];
  if (text.size() > most_comments) {
    recording_.warn(fmt::format("there are more than {} bytes of comments: the rest is left out",
                                most_comments));
    return;
  }
  text += fmt::format("{}row {}{}: {}", text.empty() ? "" : "; ", row,
                      segment.first > 1 ? fmt::format(" of segment {}", segment.first) : "",
                      to_utf8(cell));
}

void LvmRows::share_x(LvmSegment& segment, NumberList<double>&& x) {
  if (x.empty()) {
    if (x_rows_ > 0) plain_ = false;
    return;
  }
  for (LvmPart& part : segment.parts) {
    if (counting_) {
      part.x = x;
      if (x_rows_ < part.counted) plain_ = false;
    } else {
      const std::uint64_t there = std::min(x.size(), part.values.size());
      part.x = x.first(there);
      part.x.append(part.values.size() - there, nothing);
    }
    part.check = segment.parts.front().check;
    part.check.agrees = part.check.agrees && part.delta == segment.parts.front().delta;
  }
  shift_x(segment);
}

void LvmRows::shift_x(LvmSegment& segment) {
  const auto owner = std::ranges::max_element(
      segment.parts, {}, [](const LvmPart& part) { return part.said.value_or(0); });
  if (owner == segment.parts.end()) return;
  for (LvmPart& part : segment.parts) {
    if (has_other_steps(part, *owner)) {
      recording_.warn(fmt::format(
          "'{}': Delta_X is {:.9g}, that of '{}', whose times the X column has, {:.9g}: "
          "its own X0 and Delta_X are taken",
          part.name, *part.delta, owner->name, *owner->delta));
      part.x = NumberList<double>(recording_.spool());
      continue;
    }
    if (!owner->x0) continue;
    const double shift = part.x0.value_or(*owner->x0) - *owner->x0;
    if (std::abs(shift) <= 1e-3 * part.delta.value_or(0.0)) continue;
    recording_.warn(
        fmt::format("'{}': X0 is {:.9g}, that of '{}', whose times the X column has, {:.9g}: its "
                    "times are the column's and {:.9g} more",
                    part.name, *part.x0, owner->name, *owner->x0, shift));
    NumberList<double> shifted(recording_.spool());
    part.x.settle();
    part.x.each([&shifted, shift](std::span<const double> piece) {
      for (const double x : piece) shifted.push_back(x + shift);
    });
    part.x = std::move(shifted);
  }
}

}  // namespace impactrig::acquisition
