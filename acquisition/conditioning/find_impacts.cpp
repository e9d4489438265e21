// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/clipped_as_recorded.hpp"
#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/dead_tail.hpp"
#include "acquisition/conditioning/digitiser_step.hpp"
#include "acquisition/conditioning/glitches.hpp"
#include "acquisition/conditioning/impact_flags.hpp"
#include "acquisition/conditioning/recorded_signal.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "acquisition/conditioning/spikes.hpp"
#include "acquisition/conditioning/swapped_channels.hpp"
#include "acquisition/conditioning/trace.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Impact;
using datasets::ImpactFlag;
using datasets::ImpactSignal;
using datasets::InputError;
using datasets::Quantity;
using datasets::Record;

namespace {

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

void refuse_senseless(const DetectionOptions& options) {
  for (const double option : {options.threshold, options.before(), options.after()})
    if (!(option >= 0.0) || !std::isfinite(option))
      throw std::invalid_argument(fmt::format(
          "threshold, pre_trigger and post_trigger must be finite and not negative, not {}",
          option));
}

/// A single value among histories is a setting, even where it has been given a clock.
const Channel* first_of(const Record& record, Quantity quantity) {
  const auto first = [&](std::size_t least) {
    const auto found = std::ranges::find_if(record.channels, [&](const Channel& channel) {
      const bool timeless = channel.size() == 1 && channel.clock.interval == 0.0;
      return channel.quantity == quantity && channel.size() >= least && !timeless;
    });
    return found == record.channels.end() ? nullptr : &*found;
  };
  const Channel* const history = first(2);
  return history != nullptr ? history : first(1);
}

const Channel& trigger_channel(const Record& record, const DetectionOptions& options) {
  const std::string& file = record.provenance.source_file;
  if (options.trigger_index || !options.trigger_channel.empty()) {
    const Channel* const channel = options.trigger_index
                                       ? &record.channels.at(*options.trigger_index)
                                       : record.find(options.trigger_channel);
    if (channel == nullptr)
      throw InputError(whole_file(file),
                       fmt::format("there is no single channel '{}' to look for impacts in",
                                   options.trigger_channel));
    if (channel->quantity != Quantity::force && channel->quantity != Quantity::acceleration &&
        channel->quantity != Quantity::velocity && channel->quantity != Quantity::displacement)
      throw InputError(whole_file(file),
                       fmt::format("channel '{}' is a {}; impacts are looked for in a force, an "
                                   "acceleration, a velocity or a displacement",
                                   channel->name, name(channel->quantity)));
    return *channel;
  }
  for (const Quantity quantity :
       {Quantity::force, Quantity::acceleration, Quantity::velocity, Quantity::displacement})
    if (const Channel* const channel = first_of(record, quantity)) return *channel;
  throw InputError(
      whole_file(file),
      "there is no force, acceleration, velocity or displacement to look for impacts in; describe "
      "the channels in a rig file under [sensors.force] and [sensors.velocity], or their "
      "roles in a map");
}

RecordedSignal source_of(const Channel& channel, const Record& record) {
  RecordedSignal source{&channel, trace_of(channel, record.provenance.source_file), 0.0, 0.0};
  source.quantum = quantum_of(source.trace.values, source.trace.valid);
  if (channel.quantity == Quantity::force || channel.quantity == Quantity::acceleration)
    bridge_glitches(source.trace, source.quantum);
  else
    mark_dead_tail(source.quantum, source.trace);
  const auto take_stated = [&](const char* name, double& number) {
    const auto stated = channel.attributes.find(name);
    if (stated == channel.attributes.end()) return;
    std::from_chars(stated->second.data(), stated->second.data() + stated->second.size(), number);
  };
  take_stated("sensor.range", source.range);
  take_stated("sensor.low_cut", source.low_cut);
  if (const auto to_si = datasets::conversion(channel.unit, si_unit(channel.quantity)))
    source.step_before = std::abs(to_si->factor) * noted_digitiser_step(record, channel);
  if (auto filters = datasets::filters_of(record, channel)) source.filters = std::move(*filters);
  return source;
}

/// How far a parabola goes up and down over n samples.
double range_of(const QuietFit& course, std::size_t n) {
  const double last = as_double(n - 1);
  const auto [least, most] = std::minmax({course.at(0.0), course.at(last), course.at(0.5 * last),
                                          course.at(0.25 * last), course.at(0.75 * last)});
  return most - least;
}

/// A record that leans further than a contact's foot is high, by drift or by a part of a period of
/// hum, begins off its level: pulses beside the parabola that most of it follows, of which the
/// first has to stand out of that. None where that is not so.
std::vector<Contact> find_pulses_beside_course(const RecordedSignal& trigger,
                                               const DetectionOptions& options) {
  constexpr double stands_out = 2.0, leans = 6.0;
  const std::size_t n = trigger.trace.values.size();
  if (n < 32) return {};
  const QuietFit course =
      fit_quiet(trigger.trace.values, 0, n, 2, trigger.quantum, trigger.trace.valid);
  const double range = range_of(course, n);
  if (!(range > leans * course.sigma)) return {};
  Trace level = trigger.trace;
  for (std::size_t i = 0; i < n; ++i) level.values[i] -= course.at(as_double(i));
  std::vector<Contact> contacts = find_pulses(level, options);
  if (contacts.empty() || contacts.front().begins_inside ||
      std::abs(contacts.front().peak) < stands_out * range)
    return {};
  for (Contact& contact : contacts) contact.baseline += course.at(contact.onset);
  return contacts;
}

std::vector<Contact> find_contacts(const RecordedSignal& trigger, const DetectionOptions& options) {
  if (trigger.trace.quantity == Quantity::velocity) return find_jumps(trigger.trace, options);
  if (trigger.trace.quantity == Quantity::displacement) return find_bounces(trigger.trace, options);
  std::vector<Contact> contacts = find_pulses(trigger.trace, options);
  if (!contacts.empty() && contacts.front().onset > 0.0) return contacts;
  std::vector<Contact> beside = find_pulses_beside_course(trigger, options);
  return beside.empty() ? contacts : beside;
}

/// Marks spikes as not valid and bridges them.
void clear_spikes(const std::vector<Spike>& spikes, Trace& trace) {
  if (trace.valid.empty()) trace.valid.assign(trace.values.size(), 1);
  for (const Spike& spike : spikes)
    std::fill_n(trace.valid.begin() + static_cast<std::ptrdiff_t>(spike.range.begin),
                spike.range.size(), 0);
  bridge_invalid(trace.values, trace.valid);
}

/// Contacts of a force or an acceleration without spikes, which are marked as not valid: those of
/// one rig are alike, since what a contact lasts hardly depends on its speed. Where none lasts many
/// times as long as a few samples, they may be the contact. Spikes may hide the contact behind
/// them; then what is found without them decides.
std::vector<Contact> find_contacts_beside_spikes(RecordedSignal& trigger,
                                                 const DetectionOptions& options) {
  constexpr int most_rounds = 32;
  constexpr std::size_t most_looked_at = 20000;  // contacts in all rounds: of noise there are many
  std::vector<Contact> contacts = find_contacts(trigger, options);
  if (trigger.trace.quantity == Quantity::velocity ||
      trigger.trace.quantity == Quantity::displacement)
    return contacts;
  RecordedSignal cleared = trigger;
  std::vector<Contact> found = contacts;
  std::vector<Spike> undecided;
  std::size_t looked_at = 0;
  for (int round = 0; round < most_rounds && looked_at < most_looked_at; ++round) {
    looked_at += found.size();
    const std::vector<Spike> taken = spikes_among(cleared.trace, found);
    std::vector<Spike> spikes = spikes_after(cleared.trace, cleared.quantum, found, options);
    const auto add = [&](const Spike& spike) {
      const auto alike = spikes_like(spike, cleared.trace, cleared.quantum, options);
      spikes.insert(spikes.end(), alike.begin(), alike.end());
    };
    for (const Spike& spike : taken)
      if (spike.is_short_beside(found)) add(spike);
    if (spikes.empty()) {
      if (taken.empty()) break;
      add(taken.front());
      undecided.insert(undecided.end(), spikes.begin(), spikes.end());
    }
    clear_spikes(spikes, cleared.trace);
    found = find_contacts(cleared, options);
    if (!std::ranges::all_of(undecided,
                             [&](const Spike& spike) { return spike.is_short_beside(found); }))
      continue;
    undecided.clear();
    cleared.quantum = quantum_of(cleared.trace.values, cleared.trace.valid);
    trigger = cleared;
    contacts = found;
  }
  return contacts;
}

/// The part of a record that belongs to one impact [s].
struct Window {
  double begin, end;
  double floor;  ///< end of the previous impact; nothing before it is quiet
};

void describe_noise(const RecordedSignal& source, double onset_time, const Window& window,
                    const DetectionOptions& options, ImpactSignal& signal) {
  const Trace& trace = source.trace;
  const double floor = std::max(0.0, std::ceil(trace.index(window.floor)));
  const auto quiet =
      quiet_before(trace, trace.index(onset_time), static_cast<std::size_t>(floor), options);
  const double quantum = quantum_of(signal.values, signal.valid);
  signal.quantum = std::max(quantum, source.step_before);
  if (!quiet) {
    signal.noise = step_noise(signal.values, signal.valid);
    return;
  }
  const int degree = trace.quantity == Quantity::displacement ? 2 : 1;
  const QuietFit fit =
      fit_quiet(trace.values, quiet->begin, quiet->end, degree, quantum, trace.valid);
  signal.noise = fit.sigma;
  signal.noise_correlation = fit.correlation;
}

/// Samples of a motion at the end of its range say nothing of it. A fit leaves out a clipped
/// force's by itself.
void mark_clipped(double range, ImpactSignal& signal) {
  if (!(range > 0.0)) return;
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    if (!at_range(signal.values[i], range)) continue;
    if (signal.valid.empty()) signal.valid.assign(signal.values.size(), 1);
    signal.valid[i] = 0;
  }
}

