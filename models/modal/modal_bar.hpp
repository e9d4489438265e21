// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>

#include "models/collocation/step_ladder.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"
#include "models/modal/reduced_bar.hpp"

namespace impactrig::models {

/// A bar in its modes with the responses of the steps taken so far. For concurrent use.
class ModalBar {
 public:
  ModalBar(std::shared_ptr<const SmallMotionBeam> beam, const Rig& rig);
  ModalBar(std::shared_ptr<const ReducedBar> beam, const Rig& rig);
  ModalBar(std::shared_ptr<const ModalBar> other, const ModalBeam::Change& change);
  virtual ~ModalBar();
  ModalBar(const ModalBar&) = delete;
  ModalBar& operator=(const ModalBar&) = delete;

  const ModalBeam& modes() const { return modes_; }

  /// How many of the modes are the bar's own; those of a ReducedBar after them stand for the rest.
  int own_modes() const { return own_modes_; }

  /// Whether some do.
  bool is_reduced() const { return own_modes_ < modes_.modes(); }

  const StepLadder& ladder() const { return ladder_; }

  const ModalStep& step(const Collocation& rule, int level) const;

 protected:
  /// A bar whose modes stand on what another has.
  ModalBar(std::shared_ptr<const ModalBar> other, ModalBeam modes);

  /// Called once a rule and level, one call at a time.
  virtual ModalStep make_step(const Collocation& rule, int level) const;

 private:
  /// Steps of one level, of one rule each, in the order they were first asked for.
  struct Steps {
    int nodes;
    ModalStep step;
    std::unique_ptr<const Steps> others;
  };

  std::shared_ptr<const ModalBar> other_;
  std::shared_ptr<const SmallMotionBeam> beam_;
  ModalBeam modes_;
  int own_modes_;
  StepLadder ladder_;
  mutable std::mutex mutex_;  // of those who add steps
  mutable std::array<std::atomic<const Steps*>, StepLadder::levels> steps_ = {};
};

}  // namespace impactrig::models
