// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_clocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "acquisition/importers/clock_words.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/mat_programs.hpp"
#include "acquisition/importers/named_arrays.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;

namespace {

std::string_view parent_of(std::string_view path) {
  const std::size_t end = path.find_last_of('/');
  return end == 0 || end == std::string_view::npos ? std::string_view("/") : path.substr(0, end);
}

class ClockSetter {
 public:
  explicit ClockSetter(Hdf5Channels& file)
      : file_(file),
        channels_(file.record.channels),
        slices_(file.slices),
        clocks_(file.slices.size()) {}

  void set(const ImportOptions& options) {
    std::vector<NamedArray> arrays;
    for (std::size_t i = 0; i < slices_.size(); ++i) arrays.push_back(named_array(i));
    std::set<std::size_t> scaled;
    if (!options.time_column) scaled = by_scales(arrays);
    by_names(arrays, scaled, options);
    for (std::size_t i = 0; i < slices_.size(); ++i) set_clock(i, options.time_column.has_value());
    if (!file_.matlab) return;
    const bool stated = options.time_column.value_or("none") != "none";
    for (std::size_t i = 0; i < slices_.size(); ++i)
      if (slices_[i].count > 1)
        take_facts_of_program(mat_facts(), !stated && channels_[i].clock.interval == 0.0,
                              channels_[i], file_.record);
  }

 private:
  /// What attributes of a data set, or of a group around it, say of its clock.
  bool by_attributes(std::string_view name, const Hdf5Attributes& attributes, Channel& channel) {
    constexpr std::array<std::string_view, 7> intervals = {
        "dt",      "wf_increment",   "sample_interval", "sampling_interval",
        "delta_t", "sampleinterval", "samplinginterval"};
    constexpr std::array<std::string_view, 9> rates = {"fs",
                                                       "sample_rate",
                                                       "sampling_rate",
                                                       "samplerate",
                                                       "samplingrate",
                                                       "samplingfrequency",
                                                       "samplefrequency",
                                                       "sampling_frequency",
                                                       "sample_frequency"};
    const auto stated_interval = quantity_of(attributes, intervals, "s", unit_of_time(attributes));
    const auto stated_rate = quantity_of(attributes, rates, "Hz");
    const double interval = stated_interval.value_or(0.0);
    const double rate = stated_rate.value_or(0.0);
    const double period = rate > 0.0 && std::isfinite(1.0 / rate) ? 1.0 / rate : 0.0;
    datasets::SampleClock& clock = channel.clock;
    clock.interval = interval > 0.0 ? interval : period;
    if (!(clock.interval > 0.0)) clock.interval = by_other_names(attributes);
    if (!(clock.interval > 0.0)) {
      if (stated_rate) tell_unusable_rate(channel, rate);
      if (stated_interval) tell_unusable_interval(channel, interval, "s");
      return false;
    }
    if (period > 0.0 && differ(clock.interval, period))
      file_.warn(
          fmt::format("'{}': one attribute says that samples are {:.9g} s apart, that of its rate "
                      "{:.9g} s: the first is used",
                      to_utf8(name), clock.interval, period));
    clock.start = stated_start(attributes, intervals).value_or(0.0);
    return true;
  }

  /// As "fs_Hz", "Sampling Rate" or "time_step" [s]; 0 of none.
  static double by_other_names(const Hdf5Attributes& attributes) {
    for (const auto& [key, value] : attributes.numbers)
      if (const auto interval = interval_by_name(key, value)) return *interval;
    for (const auto& [key, text] : attributes.texts)
      if (const auto interval = interval_by_name(key, std::string_view(text))) return *interval;
    return 0.0;
  }

  /// "ms" of "time_unit".
  static std::string unit_of_time(const Hdf5Attributes& attributes) {
    for (const auto& [key, text] : attributes.texts)
      for (const std::string_view word :
           {"time_unit", "time_units", "xunit", "xunits", "x_unit", "x_units"})
        if (lowered(key) == word) return text;
    return {};
  }

  /// In its own unit or in that of the interval.
  static std::optional<double> stated_start(const Hdf5Attributes& attributes,
                                            std::span<const std::string_view> intervals) {
    constexpr std::array<std::string_view, 8> starts = {
        "wf_start_offset", "t0",     "start_time",   "start",
        "t_start",         "tstart", "start_offset", "time_offset"};
    std::string unit = unit_of_time(attributes);
    for (const auto& [key, text] : attributes.texts)
      for (const std::string_view interval : intervals)
        for (const std::string_view ending : {"_units", "_unit"})
          if (lowered(key) == fmt::format("{}{}", interval, ending)) unit = text;
    return quantity_of(attributes, starts, "s", unit);
  }

  static bool differ(double a, double b) { return std::abs(a - b) > 1e-3 * std::abs(b); }

