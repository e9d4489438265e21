// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/channel_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

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
        apply(*chosen.mapping, head_.record.channels.back(), head_.record.provenance);
    }
    refuse_equal_names();
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
        apply(*mapping, record.channels[i], record.provenance);
    return record;
  }

 private:
  [[noreturn]] void refuse(const std::string& problem) const {
    throw InputError({.file = map_.file}, problem);
  }

  void choose() {
    const std::vector<Channel>& there = reader_->head().record.channels;
    std::set<std::size_t> taken;
    for (const ChannelMapping& mapping : map_.channels) {
      const std::vector<std::size_t> found = find(mapping);
      if (found.empty())
        refuse(fmt::format(
            "no channel of {} matches {}; the channels are {}",
            reader_->head().record.provenance.source_file,
            mapping.index ? fmt::format("index {}", *mapping.index) : "'" + mapping.match + "'",
            list_of(there)));
      if (found.size() > 1 && !mapping.name.empty())
        refuse(
            fmt::format("'{}' matches {} channels, which cannot all be called '{}' (index = "
                        "picks one)",
                        mapping.match, found.size(), mapping.name));
      const std::size_t before = channels_.size();
      for (const std::size_t index : found)
        if (taken.insert(index).second) channels_.push_back({index, &mapping});
      if (channels_.size() == before)
        refuse(fmt::format(
            "{} matches only what an entry above it took: put it first",
            mapping.index ? fmt::format("index {}", *mapping.index) : "'" + mapping.match + "'"));
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

  void apply(const ChannelMapping& mapping, Channel& channel,
             datasets::Provenance& provenance) const {
    datasets::Edit edit{"map channel", mapping.name.empty() ? channel.name : mapping.name, {}};
    auto& says = edit.parameters;
    says["map"] = map_.file;
    if (!mapping.name.empty() && mapping.name != channel.name) {
      says["name in file"] = channel.name;
      channel.name = mapping.name;
    }
    if (mapping.full_scale && !channel.unit.empty() && !channel.unit.starts_with("FS"))
      refuse(
          fmt::format("'{}' is recorded in '{}', not in parts of full scale: leave full_scale "
                      "away",
                      channel.name, channel.unit));
    if (!mapping.unit.empty() && mapping.unit != channel.unit) {
      says["unit in file"] = channel.unit.empty() ? "not stated" : channel.unit;
      channel.unit = mapping.unit;
      channel.quantity = datasets::quantity_of_unit(channel.unit);
    }
    if (mapping.full_scale) {
      says["full scale"] = fmt::format("{} {}", *mapping.full_scale, channel.unit);
      channel.scale *= *mapping.full_scale;
      channel.offset *= *mapping.full_scale;
    }
    if (mapping.sensitivity) to_physical(mapping, channel, says);
    if (mapping.polarity < 0.0) {
      says["polarity"] = "-1";
      channel.scale = -channel.scale;
      channel.offset = -channel.offset;
    }
    if (mapping.role) take_role(*mapping.role, channel);
    if (mapping.position) channel.attributes["position"] = fmt::format("{} m", *mapping.position);
    if (mapping.delay) channel.delay = mapping.delay;
    provenance.edits.push_back(std::move(edit));
  }

  /// Volts or coulombs to the role's SI unit.
  void to_physical(const ChannelMapping& mapping, Channel& channel,
                   std::map<std::string, std::string>& says) const {
    const auto recorded = datasets::conversion(channel.unit, mapping.recorded_unit);
    if (!recorded)
      refuse(
          fmt::format("'{}' is recorded in '{}', its sensitivity is in {} a unit: state the "
                      "recorded unit, for example unit = \"{}\"",
                      channel.name, channel.unit, mapping.recorded_unit, mapping.recorded_unit));
    const std::string physical(datasets::si_unit(*mapping.role));
    const double sensitivity = mapping.sensitivity->value;
    channel.scale *= recorded->factor / sensitivity;
    channel.offset = (recorded->factor * channel.offset + recorded->offset) / sensitivity;
    channel.unit = physical;
    channel.calibration = {sensitivity, mapping.sensitivity->uncertainty, mapping.recorded_unit,
                           physical, map_.file};
    says["sensitivity"] = fmt::format("{} {}/({})", sensitivity, mapping.recorded_unit, physical);
  }

  void take_role(Quantity role, Channel& channel) const {
    const std::string_view si = datasets::si_unit(role);
    if (!si.empty() && !datasets::conversion(channel.unit, si)) {
      if (channel.unit.empty())
        refuse(fmt::format("'{}' states no unit: as {} it needs one, for example unit = \"{}\"",
                           channel.name, datasets::name(role), si));
      refuse(
          fmt::format("'{}' is recorded in '{}': as {} it needs a sensitivity, for example "
                      "sensitivity = \"{}\"",
                      channel.name, channel.unit, datasets::name(role),
                      role == Quantity::force ? "4 pC/N" : fmt::format("0.1 V/({})", si)));
    }
    channel.quantity = role;
  }

  std::unique_ptr<RecordingReader> reader_;
  ChannelMap map_;
  std::vector<MappedChannel> channels_;
  RecordingHead head_;
};

/// A text between quotes, as TOML has it.
std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
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
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
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

std::string suggested_map(const Record& record) {
  std::string text = fmt::format(
      "# What the channels of {} are. Complete it and give it to `impactrig import --map`.\n"
      "# Keys of a channel: match (name, or a pattern with * and ?) or index (from 0); name;\n"
      "# role (force, velocity, displacement, acceleration, ...); unit of the recorded numbers;\n"
      "# sensitivity (\"4 pC/N\", \"125 mm/s/V\") and gain (\"1 mV/pC\") where volts or coulombs "
      "are\n"
      "# recorded; full_scale = \"10 V\" in place of unit where parts of full scale are; polarity "
      "= -1;\n"
      "# position = \"0.69 m\" from the hinge; delay = \"2(1) us\". Steps of conditioning may\n"
      "# follow: [[conditioning]] with channel = \"velocity\" and step = \"dropouts\", ...\n\n"
      "others = \"drop\"  # or \"keep\": channels that are not named here\n",
      record.provenance.source_file);
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    const Channel& channel = record.channels[i];
    const bool no_name = std::ranges::count(record.channels, channel.name, &Channel::name) > 1 ||
                         channel.name.find_first_of("*?") != std::string::npos;
    text += "\n[[channels]]\n";
    text += no_name ? fmt::format("index = {}  # {}\n", i, channel.name)
                    : fmt::format("match = {}\n", quoted(channel.name));
    if (channel.unit.starts_with("FS")) {
      text += "# full_scale = \"10 V\"  # the file holds parts of full scale\n";
    } else if (channel.unit.empty()) {
      text += "# unit = \"V\"  # the file states none\n";
    } else {
      text += fmt::format("unit = {}\n", quoted(channel.unit));
    }
    const Quantity quantity = channel.quantity;
    const bool electrical = quantity == Quantity::voltage || quantity == Quantity::charge ||
                            quantity == Quantity::unknown || quantity == Quantity::other;
    if (electrical)
      text += "# role = \"force\"\n# sensitivity = \"4 pC/N\"\n# gain = \"1 mV/pC\"\n";
    else
      text += fmt::format("role = {}\n", quoted(datasets::name(quantity)));
    text += "# delay = \"0(1) us\"\n";
  }
  return text;
}

}  // namespace impactrig::acquisition
