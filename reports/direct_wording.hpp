// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "reports/report_data.hpp"

namespace impactrig::reports {

/// A number read from the record directly, beside what the fitted model has.
struct DirectPair {
  const char* name;  ///< "kinetic"
  const char* unit;  ///< SI
  fitting::DirectEstimate direct;
  double fitted;        ///< NaN where the model has none; kinematic: where its force ends
  bool inside() const;  ///< the model's is within the direct 95 % interval
  const fitting::Contribution* main_source() const;  ///< of the uncertainty; null without a budget
};

/// kinematic, smoothed, kinetic, energetic, dissipated energy, greatest penetration of a recording,
/// of a displacement alone speed of approach and mean rebound over it; empty where the fit has no
/// direct reading of it.
std::vector<DirectPair> direct_pairs(const fitting::Fit& fit, std::size_t recording);

/// Where the model's force ends for good in its first contact [s], where that is more than a sample
/// before its surfaces part: a damper that would pull gives no force.
std::optional<double> early_end_of_force(const models::Simulation& run);

/// Whether the model agrees with what was read directly and, where it does not, what an engineer
/// would look at: plain text, several sentences.
std::string direct_explanation(const fitting::Fit& fit, std::size_t recording);

}  // namespace impactrig::reports
