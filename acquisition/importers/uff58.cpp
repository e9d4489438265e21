// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "acquisition/importers/uff58_data.hpp"
#include "acquisition/uff58_codes.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Quantity;
using datasets::Record;
using datasets::SourcePosition;

namespace {

/// Columns of a line, by number as the standard counts them (from 1), cut where the line is short.
std::string_view columns(std::string_view line, std::size_t first, std::size_t width) {
  return first > line.size() ? std::string_view{} : line.substr(first - 1, width);
}

/// Text of a field; "NONE" stands for nothing.
std::string text_of(std::string_view field) {
  const std::string text = to_utf8(trimmed(field));
  return text == "NONE" ? std::string() : text;
}

/// An axis as records 8 to 11 describe it.
struct UffAxis {
  int type = 0;  ///< specific data type
  std::string label;
  std::string unit;
};

/// The header of one dataset 58.
struct UffHeader {
  std::array<std::string, 5> id;
  int function_type = 0;
  std::string response_entity, reference_entity;
  long response_node = 0, response_direction = 0, reference_node = 0, reference_direction = 0;
  Uff58Form form;
  std::string_view increment_text;
  double start = 0.0;
  double increment = 0.0;
  UffAxis abscissa, ordinate, denominator;
};

/// The file ended where the header needed more.
struct EndOfFile {
  const char* at;
};

class UffReader {
 public:
  explicit UffReader(const std::string& path) : file_(path) {
    std::string_view bytes = file_.bytes();
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    at_ = bytes.data();
    end_ = bytes.data() + bytes.size();
  }

  Record read() {
    while (find_dataset()) {
      const char* const start = at_;
      try {
        read_dataset();
      } catch (const EndOfFile& cut) {
        if (record_.channels.empty())
          throw InputError(place(cut.at), "the file ends within the header of a dataset 58");
        warn(fmt::format("the file ends within the header of the dataset at {}: it is left out",
                         place(start).text()));
        break;
      }
    }
    if (record_.channels.empty()) {
      std::string list;
      for (const auto& [number, count] : seen_)
        list += fmt::format("{}{}{}", list.empty() ? "" : ", ", number,
                            count > 1 ? fmt::format(" ({} times)", count) : "");
      warn(fmt::format("no recordings in this file: it has no dataset 58, only {}",
                       list.empty() ? "nothing" : list));
    }
    record_.provenance.importer = binary_seen_ ? "uff58b" : "uff58";
    return std::move(record_);
  }

 private:
  SourcePosition place(const char* at) const {
    return binary_data_seen_ ? file_.byte_position(at) : file_.position(at);
  }

  void warn(const std::string& sentence) {
    auto& warnings = record_.warnings;
    if (std::find(warnings.begin(), warnings.end(), sentence) == warnings.end())
      warnings.push_back(sentence);
  }

  /// Moves to the identifier line behind the next delimiter; false at the end of the file.
  bool find_dataset() {
    while (at_ != end_) {
      if (!is_uff_delimiter(take_line(at_, end_))) continue;
      // a doubled -1 opens one dataset, not an empty one
      for (;;) {
        if (at_ == end_) return false;
        const char* next = at_;
        if (!is_uff_delimiter(take_line(next, end_))) return true;
        at_ = next;
      }
    }
    return false;
  }

  void read_dataset() {
    const std::string_view line = take_line(at_, end_);
    std::string_view digits = trimmed(columns(line, 1, 6));
    const auto number = integer_in(digits);
    if (!number)
      throw InputError(place(line.data()),
                       fmt::format("expected the number of a dataset in columns 1 to 6, "
                                   "found '{}'",
                                   to_utf8(trimmed(line)).substr(0, 40)));
    ++seen_[*number];
    if (*number == 58) {
      read_function(line);
    } else if (*number == 151) {
      read_title();
    } else if (*number == 164) {
      read_units();
    }
    leave_dataset();
  }

  /// Moves behind the delimiter that closes the dataset.
  void leave_dataset() {
    while (at_ != end_)
      if (is_uff_delimiter(take_line(at_, end_))) return;
    if (!cut_) warn("the last dataset is not closed by -1: the file may have been cut off");
    cut_ = true;
  }

  /// A line of the dataset at hand; does not run over its end.
  std::string_view line_of_dataset() {
    const char* next = at_;
    const std::string_view line = take_line(next, end_);
    if (is_uff_delimiter(line)) return {};
    at_ = next;
    return line;
  }

