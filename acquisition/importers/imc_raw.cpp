// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/imc_fields.hpp"
#include "acquisition/importers/imc_samples.hpp"
#include "acquisition/importers/start_times.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

/// imc FAMOS raw files: keys "|XX,version,length,contents;" with the samples within a key of their
/// own, "|CS".
///
/// Source of the layout: imc, "FAMOS file format" (version 2), as RecordEvolution/IMCtermite and
/// Apollo3zehn/ImcFamosFile write it out.
namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

constexpr int year_0 = 1980;  ///< imc's times count from its start

constexpr std::array<std::string_view, 7> field_types = {
    "",
    "samples at equal distances",
    "samples over their own increasing x",
    "samples over their own x",
    "complex numbers (real and imaginary part)",
    "complex numbers (magnitude and phase)",
    "complex numbers (magnitude in dB and phase)"};

std::string kind_name(int format) {
  if (format == 9) return "imc's transitional recording";
  if (format == 10) return "time stamps as text";
  if (format == imc_digital_words) return "digital words";
  if (format == imc_six_bytes) return "integers of 6 bytes";
  return fmt::format("numbers of format {}", format);
}

bool may_have_mask(std::optional<NumberKind> kind) {
  using enum NumberKind;
  return kind == u8 || kind == i8 || kind == u16 || kind == i16 || kind == u32 || kind == i32;
}

/// 0 or 1: a bit of words, from 1.
std::function<void(std::span<double>)> bit_of_words(int bit) {
  return [bit](std::span<double> values) {
    for (double& value : values)
      value = static_cast<double>((static_cast<std::int64_t>(value) >> (bit - 1)) & 1);
  };
}

/// `seconds` after the trigger, in ISO 8601; "" where none is stated.
std::string later(const ImcTrigger& trigger, double seconds) {
  using namespace std::chrono;
  const std::string stated = iso_time(trigger.year, trigger.month, trigger.day, trigger.hour,
                                      trigger.minute, trigger.second);
  if (stated.empty() || seconds == 0.0 || !(std::abs(seconds) < 1e10)) return stated;
  const sys_days day = year(trigger.year) / month(static_cast<unsigned>(trigger.month)) /
                       std::chrono::day(static_cast<unsigned>(trigger.day));
  const double second = trigger.second + seconds;
  const double whole = std::floor(second);
  const sys_seconds time = day + hours(trigger.hour) + minutes(trigger.minute) +
                           std::chrono::seconds(static_cast<std::int64_t>(whole));
  const sys_days date = floor<days>(time);
  const year_month_day calendar(date);
  const hh_mm_ss clock(time - date);
  return iso_time(int(calendar.year()), static_cast<int>(unsigned(calendar.month())),
                  static_cast<int>(unsigned(calendar.day())),
                  static_cast<int>(clock.hours().count()),
                  static_cast<int>(clock.minutes().count()),
                  static_cast<double>(clock.seconds().count()) + (second - whole));
}

/// x of the first sample of a buffer, by CD and Cb.
double start_of(const ImcComponent& one, const ImcBuffer& buffer) {
  if (one.abscissa.start_usage == 0) return 0.0;
  return one.abscissa.start_usage == 2 ? one.abscissa.start : buffer.start;
}

/// Makes 0 of the bits that are to be ignored.
std::function<void(std::span<double>)> without_bits(std::uint64_t mask) {
  return [kept = ~static_cast<std::int64_t>(mask)](std::span<double> values) {
    for (double& value : values)
      value = static_cast<double>(static_cast<std::int64_t>(value) & kept);
  };
}

class ImcReader {
 public:
  explicit ImcReader(const std::string& path) : file_(std::make_unique<MappedFile>(path)) {}

