// SPDX-License-Identifier: BSD-3-Clause
// Sessions of sigrok (PulseView, sigrok-cli): a ZIP archive. Layout: sigrok.org, "File format:
// Sigrok/v2".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <map>
#include <memory>
#include <optional>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/stated_units.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/zip_archive.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

constexpr std::uint64_t largest_metadata = std::uint64_t{1} << 20;  ///< [bytes]
constexpr std::size_t block_size = 16384;                           ///< samples handed over at once

/// An entry of the archive that holds samples of one channel.
struct Part {
  std::uint64_t number = 0;  ///< M of analog-1-N-M
  std::uint64_t entry = 0;   ///< index in the archive
  std::uint64_t samples = 0;
};

/// "analog-1-9-2" as its numbers.
std::optional<std::array<std::uint64_t, 3>> analog_numbers(std::string_view name) {
  constexpr std::string_view prefix = "analog-";
  if (!name.starts_with(prefix)) return std::nullopt;
  const char* at = name.data() + prefix.size();
  const char* const end = name.data() + name.size();
  std::array<std::uint64_t, 3> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0 && (at == end || *at++ != '-')) return std::nullopt;
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    if (error != std::errc{} || next == at) return std::nullopt;
    at = next;
  }
  return at == end ? std::optional(numbers) : std::nullopt;
}

/// "200 kHz", "1000000": a rate in Hz; 0 when it is none.
double rate_in(std::string_view text) {
  text = trimmed(text);
  const std::size_t end = text.find_last_of("0123456789.");
  if (end == std::string_view::npos) return 0.0;
  const auto value = number_in(text.substr(0, end + 1));
  const std::string unit = lowered(trimmed(text.substr(end + 1)));
  constexpr std::array<std::pair<std::string_view, double>, 5> units = {
      {{"", 1.0}, {"hz", 1.0}, {"khz", 1e3}, {"mhz", 1e6}, {"ghz", 1e9}}};
  for (const auto& [name, factor] : units)
    if (value && *value > 0.0 && unit == name) return *value * factor;
  return 0.0;
}

