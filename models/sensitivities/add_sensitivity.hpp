// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/simulation.hpp"

namespace impactrig::models {

/// Adds derivatives of the same run by another number of its rig, times `weight`. A sum that is
/// empty yet takes the shape of the first.
void add_sensitivity(double weight, const Sensitivity& part, Sensitivity& sum);

}  // namespace impactrig::models
