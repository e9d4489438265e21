// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/tdms_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/tdms_scaling.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;

namespace {

class Recording {
 public:
  Recording(std::unique_ptr<MappedFile> file, const std::vector<TdmsObject>& objects, Record record,
            const ImportOptions& options)
      : file_(std::move(file)),
        objects_(objects),
        record_(std::move(record)),
        options_(options) {
    for (std::size_t i = 0; i < objects_.size(); ++i)
      if (objects_[i].depth == 1) groups_.emplace(objects_[i].group, i);
  }

  std::unique_ptr<RecordingReader> open() {
    describe();
    return reader_of_numbers(std::move(file_), std::move(record_), std::move(stored_));
  }

 private:
  void warn(std::string sentence) {
    if (std::ranges::find(record_.warnings, sentence) == record_.warnings.end())
      record_.warnings.push_back(std::move(sentence));
  }

  const TdmsProperties* properties_of_group(const std::string& group) const {
    const auto found = groups_.find(group);
    return found == groups_.end() ? nullptr : &objects_[found->second].properties;
  }

  void describe() {
    const TdmsProperties* file = nullptr;
    for (const TdmsObject& object : objects_)
      if (object.depth == 0) file = &object.properties;
    if (file != nullptr) {
      for (const auto& [name, value] : *file) record_.attributes[name] = text_of(value);
      for (const char* const name : {"name", "title"})
        if (const auto title = file->find(name); title != file->end() && record_.title.empty())
          record_.title = text_of(title->second);
    }
    for (const TdmsObject& object : objects_)
      if (object.depth == 1)
        for (const auto& [name, value] : object.properties)
          record_.attributes[object.group + "/" + name] = text_of(value);
    for (const TdmsObject& object : objects_)
      if (object.depth == 2) add_channel(object, file);
    if (record_.channels.empty())
      warn("no recordings in this file: it has no channel with numbers");
    set_uniform_clocks();
    set_clocks_by_channels();
    tell_same_names();
  }

  void add_channel(const TdmsObject& object, const TdmsProperties* file) {
    if (object.texts > 0) {
      warn(fmt::format("'{}' holds {} texts: it is left out", object.name, object.texts));
      return;
    }
    Channel channel;
    StoredChannel stored;
    channel.name = object.name;
    channel.attributes["group"] = object.group;
    for (const auto& [name, value] : object.properties)
      if (!name.starts_with("NI_Scale[")) channel.attributes[name] = text_of(value);
    const auto unit = object.properties.find("unit_string");
    if (unit != object.properties.end()) channel.unit = text_of(unit->second);
    const TdmsProperties* scales = &object.properties;
    if (!states_scales(*scales)) scales = properties_of_group(object.group);
    if (scales == nullptr || !states_scales(*scales)) scales = file;
    if (object.type != nullptr && object.type->role == TdmsRole::time)
      set_time_stamps(object, channel, stored);
    else
      set_numbers(object, scales, channel, stored);
    set_quantity(channel);
    record_.channels.push_back(std::move(channel));
    stored_.push_back(std::move(stored));
    channels_.push_back(&object);
  }

  void set_quantity(Channel& channel) {
    const auto [known, added] = quantities_.try_emplace(channel.unit, Quantity::unknown);
    if (added) known->second = datasets::quantity_of_unit(channel.unit);
    channel.quantity = known->second;
  }

