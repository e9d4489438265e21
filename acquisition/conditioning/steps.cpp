// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/channel_map.hpp"
#include "acquisition/conditioning/baseline.hpp"
#include "acquisition/conditioning/calculus.hpp"
#include "acquisition/conditioning/clipped_as_recorded.hpp"
#include "acquisition/conditioning/decay.hpp"
#include "acquisition/conditioning/delay.hpp"
#include "acquisition/conditioning/dropouts.hpp"
#include "acquisition/conditioning/hum.hpp"
#include "acquisition/conditioning/low_pass.hpp"
#include "acquisition/conditioning/resample.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "acquisition/conditioning/trace.hpp"
#include "datasets/input_error.hpp"
#include "datasets/number_text.hpp"
#include "datasets/sample_filter.hpp"
#include "datasets/sensor_response.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;
using datasets::Impact;
using datasets::InputError;
using datasets::Record;

namespace {

constexpr double notable_loss = 0.01;  ///< of a peak

/// The channels that a step means, where there are any: indices, since steps add channels.
std::vector<std::size_t> channels_called(const Record& record, const std::string& name) {
  if (const Channel* const channel = record.find(name))
    return {static_cast<std::size_t>(channel - record.channels.data())};
  const auto quantity = datasets::quantity_named(name);
  std::vector<std::size_t> by_pattern, by_quantity;
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    if (matches_pattern(record.channels[i].name, name)) by_pattern.push_back(i);
    if (quantity && record.channels[i].quantity == *quantity) by_quantity.push_back(i);
  }
  return by_pattern.empty() ? by_quantity : by_pattern;
}

/// The same; throws where there is none.
std::vector<std::size_t> channels_meant(const Record& record, const std::string& name) {
  std::vector<std::size_t> channels = channels_called(record, name);
  if (!channels.empty()) return channels;
  std::string names;
  for (const Channel& channel : record.channels)
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", channel.name);
  throw std::invalid_argument(
      fmt::format("there is no channel '{}'; the channels are {}", name, names));
}

/// A record on its way through the steps.
class Conditioning {
 public:
  Conditioning(Record& record, const SensorSet& sensors, const DetectionOptions& detection)
      : record_(record),
        sensors_(sensors),
        detection_(detection) {}

  /// The first of these; the others are yet to come.
  void apply(std::span<const datasets::ConditioningStep> steps) {
    to_come_ = steps.subspan(1);
    for (const std::size_t index : channels_meant(record_, steps.front().channel))
      std::visit([&](const auto& action) { act(action, index); }, steps.front().action);
  }

 private:
  Channel& channel(std::size_t index) { return record_.channels[index]; }

  void note(Edit&& edit) { record_.provenance.edits.push_back(std::move(edit)); }

  /// `remedy` ends the sentence that says there is none.
  Impact first_impact(std::string_view remedy) const {
    std::vector<Impact> impacts;
    std::string reason;
    try {
      impacts = find_impacts(record_, detection_);
    } catch (const InputError& error) {
      reason = fmt::format(" ({})", error.problem());
    }
    if (impacts.empty())
      throw std::invalid_argument(fmt::format("no impact is found{}, {}", reason, remedy));
    return impacts.front();
  }

  TimeSpan before_touch(std::size_t index) {
    const double start = channel(index).clock.start;
    const double touch =
        first_impact(
            "so what is quiet is not known; state quiet = { from = \"...\", to = \"...\" }")
            .start;
    const double guard = std::max(3.0 * channel(index).clock.interval, 0.05 * (touch - start));
    return {start, touch - guard};
  }

  TimeSpan quiet(const std::optional<TimeSpan>& stated, std::size_t index) {
    return stated ? *stated : before_touch(index);
  }

  void act(const datasets::RemoveBaseline& action, std::size_t index) {
    note(remove_baseline(channel(index), quiet(action.quiet, index)).edit);
    const bool moves = channel(index).quantity == datasets::Quantity::velocity;
    if (!action.quiet && moves) tell_approach("offset", index);
  }

