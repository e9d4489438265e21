// SPDX-License-Identifier: BSD-3-Clause
// HDF5 files of other programs, and MAT-files of version 7.3, which are HDF5 behind 512 bytes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/hdf5_arrays.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/named_arrays.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/input_error.hpp"
#include "datasets/store.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

constexpr std::uint64_t longest_small_matrix = 100;  ///< of a MAT-file: as in versions 4 and 5
constexpr std::uint64_t most_columns = 1000;

std::string_view parent_of(std::string_view path) {
  const std::size_t end = path.find_last_of('/');
  return end == 0 || end == std::string_view::npos ? std::string_view("/") : path.substr(0, end);
}

/// Copies what it is handed of one channel as doubles.
class Doubles final : public SampleSink {
 public:
  void take(std::size_t, const SampleBlock& block) override {
    std::visit(
        [this](auto samples) {
          for (const auto sample : samples) values.push_back(static_cast<double>(sample));
        },
        block.raw);
  }

  void take_times(std::size_t, std::span<const double>) override {}

  std::vector<double> values;
};

/// Hands numbers on as they come.
class EachBlock final : public SampleSink {
 public:
  using Use = std::function<void(std::span<const double>)>;

  explicit EachBlock(const Use& use) : use_(use) {}

  void take(std::size_t, const SampleBlock& block) override {
    std::visit(
        [this](auto samples) {
          numbers_.assign(samples.begin(), samples.end());
          use_(numbers_);
        },
        block.raw);
  }

  void take_times(std::size_t, std::span<const double>) override {}

 private:
  const Use& use_;
  std::vector<double> numbers_;
};

void each_number_of(const std::string& path, const Hdf5Slice& slice, const EachBlock::Use& use) {
  EachBlock sink(use);
  read_hdf5_slices(path, {slice}, sink);
}

/// A number among attributes, by the first of these names.
template <std::size_t N>
std::optional<double> number_of(const Hdf5Attributes& attributes,
                                const std::array<std::string_view, N>& names) {
  for (const auto& [key, value] : attributes.numbers)
    if (std::ranges::find(names, lowered(key)) != names.end() && std::isfinite(value)) return value;
  return std::nullopt;
}

/// The same in a unit, which "fs_units" may state, or from a text: "51.2 kHz".
template <std::size_t N>
std::optional<double> quantity_of(const Hdf5Attributes& attributes,
                                  const std::array<std::string_view, N>& names,
                                  const std::string& unit) {
  for (const auto& [key, value] : attributes.numbers) {
    if (std::ranges::find(names, lowered(key)) == names.end() || !std::isfinite(value)) continue;
    for (const std::string_view ending : {"_units", "_unit"}) {
      const auto stated = attributes.texts.find(key + std::string(ending));
      if (stated == attributes.texts.end()) continue;
      if (const auto conversion = datasets::conversion(stated->second, unit))
        return conversion->factor * value;
    }
    return value;
  }
  for (const auto& [key, text] : attributes.texts) {
    if (std::ranges::find(names, lowered(key)) == names.end()) continue;
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const char* const behind = scan_number(text.data(), end, {}, value);
    if (behind == text.data()) continue;
    const std::string_view stated =
        trimmed(std::string_view(behind, static_cast<std::size_t>(end - behind)));
    if (stated.empty()) return value;
    if (const auto conversion = datasets::conversion(std::string(stated), unit))
      return conversion->factor * value;
  }
  return std::nullopt;
}

/// "us" of "/run/time_us" and "N" of "/run/Force [N]"; "" where the name does not end so.
std::string unit_in_name(std::string_view name) {
  return split_head(name.substr(name.find_last_of("./") + 1)).unit;
}

