// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fitting/model_comparison.hpp"

namespace impactrig::fitting {

/// The rig file again with some keys changed, as a model to hold against the file's own. Where a
/// law is exchanged, keys that belong to the old one alone (contact.viscous,
/// contact.relaxation_time, contact.stiffness) are left out, and a restitution that the new one
/// needs begins at 0.5 if it is to be fitted; the candidate's note says so. A rig that does not
/// hold otherwise is a failure of the candidate. Throws std::invalid_argument on a key or a law
/// that there is not, and on keys that are no part of a model.
Candidate other_model(const RigFile& own, const std::vector<Override>& overrides,
                      const std::string& label, const std::vector<Override>& changes,
                      const FitOptions& options);

}  // namespace impactrig::fitting
