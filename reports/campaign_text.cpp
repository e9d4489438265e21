// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "reports/campaign.hpp"
#include "reports/campaign_wording.hpp"

namespace impactrig::reports {

std::string to_text(const Campaign& campaign) {
  std::string out = count_sentence(campaign) + "\n";
  for (const CampaignQuantity& quantity : campaign.quantities) {
    out += fmt::format("{}\n  mean of {} shots    {}\n  from shot to shot  {}\n  {}\n",
                       quantity.name, quantity.between.shots, mean_text(quantity),
                       tau_text(quantity), quantity.sentence);
    if (const std::string mesh = mesh_sentence(quantity); !mesh.empty()) out += "  " + mesh + "\n";
    if (const std::string names = outlier_names(campaign, quantity); !names.empty())
      out += "  Stands out: " + names + ".\n";
    if (!quantity.trend_sentence.empty()) out += "  " + quantity.trend_sentence + "\n";
  }
  for (const std::string& sentence : campaign.not_compared) out += sentence + "\n";
  for (const CampaignShot& shot : campaign.shots)
    if (word(shot) == "fail")
      out += fmt::format("fail: {}: {}\n", shot.file, shot.verdict.headline);
  for (const CampaignFailure& failure : campaign.failed)
    out += fmt::format("failed: {}: {}\n", failure.file, failure.sentence);
  for (const CampaignFailure& failure : campaign.left_out)
    out += fmt::format("left out: {}: {}\n", failure.file, failure.sentence);
  return out;
}

}  // namespace impactrig::reports
