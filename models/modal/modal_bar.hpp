// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

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

  /// BarModes::left_out.
  const Eigen::VectorXd& left_out() const { return left_out_; }

  const StepLadder& ladder() const { return ladder_; }

  const ModalStep& step(const Collocation& rule, int level) const;

 protected:
  /// A bar whose modes stand on what another has.
  ModalBar(std::shared_ptr<const ModalBar> other, ModalBeam modes);

  /// `step` may be one that is no longer needed. Called once a rule and level, one call at a time.
  virtual void make_step(const Collocation& rule, int level, std::optional<ModalStep>& step) const;

  /// The bar becomes another of as many modes and stops, when nobody uses it any more: its modes
  /// are changed by `change`, its steps are memory for new ones.
  template <typename Change>
  void become(const Change& change) {
    forget_steps();
    change(modes_);
    measure();
  }

 private:
  /// Steps of one level, of one rule each, in the order they were first asked for.
  struct Steps {
    int nodes = 0;
    std::optional<ModalStep> step;
    std::unique_ptr<Steps> others;
  };

  void forget_steps();
  void measure();

  std::shared_ptr<const ModalBar> other_;
  std::shared_ptr<const SmallMotionBeam> beam_;
  ModalBeam modes_;
  int own_modes_;
  Eigen::VectorXd left_out_;
  StepLadder ladder_;
  mutable std::mutex mutex_;  // of those who add steps
  mutable std::array<std::atomic<Steps*>, StepLadder::levels> steps_ = {};
  mutable std::unique_ptr<Steps> unused_;
};

}  // namespace impactrig::models
