// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "reports/campaign.hpp"

namespace impactrig::reports {

/// Section of the campaign's page: one row a recording, sorted by a click on a head.
std::string html_shots(const Campaign& campaign);

}  // namespace impactrig::reports