  void set_numbers(const TdmsObject& object, const TdmsProperties* scales, Channel& channel,
                   StoredChannel& stored) {
    TdmsScaling scaling;
    if (scales != nullptr) scaling = tdms_scaling(*scales);
    if (object.sources.empty()) return;
    const TdmsSource* source = &object.sources.front();
    if (scaling.problem.empty() && !scaling.what.empty()) {
      const auto found = std::ranges::find(object.sources, scaling.source, &TdmsSource::id);
      if (found != object.sources.end())
        source = &*found;
      else if (object.sources.size() > 1)
        scaling.problem = fmt::format("its scales begin with the raw signal {}, which is not there",
                                      scaling.source);
    } else if (scaling.problem.empty() && object.sources.size() > 1) {
      warn(fmt::format("'{}' has {} raw signals and no scale that joins them: the first is read",
                       object.name, object.sources.size()));
    }
    if (scaling.problem.empty() && source->imaginary.size() > 0 && !scaling.what.empty())
      scaling.problem = "its numbers are complex";
    stored.samples = source->numbers;
    stored.imaginary = source->imaginary;
    std::function<void(std::span<double>)> function;
    if (!scaling.problem.empty()) {
      warn(fmt::format("'{}' is read unscaled, without its unit{}: {}", channel.name,
                       channel.unit.empty() ? "" : fmt::format(" '{}'", channel.unit),
                       scaling.problem));
      channel.unit.clear();
    } else if (scaling.function) {
      function = scaling.function;
    } else {
      channel.scale = scaling.scale;
      channel.offset = scaling.offset;
    }
    if (!scaling.what.empty() && scaling.problem.empty())
      channel.attributes["scales"] = scaling.what;
    if (source->bit >= 0) {
      function = [bit = source->bit, next = std::move(function)](std::span<double> x) {
        for (double& value : x)  // integers of 32 bits at most, or exact below 2^53
          value = std::fmod(std::floor(std::ldexp(value, -bit)), 2.0) != 0.0 ? 1.0 : 0.0;
        if (next) next(x);
      };
    }
    stored.scaling = std::move(function);
  }

  TdmsTime time_at(std::uint64_t at, bool big_endian) const {
    ByteCursor in(*file_, big_endian, at);
    return read_tdms_time(in);
  }

  /// Time stamps become seconds since the first of them. Of their 128 bits (64 of seconds, 64 of
  /// fraction) 64 in the middle are read: 24 of seconds and 40 of fraction give 1 ns within 97 days
  /// of the first, else 32 and 32 give 0.5 µs within 68 years.
  void set_time_stamps(const TdmsObject& object, Channel& channel, StoredChannel& stored) {
    const StoredNumbers& found = object.sources.front().numbers;
    const bool big_endian = found.big_endian();
    const TdmsTime first = time_at(object.first_value, big_endian);
    const TdmsTime last = time_at(object.last_value, big_endian);
    constexpr double days_90 = 90.0 * 86400.0;
    const double span = static_cast<double>(last.seconds) - static_cast<double>(first.seconds);
    const bool fine = std::abs(span) < days_90;
    StoredNumbers numbers(NumberKind::u64, big_endian);
    for (NumberRun run : found.runs()) {
      if (fine) run.offset += big_endian ? 1 : ~std::uint64_t{0};  // a byte less of seconds
      numbers.add(run);
    }
    const double unit = std::ldexp(1.0, fine ? -40 : -32);  // [s]
    const double all = std::ldexp(1.0, fine ? 24 : 32);     // [s], where the bits begin again
    double zero = 0.0;
    read_numbers(*file_, numbers, 0, {&zero, 1});
    stored.samples = numbers;
    stored.scaling = [unit, all, zero](std::span<double> x) {
      for (double& value : x) {
        value = (value - zero) * unit;
        if (value < -0.5 * all) value += all;
        if (value >= 0.5 * all) value -= all;
      }
    };
    channel.unit = "s";
    channel.attributes["first time stamp"] = iso_text(first);
    channel.attributes["counted from"] = "its first time stamp";
  }

  static std::optional<TdmsTime> start_of(const TdmsObject& object) {
    const auto stated = object.properties.find("wf_start_time");
    if (stated == object.properties.end()) return std::nullopt;
    const auto* const time = std::get_if<TdmsTime>(&stated->second);
    if (time == nullptr || iso_text(*time).empty()) return std::nullopt;
    return *time;
  }