  std::unique_ptr<RecordingReader> open() {
    contents_ = read_imc_fields(*file_, record_);
    bool over_own_x = false;
    for (const ImcField& field : contents_.fields) {
      if (field.type == 1) {
        for (const ImcComponent& component : field.components) add_component(component);
      } else if (field.type == 2 || field.type == 3) {
        over_own_x = true;
        add_over_own_x(field);
      } else {
        refuse(field.components.front(),
               fmt::format("holds {}",
                           field.type >= 4 && field.type <= 6
                               ? std::string(field_types[static_cast<std::size_t>(field.type)])
                               : fmt::format("data of type {}", field.type)));
      }
    }
    if (record_.channels.empty()) {
      if (!refused_.empty()) throw InputError(file_->byte_position(refused_at_), refused_);
      record_.warnings.push_back("no recordings in this file: it has no channels with samples");
    }
    starts_.tell(record_);
    for (const std::string& sentence : contents_.left_out) record_.warnings.push_back(sentence);
    auto reader = reader_of_numbers(std::move(file_), std::move(record_), std::move(stored_));
    if (!over_own_x) return reader;
    // such channels are small: their times are numbers of any kind, with a scale
    Record whole = read_into_memory(*reader);
    for (auto& [index, axis] : axes_) whole.channels[index].clock = std::move(axis.clock);
    return reader_of(std::move(whole));
  }

 private:
  [[noreturn]] void fail(std::uint64_t place, const std::string& problem) const {
    throw InputError(file_->byte_position(place), problem);
  }

  static std::string name_of(const ImcComponent& one, std::size_t number) {
    return one.name.empty() ? fmt::format("channel {}", number + 1) : one.name;
  }

  void refuse(const ImcComponent& one, const std::string& what) {
    const std::string sentence =
        fmt::format("'{}' {}, which is not read", name_of(one, record_.channels.size()), what);
    contents_.left_out.push_back(sentence);
    if (refused_.empty()) {
      refused_ = sentence + ": export it from FAMOS as ASCII";
      refused_at_ = one.place;
    }
  }

  /// A component whose numbers can be read, else none (and a sentence).
  bool readable(const ImcComponent& one, bool six_bytes_too = false) {
    if (one.digital && (one.number_format != imc_digital_words || one.bit > 16)) {
      refuse(one, fmt::format("is digital, bit {} in {}", one.bit, kind_name(one.number_format)));
      return false;
    }
    const auto kind = imc_kind(one);
    if (!kind && !(six_bytes_too && one.number_format == imc_six_bytes)) {
      refuse(one, fmt::format("holds {}", kind_name(one.number_format)));
      return false;
    }
    const int width = kind ? static_cast<int>(size_of(*kind)) : 6;
    if (one.bytes != width)
      fail(one.place,
           fmt::format("'{}': numbers of format {} have {} bytes, the key CP states {}",
                       name_of(one, record_.channels.size()), one.number_format, width, one.bytes));
    if (one.count != 1) {
      refuse(one, fmt::format("is stored in groups of {} numbers", one.count));
      return false;
    }
    if (one.mask != 0 && !may_have_mask(kind)) {
      refuse(one, fmt::format("has bits to be ignored (mask {}) in {}", one.mask,
                              kind ? "its numbers" : kind_name(one.number_format)));
      return false;
    }
    if (one.distance > (std::uint64_t{1} << 31) || one.offset > (std::uint64_t{1} << 31))
      fail(one.place, fmt::format("'{}': its numbers are said to lie {} bytes apart, the first at "
                                  "{}",
                                  name_of(one, record_.channels.size()), one.distance, one.offset));
    std::uint64_t samples = 0;
    for (const ImcBuffer& buffer : one.buffers)
      samples += samples_.announced_in(one, buffer, static_cast<std::uint64_t>(width));
    if (one.segment > 0 && samples > one.segment) {
      refuse(one, fmt::format("is a matrix, of segments of {} samples ('CZ')", one.segment));
      return false;
    }
    return true;
  }

  Channel channel_of(const ImcComponent& one, const ImcBuffer& buffer) {
    Channel channel;
    channel.name = name_of(one, record_.channels.size());
    set_unit(channel, one.unit == "Degr" ? "deg" : one.unit);  // imc's name of the angle
    set_scale(channel, one.factor, one.shift, *file_, one.place);
    undo_zero_scale(channel, record_);
    set_attribute(channel, "comment", one.comment);
    set_attribute(channel, "group", one.group);
    // devices may write 1980 there and the seconds since, in their own time zone
    const std::string trigger = later(one.trigger, buffer.add_time);
    if (buffer.add_time != 0.0 && one.trigger.year != year_0)
      channel.attributes["add time"] = fmt::format("{} s", buffer.add_time);
    set_attribute(channel, "trigger time", trigger);
    if (record_.started.empty()) record_.started = trigger;
    starts_.add(trigger);
    return channel;
  }

