// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/rig_file.hpp"
#include "models/rig.hpp"
#include "models/sensitivities/spot_sensitivity.hpp"

namespace impactrig::fitting {

/// A number of the rig file by which a prediction is differentiated.
struct SensitivityParameter {
  /// A number of the rig that changes with it, and by how much.
  struct Part {
    models::RigParameter of;
    double slope;
  };

  std::string name, unit;  ///< key in the rig file; SI
  double value = 0.0;
  std::vector<Part> parts;  ///< itself, or what it makes: d/d(it) = Σ slope d/d(part)
  /// Whose spot's place it is, which is no number of the rig: parts are none.
  std::optional<models::Laser> spot = {};
};

/// The numbers by which a prediction of the rig is to be differentiated: by the names that a fit
/// frees them under, of stated_parameters(), of what a section's shape and a bar that shears are
/// made of, or of where the lasers point. "all", alone: each that the rig has and that is not zero.
/// Throws std::invalid_argument on an unknown name (and lists the known ones), on one that is named
/// twice, and on a number that the rig has not.
std::vector<SensitivityParameter> sensitivity_parameters(const RigFile& file,
                                                         const std::vector<std::string>& names);

}  // namespace impactrig::fitting
