// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "reports/campaign.hpp"

namespace impactrig::reports {

/// SVG of one quantity: every shot's value with its 95 % interval in the order of the recordings,
/// and the band of the mean.
std::string svg_shots(const Campaign& campaign, const CampaignQuantity& quantity);

/// SVG of restitution against approach speed, fitted and direct below each other, with the trend;
/// "" where no shot has both.
std::string svg_speeds(const Campaign& campaign);

}  // namespace impactrig::reports
