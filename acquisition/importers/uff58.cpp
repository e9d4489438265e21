// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/start_times.hpp"
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

/// Points handed over at once.
constexpr std::size_t points_at_once = 32768;

/// Files up to this size [bytes] have their numbers counted when they are opened.
constexpr std::size_t counted_at_once = std::size_t{1} << 25;

/// What a line without text may hold; a file of CP/M or DOS ends with 1A.
constexpr std::string_view blanks(" \t\r\n\0\x1A", 6);

/// A dataset 58 whose header is read and whose numbers are found.
struct Function {
  UffHeader header;
  Uff58Extent extent;
  bool lines_count = true;  ///< false: behind binary data
};

/// What a channel is made of.
struct Source {
  std::size_t function = 0;
  bool is_abscissa = false;  ///< an abscissa that no clock can hold is data of its own
  bool over_time = false;
  bool stated_times = false;  ///< the clock is not uniform
  double time_factor = 1.0;   ///< abscissa to [s]
};

class UffRecording final : public RecordingReader {
 public:
  UffRecording(const std::string& path, std::size_t counted_up_to) : file_(path) {
    std::string_view bytes = file_.bytes();
    trusting_ = bytes.size() > counted_up_to;
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    at_ = bytes.data();
    end_ = bytes.data() + bytes.size();
    scan();
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    Record record = head_.record;
    const std::vector<Channel> channels = std::move(record.channels);
    record.channels.clear();
    for (const std::size_t index : selected_channels(head_, wanted)) {
      record.channels.push_back(channels[index]);
      read_channel(index, wanted, record, sink);
    }
    return record;
  }

 private:
  void scan() {
    Record& record = head_.record;
    while (find_dataset()) {
      const char* const start = at_;
      try {
        read_dataset();
      } catch (const UffHeaderCut& cut) {
        if (record.channels.empty())
          throw InputError(place(cut.at), "the file ends within the header of a dataset 58");
        warn(fmt::format("the file ends within the header of the dataset at {}: it is left out",
                         place(start).text()));
        break;
      }
    }
    tell_outside();
    starts_.tell(record);
    if (record.channels.empty()) {
      std::string list;
      for (const auto& [number, count] : seen_)
        list += fmt::format("{}{}{}", list.empty() ? "" : ", ", number,
                            count > 1 ? fmt::format(" ({} times)", count) : "");
      warn(fmt::format("no recordings in this file: it has no dataset 58, only {}",
                       list.empty() ? "nothing" : list));
    }
    record.provenance.importer = binary_seen_ ? "uff58b" : "uff58";
  }

  SourcePosition place(const char* at) const {
    return binary_data_seen_ ? file_.byte_position(at) : file_.position(at);
  }

  void warn(const std::string& sentence) {
    auto& warnings = head_.record.warnings;
    if (std::find(warnings.begin(), warnings.end(), sentence) == warnings.end())
      warnings.push_back(sentence);
  }

  /// Moves to the next identifier line: behind a delimiter, or behind one that closed the dataset
  /// before and is to open this one too. False at the end of the file.
  bool find_dataset() {
    while (at_ != end_) {
      const char* const start = at_;
      const std::string_view line = take_line(at_, end_);
      if (is_uff_delimiter(line)) return skip_delimiters();
      if (line.find_first_not_of(blanks) == std::string_view::npos) continue;
      if (closed_ && identifies(line)) {
        if (unopened_++ == 0) first_unopened_ = start;
        at_ = start;
        return true;
      }
      closed_ = false;
      if (outside_++ == 0) first_outside_ = line;
    }
    return false;
  }

  /// A doubled -1 opens one dataset, not an empty one.
  bool skip_delimiters() {
    while (at_ != end_) {
      const char* next = at_;
      if (!is_uff_delimiter(take_line(next, end_))) return true;
      at_ = next;
    }
    return false;
  }

  /// A line that is the number of a dataset and nothing else, or the identifier of a 58b.
  static bool identifies(std::string_view line) {
    const auto number = integer_in(trimmed(uff_columns(line, 1, 6)));
    const std::string_view letter = uff_columns(line, 7, 1);
    if (!number || *number <= 0) return false;
    return (*number == 58 && (letter == "b" || letter == "B")) ||
           trimmed(uff_columns(line, 7, line.size())).empty();
  }

