// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/average_shots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/repeated_shots.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "acquisition/conditioning/shift_estimate.hpp"
#include "acquisition/conditioning/trace.hpp"
#include "datasets/band_limited.hpp"
#include "datasets/input_error.hpp"
#include "datasets/number_text.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::BandLimited;
using datasets::Channel;
using datasets::Edit;
using datasets::InputError;
using datasets::Record;

namespace {

constexpr double alike = 0.05;      ///< spread of peaks
constexpr double on_sample = 1e-3;  ///< of a step

/// A channel of a shot, to be read anywhere: bridged where samples are not sound.
struct Reading {
  Trace trace;  ///< in the first shot's unit, on its times
  double next;  ///< first touch of the second impact [s], on the first shot's times
};

/// Marks what find_impacts left out of a shot's force: spikes, and samples that a recorder lost.
void leave_out_spikes(const Shot& shot, const std::string& channel, Trace& trace) {
  const auto& force = shot.impact.force;
  if (!force || force->channel != channel) return;
  for (std::size_t i = 0; i < force->valid.size(); ++i) {
    if (force->valid[i] != 0) continue;
    const double at = std::round(trace.index(force->time(i)));
    if (!(at >= 0.0 && at < static_cast<double>(trace.values.size()))) continue;
    if (trace.valid.empty()) trace.valid.assign(trace.values.size(), 1);
    trace.valid[static_cast<std::size_t>(at)] = 0;
  }
  bridge_invalid(trace.values, trace.valid);
}

/// In the channel's unit, its touch on the first shot's as far as `shot.shift` says.
Reading reading_of(const Shot& shot, const Channel& channel) {
  Reading reading{{channel.quantity, channel.clock.start, channel.clock.interval,
                   sound_values(channel), sound_marks(channel)},
                  shot.next - shot.shift};
  leave_out_spikes(shot, channel.name, reading.trace);
  reading.trace.start -= shot.shift;
  return reading;
}

Reading reading_like(const Channel& like, const Shot& shot) {
  const Channel& channel = *channel_of(shot, like.name);
  Reading reading = reading_of(shot, channel);
  if (channel.unit == like.unit) return reading;
  const auto conversion = datasets::conversion(channel.unit, like.unit);
  if (!conversion)
    throw InputError(whole_file(file_of(shot)),
                     fmt::format("channel '{}' is in '{}' here and in '{}' in the first shot",
                                 like.name, channel.unit, like.unit));
  for (double& value : reading.trace.values)
    value = conversion->factor * value + conversion->offset;
  return reading;
}

/// Where shots are compared: the first one's contact between rests as long, as far as its next one.
datasets::TimeSpan compared_window(const Shot& first) {
  const double contact = first.impact.end - first.impact.start;
  return {first.impact.start - contact, std::min(first.impact.end + contact, first.next)};
}

/// Lays the shots on the first one: first touch on first touch, then trigger on trigger.
void lay_on_first(std::vector<Shot>& shots, std::vector<std::string>& warnings) {
  const Shot& first = shots.front();
  const Trace reference = reading_of(first, trigger_of(first)).trace;
  for (std::size_t k = 1; k < shots.size(); ++k) {
    Shot& shot = shots[k];
    shot.shift = shot.impact.start - first.impact.start;
    const double contact =
        std::max(first.impact.end - first.impact.start, shot.impact.end - shot.impact.start);
    try {
      const ShiftEstimate found = estimate_shift(
          reference, reading_of(shot, trigger_of(shot)).trace, compared_window(first), contact);
      shot.shift += found.value;
      shot.shift_uncertainty = found.uncertainty;
    } catch (const std::invalid_argument& why) {
      warnings.push_back(fmt::format(
          "{} is laid on {} by first touch alone, which blurs the mean: '{}' does not tell better "
          "({}).",
          file_of(shot), file_of(first), shot.impact.trigger, why.what()));
    }
  }
}

/// Sums over shots, sample by sample.
struct Sums {
  std::vector<double> n, mean, squares;

  explicit Sums(std::size_t size) : n(size, 0.0), mean(size, 0.0), squares(size, 0.0) {}