  void act(const datasets::RemoveDrift& action, std::size_t index) {
    note(remove_drift(channel(index), quiet(action.quiet, index)).edit);
    if (action.quiet) return;
    if (channel(index).quantity == datasets::Quantity::velocity) tell_approach("offset", index);
    if (channel(index).quantity == datasets::Quantity::displacement) tell_approach("slope", index);
  }

  /// Before touch the bar is on its way: what is level there is no offset of the instrument.
  void tell_approach(const std::string& parameter, std::size_t index) {
    record_.warnings.push_back(fmt::format(
        "What comes off '{}' is its course before touch ({} {}), which is the approach where the "
        "point moves; state quiet = {{ from = \"...\", to = \"...\" }} where it is at rest.",
        channel(index).name, parameter, record_.provenance.edits.back().parameters.at(parameter)));
  }

  /// A step of that kind that this channel still has before it, its quiet stretches known.
  template <typename Action>
  std::optional<Action> to_come(std::size_t index) {
    for (const datasets::ConditioningStep& step : to_come_) {
      const auto* const action = std::get_if<Action>(&step.action);
      if (action == nullptr) continue;
      const std::vector<std::size_t> meant = channels_called(record_, step.channel);
      if (std::ranges::find(meant, index) == meant.end()) continue;
      Action found = *action;
      if (found.quiet.empty()) found.quiet.push_back(before_touch(index));
      return found;
    }
    return std::nullopt;
  }

  void act(datasets::RemoveDecay action, std::size_t index) {
    if (action.quiet.empty()) action.quiet.push_back(before_touch(index));
    const auto hum = to_come<datasets::RemoveHum>(index);
    Edit edit = remove_decay(channel(index), action, hum ? &*hum : nullptr);
    if (const auto misfit = edit.parameters.find("misfit"); misfit != edit.parameters.end())
      record_.warnings.push_back(
          fmt::format("The quiet samples of '{}' do not follow {}: another course fits them better "
                      "and is up to "
                      "{} away from what came off; {}.",
                      channel(index).name,
                      action.time_constant ? "a decay with the stated time constant" : "one decay",
                      misfit->second.substr(0, misfit->second.find(" at most")),
                      action.time_constant ? "leave time_constant out, or state it anew"
                                           : "state a quiet stretch nearer to the impact"));
    note(std::move(edit));
  }

  void act(datasets::UndoLowCut action, std::size_t index) {
    action.quiet = quiet(action.quiet, index);
    note(undo_low_cut(channel(index), action));
  }

  void act(const datasets::LowPass& action, std::size_t index) {
    const FirstImpact before = first_impact();
    tell_again(action, index);
    LowPassed result = low_pass(channel(index), action);
    note(std::move(result.edit));
    const std::string what = fmt::format("low-pass at {:g} Hz", action.cutoff);
    tell_loss(result.lost, what, index);
    tell_hidden(before, what, index);
  }

  /// As a map that is stated for what it has made.
  void tell_again(const datasets::LowPass& action, std::size_t index) {
    const auto filters = datasets::filters_of(record_, channel(index));
    const bool again =
        filters && std::ranges::any_of(*filters, [&action](const datasets::SampleFilter& filter) {
          const auto* const before = std::get_if<datasets::LowPass>(&filter.action);
          return before && *before == action;
        });
    if (again)
      record_.warnings.push_back(
          fmt::format("'{}' has been through the low-pass at {:g} Hz before and is again, which "
                      "lowers the band.",
                      channel(index).name, action.cutoff));
  }

  /// What a filter may hide of the first impact.
  struct FirstImpact {
    bool clipped = false, lost = false;  ///< a laser's samples, which nobody marked
  };

  /// By its samples, no note; neither when there is none.
  FirstImpact first_impact() {
    std::vector<Edit> edits = std::exchange(record_.provenance.edits, {});
    FirstImpact first;
    try {
      const std::vector<Impact> impacts = find_impacts(record_, detection_);
      if (!impacts.empty())
        first = {impacts.front().has(datasets::ImpactFlag::clipped),
                 impacts.front().has(datasets::ImpactFlag::unmarked_dropout)};
    } catch (const InputError&) {
    }
    record_.provenance.edits = std::move(edits);
    return first;
  }

