// SPDX-License-Identifier: BSD-3-Clause
// HDF5 files of other programs, and MAT-files of version 7.3, which are HDF5 behind 512 bytes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/hdf5_arrays.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/named_arrays.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
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

/// "t", "time", "time2", "t_us", "zeit".
bool named_like_a_time(std::string_view path) {
  const std::string word = lowered(path.substr(path.find_last_of("./") + 1));
  return word == "t" || word == "tvec" || word.starts_with("t_") || word.starts_with("time") ||
         word.starts_with("zeit");
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
    for (const Hdf5Array& array : listing_.arrays)
      if (array.reference != 0 && array.field.empty())
        by_reference_.emplace(array.reference, &array);
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
  void warn(std::string sentence) {
    auto& warnings = head_.record.warnings;
    if (std::ranges::find(warnings, sentence) == warnings.end())
      warnings.push_back(std::move(sentence));
  }

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

  /// The same of all fields of records.
  std::string name_of_set(const Hdf5Array& array) const {
    Hdf5Array whole;
    whole.path = array.path;
    return name_of(whole);
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
    const std::size_t along = along_of(array);
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

  /// The dimension that is time: the one whose scale says so, else the longer.
  std::size_t along_of(const Hdf5Array& array) const {
    const std::size_t longer = array.shape[0] >= array.shape[1] ? 0 : 1;
    const std::size_t other = 1 - longer;
    const bool is_other = array.shape[other] > 1 &&
                          scale_along(array, other).kind == ScaleKind::time &&
                          scale_along(array, longer).kind != ScaleKind::time;
    return is_other ? other : longer;
  }

  /// What the scale of a dimension holds.
  enum class ScaleKind { none, unknown, other, time };

  struct Scale {
    ScaleKind kind = ScaleKind::none;
    const Hdf5Array* array = nullptr;
  };

  /// The scale of a dimension, and among several one of time.
  Scale scale_along(const Hdf5Array& array, std::size_t dimension) const {
    Scale best;
    if (dimension >= array.scales.size()) return best;
    for (const std::uint64_t reference : array.scales[dimension]) {
      const auto found = by_reference_.find(reference);
      if (found == by_reference_.end() || found->second == &array) continue;
      const Hdf5Array& scale = *found->second;
      // what was deleted may have left its place to another
      if (!is_scale(scale.attributes)) continue;
      if (scale.shape.size() != 1 || scale.shape[0] != array.shape[dimension] || scale.complex)
        continue;
      const ScaleKind kind = kind_of(scale);
      if (kind > best.kind) best = {kind, &scale};
    }
    return best;
  }

  static bool is_scale(const Hdf5Attributes& attributes) {
    const auto kind = attributes.texts.find("CLASS");
    return kind != attributes.texts.end() && kind->second == "DIMENSION_SCALE";
  }

  ScaleKind kind_of(const Hdf5Array& scale) const {
    if (!packing_of(scale, 0, 1).problem.empty()) return ScaleKind::unknown;
    const std::string unit = unit_of(scale, name_of(scale), 0, 1);
    if (datasets::conversion(unit, "s")) return ScaleKind::time;
    if (unit.empty()) return named_like_a_time(scale.path) ? ScaleKind::time : ScaleKind::unknown;
    const datasets::Quantity quantity = datasets::quantity_of_unit(unit);
    const bool understood =
        quantity != datasets::Quantity::unknown && quantity != datasets::Quantity::other;
    return understood ? ScaleKind::other : ScaleKind::unknown;
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

  /// Undoes what the NetCDF conventions pack. What cannot be undone is not in its unit.
  void take_packing(const Hdf5Array& array, std::uint64_t which, std::uint64_t columns,
                    Channel& channel, Hdf5Slice& slice) {
    const Hdf5Packing packing = packing_of(array, which, columns);
    channel.scale = packing.scale;
    channel.offset = packing.offset;
    if (!packing.problem.empty()) {
      channel.unit.clear();
      still_packed_.insert(slices_.size());
      warn(fmt::format("'{}': {}: its numbers are as they are stored, without a unit",
                       name_of_set(array), packing.problem));
    }
    constexpr std::array<std::string_view, 2> missing = {"_fillvalue", "missing_value"};
    if (!array.complex) slice.missing = number_of(array.attributes, missing);
  }

  /// What is there and is not applied, where a unit makes the numbers look like a measurement.
  void tell_unapplied(const Hdf5Array& array, std::uint64_t columns, const std::string& unit) {
    for (const auto& [key, list] : array.attributes.lists)
      if (is_unit_key(key) && list.size() != columns)
        warn(fmt::format("'{}': its attribute '{}' lists {} units, not {}: none is used",
                         name_of_set(array), key, list.size(), columns));
    const std::string names = unapplied_scales(array.attributes);
    if (unit.empty() || names.empty()) return;
    const bool several = names.find("', '") != std::string::npos;
    warn(
        fmt::format("'{}': its attribute{} {} {} not applied: its numbers are taken in {} as they "
                    "are stored",
                    name_of_set(array), several ? "s" : "", names, several ? "are" : "is", unit));
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
    const bool is_field = !array.field.empty();
    const std::uint64_t which = is_field ? array.field_index : other;
    const std::uint64_t columns = is_field ? array.fields : whole ? 1 : array.shape[1 - along];
    channel.unit = unit_of(array, name, which, columns);
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
    take_packing(array, which, columns, channel, slice);
    tell_unapplied(array, columns, channel.unit);
    channel.quantity = datasets::quantity_of_unit(channel.unit);
    head_.record.channels.push_back(std::move(channel));
    slices_.push_back(slice);
  }

  /// What attributes of a data set, or of a group around it, say of its clock.
  bool by_attributes(std::string_view name, const Hdf5Attributes& attributes,
                     datasets::SampleClock& clock) {
    constexpr std::array<std::string_view, 6> intervals = {
        "dt", "wf_increment", "sample_interval", "sampling_interval", "delta_t", "sampleinterval"};
    constexpr std::array<std::string_view, 7> rates = {
        "fs",           "sample_rate",        "sampling_rate",   "samplerate",
        "samplingrate", "sampling_frequency", "sample_frequency"};
    constexpr std::array<std::string_view, 4> starts = {"wf_start_offset", "t0", "start_time",
                                                        "start"};
    const double interval = quantity_of(attributes, intervals, "s").value_or(0.0);
    const double rate = quantity_of(attributes, rates, "Hz").value_or(0.0);
    const double period = rate > 0.0 && std::isfinite(1.0 / rate) ? 1.0 / rate : 0.0;
    clock.interval = interval > 0.0 ? interval : period;
    if (!(clock.interval > 0.0)) return false;
    if (period > 0.0 && differ(clock.interval, period))
      warn(
          fmt::format("'{}': one attribute says that samples are {:.9g} s apart, that of its rate "
                      "{:.9g} s: the first is used",
                      to_utf8(name), clock.interval, period));
    clock.start = quantity_of(attributes, starts, "s").value_or(0.0);
    return true;
  }

  static bool differ(double a, double b) { return std::abs(a - b) > 1e-3 * std::abs(b); }

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
    for (std::size_t i = 0; i < slices_.size(); ++i) arrays.push_back(named_array(i));
    clocks_.resize(arrays.size());
    std::set<std::size_t> scaled;
    if (!options.time_column) scaled = by_scales(arrays);
    by_names(arrays, scaled, options);
    for (std::size_t i = 0; i < slices_.size(); ++i)
      set_clock(i, arrays, options.time_column.has_value());
  }

  NamedArray named_array(std::size_t index) const {
    const Hdf5Array& array = *slices_[index].array;
    const Channel& channel = head_.record.channels[index];
    NamedArray named{channel.name, slices_[index].count, !array.complex};
    named.real = named.real && !still_packed_.contains(index);
    take_unit(named, channel.unit);
    named.time = is_axis(array) &&
                 (channel.unit.empty() || datasets::conversion(channel.unit, "s").has_value());
    return named;
  }

  /// What the scales of dimensions say; returns the channels that need no names any more.
  std::set<std::size_t> by_scales(const std::vector<NamedArray>& arrays) {
    std::map<const Hdf5Array*, std::size_t> channels;
    for (std::size_t i = 0; i < slices_.size(); ++i) channels.emplace(slices_[i].array, i);
    std::map<std::size_t, std::vector<std::size_t>> attached;  // to the channel that is their scale
    std::map<std::size_t, std::vector<std::size_t>> over_other;
    std::map<std::size_t, std::set<std::string>> of_unknown;  // data sets, likewise
    std::set<std::size_t> known;
    for (std::size_t i = 0; i < slices_.size(); ++i) {
      const Scale scale = scale_of(i);
      const auto channel = channels.find(scale.array);
      if (channel == channels.end() || slices_[i].count < 2) continue;
      const std::size_t axis = channel->second;
      if (scale.kind == ScaleKind::unknown)
        of_unknown[axis].insert(name_of_set(*slices_[i].array));
      else
        known.insert({i, axis});
      if (scale.kind == ScaleKind::time) attached[axis].push_back(i);
      if (scale.kind == ScaleKind::other) no_time_.insert({i, axis});
      if (scale.kind == ScaleKind::other) over_other[axis].push_back(i);
    }
    for (const auto& [axis, of] : over_other) set_other_abscissa(axis, of);
    for (const auto& [axis, of] : of_unknown) tell_unknown_scale(arrays[axis].name, of);
    std::string without_unit;
    for (const auto& [axis, of] : attached) {
      const ArrayClock clock = clock_of_scale(axis, arrays[axis]);
      clocks_[axis] = clock;
      for (const std::size_t i : of) clocks_[i] = clock;
      if (clock.interval > 0.0 && head_.record.channels[axis].unit.empty())
        without_unit += fmt::format("{}{} (the scale of a dimension)",
                                    without_unit.empty() ? "" : "; ", arrays[axis].name);
    }
    tell_taken_as_seconds(without_unit);
    return known;
  }

  void tell_unknown_scale(const std::string& scale, const std::set<std::string>& of) {
    const std::string more = of.size() > 1 ? fmt::format(" and {} more", of.size() - 1) : "";
    warn(
        fmt::format("'{}'{} {} over '{}', which states no unit of time: the clock is taken from "
                    "elsewhere (--time-column '{}' takes that)",
                    *of.begin(), more, of.size() > 1 ? "stand" : "stands", scale, scale));
  }

  Scale scale_of(std::size_t index) const {
    const Hdf5Slice& slice = slices_[index];
    const std::size_t rank = slice.array->shape.size();
    if (rank == 0 || rank > 2) return {};
    return scale_along(*slice.array, rank == 1     ? 0
                                     : slice.whole ? along_of(*slice.array)
                                                   : slice.along);
  }

  /// The clock of times that are the scale of a dimension.
  ArrayClock clock_of_scale(std::size_t axis, const NamedArray& named) {
    ImportOptions that;
    that.time_column = named.name;
    NamedArray array = named;
    array.real = true;
    ArrayClocks found = found_clocks({axis}, {array}, that);
    if (found.clocks[0].interval > 0.0)
      add_time_column(fmt::format("{} (the scale of a dimension)", named.name));
    return found.clocks[0];
  }

  /// A scale that is no time: of itself too, and of these.
  void set_other_abscissa(std::size_t axis, const std::vector<std::size_t>& of) {
    std::vector<Channel>& channels = head_.record.channels;
    double first = 0.0, last = 0.0;
    std::uint64_t count = 0;
    each_value(axis, [&](std::span<const double> values) {
      if (count == 0) first = values.front();
      last = values.back();
      count += values.size();
    });
    const double step = count > 1 ? (last - first) / static_cast<double>(count - 1) : 0.0;
    const std::string unit = channels[axis].unit;
    const std::string_view domain =
        channels[axis].quantity == datasets::Quantity::frequency ? "frequency" : "other";
    set_abscissa(channels[axis], domain, unit, first, step);
    for (const std::size_t i : of) set_abscissa(channels[i], domain, unit, first, step);
  }

  /// What names say of all others. Scales are among them where another may have no times but
  /// theirs.
  void by_names(const std::vector<NamedArray>& arrays, const std::set<std::size_t>& scaled,
                const ImportOptions& options) {
    std::set<std::uint64_t> lengths;
    for (std::size_t i = 0; i < arrays.size(); ++i)
      if (!scaled.contains(i)) lengths.insert(arrays[i].samples);
    std::vector<std::size_t> which;
    std::vector<NamedArray> others;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      if (scaled.contains(i) && !lengths.contains(arrays[i].samples)) continue;
      which.push_back(i);
      others.push_back(arrays[i]);
    }
    const ArrayClocks found = found_clocks(which, others, options);
    for (std::size_t k = 0; k < which.size(); ++k)
      if (!scaled.contains(which[k])) clocks_[which[k]] = found.clocks[k];
    add_time_column(found.time_column);
    tell_taken_as_seconds(found.without_unit);
  }

  /// The clocks of some of the channels, by the names of these, with their warnings.
  ArrayClocks found_clocks(const std::vector<std::size_t>& which,
                           const std::vector<NamedArray>& arrays, const ImportOptions& options) {
    ArrayClocks found = clocks_by_name(
        path_, arrays,
        [this, &which](std::size_t k, const auto& use) { each_value(which[k], use); }, options);
    for (const std::string& warning : found.warnings) warn(warning);
    for (std::size_t k = 0; k < which.size(); ++k) {
      ArrayClock& clock = found.clocks[k];
      if (clock.times) clock.times = which[*clock.times];
      if (clock.interval > 0.0) tell_origin(which[k], arrays[k]);
    }
    return found;
  }

  /// Of times that are told from their first.
  void tell_origin(std::size_t index, const NamedArray& times) {
    if (!origins_.contains(index) || !as_times(index).from_first) return;
    const Channel& channel = head_.record.channels[index];
    const double origin = channel.scale * origins_.at(index) + channel.offset;
    warn(
        fmt::format("'{}' begins at {:.3f} s: times are told from there, since a double does not "
                    "hold them",
                    times.name, times.seconds * origin));
  }

  void add_time_column(const std::string& text) {
    if (text.empty()) return;
    std::string& all = head_.record.attributes["time column"];
    if (all.size() < 400) all += (all.empty() ? "" : "; ") + text;
  }

  void tell_taken_as_seconds(const std::string& times) {
    if (!times.empty())
      warn(fmt::format("the time is taken as s, since no unit is stated: {}", times));
  }

  /// Hands the values of a channel to `use`; of integers that doubles do not hold, what they are
  /// more than the first.
  void each_value(std::size_t index, const std::function<void(std::span<const double>)>& use) {
    const Channel& channel = head_.record.channels[index];
    const Hdf5Slice slice = as_times(index);
    const double offset = slice.from_first ? 0.0 : channel.offset;
    std::vector<double> values;
    each_number_of(path_, slice, [&](std::span<const double> numbers) {
      values.assign(numbers.begin(), numbers.end());
      for (double& value : values) value = channel.scale * value + offset;
      use(values);
    });
  }

  /// A channel whose numbers are times.
  Hdf5Slice as_times(std::size_t index) {
    Hdf5Slice slice = slices_[index];
    slice.times = nullptr;
    if (!slice.array->wide) return slice;
    const auto [known, is_new] = origins_.try_emplace(index, 0.0);
    if (is_new) {
      Hdf5Slice one = slice;
      one.count = 1;
      each_number_of(path_, one, [&origin = known->second](std::span<const double> numbers) {
        origin = numbers.front();
      });
    }
    constexpr double exact = 9007199254740992.0;  // 2^53
    slice.from_first = std::abs(known->second) > exact;
    return slice;
  }

  void set_clock(std::size_t index, const std::vector<NamedArray>& arrays, bool stated) {
    // a rate beside a spectrum is that of what it was made from
    if (no_time_.contains(index)) return;
    datasets::SampleClock& clock = head_.record.channels[index].clock;
    const ArrayClock& found = clocks_[index];
    const Hdf5Array& array = *slices_[index].array;
    if (!(stated && found.interval > 0.0) &&
        by_attributes(name_of_set(array), array.attributes, clock)) {
      if (found.interval > 0.0 && differ(clock.interval, found.interval))
        warn(
            fmt::format("'{}': its attributes say that samples are {:.9g} s apart, what stands "
                        "beside it {:.9g} s: its attributes are used",
                        name_of_set(array), clock.interval, found.interval));
      return;
    }
    clock.start = found.start;
    clock.interval = found.interval;
    if (found.times) take_times(index, *found.times, arrays[*found.times].seconds);
    if (clock.interval > 0.0) return;
    for (std::string_view group = parent_of(array.path);; group = parent_of(group)) {
      const auto attributes = listing_.groups.find(std::string(group));
      if (attributes != listing_.groups.end() && by_attributes(group, attributes->second, clock))
        break;
      if (group == "/") break;
    }
  }

  void take_times(std::size_t index, std::size_t times, double seconds) {
    const Channel& channel = head_.record.channels[times];
    const Hdf5Slice slice = as_times(times);
    slices_[index].times = std::make_shared<const Hdf5Slice>(slice);
    slices_[index].time_factor = seconds * channel.scale;
    slices_[index].time_offset = slice.from_first ? 0.0 : seconds * channel.offset;
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
  std::map<std::uint64_t, const Hdf5Array*> by_reference_;
  std::vector<Hdf5Slice> slices_;          ///< one a channel
  std::vector<ArrayClock> clocks_;         ///< likewise, but for what attributes say
  std::set<std::size_t> no_time_;          ///< channels over frequencies, lengths, ...
  std::set<std::size_t> still_packed_;     ///< channels whose packing cannot be undone
  std::map<std::size_t, double> origins_;  ///< first numbers of channels of large integers
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
