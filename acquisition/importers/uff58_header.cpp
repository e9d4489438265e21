// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/uff58_header.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "acquisition/importers/number.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::SourcePosition;

namespace {

class HeaderReader {
 public:
  HeaderReader(const TextFile& file, const char*& at, bool lines_count)
      : file_(file),
        at_(at),
        end_(file.bytes().data() + file.bytes().size()),
        lines_count_(lines_count) {}

  UffHeader read(std::string_view identifier) {
    read_identifier(identifier);
    for (std::string& id : header_.id) id = to_utf8(trimmed(header_line()));
    read_record_6(header_line());
    read_record_7(header_line());
    header_.abscissa = read_axis(header_line());
    header_.ordinate = read_axis(header_line());
    header_.denominator = read_axis(header_line());
    if (at_ == end_ && header_.form.points > 0) throw UffHeaderCut{at_};
    take_line(at_, end_);  // record 11, the z axis
    for (long i = 0; i < extra_lines_ && at_ != end_; ++i) take_line(at_, end_);
    return std::move(header_);
  }

 private:
  SourcePosition place(const char* at) const {
    return lines_count_ ? file_.position(at) : file_.byte_position(at);
  }

  std::string_view header_line() {
    if (at_ == end_) throw UffHeaderCut{at_};
    return take_line(at_, end_);
  }

  long integer_at(std::string_view line, std::size_t first, std::size_t width,
                  std::string_view what) {
    const std::string_view field = uff_columns(line, first, width);
    if (trimmed(field).empty()) return 0;
    const auto value = integer_in(field);
    if (value) return *value;
    throw InputError(place(field.data()),
                     fmt::format("{}: expected an integer in columns {} to {}, found '{}'", what,
                                 first, first + width - 1, to_utf8(trimmed(field))));
  }

  void read_identifier(std::string_view line) {
    const std::string_view letter = uff_columns(line, 7, 1);
    if (letter != "b" && letter != "B") return;
    header_.form.binary = true;
    const long order = integer_at(line, 8, 6, "byte order");
    const long format = integer_at(line, 14, 6, "floating-point format");
    const long bytes = integer_at(line, 32, 12, "number of data bytes");
    if (format == 1 || format == 3)
      throw InputError(
          place(line.data()),
          fmt::format(
              "UFF 58b with {} floating-point numbers is not read: export it with IEEE numbers or "
              "as text (dataset 58)",
              format == 1 ? "DEC VAX" : "IBM 370"));
    if (format != 2)
      throw InputError(
          place(line.data()),
          fmt::format("floating-point format {} is unknown: expected 2 (IEEE)", format));
    if (order != 1 && order != 2)
      throw InputError(
          place(line.data()),
          fmt::format("byte order {} is unknown: expected 1 (little) or 2 (big)", order));
    header_.form.little_endian = order == 1;
    header_.form.announced_bytes = bytes > 0 ? static_cast<std::uint64_t>(bytes) : 0;
    extra_lines_ = std::clamp(integer_at(line, 20, 12, "number of header lines") - 11, 0L, 20L);
  }

  void read_record_6(std::string_view line) {
    header_.function_type = static_cast<int>(integer_at(line, 1, 5, "function type"));
    header_.response_entity = uff_text(uff_columns(line, 32, 10));
    header_.response_node = integer_in(uff_columns(line, 42, 10)).value_or(0);
    header_.response_direction = integer_in(uff_columns(line, 52, 4)).value_or(0);
    header_.reference_entity = uff_text(uff_columns(line, 57, 10));
    header_.reference_node = integer_in(uff_columns(line, 67, 10)).value_or(0);
    header_.reference_direction = integer_in(uff_columns(line, 77, 4)).value_or(0);
  }

  /// Ordinate type, number of points, spacing, start, increment: by columns, else by the blanks
  /// between them.
  void read_record_7(std::string_view line) {
    std::array<std::string_view, 5> fields = {uff_columns(line, 1, 10), uff_columns(line, 11, 10),
                                              uff_columns(line, 21, 10), uff_columns(line, 31, 13),
                                              uff_columns(line, 44, 13)};
    const auto sound = [&fields] {
      return integer_in(fields[0]) && integer_in(fields[1]) && integer_in(fields[2]) &&
             number_in(fields[3], {'.', true}) && number_in(fields[4], {'.', true});
    };
    if (!sound()) {
      std::string_view rest = trimmed(line);
      for (std::string_view& field : fields) {
        const std::size_t blank = std::min(rest.find(' '), rest.size());
        field = rest.substr(0, blank);
        rest = trimmed(rest.substr(blank));
      }
    }
    if (!sound())
      throw InputError(place(line.data()),
                       fmt::format("record 7 of a dataset 58: expected ordinate type, points, "
                                   "spacing, start and increment, found '{}'",
                                   to_utf8(trimmed(line))));
    header_.form.ordinate_type = static_cast<int>(*integer_in(fields[0]));
    const long points = *integer_in(fields[1]);
    header_.form.even = *integer_in(fields[2]) != 0;
    header_.start = *number_in(fields[3], {'.', true});
    header_.increment = *number_in(fields[4], {'.', true});
    header_.increment_text = trimmed(fields[4]);
    const int type = header_.form.ordinate_type;
    if (type != 2 && type != 4 && type != 5 && type != 6)
      throw InputError(place(line.data()),
                       fmt::format("ordinate type {} is unknown: expected 2, 4, 5 or 6", type));
    if (points < 0)
      throw InputError(place(line.data()),
                       fmt::format("the number of points is {}: expected 0 or more", points));
    header_.form.points = static_cast<std::uint64_t>(points);
  }

  UffAxis read_axis(std::string_view line) {
    UffAxis axis;
    axis.type = static_cast<int>(integer_at(line, 1, 10, "specific data type"));
    axis.label = uff_text(uff_columns(line, 27, 20));
    axis.unit = uff_text(uff_columns(line, 48, 20));
    return axis;
  }

  const TextFile& file_;
  const char*& at_;
  const char* end_;
  bool lines_count_;
  UffHeader header_;
  long extra_lines_ = 0;  // beyond the eleven of the standard
};

}  // namespace

std::string_view uff_columns(std::string_view line, std::size_t first, std::size_t width) {
  return first > line.size() ? std::string_view{} : line.substr(first - 1, width);
}

std::string uff_text(std::string_view field) {
  const std::string text = to_utf8(trimmed(field));
  return text == "NONE" ? std::string() : text;
}

UffHeader read_uff58_header(const TextFile& file, std::string_view identifier, const char*& at,
                            bool lines_count) {
  return HeaderReader(file, at, lines_count).read(identifier);
}

}  // namespace impactrig::acquisition
