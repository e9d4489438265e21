// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "reports/campaign.hpp"

namespace impactrig::reports {

/// "The shots scatter 2.3 times as much as each interval says: the restitution itself varies by
/// 0.0040 from shot to shot (95 %: 0.0031 to 0.0057), 0.8 % of it." `between` is already in.
std::string between_sentence(const CampaignQuantity& quantity);

/// "It falls by 0.12 ± 0.03 a m/s ..."; "" without a trend. `trend` is already in.
std::string trend_sentence(const CampaignQuantity& quantity);

/// "0.5012 ± 0.0011 (95 %: 0.4990 to 0.5034)", with its unit.
std::string mean_text(const CampaignQuantity& quantity);

/// That the mesh is coarser than the mean is good; "" where it is not.
std::string mesh_sentence(const CampaignQuantity& quantity);

/// "0.0040 (95 %: 0.0031 to 0.0057)", with its unit; "none seen" where the shots agree so well that
/// no τ would have let them.
std::string tau_text(const CampaignQuantity& quantity);

/// File names of the shots that stand out, comma between; "" for none.
std::string outlier_names(const Campaign& campaign, const CampaignQuantity& quantity);

/// "38 of 40 recordings fitted: 30 pass, 6 warn, 2 fail; 2 failed".
std::string count_sentence(const Campaign& campaign);

}  // namespace impactrig::reports
