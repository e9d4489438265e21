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

/// Between two rigs that differ by little, by which part of an element's length it changes, or what
/// lies on it moves, at most. 0 where no element does, or the layout changes.
double largest_change_of_elements(const Rig& one, const Rig& other, const Solver& solver,
                                  const HistoryRequest& history);

}  // namespace impactrig::models
