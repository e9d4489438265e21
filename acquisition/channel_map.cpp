// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/channel_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "acquisition/importers/full_scale.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Quantity;
using datasets::Record;

namespace {

std::string list_of(const std::vector<Channel>& channels) {
  std::string list;
  for (const Channel& channel : channels)
    list += fmt::format("{}'{}'", list.empty() ? "" : ", ", channel.name);
  return list.empty() ? "none" : list;
}

/// A channel of the mapped recording: its place in the file, and what the map says of it.
struct MappedChannel {
  std::size_t index = 0;
  const ChannelMapping* mapping = nullptr;  ///< null: as it is
};

class MappedRecording final : public RecordingReader {
 public:
  MappedRecording(std::unique_ptr<RecordingReader> reader, ChannelMap map)
      : reader_(std::move(reader)),
        map_(std::move(map)) {
    choose();
    const RecordingHead& file = reader_->head();
    head_.record = file.record;
    head_.record.channels.clear();
    head_.counted = file.counted;
    for (const MappedChannel& chosen : channels_) {
      head_.record.channels.push_back(file.record.channels[chosen.index]);
      head_.samples.push_back(file.samples[chosen.index]);
      if (chosen.mapping != nullptr)
        apply(*chosen.mapping, head_.record.channels.back(), head_.record);
    }
    refuse_equal_names();
    leave_out_answered(head_.record);
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    Selection of_file = wanted;
    of_file.channels.clear();
    const std::vector<std::size_t> places = selected_channels(head_, wanted);
    for (const std::size_t place : places) of_file.channels.push_back(channels_[place].index);
    Record record = reader_->read(of_file, sink);
    for (std::size_t i = 0; i < places.size(); ++i)
      if (const ChannelMapping* const mapping = channels_[places[i]].mapping)
        apply(*mapping, record.channels[i], record);
    leave_out_answered(record);
    return record;
  }

 private:
  [[noreturn]] void refuse(const std::string& problem, std::uint32_t line = 0) const {
    throw InputError({.file = map_.file, .line = line}, problem);
  }

  /// The warning that units are not known, where the map states all.
  static void leave_out_answered(Record& record) {
    const bool all = std::ranges::none_of(
        record.channels, [](const Channel& channel) { return channel.unit.starts_with("FS"); });
    if (all) std::erase_if(record.warnings, tells_of_full_scale);
  }

  void choose() {
    const std::vector<Channel>& there = reader_->head().record.channels;
    std::set<std::size_t> taken;
    for (const ChannelMapping& mapping : map_.channels) {
      const std::vector<std::size_t> found = find(mapping);
      if (found.empty())
        refuse(fmt::format("no channel of {} matches {}; the channels are {}",
                           reader_->head().record.provenance.source_file,
                           mapping.index ? fmt::format("index {}", *mapping.index)
                                         : "'" + mapping.match + "'",
                           list_of(there)),
               mapping.line);
      if (found.size() > 1 && !mapping.name.empty())
        refuse(fmt::format("'{}' matches {} channels, which cannot all be called '{}' (index = "
                           "picks one)",
                           mapping.match, found.size(), mapping.name),
               mapping.line);
      const std::size_t before = channels_.size();
      for (const std::size_t index : found)
        if (taken.insert(index).second) channels_.push_back({index, &mapping});
      if (channels_.size() == before)
        refuse(fmt::format("{} matches only what an entry above it took: put it first",
                           mapping.index ? fmt::format("index {}", *mapping.index)
                                         : "'" + mapping.match + "'"),
               mapping.line);
    }
    if (!map_.keep_others) return;
    for (std::size_t i = 0; i < there.size(); ++i)
      if (!taken.contains(i)) channels_.push_back({i, nullptr});
  }