  /// What `wf_increment` counts: how many seconds its unit (wf_xunit_string) has; none where the
  /// channel lies over anything else. Without a unit the abscissa's name (wf_xname) decides.
  static std::optional<double> seconds_of(const TdmsProperties& properties) {
    const auto text = [&](const char* name) {
      const auto found = properties.find(name);
      return found == properties.end() ? std::string() : text_of(found->second);
    };
    const std::string unit = text("wf_xunit_string");
    if (!unit.empty()) {
      if (datasets::quantity_of_unit(unit) == Quantity::frequency) return std::nullopt;
      const auto conversion = datasets::conversion(unit, "s");
      return conversion ? std::optional(conversion->factor) : std::nullopt;
    }
    const std::string name = text("wf_xname");
    const bool frequency = name == "Frequency" || name == "frequency";
    return frequency ? std::nullopt : std::optional(1.0);
  }

  static void set_other_abscissa(const TdmsProperties& properties, double first, double increment,
                                 Channel& channel) {
    const auto unit = properties.find("wf_xunit_string");
    const std::string spelled = unit == properties.end() ? "" : text_of(unit->second);
    const auto name = properties.find("wf_xname");
    std::string domain = name == properties.end() ? "" : text_of(name->second);
    const Quantity quantity = datasets::quantity_of_unit(spelled);
    if (spelled.empty() || quantity == Quantity::frequency)
      domain = "frequency";
    else if (domain.empty() || domain == "Time" || domain == "time")
      domain = quantity == Quantity::unknown ? "unknown" : std::string(datasets::name(quantity));
    set_abscissa(channel, domain, spelled, first, increment);
  }

  /// Uniform clocks from the waveform properties. Channels share a time origin: the earliest start.
  void set_uniform_clocks() {
    const auto before = [](const TdmsTime& a, const TdmsTime& b) {
      return a.seconds != b.seconds ? a.seconds < b.seconds : a.fraction < b.fraction;
    };
    std::optional<TdmsTime> earliest;
    for (const TdmsObject* const object : channels_)
      if (const auto start = start_of(*object); start && (!earliest || before(*start, *earliest)))
        earliest = start;
    if (earliest) record_.started = iso_text(*earliest);
    bool different = false;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const auto number = [&](const char* name) {
        const double value = number_of(channels_[i]->properties, name).value_or(0.0);
        return std::isfinite(value) ? value : 0.0;
      };
      datasets::SampleClock& clock = record_.channels[i].clock;
      const std::optional<double> unit = seconds_of(channels_[i]->properties);
      if (!unit) {
        set_other_abscissa(channels_[i]->properties, number("wf_start_offset"),
                           number("wf_increment"), record_.channels[i]);
        continue;
      }
      clock.start = *unit * number("wf_start_offset");
      clock.interval = *unit * std::max(0.0, number("wf_increment"));
      const auto start = start_of(*channels_[i]);
      if (!start) continue;
      const double later = static_cast<double>(start->seconds - earliest->seconds) +
                           std::ldexp(static_cast<double>(start->fraction), -64) -
                           std::ldexp(static_cast<double>(earliest->fraction), -64);
      // writers carry the start along in double precision: what is small against a step is none
      if (std::abs(later) <= 1e-3 * clock.interval) continue;
      different = true;
      clock.start += later;
    }
    if (different) warn("channels start at different times: time 0 is the start of the earliest");
  }