  void limit_channels(const ImcComponent& one) const {
    if (record_.channels.size() >= most_channels)
      fail(one.place, fmt::format("the file has more than {} channels or events: save it in parts",
                                  most_channels));
  }

  void add_component(const ImcComponent& one) {
    if (!readable(one)) return;
    const NumberKind kind = *imc_kind(one);
    if (one.buffers.empty()) {
      refuse(one, "has no buffer of samples ('Cb')");
      return;
    }
    const auto parts = samples_.joined_buffers(one, size_of(kind));
    if (one.events && one.events->count > 0) {
      if (parts.size() == 1)
        add_events(one, parts.front(), kind);
      else
        refuse(one, "has a list of events in several buffers");
      return;
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const ImcBuffer& first = parts[i].front();
      limit_channels(one);
      Channel channel = channel_of(one, first);
      if (parts.size() > 1) channel.name += fmt::format(", event {}", i + 1);
      const ImcRuns runs = samples_.runs_of(one, parts[i], kind, channel.name);
      if (!first.samples_at) {
        refuse(one, "has no samples in the file ('CS')");
        continue;
      }
      set_axis(channel, start_of(one, first), one.abscissa.interval, one.abscissa.unit);
      add_channel(std::move(channel), one, samples_.numbers_in(runs, kind));
    }
  }

  void add_channel(Channel channel, const ImcComponent& one, StoredNumbers numbers) {
    stored_.push_back({std::move(numbers)});
    if (one.digital && one.bit > 0)
      stored_.back().scaling = bit_of_words(one.bit);
    else if (one.mask != 0)
      stored_.back().scaling = without_bits(one.mask);
    record_.channels.push_back(std::move(channel));
  }

  /// The events that a component has of a list, none and a sentence where they cannot be read.
  std::vector<ImcEvent> events_of(const ImcComponent& one) {
    const ImcEventReference& reference = *one.events;
    const auto list = contents_.events.find(reference.list);
    std::vector<ImcEvent> events;
    if (list != contents_.events.end())
      for (std::uint64_t i = reference.first;
           i < list->second.size() && events.size() < reference.count; i += reference.step)
        events.push_back(list->second[i]);
    if (events.size() < reference.count) {
      refuse(one, fmt::format("has {} events of which {} are in the file ('CV')", reference.count,
                              events.size()));
      return {};
    }
    for (const ImcEvent& event : events) {
      const bool same = event.factor == one.factor && event.shift == one.shift;
      const bool unused = !reference.own_scale && event.shift == 0.0 &&
                          (event.factor == 0.0 || event.factor == 1.0);
      if (same || unused) continue;
      refuse(one, "has events with scales of their own");
      return {};
    }
    return events;
  }

  void add_events(const ImcComponent& one, const std::vector<ImcBuffer>& buffers, NumberKind kind) {
    const ImcBuffer& buffer = buffers.front();
    if (!buffer.samples_at) {
      refuse(one, "has no samples in the file ('CS')");
      return;
    }
    const std::vector<ImcEvent> events = events_of(one);
    if (events.empty()) return;
    const std::string name = name_of(one, record_.channels.size());
    const ImcRuns runs = samples_.runs_of(one, buffers, kind, name);
    std::uint64_t in_events = 0;
    for (std::size_t i = 0; i < events.size(); ++i) {
      limit_channels(one);
      Channel channel = channel_of_event(one, buffer, events[i]);
      channel.name = events.size() > 1 ? fmt::format("{}, event {}", name, i + 1) : name;
      StoredNumbers numbers = samples_.numbers_in(runs, kind, events[i].first, events[i].count);
      if (numbers.size() < events[i].count)
        record_.warnings.push_back(cut_off(channel.name, numbers.size(), events[i].count));
      in_events += numbers.size();
      add_channel(std::move(channel), one, std::move(numbers));
    }
    tell_of_other_axes(one, buffer, events, name);
    std::uint64_t there = 0;
    for (const NumberRun& run : runs) there += run.count;
    if (in_events < there)
      record_.warnings.push_back(
          fmt::format("'{}': {} of {} samples are in none of its {} events: they are left out",
                      name, there - in_events, there, events.size()));
  }

  static double interval_of(const ImcComponent& one, const ImcEvent& event) {
    return event.interval > 0.0 ? event.interval : one.abscissa.interval;
  }

