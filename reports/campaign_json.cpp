// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "reports/campaign.hpp"
#include "reports/json_parts.hpp"

namespace impactrig::reports {
namespace {

Json shot_json(const CampaignShot& shot) {
  Json numbers = Json::object();
  for (const ShotNumber& number : shot.numbers) {
    const bool known = std::isfinite(number.std_error) && number.std_error > 0.0;
    numbers[number.name] = {{"value", number.value},
                            {"unit", number.unit},
                            {"std_error", known ? Json(number.std_error) : Json(nullptr)},
                            {"ci95", known ? pair_json(number.ci95) : Json(nullptr)}};
  }
  return {{"file", shot.file},
          {"result", "fits/" + shot.name + ".json"},
          {"report", shot.has_report ? Json("reports/" + shot.name + ".html") : Json(nullptr)},
          {"word", word(shot)},
          {"verdict", shot.verdict.headline},
          {"converged", shot.converged},
          {"flags", shot.flags},
          {"reduced_chi2", shot.reduced_chi2},
          {"peak_force_n", shot.peak_force},
          {"approach_speed_m_s", shot.approach_speed},
          {"numbers", numbers},
          {"result_key", shot.result_key}};
}

Json trend_json(const CampaignQuantity& quantity) {
  if (!quantity.trend) return nullptr;
  const fitting::SpeedTrend& trend = *quantity.trend;
  return {{"slope_per_m_s", trend.slope},
          {"std_error", trend.std_error},
          {"ci95", pair_json(trend.ci95)},
          {"p_value", trend.p_value},
          {"mean_speed_m_s", trend.mean_speed},
          {"at_mean_speed", trend.at_mean_speed},
          {"between_shots", trend.tau},
          {"q", trend.q},
          {"dof", trend.dof},
          {"sentence", quantity.trend_sentence}};
}

Json quantity_json(const Campaign& campaign, const CampaignQuantity& quantity) {
  const fitting::BetweenShots& b = quantity.between;
  Json outliers = Json::array(), left_out = Json::array();
  for (std::size_t i = 0; i < b.deviations.size(); ++i)
    if (b.deviations[i].outlier)
      outliers.push_back({{"file", campaign.shots[quantity.shots[i]].file},
                          {"residual", b.deviations[i].residual},
                          {"p_value", b.deviations[i].p_value}});
  for (const std::size_t i : quantity.left_out) left_out.push_back(campaign.shots[i].file);
  return {{"name", quantity.name},
          {"unit", quantity.unit},
          {"shots", b.shots},
          {"mean", b.mean},
          {"std_error", b.std_error},
          {"ci95", pair_json(quantity.ci95)},
          {"mesh_shift", quantity.mesh_shift},
          {"between_shots", b.tau},
          {"between_shots_ci95", pair_json(b.tau_ci95)},
          {"q", b.q},
          {"dof", b.dof},
          {"p_value", b.p_value},
          {"i2", b.i2},
          {"scatter", b.scatter},
          {"sentence", quantity.sentence},
          {"outliers", outliers},
          {"left_out", left_out},
          {"trend", trend_json(quantity)}};
}

Json failures_json(const std::vector<CampaignFailure>& failures) {
  Json list = Json::array();
  for (const CampaignFailure& failure : failures)
    list.push_back({{"file", failure.file}, {"sentence", failure.sentence}});
  return list;
}

std::string document(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string to_json(const Campaign& campaign) {
  Json json;
  json["schema"] = "impactrig/campaign/1";
  json["title"] = campaign.title;
  json["quantities"] = Json::array();
  for (const CampaignQuantity& quantity : campaign.quantities)
    json["quantities"].push_back(quantity_json(campaign, quantity));
  json["not_compared"] = campaign.not_compared;
  json["shots"] = Json::array();
  for (const CampaignShot& shot : campaign.shots) json["shots"].push_back(shot_json(shot));
  json["failed"] = failures_json(campaign.failed);
  json["left_out"] = failures_json(campaign.left_out);
  json["provenance"] = provenance_json(campaign.provenance);
  return document(json);
}

std::string failed_json(const Campaign& campaign) {
  return document({{"schema", "impactrig/failed/1"}, {"failed", failures_json(campaign.failed)}});
}

}  // namespace impactrig::reports
