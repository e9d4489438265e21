// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>

#include "acquisition/importers/clock_words.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/mat4.hpp"
#include "acquisition/importers/mat_contents.hpp"
#include "acquisition/importers/mat_labels.hpp"
#include "acquisition/importers/mat_programs.hpp"
#include "acquisition/importers/mat_recording.hpp"
#include "acquisition/importers/named_arrays.hpp"
#include "acquisition/importers/stated_units.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

constexpr std::uint64_t most_channels = 1000;  ///< of one matrix
constexpr std::size_t longest_text = 2000;     ///< of an attribute [bytes]

/// Numbers of an array from one of them on, which `offset` would be the place of the first of.
StoredNumbers numbers(const MatArray& array, NumberKind kind, bool big_endian, std::uint64_t offset,
                      std::uint64_t first, std::uint64_t count, std::uint64_t step) {
  const std::uint64_t stride = array.stride > 0 ? array.stride : size_of(kind);
  StoredNumbers stored(kind, big_endian != array.other_order);
  stored.add({offset + first * stride, count, step * stride, 1, 0});
  return stored;
}

/// What a channel is called, the name by which its clock is looked for, and its unit.
struct Label {
  std::string name, array_name, unit;
};

Label label_of(const std::string& array) {
  return {array, array, unit_by_name(array)};
}

/// A column that a text names: "v (m/s)".
Label label_of(const std::string& array, const std::string& column) {
  const ColumnHead head = split_head(column);
  std::string word = head.name;
  std::ranges::replace_if(
      word, [](char c) { return c == '.' || c == '/'; }, '_');
  return {fmt::format("{}.{}", array, column), fmt::format("{}.{}", array, word), head.unit};
}

/// Makes channels of arrays.
class MatRecord {
 public:
  explicit MatRecord(MatContents contents) : contents_(std::move(contents)) {
    if (!contents_.version.empty()) record_.attributes["MAT-file version"] = contents_.version;
    if (!contents_.header.empty()) record_.attributes["header"] = contents_.header;
    for (const auto& [name, text] : contents_.texts)
      record_.attributes.emplace(name, to_utf8(std::string_view(text).substr(0, longest_text)));
    record_.warnings = std::move(contents_.warnings);
    if (std::string skipped = skipped_arrays(contents_); !skipped.empty())
      record_.warnings.push_back(std::move(skipped));
    for (const MatArray& array : contents_.arrays) add(array);
    tell_of_scales();
    if (record_.channels.empty())
      record_.warnings.emplace_back("there are no numbers in this file: there are no channels");
  }

  std::unique_ptr<RecordingReader> reader(const ImportOptions& options) {
    take_stated_units(options.units, contents_.file->path(), record_);
    set_clocks(options);
    return reader_of_numbers(std::move(contents_.file), std::move(record_), std::move(stored_));
  }

 private:
  void add(const MatArray& array) {
    if (array.dimensions > 2 && array.count > 1)
      record_.warnings.push_back(fmt::format(
          "'{}' has {} dimensions: its {} numbers are one channel, in the order they are "
          "stored, not one channel a column; save a matrix for that",
          array.name, array.dimensions, array.count));
    const std::uint64_t longer = std::max(array.rows, array.columns);
    const std::uint64_t shorter = std::min(array.rows, array.columns);
    const std::vector<std::string> names = labels_.channels_of(array.name, shorter);
    const bool small = longer <= longest_small_matrix &&
                       !labels_.rows_are_samples(array.rows, array.columns, !names.empty());
    if (shorter < 2 || shorter > most_channels || small) {
      if (small && is_told_of_small(array.rows, array.columns))
        record_.warnings.push_back(told_of_small(array.name, array.rows, array.columns));
      return add_channel(array, label_of(array.name), 0, array.count, 1);
    }
    const bool by_columns = array.rows >= array.columns;
    const std::vector<std::string> units = labels_.units_of(array.name, shorter);
    for (std::uint64_t i = 0; i < shorter; ++i) {
      Label label = names.empty() ? label_of(fmt::format("{}:{}", array.name, i + 1))
                                  : label_of(array.name, names[i]);
      if (label.unit.empty() && !units.empty()) label.unit = units[i];
      const std::uint64_t first = by_columns ? i * array.rows : i;
      if (first >= array.count) break;
      const std::uint64_t left = array.count - first;
      add_channel(array, label, first,
                  by_columns ? std::min(array.rows, left) : (left - 1) / array.rows + 1,
                  by_columns ? 1 : array.rows);
    }
  }

