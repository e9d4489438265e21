// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "models/collocation/step_ladder.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// A bar in its modes with the responses of the steps taken so far. For concurrent use.
class ModalBar {
 public:
  ModalBar(std::unique_ptr<const SmallMotionBeam> beam, const Rig& rig);

  const ModalBeam& modes() const { return modes_; }

  const StepLadder& ladder() const { return ladder_; }

  const ModalStep& step(const Collocation& rule, int level) const;

 private:
  std::unique_ptr<const SmallMotionBeam> beam_;
  ModalBeam modes_;
  StepLadder ladder_;
  mutable std::mutex mutex_;
  mutable std::map<std::pair<int, int>, std::unique_ptr<const ModalStep>> steps_;  // nodes, level
};

/// What runs of the same bar share: its modes are computed again only when beam, struck point,
/// weight or mesh are others than in the run before. For concurrent use.
class BarCache {
 public:
  std::shared_ptr<const ModalBar> bar(const Rig& rig, const Solver& solver);

 private:
  struct Key {
    Beam beam;
    Hinge hinge;
    double position, gravity;
    BeamModel model;
    std::array<int, 2> elements;
    int modes;
    Basis basis;

    bool operator==(const Key&) const = default;
  };

  std::mutex mutex_;
  std::optional<Key> key_;
  std::shared_ptr<const ModalBar> bar_;
};

}  // namespace impactrig::models
