// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// A channel and the recording it comes from, for messages.
struct NamedChannel {
  const datasets::Channel& channel;
  std::string file;
};

struct PairingOptions {
  double shift = 0.0;  ///< what the predicted channel is moved later by [s]
  double from = -std::numeric_limits<double>::infinity();  ///< first time compared [s]
  double to = std::numeric_limits<double>::infinity();     ///< last [s], inclusive
};

/// Two channels in one unit at one uniform run of times.
struct PairedHistories {
  std::string unit;               ///< SI where it can be, else that of the measured channel
  double start = 0.0;             ///< time of sample 0 on the measured channel's clock [s]
  double interval = 0.0;          ///< [s], > 0
  std::vector<double> measured;   ///< (n_samples), finite
  std::vector<double> predicted;  ///< (n_samples), finite
  bool measured_resampled = false;
  bool predicted_resampled = false;
  std::size_t measured_bridged = 0;   ///< samples within that were not sound
  std::size_t predicted_bridged = 0;  ///< of the predicted channel's own
  std::vector<std::string> notes;     ///< one sentence each: what was done and should be known

  double end() const { return start + interval * static_cast<double>(measured.size() - 1); }
};

/// Brings two channels together where both have samples, within the window.
///
/// The times are the measured channel's; where those are uneven, a uniform run with their mean
/// step. A channel with other times than these (by more than a thousandth of a step anywhere) is
/// resampled by straight lines, unfiltered: a predicted force bends sharply where contact begins,
/// and a band-limited curve would ring there. What is sampled more finely than the result may
/// alias. Samples that are not sound are bridged by straight lines within and cut off at the ends.
///
/// Throws datasets::InputError when a channel is no time history, its times go back, units cannot
/// be converted into each other, the two share no two instants, or more than a tenth of the samples
/// is not sound.
PairedHistories pair_histories(const NamedChannel& measured, const NamedChannel& predicted,
                               const PairingOptions& options = {});

}  // namespace impactrig::acquisition
