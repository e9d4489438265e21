// SPDX-License-Identifier: BSD-3-Clause
#include "models/implicit/ancf_chain.hpp"
#include "models/implicit/chain_motion.hpp"
#include "models/implicit/chain_motion_looks.hpp"
#include "models/implicit/chain_motion_steps.hpp"
#include "models/implicit/slope_hold.hpp"

namespace impactrig::models {

std::unique_ptr<BarMotion> make_ancf_motion(const Rig& rig, const Solver& solver,
                                            const HistoryRequest& history) {
  return make_chain_motion<AncfChain, SlopeHold>(rig, solver, history);
}

}  // namespace impactrig::models
