// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "fitting/shot_model.hpp"
#include "fitting/shot_numbers.hpp"

namespace impactrig::fitting {

/// What a model predicts of one recording at values of its numbers, and the slopes. These are exact
/// in small motion; the full equations take those of small motion where that is close
/// (`take_small_slopes`), else differences of simulations, run on all cores.
class ShotPredictions {
 public:
  using Prediction = std::shared_ptr<const Shown>;
  using Values = ShotNumbers::Values;

  /// All must live as long.
  ShotPredictions(const RigFile& rig, const ShotModel& model, const ShotNumbers& numbers)
      : rig_(rig),
        model_(model),
        numbers_(numbers) {}

  /// With its slopes where they are wanted and the equations have them; the last few are kept.
  Prediction predict(const Values& values, bool with_slopes) const;

  /// By another model, or afresh.
  Prediction predict_by(const ShotModel& model, const Values& values) const;

  /// Of every slot that needs a simulation, in the order of the slots; `held` keeps those that were
  /// made here.
  std::vector<const Shown*> slopes_at(const Values& values, const Shown& shown,
                                      std::vector<Shown>& held) const;

  void take_small_slopes() { small_slopes_ = true; }

  models::Rig rig_at(const Values& values) const { return numbers_.rig_at(values, rig_.rig); }

  long simulations() const { return simulations_; }

 private:
  Shown simulate(const ShotModel& model, const Values& values,
                 const WantedSlopes& wanted = {}) const;
  std::vector<Prediction> predict_all(const std::vector<Values>& places) const;
  std::vector<Shown> differences(const Values& values) const;

  const RigFile& rig_;
  const ShotModel& model_;
  const ShotNumbers& numbers_;
  bool small_slopes_ = false;
  mutable std::optional<models::Motion> without_slopes_;
  mutable std::map<Values, Prediction> cache_;
  mutable long simulations_ = 0;
};

}  // namespace impactrig::fitting
