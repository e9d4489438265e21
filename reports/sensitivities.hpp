// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fitting/sensitivity_parameters.hpp"
#include "models/simulation.hpp"

namespace impactrig::reports {

/// How a prediction changes with one number of its rig.
struct SensitivityEntry {
  fitting::SensitivityParameter parameter;
  std::string not_known;      ///< why there are no derivatives; empty: there are
  models::Sensitivity slope;  ///< in SI, for its unit
};

/// A number that a prediction shows of the first contact.
struct Observable {
  const char* head;    ///< of a column
  const char* unit;    ///< SI, "1" when dimensionless
  const char* key;     ///< in JSON, without the unit
  const char* si_key;  ///< in JSON, with it
  double (*value)(const models::Simulation& simulation);
  double (*slope)(const models::Sensitivity& sensitivity);
};

/// Those that the rig has: of a bar without a stop none.
std::vector<Observable> observables(const models::Simulation& simulation);

/// Whether what is known of it, histories too, is zero but for rounding.
bool changes_nothing(const models::Simulation& simulation, const SensitivityEntry& entry);

/// d ln y / d ln p: percent of y a percent of the parameter; NaN where one of the two is zero or
/// not known.
double relative_slope(const Observable& observable, const models::Simulation& simulation,
                      const SensitivityEntry& entry);

/// For the terminal: relative derivatives, then those in SI, a line a parameter; what is not known
/// in sentences.
std::string sensitivities_text(const models::Simulation& simulation,
                               const std::vector<SensitivityEntry>& entries);

}  // namespace impactrig::reports
