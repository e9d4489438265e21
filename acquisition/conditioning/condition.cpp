// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/condition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "acquisition/conditioning/delay.hpp"
#include "acquisition/conditioning/trace.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;
using datasets::InputError;
using datasets::Quantity;
using datasets::Record;
using datasets::Sensor;
using datasets::UnitConversion;

namespace {

/// A sensor of the rig and the channel it is recorded in.
struct Claim {
  const Sensor* sensor;
  const Channel* channel = nullptr;

  /// As the rig file calls it: "sensors.force".
  std::string key() const { return fmt::format("sensors.{}", name(sensor->quantity)); }
};

InputError refusal(const Record& record, std::string_view problem) {
  return InputError(whole_file(record.provenance.source_file), problem);
}

/// "'Force' and 'Acc'", "'a', 'b' and 'c'".
std::string names_of(const std::vector<const Channel*>& channels) {
  std::string result;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (i > 0) result += i + 1 == channels.size() ? " and " : ", ";
    result += fmt::format("'{}'", channels[i]->name);
  }
  return result;
}

/// "0 'Time' [s], 1 'Force' [N]", or "none".
std::string listing(const Record& record) {
  std::string result;
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    const Channel& channel = record.channels[i];
    result += fmt::format("{}{} '{}'", i > 0 ? ", " : "", i, channel.name);
    if (!channel.unit.empty()) result += fmt::format(" [{}]", channel.unit);
  }
  return result.empty() ? "none" : result;
}

/// Channels over frequency and the like are marked so by their importers; a column that is named
/// and never filled is a channel without samples.
bool history(const Channel& channel) {
  if (channel.size() == 0) return false;
  const auto domain = channel.attributes.find("domain");
  return domain == channel.attributes.end() || domain->second == "time";
}

bool in_recorded_unit(const Channel& channel, const Sensor& sensor) {
  return sensor.sensitivity && datasets::conversion(channel.unit, sensor.recorded_unit);
}

const Channel* named_channel(const Record& record, const Claim& claim) {
  const Channel* const channel = record.find(claim.sensor->channel);
  if (channel != nullptr) return channel;
  throw refusal(record, fmt::format("there is no single channel '{}', which {}.channel names; the "
                                    "channels are: {}",
                                    claim.sensor->channel, claim.key(), listing(record)));
}

/// The only channel that can be the sensor's and is not another sensor's by name.
const Channel* only_channel(const Record& record, const Claim& claim,
                            const std::vector<const Channel*>& taken) {
  std::vector<const Channel*> of_quantity, of_unit;
  for (const Channel& channel : record.channels) {
    if (!history(channel) || std::ranges::find(taken, &channel) != taken.end()) continue;
    if (channel.quantity == claim.sensor->quantity) of_quantity.push_back(&channel);
    if (in_recorded_unit(channel, *claim.sensor)) of_unit.push_back(&channel);
  }
  const auto& candidates = of_quantity.empty() ? of_unit : of_quantity;
  if (candidates.size() == 1) return candidates.front();
  if (candidates.size() > 1)
    throw refusal(record,
                  fmt::format("channels {} can all be the {}; choose one with {}.channel",
                              names_of(candidates), name(claim.sensor->quantity), claim.key()));
  throw refusal(
      record, fmt::format("there is no {} among the channels ({}); choose one with "
                          "{}.channel, or take [{}] out of the rig file",
                          name(claim.sensor->quantity), listing(record), claim.key(), claim.key()));
}

std::vector<Claim> claims_of(const Record& record, const SensorSet& sensors) {
  std::vector<Claim> claims;
  for (const auto* sensor : {&sensors.force, &sensors.velocity, &sensors.displacement})
    if (*sensor) claims.push_back({&**sensor});

  std::vector<const Channel*> taken;
  for (Claim& claim : claims) {
    if (claim.sensor->channel.empty()) continue;
    claim.channel = named_channel(record, claim);
    taken.push_back(claim.channel);
  }
  for (Claim& claim : claims)
    if (claim.channel == nullptr) claim.channel = only_channel(record, claim, taken);

  for (std::size_t i = 0; i < claims.size(); ++i)
    for (std::size_t j = i + 1; j < claims.size(); ++j)
      if (claims[i].channel == claims[j].channel)
        throw refusal(record, fmt::format("channel '{}' is claimed by both {} and {}; choose "
                                          "another with {}.channel",
                                          claims[i].channel->name, claims[i].key(), claims[j].key(),
                                          claims[j].key()));
  return claims;
}