/// None when the channel has no sample within the window.
std::optional<ImpactSignal> signal_of(const RecordedSignal& source, double onset_time,
                                      const Window& window, const DetectionOptions& options) {
  const Trace& trace = source.trace;
  const double n = as_double(trace.values.size());
  // A ten-thousandth of a step of grace: times are rounded.
  const double from = std::max(0.0, std::ceil(trace.index(window.begin) - 1e-4));
  const double to = std::min(n, std::floor(trace.index(window.end) + 1e-4) + 1.0);
  if (from >= to) return std::nullopt;
  const auto first = static_cast<std::ptrdiff_t>(from), last = static_cast<std::ptrdiff_t>(to);

  ImpactSignal signal;
  signal.quantity = trace.quantity;
  signal.channel = source.channel->name;
  signal.start = trace.time(from);
  signal.interval = trace.interval;
  signal.values.assign(trace.values.begin() + first, trace.values.begin() + last);
  if (!trace.valid.empty()) {
    signal.valid.assign(trace.valid.begin() + first, trace.valid.begin() + last);
    if (std::ranges::find(signal.valid, 0) == signal.valid.end()) signal.valid.clear();
  }
  if (signal.quantity != Quantity::force) mark_clipped(source.range, signal);
  if (const auto& calibration = source.channel->calibration;
      calibration && calibration->sensitivity != 0.0)
    signal.gain_uncertainty = std::abs(calibration->uncertainty / calibration->sensitivity);
  if (const auto& delay = source.channel->delay) {
    if (delay->removed) signal.delay = delay->value;
    signal.delay_uncertainty = delay->uncertainty;
  }
  signal.filters = source.filters;
  if (!signal.filters.empty()) signal.recorded = {trace.time(0.0), trace.time(n - 1.0)};
  describe_noise(source, onset_time, window, options, signal);
  return signal;
}

