// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/uff58_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>

#include "acquisition/importers/number.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

constexpr NumberStyle fortran{'.', true};

/// Widths of the columns of one line of ASCII data.
std::span<const int> line_widths(const Uff58Form& form) {
  static constexpr std::array<int, 6> single = {13, 13, 13, 13, 13, 13};
  static constexpr std::array<int, 4> even_double = {20, 20, 20, 20};
  static constexpr std::array<int, 4> uneven_double = {13, 20, 13, 20};
  static constexpr std::array<int, 3> uneven_complex_double = {13, 20, 20};
  if (!form.double_precision()) return single;
  if (form.even) return even_double;
  if (form.complex()) return uneven_complex_double;
  return uneven_double;
}

std::size_t numbers_a_point(const Uff58Form& form) {
  return (form.even ? 1U : 2U) + (form.complex() ? 1U : 0U);
}

/// Takes a flat sequence of numbers apart. `values` holds whole points only.
void divide(const Uff58Form& form, std::vector<double>&& values, Uff58Data& data) {
  const std::size_t stride = numbers_a_point(form);
  if (stride == 1) {
    data.ordinate = std::move(values);
    return;
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
}

/// Numbers in columns, line by line.
class AsciiReader {
 public:
  AsciiReader(const TextFile& file, const char*& at, const Uff58Form& form, bool lines_count)
      : file_(file),
        at_(at),
        form_(form),
        lines_count_(lines_count),
        widths_(line_widths(form)) {}

  Uff58Data read() {
    const std::string_view text = file_.bytes();
    const char* const end = text.data() + text.size();
    const std::uint64_t announced = form_.points * numbers_a_point(form_);
    // a number takes at least 13 columns, whatever the header says
    values_.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(
        announced + widths_.size(), static_cast<std::uint64_t>(end - at_) / 13 + widths_.size())));
    const char* const start = at_;
    while (at_ != end) {
      const char* const line_start = at_;
      const std::string_view line = take_line(at_, end);
      if (is_uff_delimiter(line)) {
        at_ = line_start;
        break;
      }
      // only a cut file ends without closing line and line end: its last number may lack digits
      cut_ = at_ == end && end[-1] != '\n';
      read_line(line, at_ == end);
    }
    settle(start, announced);
    divide(form_, std::move(values_), data_);
    return std::move(data_);
  }

 private:
  datasets::SourcePosition place(const char* at) const {
    return lines_count_ ? file_.position(at) : file_.byte_position(at);
  }

  void read_line(std::string_view line, bool last_of_file) {
    const std::size_t before = values_.size();
    if (read_by_columns(line)) return;
    values_.resize(before);
    if (read_by_blanks(line)) {
      if (!by_blanks_)
        data_.warnings.push_back(
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

  /// False when a column holds anything but a number and blanks.
  bool read_by_columns(std::string_view line) {
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

  bool read_by_blanks(std::string_view line) {
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

  void read_whole_numbers(std::string_view line) {
    for (const int width : widths_) {
      if (line.size() < static_cast<std::size_t>(width)) return;
      const auto value = number_in(line.substr(0, static_cast<std::size_t>(width)), fortran);
      if (!value) return;
      values_.push_back(*value);
      line.remove_prefix(static_cast<std::size_t>(width));
    }
  }

  [[noreturn]] void report(std::string_view line) {
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

  /// Compares what was read with what was announced.
  void settle(const char* start, std::uint64_t announced) {
    const std::size_t stride = numbers_a_point(form_);
    if (values_.empty() && announced > 0)
      throw InputError(place(start),
                       fmt::format("{} points are announced and no number is there", form_.points));
    if (values_.size() > announced && values_.size() - announced < widths_.size()) {
      values_.resize(static_cast<std::size_t>(announced));  // a last line filled up
      return;
    }
    values_.resize(values_.size() - values_.size() % stride);
    const std::size_t found = values_.size() / stride;
    if (found != form_.points)
      data_.warnings.push_back(fmt::format(
          "the header announces {} points, {} are there: these are read", form_.points, found));
  }

  const TextFile& file_;
  const char*& at_;
  const Uff58Form& form_;
  bool lines_count_;
  std::span<const int> widths_;
  std::vector<double> values_;
  Uff58Data data_;
  bool by_blanks_ = false;
  bool cut_ = false;
};

template <typename Number>
Number read_number(const char* bytes, bool little_endian) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (little_endian != (std::endian::native == std::endian::little))
    std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Number>(raw);
}

template <typename Number>
std::vector<Number> read_numbers(const char* bytes, std::size_t n, bool little_endian) {
  std::vector<Number> values(n);
  if (little_endian == (std::endian::native == std::endian::little)) {
    std::memcpy(values.data(), bytes, n * sizeof(Number));
  } else {
    for (std::size_t i = 0; i < n; ++i)
      values[i] = read_number<Number>(bytes + i * sizeof(Number), little_endian);
  }
  return values;
}

/// Bytes of the parts of one point. Uneven double data have a single precision abscissa by the
/// standard (the field E13.5 is a float), but several writers store it in double precision too.
struct PointLayout {
  std::size_t abscissa = 0;
  std::size_t number = 4;
  std::size_t numbers = 1;

  std::size_t size() const { return abscissa + number * numbers; }
};

PointLayout point_layout(const Uff58Form& form, bool wide_abscissa) {
  PointLayout layout;
  layout.number = form.double_precision() ? 8 : 4;
  layout.numbers = form.complex() ? 2 : 1;
  layout.abscissa = form.even ? 0 : (wide_abscissa ? layout.number : 4);
  return layout;
}

/// Where the closing -1 stands when the data end at `at`: directly, or after a line end. Null when
/// it is not there.
const char* closing_line(const char* at, const char* end) {
  const char* p = at;
  if (p != end && *p == '\r') ++p;
  if (p != end && *p == '\n') ++p;
  const char* next = p;
  const std::string_view line = take_line(next, end);
  return is_uff_delimiter(line.substr(0, 80)) ? p : nullptr;
}

/// The first place at or after `at` that closes a dataset; `end` when there is none.
const char* find_closing_line(const char* at, const char* end) {
  constexpr std::string_view sign = "    -1";
  const std::string_view text(at, static_cast<std::size_t>(end - at));
  for (std::size_t found = text.find(sign); found != std::string_view::npos;
       found = text.find(sign, found + 1)) {
    const char* next = at + found;
    const char* const start = next;
    if (is_uff_delimiter(take_line(next, end).substr(0, 80))) return start;
  }
  return end;
}

/// A block of binary data, once its end is found.
struct Block {
  const char* start = nullptr;
  const char* closing = nullptr;  ///< the closing -1, or the end of the file
  std::uint64_t length = 0;
  PointLayout layout;
  std::size_t points = 0;
};

/// The block is as long as its points are, or as announced: the length that a -1 follows is it.
/// Otherwise it goes on to the next -1.
Block find_block(const TextFile& file, const char* start, const Uff58Form& form,
                 std::vector<std::string>& warnings) {
  const std::string_view bytes = file.bytes();
  const char* const end = bytes.data() + bytes.size();
  const auto available = static_cast<std::uint64_t>(end - start);
  Block block;
  block.start = start;
  block.layout = point_layout(form, false);
  const PointLayout wide = point_layout(form, true);
  // more points than bytes can be no true count; the products below must not overflow
  const std::uint64_t points = std::min(form.points, available + 1);
  const std::array<std::uint64_t, 3> lengths = {points * block.layout.size(), points * wide.size(),
                                                form.announced_bytes};
  for (const std::uint64_t candidate : lengths) {
    if (candidate > available || block.closing != nullptr) continue;
    block.closing = closing_line(start + candidate, end);
    block.length = candidate;
  }
  if (block.closing == nullptr) {
    block.closing = find_closing_line(start, end);
    block.length = static_cast<std::uint64_t>(block.closing - start);
    if (block.closing == end) {
      block.length = std::min(block.length, std::max(form.announced_bytes, lengths[0]));
      warnings.emplace_back("the file ends without the closing -1: it may have been cut off");
    }
  }
  if (block.length == lengths[1] && block.length != lengths[0]) block.layout = wide;
  block.points = static_cast<std::size_t>(block.length) / block.layout.size();
  if (form.announced_bytes != 0 && form.announced_bytes != block.length)
    warnings.push_back(fmt::format("the identifier line announces {} bytes of data, {} are there",
                                   form.announced_bytes, block.length));
  if (block.points != form.points)
    warnings.push_back(fmt::format("the header announces {} points, {} are there: these are read",
                                   form.points, block.points));
  return block;
}

/// Takes points of several numbers apart.
void divide(const Uff58Form& form, const Block& block, Uff58Data& data) {
  const auto number = [&form](const char* p, std::size_t size) {
    return size == 8 ? read_number<double>(p, form.little_endian)
                     : static_cast<double>(read_number<float>(p, form.little_endian));
  };
  const PointLayout& layout = block.layout;
  std::vector<double> ordinate(block.points);
  if (!form.even) data.abscissa.resize(block.points);
  if (form.complex()) data.imaginary.resize(block.points);
  for (std::size_t i = 0; i < block.points; ++i) {
    const char* p = block.start + i * layout.size();
    if (!form.even) data.abscissa[i] = number(p, layout.abscissa);
    p += layout.abscissa;
    ordinate[i] = number(p, layout.number);
    if (form.complex()) data.imaginary[i] = number(p + layout.number, layout.number);
  }
  data.ordinate = std::move(ordinate);
}

Uff58Data read_binary(const TextFile& file, const char*& at, const Uff58Form& form) {
  Uff58Data data;
  const Block block = find_block(file, at, form, data.warnings);
  if (block.points == 0 && form.points > 0)
    throw InputError(file.byte_position(at),
                     fmt::format("{} points are announced and no data are there", form.points));
  at = block.closing;
  if (!form.even || form.complex()) {
    divide(form, block, data);
  } else if (form.double_precision()) {
    data.ordinate = read_numbers<double>(block.start, block.points, form.little_endian);
  } else {
    data.ordinate = read_numbers<float>(block.start, block.points, form.little_endian);
  }
  return data;
}

}  // namespace

std::size_t Uff58Data::size() const {
  return std::visit([](const auto& samples) { return samples.size(); }, ordinate);
}

bool is_uff_delimiter(std::string_view line) {
  if (line.size() < 2 || line.size() > 200) return false;
  const std::string_view text = trimmed(line);
  return text == "-1" && text.data() - line.data() == 4;
}

Uff58Data read_uff58_data(const TextFile& file, const char*& at, const Uff58Form& form,
                          bool lines_count) {
  if (form.binary) return read_binary(file, at, form);
  return AsciiReader(file, at, form, lines_count).read();
}

}  // namespace impactrig::acquisition
