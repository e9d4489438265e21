// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/sampled_curve.hpp"
#include "models/simulation.hpp"

namespace impactrig::fitting {

/// What a force sensor in the first stop sees of a simulated impact, for its chain: with the jumps
/// of the force, and spikes for what lines between its samples miss.
datasets::SampledCurve force_curve(const models::History& history);

}  // namespace impactrig::fitting