void subtract_baseline(ImpactSignal& signal, double baseline) {
  signal.baseline = baseline;
  for (double& value : signal.values) value -= baseline;
}

/// The force's level before touch when the trigger is another channel.
double level_before(const RecordedSignal& source, double onset_time, const Window& window,
                    const DetectionOptions& options) {
  const Trace& trace = source.trace;
  const double floor = std::max(0.0, std::ceil(trace.index(window.floor)));
  const auto quiet =
      quiet_before(trace, trace.index(onset_time), static_cast<std::size_t>(floor), options);
  if (!quiet) return 0.0;
  return fit_quiet(trace.values, quiet->begin, quiet->end, 1, source.quantum, trace.valid).mean;
}

/// Mean before touch, dropouts left out; of the samples there are when there are few.
double approach_velocity(const RecordedSignal& velocity, double onset_time, const Window& window,
                         const DetectionOptions& options) {
  const Trace& trace = velocity.trace;
  const double floor = std::max(0.0, std::ceil(trace.index(window.floor)));
  const double onset = trace.index(onset_time);
  if (const auto quiet = quiet_before(trace, onset, static_cast<std::size_t>(floor), options))
    return fit_quiet(trace.values, quiet->begin, quiet->end, 1, velocity.quantum, trace.valid).mean;
  const double last =
      std::min(std::max(std::floor(onset), 0.0), as_double(trace.values.size() - 1));
  const auto end = static_cast<std::ptrdiff_t>(last) + 1;
  const auto begin = std::min(static_cast<std::ptrdiff_t>(floor), end - 1);
  return median({trace.values.begin() + begin, trace.values.begin() + end});
}

