// SPDX-License-Identifier: BSD-3-Clause
#include "app/campaign_items.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>

#include "acquisition/importer.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::app {
namespace fs = std::filesystem;

namespace {

std::vector<std::string> recordings_in(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure))
    if (entry.is_regular_file(failure) && acquisition::looks_like_recording(entry.path().string()))
      paths.push_back(entry.path().string());
  if (failure) throw datasets::FileError(folder, "cannot be read: " + failure.message());
  if (paths.empty())
    throw datasets::InputError({.file = folder},
                               "holds no recording of a known format (`impactrig formats`)");
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Appends to the names that several items have.
template <typename Change>
void change_alike(std::vector<CampaignItem>& items, Change change) {
  std::map<std::string, int> count;
  for (const CampaignItem& item : items) ++count[item.name];
  for (CampaignItem& item : items)
    if (count[item.name] > 1) change(item);
}

}  // namespace

void name_items(std::vector<CampaignItem>& items) {
  for (CampaignItem& item : items) item.name = fs::path(item.path).filename().string();
  change_alike(items, [](CampaignItem& item) {
    const std::string folder = fs::absolute(item.path).parent_path().filename().string();
    item.name = folder + "_" + item.name;
  });
  std::set<std::string> taken;
  for (CampaignItem& item : items) {
    std::string name = item.name;
    for (int number = 2; !taken.insert(name).second; ++number)
      name = fmt::format("{}-{}", item.name, number);
    item.name = name;
  }
}

std::vector<CampaignItem> campaign_items(const std::vector<std::string>& named) {
  std::vector<CampaignItem> items;
  std::set<std::string> seen;
  std::error_code ignored;
  for (const std::string& path : named) {
    const std::vector<std::string> paths =
        fs::is_directory(path, ignored) ? recordings_in(path) : std::vector<std::string>{path};
    for (const std::string& recording : paths)
      if (seen.insert(fs::weakly_canonical(recording, ignored).string()).second)
        items.push_back({.path = recording, .name = {}, .sha256 = {}, .key = {}});
  }
  name_items(items);
  return items;
}

}  // namespace impactrig::app
