// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "models/collocation/bar_motion.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// The full equations of an AncfBeam in steps of the Radau IIA method: its vibration limits no
/// step, and the cost of a step is linear in the elements.
std::unique_ptr<BarMotion> make_ancf_motion(const Rig& rig, const Solver& solver,
                                            const HistoryRequest& history);

/// The same of a ReissnerBeam.
std::unique_ptr<BarMotion> make_reissner_motion(const Rig& rig, const Solver& solver,
                                                const HistoryRequest& history);

}  // namespace impactrig::models
