// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/uff58_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "acquisition/importers/number.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

constexpr NumberStyle fortran{'.', true};

/// Takes a flat sequence of numbers apart. `values` holds whole points only.
Uff58Block divided(const Uff58Form& form, std::span<const double> values) {
  Uff58Block data;
  const std::size_t stride = uff58_numbers_a_point(form);
  if (stride == 1) {
    data.ordinate = std::vector<double>(values.begin(), values.end());
    return data;
  }
  const std::size_t n = values.size() / stride;
  std::vector<double> ordinate(n);
  if (!form.even) data.abscissa.resize(n);
  if (form.complex()) data.imaginary.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double* point = values.data() + stride * i;
    if (!form.even) data.abscissa[i] = *point++;
    ordinate[i] = *point++;
    if (form.complex()) data.imaginary[i] = *point;
  }
  data.ordinate = std::move(ordinate);
  return data;
}

}  // namespace

std::span<const int> uff58_line_widths(const Uff58Form& form) {
  static constexpr std::array<int, 6> single = {13, 13, 13, 13, 13, 13};
  static constexpr std::array<int, 4> even_double = {20, 20, 20, 20};
  static constexpr std::array<int, 4> uneven_double = {13, 20, 13, 20};
  static constexpr std::array<int, 3> uneven_complex_double = {13, 20, 20};
  if (!form.double_precision()) return single;
  if (form.even) return even_double;
  if (form.complex()) return uneven_complex_double;
  return uneven_double;
}

std::size_t uff58_numbers_a_point(const Uff58Form& form) {
  return (form.even ? 1U : 2U) + (form.complex() ? 1U : 0U);
}

const char* uff58_closing_line_by_count(const char* start, const char* end, const Uff58Form& form) {
  const std::uint64_t numbers_a_line = uff58_line_widths(form).size();
  const auto available = static_cast<std::uint64_t>(end - start);
  if (form.points == 0 || form.points > available) return nullptr;
  const char* next = start;
  take_line(next, end);
  const auto line = static_cast<std::uint64_t>(next - start);
  const std::uint64_t lines =
      (form.points * uff58_numbers_a_point(form) + numbers_a_line - 1) / numbers_a_line;
  if (lines > available / line) return nullptr;
  const char* at = start + (lines - 1) * line;
  if (at > start && at[-1] != '\n') return nullptr;
  take_line(at, end);
  next = at;
  return is_uff_delimiter(take_line(next, end)) ? at : nullptr;
}

bool Uff58Text::read_numbers(std::size_t most) {
  const std::string_view text = file_.bytes();
  const char* const end = text.data() + text.size();
  while (at_ != end && values_.size() < most) {
    const char* const line_start = at_;
    const std::string_view line = take_line(at_, end);
    if (is_uff_delimiter(line)) {
      at_ = line_start;
      return false;
    }
    // only a cut file ends without closing line and line end: its last number may lack digits
    cut_ = at_ == end && end[-1] != '\n';
    read_line(line, at_ == end);
  }
  return at_ != end;
}

std::uint64_t Uff58Text::count() {
  const char* const start = at_;
  std::uint64_t numbers = 0;
  for (bool more = true; more;) {
    const char* const first = at_;
    more = read_numbers(numbers_at_once);
    numbers += values_.size();
    values_.clear();
    file_.release(first, at_);
  }
  const std::size_t stride = uff58_numbers_a_point(form_);
  const std::uint64_t announced =
      form_.points > ~std::uint64_t{0} / stride ? ~std::uint64_t{0} : form_.points * stride;
  if (numbers == 0 && announced > 0)
    throw InputError(place(start),
                     fmt::format("{} points are announced and no number is there", form_.points));
  // the last line may be filled up
  const std::uint64_t width = std::max<std::uint64_t>(widths_.size(), 1);
  if (numbers > announced && numbers <= (announced + width - 1) / width * width)
    return form_.points;
  return numbers / stride;
}

std::uint64_t Uff58Text::skip(std::uint64_t points) {
  const std::string_view text = file_.bytes();
  const std::uint64_t a_line = widths_.size() / uff58_numbers_a_point(form_);
  const std::uint64_t lines = points / a_line;
  const char* next = at_;
  take_line(next, text.data() + text.size());
  if (widths_.size() % uff58_numbers_a_point(form_) != 0) return 0;
  at_ += lines * static_cast<std::uint64_t>(next - at_);
  return lines * a_line;
}

