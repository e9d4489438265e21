// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "models/modal/modal_bar.hpp"
#include "models/modal/reduced_bar.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// What a bar in its modes depends on.
struct BarKey {
  Beam beam;
  Hinge hinge;
  double position, gravity_along, gravity_across;
  std::vector<double> further;  // positions of further stops, negative on the far side
  BeamModel model;
  std::array<int, 2> elements;
  int modes, axial_modes;
  Basis basis;
  double negligible_weight;  // as a LinearBar has it

  static BarKey of(const Rig& rig, const Solver& solver);

  struct Hash {
    std::size_t operator()(const BarKey& key) const;
  };

  bool operator==(const BarKey&) const = default;
};

std::shared_ptr<const ModalBar> make_modal_bar(const Rig& rig, const Solver& solver);

/// Of finite elements: the bar in so many of its modes and what stands for the others.
std::shared_ptr<const ReducedBar> make_reduced_bar(const Rig& rig, const Solver& solver, int modes);

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