  /// Times from a channel: the one the user states, else the only one of time stamps in a group.
  void set_clocks_by_channels() {
    if (options_.time_column == "none") return;
    if (options_.time_column) {
      const Channel* const stated = record_.find(*options_.time_column);
      if (stated == nullptr)
        fail_in_tdms(
            *file_, 0,
            fmt::format("there is no channel '{}' to take times from", *options_.time_column));
      const auto t = static_cast<std::size_t>(stated - record_.channels.data());
      std::vector<std::size_t> group;
      for (std::size_t i = 0; i < channels_.size(); ++i)
        if (channels_[i]->group == channels_[t]->group) group.push_back(i);
      take_times(t, group, true);
      return;
    }
    std::map<std::string, std::vector<std::size_t>> groups;
    std::map<std::string, std::vector<std::size_t>> stamps;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      groups[channels_[i]->group].push_back(i);
      if (is_time_stamps(i)) stamps[channels_[i]->group].push_back(i);
    }
    for (const auto& [group, found] : stamps) {
      if (found.size() == 1) {
        take_times(found.front(), groups[group], false);
      } else {
        for (const std::size_t i : found) take_times(i, {i}, false);
      }
    }
  }

  bool is_time_stamps(std::size_t i) const {
    return channels_[i]->type != nullptr && channels_[i]->type->role == TdmsRole::time;
  }

  /// Gives the channels of as many values as channel `t` its values as times; `all`: even those
  /// that have a clock.
  void take_times(std::size_t t, const std::vector<std::size_t>& channels, bool all) {
    const std::uint64_t n = stored_[t].samples.size();
    if (n == 0 || stored_[t].imaginary.size() > 0) return;
    const Channel& times = record_.channels[t];
    double factor = 1.0;
    if (times.unit != "s") {
      const auto conversion = datasets::conversion(times.unit, "s");
      if (conversion)
        factor = conversion->factor;
      else
        warn(fmt::format("the times in '{}' are taken as seconds: its unit is '{}'", times.name,
                         times.unit));
    }
    const auto seconds = [scaling = stored_[t].scaling, scale = times.scale * factor,
                          offset = times.offset * factor](std::span<double> x) {
      if (scaling) scaling(x);
      if (scale == 1.0 && offset == 0.0) return;
      for (double& value : x) value = scale * value + offset;
    };
    datasets::SampleClock clock;
    StoredChannel found;
    const std::string warning = set_stored_times(*file_, stored_[t].samples, seconds, clock, found);
    bool used = false;
    for (const std::size_t i : channels) {
      Channel& channel = record_.channels[i];
      if (stored_[i].samples.size() != n || (channel.clock.interval > 0.0 && !all)) continue;
      channel.clock.start = clock.start;
      channel.clock.interval = clock.interval;
      stored_[i].times = found.times;
      stored_[i].times_scaling = found.times_scaling;
      if (i == t) continue;
      channel.attributes["times from"] = times.name;
      used = true;
    }
    if (!warning.empty()) warn(fmt::format("times from '{}': {}", times.name, warning));
    if (used && !all)
      warn(
          fmt::format("channels of '{}' state no sample interval: their times are the time stamps "
                      "in '{}' (--time-column none leaves them out)",
                      channels_[t]->group, times.name));
    if (!used && all)
      warn(
          fmt::format("no other channel of its group has as many values as '{}': it gives no times",
                      times.name));
  }

  void tell_same_names() {
    std::set<std::string> names;
    for (const Channel& channel : record_.channels)
      if (!names.insert(channel.name).second) {
        warn(fmt::format("several groups have a channel '{0}': state the group too, '{1}/{0}'",
                         channel.name, channel.attributes.at("group")));
        return;
      }
  }

  std::unique_ptr<MappedFile> file_;
  const std::vector<TdmsObject>& objects_;
  Record record_;
  const ImportOptions& options_;
  std::vector<StoredChannel> stored_;
  std::vector<const TdmsObject*> channels_;    // of record_
  std::map<std::string, std::size_t> groups_;  // their objects
  std::map<std::string, Quantity> quantities_;
};

}  // namespace

std::unique_ptr<RecordingReader> tdms_recording(std::unique_ptr<MappedFile> file,
                                                const std::vector<TdmsObject>& objects,
                                                Record record, const ImportOptions& options) {
  return Recording(std::move(file), objects, std::move(record), options).open();
}

}  // namespace impactrig::acquisition
