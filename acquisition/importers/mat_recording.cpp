// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mat_recording.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "acquisition/importers/stated_units.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

StoredNumbers stored(const MatArray& array, bool big_endian, bool imaginary = false) {
  const NumberKind kind = imaginary ? array.imaginary_kind : array.kind;
  StoredNumbers numbers(kind, big_endian);
  numbers.add(
      {imaginary ? array.imaginary_offset : array.offset, array.count, size_of(kind), 1, 0});
  return numbers;
}

class RecordingInMat {
 public:
  explicit RecordingInMat(MatContents contents) : contents_(std::move(contents)) {
    for (const MatArray& found : contents_.arrays) arrays_.emplace(found.name, &found);
    for (const auto& [name, why] : contents_.skipped) skipped_.insert(name);
    read_head();
    for (const std::string& name : contents_.variables)
      if (name != "recording" && is_channel(name)) add_channel(name);
    tell_of_others();
  }

  std::unique_ptr<RecordingReader> reader(const std::vector<std::string>& units) {
    take_stated_units(units, contents_.file->path(), record_);
    return reader_of_numbers(std::move(contents_.file), std::move(record_), std::move(stored_));
  }

 private:
  void read_head() {
    record_.warnings = std::move(contents_.warnings);
    record_.title = text("recording.title");
    record_.started = text("recording.start_time");
    record_.attributes = attributes("recording.attributes");
    const auto entries = contents_.structures.find("recording.warnings");
    for (std::uint64_t i = 0; entries != contents_.structures.end() && i < entries->second; ++i) {
      const auto found = contents_.texts.find(entry("recording.warnings", i, "text"));
      if (found == contents_.texts.end()) break;  // beyond what the file holds
      record_.warnings.push_back(to_utf8(found->second));
    }
    read_edits();
    for (const auto& [field, key] :
         {std::pair{"source_file", "origin file"}, std::pair{"source_sha256", "origin sha256"},
          std::pair{"source_format", "origin format"},
          std::pair{"source_program", "origin program"}})
      if (std::string says = text(fmt::format("recording.{}", field)); !says.empty())
        record_.attributes.emplace(key, std::move(says));
  }

  void read_edits() {
    const auto entries = contents_.structures.find("recording.edits");
    for (std::uint64_t i = 0; entries != contents_.structures.end() && i < entries->second; ++i) {
      const std::string what = text(entry("recording.edits", i, "what"));
      if (what.empty()) break;  // beyond what the file holds
      record_.provenance.edits.push_back({what, lines(entry("recording.edits", i, "channel")),
                                          attributes(entry("recording.edits", i, "parameters"))});
    }
  }

  std::string text(const std::string& name) const {
    const auto found = contents_.texts.find(name);
    return found == contents_.texts.end() ? std::string() : to_utf8(found->second);
  }

  /// Text of which line breaks and tabs stay.
  std::string lines(const std::string& name) const {
    const auto found = contents_.texts.find(name);
    if (found == contents_.texts.end()) return {};
    std::string clean = to_utf8_with_controls(found->second);
    for (char& c : clean) {
      const bool stays = c == '\n' || c == '\r' || c == '\t';
      if (!stays && (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)) c = ' ';
    }
    return clean;
  }

  const MatArray* array(const std::string& name) const {
    const auto found = arrays_.find(name);
    return found == arrays_.end() ? nullptr : found->second;
  }

  std::optional<double> number(const std::string& name) const {
    const MatArray* const found = array(name);
    if (found == nullptr || found->count != 1) return std::nullopt;
    double value = 0.0;
    read_numbers(*contents_.file, stored(*found, contents_.big_endian), 0, {&value, 1});
    return value;
  }

  /// A field of one of several structures, named as read_mat_contents() does.
  std::string entry(const std::string& name, std::uint64_t index, std::string_view field) const {
    return contents_.structures.at(name) == 1 ? fmt::format("{}.{}", name, field)
                                              : fmt::format("{}({}).{}", name, index + 1, field);
  }

  std::map<std::string, std::string> attributes(const std::string& name) const {
    std::map<std::string, std::string> all;
    const auto entries = contents_.structures.find(name);
    for (std::uint64_t i = 0; entries != contents_.structures.end() && i < entries->second; ++i) {
      const std::string key = text(entry(name, i, "name"));
      const std::string value = lines(entry(name, i, "value"));
      if (key.empty() && value.empty()) break;  // beyond what the file holds
      all.emplace(key, value);
    }
    return all;
  }

