// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/named_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "acquisition/importers/clock_words.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double latest_start = 1e4;  ///< [s]; larger numbers may be dates in days or seconds
/// Tektronix DPO: of times, one only beside the other.
constexpr std::string_view spacing_word = "spacing", spacing_start_word = "starttime";
/// BIOPAC AcqKnowledge: with `isi_units` the interval of samples, elsewhere that of stimuli.
constexpr std::string_view biopac_word = "isi";

/// "run" of "run.force", "/entry" of "/entry/force"; "" of what stands at the top.
std::string_view group_of(std::string_view name) {
  const std::size_t end = end_of_group(name);
  return end == std::string_view::npos ? std::string_view{} : name.substr(0, end);
}

/// "2" of "force2", "_2" of "force_2"; "" of what ends otherwise, or is a number.
std::string_view number_behind(std::string_view name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  if (last == std::string_view::npos || last + 1 == name.size()) return {};
  return name.substr(name[last] == '_' && last > 0 ? last : last + 1);
}

/// "#2" of "t2" and "time2", of which all that ends in 2 may be, in its group.
std::string whose_numbered_time(std::string_view name) {
  const std::string_view number = number_behind(name);
  const std::string_view stem = name.substr(0, name.size() - number.size());
  const std::size_t end = end_of_group(name);
  const std::string_view word = stem.substr(end == std::string_view::npos ? 0 : end + 1);
  if (number.empty() || (word != "t" && lowered(word) != "time")) return {};
  return fmt::format("{}#{}", lowered(stem.substr(0, stem.size() - word.size())), number);
}

/// "force" of "t_force", "time_force" and "force_time", "Data1_force" of "Data1_time_force": what
/// an array is the time of by its name, in lower case; "" of other names. "x_t" is a derivative.
std::string whose_time(std::string_view name) {
  if (std::string numbered = whose_numbered_time(name); !numbered.empty()) return numbered;
  const std::size_t end = end_of_group(name);
  const std::size_t begin = end == std::string_view::npos ? 0 : end + 1;
  std::string rest = lowered(name.substr(0, begin));
  int words = 0, times = 0;
  const std::string_view last = name.substr(begin);
  for (std::size_t at = 0; at <= last.size();) {
    const std::size_t mark = std::min(last.find('_', at), last.size());
    const std::string word = lowered(last.substr(at, mark - at));
    const bool is_t = at == 0 && last.starts_with("t_");
    at = mark + 1;
    if (is_t || word == "time") {
      ++times;
      continue;
    }
    rest += (words++ > 0 ? "_" : "") + word;
  }
  return times == 1 && words > 0 ? rest : std::string();
}

/// What there is to know of times before they are judged.
struct Ends {
  double first = 0.0;
  double last = 0.0;
  std::uint64_t count = 0;
  bool increasing = true;  ///< throughout, and finite
  bool finite = true;

  void add(std::span<const double> values) {
    for (const double value : values) {
      finite = finite && std::isfinite(value);
      increasing = increasing && std::isfinite(value) && (count == 0 || value > last);
      if (count++ == 0) first = value;
      last = value;
    }
  }
};

/// Dividing keeps decimal digits where multiplying by 0.001 would not.
double in_seconds(double time, double unit) {
  const double inverse = std::round(1.0 / unit);
  return std::abs(inverse * unit - 1.0) < 1e-15 ? time / inverse : time * unit;
}

/// What an array's times came to.
struct TimesFound {
  ArrayClock clock;
  bool usable = false;
  std::string unusable;  ///< why not
  std::string why;       ///< they are taken as times
};

class ClockFinder {
 public:
  ClockFinder(const std::string& path, const std::vector<NamedArray>& arrays,
              const EachNumber& each_number, const ImportOptions& options)
      : path_(path),
        arrays_(arrays),
        each_number_(each_number),
        wanted_(options.time_column),
        head_only_(options.head_only) {}

