// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "datasets/impact.hpp"
#include "fitting/fitted_channel.hpp"
#include "fitting/shot_cost.hpp"
#include "fitting/shot_model.hpp"

namespace impactrig::fitting {

/// One recording of a fit with what was chosen for it.
struct Shot {
  const datasets::Impact* impact = nullptr;
  double window = 0.0;   ///< fitted after first touch [s]
  double contact = 0.0;  ///< duration of the first contact as seen [s]
  double reach = 0.0;    ///< of the filters of its channels, to either side of a sample [s]
  std::vector<FittedChannel> channels;
  std::vector<std::size_t> numbers;  ///< of the variables that concern it
  std::shared_ptr<ShotModel> model;
  std::unique_ptr<ShotCost> cost;
};

/// What a prediction of a shot needs beyond the recorded samples, to either side [s].
double margin_of(const Shot& shot);

/// Takes the sound samples of every channel, up to a part of the window in contact durations.
void choose_samples(Shot& shot, double contacts, bool one_by_one);

/// Throws std::invalid_argument where a filter reaches so far that no sample of the window depends
/// on recorded ones alone.
void refuse_all_made_up(const Shot& shot);

}  // namespace impactrig::fitting