  void tell_outside() {
    if (unopened_ == 1)
      warn(
          fmt::format("the dataset at {} begins without a -1 of its own, behind the one that "
                      "closes the dataset before: it is read",
                      place(first_unopened_).text()));
    if (unopened_ > 1)
      warn(
          fmt::format("{} datasets, the first at {}, begin without a -1 of their own, behind the "
                      "one that closes the dataset before: they are read",
                      unopened_, place(first_unopened_).text()));
    if (outside_ > 0)
      warn(fmt::format("{} outside of datasets {} not read, from {} on: '{}'",
                       outside_ == 1 ? "a line" : fmt::format("{} lines", outside_),
                       outside_ == 1 ? "is" : "are", place(first_outside_.data()).text(),
                       to_utf8(trimmed(first_outside_).substr(0, 40))));
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
    closed_ = false;
    while (at_ != end_ && !closed_) closed_ = is_uff_delimiter(take_line(at_, end_));
    if (closed_) return;
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
    if (head_.record.title.empty()) head_.record.title = name;
    if (!description.empty()) head_.record.attributes["model description"] = description;
    if (!program.empty()) head_.record.attributes["written by"] = program;
  }

  void read_units() {
    const std::string_view line = line_of_dataset();
    head_.record.attributes["units code"] = uff_text(uff_columns(line, 1, 10));
    head_.record.attributes["units"] = uff_text(uff_columns(line, 11, 20));
    const std::string_view factors = line_of_dataset();
    constexpr std::array<std::string_view, 3> names = {"length factor", "force factor",
                                                       "temperature factor"};
    for (std::size_t i = 0; i < names.size(); ++i)
      if (const auto factor = number_in(uff_columns(factors, 1 + 25 * i, 25), {'.', true}))
        head_.record.attributes[std::string(names[i])] = fmt::format("{}", *factor);
    if (const auto offset = number_in(uff_columns(line_of_dataset(), 1, 25), {'.', true}))
      head_.record.attributes["temperature offset"] = fmt::format("{}", *offset);
  }

  void read_function(std::string_view identifier) {
    Function function;
    function.header = read_uff58_header(file_, identifier, at_, !binary_data_seen_);
    binary_seen_ = binary_seen_ || function.header.form.binary;
    function.lines_count = !binary_data_seen_;
    try {
      function.extent =
          find_uff58_data(file_, at_, function.header.form, function.lines_count, trusting_);
    } catch (const InputError&) {
      // the last dataset was cut off before its data: what came before it is whole
      if (head_.record.channels.empty() || at_ != end_) throw;
      throw UffHeaderCut{at_};
    }
    at_ = function.extent.closing;
    if (function.header.form.binary) binary_data_seen_ = true;
    add_channel(std::move(function));
  }

  std::string channel_name(const UffHeader& header) const {
    if (!header.id[0].empty() && header.id[0] != "NONE") return header.id[0];
    if (!header.response_entity.empty()) return header.response_entity;
    if (!header.ordinate.label.empty()) return header.ordinate.label;
    return fmt::format("function {}", head_.record.channels.size() + 1);
  }