/// What the trigger shows of the bar's way there and back, where that is a displacement.
void tell_rebound(const Bounce& bounce, const Trace& trace, Impact& impact) {
  const double rate = 1.0 / trace.interval;
  if (!impact.velocity) impact.approach_velocity = bounce.sign * bounce.approach.value * rate;
  datasets::Rebound told;
  told.approach_error = bounce.approach.error * rate;
  if (const auto& back = bounce.rebound) {
    told.from = trace.time(back->from);
    told.to = trace.time(back->to);
    told.velocity = bounce.sign * back->speed.value * rate;
    told.velocity_error = std::hypot(back->speed.error, back->vibration) * rate;
    told.restitution = back->speed.value / bounce.approach.value;
    told.restitution_error =
        std::hypot(told.velocity_error, told.restitution * told.approach_error) /
        (bounce.approach.value * rate);
  } else {
    told.absent = bounce.back ? "The record ends, or samples are lost, before it shows the rebound "
                                "for as long as the contact lasts; record more after the trigger."
                              : "The record ends before the displacement is back at first touch; "
                                "record more after the trigger.";
  }
  impact.rebound = std::move(told);
}

/// What a contact and its further hits take [s]. What has not ended with the record may be a force
/// that stays.
double time_taken(const Contact& contact, const Trace& trace) {
  constexpr double of_width = 4.0;
  const double taken = std::max(contact.end, contact.last_end) - contact.onset;
  return trace.interval * (contact.ends_inside ? std::min(taken, of_width * contact.width) : taken);
}

/// Where nothing is stated a contact comes with half of its time before it, in which noise that is
/// slow beside it shows, and as long behind it as it took, to see what it leaves the bar in.
DetectionOptions options_for(const Contact& contact, const Trace& trace, double usual_before,
                             const DetectionOptions& options) {
  const double taken = time_taken(contact, trace);
  DetectionOptions kept = options;
  kept.pre_trigger = options.pre_trigger.value_or(std::max(usual_before, 0.5 * taken));
  kept.post_trigger = options.post_trigger.value_or(std::max(options.after(), 2.0 * taken));
  return kept;
}

Impact impact_of(const Contact& contact, const RecordedSignal& trigger,
                 const std::vector<const RecordedSignal*>& sources, const Window& window,
                 const DetectionOptions& options) {
  const Trace& trace = trigger.trace;
  Impact impact;
  impact.start = trace.time(contact.onset);
  impact.end = trace.time(contact.end);
  impact.peak = contact.peak;
  impact.peak_time = trace.time(as_double(contact.peak_index));
  impact.width = contact.width * trace.interval;
  impact.impulse = contact.impulse * trace.interval;
  for (const RecordedSignal* const source : sources) {
    auto signal = signal_of(*source, impact.start, window,
                            options_for(contact, trace, options.before(), options));
    if (!signal) continue;
    if (signal->quantity == Quantity::force) {
      subtract_baseline(*signal, source == &trigger
                                     ? contact.baseline
                                     : level_before(*source, impact.start, window, options));
      impact.force = std::move(signal);
    } else if (signal->quantity == Quantity::velocity) {
      impact.approach_velocity = approach_velocity(*source, impact.start, window, options);
      impact.velocity = std::move(signal);
    } else if (signal->quantity == Quantity::displacement) {
      impact.displacement = std::move(signal);
    }
  }
  if (contact.bounce) tell_rebound(*contact.bounce, trace, impact);
  impact.flags = flags_of(impact, contact, sources, window.floor, options);
  return impact;
}

