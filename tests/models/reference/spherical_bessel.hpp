// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace impactrig::models {

/// Spherical Bessel functions j_0(z) ... j_{n-1}(z) of the first kind, z >= 0, by Miller's backward
/// recurrence, scaled by Σ (2n + 1) j_n² = 1,
/// or forward where z is larger than all n. Absolute error a few units of rounding.
/// Source: [DLMF2010], 10.51 and 10.60.12.
void spherical_bessel(double z, std::span<double> j);

}  // namespace impactrig::models