class ForeignReader final : public RecordingReader {
 public:
  ForeignReader(const std::string& path, const ImportOptions& options, bool matlab)
      : path_(path),
        matlab_(matlab),
        listing_(list_hdf5(path)) {
    Record& record = head_.record;
    record.provenance.importer = matlab ? "mat" : "hdf5";
    if (matlab) record.attributes["MAT-file version"] = "7.3";
    const auto root = listing_.groups.find("/");
    if (root != listing_.groups.end()) {
      for (const auto& [key, text] : root->second.texts) record.attributes.emplace(key, text);
      for (const auto& [key, value] : root->second.numbers)
        record.attributes.emplace(key, fmt::format("{}", value));
    }
    if (matlab) forget_internals();
    take_texts();
    for (const Hdf5Array& array : listing_.arrays) add(array);
    set_clocks(options);
    if (!matlab) numbers_to_attributes();
    tell_skipped();
    if (record.channels.empty())
      record.warnings.emplace_back("there are no data sets of numbers: there are no channels");
    for (const Hdf5Slice& slice : slices_) head_.samples.push_back(slice.count);
  }

  const RecordingHead& head() const override { return head_; }

  bool is_own() const {
    const auto root = listing_.groups.find("/");
    if (root == listing_.groups.end()) return false;
    const auto format = root->second.texts.find("format");
    return format != root->second.texts.end() && format->second == "impactrig-recording";
  }