void refuse_samples_that_are_not_finite(const Record& record, const Channel& channel) {
  std::size_t bad = 0;
  std::size_t first = 0;
  const auto count = [&](const auto& samples) {
    if constexpr (std::is_floating_point_v<typename std::decay_t<decltype(samples)>::value_type>) {
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (std::isfinite(samples[i]) || !channel.is_valid(i)) continue;
        if (bad++ == 0) first = i;
      }
    }
  };
  std::visit(count, channel.raw);
  if (bad > 0)
    throw refusal(record, fmt::format("channel '{}' has {} sample{} that {} not finite, the first "
                                      "is sample {} at {:.9g} s; mark them invalid or cut them out",
                                      channel.name, bad, bad == 1 ? "" : "s",
                                      bad == 1 ? "is" : "are", first, channel.clock.time(first)));
}

/// value -> factor * value + offset, without touching the samples.
void scale_values(Channel& channel, double factor, double offset) {
  channel.scale *= factor;
  channel.offset = factor * channel.offset + offset;
}

void convert_unit(Channel& channel, const UnitConversion& to_si, Quantity quantity,
                  std::vector<Edit>& edits) {
  if (to_si.factor == 1.0 && to_si.offset == 0.0) return;
  scale_values(channel, to_si.factor, to_si.offset);
  edits.push_back({"convert unit",
                   channel.name,
                   {{"from", channel.unit},
                    {"to", std::string(si_unit(quantity))},
                    {"factor", fmt::format("{}", to_si.factor)},
                    {"offset", fmt::format("{} {}", to_si.offset, si_unit(quantity))}}});
}

void apply_sensitivity(Channel& channel, const Sensor& sensor, const UnitConversion& to_recorded,
                       std::vector<Edit>& edits) {
  const double sensitivity = sensor.sensitivity->value;
  scale_values(channel, to_recorded.factor / sensitivity, to_recorded.offset / sensitivity);
  const std::string unit = fmt::format("{}/({})", sensor.recorded_unit, si_unit(sensor.quantity));
  edits.push_back({"apply sensitivity",
                   channel.name,
                   {{"sensitivity", fmt::format("{} {}", sensitivity, unit)},
                    {"uncertainty", fmt::format("{} {}", sensor.sensitivity->uncertainty, unit)},
                    {"recorded", channel.unit.empty() ? "unit not stated" : channel.unit}}});
}

/// The same sensor has the same relative uncertainty whoever applied its sensitivity.
void keep_calibration(Channel& channel, const Sensor& sensor) {
  if (!sensor.sensitivity) return;
  channel.calibration = {.sensitivity = sensor.sensitivity->value,
                         .uncertainty = sensor.sensitivity->uncertainty,
                         .recorded_unit = sensor.recorded_unit,
                         .physical_unit = std::string(si_unit(sensor.quantity)),
                         .source = fmt::format("sensors.{}.sensitivity", name(sensor.quantity))};
}

void refuse_useless_sensitivity(const Record& record, const Claim& claim) {
  const auto& sensitivity = claim.sensor->sensitivity;
  if (sensitivity && (sensitivity->value == 0.0 || !std::isfinite(sensitivity->value)))
    throw refusal(record, fmt::format("{}.sensitivity is {} {}/({}), which turns every sample of "
                                      "channel '{}' into nothing; state the calibrated value",
                                      claim.key(), sensitivity->value, claim.sensor->recorded_unit,
                                      si_unit(claim.sensor->quantity), claim.channel->name));
}