/// Whether the first force and the first velocity look exchanged.
bool swapped(const std::vector<const RecordedSignal*>& sources, const DetectionOptions& options) {
  const auto of = [&](Quantity quantity) -> const Trace* {
    for (const RecordedSignal* const source : sources)
      if (source->trace.quantity == quantity) return &source->trace;
    return nullptr;
  };
  const Trace* const force = of(Quantity::force);
  const Trace* const velocity = of(Quantity::velocity);
  return force != nullptr && velocity != nullptr && look_swapped(*force, *velocity, options);
}

/// Samples closer together than half a period of what a filter passes tell nothing of their own.
double usual_pre_trigger(const std::vector<const RecordedSignal*>& sources) {
  constexpr double samples = 200.0, longest = 50e-3;  // [s]
  double slowest = 0.0;
  for (const RecordedSignal* const source : sources) {
    slowest = std::max(slowest, source->trace.interval);
    for (const datasets::SampleFilter& filter : source->filters)
      slowest = std::max(slowest, 0.5 / filter.pass_band());
  }
  return std::clamp(samples * slowest, DetectionOptions::least_pre_trigger, longest);
}

}  // namespace

std::vector<Impact> find_impacts(const Record& record, const DetectionOptions& options) {
  refuse_senseless(options);
  const std::string& file = record.provenance.source_file;
  const Channel& chosen = trigger_channel(record, options);
  RecordedSignal trigger = source_of(chosen, record);
  const std::vector<Contact> contacts = find_contacts_beside_spikes(trigger, options);
  if (contacts.empty()) return {};

  std::vector<RecordedSignal> others;
  others.reserve(3);
  std::vector<const RecordedSignal*> sources{&trigger};
  for (const Quantity quantity : {Quantity::force, Quantity::velocity, Quantity::displacement}) {
    if (quantity == chosen.quantity) continue;
    // a laser without a signal says nothing of a force
    if (const Channel* const channel = first_of(record, quantity);
        channel != nullptr && has_sound_sample(*channel)) {
      others.push_back(source_of(*channel, record));
      sources.push_back(&others.back());
    }
  }

  const double before = options.pre_trigger.value_or(usual_pre_trigger(sources));
  constexpr double least_shown = 8.0;  // samples from touch on
  const bool exchanged = swapped(sources, options);
  const std::vector<datasets::TimeSpan> clipped = noted_clipped(record);
  std::vector<Impact> impacts;
  Window window{0.0, 0.0, -INFINITY};
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double start = trigger.trace.time(contacts[i].onset);
    const DetectionOptions kept = options_for(contacts[i], trigger.trace, before, options);
    window.begin = std::max(start - kept.before(), window.floor);
    // times may be in another unit than stated: who judges them needs to see something
    window.end = start + std::max(kept.after(), least_shown * trigger.trace.interval);
    if (i + 1 < contacts.size())
      window.end = std::min(window.end, trigger.trace.time(contacts[i + 1].onset - 1.0));
    impacts.push_back(impact_of(contacts[i], trigger, sources, window, options));
    if (is_among(clipped, impacts.back()) && !impacts.back().has(ImpactFlag::clipped))
      impacts.back().flags.insert(impacts.back().flags.begin(), ImpactFlag::clipped);
    // Other flags would judge the one channel as the other.
    if (exchanged) impacts.back().flags = {ImpactFlag::swapped};
    impacts.back().recording = file;
    impacts.back().trigger = chosen.name;
    window.floor = trigger.trace.time(contacts[i].end);
  }
  return impacts;
}

}  // namespace impactrig::acquisition
