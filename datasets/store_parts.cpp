// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/store_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "datasets/hdf5_write.hpp"

namespace impactrig::datasets {

void add_quicklook(hid_t parent, const std::string& name, const std::string& title,
                   std::uint64_t samples, const Quicklook& look) {
  const Hdf5Handle group = add_group(parent, name, "NXdata");
  add_text(group.id(), "title", title);
  add_text(group.id(), "signal", "value");
  add_text_list(group.id(), "axes", "time");
  add_number(group.id(), "time_indices", std::int64_t{0});
  add_number(group.id(), "samples", samples);

  const Hdf5Handle time = add_data(group.id(), "time", look.time);
  add_text(time.id(), "units", "s");
  add_text(time.id(), "long_name", "time (s)");
  std::vector<Hdf5Handle> data;
  const auto add_signal = [&](const char* set, const std::vector<double>& values,
                              std::string_view label) {
    data.push_back(add_data(group.id(), set, values));
    add_text(data.back().id(), "units", look.unit);
    add_text(data.back().id(), "long_name",
             look.unit.empty() ? std::string(label) : fmt::format("{} ({})", label, look.unit));
  };
  add_signal("value", look.values, title);
  if (!look.imaginary.empty()) {
    add_signal("imaginary", look.imaginary, "imaginary part of " + title);
    add_text_list(group.id(), "auxiliary_signals", "imaginary");
  }
  attach_time(group.id(), time, data);
}

void describe_channel(hid_t group, std::size_t index, const Channel& channel) {
  add_number(group, "index", static_cast<std::uint64_t>(index));
  add_scalar_text(group, "name", channel.name);
  add_scalar_text(group, "quantity", impactrig::datasets::name(channel.quantity));
  add_scalar_text(group, "unit", channel.unit);
  add_pairs(group, "attributes", channel.attributes);
}

void describe_samples(hid_t samples, const Channel& channel) {
  const bool scaled = channel.scale != 1.0 || channel.offset != 0.0;
  add_text(samples, "units", scaled ? "1" : channel.unit);
  add_text(samples, "physical_units", channel.unit);
  add_number(samples, "scale_factor", channel.scale);
  add_number(samples, "add_offset", channel.offset);
  add_number(samples, "start", channel.clock.start);
  add_number(samples, "interval", channel.clock.interval);
}

void describe_times(hid_t times) {
  add_text(times, "units", "s");
}

void describe_imaginary(hid_t imaginary, const Channel& channel) {
  add_text(imaginary, "units", channel.unit);
}

void describe_valid(hid_t valid) {
  add_text(valid, "flag_meanings", "0: not sound, 1: sound");
}

void add_calibration(hid_t parent, const std::string& name, const Channel& channel) {
  if (!channel.calibration && !channel.delay) return;
  const Hdf5Handle group = add_group(parent, name, "NXcollection");
  if (channel.calibration) {
    const Calibration& calibration = *channel.calibration;
    const std::string& physical = calibration.physical_unit;
    const bool simple = physical.find_first_of(" ./*()") == std::string::npos;
    const std::string unit =
        calibration.recorded_unit + (simple ? "/" + physical : "/(" + physical + ")");
    add_text(add_scalar(group.id(), "sensitivity", calibration.sensitivity).id(), "units", unit);
    add_text(add_scalar(group.id(), "sensitivity_errors", calibration.uncertainty).id(), "units",
             unit);
    add_scalar_text(group.id(), "recorded_unit", calibration.recorded_unit);
    add_scalar_text(group.id(), "physical_unit", calibration.physical_unit);
    add_scalar_text(group.id(), "source", calibration.source);
  }
  if (channel.delay) {
    const Hdf5Handle delay = add_scalar(group.id(), "delay", channel.delay->value);
    add_text(delay.id(), "units", "s");
    add_number(delay.id(), "removed", static_cast<std::uint8_t>(channel.delay->removed));
    add_text(add_scalar(group.id(), "delay_errors", channel.delay->uncertainty).id(), "units", "s");
  }
}

namespace {

void add_provenance(hid_t parent, const Provenance& provenance) {
  const Hdf5Handle group = add_group(parent, "provenance", "NXcollection");
  add_scalar_text(group.id(), "source_file", provenance.source_file);
  add_scalar(group.id(), "bytes", provenance.bytes);
  add_scalar_text(group.id(), "sha256", provenance.sha256);
  add_scalar_text(group.id(), "importer", provenance.importer);
  add_scalar_text(group.id(), "program", provenance.program);
  if (provenance.edits.empty()) return;
  const Hdf5Handle edits = add_group(group.id(), "edits", "NXcollection");
  for (std::size_t i = 0; i < provenance.edits.size(); ++i) {
    const Edit& edit = provenance.edits[i];
    const Hdf5Handle one = add_group(edits.id(), fmt::format("edit_{:06}", i), "NXcollection");
    add_scalar_text(one.id(), "what", edit.what);
    add_scalar_text(one.id(), "channel", edit.channel);
    add_pairs(one.id(), "parameters", edit.parameters);
  }
}

}  // namespace

std::vector<std::string> group_names(std::span<const std::string> channels) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const std::string& channel : channels) {
    std::string base;
    for (const char c : channel) {
      const bool upper = c >= 'A' && c <= 'Z';
      const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
      if (upper) base += static_cast<char>(c - 'A' + 'a');
      if (plain) base += c;
      if (!upper && !plain && !base.empty() && base.back() != '_') base += '_';
    }
    base.resize(std::min<std::size_t>(base.size(), 40));
    while (base.ends_with('_')) base.pop_back();
    if (base.empty() || (base.front() >= '0' && base.front() <= '9'))
      base = base.empty() ? "channel" : "channel_" + base;
    std::string name = base;
    for (int copy = 2; !taken.insert(name).second; ++copy) name = fmt::format("{}_{}", base, copy);
    names.push_back(name);
  }
  return names;
}

void add_file_head(hid_t file) {
  add_text(file, "NX_class", "NXroot");
  add_text(file, "default", "entry");
  add_text(file, "format", layout::format);
  add_text(file, "format_version", layout::format_version);
  add_text(file, "creator", program_version());
}

void describe_record(hid_t entry, const Record& record) {
  add_scalar_text(entry, "title", record.title);
  if (!record.started.empty()) add_scalar_text(entry, "start_time", record.started);
  add_provenance(entry, record.provenance);
  add_text_data(entry, "warnings", record.warnings);
  add_pairs(entry, "attributes", record.attributes);
}

void show_first(hid_t entry, hid_t quicklook, std::span<const ShownChannel> channels) {
  const auto shown = [](const ShownChannel& channel) { return channel.samples > 0; };
  auto found = std::ranges::find_if(channels, [&](const ShownChannel& channel) {
    return shown(channel) && channel.quantity == Quantity::force;
  });
  if (found == channels.end()) found = std::ranges::find_if(channels, shown);
  if (found == channels.end()) return;
  add_text(entry, "default", "quicklook");
  add_text(quicklook, "default", found->group);
}

}  // namespace impactrig::datasets