  void add(std::size_t i, double value) {  // Welford
    n[i] += 1.0;
    const double step = value - mean[i];
    mean[i] += step / n[i];
    squares[i] += step * (value - mean[i]);
  }
};

/// The times of the first shot's channel that every reading reaches before its next impact.
IndexRange common_samples(const Channel& first, const std::vector<Reading>& readings) {
  double begin = 0.0, end = static_cast<double>(first.size());
  for (const Reading& reading : readings) {
    const double ratio = first.clock.interval / reading.trace.interval;
    const double at_start = reading.trace.index(first.clock.start);
    begin = std::max(begin, std::ceil(-at_start / ratio - 1e-9));
    const double last = static_cast<double>(reading.trace.values.size() - 1);
    end = std::min(end, std::floor((last - at_start) / ratio + 1e-9) + 1.0);
    // Two samples less than up to touch, which is known to a sample at best.
    end =
        std::min(end, std::floor((reading.next - first.clock.start) / first.clock.interval) - 2.0);
  }
  if (!(begin < end)) return {};
  return {static_cast<std::size_t>(begin), static_cast<std::size_t>(end)};
}

Sums sums_of(const Channel& first, const IndexRange& range, const std::vector<Reading>& readings) {
  Sums sums(range.size());
  for (const Reading& reading : readings) {
    const Trace& trace = reading.trace;
    const double ratio = first.clock.interval / trace.interval;
    const BandLimited signal(trace.values, std::max(1.0, ratio));
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const double at = trace.index(first.clock.time(i));
      if (!sound_at(trace, at)) continue;
      const double nearest = std::round(at);
      // Nearly on a sample, and at no other rate, the sample itself.
      const bool exact = std::abs(at - nearest) < on_sample && ratio <= 1.0;
      sums.add(i - range.begin,
               exact ? trace.values[static_cast<std::size_t>(nearest)] : signal(at));
    }
  }
  return sums;
}

/// What came off the clocks of the shots' channels of that name, in the mean; none where nothing
/// did. Uncertainties are one sensor's, so they do not average out.
std::optional<datasets::Delay> mean_delay(const std::vector<Shot>& shots, const std::string& name) {
  datasets::Delay mean{0.0, 0.0, true};
  bool any = false;
  for (const Shot& shot : shots) {
    const Channel& channel = *channel_of(shot, name);
    if (!channel.delay) continue;
    any = true;
    mean.value += channel.delay->value / static_cast<double>(shots.size());
    mean.uncertainty += channel.delay->uncertainty / static_cast<double>(shots.size());
  }
  return any ? std::optional(mean) : std::nullopt;
}

/// The mean and its neighbour, the standard deviation.
std::array<Channel, 2> channels_of(const Channel& first, const IndexRange& range,
                                   const Sums& sums) {
  Channel mean = first;
  mean.clock.start = first.clock.time(range.begin);
  mean.valid.clear();
  mean.attributes["shots"] = fmt::format("{:.0f}", *std::ranges::max_element(sums.n));
  Channel spread = mean;
  spread.name = first.name + ", standard deviation";
  spread.quantity = datasets::Quantity::other;
  spread.calibration.reset();
  std::vector<double> deviation(sums.n.size(), 0.0);
  for (std::size_t i = 0; i < sums.n.size(); ++i) {
    if (sums.n[i] >= 2.0) {
      deviation[i] = std::sqrt(sums.squares[i] / (sums.n[i] - 1.0));
      continue;
    }
    if (mean.valid.empty()) mean.valid.assign(sums.n.size(), 1);
    mean.valid[i] = 0;
  }
  spread.valid = mean.valid;
  replace_values(mean, std::vector<double>(sums.mean));
  replace_values(spread, std::move(deviation));
  return {std::move(mean), std::move(spread)};
}

/// How far the shots differ in one number.
struct Likeness {
  double spread = 0.0;             ///< relative standard deviation
  const Shot* furthest = nullptr;  ///< from the median; of two shots none
  double off = 0.0;                ///< by how much of the median it is
};

template <typename Value>
Likeness likeness_of(const std::vector<Shot>& shots, const Value& value) {
  Sums sums(1);
  std::vector<double> values;
  for (const Shot& shot : shots) {
    sums.add(0, value(shot));
    values.push_back(value(shot));
  }
  Likeness result;
  result.spread = std::sqrt(sums.squares[0] / (sums.n[0] - 1.0)) / std::abs(sums.mean[0]);
  if (shots.size() < 3) return result;
  const double middle = median(values);
  result.furthest = &*std::ranges::max_element(
      shots, {}, [&](const Shot& shot) { return std::abs(value(shot) - middle); });
  result.off = value(*result.furthest) / middle - 1.0;
  return result;
}

void warn_of_no_mean(const std::string& channel, std::string_view reason, Record& result) {
  result.warnings.push_back(fmt::format("Channel '{}' is not in the mean: {}.", channel, reason));
}

void warn_of_fewer(const std::string& channel, std::size_t shots, const Sums& sums,
                   Record& result) {
  const auto all = static_cast<double>(shots);
  const auto fewer = std::ranges::count_if(sums.n, [all](double n) { return n < all; });
  if (fewer == 0) return;
  result.warnings.push_back(
      fmt::format("'{}': {} of {} samples are the mean of fewer than all {} shots, down to {:.0f}: "
                  "those of the "
                  "others are not valid.",
                  channel, fewer, sums.n.size(), shots, *std::ranges::min_element(sums.n)));
}