  /// A filter makes of a flat top a crest and of a dropout a dent, whose samples a fit does not
  /// know to leave out.
  void tell_hidden(const FirstImpact& before, std::string_view what, std::size_t index) {
    if (!before.clipped && !before.lost) return;
    const FirstImpact after = first_impact();
    if (before.clipped && !after.clipped)
      record_.warnings.push_back(fmt::format(
          "The {} hides that '{}' was clipped: peak and impulse are too small, and a fit no longer "
          "knows which samples to leave out; leave the step out, and record again with a larger "
          "range.",
          what, channel(index).name));
    if (before.lost && !after.lost)
      record_.warnings.push_back(fmt::format(
          "The {} hides that '{}' has dropouts that nobody marked: what it made of them is part of "
          "the signal now. Put the step dropouts before it.",
          what, channel(index).name));
  }

  void tell_loss(double lost, std::string_view to_what, std::size_t index) {
    if (lost < notable_loss) return;
    record_.warnings.push_back(fmt::format(
        "The {} takes {} off the largest value of '{}'; a fit filters its prediction so too, "
        "`compare` does not.",
        to_what, datasets::percent(lost), channel(index).name));
  }

  void act(datasets::RemoveHum action, std::size_t index) {
    if (action.quiet.empty()) action.quiet.push_back(before_touch(index));
    const auto decay = to_come<datasets::RemoveDecay>(index);
    Edit edit = remove_hum(channel(index), action, decay ? &*decay : nullptr);
    if (edit.parameters.contains("found"))
      record_.warnings.push_back(
          fmt::format("No hum near {} Hz stands out of the quiet samples of '{}' ({}), so none was "
                      "taken off; an impact among them would hide it.",
                      action.frequency ? fmt::format("{:g}", *action.frequency) : "50 or 60",
                      channel(index).name, edit.parameters.at("quiet")));
    const auto frequency = edit.parameters.find("frequency");
    if (frequency != edit.parameters.end() && frequency->second.ends_with("as the other"))
      record_.warnings.push_back(fmt::format(
          "The quiet samples of '{}' are too short to tell hum of 50 Hz from one of 60 Hz; state "
          "frequency in the step.",
          channel(index).name));
    note(std::move(edit));
  }

  void act(const datasets::RepairDropouts& action, std::size_t index) {
    note(repair_dropouts(channel(index), action));
  }

  void act(const datasets::AlignTo& action, std::size_t index) {
    const std::vector<std::size_t> references = channels_meant(record_, action.reference);
    if (references.size() > 1)
      throw std::invalid_argument(fmt::format("'{}' names {} channels to align to; name one",
                                              action.reference, references.size()));
    if (references.front() == index)
      throw std::invalid_argument(
          fmt::format("channel '{}' is to be aligned to itself", channel(index).name));
    // what is known and not taken off yet would come off one of the two later
    for (const std::size_t either : {references.front(), index})
      if (channel(either).delay)
        if (auto edit = remove_known_delay(channel(either))) note(std::move(*edit));
    const Channel& reference = channel(references.front());
    const Impact impact =
        first_impact("by which channels could be aligned; choose another --trigger or --threshold");
    const bool struck = (reference.quantity == datasets::Quantity::force) !=
                        (channel(index).quantity == datasets::Quantity::force);
    const double margin = 2.0 * impact.width + action.range;
    const TimeSpan window{impact.start - margin,
                          struck ? impact.peak_time : impact.end + 2.0 * impact.width};
    const DelayEstimate found =
        estimate_delay(through_chain_of(channel(index), reference),
                       through_chain_of(reference, channel(index)), window, action.range);
    note(remove_estimated_delay(found, reference.name, channel(index)));
  }

