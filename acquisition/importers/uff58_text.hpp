// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/uff58_data.hpp"

namespace impactrig::acquisition {

/// Widths of the columns of one line of ASCII data.
std::span<const int> uff58_line_widths(const Uff58Form& form);

/// With the abscissa, where each point has one.
std::size_t uff58_numbers_a_point(const Uff58Form& form);

/// The closing line of text data whose lines are all as long as the first and as many as announced;
/// null when it is not there.
const char* uff58_closing_line_by_count(const char* start, const char* end, const Uff58Form& form);

/// Numbers in columns, line by line.
class Uff58Text {
 public:
  Uff58Text(const TextFile& file, const char* start, const Uff58Form& form, bool lines_count)
      : file_(file),
        at_(start),
        form_(form),
        lines_count_(lines_count),
        widths_(uff58_line_widths(form)) {}

  const char* at() const { return at_; }

  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Reads lines until there are so many numbers, or up to the closing line; false there.
  bool read_numbers(std::size_t most);

  /// Counts the points that are there, against those announced.
  std::uint64_t count();

  /// Passes over whole lines that are all as long as the first.
  std::uint64_t skip(std::uint64_t points);

  /// The next whole points, of `left` that are there; the start of a line that remains is for the
  /// next call.
  Uff58Block read(std::size_t most, std::uint64_t& left);

 private:
  static constexpr std::size_t numbers_at_once = 65536;

  datasets::SourcePosition place(const char* at) const;

  void read_line(std::string_view line, bool last_of_file);

  /// False when a column holds anything but a number and blanks.
  bool read_by_columns(std::string_view line);

  bool read_by_blanks(std::string_view line);

  void read_whole_numbers(std::string_view line);

  [[noreturn]] void report(std::string_view line);

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

}  // namespace impactrig::acquisition