  /// NeXus: a group NXdata names its axes, which may be links.
  bool is_axis(const Hdf5Array& array) const {
    return array.is_axis || is_axis(array.path) ||
           std::ranges::any_of(links_to(file_.listing, array.path),
                               [this](const std::string& link) { return is_axis(link); });
  }

  bool is_axis(std::string_view path) const {
    const auto group = file_.listing.groups.find(std::string(parent_of(path)));
    if (group == file_.listing.groups.end()) return false;
    const auto& texts = group->second.texts;
    const auto axes = texts.find("axes");
    return axes != texts.end() && axes->second == path.substr(path.find_last_of('/') + 1);
  }

  NamedArray named_array(std::size_t index) {
    const Hdf5Array& array = *slices_[index].array;
    const Channel& channel = channels_[index];
    NamedArray named{channel.name, slices_[index].count, !array.complex};
    named.real = named.real && !file_.still_packed.contains(index);
    take_unit(named, channel.unit);
    take_unit_since_1970(index, named);
    if (slices_[index].whole && !array.is_field())
      for (const std::string& link : links_to(file_.listing, array.path))
        named.other_names.push_back(file_.name_of_path(link));
    named.time = is_axis(array) &&
                 (channel.unit.empty() || datasets::conversion(channel.unit, "s").has_value());
    if (file_.matlab) tell_times_of_program(mat_facts(), named);
    return named;
  }

  /// Integers of 64 bits that count from 1970: what they are more than the first does not tell.
  void take_unit_since_1970(std::size_t index, NamedArray& named) {
    if (named.has_unit || !slices_[index].array->wide || named.samples < 2) return;
    if (!is_named_as_time(named.name) || !as_times(index).from_first) return;
    const Channel& channel = channels_[index];
    const std::string unit = unit_since_1970(channel.scale * origins_.at(index) + channel.offset);
    if (unit.empty()) return;
    take_unit(named, unit);
    file_.warn(counts_since_1970(named.name, unit));
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
      const DimensionScale scale = file_.scales.of_samples(slices_[i]);
      const auto channel = channels.find(scale.array);
      if (channel == channels.end() || slices_[i].count < 2) continue;
      const std::size_t axis = channel->second;
      if (scale.kind == ScaleKind::unknown)
        of_unknown[axis].insert(file_.name_of_set(*slices_[i].array));
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
      if (clock.interval > 0.0 && channels_[axis].unit.empty())
        without_unit += fmt::format("{}{} (the scale of a dimension)",
                                    without_unit.empty() ? "" : "; ", arrays[axis].name);
    }
    tell_taken_as_seconds(without_unit);
    return known;
  }

