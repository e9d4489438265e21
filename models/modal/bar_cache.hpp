// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "models/collocation/step_ladder.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"
#include "models/modal/reduced_bar.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// A bar in its modes with the responses of the steps taken so far. For concurrent use.
class ModalBar {
 public:
  ModalBar(std::shared_ptr<const SmallMotionBeam> beam, const Rig& rig);
  ModalBar(std::shared_ptr<const ReducedBar> beam, const Rig& rig);
  ModalBar(std::shared_ptr<const ModalBar> other, const ModalBeam::Change& change);
  ~ModalBar();
  ModalBar(const ModalBar&) = delete;
  ModalBar& operator=(const ModalBar&) = delete;

  const ModalBeam& modes() const { return modes_; }

  /// How many of the modes are the bar's own; those of a ReducedBar after them stand for the rest.
  int own_modes() const { return own_modes_; }

  /// Whether some do.
  bool is_reduced() const { return own_modes_ < modes_.modes(); }

  const StepLadder& ladder() const { return ladder_; }

  const ModalStep& step(const Collocation& rule, int level) const;

 private:
  /// Steps of one level, of one rule each, in the order they were first asked for.
  struct Steps {
    int nodes;
    ModalStep step;
    std::unique_ptr<const Steps> others;
  };

  std::shared_ptr<const ModalBar> other_;  // whose beam the modes stand on
  std::shared_ptr<const SmallMotionBeam> beam_;
  ModalBeam modes_;
  int own_modes_;
  StepLadder ladder_;
  mutable std::mutex mutex_;  // of those who add steps
  mutable std::array<std::atomic<const Steps*>, StepLadder::levels> steps_ = {};
};

/// What a bar in its modes depends on.
struct BarKey {
  Beam beam;
  Hinge hinge;
  double position, gravity;
  std::vector<double> further;  // positions of further stops, negative on the far side
  BeamModel model;
  std::array<int, 2> elements;
  int modes, axial_modes;
  Basis basis;

  static BarKey of(const Rig& rig, const Solver& solver);

  struct Hash {
    std::size_t operator()(const BarKey& key) const;
  };

  bool operator==(const BarKey&) const = default;
};

std::shared_ptr<const ModalBar> make_modal_bar(const Rig& rig, const Solver& solver);

/// Of finite elements: the bar in so many of its modes and what stands for the others.
std::shared_ptr<const ReducedBar> make_reduced_bar(const Rig& rig, const Solver& solver, int modes);

/// Bars of the same length, struck point, mesh and weight a mass, without further masses, have
/// nearly the same modes, whatever E, I, ρ, A and the hinge's spring and damper are: those of each
/// follow from the modes of one that stands for all.
class BarFamily {
 public:
  /// The bar that stands for all; of beams that are in no family, none.
  static std::optional<Rig> representative(const Rig& rig);

  BarFamily(const Rig& representative, const Solver& solver);

  std::shared_ptr<const ModalBar> bar(const Rig& rig) const;

 private:
  Beam beam_;
  std::shared_ptr<const ModalBar> bar_;
};

/// What runs of the same bar share: its modes are computed again only when beam, struck point,
/// weight or mesh are others than in the run before. For concurrent use.
class BarCache {
 public:
  /// In all modes.
  std::shared_ptr<const ModalBar> bar(const Rig& rig, const Solver& solver);

  /// A ReducedBar.
  std::shared_ptr<const ModalBar> reduced_bar(const Rig& rig, const Solver& solver, int modes);

 private:
  void forget_others(const Rig& rig, const Solver& solver);

  std::mutex mutex_;
  std::optional<BarKey> key_;
  std::shared_ptr<const ModalBar> whole_;
  std::map<int, std::shared_ptr<const ModalBar>> reduced_;  // by the number of modes asked for
  std::shared_ptr<const ReducedBar> last_;                  // of those
};

}  // namespace impactrig::models