  void act(const datasets::Resample& action, std::size_t index) {
    const FirstImpact before = first_impact();
    Resampled result = resample(channel(index), action);
    note(std::move(result.edit));
    const std::string what = fmt::format("resampling to {:g} Hz", action.rate);
    tell_loss(result.lost, what, index);
    tell_hidden(before, what, index);
    if (result.gaps == 0) return;
    record_.warnings.push_back(fmt::format(
        "'{}' has {} gap{} in its times, {}{:g} s long: {} of the resampled values lie in {} and "
        "are marked invalid.",
        channel(index).name, result.gaps, result.gaps == 1 ? "" : "s",
        result.gaps == 1 ? "" : "up to ", result.longest_gap, result.in_gaps,
        result.gaps == 1 ? "it" : "them"));
  }

  void act(const datasets::Integrate& action, std::size_t index) {
    IntegrationOptions options;
    options.quiet = action.quiet;
    options.zero_at = action.zero_at.value_or(channel(index).clock.start);
    refuse_zero_beyond(channel(index), options.zero_at);
    tell_bridged_integral(channel(index));
    add(integrate(channel(index), options), action.name);
  }

  /// A time [s] within the record but for half of a step.
  static void refuse_zero_beyond(const Channel& channel, double time) {
    if (channel.size() == 0 || !channel.clock.uniform()) return;
    const double first = channel.clock.start, last = channel.clock.time(channel.size() - 1);
    const double grace = 0.5 * channel.clock.interval;
    if (time >= first - grace && time <= last + grace) return;
    throw std::invalid_argument(
        fmt::format("the integral of '{}' cannot be zero at {:g} s: the record goes from {:g} s to "
                    "{:g} s",
                    channel.name, time, first, last));
  }

  void tell_bridged_integral(const Channel& channel) {
    const std::vector<std::uint8_t> sound = sound_marks(channel);
    const auto first = std::ranges::find(sound, 0);
    if (first == sound.end()) return;
    record_.warnings.push_back(fmt::format(
        "'{}' is integrated over {} samples that are not valid, by straight lines between those "
        "beside them: from {:g} s on the integral holds what these give.",
        channel.name, std::ranges::count(sound, 0),
        channel.clock.time(static_cast<std::size_t>(first - sound.begin()))));
  }

  void act(const datasets::Differentiate& action, std::size_t index) {
    add(differentiate(channel(index)), action.name);
  }

  void add(Derived&& derived, const std::string& name) {
    if (!name.empty()) derived.channel.name = name;
    if (record_.find(derived.channel.name) != nullptr)
      throw std::invalid_argument(
          fmt::format("there is a channel '{}' already; state another name", derived.channel.name));
    derived.edit.parameters["result"] = derived.channel.name;
    record_.channels.push_back(std::move(derived.channel));
    note(std::move(derived.edit));
  }

  /// A channel as another one's sensor would have filtered it too.
  Channel through_chain_of(const Channel& other, const Channel& channel) const {
    Channel result = channel;
    for (const auto* sensor : {&sensors_.force, &sensors_.velocity, &sensors_.displacement})
      if (*sensor && (*sensor)->quantity == other.quantity)
        replace_values(result, datasets::sensor_response(**sensor, sound_values(channel),
                                                         channel.clock.interval));
    return result;
  }

  Record& record_;
  const SensorSet& sensors_;
  const DetectionOptions& detection_;
  std::span<const datasets::ConditioningStep> to_come_;
};

}  // namespace

void apply_steps(std::span<const datasets::ConditioningStep> steps, Record& record,
                 const SensorSet& sensors, const DetectionOptions& detection,
                 const std::function<void()>& done) {
  if (!steps.empty()) note_clipped(record, detection);
  Conditioning conditioning(record, sensors, detection);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    try {
      conditioning.apply(steps.subspan(i));
    } catch (const std::invalid_argument& error) {
      throw InputError(whole_file(record.provenance.source_file),
                       fmt::format("conditioning step {}: {}", i + 1, error.what()));
    }
    if (done) done();
  }
}

}  // namespace impactrig::acquisition