  std::vector<std::size_t> find(const ChannelMapping& mapping) const {
    const Record& record = reader_->head().record;
    if (mapping.index)
      return *mapping.index < record.channels.size() ? std::vector{*mapping.index}
                                                     : std::vector<std::size_t>{};
    std::vector<std::size_t> found;
    if (mapping.match.find_first_of("*?") == std::string::npos) {
      if (const Channel* const channel = record.find(mapping.match))
        found.push_back(static_cast<std::size_t>(channel - record.channels.data()));
      return found;
    }
    for (std::size_t i = 0; i < record.channels.size(); ++i)
      if (matches_pattern(record.channels[i].name, mapping.match)) found.push_back(i);
    return found;
  }

  /// Files may have equal names, a map may not make them.
  void refuse_equal_names() const {
    std::map<std::string, bool> renamed;  // whether one of that name is
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const std::string& name = head_.record.channels[i].name;
      const bool now = channels_[i].mapping != nullptr && !channels_[i].mapping->name.empty();
      const auto [known, first] = renamed.try_emplace(name, now);
      if (first) continue;
      if (now || known->second) refuse(fmt::format("two channels would be called '{}'", name));
    }
  }

  /// As a map that is stated for what it has made. The channel is called as in the file.
  void warn_of_two_polarities(const Channel& channel, Record& record) const {
    if (datasets::has_been_inverted(reader_->head().record, channel))
      record.warnings.push_back(
          fmt::format("'{}' has been inverted by a map before and is again by {}, so that it is as "
                      "recorded: state it once",
                      channel.name, map_.file));
  }

  void apply(const ChannelMapping& mapping, Channel& channel, Record& record) const {
    if (mapping.polarity < 0.0) warn_of_two_polarities(channel, record);
    datasets::Edit edit{"map channel", mapping.name.empty() ? channel.name : mapping.name, {}};
    auto& says = edit.parameters;
    says["map"] = map_.file;
    if (!mapping.name.empty() && mapping.name != channel.name) {
      says["name in file"] = channel.name;
      channel.name = mapping.name;
    }
    if (mapping.full_scale && !channel.unit.empty() && !channel.unit.starts_with("FS"))
      refuse(fmt::format("'{}' is recorded in '{}', not in parts of full scale: leave full_scale "
                         "away",
                         channel.name, channel.unit),
             mapping.line);
    if (!mapping.unit.empty() && mapping.unit != channel.unit) {
      says["unit in file"] = channel.unit.empty() ? "not stated" : channel.unit;
      channel.unit = mapping.unit;
      channel.quantity = datasets::quantity_of_unit(channel.unit);
    }
    if (mapping.full_scale) {
      says["full scale"] = fmt::format("{:.12g} {}", *mapping.full_scale, channel.unit);
      channel.scale *= *mapping.full_scale;
      channel.offset *= *mapping.full_scale;
    }
    if (mapping.sensitivity) to_physical(mapping, channel, says);
    if (mapping.polarity < 0.0) {
      says["polarity"] = "-1";
      channel.scale = -channel.scale;
      channel.offset = -channel.offset;
    }
    if (mapping.role) {
      take_role(*mapping.role, mapping.line, channel);
      says["role"] = datasets::name(*mapping.role);
    }
    if (mapping.position)
      says["position"] = channel.attributes["position"] =
          fmt::format("{:.12g} m", *mapping.position);
    if (mapping.delay) {
      channel.delay = mapping.delay;
      says["delay"] = fmt::format("{:.12g} s, uncertain by {:.3g} s", mapping.delay->value,
                                  mapping.delay->uncertainty);
    }
    if (!std::isfinite(channel.scale) || channel.scale == 0.0)
      refuse(fmt::format("'{}' would be scaled by {:g}: look at its sensitivity and full scale",
                         channel.name, channel.scale),
             mapping.line);
    record.provenance.edits.push_back(std::move(edit));
  }

