// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "datasets/units.hpp"

namespace impactrig::datasets {

/// When the samples of a channel were taken: t_i = start + i interval, or one stated time a sample.
struct SampleClock {
  double start = 0.0;         ///< time of sample 0 [s], before any known delay is taken off
  double interval = 0.0;      ///< [s], > 0; the mean step where `times` is filled
  std::vector<double> times;  ///< [s], one a sample, only where the step is not uniform (n_samples)

  bool uniform() const { return times.empty(); }

  double time(std::size_t i) const {
    return uniform() ? start + interval * static_cast<double>(i) : times[i];
  }
};

/// Samples as the file holds them. What they mean is Channel::scale and Channel::offset.
using RawSamples = std::variant<std::vector<double>, std::vector<float>, std::vector<std::int16_t>,
                                std::vector<std::int32_t>>;

/// Some of them that follow each other.
using RawSpan = std::variant<std::span<const double>, std::span<const float>,
                             std::span<const std::int16_t>, std::span<const std::int32_t>>;

/// What a calibration says of a channel: how the recorded unit becomes the physical one.
struct Calibration {
  double sensitivity = 1.0;   ///< recorded unit a physical unit, e.g. V/N
  double uncertainty = 0.0;   ///< standard uncertainty of `sensitivity`, same unit
  std::string recorded_unit;  ///< "V"
  std::string physical_unit;  ///< "N"
  std::string source;         ///< where it was stated: rig file, certificate, date
};

/// How much later than the event a channel shows it.
struct Delay {
  double value = 0.0;        ///< [s]
  double uncertainty = 0.0;  ///< standard uncertainty [s]
  bool removed = false;      ///< true once `value` has been taken off the channel's clock
};

/// One measured quantity over time. value(i) = scale * raw[i] + offset, in `unit`.
struct Channel {
  std::string name;
  Quantity quantity = Quantity::unknown;
  std::string unit;  ///< of value(i), as the file spells it; "1" dimensionless, "" not stated
  SampleClock clock;
  RawSamples raw;
  double scale = 1.0;
  double offset = 0.0;
  std::vector<double> imaginary;    ///< (n_samples) of a complex channel, else empty; no scale
  std::vector<std::uint8_t> valid;  ///< 1 sound, 0 not (dropout, clipped, lost); empty: all sound
  std::optional<Calibration> calibration;
  std::optional<Delay> delay;
  std::map<std::string, std::string> attributes;  ///< whatever else the file says, by its own names

  std::size_t size() const;
  double value(std::size_t i) const;
  std::vector<double> values() const;  ///< (n_samples), complex channels: real part
  /// The values from sample `first` on, as many as `to` takes.
  void values(std::size_t first, std::span<double> to) const;

  bool is_valid(std::size_t i) const { return valid.empty() || valid[i] != 0; }

  bool complex() const { return !imaginary.empty(); }
};

/// One thing that was done to a record after it was read, in order.
struct Edit {
  std::string what;                               ///< "remove baseline"
  std::string channel;                            ///< "" for all
  std::map<std::string, std::string> parameters;  ///< with units: {"offset", "0.012 V"}
};

/// Attribute of a channel and parameter of an edit in a recording joined of several: the file that
/// they came with.
constexpr std::string_view recorded_in = "recorded in";

/// Whether an edit was made to this channel, or before it had that name: to one of its file.
bool is_of_file_of(const Edit& edit, const Channel& channel);
bool was_made_to(const Edit& edit, const Channel& channel);

/// Where a record comes from.
struct Provenance {
  std::string source_file;  ///< as named by the user
  std::uint64_t bytes = 0;  ///< its size
  std::string sha256;       ///< of the source file, 64 hex digits; empty for instruments
  std::string importer;     ///< "uff58b"
  std::string program;      ///< "impactrig 0.1.0"
  std::vector<Edit> edits;  ///< every later change
};

/// Attribute of a channel: further names that its file has for it (links), between " | ".
constexpr std::string_view other_names = "linked as";

/// A recording: channels that share a time origin.
struct Record {
  std::string title;
  std::string started;  ///< ISO 8601, or as the file says; "" unknown
  std::vector<Channel> channels;
  Provenance provenance;
  std::vector<std::string> warnings;              ///< one sentence each
  std::map<std::string, std::string> attributes;  ///< whatever else the file's header says

  /// The channel of that name (the first that has it exactly, else the only one that matches
  /// without regard to case), of that name in the group that its attribute "group" states
  /// ("Impacts/Force"), of a name of its attribute other_names, the only one that ends so behind a
  /// slash ("Force" of "/shot/Force"), or of that index from 0 ("2"); null when there is none.
  const Channel* find(std::string_view name_or_index) const;
};

/// "impactrig 0.1.0".
std::string program_version();

/// SHA-256 of a file, or of several one behind the other, 64 hex digits. Throws FileError.
std::string sha256_of_file(const std::string& path);
std::string sha256_of_files(std::span<const std::string> paths);
std::string sha256_of(std::string_view bytes);

/// What a channel has been through, or the channel that it was made of, whatever these were called
/// then; in order.
std::vector<const Edit*> edits_of(const Record& record, const Channel& channel);

/// By a map, whatever it was called then.
bool has_been_inverted(const Record& record, const Channel& channel);

}  // namespace impactrig::datasets