class SigrokReader final : public RecordingReader {
 public:
  SigrokReader(const std::string& path, const ImportOptions& options) : file_(path) {
    const std::string version(trimmed(text_of("version")));
    if (version != "1" && version != "2")
      archive_.refuse(fmt::format("the session is of version '{}', expected 1 or 2",
                                  to_utf8(version.substr(0, 20))));
    head_.record.attributes["session version"] = version;
    read_metadata(text_of("metadata"));
    list_entries();
    describe(options);
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    Record record = head_.record;
    record.channels.clear();
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      Channel channel = head_.record.channels[chosen[k]];
      const SampleRange range = samples_within(channel.clock, head_.samples[chosen[k]], wanted);
      channel.clock.start += channel.clock.interval * static_cast<double>(range.first);
      record.channels.push_back(std::move(channel));
      hand_over(parts_[chosen[k]], record.channels.back().name, range, k, sink);
    }
    return record;
  }

 private:
  std::string text_of(const char* name) {
    const auto entry = archive_.find(name);
    if (!entry)
      archive_.refuse(fmt::format("the archive has no '{}': it is no sigrok session", name));
    const std::uint64_t size = archive_.size(*entry, name);
    if (size > largest_metadata)
      archive_.refuse(
          fmt::format("'{}' has {} bytes, at most {} are expected", name, size, largest_metadata));
    std::string text(size, '\0');
    archive_.open(*entry, name).read(text.data(), text.size());
    return text;
  }

  /// [device 1] and lines of key=value.
  void read_metadata(const std::string& text) {
    const char* at = text.data();
    const char* const end = text.data() + text.size();
    std::uint64_t device = 0;
    while (at != end) {
      const std::string_view line = trimmed(take_line(at, end));
      constexpr std::string_view section = "[device ";
      if (line.starts_with('[')) {
        device = 0;
        if (line.starts_with(section))
          std::from_chars(line.data() + section.size(), line.data() + line.size(), device);
        continue;
      }
      const std::size_t equals = line.find('=');
      if (equals == std::string_view::npos) continue;
      const std::string_view key = trimmed(line.substr(0, equals));
      const std::string_view value = trimmed(line.substr(equals + 1));
      if (key == "samplerate") rates_.emplace(device, std::string(value));
      if (key == "sigrok version") head_.record.attributes["sigrok version"] = to_utf8(value);
      constexpr std::string_view analog = "analog";
      if (!key.starts_with(analog)) continue;
      std::uint64_t number = 0;
      const auto [stop, error] =
          std::from_chars(key.data() + analog.size(), key.data() + key.size(), number);
      if (error == std::errc{} && stop == key.data() + key.size())
        names_.emplace(std::pair(device, number), to_utf8(value));
    }
  }

  void list_entries() {
    for (std::uint64_t index = 0; index < archive_.entries(); ++index) {
      const std::string_view name = archive_.name(index);
      if (name.starts_with("logic-")) logic_ = true;
      const auto numbers = analog_numbers(name);
      if (!numbers) continue;
      const std::string shown = to_utf8(name);
      const std::uint64_t size = archive_.size(index, shown);
      if (size % sizeof(float) != 0)
        head_.record.warnings.push_back(fmt::format(
            "{} has {} bytes, no multiple of 4: the last ones are left out", shown, size));
      found_[{(*numbers)[0], (*numbers)[1]}].push_back(
          {(*numbers)[2], index, size / sizeof(float)});
    }
  }

  void describe(const ImportOptions& options) {
    Record& record = head_.record;
    if (!found_.empty()) check_stated_units(options.units, found_.size(), "channels", file_.path());
    for (auto& [which, parts] : found_) {
      const auto& [device, number] = which;
      std::ranges::sort(parts, {}, &Part::number);
      Channel channel;
      const auto name = names_.find(which);
      channel.name = name != names_.end() ? name->second : fmt::format("analog {}", number);
      if (device > 1) channel.attributes["device"] = fmt::format("{}", device);
      const std::size_t index = record.channels.size();
      if (index < options.units.size()) channel.unit = options.units[index];
      channel.quantity = datasets::quantity_of_unit(channel.unit);
      const auto rate = rates_.find(device);
      const double hertz = rate != rates_.end() ? rate_in(rate->second) : 0.0;
      if (hertz > 0.0)
        channel.clock.interval = 1.0 / hertz;
      else if (rate != rates_.end())
        channel.attributes[std::string(unusable_clock)] =
            fmt::format("a sample rate of '{}'", to_utf8(rate->second));
      if (rate != rates_.end()) channel.attributes["samplerate"] = to_utf8(rate->second);
      std::uint64_t samples = 0;
      bool in_order = true;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        samples += parts[i].samples;
        if (in_order && parts[i].number != i + 1)
          record.warnings.push_back(fmt::format(
              "'{}': part {} is not there once: what follows is out of time", channel.name, i + 1));
        in_order = in_order && parts[i].number == i + 1;
      }
      record.channels.push_back(std::move(channel));
      head_.samples.push_back(samples);
      parts_.push_back(std::move(parts));
    }
    if (logic_)
      record.warnings.emplace_back("the session has logic channels too: they are left out");
    if (record.channels.empty())
      record.warnings.emplace_back("there are no analog channels in this session");
    else if (options.units.empty())
      record.warnings.emplace_back(
          "a sigrok session holds no units of its analog channels: --units states them");
  }

  void hand_over(const std::vector<Part>& parts, const std::string& channel_name, SampleRange range,
                 std::size_t channel, SampleSink& sink) {
    std::uint64_t before = 0;  // samples of the parts before this one
    std::vector<float> samples(block_size);
    for (const Part& part : parts) {
      const std::uint64_t first = std::max(range.first, before) - before;
      const std::uint64_t last = std::min(std::max(range.last, before) - before, part.samples);
      before += part.samples;
      if (first >= last) continue;
      const std::string name = fmt::format("part {} of '{}'", part.number, channel_name);
      ZipArchive::Entry entry = archive_.open(part.entry, name);
      for (std::uint64_t at = 0; at < last;) {
        // what lies before the window has to be unpacked too
        const std::uint64_t stop = at < first ? first : last;
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(block_size, stop - at));
        read_floats(entry, samples.data(), count);
        if (at >= first) {
          SampleBlock block;
          block.raw = std::span<const float>(samples.data(), count);
          sink.take(channel, block);
        }
        at += count;
      }
      if (last == part.samples) entry.check_sum();
    }
  }

  static void read_floats(ZipArchive::Entry& entry, float* to, std::size_t count) {
    entry.read(to, count * sizeof(float));
    if constexpr (std::endian::native == std::endian::big)
      for (std::size_t i = 0; i < count; ++i) {
        auto* const sample = reinterpret_cast<char*>(to + i);
        std::reverse(sample, sample + sizeof(float));
      }
  }

  MappedFile file_;
  ZipArchive archive_{file_};
  std::map<std::uint64_t, std::string> rates_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> names_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::vector<Part>> found_;
  bool logic_ = false;
  RecordingHead head_;
  std::vector<std::vector<Part>> parts_;  ///< one a channel
};

}  // namespace

int recognises_sigrok(std::string_view file_name, std::string_view head) {
  if (!head.starts_with(std::string_view("PK\x03\x04", 4))) return 0;
  // the name of the first entry stands behind its header of 30 bytes; "version" comes first
  if (head.size() > 37 && head.substr(26, 2) == std::string_view("\x07\x00", 2) &&
      head.substr(30, 7) == "version")
    return 90;
  return file_name.ends_with(".sr") ? 60 : 0;
}

std::unique_ptr<RecordingReader> open_sigrok(const std::string& path,
                                             const ImportOptions& options) {
  return std::make_unique<SigrokReader>(path, options);
}

}  // namespace impactrig::acquisition
