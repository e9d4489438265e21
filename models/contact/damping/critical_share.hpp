// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

namespace impactrig::models {

/// ζ of a linear spring and dashpot that rebounds with e when it may pull.
inline double critical_share(double e) {
  const double log_e = std::log(e);
  return -log_e / std::sqrt(std::numbers::pi * std::numbers::pi + log_e * log_e);
}

}  // namespace impactrig::models