  void add_channel(const MatArray& array, const Label& label, std::uint64_t first,
                   std::uint64_t count, std::uint64_t step) {
    Channel channel;
    channel.name = label.name;
    channel.unit = label.unit;
    array_names_.push_back(label.array_name);
    if (channel.unit.empty()) channel.unit = labels_.unit_of(array.name);
    channel.quantity = datasets::quantity_of_unit(channel.unit);
    channel.attributes["size"] =
        fmt::format("{} x {}", array.transposed ? array.columns : array.rows,
                    array.transposed ? array.rows : array.columns);
    StoredChannel stored;
    stored.samples =
        numbers(array, array.kind, contents_.big_endian, array.offset, first, count, step);
    if (array.complex)
      stored.imaginary = numbers(array, array.imaginary_kind, contents_.big_endian,
                                 array.imaginary_offset, first, count, step);
    record_.channels.push_back(std::move(channel));
    stored_.push_back(std::move(stored));
  }

  /// Of integers beside numbers that are called so: what they mean is not known.
  void tell_of_scales() {
    constexpr auto words = std::to_array<std::string_view>(
        {"scale", "scalefactor", "scale_factor", "gain", "slope", "sensitivity", "offset"});
    std::map<std::string_view, std::vector<std::string_view>> scales;  // by group
    const auto group_of = [](std::string_view name) {
      const std::size_t end = end_of_group(name);
      return name.substr(0, end == name.npos ? 0 : end);
    };
    for (const MatArray& array : contents_.arrays)
      if (array.count == 1 && std::ranges::find(words, last_word(array.name)) != words.end())
        scales[group_of(array.name)].push_back(array.name);
    for (const MatArray& array : contents_.arrays) {
      const bool integers = array.kind != NumberKind::f32 && array.kind != NumberKind::f64;
      const auto beside = scales.find(group_of(array.name));
      if (array.count < 2 || !integers || beside == scales.end()) continue;
      record_.warnings.push_back(fmt::format(
          "'{}' holds integers, and '{}' beside it {} not applied: a map's sensitivity and unit "
          "state what they mean",
          array.name, fmt::join(beside->second, "', '"), beside->second.size() > 1 ? "are" : "is"));
      scales.erase(beside);  // once
    }
  }

  void set_clocks(const ImportOptions& options) {
    std::vector<NamedArray> arrays;
    for (std::size_t i = 0; i < stored_.size(); ++i) {
      arrays.push_back(
          {array_names_[i], stored_[i].samples.size(), stored_[i].imaginary.size() == 0});
      take_unit(arrays.back(), record_.channels[i].unit);
      tell_times_of_program(facts(), arrays.back());
    }
    ArrayClocks found = clocks_by_name(
        contents_.file->path(), arrays,
        [this](std::size_t i, const NumberRange& range, const auto& use) {
          each_number(*contents_.file, stored_[i].samples, range.first, range.count, use);
        },
        options);
    for (std::size_t i = 0; i < stored_.size(); ++i) {
      const ArrayClock& clock = found.clocks[i];
      record_.channels[i].clock.start = clock.start;
      record_.channels[i].clock.interval = clock.interval;
      set_attribute(record_.channels[i], unusable_clock, clock.unusable);
      if (!clock.times) continue;
      stored_[i].times = stored_[*clock.times].samples;
      const double seconds = clock.seconds;
      if (seconds == 1.0) continue;
      stored_[i].times_scaling = [seconds](std::span<double> times) {
        for (double& time : times) time *= seconds;
      };
    }
    if (!options.time_column) take_interval_of_text();
    const bool stated = options.time_column && *options.time_column != "none";
    for (std::size_t i = 0; i < stored_.size(); ++i)
      if (arrays[i].samples > 1)
        take_facts_of_program(facts(),
                              !stated && !found.clocks[i].times && found.clocks[i].interval == 0.0,
                              record_.channels[i], record_);
    for (std::string& warning : found.warnings) record_.warnings.push_back(std::move(warning));
    if (found.time_column.empty()) return;
    record_.attributes["time column"] = found.time_column;
    const auto unit = contents_.texts.find("horizontalUnits");
    const bool in_seconds = unit != contents_.texts.end() && unit->second == "s";
    if (!in_seconds && !found.without_unit.empty())
      record_.warnings.push_back(
          fmt::format("the time is taken as s, since no unit is stated: {}", found.without_unit));
  }