  void set_unit(const UffHeader& header, Channel& channel) {
    channel.unit = header.ordinate.unit;
    Quantity stated = uff58_quantity(header.ordinate.type);
    constexpr int frequency_response = 4, transmissibility = 5;
    const bool is_ratio =
        header.function_type == frequency_response || header.function_type == transmissibility;
    const std::string& below = header.denominator.unit;
    if (is_ratio) stated = Quantity::unknown;
    if (is_ratio && !channel.unit.empty() && !below.empty() && below != "NONE")
      channel.unit = fmt::format("({})/({})", channel.unit, below);
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

  /// "ms" of the label "Time [ms]" where the field for the unit is empty.
  std::string abscissa_unit(const UffHeader& header) {
    const UffAxis& axis = header.abscissa;
    std::string unit = split_head(axis.label).unit;
    if (!axis.unit.empty() || unit == "s" ||
        datasets::quantity_of_unit(unit) != datasets::Quantity::time)
      return axis.unit;
    warn(fmt::format("no unit of the abscissa is stated, but its label is '{}': it is taken in {}",
                     axis.label, unit));
    return unit;
  }

  /// The factor of an abscissa's unit to seconds.
  double time_factor(const std::string& unit) {
    if (unit.empty() || unit == "s") return 1.0;
    const auto conversion = datasets::conversion(unit, "s");
    if (conversion) return conversion->factor;
    warn(fmt::format("the abscissa's unit '{}' is not one of time: it is taken as s", unit));
    return 1.0;
  }

  /// The first and the last stated abscissa.
  std::pair<double, double> abscissa_ends(const Function& function) {
    if (function.extent.points == 0) return {0.0, 0.0};
    Uff58Reader reader(file_, function.header.form, function.extent, function.lines_count);
    const double first = reader.read(1).abscissa.front();
    double last = first;
    for (const char* released = reader.at();;) {
      const Uff58Block block = reader.read(points_at_once);
      if (block.size() == 0) break;
      last = block.abscissa.back();
      file_.release(released, reader.at());
      released = reader.at();
    }
    return {first, last};
  }

  void set_clock(const Function& function, Source& source, Channel& channel) {
    const UffHeader& header = function.header;
    source.over_time =
        uff58_is_time(header.abscissa.type, header.function_type, header.abscissa.unit);
    if (!source.over_time) {
      double first = header.start;
      double increment = header.increment;
      if (!header.form.even) {
        const auto ends = abscissa_ends(function);
        first = function.extent.points > 0 ? ends.first : header.start;
        if (function.extent.points > 1)
          increment = (ends.second - ends.first) / static_cast<double>(function.extent.points - 1);
      }
      const std::string_view domain = header.abscissa.type == 18 ? "frequency" : "other";
      set_abscissa(channel, domain, header.abscissa.unit, first, increment);
      warn(
          fmt::format("'{}' is no time record: {} over {}", channel.name,
                      uff58_function_name(header.function_type),
                      header.abscissa.label.empty() ? std::string(domain) : header.abscissa.label));
      return;
    }
    channel.attributes["domain"] = "time";
    source.time_factor = time_factor(abscissa_unit(header));
    if (!header.form.even) {
      const TimeAxisCheck check = time_axis_of(function, source.time_factor);
      const TimeAxis axis = check.axis();
      source.stated_times = !check.uniform();
      if (!axis.warning.empty()) warn(axis.warning);
      channel.clock = axis.clock;
      return;
    }
    channel.clock.start = source.time_factor * header.start;
    channel.clock.interval = header.increment > 0.0 ? source.time_factor * header.increment : 0.0;
    tell_unusable_interval(channel, header.increment, header.abscissa.unit);
    if (!uff58_read_exact_clock(header.id[4], channel.clock)) offer_nice_rate(header, channel);
  }

  /// Hands the abscissas of a function, times `factor`, to `use` piece by piece.
  template <typename Use>
  void for_each_abscissa(const Function& function, double factor, const Use& use) {
    Uff58Reader reader(file_, function.header.form, function.extent, function.lines_count);
    for (const char* start = reader.at();; start = reader.at()) {
      Uff58Block block = reader.read(points_at_once);
      if (block.size() == 0) return;
      for (double& abscissa : block.abscissa) abscissa *= factor;
      use(std::span<const double>(block.abscissa));
      file_.release(start, reader.at());
    }
  }

  /// Judges the stated times of a function.
  TimeAxisCheck time_axis_of(const Function& function, double factor) {
    const auto [first, last] = abscissa_ends(function);
    TimeAxisCheck check(factor * first, factor * last, function.extent.points);
    for_each_abscissa(function, factor,
                      [&check](std::span<const double> times) { check.add(times); });
    return check;
  }

  void add_channel(Function&& function) {
    const UffHeader& header = function.header;
    Channel channel;
    channel.name = channel_name(header);
    add_attributes(header, channel);
    set_unit(header, channel);
    if (header.form.points == 0) warn(fmt::format("'{}' has no samples", channel.name));
    for (const std::string& warning : function.extent.warnings)
      warn(fmt::format("'{}': {}", channel.name, warning));
    Source source;
    source.function = functions_.size();
    const bool uneven_spectrum =
        !header.form.even &&
        !uff58_is_time(header.abscissa.type, header.function_type, header.abscissa.unit);
    if (uneven_spectrum) {
      Channel axis;
      axis.name = channel.name + " (abscissa)";
      axis.unit = header.abscissa.unit;
      axis.quantity = datasets::quantity_of_unit(axis.unit);
      set_abscissa(axis, header.abscissa.type == 18 ? "frequency" : "other", axis.unit, 0.0, 0.0);
      add(std::move(axis), {source.function, true}, function.extent);
    }
    set_clock(function, source, channel);
    const std::string started = header.id[2] != "NONE" ? iso_date(header.id[2]) : "";
    if (head_.record.started.empty()) head_.record.started = started;
    if (source.over_time) starts_.add(started);
    add(std::move(channel), source, function.extent);
    functions_.push_back(std::move(function));
  }

  void add(Channel&& channel, const Source& source, const Uff58Extent& extent) {
    head_.record.channels.push_back(std::move(channel));
    head_.samples.push_back(extent.points);
    head_.counted = head_.counted && extent.counted;
    sources_.push_back(source);
  }

  /// Hands over the channel's samples; `record.channels.back()` is its head.
  void read_channel(std::size_t index, const Selection& wanted, Record& record, SampleSink& sink) {
    const Source& source = sources_[index];
    const Function& function = functions_[source.function];
    const std::size_t number = record.channels.size() - 1;
    Channel& channel = record.channels.back();
    const bool stated = source.stated_times;
    const SampleRange range = range_of(function, source, wanted, channel.clock);
    Uff58Reader reader(file_, function.header.form, function.extent, function.lines_count);
    std::uint64_t before = reader.skip(range.first);
    while (before < range.last) {
      const char* const start = reader.at();
      Uff58Block block = reader.read(points_at_once);
      const std::size_t n = block.size();
      if (n == 0) break;
      for (double& time : block.abscissa) time *= source.time_factor;
      const std::size_t from =
          static_cast<std::size_t>(std::clamp(range.first, before, before + n) - before);
      const std::size_t to =
          static_cast<std::size_t>(std::clamp(range.last, before, before + n) - before);
      if (from < to) hand_over(block, source, from, to - from, number, stated, sink);
      before += n;
      file_.release(start, reader.at());
    }
    if (before < range.last)
      record.warnings.push_back(
          fmt::format("'{}': the header announces {} points, {} are there: these are read",
                      channel.name, function.header.form.points, before));
    if (function.extent.counted) return;
    for (const std::string& warning : reader.warnings())
      record.warnings.push_back(fmt::format("'{}': {}", channel.name, warning));
  }

  /// The samples of a window, whose clock `clock` becomes.
  SampleRange range_of(const Function& function, const Source& source, const Selection& wanted,
                       datasets::SampleClock& clock) {
    const std::uint64_t points = function.extent.points;
    if (!source.over_time || !wanted.has_window()) return {0, points};
    if (!source.stated_times) {
      const SampleRange range = samples_within(clock, points, wanted);
      clock.start += clock.interval * static_cast<double>(range.first);
      return range;
    }
    TimeWindow found(wanted);
    for_each_abscissa(function, source.time_factor,
                      [&found](std::span<const double> times) { found.add(times); });
    found.settle(clock);
    return found.range();
  }

  static void hand_over(const Uff58Block& block, const Source& source, std::size_t first,
                        std::size_t count, std::size_t number, bool stated, SampleSink& sink) {
    const auto part = [first, count](const std::vector<double>& values) {
      return std::span<const double>(values).subspan(first, count);
    };
    SampleBlock samples;
    if (source.is_abscissa) {
      samples.raw = part(block.abscissa);
    } else {
      std::visit(
          [&](const auto& ordinate) { samples.raw = std::span(ordinate).subspan(first, count); },
          block.ordinate);
      if (!block.imaginary.empty()) samples.imaginary = part(block.imaginary);
    }
    sink.take(number, samples);
    if (stated) sink.take_times(number, part(block.abscissa));
  }

  TextFile file_;
  const char* at_ = nullptr;
  const char* end_ = nullptr;
  bool trusting_ = false;  // that what a text's header announces is there
  StartTimes starts_;
  RecordingHead head_;
  std::vector<Function> functions_;
  std::vector<Source> sources_;  // one a channel
  std::map<long, int> seen_;     // datasets by number
  std::map<std::string, Quantity>
      quantities_;  // of units: a file repeats a few of them thousands of times
  bool binary_seen_ = false;
  bool binary_data_seen_ = false;  // from there on, lines cannot be counted
  bool cut_ = false;
  bool closed_ = false;         // nothing but blanks since a dataset was closed
  std::uint64_t unopened_ = 0;  // datasets behind the -1 that closes another
  const char* first_unopened_ = nullptr;
  std::uint64_t outside_ = 0;  // lines outside of datasets
  std::string_view first_outside_;
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

std::unique_ptr<RecordingReader> open_uff58(const std::string& path, const ImportOptions&) {
  return std::make_unique<UffRecording>(path, counted_at_once);
}

std::unique_ptr<RecordingReader> open_uff58_by_blocks(const std::string& path,
                                                      const ImportOptions&) {
  return std::make_unique<UffRecording>(path, 0);
}

}  // namespace impactrig::acquisition
