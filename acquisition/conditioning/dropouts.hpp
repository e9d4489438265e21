// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// A stretch of samples that a laser lost, [begin, end), and how far they are from the course
/// between their neighbours.
struct Dropout {
  std::size_t begin = 0, end = 0;
  double departure = 0.0;  ///< the largest, signed
};

/// Finds dropouts and spikes in a laser's signal: stretches of at most `longest` samples that
/// begin and end with a step, or are one spike, while the signal goes on behind them as it was
/// before.
///
/// A sample stands out when it is further from the cubic through its four neighbours than
///
///   8 times the scatter of that departure, of the whole record and of the samples around it
///   (three times `longest`, at least 192: a burst of noise is no scatter of its own),
///   and 2 % of what the signal spans between its 1st and 99th percentile.
///
/// (the two samples beside a step do so too). A stretch between such samples is a dropout when its
/// departure (the median one, or the largest of up to 12 samples) from the Hermite cubic that joins
/// the lines through 12 sound samples on either side is more than twice the change across it, and
/// four times the scatter of these samples about their lines. So an impact, however few samples it
/// has, is none: the velocity does not come back. Within a contact, where it changes by as much, a
/// stretch of at least 18 samples that is level at zero (3 % of the span, at most six times the
/// noise) is a dropout too, where the line on one side at least does not lead there. A velocity's
/// quiet stretch that is further from zero than its course is none: the laser saw it between two
/// losses. So is a stretch of at least 8 equal samples, the last value that the laser saw, where
/// such are no chance beside samples that differ (once in a million records) and which ends with a
/// step of 8 times the noise and 2 % of the span. Samples at the ends of a stretch that are off by
/// less than a tenth of that (of one at zero within a contact: within three times the scatter of
/// those lines) do not belong to it.
std::vector<Dropout> find_dropouts(std::span<const double> values,
                                   const std::vector<std::uint8_t>& valid, std::size_t longest,
                                   datasets::Quantity quantity);

/// Bridges dropouts and spikes of a velocity or displacement by those cubics and marks their
/// samples invalid: fits and statistics leave them out. The edit says how many there were.
/// Throws std::invalid_argument for a force or an acceleration, in which an impact itself is a
/// spike.
datasets::Edit repair_dropouts(datasets::Channel& channel, const datasets::RepairDropouts& repair);

}  // namespace impactrig::acquisition
