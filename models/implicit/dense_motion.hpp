// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "models/collocation/bar_motion.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// The full equations of a bar of few coordinates in steps of the Radau IIA method; the cost of a
/// step grows with the cube of their number.
std::unique_ptr<BarMotion> make_dense_motion(const Rig& rig, const Solver& solver,
                                             const HistoryRequest& history);

}  // namespace impactrig::models