  void read_title() {
    const std::string name = text_of(line_of_dataset());
    const std::string description = text_of(line_of_dataset());
    const std::string program = text_of(line_of_dataset());
    if (record_.title.empty()) record_.title = name;
    if (!description.empty()) record_.attributes["model description"] = description;
    if (!program.empty()) record_.attributes["written by"] = program;
  }

  void read_units() {
    const std::string_view line = line_of_dataset();
    record_.attributes["units code"] = text_of(columns(line, 1, 10));
    record_.attributes["units"] = text_of(columns(line, 11, 20));
    const std::string_view factors = line_of_dataset();
    constexpr std::array<std::string_view, 3> names = {"length factor", "force factor",
                                                       "temperature factor"};
    for (std::size_t i = 0; i < names.size(); ++i)
      if (const auto factor = number_in(columns(factors, 1 + 25 * i, 25), {'.', true}))
        record_.attributes[std::string(names[i])] = fmt::format("{}", *factor);
    if (const auto offset = number_in(columns(line_of_dataset(), 1, 25), {'.', true}))
      record_.attributes["temperature offset"] = fmt::format("{}", *offset);
  }

  std::string_view header_line() {
    if (at_ == end_) throw EndOfFile{at_};
    return take_line(at_, end_);
  }

  long integer_at(std::string_view line, std::size_t first, std::size_t width,
                  std::string_view what) {
    const std::string_view field = columns(line, first, width);
    if (trimmed(field).empty()) return 0;
    const auto value = integer_in(field);
    if (value) return *value;
    throw InputError(place(field.data()),
                     fmt::format("{}: expected an integer in columns {} to {}, found '{}'", what,
                                 first, first + width - 1, to_utf8(trimmed(field))));
  }

  void read_identifier(std::string_view line, UffHeader& header) {
    const std::string_view letter = columns(line, 7, 1);
    if (letter != "b" && letter != "B") return;
    header.form.binary = true;
    binary_seen_ = true;
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
    header.form.little_endian = order == 1;
    header.form.announced_bytes = bytes > 0 ? static_cast<std::uint64_t>(bytes) : 0;
    extra_header_lines_ =
        std::clamp(integer_at(line, 20, 12, "number of header lines") - 11, 0L, 20L);
  }

  void read_record_6(std::string_view line, UffHeader& header) {
    header.function_type = static_cast<int>(integer_at(line, 1, 5, "function type"));
    header.response_entity = text_of(columns(line, 32, 10));
    header.response_node = integer_in(columns(line, 42, 10)).value_or(0);
    header.response_direction = integer_in(columns(line, 52, 4)).value_or(0);
    header.reference_entity = text_of(columns(line, 57, 10));
    header.reference_node = integer_in(columns(line, 67, 10)).value_or(0);
    header.reference_direction = integer_in(columns(line, 77, 4)).value_or(0);
  }

  /// Ordinate type, number of points, spacing, start, increment: by columns, else by the blanks
  /// between them.
  void read_record_7(std::string_view line, UffHeader& header) {
    std::array<std::string_view, 5> fields = {columns(line, 1, 10), columns(line, 11, 10),
                                              columns(line, 21, 10), columns(line, 31, 13),
                                              columns(line, 44, 13)};
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
    header.form.ordinate_type = static_cast<int>(*integer_in(fields[0]));
    const long points = *integer_in(fields[1]);
    header.form.even = *integer_in(fields[2]) != 0;
    header.start = *number_in(fields[3], {'.', true});
    header.increment = *number_in(fields[4], {'.', true});
    header.increment_text = trimmed(fields[4]);
    const int type = header.form.ordinate_type;
    if (type != 2 && type != 4 && type != 5 && type != 6)
      throw InputError(place(line.data()),
                       fmt::format("ordinate type {} is unknown: expected 2, 4, 5 or 6", type));
    if (points < 0)
      throw InputError(place(line.data()),
                       fmt::format("the number of points is {}: expected 0 or more", points));
    header.form.points = static_cast<std::uint64_t>(points);
  }

  UffAxis read_axis(std::string_view line) {
    UffAxis axis;
    axis.type = static_cast<int>(integer_at(line, 1, 10, "specific data type"));
    axis.label = text_of(columns(line, 27, 20));
    axis.unit = text_of(columns(line, 48, 20));
    return axis;
  }

