// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/fit.hpp"

namespace impactrig::fitting {

/// What is said of parameters that ended at a bound. There the covariance knows nothing of the side
/// that is left (a restitution of 0 acts by its square), but the profile likelihood, where the fit
/// has one, does: `ci95` then goes from the bound to its limit, and `std_error` is the way there
/// over 1.96. Where χ² still rises from the bound on like a slope, not like a valley's floor, the
/// data want the parameter beyond by some two standard errors and more, and no interval helps: both
/// stay as they are. A warning says which.
void settle_bounds(Fit& fit);

}  // namespace impactrig::fitting
