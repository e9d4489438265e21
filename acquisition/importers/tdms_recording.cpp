// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/tdms_recording.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/clock_words.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/stated_units.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/tdms_clock.hpp"
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
    for (const TdmsObject& object : objects_) {
      if (object.depth == 0) root_ = &object;
      if (object.depth == 1) groups_.emplace(object.group, &object);
    }
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

  void describe() {
    if (root_ != nullptr) {
      for (const auto& [name, value] : root_->properties) record_.attributes[name] = text_of(value);
      for (const char* const name : {"name", "title"})
        if (record_.title.empty()) record_.title = text_of(root_->properties, name);
    }
    for (const TdmsObject& object : objects_)
      if (object.depth == 1)
        for (const auto& [name, value] : object.properties)
          record_.attributes[object.group + "/" + name] = text_of(value);
    add_channels();
    if (record_.channels.empty())
      warn("no recordings in this file: it has no channel with numbers");
    take_stated_units(options_.units, file_->path(), record_);
    set_uniform_clocks();
    set_clocks_by_channels();
    set_clocks_by_properties();
  }

  /// A part of a channel, which is a channel of the record.
  struct Part {
    const TdmsObject* object;
    const TdmsPart* part;
  };

  /// The first part of every channel, then the later ones by their segments.
  void add_channels() {
    std::vector<Part> later;
    for (const TdmsObject& object : objects_) {
      if (object.depth != 2) continue;
      std::vector<const TdmsPart*> parts;
      for (const TdmsPart& part : object.earlier) parts.push_back(&part);
      parts.push_back(&object);
      add_channel({&object, parts.front()});
      for (std::size_t i = 1; i < parts.size(); ++i) later.push_back({&object, parts[i]});
    }
    std::ranges::stable_sort(later, {}, [](const Part& one) { return one.part->segment; });
    for (const Part& part : later) add_channel(part);
  }

  void add_channel(const Part& added) {
    const auto& [object, part] = added;
    if (part->texts > 0) {
      warn(fmt::format("'{}' holds {} texts: it is left out", object->name, part->texts));
      return;
    }
    Channel channel;
    StoredChannel stored;
    channel.name = object->name;
    if (part->segment > 1) channel.name += fmt::format(" (segment {})", part->segment);
    channel.attributes["group"] = object->group;
    for (const auto& [name, value] : part->properties)
      if (!name.starts_with("NI_Scale[")) channel.attributes[name] = text_of(value);
    channel.unit = text_of(part->properties, "unit_string");
    if (channel.unit.empty()) take_unit_of_others(part->properties, channel);
    if (channel.unit.empty()) take_unit_of_name(channel);
    if (part->type != nullptr && part->type->role == TdmsRole::time)
      set_time_stamps(*part, channel, stored);
    else
      set_numbers(added, channel, stored);
    set_marks(*part, channel, stored);
    set_quantity(channel);
    record_.channels.push_back(std::move(channel));
    stored_.push_back(std::move(stored));
    channels_.push_back(added);
  }

  /// Of properties that stand for LabVIEW's own: DAQmx's, DIAdem's, those of users.
  static void take_unit_of_others(const TdmsProperties& properties, Channel& channel) {
    for (const char* name : {"NI_UnitDescription", "Unit", "Units", "unit", "units", "Einheit"}) {
      const std::string unit = text_of(properties, name);
      if (datasets::quantity_of_unit(unit) == Quantity::unknown) continue;
      channel.unit = unit;
      return;
    }
  }

  /// "N" of "Force (N)"; what is no unit of a quantity may be anything: "Untitled (2)".
  static void take_unit_of_name(Channel& channel) {
    const std::string unit = unit_by_name(channel.name);
    const Quantity quantity = datasets::quantity_of_unit(unit);
    if (quantity != Quantity::unknown && quantity != Quantity::other) channel.unit = unit;
  }

  /// What a channel's own properties state of scales, else its group's, else the file's.
  TdmsScaling scaling_of(const Part& of) const {
    if (states_scales(of.part->properties)) return tdms_scaling(of.part->properties);
    const auto group = groups_.find(of.object->group);
    const TdmsObject* object = group == groups_.end() ? nullptr : group->second;
    if (object == nullptr || !states_scales(object->properties)) object = root_;
    if (object == nullptr) return {};
    TdmsScaling scaling = tdms_scaling(object->properties);
    if (object->scales_change)
      scaling.problem = fmt::format("the scales of {} change from one segment to another",
                                    object->depth == 0 ? "the file" : "its group");
    return scaling;
  }

  void set_quantity(Channel& channel) {
    const auto [known, added] = quantities_.try_emplace(channel.unit, Quantity::unknown);
    if (added) known->second = datasets::quantity_of_unit(channel.unit);
    channel.quantity = known->second;
  }

  /// The raw numbers that the scales begin with; `scaling` has a problem where they are not there.
  const TdmsSource* source_of(const Part& of, TdmsScaling& scaling) {
    const std::vector<TdmsSource>& sources = of.part->sources;
    const TdmsSource* const first = &sources.front();
    if (!scaling.problem.empty()) return first;
    const auto found = std::ranges::find(sources, scaling.source, &TdmsSource::id);
    if (found != sources.end()) return &*found;
    const bool any_scale = !scaling.what.empty();
    if (first->id == TdmsScaling::raw_data) {
      // numbers of DAQmx that are saved as others: their raw signal is still called scale 0
      if (scaling.source != 0 || !any_scale)
        scaling.problem = fmt::format("its scale {} is announced and not there", scaling.source);
    } else if (scaling.source != TdmsScaling::raw_data || (any_scale && sources.size() > 1)) {
      scaling.problem = fmt::format("its scales begin with the raw signal {}, which is not there",
                                    scaling.source);
    } else if (sources.size() > 1) {
      warn(fmt::format("'{}' has {} raw signals and no scale that joins them: the first is read",
                       of.object->name, sources.size()));
    }
    return first;
  }

  /// The raw numbers that the scales need beside those they begin with; `scaling` has a problem
  /// where they are not there.
  static std::vector<StoredNumbers> others_of(const Part& of, const TdmsSource& source,
                                              TdmsScaling& scaling) {
    std::vector<StoredNumbers> others;
    for (const std::uint32_t id : scaling.others) {
      if (!scaling.problem.empty()) return {};
      const auto found = std::ranges::find(of.part->sources, id, &TdmsSource::id);
      if (found == of.part->sources.end())
        scaling.problem =
            source.id == TdmsScaling::raw_data
                ? fmt::format("its scale {} is announced and not there", id)
                : fmt::format("its scales need the raw signal {}, which is not there", id);
      else if (found->bit >= 0 || source.bit >= 0)
        scaling.problem = "its scales join digital lines";
      else if (found->imaginary.size() > 0)
        scaling.problem = "its numbers are complex";
      else
        others.push_back(found->numbers);
    }
    return others;
  }

  void set_numbers(const Part& of, Channel& channel, StoredChannel& stored) {
    if (of.part->sources.empty()) return;
    TdmsScaling scaling = scaling_of(of);
    const TdmsSource* const source = source_of(of, scaling);
    std::vector<StoredNumbers> others = others_of(of, *source, scaling);
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
    } else if (!others.empty()) {
      // a file that is cut may hold more of one raw signal than of another
      std::uint64_t count = stored.samples.size();
      for (const StoredNumbers& other : others) count = std::min(count, other.size());
      stored.samples = stored.samples.first(count);
      for (const StoredNumbers& other : others) stored.others.push_back(other.first(count));
      stored.joining = std::move(scaling.function);
    } else if (scaling.function) {
      function = [scale = std::move(scaling.function)](std::span<double> x) { scale(x, {}); };
    } else {
      channel.scale = scaling.scale;
      channel.offset = scaling.offset;
    }
    if (scaling.problem.empty() && !scaling.what.empty())
      channel.attributes["scales"] = scaling.what;
    if (scaling.problem.empty() && !scaling.note.empty())
      warn(fmt::format("'{}': {}", channel.name, scaling.note));
    if (source->bit >= 0) {
      function = [bit = source->bit, next = std::move(function)](std::span<double> x) {
        for (double& value : x)  // integers of 32 bits at most, or exact below 2^53
          value = std::fmod(std::floor(std::ldexp(value, -bit)), 2.0) != 0.0 ? 1.0 : 0.0;
        if (next) next(x);
      };
    }
    stored.scaling = std::move(function);
  }

  void set_marks(const TdmsPart& part, const Channel& channel, StoredChannel& stored) {
    if (part.marks.size() == 0) return;
    if (part.marks.size() < stored.samples.size()) {
      warn(fmt::format("'{}' has {} marks of {} samples: they are not read", channel.name,
                       part.marks.size(), stored.samples.size()));
      return;
    }
    stored.invalid = part.marks.first(stored.samples.size());
    stored.invalid_meaning = [](std::span<double> marks) {
      for (double& mark : marks) mark = std::fmod(mark, 2.0) != 0.0 ? 0.0 : 1.0;
    };
  }

  TdmsTime time_at(std::uint64_t at, bool big_endian) const {
    ByteCursor in(*file_, big_endian, at);
    return read_tdms_time(in);
  }

  /// Time stamps become seconds since the first of them. Of their 128 bits (64 of seconds, 64 of
  /// fraction) 64 in the middle are read: 24 of seconds and 40 of fraction give 1 ns within 97 days
  /// of the first, else 32 and 32 give 0.5 µs within 68 years.
  void set_time_stamps(const TdmsPart& part, Channel& channel, StoredChannel& stored) {
    channel.unit = "s";
    if (part.samples() == 0) return;
    if (part.diadem_times) return set_diadem_times(part, channel, stored);
    const StoredNumbers& found = part.sources.front().numbers;
    const bool big_endian = found.big_endian();
    const TdmsTime first = time_at(part.first_value, big_endian);
    const TdmsTime last = time_at(part.last_value, big_endian);
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
    channel.attributes["first time stamp"] = iso_text(first);
    channel.attributes["counted from"] = "its first time stamp";
  }

  /// DIAdem counts seconds in double precision, in no stated zone, so that 1970 begins at
  /// 62167132800; they become seconds since the first of them, where they are times of our calendar
  /// and not of a clock that began with the measurement.
  void set_diadem_times(const TdmsPart& part, Channel& channel, StoredChannel& stored) const {
    stored.samples = part.sources.front().numbers;
    double first = 0.0;
    read_numbers(*file_, stored.samples, 0, {&first, 1});
    constexpr double year_1000 = 31556952000.0;
    constexpr double year_10000 = 315569520000.0;
    if (!(first > year_1000) || !(first < year_10000)) return;
    if (stored.samples.ramp())
      stored.samples = StoredNumbers({0.0, stored.samples.ramp()->step}, stored.samples.size());
    else
      stored.scaling = [first](std::span<double> x) {
        for (double& value : x) value -= first;
      };
    channel.attributes["counted from"] = "its first time stamp";
    constexpr std::int64_t year_1970 = 62167132800;
    const auto steps =
        static_cast<std::int64_t>(std::llround(first * 1e5));  // of 10 us: all it has
    std::string text =
        iso_utc(steps / 100000 - year_1970, static_cast<std::uint32_t>(steps % 100000 * 10));
    if (text.ends_with('Z')) text.pop_back();
    channel.attributes["first time stamp"] = text;
  }

  static void set_other_abscissa(const TdmsPart& part, Channel& channel) {
    const std::string spelled = text_of(part.properties, "wf_xunit_string");
    std::string domain = text_of(part.properties, "wf_xname");
    const Quantity quantity = datasets::quantity_of_unit(spelled);
    if (spelled.empty() || quantity == Quantity::frequency)
      domain = "frequency";
    else if (domain.empty() || domain == "Time" || domain == "time")
      domain = quantity == Quantity::unknown ? "unknown" : std::string(datasets::name(quantity));
    set_abscissa(channel, domain, spelled, tdms_start_offset(part.properties) + part.after,
                 tdms_step(part.properties));
  }

  /// Uniform clocks from the waveform properties. Channels share a time origin: the earliest start.
  void set_uniform_clocks() {
    const auto before = [](const TdmsTime& a, const TdmsTime& b) {
      return a.seconds != b.seconds ? a.seconds < b.seconds : a.fraction < b.fraction;
    };
    std::optional<TdmsTime> earliest;
    for (const Part& channel : channels_)
      if (const auto start = tdms_start(channel.part->properties);
          start && (!earliest || before(*start, *earliest)))
        earliest = start;
    if (earliest) record_.started = iso_text(*earliest);
    bool different = false;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const TdmsPart& part = *channels_[i].part;
      datasets::SampleClock& clock = record_.channels[i].clock;
      if (!seconds_of_abscissa(part.properties)) {
        set_other_abscissa(part, record_.channels[i]);
        continue;
      }
      clock.start = tdms_start_offset(part.properties) + part.after;
      clock.interval = tdms_step(part.properties);
      if (const auto stated = number_of(part.properties, "wf_increment"))
        tell_unusable_interval(record_.channels[i], *stated,
                               text_of(part.properties, "wf_xunit_string"));
      const auto start = tdms_start(part.properties);
      if (!start) continue;
      const double later = seconds_between(*earliest, *start);
      // writers carry the start along in double precision: what is small against a step is none
      if (std::abs(later) <= 1e-3 * clock.interval) continue;
      different = true;
      clock.start += later;
    }
    if (different) warn("channels start at different times: time 0 is the start of the earliest");
  }

  /// Times from a channel: the one the user states, else the only one of time stamps in a group,
  /// or the only one that its name and unit call a time.
  void set_clocks_by_channels() {
    take_units_of_times();
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
        if (channels_[i].object->group == channels_[t].object->group) group.push_back(i);
      take_times(t, group, true);
      return;
    }
    std::map<std::string, std::vector<std::size_t>> groups;
    std::map<std::string, std::vector<std::size_t>> stamps;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      groups[channels_[i].object->group].push_back(i);
      if (is_time_stamps(i)) stamps[channels_[i].object->group].push_back(i);
    }
    for (const auto& [group, found] : stamps) {
      if (found.size() == 1) {
        take_times(found.front(), groups[group], false);
      } else {
        for (const std::size_t i : found) take_times(i, {i}, false);
      }
    }
    for (const auto& [group, members] : groups) {
      std::vector<std::size_t> named;
      std::ranges::copy_if(members, std::back_inserter(named),
                           [this](std::size_t i) { return is_named_time(i); });
      if (named.size() == 1 && have_default_clocks(members)) drop_default_clocks(named[0], members);
      if (named.size() == 1 && is_needed(named.front(), members) && increases(named.front()))
        take_times(named.front(), members, false);
    }
  }

  /// What users have written of the rate, of the channel, its group or all, where nothing else
  /// tells it.
  void set_clocks_by_properties() {
    std::map<std::string_view, const TdmsProperties*> groups;
    for (const TdmsObject& object : objects_)
      if (object.depth == 1) groups.emplace(object.group, &object.properties);
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      Channel& channel = record_.channels[i];
      if (!seconds_of_abscissa(channels_[i].part->properties)) continue;
      if (!channel.clock.uniform() || (channel.clock.interval != 0.0 && !is_default(channel.clock)))
        continue;
      const auto group = groups.find(channels_[i].object->group);
      const TdmsProperties* const places[] = {&channels_[i].part->properties,
                                              group == groups.end() ? nullptr : group->second,
                                              root_ == nullptr ? nullptr : &root_->properties};
      for (const TdmsProperties* const place : places)
        if (place != nullptr && set_clock_by(*place, channel)) break;
    }
  }

  static bool set_clock_by(const TdmsProperties& properties, Channel& channel) {
    for (const auto& [name, value] : properties) {
      const std::string key = name == "wf_increment" ? "dt" : name;
      const auto number = number_of(value);
      const std::string text = text_of(value);
      const auto interval =
          number ? interval_by_name(key, *number) : interval_by_name(key, std::string_view(text));
      if (!interval || (name == "wf_increment" && *interval == 1.0)) continue;
      channel.clock.interval = *interval;
      channel.attributes["sample interval"] = fmt::format("by the property '{}'", name);
      return true;
    }
    return false;
  }

  bool is_named_time(std::size_t i) const {
    const Channel& channel = record_.channels[i];
    return (is_time_name(split_head(channel.name).name) || channels_[i].part->is_axis) &&
           (channel.clock.interval == 0.0 || is_default(channel.clock)) &&
           (channel.unit.empty() || channel.quantity == Quantity::time);
  }

  /// "ms" of a channel "Time (ms)" without a unit of its own.
  void take_units_of_times() {
    for (Channel& channel : record_.channels) {
      const ColumnHead head = split_head(channel.name);
      if (!channel.unit.empty() || !is_time_name(head.name) ||
          datasets::quantity_of_unit(head.unit) != Quantity::time)
        continue;
      channel.unit = head.unit;
      channel.quantity = Quantity::time;
    }
  }

  /// An increment of 1, which LabVIEW writes where it knows none.
  static bool is_default(const datasets::SampleClock& clock) {
    return clock.interval == 1.0 && clock.start == 0.0;
  }

  bool have_default_clocks(const std::vector<std::size_t>& channels) const {
    return std::ranges::all_of(
        channels, [this](std::size_t i) { return is_default(record_.channels[i].clock); });
  }

  /// Where the times, which increase, are in other steps than such an increment.
  void drop_default_clocks(std::size_t times, const std::vector<std::size_t>& channels) {
    if (!increases(times) || has_steps_of_one(times)) return;
    for (const std::size_t i : channels) record_.channels[i].clock.interval = 0.0;
    warn(
        fmt::format("wf_increment is 1 s, as LabVIEW writes it where it knows none, and '{}' is in "
                    "other steps: '{}' gives the times",
                    record_.channels[times].name, record_.channels[times].name));
  }

  bool has_steps_of_one(std::size_t t) const {
    std::vector<double> first_two;
    each_number(*file_, stored_[t].samples, [&](std::span<const double> numbers) {
      const std::size_t wanted = 2 - std::min<std::size_t>(2, first_two.size());
      first_two.insert(
          first_two.end(), numbers.begin(),
          numbers.begin() + static_cast<std::ptrdiff_t>(std::min(wanted, numbers.size())));
    });
    if (stored_[t].scaling) stored_[t].scaling(first_two);
    const Channel& channel = record_.channels[t];
    return first_two.size() == 2 &&
           std::abs(channel.scale * (first_two[1] - first_two[0]) - 1.0) < 1e-9;
  }

  /// True where another channel has as many values and no clock.
  bool is_needed(std::size_t t, const std::vector<std::size_t>& channels) const {
    return std::ranges::any_of(channels, [&](std::size_t i) {
      return i != t && record_.channels[i].clock.interval == 0.0 &&
             !record_.channels[i].attributes.contains("domain") &&
             (stored_[i].samples.size() == stored_[t].samples.size() || is_cut_off(i, t));
    });
  }

  /// Whether the file ends within the samples of a channel that would be as many as the times.
  bool is_cut_off(std::size_t i, std::size_t t) const {
    const std::uint64_t n = stored_[t].samples.size();
    return channels_[i].part->announced == n && stored_[i].samples.size() < n;
  }

  bool increases(std::size_t t) const {
    if (stored_[t].imaginary.size() > 0 || stored_[t].joining) return false;
    double last = -std::numeric_limits<double>::infinity();
    bool rises = true;
    std::vector<double> times;
    each_number(*file_, stored_[t].samples, [&](std::span<const double> numbers) {
      times.assign(numbers.begin(), numbers.end());
      if (stored_[t].scaling) stored_[t].scaling(times);
      for (const double time : times) rises = time > std::exchange(last, time) && rises;
    });
    return rises && stored_[t].samples.size() > 1;
  }

  bool is_time_stamps(std::size_t i) const {
    const TdmsType* const type = channels_[i].part->type;
    return type != nullptr && type->role == TdmsRole::time;
  }

  /// Numbers may be those of LabVIEW's clock.
  void tell_of_1904(const std::string& name, double start) {
    constexpr double earliest = 2.9e9, latest = 4.3e9;  // 1995 to 2040, as seconds since 1904
    constexpr double from_1904_to_1970 = 2082844800.0;
    if (!(start > earliest && start < latest)) return;
    const auto second = static_cast<std::time_t>(start - from_1904_to_1970);
    warn(
        fmt::format("'{}' begins at {:.0f} s, which is {:%Y-%m-%dT%H:%M:%S}Z if it counts since "
                    "1904, as LabVIEW does: the times are left as they are",
                    name, start, fmt::gmtime(second)));
  }

  /// Gives the channels of as many values as channel `t` its values as times; `all`: even those
  /// that have a clock.
  void take_times(std::size_t t, const std::vector<std::size_t>& channels, bool all) {
    const std::uint64_t n = stored_[t].samples.size();
    if (n == 0 || stored_[t].imaginary.size() > 0 || stored_[t].joining) return;
    const Channel& times = record_.channels[t];
    double factor = 1.0;
    if (times.unit != "s" && !is_time_stamps(t)) {  // those are in s, whatever is said of them
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
    if (!is_time_stamps(t)) tell_of_1904(times.name, clock.start);
    bool used = false;
    for (const std::size_t i : channels) {
      Channel& channel = record_.channels[i];
      const bool fits =
          stored_[i].samples.size() == n || (is_cut_off(i, t) && found.times.size() == 0);
      if (!fits || (channel.clock.interval > 0.0 && !all)) continue;
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
      warn(fmt::format(
          "channels of '{}' state no sample interval: their times are the {} "
          "in '{}' (--time-column none leaves them out)",
          channels_[t].object->group, is_time_stamps(t) ? "time stamps" : "numbers", times.name));
    if (!used && all)
      warn(
          fmt::format("no other channel of its group has as many values as '{}': it gives no times",
                      times.name));
  }

  std::unique_ptr<MappedFile> file_;
  const std::vector<TdmsObject>& objects_;
  Record record_;
  const ImportOptions& options_;
  std::vector<StoredChannel> stored_;
  std::vector<Part> channels_;  // of record_
  const TdmsObject* root_ = nullptr;
  std::map<std::string, const TdmsObject*> groups_;
  std::map<std::string, Quantity> quantities_;
};

}  // namespace

std::unique_ptr<RecordingReader> tdms_recording(std::unique_ptr<MappedFile> file,
                                                const std::vector<TdmsObject>& objects,
                                                Record record, const ImportOptions& options) {
  return Recording(std::move(file), objects, std::move(record), options).open();
}

}  // namespace impactrig::acquisition
