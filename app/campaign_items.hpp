// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace impactrig::app {

/// One recording of a campaign.
struct CampaignItem {
  std::string path;
  std::string name;  ///< of its result, without ending: unlike all others of the campaign
  std::string sha256;
  std::string key;  ///< of its result
};

/// Files as they are named, folders as the recordings in them, sorted by name; each once. Throws
/// datasets::InputError for a folder without recordings.
std::vector<CampaignItem> campaign_items(const std::vector<std::string>& named);

/// File names; where files of one name come from several folders, with the folder's name before,
/// and a number after what is still alike.
void name_items(std::vector<CampaignItem>& items);

}  // namespace impactrig::app
