// SPDX-License-Identifier: BSD-3-Clause
#include "app/campaign_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace impactrig::app {
namespace {

struct Word {
  PlannedItem::What what;
  const char* word;
  const char* of_many;
};

using What = PlannedItem::What;
constexpr Word words[] = {
    {What::reuse, "reuse", "results reused"},
    {What::fit, "fit", "to fit"},
    {What::replace, "replace", "to fit anew, replacing results of other options or recordings"},
    {What::refuse, "refuse",
     "whose results are of other options or recordings: --force would make them anew, without it "
     "nothing is done"},
    {What::leave_out, "leave out", "left out"},
    {What::fail, "fail", "that cannot be read"}};

const char* word_of(What what) {
  return std::ranges::find(words, what, &Word::what)->word;
}

}  // namespace

std::string plan_text(const std::vector<PlannedItem>& plan) {
  std::string text;
  for (const PlannedItem& item : plan)
    text += fmt::format("{:<10} {}   {}\n", word_of(item.what), item.file, item.why);
  text += fmt::format("{} recordings:", plan.size());
  bool first = true;
  for (const Word& word : words) {
    const auto count = std::ranges::count(plan, word.what, &PlannedItem::what);
    if (count == 0) continue;
    text += fmt::format("{} {} {}", first ? "" : ",", count, word.of_many);
    first = false;
  }
  return text + "\n";
}

std::string plan_json(const std::vector<PlannedItem>& plan) {
  nlohmann::ordered_json json;
  json["schema"] = "impactrig/campaign-plan/1";
  json["recordings"] = nlohmann::ordered_json::array();
  for (const PlannedItem& item : plan) {
    const bool sentence = item.what == What::leave_out || item.what == What::fail;
    json["recordings"].push_back({{"file", item.file},
                                  {"action", word_of(item.what)},
                                  {sentence ? "sentence" : "result", item.why}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace impactrig::app
