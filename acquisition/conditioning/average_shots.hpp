// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// The mean of repeated shots, channel by channel: noise falls by the root of their number, and
/// what differs from shot to shot stands beside it.
///
/// Each shot's first impact is laid on that of the first shot by estimate_shift of the trigger
/// channel (by first touch, with a warning, where that refuses), and its channels are read there
/// between samples (BandLimited). Delays that are known (Channel::delay) and not taken off yet come
/// off first; of those of one channel the mean has the mean, and the mean of their uncertainties,
/// since one sensor's do not average out. The mean has the first shot's clock, as far as every shot
/// reaches and before any shot's second impact, since bounces do not coincide. Channels are taken
/// by their names; those that not every shot has, or whose clock is not uniform, are left out with
/// a warning. Single values stay where they are one in all shots. For each there is a second
/// channel, "NAME, standard deviation", over the shots. A sample is the mean of the sound ones, and
/// invalid where there are fewer than two.
///
/// A shot without impact, or whose impact is clipped, hit twice or cut, of the other sign or found
/// in another quantity, is left out with a warning; so is one that was conditioned otherwise than
/// most, by steps that change samples, since the edits of the mean are the first shot's. What is
/// said of the single shots stays, with their files. Where it has unmarked dropouts they are
/// marked, by repair_dropouts of the whole channel, with a warning. When peaks or approach
/// velocities spread by more than 5 % that is said, with the shot that is furthest from the median:
/// contact is not linear, so the mean of unlike shots is the shot of no rig. Of three shots or
/// more, one that shows another channel by more than a sample earlier or later beside the trigger
/// than most is named: a delay was left in it. The edits hold files, shifts with their standard
/// uncertainties, and spreads.
///
/// Throws datasets::InputError when fewer than two shots are left, or units
/// of one channel cannot be converted, or two channels of a shot have one name; what find_impacts
/// throws.
datasets::Record average_shots(std::vector<datasets::Record> shots,
                               const DetectionOptions& options = {});

}  // namespace impactrig::acquisition
