// SPDX-License-Identifier: BSD-3-Clause
// LabVIEW measurement files. Layout: National Instruments, "Specification for the LabVIEW
// Measurement File (.lvm)", 2006 and later.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/large_table.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/text_table.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;
using datasets::SampleClock;

namespace {

constexpr std::string_view first_word = "LabVIEW Measurement";
constexpr std::string_view end_of_header = "***End_of_Header***";
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t end = line.find(separator);
    cells.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

/// A moment, whole seconds apart from the rest so that differences keep their digits.
struct Moment {
  std::int64_t seconds = 0;
  double fraction = 0.0;
};

double operator-(const Moment& a, const Moment& b) {
  return static_cast<double>(a.seconds - b.seconds) + (a.fraction - b.fraction);
}

/// "2013/02/19" and "09:51:40,727189064" (or with a point).
std::optional<Moment> moment_of(std::string_view date, std::string_view time) {
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
  Moment moment;
  const auto days = std::chrono::sys_days{calendar}.time_since_epoch().count();
  moment.seconds = (static_cast<std::int64_t>(days) * 24 + h) * 3600 + min * 60 + s;
  std::string rest = hour.substr(static_cast<std::size_t>(used));
  if (rest.size() > 1 && (rest[0] == '.' || rest[0] == ','))
    moment.fraction = number_in("0." + rest.substr(1)).value_or(0.0);
  return moment;
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

/// Whether X values are X_0 + i Delta_X but for the digits they were printed with.
struct DeltaCheck {
  bool agrees = true;
  std::uint64_t count = 0;
  double first = 0.0;
  double first_place = 0.0;

  void see(double x, double place, double delta) {
    if (count == 0) {
      first = x;
      first_place = place;
    }
    const double line = first + delta * static_cast<double>(count++);
    const double rounding = 0.5 * (place + first_place) + 1e-12 * std::abs(x);
    agrees = agrees && std::abs(x - line) <= 1.02 * rounding;
  }
};

/// One channel of one segment.
struct Part {
  std::string name;
  std::string unit;
  std::string y_dimension;
  std::string x_dimension;
  std::string x_unit;
  std::string delta_text;             ///< of Delta_X, as printed
  std::optional<double> x0;           ///< in x_unit
  std::optional<double> delta;        ///< likewise
  std::optional<std::uint64_t> said;  ///< samples the header declares
  std::vector<double> values;
  std::vector<std::uint8_t> valid;  ///< empty: all are there
  std::vector<double> x;            ///< one a value; empty: there is no X column
  DeltaCheck check;
  std::uint64_t missing = 0;
  std::uint64_t counted = 0;    ///< samples, where they are counted only and `values` stays empty
  std::uint64_t counted_x = 0;  ///< X values with them

  std::uint64_t samples() const { return counted > 0 ? counted : values.size(); }
};

/// Channels that were recorded together.
struct Segment {
  std::vector<Part> parts;
  std::optional<Moment> moment;
  double shift = 0.0;  ///< what its times lack to those of the first segment [s]
  int first = 1;       ///< number of this segment in the file
  int joined = 1;      ///< how many segments of the file it consists of
};

bool alike(const Segment& a, const Segment& b) {
  return std::ranges::equal(a.parts, b.parts, [](const Part& one, const Part& other) {
    return one.name == other.name && one.unit == other.unit &&
           one.x_dimension == other.x_dimension && one.x_unit == other.x_unit &&
           one.delta == other.delta && one.x.empty() == other.x.empty();
  });
}

double first_x(const Part& part) {
  return part.x.empty() ? part.x0.value_or(0.0) : part.x.front();
}

double step_of(const Part& part) {
  const std::size_t n = part.x.size();
  if (n > 1) return (part.x.back() - part.x.front()) / static_cast<double>(n - 1);
  return part.delta.value_or(0.0);
}

/// Whether `next`, shifted, goes on where `part` ends: within half a step.
bool continues(const Part& part, const Part& next, double shift) {
  const double step = step_of(part);
  if (!(step > 0.0) || part.values.empty() || next.values.empty()) return false;
  const double end = part.x.empty() ? first_x(part) + step * static_cast<double>(part.values.size())
                                    : part.x.back() + step;
  return std::abs(first_x(next) + shift - end) <= 0.5 * step;
}

void append(Part& part, Part&& next, double shift) {
  if (part.valid.empty() && !next.valid.empty()) part.valid.assign(part.values.size(), 1);
  if (!part.valid.empty() && next.valid.empty()) next.valid.assign(next.values.size(), 1);
  part.valid.insert(part.valid.end(), next.valid.begin(), next.valid.end());
  part.values.insert(part.values.end(), next.values.begin(), next.values.end());
  part.missing += next.missing;
  for (const double x : next.x) part.x.push_back(x + shift);
  part.check.agrees = part.check.agrees && next.check.agrees;
  if (part.said && next.said && *next.said < std::numeric_limits<std::uint64_t>::max() - *part.said)
    *part.said += *next.said;
  else
    part.said.reset();
}

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

/// The round rate [Hz] that a Delta_X of few decimals must stand for: "0.000977" is 1/1024 s. None
/// when the rate is an integer as it stands, or nothing is rounder.
std::optional<double> rate_meant(std::string_view text, double delta) {
  const std::size_t mark = text.find_first_of(".,");
  const bool fixed = mark != std::string_view::npos &&
                     text.find_first_not_of("0123456789", mark + 1) == std::string_view::npos;
  if (!fixed || !(delta > 0.0)) return std::nullopt;
  const double stated = 1.0 / delta;
  if (std::abs(stated - std::round(stated)) <= 1e-9 * stated) return std::nullopt;
  const double half = 0.5 * std::pow(10.0, -static_cast<double>(text.size() - mark - 1));
  if (!(half < delta)) return std::nullopt;
  const double low = std::ceil(1.0 / (delta + half));
  const double high = std::floor(1.0 / (delta - half));
  // a number with one or two digits is rounded so much that nothing can be said
  if (!(low >= 1.0) || high - low > 0.01 * stated || high - low > 1000.0) return std::nullopt;
  std::optional<double> best;
  double best_odd = 0.0;
  for (double rate = low; rate <= high; rate += 1.0) {
    double odd = rate;
    for (const double factor : {2.0, 5.0})
      while (std::fmod(odd, factor) == 0.0) odd /= factor;
    if (!best || odd < best_odd) {
      best = rate;
      best_odd = odd;
    }
  }
  return best && best_odd < 100.0 ? best : std::nullopt;
}

class LvmReader {
 public:
  LvmReader(const std::string& path, const ImportOptions& options)
      : file_(path),
        options_(options),
        at_(file_.text().data()),
        end_(at_ + file_.text().size()) {}

  /// Counts what a large file holds without keeping it. False where that does not tell all there is
  /// to know: several segments, missing values, times that Delta_X does not explain.
  bool count() {
    counting_ = true;
    read_file_header();
    if (!read_segment() || !plain_) return false;
    skip_between();
    if (at_ != end_ || segments_.size() != 1) return false;
    for (Part& part : segments_.front().parts) {
      const bool without_x = part.x.empty() && part.counted_x == 0;
      const bool explained = part.check.agrees && part.delta.value_or(0.0) > 0.0;
      if (part.counted == 0 || !(without_x || explained)) return false;
    }
    finish();
    return true;
  }

  const Record& record() const { return record_; }

  std::vector<std::uint64_t> counts() const {
    std::vector<std::uint64_t> list;
    for (const Part& part : segments_.front().parts) list.push_back(part.counted);
    return list;
  }

  /// Reads the values that were counted; `use(row)` is told before each row, `take(channel, value)`
  /// of each value.
  template <typename Use, typename Take>
  void read_counted(const Use& use, const Take& take) {
    const Segment& segment = segments_.front();
    const std::size_t channels = segment.parts.size();
    std::uint64_t row = 0;
    for (const char* at = rows_first_; at != rows_last_;) {
      const std::string_view line = take_line(at, rows_last_);
      if (blank(line)) continue;
      if (!use(row++, at)) return;
      const char* cell = line.data();
      const char* const last = line.data() + line.size();
      for (std::size_t column = 0; cell <= last; ++column, ++cell) {
        const bool is_x = multi_ ? column % 2 == 0 : column == 0;
        const std::size_t channel = multi_ ? column / 2 : column - 1;
        if (column > 0 && channel >= channels) break;
        double value = nothing;
        if (take_cell(cell, last, segment, column, value) && !is_x) take(channel, value);
      }
    }
  }

  void release(const char* first, const char* last) const { file_.release(first, last); }

  const char* rows() const { return rows_first_; }

  Record read() {
    read_file_header();
    while (read_segment()) {
    }
    finish();
    return std::move(record_);
  }

 private:
  void finish() {
    if (segments_.empty())
      warn("there is no segment with samples in this file: there are no channels");
    for (Segment& segment : segments_) deliver(segment);
    if (options_.units.size() > record_.channels.size())
      throw InputError(whole(), fmt::format("{} units are stated but the file has {} channels",
                                            options_.units.size(), record_.channels.size()));
    if (special_blocks_ > 0)
      record_.attributes["special blocks left out"] = fmt::format("{}", special_blocks_);
  }

  datasets::SourcePosition whole() const {
    datasets::SourcePosition place;
    place.file = file_.path();
    return place;
  }

  void warn(std::string text) {
    if (record_.warnings.size() < most_warnings &&
        std::ranges::find(record_.warnings, text) == record_.warnings.end())
      record_.warnings.push_back(std::move(text));
  }

  void say(std::string_view key, std::string_view value) {
    if (!value.empty()) record_.attributes.emplace(to_utf8(key), to_utf8(value));
  }

  bool blank(std::string_view line) const {
    return std::ranges::all_of(line, [this](char c) {
      return c == separator_ || c == ' ' || c == '\t' || c == '\r' || c == '\0';
    });
  }

  // ---- the head of the file

  void read_file_header() {
    while (at_ != end_ && std::string_view(" \t\r\n").find(*at_) != std::string_view::npos) ++at_;
    const char* const start = at_;
    std::string_view line = take_line(at_, end_);
    if (!trimmed(line).starts_with(first_word))
      throw InputError(file_.position(start), fmt::format("expected '{}', found '{}'", first_word,
                                                          to_utf8(trimmed(line).substr(0, 40))));
    find_separator(start);
    std::string date;
    std::string time;
    for (;;) {
      if (at_ == end_)
        throw InputError(file_.position(end_),
                         fmt::format("the file ends within its header: no '{}'", end_of_header));
      const char* const begin = at_;
      line = take_line(at_, end_);
      const std::vector<std::string_view> cells = split(line, separator_);
      const std::string_view key = cells.front();
      const std::string_view value = cells.size() > 1 ? cells[1] : std::string_view{};
      if (key.starts_with(end_of_header)) break;
      if (key == "Channels" || key == "X_Value")
        throw InputError(
            file_.position(begin),
            fmt::format("the file's header does not end before '{}': no '{}'", key, end_of_header));
      if (key == "Decimal_Separator" && !value.empty()) decimal_ = value.front();
      if (key == "X_Columns") multi_ = lowered(value) == "multi";
      if (key == "Multi_Headings") one_heading_ = lowered(value) == "no";
      if (key == "Date") date = value;
      if (key == "Time") time = value;
      if (key == "Description") record_.title = to_utf8(value);
      if (!key.empty()) say(key, value);
    }
    if (options_.decimal) decimal_ = *options_.decimal;
    if (decimal_ != '\0' && decimal_ != '.' && decimal_ != ',')
      throw InputError(file_.position(start),
                       fmt::format("Decimal_Separator is '{}', expected '.' or ','",
                                   to_utf8(std::string(1, decimal_))));
    if (decimal_ == separator_)
      throw InputError(file_.position(start),
                       fmt::format("Separator and Decimal_Separator are both '{}': state --decimal",
                                   to_utf8(std::string(1, decimal_))));
    record_.started = iso_text(date, time);
  }

  /// "Separator<TAB>Tab" and "Separator,Comma" show it twice; the word decides.
  void find_separator(const char* start) {
    constexpr std::string_view key = "Separator";
    std::string_view rest(start, static_cast<std::size_t>(end_ - start));
    rest = rest.substr(0, 65536);
    const std::size_t first_end = rest.find_first_of("\r\n");
    const std::size_t after = rest.find_first_of("\t,;", first_word.size());
    if (after < first_end) separator_ = rest[after];
    for (std::size_t found = rest.find("\nSeparator"); found != std::string_view::npos;
         found = rest.find("\nSeparator", found + 1)) {
      const std::string_view line = rest.substr(found + 1, rest.find('\n', found + 1) - found - 1);
      if (line.size() <= key.size()) continue;
      const char written = line[key.size()];
      const std::string_view word = trimmed(line.substr(key.size() + 1));
      separator_ = written;
      if (word.starts_with("Tab")) separator_ = '\t';
      if (word.starts_with("Comma")) separator_ = ',';
      break;
    }
    if (options_.delimiter) separator_ = *options_.delimiter;
  }

  // ---- a segment

  /// False when there is none left.
  bool read_segment() {
    skip_between();
    if (at_ == end_) return false;
    const char* const start = at_;
    Header header;
    if (!read_segment_header(header)) {
      warn(fmt::format("the file ends within the header of segment {} at {}: it is left out",
                       number_ + 1, file_.position(start).text()));
      return false;
    }
    ++number_;
    if (at_ == end_) {
      warn(fmt::format("segment {} has no samples: the file ends behind its header", number_));
      return false;
    }
    Segment segment;
    segment.first = number_;
    segment.moment = moment_of(header.cell("Date"), header.cell("Time"));
    if (number_ == 1 && segment.moment)
      record_.started = iso_text(header.cell("Date"), header.cell("Time"));
    name_columns(header, segment);
    read_rows(segment);
    check_counts(segment);
    add(std::move(segment));
    return true;
  }

  /// Cells of the header's lines by their key.
  struct Header {
    std::map<std::string, std::vector<std::string_view>, std::less<>> lines;

    /// The cell of a column; for a key alone its first one that is not empty.
    std::string_view cell(std::string_view key, std::size_t column) const {
      const auto found = lines.find(key);
      return found != lines.end() && column < found->second.size() ? found->second[column]
                                                                   : std::string_view{};
    }

    std::string_view cell(std::string_view key) const {
      const auto found = lines.find(key);
      if (found == lines.end()) return {};
      for (std::size_t c = 1; c < found->second.size(); ++c)
        if (!found->second[c].empty()) return found->second[c];
      return {};
    }
  };

  /// Empty lines, and special blocks, which are whatever a program wanted to keep.
  void skip_between() {
    while (at_ != end_) {
      const char* const start = at_;
      const std::string_view line = take_line(at_, end_);
      if (line.starts_with("***Start_Special***")) {
        skip_special(start);
        continue;
      }
      if (blank(line)) continue;
      at_ = start;
      return;
    }
  }

  void skip_special(const char* start) {
    ++special_blocks_;
    while (at_ != end_)
      if (take_line(at_, end_).starts_with("***End_Special***")) return;
    warn(fmt::format("the special block at {} does not end: the rest of the file is left out",
                     file_.position(start).text()));
  }

  bool read_segment_header(Header& header) {
    while (at_ != end_) {
      const char* const start = at_;
      const std::string_view line = take_line(at_, end_);
      if (line.starts_with("***Start_Special***")) {
        skip_special(start);
        continue;
      }
      std::vector<std::string_view> cells = split(line, separator_);
      if (cells.front().starts_with(end_of_header)) return true;
      if (cells.front().empty()) continue;
      if (cells.front() == "X_Value" || number_in(cells.front(), {'.', false}))
        throw InputError(file_.position(start),
                         fmt::format("the header of segment {} does not end before this line: no "
                                     "'{}'",
                                     number_ + 1, end_of_header));
      const std::string key = to_utf8(cells.front());
      constexpr std::array<std::string_view, 9> per_channel = {
          "Samples",     "Date",         "Time", "Y_Unit_Label", "Y_Dimension",
          "X_Dimension", "X_Unit_Label", "X0",   "Delta_X"};
      if (std::ranges::find(per_channel, key) == per_channel.end() && key != "Channels" &&
          cells.size() > 1)
        say(key, cells[1]);
      if (key == "Test_Name" && record_.title.empty() && cells.size() > 1)
        record_.title = to_utf8(cells[1]);
      header.lines.emplace(key, std::move(cells));
    }
    return false;
  }

  std::size_t y_column(std::size_t channel) const { return multi_ ? 2 * channel + 1 : channel + 1; }

  /// Channels from the line of names; the header's lines have their values in the same columns.
  void name_columns(const Header& header, Segment& segment) {
    const char* const start = at_;
    std::vector<std::string_view> names = split(take_line(at_, end_), separator_);
    if (names.front() != "X_Value")
      throw InputError(file_.position(start),
                       fmt::format("expected the line of names that begins with 'X_Value', found "
                                   "'{}'",
                                   to_utf8(names.front().substr(0, 40))));
    comment_ = names.size() > 1 && names.back() == "Comment";
    if (comment_) names.pop_back();
    std::size_t channels = multi_ ? names.size() / 2 : names.size() - 1;
    const auto declared = integer_in(header.cell("Channels"));
    const bool trailing = !comment_ && names.size() > 1 && names.back().empty();
    if (trailing && declared && *declared >= 0 && static_cast<std::size_t>(*declared) < channels)
      channels = static_cast<std::size_t>(*declared);
    if (!header.cell("Channels").empty() &&
        (!declared || *declared < 0 || static_cast<std::size_t>(*declared) != channels))
      warn(fmt::format("segment {} declares {} channels and names {}: those named are read",
                       number_, to_utf8(header.cell("Channels").substr(0, 40)), channels));
    if (decimal_ == '\0') decimal_ = decimal_of(header, channels);
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t column = y_column(c);
      Part part;
      part.name = column < names.size() ? to_utf8(names[column]) : std::string();
      if (part.name.empty()) part.name = fmt::format("column {}", column);
      part.unit = to_utf8(header.cell("Y_Unit_Label", column));
      part.y_dimension = to_utf8(header.cell("Y_Dimension", column));
      part.x_dimension = to_utf8(header.cell("X_Dimension", column));
      part.x_unit = to_utf8(header.cell("X_Unit_Label", column));
      part.x0 = finite(header.cell("X0", column));
      part.delta_text = to_utf8(header.cell("Delta_X", column));
      part.delta = finite(header.cell("Delta_X", column));
      if (part.delta && !(*part.delta > 0.0)) part.delta.reset();
      const auto said = integer_in(header.cell("Samples", column));
      if (said && *said >= 0) part.said = static_cast<std::uint64_t>(*said);
      segment.parts.push_back(std::move(part));
    }
  }

  std::optional<double> finite(std::string_view cell) const {
    const auto value = number_in(cell, {decimal_, false});
    return value && std::isfinite(*value) ? value : std::nullopt;
  }

  /// For files without Decimal_Separator: what the first numbers are written with.
  char decimal_of(const Header& header, std::size_t channels) const {
    if (separator_ == ',') return '.';
    const char* at = at_;
    const auto row = split(take_line(at, end_), separator_);
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

  // ---- rows

  /// Rows until a line of text or the end of the file. An empty cell is no sample: the column ends,
  /// or a value is missing when it goes on below.
  void read_rows(Segment& segment) {
    const std::size_t channels = segment.parts.size();
    const std::uint64_t packet = packet_length(segment);
    std::vector<std::uint64_t> due(channels, 0);  // samples that rows up to now ought to have
    std::vector<double> x;                        // the only X column
    std::uint64_t row = 0;
    std::size_t cells_before = 0;
    rows_first_ = at_;
    rows_last_ = end_;
    if (packet != 0) plain_ = false;
    const char* released = at_;
    while (at_ != end_ && (plain_ || !counting_)) {
      const char* const start = at_;
      const std::string_view line = take_line(at_, end_);
      if (blank(line)) continue;
      if (ends_rows(line)) {
        at_ = rows_last_ = start;
        break;
      }
      if (counting_ && start - released > (1 << 22)) {
        file_.release(released, start);
        released = start;
      }
      const auto cells = static_cast<std::size_t>(std::ranges::count(line, separator_)) + 1;
      const bool whole_line = line.data() + line.size() != end_;
      if (!whole_line && cells < cells_before) {
        warn(fmt::format("the file ends within the row at {}: this row is left out",
                         file_.position(start).text()));
        rows_last_ = start;
        break;
      }
      cells_before = cells;
      read_row(line, segment, packet, row, due, x);
      ++row;
    }
    if (!multi_) share_x(segment, std::move(x));
  }

  /// A line that begins with text: a header's key, a special block.
  bool ends_rows(std::string_view line) const {
    const std::string_view cell = trimmed(line.substr(0, line.find(separator_)));
    if (cell.empty() || cell_value(cell, decimal_)) return false;
    const auto letter = static_cast<unsigned char>(cell.front());
    return std::isalpha(letter) != 0 || cell.starts_with("***");
  }

  /// Rows of a packet when channels have different numbers of samples in it, else 0. Packets that
  /// follow without a header then leave cells empty that are not missing.
  std::uint64_t packet_length(const Segment& segment) const {
    std::uint64_t most = 0;
    bool differ = false;
    for (const Part& part : segment.parts) {
      if (!part.said || *part.said == 0) return 0;
      differ = differ || *part.said != *segment.parts.front().said;
      most = std::max(most, *part.said);
    }
    return differ && one_heading_ ? most : 0;
  }

  void read_row(std::string_view line, Segment& segment, std::uint64_t packet, std::uint64_t row,
                std::vector<std::uint64_t>& due, std::vector<double>& x) {
    const char* at = line.data();
    const char* const last = line.data() + line.size();
    const std::size_t channels = segment.parts.size();
    double pair_x = nothing;
    for (std::size_t column = 0; at <= last; ++column) {
      const char* stop = at;
      double value = nothing;
      const bool is_x = multi_ ? column % 2 == 0 : column == 0;
      const std::size_t channel = multi_ ? column / 2 : column - 1;
      const bool beyond = column > 0 && channel >= channels;
      if (beyond) {
        take_comment({at, static_cast<std::size_t>(last - at)}, row);
        return;
      }
      const bool there = take_cell(stop, last, segment, column, value);
      if (is_x && there && channels > 0) {
        Part& part = segment.parts[multi_ ? channel : 0];
        const std::string_view cell(at, static_cast<std::size_t>(stop - at));
        part.check.see(value, last_place(trimmed(cell), decimal_), part.delta.value_or(0.0));
      }
      if (is_x && multi_) pair_x = value;
      if (is_x && !multi_ && there && counting_) {
        if (x_rows_++ != row) plain_ = false;
        if (row == 0) x.push_back(value);
      } else if (is_x && !multi_ && there) {
        if (x.size() < row) charge(row - x.size());
        x.resize(row, nothing);
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

  /// Reads a cell; false when it is empty. `at` is left at the separator behind it.
  bool take_cell(const char*& at, const char* last, const Segment& segment, std::size_t column,
                 double& value) const {
    while (at != last && *at != separator_ && (*at == ' ' || *at == '\t')) ++at;
    if (at == last || *at == separator_) return false;
    const char* const start = at;
    const char* q = scan_number(at, last, {decimal_, false}, value);
    while (q != at && q != last && (*q == ' ' || *q == '\r') && *q != separator_) ++q;
    if (q != at && (q == last || *q == separator_)) {
      at = q;
      return true;
    }
    while (at != last && *at != separator_) ++at;
    const std::string_view cell =
        trimmed(std::string_view(start, static_cast<std::size_t>(at - start)));
    const auto unusual = cell_value(cell, decimal_);
    if (!unusual)
      throw InputError(file_.position(start),
                       fmt::format("{}: expected a number, found '{}'", culprit(segment, column),
                                   to_utf8(cell.substr(0, 40))));
    value = *unusual;
    return true;
  }

  std::string culprit(const Segment& segment, std::size_t column) const {
    const bool is_x = multi_ ? column % 2 == 0 : column == 0;
    if (is_x) return "X_Value";
    return segment.parts[multi_ ? column / 2 : column - 1].name;
  }

  /// Puts a value where its row says: rows in which it was missing are filled up.
  void take_value(Part& part, double value, double x, std::uint64_t place) {
    if (counting_) return count_value(part, value, x, place);
    const std::size_t n = part.values.size();
    if (n < place) {
      charge(place - n);
      part.missing += place - n;
      if (part.valid.empty()) part.valid.assign(n, 1);
      part.values.resize(place, nothing);
      part.valid.resize(place, 0);
      if (!part.x.empty()) part.x.resize(place, nothing);
    }
    const bool missing = std::isnan(value);
    if (missing && part.valid.empty()) part.valid.assign(part.values.size(), 1);
    part.values.push_back(value);
    if (!part.valid.empty()) part.valid.push_back(missing ? 0 : 1);
    if (missing) ++part.missing;
    if (multi_ && (!std::isnan(x) || !part.x.empty())) {
      part.x.resize(part.values.size() - 1, nothing);
      part.x.push_back(x);
    }
  }

  /// The first X stands for all where they are counted.
  void count_value(Part& part, double value, double x, std::uint64_t place) {
    if (place != part.counted || std::isnan(value)) plain_ = false;
    if (multi_ && !std::isnan(x)) {
      if (part.counted_x++ != part.counted) plain_ = false;
      if (part.x.empty()) part.x.push_back(x);
    } else if (part.counted_x > 0) {
      plain_ = false;
    }
    ++part.counted;
  }

  /// An empty cell takes its separator at least: what lacks more was never written by LabVIEW.
  void charge(std::uint64_t missing) {
    filled_ += missing;
    if (filled_ > file_.text().size())
      throw InputError(file_.position(at_), "more values are missing than the file has characters");
  }

  void take_comment(std::string_view cell, std::uint64_t row) {
    cell = trimmed(cell);
    while (!cell.empty() && cell.back() == separator_) cell.remove_suffix(1);
    if (cell.empty()) return;
    if (!comment_ && cell_value(cell, decimal_)) {
      warn("rows have more cells than there are names: the rest is left out");
      return;
    }
    std::string& text = record_.attributes["comments"];
    text += fmt::format("{}row {}{}: {}", text.empty() ? "" : "; ", row,
                        number_ > 1 ? fmt::format(" of segment {}", number_) : "", to_utf8(cell));
  }

  void share_x(Segment& segment, std::vector<double>&& x) {
    if (x.empty()) {
      if (x_rows_ > 0) plain_ = false;
      return;
    }
    for (Part& part : segment.parts) {
      if (counting_) {
        part.x = x;
        if (x_rows_ < part.counted) plain_ = false;
        part.check = segment.parts.front().check;
        part.check.agrees = part.check.agrees && part.delta == segment.parts.front().delta;
        continue;
      }
      part.x.assign(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(
                                               std::min(x.size(), part.values.size())));
      part.x.resize(part.values.size(), nothing);
      part.check = segment.parts.front().check;
      part.check.agrees = part.check.agrees && part.delta == segment.parts.front().delta;
    }
  }

  // ---- what the segments mean

  void check_counts(const Segment& segment) {
    std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> differ;  // names by counts
    for (const Part& part : segment.parts) {
      const std::uint64_t n = part.samples();
      if (!part.said || *part.said == n) continue;
      std::string& names = differ[{*part.said, n}];
      if (names.size() < 200)
        names += fmt::format("{}'{}'", names.empty() ? "" : ", ", part.name);
      else if (!names.ends_with("..."))
        names += ", ...";
    }
    for (const auto& [counts, names] : differ) {
      const auto [said, n] = counts;
      warn(fmt::format("{}: the header declares {} samples, there are {}{}", names, said, n,
                       n > said && one_heading_
                           ? ": packets without a header of their own follow, and whether time "
                             "passed between them is not told"
                           : ""));
    }
  }

  /// To the segment before, when all channels are the same and go on in time.
  void add(Segment&& segment) {
    const double later = !segments_.empty() && segment.moment && segments_.front().moment
                             ? *segment.moment - *segments_.front().moment
                             : 0.0;
    if (!segments_.empty() && alike(segments_.back(), segment)) {
      Segment& before = segments_.back();
      for (const double shift : {before.shift, later}) {
        bool goes_on = !before.parts.empty();
        for (std::size_t c = 0; c < before.parts.size() && goes_on; ++c)
          goes_on = continues(before.parts[c], segment.parts[c], shift - before.shift);
        if (!goes_on) continue;
        for (std::size_t c = 0; c < before.parts.size(); ++c)
          append(before.parts[c], std::move(segment.parts[c]), shift - before.shift);
        ++before.joined;
        return;
      }
    }
    segment.shift = later;
    segments_.push_back(std::move(segment));
  }

  void deliver(Segment& segment) {
    if (segments_.size() > 1)
      warn(
          fmt::format("the file has {} segments that do not continue each other in time: channels "
                      "of the later ones are named '... (segment n)'",
                      segments_.size()));
    for (Part& part : segment.parts) {
      Channel channel;
      channel.name = part.name;
      if (segment.first > 1) channel.name += fmt::format(" (segment {})", segment.first);
      const std::size_t index = record_.channels.size();
      channel.unit = index < options_.units.size() && !options_.units[index].empty()
                         ? options_.units[index]
                         : part.unit;
      channel.quantity = datasets::quantity_of_unit(channel.unit);
      if (!part.y_dimension.empty()) channel.attributes["Y_Dimension"] = part.y_dimension;
      if (segment.joined > 1) channel.attributes["segments"] = fmt::format("{}", segment.joined);
      if (part.said) channel.attributes["Samples"] = fmt::format("{}", *part.said);
      set_clock(part, segment.shift, channel);
      if (part.missing > 0)
        warn(fmt::format("'{}': {} of {} values {} missing; marked as not valid", channel.name,
                         part.missing, part.values.size(), part.missing == 1 ? "is" : "are"));
      channel.raw = std::move(part.values);
      channel.valid = std::move(part.valid);
      record_.channels.push_back(std::move(channel));
    }
  }

  void set_clock(Part& part, double shift, Channel& channel) {
    const std::string dimension = lowered(part.x_dimension);
    const bool time = dimension.empty() || dimension == "time";
    if (!time) {
      set_abscissa(channel, dimension, part.x_unit, first_x(part), step_of(part));
      return;
    }
    double factor = 1.0;
    if (!part.x_unit.empty()) {
      const auto conversion = datasets::conversion(part.x_unit, "s");
      if (conversion)
        factor = conversion->factor;
      else
        warn(fmt::format("the X unit '{}' is not one of time: times are taken as s", part.x_unit));
    }
    SampleClock& clock = channel.clock;
    const double delta = part.delta.value_or(0.0);
    if (!part.delta_text.empty()) channel.attributes["Delta_X"] = part.delta_text;
    const bool gaps =
        std::ranges::any_of(part.x, [](double value) { return !std::isfinite(value); });
    if (gaps)
      warn(fmt::format("'{}': X values are missing: {}", channel.name,
                       delta > 0.0 ? "Delta_X is used" : "the X column is not used"));
    if (part.x.empty() || gaps) {
      clock.start = part.x0.value_or(0.0) * factor + shift;
      clock.interval = delta * factor;
      tell_rate_meant(part);
      return;
    }
    if (delta > 0.0 && part.check.agrees) {
      clock.start = part.x.front() * factor + shift;
      clock.interval = delta * factor;
      return;
    }
    TimeAxis axis = time_axis(std::move(part.x));
    if (delta > 0.0)
      warn(fmt::format("{}Delta_X is {:.9g} but the X column steps by {:.9g}: the X column is used",
                       multi_ ? "'" + channel.name + "': " : std::string(), delta,
                       axis.clock.interval));
    if (!axis.warning.empty()) warn(fmt::format("'{}': {}", channel.name, axis.warning));
    clock = std::move(axis.clock);
    clock.start = clock.start * factor + shift;
    clock.interval *= factor;
    for (double& x : clock.times) x = x * factor + shift;
  }

  void tell_rate_meant(const Part& part) {
    const auto rate = rate_meant(part.delta_text, part.delta.value_or(0.0));
    if (rate)
      warn(
          fmt::format("Delta_X is printed as {}, which stands for 1/{} s too: --sample-rate {} "
                      "states that",
                      part.delta_text, *rate, *rate));
  }

  static constexpr std::size_t most_warnings = 100;

  TextFile file_;
  const ImportOptions options_;
  const char* at_;
  const char* end_;
  bool counting_ = false;
  bool plain_ = true;  ///< nothing was met that counting does not tell
  std::uint64_t x_rows_ = 0;
  const char* rows_first_ = nullptr;  ///< of the segment read last
  const char* rows_last_ = nullptr;
  char separator_ = '\t';
  char decimal_ = '\0';  ///< '\0': not known yet
  bool multi_ = false;
  bool one_heading_ = false;
  bool comment_ = false;  ///< this segment has a column of comments
  int number_ = 0;        ///< of the segment that is read, from 1
  std::uint64_t filled_ = 0;
  int special_blocks_ = 0;
  Record record_;
  std::vector<Segment> segments_;
};

/// A large file of one segment, whose values are read by blocks.
class LargeLvm final : public RecordingReader {
 public:
  explicit LargeLvm(std::unique_ptr<LvmReader> counted) : file_(std::move(counted)) {
    head_.record = file_->record();
    head_.samples = file_->counts();
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    Record record = head_.record;
    record.channels.clear();
    std::vector<Wanted> parts;
    std::uint64_t last = 0;
    for (const std::size_t index : chosen) {
      record.channels.push_back(head_.record.channels[index]);
      SampleClock& clock = record.channels.back().clock;
      parts.push_back({index, samples_within(clock, head_.samples[index], wanted), {}});
      clock.start += clock.interval * static_cast<double>(parts.back().range.first);
      last = std::max(last, parts.back().range.last);
    }
    std::vector<std::vector<std::size_t>> of_channel(head_.samples.size());
    for (std::size_t i = 0; i < parts.size(); ++i) of_channel[parts[i].channel].push_back(i);
    std::uint64_t row = 0;
    const char* released = file_->rows();
    const auto hand_over = [&] {
      for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i].values.empty())
          sink.take(i, {std::span<const double>(parts[i].values), {}, {}});
        parts[i].values.clear();
      }
    };
    file_->read_counted(
        [&](std::uint64_t next, const char* at) {
          row = next;
          if (row % rows_at_once == 0) {
            hand_over();
            file_->release(released, at);
            released = at;
          }
          return row < last;
        },
        [&](std::size_t channel, double value) {
          for (const std::size_t i : of_channel[channel])
            if (row >= parts[i].range.first && row < parts[i].range.last)
              parts[i].values.push_back(value);
        });
    hand_over();
    return record;
  }

 private:
  struct Wanted {
    std::size_t channel;
    SampleRange range;
    std::vector<double> values;
  };

  static constexpr std::uint64_t rows_at_once = 16384;

  std::unique_ptr<LvmReader> file_;
  RecordingHead head_;
};

/// A table of numbers, but for its ending: LabVIEW can leave the header away. Columns are counted
/// from 1, as LabVIEW's users do, and end where their values do.
Record read_headerless(const std::string& path, const ImportOptions& options) {
  Record record = read_into_memory(*open_csv(path, options));
  record.warnings.insert(record.warnings.begin(),
                         "the file has no header: it is read as a table of numbers");
  std::string& time_column = record.attributes["time column"];
  if (time_column.starts_with("column 0 (")) {
    time_column[7] = '1';
    for (std::string& warning : record.warnings)
      if (warning.starts_with("the time column 'column 0'")) warning[24] = '1';
  }
  for (Channel& channel : record.channels) {
    const std::string name = channel.name;
    if (const auto number = integer_in(name.starts_with("column ") ? name.substr(7) : ""))
      channel.name = fmt::format("column {}", *number + 1);
    const std::string about = fmt::format("'{}'", name);
    const auto old = std::ranges::find_if(
        record.warnings, [&about](const std::string& text) { return text.starts_with(about); });
    std::size_t n = channel.valid.size();
    while (n > 0 && channel.valid[n - 1] == 0) --n;
    if (old != record.warnings.end()) old->replace(0, about.size(), "'" + channel.name + "'");
    if (channel.valid.empty() || n == channel.valid.size()) continue;
    const std::size_t rows = channel.valid.size();
    std::get<std::vector<double>>(channel.raw).resize(n);
    channel.valid.resize(n);
    if (!channel.clock.times.empty()) channel.clock.times.resize(n);
    const auto missing = std::ranges::count(channel.valid, std::uint8_t{0});
    if (missing == 0) channel.valid.clear();
    const std::string text =
        fmt::format("'{}' ends after {} of {} rows{}", channel.name, n, rows,
                    missing > 0 ? fmt::format(", {} values within are missing", missing) : "");
    if (old != record.warnings.end())
      *old = text;
    else
      record.warnings.push_back(text);
  }
  return record;
}

}  // namespace

int recognises_lvm(std::string_view file_name, std::string_view head) {
  if (trimmed(head.substr(0, 64)).starts_with(first_word)) return 100;
  return lowered(file_name).ends_with(".lvm") && recognises_csv(file_name, head) > 0 ? 30 : 0;
}

std::unique_ptr<RecordingReader> open_lvm(const std::string& path, const ImportOptions& options) {
  {
    TextFile file(path);
    const std::string_view text = file.text();
    const std::size_t start = text.find_first_not_of(" \t\r\n");
    const bool headed =
        start != std::string_view::npos && text.substr(start).starts_with(first_word);
    const std::string_view head = text.substr(0, 65536);
    if (!headed && head.find(end_of_header) == std::string_view::npos)
      return reader_of(read_headerless(path, options));
    if (text.size() > read_at_once) return open_lvm_by_blocks(path, options);
  }
  return reader_of(LvmReader(path, options).read());
}

std::unique_ptr<RecordingReader> open_lvm_by_blocks(const std::string& path,
                                                    const ImportOptions& options) {
  auto counted = std::make_unique<LvmReader>(path, options);
  if (counted->count()) return std::make_unique<LargeLvm>(std::move(counted));
  return reader_of(LvmReader(path, options).read());
}

}  // namespace impactrig::acquisition