  Record read(const Selection& wanted, SampleSink& sink) override {
    Record record = head_.record;
    record.channels.clear();
    std::vector<Hdf5Slice> slices;
    for (const std::size_t index : selected_channels(head_, wanted)) {
      Channel channel = head_.record.channels[index];
      Hdf5Slice slice = slices_[index];
      const SampleRange range = slice.times == nullptr
                                    ? samples_within(channel.clock, slice.count, wanted)
                                    : range_of_times(slice, wanted, channel.clock);
      if (slice.times == nullptr)
        channel.clock.start += channel.clock.interval * static_cast<double>(range.first);
      slice.first = range.first;
      slice.count = range.last - range.first;
      slices.push_back(slice);
      record.channels.push_back(std::move(channel));
    }
    const std::vector<Hdf5SliceSeen> seen = read_hdf5_slices(path_, slices, sink);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const std::string& name = record.channels[i].name;
      if (seen[i].missing > 0)
        record.warnings.push_back(
            fmt::format("'{}': {} of {} samples are {}, which stands for none; "
                        "marked as not valid",
                        name, seen[i].missing, slices[i].count, *slices[i].missing));
      if (std::string wide = seen[i].wide.warning(name); !wide.empty())
        record.warnings.push_back(std::move(wide));
    }
    return record;
  }

 private:
  /// "/run/force" as MATLAB writes it: "run.force"; of records "/run/table.force".
  std::string name_of(const Hdf5Array& array) const {
    std::string name = array.path;
    if (!array.field.empty()) name += "." + array.field;
    if (matlab_) {
      name.erase(0, 1);
      std::ranges::replace(name, '/', '.');
    }
    return to_utf8(name);
  }

  /// Texts beside the data are facts about them; NeXus has the title and start so.
  void take_texts() {
    Record& record = head_.record;
    for (const auto& [path, text] : listing_.texts) {
      if (text.empty() || (matlab_ && path.starts_with("/#"))) continue;
      record.attributes.emplace(path, text);
      if (path.ends_with("/title") && record.title.empty()) record.title = text;
      if (path.ends_with("/start_time") && record.started.empty()) record.started = text;
    }
  }

  void forget_internals() {
    const auto internal = [](std::string_view path) {
      return path.starts_with("/#") || path.starts_with("'/#");
    };
    std::erase_if(listing_.arrays,
                  [&internal](const Hdf5Array& array) { return internal(array.path); });
    std::erase_if(listing_.skipped,
                  [&internal](const std::string& text) { return internal(text); });
  }

  void add(const Hdf5Array& array) {
    const std::string name = name_of(array);
    const auto& shape = array.shape;
    if (matlab_ && array.attributes.texts.contains("MATLAB_class") &&
        array.attributes.texts.at("MATLAB_class") == "char") {
      if (array.text.empty())
        listing_.skipped.push_back(fmt::format("'{}' (text)", name));
      else
        head_.record.attributes.emplace(name, array.text);
      return;
    }
    if (array.attributes.numbers.contains("MATLAB_empty")) {
      listing_.skipped.push_back(fmt::format("'{}' (empty)", name));
      return;
    }
    if (shape.size() > 2 && !matlab_) {
      listing_.skipped.push_back(fmt::format("'{}' ({} dimensions)", name, shape.size()));
      return;
    }
    if (shape.size() != 2) return add_channel(array, name, true, 0, 0);
    const std::size_t along = shape[0] >= shape[1] ? 0 : 1;
    const std::uint64_t columns = shape[1 - along];
    const bool flat =
        columns == 1 || columns > most_columns || (matlab_ && shape[along] <= longest_small_matrix);
    if (flat && columns > most_columns && !matlab_) {
      listing_.skipped.push_back(
          fmt::format("'{}' ({} columns, at most {} are read)", name, columns, most_columns));
      return;
    }
    if (flat) return add_channel(array, name, true, 0, 0);
    const std::vector<std::string>* const names = column_names(array, columns);
    for (std::uint64_t c = 0; c < columns; ++c)
      add_channel(array,
                  names == nullptr ? fmt::format("{}:{}", name, c + 1) : name + "." + (*names)[c],
                  false, along, c);
  }

  /// The names that an attribute gives the columns; null where none does, or two are the same.
  static const std::vector<std::string>* column_names(const Hdf5Array& array,
                                                      std::uint64_t columns) {
    constexpr std::array<std::string_view, 9> keys = {"columns",  "column_names",  "columnnames",
                                                      "channels", "channel_names", "channelnames",
                                                      "names",    "labels",        "fields"};
    for (const auto& [key, list] : array.attributes.lists) {
      if (list.size() != columns || std::ranges::find(keys, lowered(key)) == keys.end()) continue;
      const std::set<std::string> different(list.begin(), list.end());
      if (different.size() == list.size() && !different.contains("")) return &list;
    }
    return nullptr;
  }

  /// The unit that an attribute states, for all or one by one.
  static std::string unit_of(const Hdf5Attributes& attributes, std::uint64_t which) {
    const auto is_unit = [](std::string_view key) {
      const std::string word = lowered(key);
      return word == "units" || word == "unit" || word == "unit_string";
    };
    for (const auto& [key, text] : attributes.texts)
      if (is_unit(key)) return text;
    for (const auto& [key, list] : attributes.lists)
      if (is_unit(key) && which < list.size()) return list[which];
    return {};
  }

  /// What the NetCDF conventions say of numbers that stand for others.
  static void take_packing(const Hdf5Attributes& attributes, Channel& channel, Hdf5Slice& slice) {
    constexpr std::array<std::string_view, 1> factor = {"scale_factor"};
    constexpr std::array<std::string_view, 1> offset = {"add_offset"};
    constexpr std::array<std::string_view, 2> missing = {"_fillvalue", "missing_value"};
    channel.scale = number_of(attributes, factor).value_or(1.0);
    channel.offset = number_of(attributes, offset).value_or(0.0);
    slice.missing = number_of(attributes, missing);
  }

  void add_channel(const Hdf5Array& array, const std::string& name, bool whole, std::size_t along,
                   std::uint64_t other) {
    Channel channel;
    channel.name = name;
    for (const auto& [key, text] : array.attributes.texts) channel.attributes.emplace(key, text);
    for (const auto& [key, value] : array.attributes.numbers)
      channel.attributes.emplace(key, fmt::format("{}", value));
    std::string size;
    for (std::size_t d = 0; d < array.shape.size(); ++d) {
      const std::size_t which = matlab_ ? array.shape.size() - 1 - d : d;
      size += fmt::format("{}{}", d == 0 ? "" : " x ", array.shape[which]);
    }
    channel.attributes.emplace("size", size.empty() ? "1" : size);
    channel.unit = unit_of(array.attributes, array.field.empty() ? other : array.field_index);
    if (channel.unit.empty()) channel.unit = unit_in_name(name);
    // "milliseconds since 2024-03-01 12:00", as NetCDF has it
    channel.unit.resize(std::min(channel.unit.find(" since "), channel.unit.size()));
    channel.quantity = datasets::quantity_of_unit(channel.unit);
    Hdf5Slice slice;
    slice.array = &array;
    slice.whole = whole;
    slice.along = along;
    slice.other = other;
    slice.count = 1;
    if (whole)
      for (const std::uint64_t side : array.shape) slice.count *= side;
    else
      slice.count = array.shape[along];
    if (!array.complex) take_packing(array.attributes, channel, slice);
    head_.record.channels.push_back(std::move(channel));
    slices_.push_back(slice);
  }

  /// What attributes of a data set, or of a group around it, say of its clock.
  static bool by_attributes(const Hdf5Attributes& attributes, datasets::SampleClock& clock) {
    constexpr std::array<std::string_view, 6> intervals = {
        "dt", "wf_increment", "sample_interval", "sampling_interval", "delta_t", "sampleinterval"};
    constexpr std::array<std::string_view, 7> rates = {
        "fs",           "sample_rate",        "sampling_rate",   "samplerate",
        "samplingrate", "sampling_frequency", "sample_frequency"};
    constexpr std::array<std::string_view, 4> starts = {"wf_start_offset", "t0", "start_time",
                                                        "start"};
    const auto interval = quantity_of(attributes, intervals, "s");
    const auto rate = quantity_of(attributes, rates, "Hz");
    if (interval && *interval > 0.0)
      clock.interval = *interval;
    else if (rate && *rate > 0.0 && std::isfinite(1.0 / *rate))
      clock.interval = 1.0 / *rate;
    else
      return false;
    clock.start = quantity_of(attributes, starts, "s").value_or(0.0);
    return true;
  }

  /// NeXus: a group NXdata names its axes.
  bool is_axis(const Hdf5Array& array) const {
    const auto group = listing_.groups.find(std::string(parent_of(array.path)));
    if (group == listing_.groups.end()) return false;
    const auto& texts = group->second.texts;
    const auto axes = texts.find("axes");
    const std::string_view path = array.path;
    return axes != texts.end() && axes->second == path.substr(path.find_last_of('/') + 1);
  }

  void set_clocks(const ImportOptions& options) {
    std::vector<NamedArray> arrays;
    for (std::size_t i = 0; i < slices_.size(); ++i) {
      const Hdf5Array& array = *slices_[i].array;
      NamedArray named{head_.record.channels[i].name, slices_[i].count, !array.complex};
      const std::string& unit = head_.record.channels[i].unit;
      if (!unit.empty()) {
        const auto conversion = datasets::conversion(unit, "s");
        named.time = is_axis(array) && conversion.has_value();
        named.real = named.real && (conversion.has_value() || slices_[i].count == 1);
        if (conversion) named.seconds = conversion->factor;
        if (const auto rate = datasets::conversion(unit, "Hz")) named.seconds = 1.0 / rate->factor;
      } else {
        named.time = is_axis(array);
      }
      arrays.push_back(std::move(named));
    }
    const ArrayClocks found = clocks_by_name(
        path_, arrays,
        [this](std::size_t i, const auto& use) {
          const Channel& channel = head_.record.channels[i];
          each_number_of(path_, slices_[i], [&](std::span<const double> numbers) {
            std::vector<double> values(numbers.begin(), numbers.end());
            for (double& value : values) value = channel.scale * value + channel.offset;
            use(values);
          });
        },
        options);
    for (const std::string& warning : found.warnings) head_.record.warnings.push_back(warning);
    if (!found.time_column.empty()) head_.record.attributes["time column"] = found.time_column;
    for (std::size_t i = 0; i < slices_.size(); ++i) {
      datasets::SampleClock& clock = head_.record.channels[i].clock;
      const bool stated = options.time_column && found.clocks[i].interval > 0.0;
      if (!stated && by_attributes(slices_[i].array->attributes, clock)) continue;
      clock.start = found.clocks[i].start;
      clock.interval = found.clocks[i].interval;
      if (found.clocks[i].times) {
        const std::size_t times = *found.clocks[i].times;
        Hdf5Slice slice = slices_[times];
        slice.times = nullptr;
        slices_[i].times = std::make_shared<const Hdf5Slice>(slice);
        slices_[i].time_factor = arrays[times].seconds * head_.record.channels[times].scale;
        slices_[i].time_offset = arrays[times].seconds * head_.record.channels[times].offset;
      }
      if (clock.interval > 0.0) continue;
      for (std::string_view group = parent_of(slices_[i].array->path);; group = parent_of(group)) {
        const auto attributes = listing_.groups.find(std::string(group));
        if (attributes != listing_.groups.end() && by_attributes(attributes->second, clock)) break;
        if (group == "/") break;
      }
    }
    tell_unit_of_time(found, arrays);
  }

  void tell_unit_of_time(const ArrayClocks& found, const std::vector<NamedArray>& arrays) {
    if (found.time_column.empty()) return;
    for (std::size_t i = 0; i < arrays.size(); ++i)
      if (!head_.record.channels[i].unit.empty() &&
          found.time_column.find(arrays[i].name + " (") != std::string::npos)
        return;
    head_.record.warnings.push_back(
        fmt::format("the time is taken as s, since no unit is stated: {}", found.time_column));
  }

  /// Single numbers beside the data are facts about them, not recordings.
  void numbers_to_attributes() {
    std::vector<Hdf5Slice> single;
    std::vector<std::string> names;
    std::vector<Channel> channels;
    std::vector<Hdf5Slice> slices;
    for (std::size_t i = 0; i < slices_.size(); ++i) {
      Channel& channel = head_.record.channels[i];
      if (slices_[i].array->shape.empty()) {
        single.push_back(slices_[i]);
        names.push_back(channel.name);
      } else {
        channels.push_back(std::move(channel));
        slices.push_back(slices_[i]);
      }
    }
    head_.record.channels = std::move(channels);
    slices_ = std::move(slices);
    if (single.empty()) return;
    Doubles sink;  // one sample each, in their order
    read_hdf5_slices(path_, single, sink);
    for (std::size_t i = 0; i < names.size() && i < sink.values.size(); ++i)
      head_.record.attributes.emplace(names[i], fmt::format("{}", sink.values[i]));
  }

  void tell_skipped() {
    std::string list;
    std::size_t more = 0;
    for (const std::string& text : listing_.skipped) {
      if (list.size() > 500)
        ++more;
      else
        list += (list.empty() ? "" : ", ") + text;
    }
    if (more > 0) list += fmt::format(" and {} more", more);
    if (!list.empty()) head_.record.warnings.push_back("not read: " + list);
  }

  SampleRange range_of_times(const Hdf5Slice& slice, const Selection& wanted,
                             datasets::SampleClock& clock) const {
    if (!wanted.has_window()) return {0, slice.count};
    TimeWindow found(wanted);
    std::vector<double> times;
    each_number_of(path_, *slice.times, [&](std::span<const double> numbers) {
      times.assign(numbers.begin(), numbers.end());
      for (double& time : times) time = slice.time_factor * time + slice.time_offset;
      found.add(times);
    });
    found.settle(clock);
    return found.range();
  }

  std::string path_;
  bool matlab_;
  Hdf5Listing listing_;
  RecordingHead head_;
  std::vector<Hdf5Slice> slices_;  ///< one a channel
};

/// Where the HDF5 file begins: behind a user block of 0, 512, 1024, ... bytes; none when it does
/// not within the first 64 KiB.
bool has_hdf5_signature(std::string_view head) {
  for (std::size_t at = 0; at < head.size(); at = at == 0 ? 512 : 2 * at)
    if (datasets::looks_like_hdf5(head.substr(at))) return true;
  return false;
}

}  // namespace

int recognises_foreign_hdf5(std::string_view, std::string_view head) {
  return has_hdf5_signature(head) ? 90 : 0;
}

std::unique_ptr<RecordingReader> open_foreign_hdf5(const std::string& path,
                                                   const ImportOptions& options) {
  const MappedFile file(path);
  if (!has_hdf5_signature(file.bytes().substr(0, 65536)))
    throw datasets::InputError(file.byte_position(0),
                               "expected the signature of HDF5 at byte 0, 512, 1024, ...");
  auto reader = std::make_unique<ForeignReader>(path, options, false);
  if (reader->is_own()) return open_hdf5(path, options);
  return reader;
}

std::unique_ptr<RecordingReader> open_mat73(const std::string& path, const ImportOptions& options) {
  return std::make_unique<ForeignReader>(path, options, true);
}

}  // namespace impactrig::acquisition
