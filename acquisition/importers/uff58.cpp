// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "acquisition/importers/uff58_data.hpp"
#include "acquisition/importers/uff58_header.hpp"
#include "acquisition/uff58_codes.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Quantity;
using datasets::Record;
using datasets::SourcePosition;

namespace {

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
      } catch (const UffHeaderCut& cut) {
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
    const std::string_view digits = trimmed(uff_columns(line, 1, 6));
    const auto number = integer_in(digits);
    if (!number)
      throw InputError(place(line.data()),
                       fmt::format("expected the number of a dataset in columns 1 to 6, "
                                   "found '{}'",
                                   to_utf8(trimmed(line).substr(0, 40))));
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
    const std::string name = uff_text(line_of_dataset());
    const std::string description = uff_text(line_of_dataset());
    const std::string program = uff_text(line_of_dataset());
    if (record_.title.empty()) record_.title = name;
    if (!description.empty()) record_.attributes["model description"] = description;
    if (!program.empty()) record_.attributes["written by"] = program;
  }

  void read_units() {
    const std::string_view line = line_of_dataset();
    record_.attributes["units code"] = uff_text(uff_columns(line, 1, 10));
    record_.attributes["units"] = uff_text(uff_columns(line, 11, 20));
    const std::string_view factors = line_of_dataset();
    constexpr std::array<std::string_view, 3> names = {"length factor", "force factor",
                                                       "temperature factor"};
    for (std::size_t i = 0; i < names.size(); ++i)
      if (const auto factor = number_in(uff_columns(factors, 1 + 25 * i, 25), {'.', true}))
        record_.attributes[std::string(names[i])] = fmt::format("{}", *factor);
    if (const auto offset = number_in(uff_columns(line_of_dataset(), 1, 25), {'.', true}))
      record_.attributes["temperature offset"] = fmt::format("{}", *offset);
  }

  void read_function(std::string_view identifier) {
    const UffHeader header = read_uff58_header(file_, identifier, at_, !binary_data_seen_);
    binary_seen_ = binary_seen_ || header.form.binary;
    const char* const start = at_;
    std::optional<Uff58Data> data;
    try {
      data = read_uff58_data(file_, at_, header.form, !binary_data_seen_);
    } catch (const InputError&) {
      // the last dataset was cut off before its data: what came before it is whole
      if (record_.channels.empty() || start != end_) throw;
      throw UffHeaderCut{start};
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
    const std::string_view identifier = trimmed(uff_columns(line, 1, 6));
    if (!integer_in(identifier)) return kind;
    kind = UffKind::text;
    if (identifier == "58" && (uff_columns(line, 7, 1) == "b" || uff_columns(line, 7, 1) == "B"))
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