  void tell_unknown_scale(const std::string& scale, const std::set<std::string>& of) {
    const std::string more = of.size() > 1 ? fmt::format(" and {} more", of.size() - 1) : "";
    file_.warn(
        fmt::format("'{}'{} {} over '{}', which states no unit of time: the clock is taken from "
                    "elsewhere (--time-column '{}' takes that)",
                    *of.begin(), more, of.size() > 1 ? "stand" : "stands", scale, scale));
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
    double first = 0.0, last = 0.0;
    std::uint64_t count = 0;
    each_value(axis, {0, slices_[axis].count}, [&](std::span<const double> values) {
      if (count == 0) first = values.front();
      last = values.back();
      count += values.size();
    });
    const double step = count > 1 ? (last - first) / static_cast<double>(count - 1) : 0.0;
    const std::string unit = channels_[axis].unit;
    const std::string_view domain =
        channels_[axis].quantity == datasets::Quantity::frequency ? "frequency" : "other";
    set_abscissa(channels_[axis], domain, unit, first, step);
    for (const std::size_t i : of) set_abscissa(channels_[i], domain, unit, first, step);
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
        file_.path, arrays,
        [this, &which](std::size_t k, const NumberRange& range, const auto& use) {
          each_value(which[k], range, use);
        },
        options);
    for (const std::string& warning : found.warnings) file_.warn(warning);
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
    const Channel& channel = channels_[index];
    const double origin =
        times.seconds * (channel.scale * origins_.at(index) + channel.offset);  // [s]
    file_.warn(
        fmt::format("'{}' begins at {:.3f} s: times are told from there, since a double does not "
                    "hold them",
                    times.name, origin));
    if (file_.record.started.empty() && is_since_1970(origin))
      file_.record.started = iso_time_utc(std::round(origin * 1e6) / 1e6);
  }

  void add_time_column(const std::string& text) {
    if (text.empty()) return;
    std::string& all = file_.record.attributes["time column"];
    if (all.size() < 400) all += (all.empty() ? "" : "; ") + text;
  }

  void tell_taken_as_seconds(const std::string& times) {
    if (!times.empty())
      file_.warn(fmt::format("the time is taken as s, since no unit is stated: {}", times));
  }

  /// Hands the values of a channel to `use`; of integers that doubles do not hold, what they are
  /// more than the first.
  void each_value(std::size_t index, const NumberRange& range,
                  const std::function<void(std::span<const double>)>& use) {
    const Channel& channel = channels_[index];
    Hdf5Slice slice = as_times(index);
    // what counts from the first number has to begin there
    std::uint64_t passed = slice.from_first ? range.first : 0;
    slice.first += range.first - passed;
    slice.count = passed + range.count;
    const double offset = slice.from_first ? 0.0 : channel.offset;
    std::vector<double> values;
    each_number_of(file_.path, slice, [&](std::span<const double> numbers) {
      const auto before = std::min<std::uint64_t>(passed, numbers.size());
      passed -= before;
      values.assign(numbers.begin() + static_cast<std::ptrdiff_t>(before), numbers.end());
      for (double& value : values) value = channel.scale * value + offset;
      if (!values.empty()) use(values);
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
      each_number_of(file_.path, one, [&origin = known->second](std::span<const double> numbers) {
        origin = numbers.front();
      });
    }
    constexpr double exact = 9007199254740992.0;  // 2^53
    slice.from_first = std::abs(known->second) > exact;
    return slice;
  }

  void set_clock(std::size_t index, bool stated) {
    // a rate beside a spectrum is that of what it was made from
    if (no_time_.contains(index)) return;
    datasets::SampleClock& clock = channels_[index].clock;
    const ArrayClock& found = clocks_[index];
    const Hdf5Array& array = *slices_[index].array;
    if (!(stated && found.interval > 0.0) &&
        by_attributes(file_.name_of_set(array), array.attributes, channels_[index])) {
      // times of the same steps tell when these begin, unless an attribute does
      if (found.interval > 0.0 && !differ(clock.interval, found.interval) &&
          !stated_start(array.attributes, {}))
        clock.start = found.start;
      if (found.interval > 0.0 && differ(clock.interval, found.interval))
        file_.warn(
            fmt::format("'{}': its attributes say that samples are {:.9g} s apart, what stands "
                        "beside it {:.9g} s: its attributes are used",
                        file_.name_of_set(array), clock.interval, found.interval));
      return;
    }
    clock.start = found.start;
    clock.interval = found.interval;
    set_attribute(channels_[index], unusable_clock, found.unusable);
    if (found.times) take_times(index, *found.times, found.seconds);
    if (clock.interval > 0.0) return;
    const auto by_some_group = [&](const std::string& path) {
      return by_groups(path, channels_[index]);
    };
    if (!by_some_group(array.path) &&
        !std::ranges::any_of(links_to(file_.listing, array.path), by_some_group))
      return;
    if (const auto own = stated_start(array.attributes, {})) clock.start = *own;
  }

  MatFacts mat_facts() {
    const auto number = [this](const std::string& name) -> std::optional<double> {
      const auto found = std::ranges::find(channels_, name, &Channel::name);
      if (found == channels_.end()) return std::nullopt;
      const auto index = static_cast<std::size_t>(found - channels_.begin());
      if (slices_[index].count != 1 || slices_[index].array->complex) return std::nullopt;
      double value = 0.0;
      each_value(index, {0, 1},
                 [&value](std::span<const double> values) { value = values.front(); });
      return value;
    };
    const auto text = [this](const std::string& name) {
      const auto found = file_.record.attributes.find(name);
      return found == file_.record.attributes.end() ? std::string() : found->second;
    };
    return {number, text};
  }

  /// What attributes of the groups around a path say.
  bool by_groups(std::string_view path, Channel& channel) {
    for (std::string_view group = parent_of(path);; group = parent_of(group)) {
      const auto attributes = file_.listing.groups.find(std::string(group));
      if (attributes != file_.listing.groups.end() &&
          by_attributes(group, attributes->second, channel))
        return true;
      if (group == "/") return false;
    }
  }

  void take_times(std::size_t index, std::size_t times, double seconds) {
    const Channel& channel = channels_[times];
    const Hdf5Slice slice = as_times(times);
    slices_[index].times = std::make_shared<const Hdf5Slice>(slice);
    slices_[index].time_factor = seconds * channel.scale;
    slices_[index].time_offset = slice.from_first ? 0.0 : seconds * channel.offset;
  }

  Hdf5Channels& file_;
  std::vector<Channel>& channels_;         ///< of the file
  std::vector<Hdf5Slice>& slices_;         ///< likewise
  std::vector<ArrayClock> clocks_;         ///< one a channel, but for what attributes say
  std::set<std::size_t> no_time_;          ///< channels over frequencies, lengths, ...
  std::map<std::size_t, double> origins_;  ///< first numbers of channels of large integers
};

}  // namespace

void set_clocks(Hdf5Channels& channels, const ImportOptions& options) {
  ClockSetter(channels).set(options);
}

}  // namespace impactrig::acquisition
