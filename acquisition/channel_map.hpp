// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/recording_reader.hpp"
#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

/// What a map says of the channels of one name or pattern.
struct ChannelMapping {
  std::string match;  ///< name (case counts less than a whole match), or a pattern with * and ?
  std::optional<std::size_t> index;  ///< in place of `match`: from 0
  std::string name;                  ///< in place of the file's; "" = the file's
  std::optional<datasets::Quantity> role;
  std::string unit;  ///< of the file's numbers, in place of what the file says; "" = the file's
  /// What 1.0 in the file stands for, in `unit`; > 0 (a WAVE file holds parts of full scale).
  std::optional<double> full_scale;
  /// Recorded unit an SI unit of the role, gain included; > 0.
  std::optional<datasets::UncertainValue> sensitivity;
  std::string recorded_unit;       ///< of `sensitivity`: "V" or "pC"
  double polarity = 1.0;           ///< 1 or -1
  std::optional<double> position;  ///< from the hinge [m]
  std::optional<datasets::Delay> delay;
  std::uint32_t line = 0;  ///< of the map's file where the entry begins, from 1; 0 = not known
};

/// Which channels of recordings are meant, and what their numbers are.
struct ChannelMap {
  std::string file;          ///< where it is written
  bool keep_others = false;  ///< channels that it does not name follow, as they are
  std::vector<ChannelMapping> channels;
  /// What is done to the mapped channels once they are in memory (apply_steps); `mapped` leaves it.
  std::vector<datasets::ConditioningStep> conditioning{};
};

/// A recording with the channels of a map, in the map's order. Samples stay as they are: unit,
/// sensitivity and polarity go into scale and offset, the provenance has an edit for each channel.
/// Throws datasets::InputError for a mapping that fits no channel, a name that would be given
/// twice, or a role that the unit is not of.
std::unique_ptr<RecordingReader> mapped(std::unique_ptr<RecordingReader> reader, ChannelMap map);

/// A map of a recording's channels as a file to be completed, with a comment for each key. It holds
/// as it is: what does not fit a channel's unit is a comment. Where the record has its samples, the
/// polarity is what the largest impact shows: the contact presses and the bar comes closer.
std::string suggested_map(const datasets::Record& record);

/// What to state as the unit where a mass in kg is recorded and a force ("kgf") or an acceleration
/// ("kilo-g") is meant; "" for other units and roles.
std::string_view unit_of_weight(std::string_view unit, datasets::Quantity role);

/// A usual sensitivity of a channel recorded in volts ("2.25 mV/N") or coulombs ("4 pC/N"); "" for
/// other units and roles.
std::string sensitivity_example(std::string_view unit, datasets::Quantity role);

/// True when a name is of a pattern: * stands for any characters, ? for one.
bool matches_pattern(std::string_view name, std::string_view pattern);

}  // namespace impactrig::acquisition