double peak_of(const Shot& shot) {
  return shot.impact.peak;
}

void warn_of_unlike(std::string_view what, const Likeness& likeness, Record& result) {
  if (!(likeness.spread > alike)) return;
  std::string warning = fmt::format(
      "The {} of the shots differ with a standard deviation of {}; contact is not linear, so fit "
      "the shots one by one instead of their mean",
      what, datasets::percent(likeness.spread));
  if (likeness.furthest != nullptr)
    warning += fmt::format(", or leave out {}, which is {} {} their median",
                           file_of(*likeness.furthest), datasets::percent(std::abs(likeness.off)),
                           likeness.off < 0.0 ? "below" : "above");
  result.warnings.push_back(warning + ".");
}

/// How much later than in the first shot, triggers laid on each other, a shot shows a channel.
/// None where the two have no likeness.
std::optional<ShiftEstimate> delay_in(const Reading& reading, const Reading& reference,
                                      const Shot& first) {
  const double contact = first.impact.end - first.impact.start;
  try {
    return estimate_shift(reference.trace, reading.trace, compared_window(first), 0.5 * contact);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// Of three shots or more the one that shows a channel at another time, beside the trigger, than
/// most do: by more than a sample and five standard uncertainties.
void warn_of_delay_left(const std::vector<Shot>& shots, const Channel& channel,
                        const std::vector<Reading>& readings, Record& result) {
  if (shots.size() < 3 || channel.name == shots.front().impact.trigger) return;
  std::vector<double> values{0.0};
  std::vector<std::pair<const Shot*, ShiftEstimate>> delays{{&shots.front(), {}}};
  for (std::size_t k = 1; k < shots.size(); ++k)
    if (const auto delay = delay_in(readings[k], readings.front(), shots.front())) {
      values.push_back(delay->value);
      delays.emplace_back(&shots[k], *delay);
    }
  if (values.size() < 3) return;
  const double usual = median(values);
  for (const auto& [shot, delay] : delays) {
    const double off = delay.value - usual;
    if (std::abs(off) <= std::max(channel.clock.interval, 5.0 * delay.uncertainty)) continue;
    result.warnings.push_back(fmt::format(
        "{} shows '{}' {:.3g} s {} than most shots do, beside '{}': the mean is blurred by it. "
        "State the delay in that shot's map, or leave the shot out.",
        file_of(*shot), channel.name, std::abs(off), off > 0.0 ? "later" : "earlier",
        shot->impact.trigger));
  }
}

/// A warning without its numbers.
std::string wording_of(const std::string& warning) {
  std::string words;
  for (const char c : warning)
    if (!(c >= '0' && c <= '9') && c != '.' && c != '-' && c != '+') words += c;
  return words;
}

/// What is said of the single shots, once where it is the same of several but for numbers.
std::vector<std::string> own_warnings(const std::vector<Shot>& shots) {
  struct Told {
    std::string words, text;
    std::vector<std::string> files;
  };

  std::vector<Told> all;
  for (const Shot& shot : shots)
    for (const std::string& warning : shot.record->warnings) {
      const std::string words = wording_of(warning);
      auto told = std::ranges::find(all, words, &Told::words);
      if (told == all.end()) told = all.insert(all.end(), {words, warning, {}});
      if (told->files.empty() || told->files.back() != file_of(shot))
        told->files.push_back(file_of(shot));
    }
  std::vector<std::string> warnings;
  for (const Told& told : all) {
    const std::vector<std::string> others(told.files.begin() + 1, told.files.end());
    warnings.push_back(fmt::format("{}: {}", told.files.front(), told.text));
    if (!others.empty()) warnings.back() += fmt::format(" (Likewise {}.)", listed(others));
  }
  return warnings;
}

/// What was done to one shot alone.
void note_own_edits(const std::vector<Edit>& edits, Edit& shot) {
  const auto note = [&](const Edit& own, const std::string& key, std::string_view words) {
    const auto value = own.parameters.find(key);
    if (value != own.parameters.end())
      shot.parameters[fmt::format("{} '{}'", words, own.channel)] = value->second;
  };
  for (const Edit& own : edits) {
    if (own.what == "remove delay" || own.what == "align") note(own, "delay", "delay taken off");
    if (own.what == "repair dropouts") note(own, "samples", "dropouts of");
  }
}

void note_shots(const std::vector<Shot>& shots, Record& result) {
  for (std::size_t k = 1; k < shots.size(); ++k) {
    const datasets::Provenance& from = shots[k].record->provenance;
    Edit edit{"average shots", "", {{"file", from.source_file}, {"sha256", from.sha256}}};
    edit.parameters["shift"] = fmt::format("{:.9g} s", shots[k].shift);
    edit.parameters["shift uncertainty"] =
        shots[k].shift_uncertainty ? fmt::format("{:.2g} s", *shots[k].shift_uncertainty)
                                   : "not known: by first touch";
    note_own_edits(from.edits, edit);
    result.provenance.edits.push_back(std::move(edit));
  }
  const Likeness peaks = likeness_of(shots, peak_of);
  Edit edit{"average shots",
            "",
            {{"shots", std::to_string(shots.size())},
             {"trigger", shots.front().impact.trigger},
             {"peaks", "standard deviation " + datasets::percent(peaks.spread)}}};
  warn_of_unlike("peaks", peaks, result);
  if (std::ranges::all_of(shots, [](const Shot& shot) { return approach_of(shot) != 0.0; })) {
    const Likeness speeds = likeness_of(shots, approach_of);
    edit.parameters["approach velocities"] =
        "standard deviation " + datasets::percent(speeds.spread);
    warn_of_unlike("approach velocities", speeds, result);
  }
  result.provenance.edits.push_back(std::move(edit));
}

/// The names of all shots' channels, those of the first one in front.
std::vector<std::string> names_in(const std::vector<Shot>& shots) {
  std::vector<std::string> names;
  for (const Shot& shot : shots)
    for (const Channel& channel : shot.record->channels)
      if (std::ranges::find(names, channel.name) == names.end()) names.push_back(channel.name);
  return names;
}

/// Why a mean of histories cannot have a channel of that name; empty where it can.
std::string reason_against(const std::string& name, const std::vector<Shot>& shots) {
  std::vector<std::string> without;
  for (const Shot& shot : shots)
    if (channel_of(shot, name) == nullptr) without.push_back(file_of(shot));
  if (!without.empty()) return "it is not in " + listed(without);
  for (const Shot& shot : shots) {
    const Channel& channel = *channel_of(shot, name);
    if (channel.size() == 1) return "it is a single value in " + file_of(shot);
    try {
      refuse_unusable_clock(channel, file_of(shot));
    } catch (const InputError& error) {
      return error.what();
    }
    if (sound_samples(channel, {0, channel.size()}) == 0)
      return "it has no sound sample in " + file_of(shot);
  }
  return {};
}

/// Single values in all shots, which are settings or the like: whether they are one, too.
bool is_one_value(const std::string& name, const std::vector<Shot>& shots, std::string& reason) {
  const Channel* const first = channel_of(shots.front(), name);
  std::vector<double> values;
  for (const Shot& shot : shots) {
    const Channel* const channel = channel_of(shot, name);
    if (channel == nullptr || channel->size() != 1 || channel->unit != first->unit) return false;
    values.push_back(channel->value(0));
  }
  const auto [least, most] = std::ranges::minmax(values);
  if (least == most) return true;
  reason = fmt::format("it is a single value a shot, from {:.6g} to {:.6g}", least, most);
  return false;
}

/// The mean of a channel that all shots have, and its standard deviation.
void add_mean(const Channel& channel, const std::vector<Shot>& shots, Record& result) {
  std::vector<Reading> readings;
  for (const Shot& shot : shots) readings.push_back(reading_like(channel, shot));
  const IndexRange range = common_samples(channel, readings);
  if (range.size() == 0) {
    warn_of_no_mean(channel.name, "the shots have no time of it in common", result);
    return;
  }
  warn_of_delay_left(shots, channel, readings, result);
  const Sums sums = sums_of(channel, range, readings);
  warn_of_fewer(channel.name, shots.size(), sums, result);
  for (Channel& made : channels_of(channel, range, sums)) {
    made.delay = mean_delay(shots, channel.name);
    result.channels.push_back(std::move(made));
  }
}

}  // namespace

Record average_shots(std::vector<Record> records, const DetectionOptions& options) {
  std::vector<std::string> warnings;
  std::vector<Shot> shots = usable_shots(records, options, warnings);
  lay_on_first(shots, warnings);

  const Record& first = *shots.front().record;
  Record result = first;
  result.channels.clear();
  result.warnings = own_warnings(shots);
  for (std::string& warning : warnings) result.warnings.push_back(std::move(warning));
  for (const std::string& name : names_in(shots)) {
    const Channel* const channel = channel_of(shots.front(), name);
    std::string reason = reason_against(name, shots);
    if (reason.empty())
      add_mean(*channel, shots, result);
    else if (channel != nullptr && is_one_value(name, shots, reason))
      result.channels.push_back(*channel);
    else
      warn_of_no_mean(name, reason, result);
  }
  note_shots(shots, result);
  return result;
}

}  // namespace impactrig::acquisition