  void read_function(std::string_view identifier) {
    UffHeader header;
    extra_header_lines_ = 0;
    read_identifier(identifier, header);
    for (std::string& id : header.id) id = to_utf8(trimmed(header_line()));
    read_record_6(header_line(), header);
    read_record_7(header_line(), header);
    header.abscissa = read_axis(header_line());
    header.ordinate = read_axis(header_line());
    header.denominator = read_axis(header_line());
    if (at_ == end_ && header.form.points > 0) throw EndOfFile{at_};
    take_line(at_, end_);  // record 11, the z axis
    for (long i = 0; i < extra_header_lines_ && at_ != end_; ++i) take_line(at_, end_);

    const char* const start = at_;
    std::optional<Uff58Data> data;
    try {
      data = read_uff58_data(file_, at_, header.form, !binary_data_seen_);
    } catch (const InputError&) {
      // the last dataset was cut off before its data: what came before it is whole
      if (record_.channels.empty() || start != end_) throw;
      throw EndOfFile{start};
    }
    if (header.form.binary) binary_data_seen_ = true;
    add_channel(header, std::move(*data));
  }

  std::string channel_name(const UffHeader& header) const {
    if (!header.id[0].empty() && header.id[0] != "NONE") return header.id[0];
    if (!header.response_entity.empty()) return header.response_entity;
    if (!header.ordinate.label.empty()) return header.ordinate.label;
    return fmt::format("function {}", record_.channels.size() + 1);
  }

  void set_unit(const UffHeader& header, Channel& channel) {
    channel.unit = header.ordinate.unit;
    const Quantity stated = uff58_quantity(header.ordinate.type);
    const auto [known, added] = quantities_.try_emplace(channel.unit, Quantity::unknown);
    if (added) known->second = datasets::quantity_of_unit(channel.unit);
    channel.quantity = known->second;
    if (channel.unit.empty()) {
      channel.quantity = stated;
      if (stated != Quantity::unknown) warn(fmt::format("'{}' states no unit", channel.name));
    } else if (channel.quantity == Quantity::unknown || channel.quantity == Quantity::other) {
      if (stated != Quantity::unknown) channel.quantity = stated;
    } else if (stated != Quantity::unknown && stated != channel.quantity) {
      channel.attributes["stated quantity"] = datasets::name(stated);
    }
  }

  void add_attributes(const UffHeader& header, Channel& channel) {
    auto& says = channel.attributes;
    const auto put = [&says](const std::string& key, const std::string& value) {
      if (!value.empty() && value != "NONE") says[key] = value;
    };
    for (std::size_t i = 0; i < header.id.size(); ++i)
      put(fmt::format("id line {}", i + 1), header.id[i]);
    put("function", std::string(uff58_function_name(header.function_type)));
    put("response entity", header.response_entity);
    put("reference entity", header.reference_entity);
    if (header.response_node != 0 || header.response_direction != 0) {
      says["response node"] = fmt::format("{}", header.response_node);
      says["response direction"] = fmt::format("{}", header.response_direction);
    }
    if (header.reference_node != 0 || header.reference_direction != 0) {
      says["reference node"] = fmt::format("{}", header.reference_node);
      says["reference direction"] = fmt::format("{}", header.reference_direction);
    }
    put("ordinate label", header.ordinate.label);
    put("abscissa label", header.abscissa.label);
    put("denominator unit", header.denominator.unit);
  }

  /// Says what the six digits of an increment may stand for.
  void offer_nice_rate(const UffHeader& header, Channel& channel) {
    const auto rate = nice_rate(channel.clock.interval);
    if (!rate) return;
    channel.attributes["nearest round rate"] = fmt::format("{} Hz", *rate);
    warn(
        fmt::format("the stated interval of {} s has six digits and gives {:.3f} Hz; --sample-rate "
                    "{} sets the round "
                    "rate it probably stands for",
                    to_utf8(header.increment_text), 1.0 / channel.clock.interval, *rate));
  }

