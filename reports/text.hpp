// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "reports/report_data.hpp"

namespace impactrig::reports {

/// A fit for the terminal: values with standard errors and intervals, the restitutions, residuals
/// against noise, warnings.
std::string to_text(const ReportData& data);

/// A prediction for the terminal.
std::string to_text(const models::Simulation& simulation, const models::Rig& rig);

}  // namespace impactrig::reports