  /// "SamplingRate" as a text at the top, where nothing else tells a clock.
  void take_interval_of_text() {
    for (const auto& [name, text] : contents_.texts) {
      const auto interval = interval_by_name(name, text);
      if (!interval || name.find_first_of(".{(") != name.npos) continue;
      for (std::size_t i = 0; i < stored_.size(); ++i) {
        Channel& channel = record_.channels[i];
        const bool open = stored_[i].times.size() == 0 && channel.clock.interval == 0.0 &&
                          !channel.attributes.contains(std::string(unusable_clock));
        if (!open || stored_[i].samples.size() < 2) continue;
        channel.clock.interval = *interval;
        record_.attributes["time column"] =
            fmt::format("{} (an interval of {:.9g} s by its text)", name, *interval);
      }
      return;
    }
  }

  MatFacts facts() const {
    const auto number = [this](const std::string& name) -> std::optional<double> {
      const auto found = std::ranges::find(contents_.arrays, name, &MatArray::name);
      if (found == contents_.arrays.end() || found->count != 1 || found->complex)
        return std::nullopt;
      double value = 0.0;
      StoredNumbers one(found->kind, contents_.big_endian != found->other_order);
      one.add({found->offset, 1, size_of(found->kind)});
      read_numbers(*contents_.file, one, 0, {&value, 1});
      return value;
    };
    const auto text = [this](const std::string& name) {
      const auto found = contents_.texts.find(name);
      return found == contents_.texts.end() ? std::string() : found->second;
    };
    return {number, text};
  }

  MatContents contents_;
  MatLabels labels_{contents_};
  Record record_;
  std::vector<std::string> array_names_;  ///< of the channels
  std::vector<StoredChannel> stored_;
};

}  // namespace

int recognises_mat(std::string_view file_name, std::string_view head) {
  if (head.starts_with("MATLAB 5.0 MAT-file") || head.starts_with("MATLAB 7.")) return 100;
  // version 5 as others write it: any text, then version and byte order
  if (head.size() >= 128 && (head.substr(124, 4) == std::string_view("\x00\x01IM", 4) ||
                             head.substr(124, 4) == std::string_view("\x01\x00MI", 4)))
    return 90;
  if (!looks_like_mat4(head)) return 0;
  return file_name.ends_with(".mat") || file_name.ends_with(".MAT") ? 90 : 60;
}

std::unique_ptr<RecordingReader> open_mat(const std::string& path, const ImportOptions& options) {
  {
    const MappedFile file(path);
    constexpr std::string_view hdf5 = "\x89HDF\r\n\x1a\n";
    if (file.bytes().starts_with(hdf5) ||
        (file.bytes().size() > 512 && file.bytes().substr(512).starts_with(hdf5)))
      return open_mat73(path, options);
  }
  MatContents contents = read_mat_contents(path);
  if (is_mat_recording(contents))
    return reader_of_mat_recording(std::move(contents), options.units);
  return reader_of_mat_contents(std::move(contents), options);
}

std::unique_ptr<RecordingReader> reader_of_mat_contents(MatContents contents,
                                                        const ImportOptions& options) {
  return MatRecord(std::move(contents)).reader(options);
}

}  // namespace impactrig::acquisition