  void set_clock(const UffHeader& header, std::vector<double>&& abscissa, Channel& channel) {
    const bool over_time =
        uff58_is_time(header.abscissa.type, header.function_type, header.abscissa.unit);
    if (!over_time) {
      const double first = abscissa.empty() ? header.start : abscissa.front();
      double increment = header.increment;
      if (abscissa.size() > 1)
        increment = (abscissa.back() - abscissa.front()) / static_cast<double>(abscissa.size() - 1);
      const std::string_view domain = header.abscissa.type == 18 ? "frequency" : "other";
      set_abscissa(channel, domain, header.abscissa.unit, first, increment);
      warn(
          fmt::format("'{}' is no time record: {} over {}", channel.name,
                      uff58_function_name(header.function_type),
                      header.abscissa.label.empty() ? std::string(domain) : header.abscissa.label));
      return;
    }
    channel.attributes["domain"] = "time";
    double factor = 1.0;
    const std::string& unit = header.abscissa.unit;
    if (!unit.empty() && unit != "s") {
      const auto conversion = datasets::conversion(unit, "s");
      if (conversion) {
        factor = conversion->factor;
      } else {
        warn(fmt::format("the abscissa's unit '{}' is not one of time: it is taken as s", unit));
      }
    }
    if (header.form.even) {
      channel.clock.start = factor * header.start;
      channel.clock.interval = header.increment > 0.0 ? factor * header.increment : 0.0;
      if (!uff58_read_exact_clock(header.id[4], channel.clock)) offer_nice_rate(header, channel);
      return;
    }
    if (factor != 1.0)
      for (double& time : abscissa) time *= factor;
    TimeAxis axis = time_axis(std::move(abscissa));
    if (!axis.warning.empty()) warn(axis.warning);
    channel.clock = std::move(axis.clock);
  }

  void add_channel(const UffHeader& header, Uff58Data&& data) {
    Channel channel;
    channel.name = channel_name(header);
    add_attributes(header, channel);
    set_unit(header, channel);
    if (header.form.points == 0) warn(fmt::format("'{}' has no samples", channel.name));
    for (const std::string& warning : data.warnings)
      warn(fmt::format("'{}': {}", channel.name, warning));
    const bool uneven_spectrum =
        !header.form.even &&
        !uff58_is_time(header.abscissa.type, header.function_type, header.abscissa.unit);
    if (uneven_spectrum) {  // an abscissa that no clock can hold is data of its own
      Channel axis;
      axis.name = channel.name + " (abscissa)";
      axis.unit = header.abscissa.unit;
      axis.quantity = datasets::quantity_of_unit(axis.unit);
      axis.raw = data.abscissa;
      set_abscissa(axis, header.abscissa.type == 18 ? "frequency" : "other", axis.unit, 0.0, 0.0);
      record_.channels.push_back(std::move(axis));
    }
    set_clock(header, std::move(data.abscissa), channel);
    channel.raw = std::move(data.ordinate);
    channel.imaginary = std::move(data.imaginary);
    if (record_.started.empty() && header.id[2] != "NONE") record_.started = iso_date(header.id[2]);
    record_.channels.push_back(std::move(channel));
  }

  TextFile file_;
  const char* at_ = nullptr;
  const char* end_ = nullptr;
  Record record_;
  std::map<long, int> seen_;  // datasets by number
  std::map<std::string, Quantity>
      quantities_;  // of units: a file repeats a few of them thousands of times
  bool binary_seen_ = false;
  bool binary_data_seen_ = false;  // from there on, lines cannot be counted
  bool cut_ = false;
  long extra_header_lines_ = 0;
};

/// The identifier lines among the first bytes of a file, as far as they can be found by lines.
enum class UffKind { none, text, binary };

UffKind uff_kind(std::string_view head) {
  const char* at = head.data();
  const char* const end = at + head.size();
  bool opened = false;
  UffKind kind = UffKind::none;
  for (int number = 0; at != end; ++number) {
    const std::string_view line = take_line(at, end);
    if (!opened) {
      if (trimmed(line).empty()) continue;
      if (!is_uff_delimiter(line)) {
        if (kind == UffKind::none) return UffKind::none;
        continue;
      }
      opened = true;
      continue;
    }
    if (is_uff_delimiter(line)) continue;
    const std::string_view identifier = trimmed(columns(line, 1, 6));
    if (!integer_in(identifier)) return kind;
    kind = UffKind::text;
    if (identifier == "58" && (columns(line, 7, 1) == "b" || columns(line, 7, 1) == "B"))
      return UffKind::binary;
    if (identifier == "58") return kind;
    while (at != end && !is_uff_delimiter(take_line(at, end))) {
    }
    opened = false;
  }
  return kind;
}

}  // namespace

int recognises_uff58b(std::string_view, std::string_view head) {
  return uff_kind(head) == UffKind::binary ? 100 : 0;
}

int recognises_uff58(std::string_view, std::string_view head) {
  return uff_kind(head) == UffKind::none ? 0 : 95;
}

Record read_uff58(const std::string& path, const ImportOptions&) {
  return UffReader(path).read();
}

}  // namespace impactrig::acquisition