  ArrayClocks find() {
    result_.clocks.resize(arrays_.size());
    const bool none = wanted_ == "none";
    const bool stated = wanted_ && !none;
    const std::size_t column = stated ? stated_column() : 0;
    find_spacings();
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
      if (stated) break;
      const std::string word = last_word(arrays_[i].name);
      const std::string group(group_of(arrays_[i].name));
      if (!none && arrays_[i].real && arrays_[i].samples > 1) {
        if (is_time(i, arrays_[i].name)) add_times(i, group);
        for (const std::string& other : arrays_[i].other_names)
          if (is_time(i, other)) add_times(i, std::string(group_of(other)));
      }
      if (arrays_[i].real && arrays_[i].samples == 1) take_number(word, group, i);
      if (none || !arrays_[i].real || arrays_[i].samples < 2) continue;
      if (std::string whose = whose_time(arrays_[i].name); !whose.empty())
        own_times_.try_emplace(std::pair(std::move(whose), arrays_[i].samples), i);
    }
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
      if (arrays_[i].samples < 2) continue;
      if (stated) {
        if (arrays_[i].samples == arrays_[column].samples) use_times(i, column, "stated");
        continue;
      }
      std::vector<std::string> groups = {std::string(group_of(arrays_[i].name))};
      for (const std::string& other : arrays_[i].other_names) groups.emplace_back(group_of(other));
      for (std::string_view around = group_of(arrays_[i].name); !around.empty();) {
        around = group_of(around);
        groups.emplace_back(around);  // the last is the top
      }
      const auto times = [&](const std::string& group) { return by_times(i, group); };
      const auto number = [&](const std::string& group) { return by_number(i, group); };
      const auto said = [&](const std::string& group) { return has_said_times(i, group); };
      const bool any = (!std::ranges::any_of(groups, said) && by_own_times(i)) ||
                       std::ranges::any_of(groups, times) || by_own_times(i);
      if (!any) std::ranges::any_of(groups, number);
    }
    for (const auto& [whose, times] : own_times_)
      if (const auto axis = axes_.find(times); axis != axes_.end() && axis->second.usable)
        result_.clocks[times] = axis->second.clock;
    if (!wanted_) take_numbers_beside();
    if (!wanted_) take_first_columns();
    if (!wanted_) tell_other_lengths();
    return std::move(result_);
  }

 private:
  bool is_time(std::size_t index, const std::string& name) const {
    return arrays_[index].time || is_named_as_time(name);
  }

  std::size_t stated_column() const {
    for (std::size_t i = 0; i < arrays_.size(); ++i)
      if (arrays_[i].name == *wanted_ && arrays_[i].real) return i;
    std::string list;
    for (const NamedArray& array : arrays_) {
      if (list.size() > 400) {
        list += ", ...";
        break;
      }
      list += (list.empty() ? "'" : ", '") + array.name + "'";
    }
    datasets::SourcePosition place;
    place.file = path_;
    throw datasets::InputError(
        place, fmt::format("there is no array '{}' of real numbers for the time; the arrays are {}",
                           *wanted_, list.empty() ? "none" : list));
  }

  void add_times(std::size_t index, const std::string& group) {
    constexpr std::size_t most = 10;  // of the same length, so that the search ends
    std::vector<std::size_t>& list = times_[std::pair(group, arrays_[index].samples)];
    if (list.size() < most && std::ranges::find(list, index) == list.end()) list.push_back(index);
  }

  /// Groups that have both words of a Tektronix oscilloscope.
  void find_spacings() {
    std::set<std::string> starts;
    for (const NamedArray& array : arrays_)
      if (array.samples == 1 && last_word(array.name) == spacing_start_word)
        starts.emplace(group_of(array.name));
    for (const NamedArray& array : arrays_)
      if (array.samples == 1 && last_word(array.name) == spacing_word)
        if (const std::string group(group_of(array.name)); starts.contains(group))
          spaced_.insert(group);
  }

  void take_number(const std::string& word, const std::string& group, std::size_t index) {
    const bool spaced = spaced_.contains(group);
    const bool interval = is_interval_word(word) || (spaced && word == spacing_word) ||
                          (word == biopac_word && arrays_[index].has_unit);
    const bool start = is_start_word(word);
    if (!interval && !start && !is_rate_word(word)) return;
    Ends value;
    each_number_(index, {0, arrays_[index].samples},
                 [&value](std::span<const double> numbers) { value.add(numbers); });
    if (value.count != 1 || !std::isfinite(value.first)) return;
    if (start) {
      if (std::abs(value.first) < latest_start)
        starts_.emplace(group, std::pair(value.first, index));
      return;
    }
    const double unit = arrays_[index].seconds;
    const double seconds = interval ? value.first * unit : unit / value.first;
    if (!(seconds > 0.0) || !std::isfinite(seconds)) {
      unusable_.try_emplace(group, fmt::format("'{}' as {:.9g}", arrays_[index].name, value.first));
      return;
    }
    const auto [known, is_first] = intervals_.try_emplace(group, seconds, index);
    if (!is_first && differ(seconds, known->second.first))
      result_.warnings.push_back(
          fmt::format("'{}' says that samples are {:.9g} s apart, '{}' {:.9g} s: '{}' is used",
                      arrays_[known->second.second].name, known->second.first, arrays_[index].name,
                      seconds, arrays_[known->second.second].name));
  }

  static bool differ(double a, double b) { return std::abs(a - b) > 1e-3 * std::abs(b); }

  /// A number of the same group, or at the top, may say something else than the times.
  void compare_with_number(std::size_t times, const std::string& group) {
    auto found = intervals_.find(group);
    if (found == intervals_.end()) found = intervals_.find({});
    const double step = axes_.at(times).clock.interval;
    if (found == intervals_.end() || !differ(step, found->second.first)) return;
    const auto [seconds, number] = found->second;
    if (!compared_.insert(std::pair(times, number)).second) return;
    std::string_view unit;
    for (const auto& [name, size] : {std::pair{"ms", 1e3}, std::pair{"us", 1e6}})
      if (!differ(step, size * seconds)) unit = name;
    result_.warnings.push_back(fmt::format(
        "'{}' steps by {:.9g} s, but '{}' says that samples are {:.9g} s apart{}: '{}' is used "
        "(--time-column none takes '{}')",
        arrays_[times].name, step, arrays_[number].name, seconds,
        unit.empty() ? "" : fmt::format(", as if the times were in {}", unit), arrays_[times].name,
        arrays_[number].name));
  }

  /// "meta.fs" beside "data": the interval of a group without arrays of its own, for arrays without
  /// a clock, where no other group tells another one.
  void take_numbers_beside() {
    if (intervals_.empty()) return;
    std::set<std::string, std::less<>> groups;  // that have arrays, and those around them
    for (const NamedArray& array : arrays_)
      for (std::string_view group = group_of(array.name); array.samples > 1 && !group.empty();
           group = group_of(group))
        groups.emplace(group);
    const auto& [first, told] = *intervals_.begin();
    for (const auto& [group, interval] : intervals_)
      if (group.empty() || groups.contains(group) || differ(interval.first, told.first)) return;
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
      const ArrayClock& clock = result_.clocks[i];
      if (arrays_[i].samples > 1 && clock.interval == 0.0 && !clock.times && clock.unusable.empty())
        by_number(i, first);
    }
  }

  /// Matrices of which nothing tells the clock: a first column that increases evenly, and does not
  /// count samples, beside a second that does not increase.
  void take_first_columns() {
    for (std::size_t i = 0; i + 1 < arrays_.size(); ++i) {
      const std::string& name = arrays_[i].name;
      if (!name.ends_with(":1") || !arrays_[i].real || result_.clocks[i].interval > 0.0) continue;
      const std::string_view matrix = std::string_view(name).substr(0, name.size() - 1);
      if (arrays_[i + 1].name != fmt::format("{}2", matrix)) continue;
      const Ends first = ends_of(i), second = ends_of(i + 1);
      const double step = (first.last - first.first) /
                          static_cast<double>(std::max<std::uint64_t>(first.count, 2) - 1);
      if (!first.increasing || second.increasing || step == 1.0) continue;
      axes_[i] = look_at(i, "the first column, since it increases evenly", true);
      for (std::size_t k = i; k < arrays_.size() && arrays_[k].name.starts_with(matrix); ++k)
        use_times(k, i, {});
    }
  }

  /// Of arrays without a clock, or that have it of a number, beside times that are a few more or
  /// fewer.
  void tell_other_lengths() {
    std::set<std::size_t> told;
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
      ArrayClock& clock = result_.clocks[i];
      const auto number = by_numbers_.find(i);
      const bool open = number != by_numbers_.end() ||
                        (clock.interval == 0.0 && !clock.times && clock.unusable.empty());
      if (arrays_[i].samples < 2 || !open) continue;
      const std::string group(group_of(arrays_[i].name));
      const auto found = times_.lower_bound(std::pair(group, std::uint64_t{0}));
      if (found == times_.end() || found->first.first != group) continue;
      const std::size_t times = found->second.front();
      const auto beside = static_cast<double>(arrays_[times].samples);
      const auto samples = static_cast<double>(arrays_[i].samples);
      if (beside == samples || std::abs(beside - samples) > std::max(1.0, 0.01 * samples)) continue;
      if (number == by_numbers_.end())
        clock.unusable = fmt::format("'{}' with {} numbers for {} samples", arrays_[times].name,
                                     arrays_[times].samples, arrays_[i].samples);
      else if (told.insert(times).second)
        result_.warnings.push_back(fmt::format(
            "'{}' has {} numbers and '{}' {} samples, so they are not taken as its times: '{}' "
            "tells the interval",
            arrays_[times].name, arrays_[times].samples, arrays_[i].name, arrays_[i].samples,
            arrays_[number->second].name));
    }
  }

  /// The numbers that are looked at from the first on: all, but where the head alone is asked for.
  NumberRange looked_at(std::size_t index) const {
    constexpr std::uint64_t few = 32768;
    const std::uint64_t all = arrays_[index].samples;
    return {0, head_only_ && all > 2 * few ? few : all};
  }

  Ends ends_of(std::size_t index) {
    Ends ends;
    const auto add = [&ends](std::span<const double> values) { ends.add(values); };
    const std::uint64_t all = arrays_[index].samples;
    const NumberRange first = looked_at(index);
    each_number_(index, first, add);
    if (first.count < all) each_number_(index, {all - first.count, first.count}, add);
    if (ends.count == std::min(all, 2 * first.count)) ends.count = all;
    return ends;
  }

  bool by_own_times(std::size_t index) {
    const std::string& name = arrays_[index].name;
    const std::size_t end = end_of_group(name);
    const std::string group = lowered(name.substr(0, end == std::string::npos ? 0 : end + 1));
    const auto by = [&](std::string whose) {
      const auto found = own_times_.find(std::pair(std::move(whose), arrays_[index].samples));
      return found != own_times_.end() && found->second != index &&
             ends_of(found->second).increasing && use_times(index, found->second, "by its name");
    };
    return by(lowered(name)) || by(fmt::format("{}#{}", group, number_behind(name)));
  }

  /// Of which the file says that they are, not their name alone.
  bool has_said_times(std::size_t index, const std::string& group) const {
    const auto found = times_.find(std::pair(group, arrays_[index].samples));
    return found != times_.end() && std::ranges::any_of(found->second, [this](std::size_t times) {
             return arrays_[times].time;
           });
  }

  bool by_times(std::size_t index, const std::string& group) {
    const auto found = times_.find(std::pair(group, arrays_[index].samples));
    if (found == times_.end()) return false;
    for (const std::size_t times : found->second) {
      if (!use_times(index, times, arrays_[times].time ? "as the file says" : "by its name"))
        continue;
      compare_with_times(times, found->second);
      if (times != index) compare_with_number(times, std::string(group_of(arrays_[index].name)));
      return true;
    }
    return false;
  }

  /// Others of the group may claim to be the times as well, and say something else.
  void compare_with_times(std::size_t used, const std::vector<std::size_t>& all) {
    if (!compared_times_.insert(used).second) return;
    for (const std::size_t other : all) {
      if (other == used || arrays_[other].time != arrays_[used].time) continue;
      const Ends mine = ends_of(used), its = ends_of(other);
      if (!its.increasing) continue;
      const auto step = [this](const Ends& ends, std::size_t index) {
        return arrays_[index].seconds * (ends.last - ends.first) /
               static_cast<double>(ends.count - 1);
      };
      const double start = arrays_[used].seconds * mine.first;
      const double its_start = arrays_[other].seconds * its.first;
      if (!differ(step(its, other), step(mine, used)) &&
          std::abs(its_start - start) <= 1e-3 * step(mine, used))
        continue;
      result_.warnings.push_back(fmt::format(
          "both '{0}' and '{1}' claim to be the time of {2} samples: '{0}' is used, from {3:.9g} s "
          "in steps of {4:.9g} s; '{1}' goes from {5:.9g} s in steps of {6:.9g} s (--time-column "
          "states one)",
          arrays_[used].name, arrays_[other].name, mine.count, start, step(mine, used), its_start,
          step(its, other)));
    }
  }

  bool use_times(std::size_t index, std::size_t times, std::string_view why) {
    auto [found, is_new] = axes_.try_emplace(times);
    TimesFound& axis = found->second;
    if (is_new) axis = look_at(times, why);
    if (axis.usable && (index != times || wanted_) && told_times_.insert(times).second)
      told(times, axis.why);
    if (axis.usable)
      result_.clocks[index] = axis.clock;
    else if (result_.clocks[index].unusable.empty())
      result_.clocks[index].unusable = axis.unusable;
    return axis.usable;
  }

  /// `only_even`: times that are not uniform are none.
  TimesFound look_at(std::size_t index, std::string_view why, bool only_even = false) {
    TimesFound found;
    const std::string& name = arrays_[index].name;
    const Ends ends = ends_of(index);
    if (!ends.increasing || ends.count < 2) {
      if (ends.count > 1)
        result_.warnings.push_back(
            fmt::format("'{}' does not increase throughout: it is not taken as the time", name));
      found.unusable = fmt::format(
          "'{}', which {}", name,
          ends.finite ? "does not increase throughout" : "holds numbers that are not finite");
      return found;
    }
    const double step = (ends.last - ends.first) / static_cast<double>(ends.count - 1);
    if (!arrays_[index].has_unit && may_count_days(ends.first, step)) {
      found.unusable = fmt::format(
          "'{}' from {:.9g} on in steps of {:.3g}, which may be days (--units states its unit)",
          name, ends.first, step);
      return found;
    }
    take_unit_since_1970(ends.first, arrays_[index]);
    const double unit = arrays_[index].seconds;
    TimeAxisCheck check(in_seconds(ends.first, unit), in_seconds(ends.last, unit), ends.count);
    std::vector<double> seconds;
    each_number_(index, looked_at(index), [&](std::span<const double> values) {
      if (unit == 1.0) return check.add(values);
      seconds.assign(values.begin(), values.end());
      for (double& time : seconds) time = in_seconds(time, unit);
      check.add(seconds);
    });
    if (only_even && !check.uniform()) return found;
    const TimeAxis axis = check.axis();
    if (!axis.warning.empty())
      result_.warnings.push_back(fmt::format("'{}': {}", name, axis.warning));
    found.clock.start = axis.clock.start;
    found.clock.interval = axis.clock.interval;
    found.clock.seconds = unit;
    if (!check.uniform()) found.clock.times = index;
    found.usable = true;
    found.why = why;
    return found;
  }

  void take_unit_since_1970(double first, NamedArray& times) {
    const std::string unit = times.has_unit ? std::string() : unit_since_1970(first);
    if (unit.empty()) return;
    take_unit(times, unit);
    result_.warnings.push_back(counts_since_1970(times.name, unit));
  }

  bool by_number(std::size_t index, const std::string& group) {
    ArrayClock& clock = result_.clocks[index];
    const auto unusable = unusable_.find(group);
    if (unusable != unusable_.end() && clock.unusable.empty()) clock.unusable = unusable->second;
    const auto found = intervals_.find(group);
    if (found == intervals_.end()) return false;
    clock.interval = found->second.first;
    by_numbers_.emplace(index, found->second.second);
    const auto start = starts_.find(group);
    const std::size_t source = found->second.second;
    if (start != starts_.end()) {
      const auto [value, number] = start->second;
      const bool as_interval = !arrays_[number].has_unit && arrays_[source].has_unit &&
                               !is_rate_word(last_word(arrays_[source].name));
      clock.start = value * arrays_[as_interval ? source : number].seconds;
    }
    if (told_numbers_.insert(source).second) {
      told(source, fmt::format("an interval of {:.9g} s by its name", clock.interval));
    }
    return true;
  }

  void told(std::size_t index, std::string_view why) {
    const std::string text = fmt::format("{} ({})", arrays_[index].name, why);
    for (std::string* const list : {&result_.time_column, &result_.without_unit}) {
      if (list->size() > 400 || (list == &result_.without_unit && arrays_[index].has_unit))
        continue;
      if (!list->empty()) *list += "; ";
      *list += text;
    }
  }

  const std::string& path_;
  std::vector<NamedArray> arrays_;
  const EachNumber& each_number_;
  const std::optional<std::string>& wanted_;
  bool head_only_;
  ArrayClocks result_;
  /// Arrays that may hold the times, by group and length, in their order.
  std::map<std::pair<std::string, std::uint64_t>, std::vector<std::size_t>> times_;
  std::map<std::string, std::pair<double, std::size_t>> intervals_;  ///< by group
  std::map<std::string, std::string> unusable_;                      ///< by group
  std::map<std::string, std::pair<double, std::size_t>> starts_;     ///< by group
  /// Times of one array each, by its name in lower case and its length.
  std::map<std::pair<std::string, std::uint64_t>, std::size_t> own_times_;
  std::set<std::string> spaced_;  ///< groups
  std::map<std::size_t, TimesFound> axes_;
  std::map<std::size_t, std::size_t> by_numbers_;  ///< the number that an array's clock is of
  std::set<std::size_t> told_numbers_, told_times_;
  std::set<std::size_t> compared_times_;
  std::set<std::pair<std::size_t, std::size_t>> compared_;  ///< times and a number
};

}  // namespace

void take_unit(NamedArray& array, const std::string& unit) {
  if (unit.empty()) return;
  const auto time = datasets::conversion(unit, "s");
  array.has_unit = true;
  // a single number may be a rate
  array.real = array.real && (time.has_value() || array.samples == 1);
  if (time) array.seconds = time->factor;
  if (const auto rate = datasets::conversion(unit, "Hz")) array.seconds = 1.0 / rate->factor;
}

ArrayClocks clocks_by_name(const std::string& path, const std::vector<NamedArray>& arrays,
                           const EachNumber& each_number, const ImportOptions& options) {
  return ClockFinder(path, arrays, each_number, options).find();
}

}  // namespace impactrig::acquisition
