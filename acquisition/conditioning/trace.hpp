// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/input_error.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// A channel as plain numbers: SI, uniform steps, invalid samples bridged by straight lines.
struct Trace {
  datasets::Quantity quantity = datasets::Quantity::unknown;
  double start = 0.0;               ///< time of values[0] [s]
  double interval = 0.0;            ///< [s], > 0
  std::vector<double> values;       ///< [SI] (n_samples)
  std::vector<std::uint8_t> valid;  ///< as Channel::valid; empty: all sound

  double time(double index) const { return start + interval * index; }

  double index(double time) const { return (time - start) / interval; }

  bool is_valid(std::size_t i) const { return valid.empty() || valid[i] != 0; }

  /// The marks of samples [begin, end); empty: all sound.
  std::span<const std::uint8_t> marks(std::size_t begin, std::size_t end) const {
    if (valid.empty()) return {};
    return std::span(valid).subspan(begin, end - begin);
  }
};

/// A recording as the place of an error.
inline datasets::SourcePosition whole_file(const std::string& file) {
  return {file, 0, 0, std::nullopt};
}

/// Throws datasets::InputError (place: `file`) when a channel has no samples, is complex, or its
/// clock has no or no uniform step.
void refuse_unusable_clock(const datasets::Channel& channel, const std::string& file);

/// Whether any sample is valid and finite.
bool has_sound_sample(const datasets::Channel& channel);

/// Throws datasets::InputError (place: `file`) besides when the unit cannot be converted to that of
/// the channel's quantity, or no sample is sound. Samples that are not finite count as invalid.
Trace trace_of(const datasets::Channel& channel, const std::string& file);

/// Replaces the values where valid[i] is 0 by the straight line between their sound neighbours (by
/// the nearest one at the ends). At least one must be sound; an empty `valid` changes nothing.
void bridge_invalid(std::vector<double>& values, const std::vector<std::uint8_t>& valid);

}  // namespace impactrig::acquisition
