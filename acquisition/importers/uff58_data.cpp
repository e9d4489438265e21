// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/uff58_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
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
Uff58Block divided(const Uff58Form& form, std::span<const double> values) {
  Uff58Block data;
  const std::size_t stride = numbers_a_point(form);
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

/// Numbers in columns, line by line.
class Uff58Reader::Text {
 public:
  Text(const TextFile& file, const char* start, const Uff58Form& form, bool lines_count)
      : file_(file),
        at_(start),
        form_(form),
        lines_count_(lines_count),
        widths_(line_widths(form)) {}

  const char* at() const { return at_; }

  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Reads lines until there are so many numbers, or up to the closing line; false there.
  bool read_numbers(std::size_t most) {
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

  /// Counts the points that are there, against those announced.
  std::uint64_t count() {
    const char* const start = at_;
    std::uint64_t numbers = 0;
    for (bool more = true; more;) {
      const char* const first = at_;
      more = read_numbers(numbers_at_once);
      numbers += values_.size();
      values_.clear();
      file_.release(first, at_);
    }
    const std::size_t stride = numbers_a_point(form_);
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

  /// Passes over whole lines that are all as long as the first.
  std::uint64_t skip(std::uint64_t points) {
    const std::string_view text = file_.bytes();
    const std::uint64_t a_line = widths_.size() / numbers_a_point(form_);
    const std::uint64_t lines = points / a_line;
    const char* next = at_;
    take_line(next, text.data() + text.size());
    if (widths_.size() % numbers_a_point(form_) != 0) return 0;
    at_ += lines * static_cast<std::uint64_t>(next - at_);
    return lines * a_line;
  }

  /// The next whole points, of `left` that are there; the start of a line that remains is for the
  /// next call.
  Uff58Block read(std::size_t most, std::uint64_t& left) {
    const std::size_t stride = numbers_a_point(form_);
    const std::uint64_t asked = std::min<std::uint64_t>(most, left);
    read_numbers(asked * stride);
    const auto points =
        static_cast<std::size_t>(std::min<std::uint64_t>(values_.size() / stride, asked));
    left -= points;
    Uff58Block block = divided(form_, std::span(values_).first(points * stride));
    values_.erase(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(points * stride));
    return block;
  }

 private:
  static constexpr std::size_t numbers_at_once = 65536;

  datasets::SourcePosition place(const char* at) const {
    return lines_count_ ? file_.position(at) : file_.byte_position(at);
  }

  void read_line(std::string_view line, bool last_of_file) {
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

  const TextFile& file_;
  const char* at_;
  const Uff58Form& form_;
  bool lines_count_;
  std::span<const int> widths_;
  std::vector<double> values_;
  std::vector<std::string> warnings_;
  bool by_blanks_ = false;
  bool cut_ = false;
};

namespace {

template <typename Number>
Number read_number(const char* bytes, bool little_endian) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (little_endian != (std::endian::native == std::endian::little))
    std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Number>(raw);
}

template <typename Number>
std::vector<Number> read_numbers(const TextFile& file, const char* bytes, std::size_t n,
                                 bool little_endian) {
  std::vector<Number> values(n);
  file.copy(bytes, n * sizeof(Number), values.data());
  if (little_endian == (std::endian::native == std::endian::little)) return values;
  for (Number& value : values)
    value = read_number<Number>(reinterpret_cast<const char*>(&value), little_endian);
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

/// Whether this is no number that was ever measured.
bool is_strange(const char* at, std::size_t bytes, bool little) {
  const double value = bytes == 8 ? read_number<double>(at, little)
                                  : static_cast<double>(read_number<float>(at, little));
  const double size = std::abs(value);
  return value != 0.0 && !(size > 1e-30 && size < 1e30);
}

constexpr std::uint64_t points_looked_at = 512;

/// Whether the first values are no measured numbers as the identifier line says their bytes lie,
/// and all are with the bytes the other way round.
bool looks_reversed(const Uff58Extent& extent, bool little_endian) {
  const std::size_t bytes = extent.number_bytes;
  const std::size_t point = extent.abscissa_bytes + bytes;
  std::uint64_t strange = 0, values = 0;
  for (std::uint64_t i = 0; i < std::min(extent.points, points_looked_at); ++i) {
    const char* const at = extent.start + i * point + extent.abscissa_bytes;
    if (is_strange(at, bytes, !little_endian)) return false;
    strange += is_strange(at, bytes, little_endian) ? 1 : 0;
    values += read_number<std::uint32_t>(at, true) != 0 ||
                      read_number<std::uint32_t>(at + bytes - 4, true) != 0
                  ? 1
                  : 0;
  }
  return values > 0 && 2 * strange > values;
}

/// Whether the first values of points of this layout are all numbers that may be measured.
bool looks_measured(const char* start, const PointLayout& layout, const Uff58Form& form) {
  for (std::uint64_t i = 0; i < std::min(form.points, points_looked_at); ++i)
    for (std::size_t k = 0; k < layout.numbers; ++k)
      if (is_strange(start + i * layout.size() + layout.abscissa + k * layout.number, layout.number,
                     form.little_endian))
        return false;
  return true;
}

/// The layouts of all ordinate types in which the announced points take so many bytes.
std::vector<PointLayout> layouts_of(const Uff58Form& form, std::uint64_t length) {
  std::vector<PointLayout> fitting;
  for (const std::size_t number : {4U, 8U})
    for (const std::size_t numbers : {1U, 2U})
      for (const bool wide : {false, true}) {
        if (wide && (form.even || number == 4)) continue;
        const PointLayout layout{form.even ? 0 : wide ? number : 4, number, numbers};
        if (layout.size() * form.points == length) fitting.push_back(layout);
      }
  return fitting;
}

/// What the announced points and bytes, which are there, make of an ordinate type that they
/// contradict: the other precision where nothing else fits. Throws datasets::InputError where that
/// may be wrong.
PointLayout settle_layout(const TextFile& file, const char* start, const Uff58Form& form,
                          std::uint64_t length, const PointLayout& layout,
                          std::vector<std::string>& warnings) {
  const std::vector<PointLayout> fitting = layouts_of(form, length);
  if (fitting.empty()) return layout;
  const std::string contradiction = fmt::format(
      "ordinate type {} takes {} bytes a point, and the header's points and bytes give {}",
      form.ordinate_type, layout.size(), fitting.front().size());
  const bool settled = fitting.size() == 1 && fitting.front().numbers == layout.numbers &&
                       looks_measured(start, fitting.front(), form);
  if (!settled)
    throw InputError(file.byte_position(start),
                     contradiction +
                         ": which is wrong cannot be told; correct the ordinate type in columns 1 "
                         "to 10 of record 7 or the number of points behind it");
  warnings.push_back(fmt::format("{}, as many as are there: the numbers are read in {} precision",
                                 contradiction, fitting.front().number == 8 ? "double" : "single"));
  return fitting.front();
}

/// The block is as long as its points are, or as announced: the length that a -1 follows is it.
/// Otherwise it goes on to the next -1.
Uff58Extent find_binary(const TextFile& file, const char* start, const Uff58Form& form) {
  const std::string_view bytes = file.bytes();
  const char* const end = bytes.data() + bytes.size();
  const auto available = static_cast<std::uint64_t>(end - start);
  Uff58Extent extent;
  extent.start = start;
  PointLayout layout = point_layout(form, false);
  const PointLayout wide = point_layout(form, true);
  // more points than bytes can be no true count; the products below must not overflow
  const std::uint64_t points = std::min(form.points, available + 1);
  const std::array<std::uint64_t, 3> lengths = {points * layout.size(), points * wide.size(),
                                                form.announced_bytes};
  std::uint64_t length = 0;
  for (const std::uint64_t candidate : lengths) {
    if (candidate > available || extent.closing != nullptr) continue;
    extent.closing = closing_line(start + candidate, end);
    length = candidate;
  }
  if (extent.closing == nullptr) {
    extent.closing = find_closing_line(start, end);
    length = static_cast<std::uint64_t>(extent.closing - start);
    if (extent.closing == end) {
      length = std::min(length, std::max(form.announced_bytes, lengths[0]));
      extent.warnings.emplace_back(
          "the file ends without the closing -1: it may have been cut off");
    }
  }
  // of data that are cut off the announced length tells
  const bool announced_wide =
      form.announced_bytes / wide.size() == form.points && form.announced_bytes % wide.size() == 0;
  if ((length == lengths[1] || announced_wide) && length != lengths[0])
    layout = wide;
  else if (length == form.announced_bytes && length != lengths[0] && form.points <= available)
    layout = settle_layout(file, start, form, length, layout, extent.warnings);
  extent.abscissa_bytes = static_cast<std::uint32_t>(layout.abscissa);
  extent.number_bytes = static_cast<std::uint32_t>(layout.number);
  extent.points = length / layout.size();
  if (form.announced_bytes != 0 && form.announced_bytes != length)
    extent.warnings.push_back(
        fmt::format("the identifier line announces {} bytes of data, {} are there",
                    form.announced_bytes, length));
  if (!form.complex() && looks_reversed(extent, form.little_endian))
    extent.warnings.push_back(fmt::format(
        "the identifier line says that bytes are {}-endian, and the values are numbers of "
        "a measurement only the other way round: correct the byte order in columns 8 to "
        "13 of that line",
        form.little_endian ? "little" : "big"));
  if (extent.points == 0 && form.points > 0)
    throw InputError(file.byte_position(start),
                     fmt::format("{} points are announced and no data are there", form.points));
  return extent;
}

/// The closing line of text data whose lines are all as long as the first and as many as announced;
/// null when it is not there.
const char* closing_line_by_count(const char* start, const char* end, const Uff58Form& form) {
  const std::uint64_t numbers_a_line = line_widths(form).size();
  const auto available = static_cast<std::uint64_t>(end - start);
  if (form.points == 0 || form.points > available) return nullptr;
  const char* next = start;
  take_line(next, end);
  const auto line = static_cast<std::uint64_t>(next - start);
  const std::uint64_t lines =
      (form.points * numbers_a_point(form) + numbers_a_line - 1) / numbers_a_line;
  if (lines > available / line) return nullptr;
  const char* at = start + (lines - 1) * line;
  if (at > start && at[-1] != '\n') return nullptr;
  take_line(at, end);
  next = at;
  return is_uff_delimiter(take_line(next, end)) ? at : nullptr;
}

}  // namespace

/// Points side by side.
class Uff58Reader::Binary {
 public:
  Binary(const TextFile& file, const Uff58Form& form, const Uff58Extent& extent)
      : file_(file),
        form_(form),
        extent_(extent),
        at_(extent.start) {}

  const char* at() const { return at_; }

  std::uint64_t skip(std::uint64_t points) {
    at_ += points * point_bytes();
    return points;
  }

  Uff58Block read(std::size_t most, std::uint64_t& left) {
    const auto points = static_cast<std::size_t>(std::min<std::uint64_t>(most, left));
    left -= points;
    Uff58Block block;
    if (!form_.even || form_.complex())
      divide(points, block);
    else if (extent_.number_bytes == 8)
      block.ordinate = read_numbers<double>(file_, at_, points, form_.little_endian);
    else
      block.ordinate = read_numbers<float>(file_, at_, points, form_.little_endian);
    at_ += points * point_bytes();
    return block;
  }

 private:
  std::size_t point_bytes() const {
    return extent_.abscissa_bytes + extent_.number_bytes * (form_.complex() ? 2U : 1U);
  }

  double number(const char* p, std::size_t size) const {
    return size == 8 ? read_number<double>(p, form_.little_endian)
                     : static_cast<double>(read_number<float>(p, form_.little_endian));
  }

  /// Takes points of several numbers apart.
  void divide(std::size_t points, Uff58Block& block) const {
    std::vector<double> ordinate(points);
    if (!form_.even) block.abscissa.resize(points);
    if (form_.complex()) block.imaginary.resize(points);
    for (std::size_t i = 0; i < points; ++i) {
      const char* p = at_ + i * point_bytes();
      if (!form_.even) block.abscissa[i] = number(p, extent_.abscissa_bytes);
      p += extent_.abscissa_bytes;
      ordinate[i] = number(p, extent_.number_bytes);
      if (form_.complex())
        block.imaginary[i] = number(p + extent_.number_bytes, extent_.number_bytes);
    }
    block.ordinate = std::move(ordinate);
  }

  const TextFile& file_;
  const Uff58Form& form_;
  const Uff58Extent& extent_;
  const char* at_;
};

std::size_t Uff58Block::size() const {
  return std::visit([](const auto& samples) { return samples.size(); }, ordinate);
}

bool is_uff_delimiter(std::string_view line) {
  if (line.size() < 2 || line.size() > 200) return false;
  const std::string_view text = trimmed(line);
  return text == "-1" && text.data() - line.data() == 4;
}

Uff58Extent find_uff58_data(const TextFile& file, const char* start, const Uff58Form& form,
                            bool lines_count, bool trusting) {
  Uff58Extent extent;
  if (form.binary) {
    extent = find_binary(file, start, form);
  } else {
    const std::string_view bytes = file.bytes();
    extent.start = start;
    if (trusting) extent.closing = closing_line_by_count(start, bytes.data() + bytes.size(), form);
    extent.counted = extent.closing == nullptr;
    extent.points = form.points;
    if (extent.counted) extent.points = Uff58Reader::count(file, form, lines_count, extent);
  }
  if (extent.points != form.points)
    extent.warnings.push_back(
        fmt::format("the header announces {} points, {} are there: these are read", form.points,
                    extent.points));
  return extent;
}

Uff58Reader::Uff58Reader(const TextFile& file, const Uff58Form& form, const Uff58Extent& extent,
                         bool lines_count)
    : left_(extent.points),
      even_lines_(!extent.counted) {
  if (form.binary)
    binary_ = std::make_unique<Binary>(file, form, extent);
  else
    text_ = std::make_unique<Text>(file, extent.start, form, lines_count);
}

Uff58Reader::~Uff58Reader() = default;

std::uint64_t Uff58Reader::count(const TextFile& file, const Uff58Form& form, bool lines_count,
                                 Uff58Extent& extent) {
  Text text(file, extent.start, form, lines_count);
  const std::uint64_t points = text.count();
  extent.closing = text.at();
  extent.warnings = text.warnings();
  return points;
}

std::uint64_t Uff58Reader::skip(std::uint64_t points) {
  points = std::min(points, left_);
  if (text_ && !even_lines_) return 0;
  const std::uint64_t skipped = text_ ? text_->skip(points) : binary_->skip(points);
  left_ -= skipped;
  return skipped;
}

Uff58Block Uff58Reader::read(std::size_t most) {
  return text_ ? text_->read(most, left_) : binary_->read(most, left_);
}

const char* Uff58Reader::at() const {
  return text_ ? text_->at() : binary_->at();
}

std::vector<std::string> Uff58Reader::warnings() const {
  return text_ ? text_->warnings() : std::vector<std::string>{};
}

}  // namespace impactrig::acquisition
