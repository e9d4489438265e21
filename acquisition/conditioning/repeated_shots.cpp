// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/repeated_shots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/delay.hpp"
#include "acquisition/conditioning/dropouts.hpp"
#include "acquisition/conditioning/trace.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Impact;
using datasets::ImpactFlag;
using datasets::InputError;
using datasets::Record;

namespace {

constexpr std::array unusable{ImpactFlag::clipped, ImpactFlag::double_hit, ImpactFlag::too_short,
                              ImpactFlag::unmarked_dropout};

/// Channels of different shots are told by their names.
void refuse_equal_names(const Record& record) {
  for (const Channel& channel : record.channels)
    if (std::ranges::count(record.channels, channel.name, &Channel::name) > 1)
      throw InputError(whole_file(record.provenance.source_file),
                       fmt::format("has several channels named '{}'; give each a name of its own "
                                   "in a map (--map)",
                                   channel.name));
}

void remove_known_delays(Record& record) {
  for (Channel& channel : record.channels) {
    if (!channel.delay) continue;
    if (auto edit = remove_known_delay(channel))
      record.provenance.edits.push_back(std::move(*edit));
  }
}

/// Marks what a laser has lost without a mark, so that it is in no mean.
void mark_dropouts(const std::string& name, Record& record, std::vector<std::string>& warnings) {
  Channel& channel = *std::ranges::find(record.channels, name, &Channel::name);
  datasets::Edit edit = repair_dropouts(channel, {});
  if (!edit.parameters.contains("first")) return;
  warnings.push_back(fmt::format(
      "{}: '{}' has dropouts that nobody marked, from {} on: of this shot these samples "
      "are not in the mean ({}), as with the step dropouts in a map.",
      record.provenance.source_file, name, edit.parameters.at("first"),
      edit.parameters.at("samples")));
  record.provenance.edits.push_back(std::move(edit));
}

/// As find_impacts finds them where the motion has no unmarked dropouts in the first one.
std::vector<Impact> impacts_without_dropouts(Record& record, const DetectionOptions& options,
                                             std::vector<std::string>& warnings) {
  std::vector<Impact> impacts = find_impacts(record, options);
  if (impacts.empty() || !impacts.front().has(ImpactFlag::unmarked_dropout)) return impacts;
  for (const auto& signal : {impacts.front().velocity, impacts.front().displacement})
    if (signal) mark_dropouts(signal->channel, record, warnings);
  return find_impacts(record, options);
}

/// Why a shot cannot be used; empty when it can.
std::string reason_against(const std::vector<Impact>& impacts) {
  if (impacts.empty()) return "there is no impact in it";
  for (const ImpactFlag flag : unusable)
    if (impacts.front().has(flag)) return fmt::format("its impact is {}", name(flag));
  return {};
}

/// Takes out the shots of which `value` has the other sign than that of most (of the first, where
/// as many have either), and says of which `what`. None has a sign where `value` is 0.
template <typename Value>
void leave_out_opposite(std::string_view what, const Value& value, std::vector<Shot>& shots,
                        std::vector<std::string>& warnings) {
  int balance = 0;
  for (const Shot& shot : shots) balance += (value(shot) > 0.0) - (value(shot) < 0.0);
  const auto first = std::ranges::find_if(shots, [&](const Shot& s) { return value(s) != 0.0; });
  if (first == shots.end()) return;
  const double sign = balance != 0 ? balance : value(*first);
  std::erase_if(shots, [&](const Shot& shot) {
    const bool opposite = value(shot) * sign < 0.0;
    if (opposite)
      warnings.push_back(
          fmt::format("{} is not in the mean: its {} has the opposite sign.", file_of(shot), what));
    return opposite;
  });
}

/// Takes out the shots whose impact was found in another quantity than that of most (of the first,
/// where as many have either): their peaks are not of one kind.
void leave_out_other_triggers(std::vector<Shot>& shots, std::vector<std::string>& warnings) {
  if (shots.empty()) return;
  const auto of_its_kind = [&](const Shot& shot) {
    return std::ranges::count_if(shots, [&](const Shot& other) {
      return trigger_of(other).quantity == trigger_of(shot).quantity;
    });
  };
  const Channel& usual = trigger_of(*std::ranges::max_element(shots, {}, of_its_kind));
  std::erase_if(shots, [&](const Shot& shot) {
    const Channel& trigger = trigger_of(shot);
    if (trigger.quantity == usual.quantity) return false;
    warnings.push_back(fmt::format(
        "{} is not in the mean: its impact is found in '{}' ({}), that of the others in '{}' ({}).",
        file_of(shot), trigger.name, name(trigger.quantity), usual.name, name(usual.quantity)));
    return true;
  });
}

std::optional<double> peak_of(const Shot& shot) {
  return std::abs(shot.impact.peak);
}

/// None of a shot without a velocity.
std::optional<double> speed_of(const Shot& shot) {
  if (!shot.impact.velocity) return std::nullopt;
  return std::abs(approach_of(shot));
}

/// Takes out shots whose `value` is off that of the middle one by a factor, another unit or range,
/// or is nothing: a laser without a signal. Of fewer than three shots none is the odd one.
template <typename Value>
void leave_out_far_off(std::string_view what, const Value& value, std::vector<Shot>& shots,
                       std::vector<std::string>& warnings) {
  constexpr std::size_t fewest = 3;
  constexpr double far_off = 5.0;
  std::vector<double> values;
  for (const Shot& shot : shots)
    if (const auto known = value(shot)) values.push_back(*known);
  if (values.size() < fewest) return;
  const double usual = median(std::move(values));
  if (!(usual > 0.0)) return;
  std::erase_if(shots, [&](const Shot& shot) {
    const double ratio = value(shot).value_or(usual) / usual;
    if (ratio < far_off && ratio > 1.0 / far_off) return false;
    warnings.push_back(fmt::format("{} is not in the mean: its {} is {}.", file_of(shot), what,
                                   ratio > 0.0
                                       ? fmt::format("{:.3g} times that of the usual shots", ratio)
                                       : "not to be seen"));
    return true;
  });
}

/// Steps that change what a channel's samples mean, and what is asked for in them. Delays and
/// dropouts are a shot's own.
struct Step {
  std::string_view what;
  std::vector<std::string_view> asked;
};

const std::vector<Step>& comparable_steps() {
  static const std::vector<Step> steps{{"remove baseline", {}},
                                       {"remove drift", {}},
                                       {"remove decay", {}},
                                       {"remove hum", {}},
                                       {"undo low cut", {"frequency"}},
                                       {"low-pass, zero phase", {"cutoff", "order"}},
                                       {"resample", {"to"}}};
  return steps;
}

/// What was done to a channel: its name, and "low-pass, zero phase (cutoff 4000 Hz, ...)".
using Done = std::pair<std::string, std::string>;

/// "low-pass, zero phase (cutoff 4000 Hz, ...)"; none of what may differ.
std::optional<std::string> comparable(const datasets::Edit& edit) {
  const auto step = std::ranges::find(comparable_steps(), edit.what, &Step::what);
  if (step == comparable_steps().end()) return std::nullopt;
  std::vector<std::string> asked;
  for (const std::string_view key : step->asked)
    if (const auto value = edit.parameters.find(std::string(key)); value != edit.parameters.end())
      asked.push_back(fmt::format("{} {}", key, value->second));
  return asked.empty() ? edit.what : fmt::format("{} ({})", edit.what, fmt::join(asked, ", "));
}

/// Of the channels that every shot has, one after the other.
std::vector<Done> conditioning_of(const Shot& shot, const std::vector<Shot>& shots) {
  std::vector<Done> all;
  for (const Channel& channel : shot.record->channels) {
    const bool common = std::ranges::all_of(shots, [&channel](const Shot& other) {
      return channel_of(other, channel.name) != nullptr;
    });
    if (!common) continue;
    for (const datasets::Edit* const edit : datasets::edits_of(*shot.record, channel))
      if (auto done = comparable(*edit)) all.emplace_back(channel.name, *std::move(done));
  }
  std::ranges::stable_sort(all, {}, &Done::first);
  return all;
}

/// In what a shot differs from the usual ones.
std::string difference(const std::vector<Done>& own, const std::vector<Done>& usual,
                       const std::string& usual_file) {
  const auto [here, there] = std::ranges::mismatch(own, usual);
  const bool more = here != own.end() && std::ranges::find(usual, *here) == usual.end();
  if (more || there == usual.end())
    return fmt::format("'{}' has been through {} in it, and not in {}", here->first, here->second,
                       usual_file);
  if (here == own.end() || std::ranges::find(own, *there) == own.end())
    return fmt::format("'{}' has not been through {} in it, but in {}", there->first, there->second,
                       usual_file);
  return fmt::format("'{}' has been through its steps in another order than in {}", there->first,
                     usual_file);
}

/// Takes out the shots that were conditioned otherwise than most (than the first, where as many
/// were either way): a mean of them would be neither, and its edits can tell of one only.
void leave_out_other_conditioning(std::vector<Shot>& shots, std::vector<std::string>& warnings) {
  if (shots.empty()) return;
  std::vector<std::vector<Done>> done;
  for (const Shot& shot : shots) done.push_back(conditioning_of(shot, shots));
  const auto usual = std::ranges::max_element(
      done, {}, [&](const std::vector<Done>& one) { return std::ranges::count(done, one); });
  const std::string usual_file = file_of(shots[static_cast<std::size_t>(usual - done.begin())]);
  std::vector<Shot> alike;
  for (std::size_t k = 0; k < shots.size(); ++k) {
    if (done[k] == *usual)
      alike.push_back(std::move(shots[k]));
    else
      warnings.push_back(fmt::format("{} is not in the mean: {}.", file_of(shots[k]),
                                     difference(done[k], *usual, usual_file)));
  }
  shots = std::move(alike);
}

}  // namespace

