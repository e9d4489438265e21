// SPDX-License-Identifier: BSD-3-Clause
#include "reports/json_parts.hpp"

namespace impactrig::reports {

namespace {

Json estimate_json(const fitting::DirectEstimate& estimate) {
  Json budget = Json::array();
  for (const fitting::Contribution& part : estimate.budget)
    budget.push_back({{"source", part.source}, {"std_error", part.std_error}});
  Json json = {{"value", estimate.value},
               {"std_error", estimate.std_error},
               {"ci95", pair_json(estimate.ci95)},
               {"budget", budget}};
  if (!estimate.given()) json["absent"] = estimate.absent;
  return json;
}

fitting::DirectEstimate estimate_from(const JsonReader& json) {
  fitting::DirectEstimate estimate;
  estimate.value = json["value"].number();
  estimate.std_error = json["std_error"].number();
  estimate.ci95 = json["ci95"].pair();
  const JsonReader budget = json["budget"];
  for (std::size_t i = 0; i < budget.size(); ++i) {
    const JsonReader part = budget.element(i);
    estimate.budget.push_back({part["source"].text(), part["std_error"].number()});
  }
  if (json.has("absent")) estimate.absent = json["absent"].text();
  return estimate;
}

}  // namespace

Json direct_json(const fitting::DirectRestitution& direct, const std::string& recording) {
  return {{"recording", recording},
          {"kinematic", estimate_json(direct.kinematic)},
          {"kinematic_smoothed", estimate_json(direct.smoothed)},
          {"kinetic", estimate_json(direct.kinetic)},
          {"energetic", estimate_json(direct.energetic)},
          {"touch_s", direct.touch},
          {"deepest_s", direct.deepest},
          {"separation_s", direct.separation},
          {"notes", direct.notes},
          {"hysteresis",
           {{"dissipated_j", estimate_json(direct.hysteresis.dissipated)},
            {"max_penetration_m", estimate_json(direct.hysteresis.max_penetration)},
            {"time_s", direct.hysteresis.time},
            {"penetration_m", direct.hysteresis.penetration},
            {"force_n", direct.hysteresis.force}}}};
}

fitting::DirectRestitution direct_from(const JsonReader& json) {
  fitting::DirectRestitution direct;
  direct.kinematic = estimate_from(json["kinematic"]);
  direct.smoothed = estimate_from(json["kinematic_smoothed"]);
  direct.kinetic = estimate_from(json["kinetic"]);
  direct.energetic = estimate_from(json["energetic"]);
  direct.touch = json["touch_s"].number();
  direct.deepest = json["deepest_s"].number();
  direct.separation = json["separation_s"].number();
  direct.notes = json["notes"].texts();
  const JsonReader loop = json["hysteresis"];
  direct.hysteresis.dissipated = estimate_from(loop["dissipated_j"]);
  direct.hysteresis.max_penetration = estimate_from(loop["max_penetration_m"]);
  direct.hysteresis.time = loop["time_s"].numbers();
  direct.hysteresis.penetration = loop["penetration_m"].numbers();
  direct.hysteresis.force = loop["force_n"].numbers();
  if (direct.hysteresis.time.size() != direct.hysteresis.penetration.size() ||
      direct.hysteresis.time.size() != direct.hysteresis.force.size())
    loop.fail("time_s, penetration_m and force_n must be of one length");
  return direct;
}

}  // namespace impactrig::reports