  /// Volts or coulombs to the role's SI unit.
  void to_physical(const ChannelMapping& mapping, Channel& channel,
                   std::map<std::string, std::string>& says) const {
    const auto recorded = datasets::conversion(channel.unit, mapping.recorded_unit);
    if (!recorded)
      refuse(fmt::format("'{}' is recorded in '{}', its sensitivity is in {} a unit: state the "
                         "recorded unit, for example unit = \"{}\"",
                         channel.name, channel.unit, mapping.recorded_unit, mapping.recorded_unit),
             mapping.line);
    const std::string physical(datasets::si_unit(*mapping.role));
    const double sensitivity = mapping.sensitivity->value;
    channel.scale *= recorded->factor / sensitivity;
    channel.offset = (recorded->factor * channel.offset + recorded->offset) / sensitivity;
    channel.unit = physical;
    channel.calibration = {sensitivity, mapping.sensitivity->uncertainty, mapping.recorded_unit,
                           physical, map_.file};
    says["sensitivity"] =
        fmt::format("{:.12g} {}/({})", sensitivity, mapping.recorded_unit, physical);
    if (mapping.sensitivity->uncertainty > 0.0)
      says["sensitivity"] += fmt::format(", uncertain by {:.3g}", mapping.sensitivity->uncertainty);
  }

  void take_role(Quantity role, std::uint32_t line, Channel& channel) const {
    const std::string_view si = datasets::si_unit(role);
    if (!si.empty() && !datasets::conversion(channel.unit, si)) {
      const std::string_view what = datasets::name(role);
      if (channel.unit.empty())
        refuse(fmt::format("'{}' states no unit: as {} it needs one, for example unit = \"{}\"",
                           channel.name, what, si),
               line);
      if (const std::string_view meant = unit_of_weight(channel.unit, role); !meant.empty())
        refuse(fmt::format("'{}' is recorded in '{}', a mass: as {} it needs unit = \"{}\"",
                           channel.name, channel.unit, what, meant),
               line);
      if (const std::string example = sensitivity_example(channel.unit, role); !example.empty())
        refuse(fmt::format("'{}' is recorded in '{}': as {} it needs a sensitivity, for example "
                           "sensitivity = \"{}\"",
                           channel.name, channel.unit, what, example),
               line);
      refuse(fmt::format("'{}' is recorded in '{}', which is no unit of {}: state what its numbers "
                         "are in, for example unit = \"{}\", or unit = \"V\" with a sensitivity",
                         channel.name, channel.unit, what, si),
             line);
    }
    channel.quantity = role;
  }

  std::unique_ptr<RecordingReader> reader_;
  ChannelMap map_;
  std::vector<MappedChannel> channels_;
  RecordingHead head_;
};

}  // namespace

std::string_view unit_of_weight(std::string_view unit, Quantity role) {
  const auto mass = datasets::conversion(unit, "kg");
  if (!mass || mass->factor != 1.0) return {};
  return role == Quantity::force ? "kgf" : role == Quantity::acceleration ? "kilo-g" : "";
}

std::string sensitivity_example(std::string_view unit, Quantity role) {
  const std::string_view si = datasets::si_unit(role);
  if (si.empty()) return {};
  if (datasets::conversion(unit, "C"))
    return role == Quantity::force ? "4 pC/N" : fmt::format("10 pC/({})", si);
  if (!datasets::conversion(unit, "V")) return {};
  return role == Quantity::force ? "2.25 mV/N" : fmt::format("0.1 V/({})", si);
}

namespace {

/// Bytes of a UTF-8 character behind its first.
bool continues_character(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

}  // namespace

bool matches_pattern(std::string_view name, std::string_view pattern) {
  std::size_t n = 0;
  std::size_t p = 0;
  std::size_t star = std::string_view::npos;  // the last one, and where its match ends so far
  std::size_t after = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      after = n;
    } else if (p < pattern.size() && pattern[p] == '?') {
      ++p;
      ++n;
      while (n < name.size() && continues_character(name[n])) ++n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++after;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::unique_ptr<RecordingReader> mapped(std::unique_ptr<RecordingReader> reader, ChannelMap map) {
  return std::make_unique<MappedRecording>(std::move(reader), std::move(map));
}

}  // namespace impactrig::acquisition