  bool is_channel(const std::string& name) const {
    return contents_.structures.at(name) == 1 && number(name + ".start").has_value() &&
           number(name + ".interval").has_value() &&
           (array(name + ".value") != nullptr || skipped_.contains(name + ".value"));  // empty
  }

  void add_channel(const std::string& name) {
    Channel channel;
    channel.name = lines(name + ".name");
    channel.unit = text(name + ".unit");
    channel.quantity =
        datasets::quantity_named(text(name + ".quantity")).value_or(datasets::Quantity::unknown);
    channel.clock.start = number(name + ".start").value_or(0.0);
    channel.clock.interval = number(name + ".interval").value_or(0.0);
    if (!std::isfinite(channel.clock.start)) channel.clock.start = 0.0;
    if (!(channel.clock.interval > 0.0) || std::isinf(channel.clock.interval))
      channel.clock.interval = 0.0;
    channel.attributes = attributes(name + ".attributes");
    if (const auto sensitivity = number(name + ".calibration.sensitivity"))
      channel.calibration = {*sensitivity, number(name + ".calibration.uncertainty").value_or(0.0),
                             text(name + ".calibration.recorded_unit"),
                             text(name + ".calibration.physical_unit"),
                             text(name + ".calibration.source")};
    if (const auto delay = number(name + ".delay.value"))
      channel.delay = {*delay, number(name + ".delay.uncertainty").value_or(0.0),
                       number(name + ".delay.removed").value_or(0.0) != 0.0};
    StoredChannel samples;
    samples.samples = StoredNumbers(NumberKind::f64, contents_.big_endian);
    if (const MatArray* const value = array(name + ".value")) {
      samples.samples = stored(*value, contents_.big_endian);
      if (value->complex) samples.imaginary = stored(*value, contents_.big_endian, true);
      samples.times = beside(name + ".time", value->count);
      samples.invalid = beside(name + ".invalid", value->count);
    }
    record_.channels.push_back(std::move(channel));
    stored_.push_back(std::move(samples));
  }

  /// An array that has a number for each sample, or more where the samples were cut; nothing where
  /// there is none.
  StoredNumbers beside(const std::string& name, std::uint64_t samples) {
    const MatArray* const found = array(name);
    if (found == nullptr) return {};
    if (found->count >= samples) {
      MatArray part = *found;
      part.count = samples;
      return stored(part, contents_.big_endian);
    }
    record_.warnings.push_back(fmt::format("'{}' has {} numbers for {} samples: it is left out",
                                           name, found->count, samples));
    return {};
  }

  /// Names what stands in the file and is no part of the recording.
  void tell_of_others() {
    std::string list;
    std::uint64_t more = contents_.more_skipped;
    const auto tell = [&](const std::string& name) {
      if (list.size() < 500)
        list += (list.empty() ? "'" : ", '") + name + "'";
      else
        ++more;
    };
    for (const std::string& name : contents_.variables)
      if (name != "recording" && !is_channel(name)) tell(name);
    const auto at_top = [](const std::string& name) { return name.find('.') == std::string::npos; };
    for (const MatArray& found : contents_.arrays)
      if (at_top(found.name)) tell(found.name);
    for (const auto& [name, text] : contents_.texts)
      if (at_top(name)) tell(name);
    for (const auto& [name, why] : contents_.skipped)
      if (at_top(name)) tell(name);
    if (list.empty() && more == 0) return;
    if (more > 0) list += fmt::format(" and {} more", more);
    record_.warnings.push_back(
        fmt::format("not read, since no channel of the recording is there: {}", list));
  }

  MatContents contents_;
  std::unordered_map<std::string, const MatArray*> arrays_;
  std::unordered_set<std::string> skipped_;
  Record record_;
  std::vector<StoredChannel> stored_;
};

}  // namespace

bool is_mat_recording(const MatContents& contents) {
  const auto format = contents.texts.find("recording.format");
  return format != contents.texts.end() && format->second == "impactrig-recording";
}

std::unique_ptr<RecordingReader> reader_of_mat_recording(MatContents contents,
                                                         const std::vector<std::string>& units) {
  return RecordingInMat(std::move(contents)).reader(units);
}

}  // namespace impactrig::acquisition