Uff58Block Uff58Text::read(std::size_t most, std::uint64_t& left) {
  const std::size_t stride = uff58_numbers_a_point(form_);
  const std::uint64_t asked = std::min<std::uint64_t>(most, left);
  read_numbers(asked * stride);
  const auto points =
      static_cast<std::size_t>(std::min<std::uint64_t>(values_.size() / stride, asked));
  left -= points;
  Uff58Block block = divided(form_, std::span(values_).first(points * stride));
  values_.erase(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(points * stride));
  return block;
}

datasets::SourcePosition Uff58Text::place(const char* at) const {
  return lines_count_ ? file_.position(at) : file_.byte_position(at);
}

void Uff58Text::read_line(std::string_view line, bool last_of_file) {
  const std::size_t before = values_.size();
  if (read_by_columns(line)) return;
  values_.resize(before);
  if (read_by_blanks(line)) {
    if (!by_blanks_)
      warnings_.push_back(
          fmt::format("the numbers from {} on are not in columns of the standard's width: they "
                      "are read by the blanks between them",
                      place(line.data()).text()));
    by_blanks_ = true;
    return;
  }
  values_.resize(before);
  if (last_of_file) {  // cut within a number: the ones before it are sound
    read_whole_numbers(line);
    return;
  }
  report(line);
}

bool Uff58Text::read_by_columns(std::string_view line) {
  const char* p = line.data();
  const char* const end = p + line.size();
  const char* last_cell = nullptr;
  for (const int width : widths_) {
    if (p == end) return true;
    const char* const cell = p;
    if (cut_ && end - cell < width) return true;
    const char* const cell_end = end - p < width ? end : p + width;
    while (p != cell_end && *p == ' ') ++p;
    if (p == cell_end) {  // blank: the line ends here, or it is no line of columns
      return trimmed({cell, static_cast<std::size_t>(end - cell)}).empty();
    }
    double value = 0.0;
    const char* const q = scan_number(p, cell_end, fortran, value);
    if (q == p) return false;
    p = q;
    while (p != cell_end && (*p == ' ' || *p == '\t')) ++p;
    if (p != cell_end) return false;
    // digits on both sides of a column's edge may be one number cut in two
    if (last_cell != nullptr && cell[-1] != ' ' && (detail::is_digit(*cell) || *cell == '.') &&
        std::string_view(last_cell, static_cast<std::size_t>(cell - last_cell))
                .find_first_of("EeDd") == std::string_view::npos)
      return false;
    last_cell = cell;
    values_.push_back(value);
  }
  return trimmed({p, static_cast<std::size_t>(end - p)}).empty();
}

bool Uff58Text::read_by_blanks(std::string_view line) {
  const char* p = line.data();
  const char* const end = p + line.size();
  for (;;) {
    while (p != end && (*p == ' ' || *p == '\t')) ++p;
    if (p == end) return true;
    double value = 0.0;
    const char* const q = scan_number(p, end, fortran, value);
    if (q == p || (q != end && *q != ' ' && *q != '\t')) return false;
    values_.push_back(value);
    p = q;
  }
}

void Uff58Text::read_whole_numbers(std::string_view line) {
  for (const int width : widths_) {
    if (line.size() < static_cast<std::size_t>(width)) return;
    const auto value = number_in(line.substr(0, static_cast<std::size_t>(width)), fortran);
    if (!value) return;
    values_.push_back(*value);
    line.remove_prefix(static_cast<std::size_t>(width));
  }
}

void Uff58Text::report(std::string_view line) {
  std::size_t start = 0;
  for (const int width : widths_) {
    const std::string_view cell =
        line.substr(std::min(start, line.size()), static_cast<std::size_t>(width));
    if (!number_in(cell, fortran))
      throw InputError(place(cell.data()),
                       fmt::format("expected a number in {} columns, found '{}'", width,
                                   to_utf8(trimmed(cell))));
    start += static_cast<std::size_t>(width);
  }
  throw InputError(place(line.data()), "the line goes on after its last column");
}

}  // namespace impactrig::acquisition
