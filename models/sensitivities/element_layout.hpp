// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "models/simulation.hpp"

namespace impactrig::models {

/// How a solver divides a bar into elements, and which of them hold what is struck, carried or
/// looked at. Closed forms have neither.
struct ElementLayout {
  std::vector<int> shares;  ///< elements between steps of the bar, struck point and ends
  /// Of masses, stops and lasers, the element of each; beyond the tip one more than there are.
  std::vector<std::size_t> holds;

  static ElementLayout of(const Rig& rig, const Solver& solver, const HistoryRequest& history);

  bool operator==(const ElementLayout&) const = default;
};

}  // namespace impactrig::models
