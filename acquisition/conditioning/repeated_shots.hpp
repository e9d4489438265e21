// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "datasets/impact.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// A shot and where its impact is.
struct Shot {
  const datasets::Record* record;
  datasets::Impact impact;
  double next = INFINITY;  ///< first touch of its second impact [s]
  double shift = 0.0;      ///< its times less the first shot's [s]
  /// Standard uncertainty of `shift` [s]; none where first touch alone says it.
  std::optional<double> shift_uncertainty = {};
};

const std::string& file_of(const Shot& shot);

/// Null where the shot has no such channel.
const datasets::Channel* channel_of(const Shot& shot, const std::string& name);

/// "a.csv, b.csv", and of more than three the first ones and how many more there are.
std::string listed(const std::vector<std::string>& files);

/// The channel that its impact was found in.
const datasets::Channel& trigger_of(const Shot& shot);

/// 0 where it does not stand out of the noise, or there is no velocity.
double approach_of(const Shot& shot);

/// The shots that a mean can be made of, known delays taken off their clocks and
/// unmarked dropouts of the first impact marked (an edit each);
/// `warnings` say which are left out, and why. The shots point to the records. Throws
/// datasets::InputError when there are fewer than two, or two channels of a shot have one name;
/// what find_impacts throws.
std::vector<Shot> usable_shots(std::span<datasets::Record> records, const DetectionOptions& options,
                               std::vector<std::string>& warnings);

}  // namespace impactrig::acquisition