const std::string& file_of(const Shot& shot) {
  return shot.record->provenance.source_file;
}

const Channel* channel_of(const Shot& shot, const std::string& name) {
  const auto& channels = shot.record->channels;
  const auto found = std::ranges::find(channels, name, &Channel::name);
  return found == channels.end() ? nullptr : &*found;
}

std::string listed(const std::vector<std::string>& files) {
  constexpr std::size_t most = 3;
  if (files.size() <= most) return fmt::format("{}", fmt::join(files, ", "));
  return fmt::format("{} and {} more", fmt::join(files.begin(), files.begin() + most, ", "),
                     files.size() - most);
}

const Channel& trigger_of(const Shot& shot) {
  return *channel_of(shot, shot.impact.trigger);
}

double approach_of(const Shot& shot) {
  const Impact& impact = shot.impact;
  if (!impact.velocity) return 0.0;
  const bool known = std::abs(impact.approach_velocity) > 3.0 * impact.velocity->noise;
  return known ? impact.approach_velocity : 0.0;
}

std::vector<Shot> usable_shots(std::span<Record> records, const DetectionOptions& options,
                               std::vector<std::string>& warnings) {
  std::vector<Shot> shots;
  for (Record& record : records) {
    refuse_equal_names(record);
    remove_known_delays(record);
    const std::vector<Impact> impacts = impacts_without_dropouts(record, options, warnings);
    const std::string reason = reason_against(impacts);
    if (reason.empty())
      shots.push_back({&record, impacts.front(), impacts.size() > 1 ? impacts[1].start : INFINITY});
    else
      warnings.push_back(
          fmt::format("{} is not in the mean: {}.", record.provenance.source_file, reason));
  }
  leave_out_other_triggers(shots, warnings);
  leave_out_other_conditioning(shots, warnings);
  leave_out_opposite(
      "peak", [](const Shot& shot) { return shot.impact.peak; }, shots, warnings);
  leave_out_opposite("approach velocity", approach_of, shots, warnings);
  leave_out_far_off("peak", peak_of, shots, warnings);
  leave_out_far_off("approach velocity", speed_of, shots, warnings);
  if (shots.size() < 2)
    throw InputError(
        whole_file(records.empty() ? "" : records.front().provenance.source_file),
        fmt::format("a mean needs two shots at least, and {} of {} can be used{}{}", shots.size(),
                    records.size(), warnings.empty() ? "" : ": ", fmt::join(warnings, " ")));
  return shots;
}

}  // namespace impactrig::acquisition
