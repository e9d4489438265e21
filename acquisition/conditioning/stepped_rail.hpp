// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/impact.hpp"

namespace impactrig::acquisition {

/// A rail that no range states, of a digitiser whose steps hide the noise: a level stretch at the
/// extreme, far longer than a step takes beside it, that the signal leaves at once. Inside the
/// window both ends have to, and fall off faster than the crest through such steps would that the
/// stretch allows (see flat_top). A velocity may begin or end on its rail; so may one at constant
/// speed whose contact begins with a jump, but that one leaves before the force has done anything,
/// and within a tenth of the contact where the two channels are not quite aligned; where they are
/// further apart, is_cut_not_late() tells.
/// Displacements do it by themselves, as a struck bar's.
bool on_stepped_rail(const datasets::Impact& impact, const datasets::ImpactSignal& signal,
                     double sign);

/// The same of a velocity whose noise hides a digitiser's steps, and is behind the rail too: seen
/// in steps of that noise.
bool on_noisy_rail(const datasets::Impact& impact, const datasets::ImpactSignal& velocity,
                   double sign);

}  // namespace impactrig::acquisition