void convert_to_si(const Record& record, const Claim& claim, Channel& channel, Record& result) {
  const Sensor& sensor = *claim.sensor;
  refuse_useless_sensitivity(record, claim);
  auto& edits = result.provenance.edits;
  if (const auto to_si = datasets::conversion(channel.unit, si_unit(sensor.quantity))) {
    convert_unit(channel, *to_si, sensor.quantity, edits);
    if (sensor.sensitivity)
      result.warnings.push_back(
          fmt::format("Channel '{}' is recorded in {} already, so {}.sensitivity is not applied.",
                      channel.name, channel.unit, claim.key()));
  } else if (in_recorded_unit(channel, sensor)) {
    apply_sensitivity(channel, sensor, *datasets::conversion(channel.unit, sensor.recorded_unit),
                      edits);
  } else if (sensor.sensitivity && channel.unit.empty()) {
    apply_sensitivity(channel, sensor, {}, edits);
    result.warnings.push_back(
        fmt::format("Channel '{}' states no unit; it is taken to be in {} as {}.sensitivity says.",
                    channel.name, sensor.recorded_unit, claim.key()));
  } else {
    const std::string remedy = fmt::format(
        "state {0}.sensitivity or choose another channel with {0}.channel", claim.key());
    if (channel.unit.empty())
      throw refusal(record, fmt::format("channel '{}' states no unit; {}, or state its unit when "
                                        "importing",
                                        channel.name, remedy));
    if (sensor.sensitivity)
      throw refusal(
          record,
          fmt::format("channel '{}' is in {}, but {}.sensitivity is for a recording in "
                      "{}; correct the sensitivity or choose another channel with "
                      "{}.channel",
                      channel.name, channel.unit, claim.key(), sensor.recorded_unit, claim.key()));
    throw refusal(record, fmt::format("channel '{}' is in {}, which is no {}; {}", channel.name,
                                      channel.unit, name(sensor.quantity), remedy));
  }
  channel.quantity = sensor.quantity;
  channel.unit = si_unit(sensor.quantity);
}

void apply_polarity(Channel& channel, const Sensor& sensor, std::vector<Edit>& edits) {
  if (sensor.polarity >= 0.0) return;
  scale_values(channel, -1.0, 0.0);
  edits.push_back({"apply polarity", channel.name, {{"polarity", "-1"}}});
}

/// A map's delay gives way to the rig file's, which gives way to one that is off already; both may
/// be meant.
void warn_of_two_delays(const Claim& claim, Record& result) {
  const auto& own = claim.channel->delay;
  const datasets::Delay& stated = claim.sensor->delay;
  if (!own || own->value == stated.value || !says_something(stated)) return;
  result.warnings.push_back(fmt::format(
      fmt::runtime(own->removed
                       ? "Channel '{}' has had a delay of {:g} s taken off, so {}.delay, {:g} s, "
                         "is not; state it in one place."
                       : "Channel '{}' states a delay of {:g} s, but {}.delay is {:g} s, which is "
                         "used; state it in one place."),
      claim.channel->name, own->value, claim.key(), stated.value));
}

/// A map that has turned a channel over leaves nothing to turn to the rig file; both may be meant,
/// as for an amplifier between the two.
void warn_of_two_polarities(const Record& record, const Claim& claim, Record& result) {
  if (claim.sensor->polarity >= 0.0 || !has_been_inverted(record, *claim.channel)) return;
  result.warnings.push_back(
      fmt::format("Channel '{}' has been inverted by its map, and is again by {}.polarity = -1, so "
                  "that it is as recorded; state it in one place.",
                  claim.channel->name, claim.key()));
}

void warn_of_low_cut(const Claim& claim, Record& result) {
  if (claim.sensor->quantity != Quantity::velocity || !claim.sensor->low_cut) return;
  result.warnings.push_back(
      fmt::format("{}.low_cut is {:g} Hz: the constant approach speed does not reach the "
                  "recording, so restitution cannot be read off as a ratio of plateaus; use a "
                  "decoder range that goes down to 0 Hz.",
                  claim.key(), claim.sensor->low_cut->frequency));
}