  Channel channel_of_event(const ImcComponent& one, const ImcBuffer& buffer,
                           const ImcEvent& event) {
    Channel channel = channel_of(one, buffer);
    if (event.time != 0.0) {  // how it adds to the trigger time is not documented
      channel.attributes["event time"] = fmt::format("{} s", event.time);
      channel.attributes.erase("trigger time");
    }
    if (one.events->own_axis)
      set_axis(channel, event.start, interval_of(one, event), one.abscissa.unit);
    else
      set_axis(channel, start_of(one, buffer), one.abscissa.interval, one.abscissa.unit);
    return channel;
  }

  void tell_of_other_axes(const ImcComponent& one, const ImcBuffer& buffer,
                          const std::vector<ImcEvent>& events, const std::string& name) {
    const bool same = std::ranges::all_of(events, [&](const ImcEvent& event) {
      return event.start == start_of(one, buffer) &&
             interval_of(one, event) == one.abscissa.interval;
    });
    if (same) return;
    record_.warnings.push_back(
        fmt::format("'{}': its list of events states other starts or intervals than the channel: "
                    "those of the {} are taken",
                    name, one.events->own_axis ? "list" : "channel"));
  }

  void add_over_own_x(const ImcField& field) {
    // the index tells y (1) from x (2), whichever comes first
    const bool x_first = field.components.size() == 2 && field.components[0].index == 2 &&
                         field.components[1].index == 1;
    const ImcComponent& one = field.components[x_first ? 1 : 0];
    const ImcComponent& x = field.components[field.components.size() == 2 && !x_first ? 1 : 0];
    if (field.components.size() != 2 || one.buffers.size() != 1 || x.buffers.size() != 1 ||
        !one.buffers.front().samples_at || !x.buffers.front().samples_at) {
      refuse(one, fmt::format("is an x-y data set of {} components in several buffers",
                              field.components.size()));
      return;
    }
    if (!readable(one) || !readable(x, true)) return;
    if (one.digital || x.digital) return refuse(one, "is digital over an x of its own");
    for (const ImcComponent* const component : {&one, &x}) {
      if (component->mask == 0 && (!component->events || component->events->count == 0)) continue;
      refuse(one, fmt::format("is an x-y data set with {}",
                              component->mask != 0 ? "bits to be ignored" : "a list of events"));
      return;
    }
    limit_channels(one);
    Channel channel = channel_of(one, one.buffers.front());
    const NumberKind kind = *imc_kind(one);
    StoredNumbers numbers =
        samples_.numbers_in(samples_.runs_of(one, one.buffers, kind, channel.name), kind);
    std::vector<double> times = samples_.values_of(x);
    if (times.size() != numbers.size()) {
      refuse(one, fmt::format("has {} samples and {} x", numbers.size(), times.size()));
      return;
    }
    const auto seconds = datasets::conversion(x.unit, "s");
    if (!x.unit.empty() && !seconds) {
      refuse(one, fmt::format("is over '{}', which is no time", x.unit));
      return;
    }
    if (seconds && seconds->factor != 1.0)
      for (double& time : times) time *= seconds->factor;
    channel.attributes["domain"] = "time";
    if (std::any_of(times.begin(), times.end(), [](double time) { return !std::isfinite(time); })) {
      refuse(one, "has times that are not finite");
      return;
    }
    TimeAxis axis = time_axis(std::move(times));
    if (!axis.warning.empty())
      record_.warnings.push_back(fmt::format("'{}': {}", channel.name, axis.warning));
    axes_.emplace_back(record_.channels.size(), std::move(axis));
    stored_.push_back({std::move(numbers)});
    record_.channels.push_back(std::move(channel));
  }

  std::unique_ptr<MappedFile> file_;
  ImcContents contents_;
  Record record_;
  ImcSamples samples_{*file_, contents_, record_.warnings};
  StartTimes starts_;
  std::string refused_;
  std::uint64_t refused_at_ = 0;
  std::vector<StoredChannel> stored_;
  std::vector<std::pair<std::size_t, TimeAxis>> axes_;
};

}  // namespace

int recognises_imc_raw(std::string_view, std::string_view head) {
  return head.starts_with("|CF,") ? 100 : 0;
}

std::unique_ptr<RecordingReader> open_imc_raw(const std::string& path, const ImportOptions&) {
  return ImcReader(path).open();
}

}  // namespace impactrig::acquisition