Channel conditioned(const Record& record, const Claim& claim, Record& result) {
  refuse_unusable_clock(*claim.channel, record.provenance.source_file);
  refuse_samples_that_are_not_finite(record, *claim.channel);
  Channel channel = *claim.channel;
  convert_to_si(record, claim, channel, result);
  apply_polarity(channel, *claim.sensor, result.provenance.edits);
  warn_of_two_polarities(record, claim, result);
  if (auto edit = remove_known_delay(channel, claim.sensor->delay))
    result.provenance.edits.push_back(std::move(*edit));
  warn_of_two_delays(claim, result);
  keep_calibration(channel, *claim.sensor);
  if (claim.sensor->range > 0.0)
    channel.attributes["sensor.range"] = fmt::format("{}", claim.sensor->range);
  if (const auto& cut = claim.sensor->low_cut; cut && cut->order == 1)
    channel.attributes["sensor.low_cut"] = fmt::format("{}", cut->frequency);
  warn_of_low_cut(claim, result);
  return channel;
}

/// What stands in for the rig's sensors when there are none: the recording's own channels.
void take_what_is_there(const Record& record, Record& result) {
  constexpr std::array wanted{Quantity::force, Quantity::velocity, Quantity::displacement,
                              Quantity::acceleration};
  for (const Channel& channel : record.channels) {
    if (!history(channel)) continue;
    if (std::ranges::find(wanted, channel.quantity) == wanted.end()) continue;
    Sensor sensor;
    sensor.quantity = channel.quantity;
    result.channels.push_back(conditioned(record, {&sensor, &channel}, result));
  }
  if (result.channels.empty())
    throw refusal(record, fmt::format("there is no force, velocity, displacement or acceleration "
                                      "among the channels ({}); describe them in a rig file under "
                                      "[sensors.force] and [sensors.velocity]",
                                      listing(record)));
}

void list_channels_left_out(const Record& record, Record& result) {
  std::string names;
  for (const Channel& channel : record.channels) {
    const auto kept = [&](const Channel& other) { return other.name == channel.name; };
    if (std::ranges::any_of(result.channels, kept)) continue;
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", channel.name);
  }
  if (!names.empty())
    result.provenance.edits.push_back({"leave out channels", "", {{"channels", names}}});
}

/// A channel that has been aligned to another goes by that one's clock: what comes off this now
/// comes off both.
void follow_references(const Record& record, Record& result) {
  const std::vector<Edit> edits = record.provenance.edits;
  for (Channel& channel : result.channels)
    for (const Edit& edit : edits) {
      if (edit.what != "align" || !was_made_to(edit, channel)) continue;
      const auto reference = edit.parameters.find("reference");
      if (reference == edit.parameters.end()) continue;
      const Channel* const before = record.find(reference->second);
      const auto after = std::ranges::find_if(result.channels, [before](const Channel& other) {
        return before != nullptr && other.name == before->name;
      });
      if (before == nullptr || after == result.channels.end()) continue;
      if ((before->delay && before->delay->removed) || after->delay->value == 0.0) continue;
      const datasets::Delay own = channel.delay.value_or(datasets::Delay{});
      channel.delay.reset();
      auto follow = remove_known_delay(channel, {after->delay->value, own.uncertainty, false});
      follow->parameters.emplace("with", before->name);
      channel.delay->value += own.value;
      result.provenance.edits.push_back(std::move(*follow));
    }
}

}  // namespace

Record condition(const Record& record, const SensorSet& sensors) {
  Record result;
  result.title = record.title;
  result.started = record.started;
  result.provenance = record.provenance;
  result.warnings = record.warnings;
  result.attributes = record.attributes;

  const std::vector<Claim> claims = claims_of(record, sensors);
  for (const Claim& claim : claims) result.channels.push_back(conditioned(record, claim, result));
  if (claims.empty()) take_what_is_there(record, result);
  follow_references(record, result);
  list_channels_left_out(record, result);
  return result;
}

}  // namespace impactrig::acquisition
