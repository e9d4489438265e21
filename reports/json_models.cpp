// SPDX-License-Identifier: BSD-3-Clause
#include "reports/json_parts.hpp"

namespace impactrig::reports {

Json models_json(const fitting::ModelComparison& models) {
  Json scores = Json::array();
  for (const fitting::ModelScore& s : models.scores) {
    const auto given = [&](const auto& value) {
      return s.failure.empty() ? Json(value) : Json(nullptr);
    };
    scores.push_back(
        {{"label", s.label},
         {"note", s.note.empty() ? Json(nullptr) : Json(s.note)},
         {"failure", s.failure.empty() ? Json(nullptr) : Json(s.failure)},
         {"chi2", given(s.chi2)},
         {"dof", given(s.dof)},
         {"unknowns", given(s.unknowns)},
         {"aicc", given(s.aicc)},
         {"bic", given(s.bic)},
         {"delta", given(s.delta)},
         {"weight", given(s.weight)},
         {"sound", given(s.sound)},
         {"sentence", given(s.sentence)},
         {"held_out", s.held_out ? Json{{"chi2", s.held_out->chi2}, {"dof", s.held_out->dof}}
                                 : Json(nullptr)}});
  }
  return {{"inflation", models.inflation}, {"sentence", models.sentence}, {"scores", scores}};
}

fitting::ModelComparison models_from(const JsonReader& json) {
  fitting::ModelComparison models;
  models.inflation = json["inflation"].number();
  models.sentence = json["sentence"].text();
  const JsonReader scores = json["scores"];
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const JsonReader from = scores.element(i);
    fitting::ModelScore s;
    s.label = from["label"].text();
    if (from.has("note")) s.note = from["note"].text();
    if (from.has("failure")) {
      s.failure = from["failure"].text();
      models.scores.push_back(std::move(s));
      continue;
    }
    s.chi2 = from["chi2"].number();
    s.dof = from["dof"].integer();
    s.unknowns = static_cast<int>(from["unknowns"].integer());
    s.aicc = from["aicc"].number();
    s.bic = from["bic"].number();
    s.delta = from["delta"].number();
    s.weight = from["weight"].number();
    s.sound = from["sound"].boolean();
    s.sentence = from["sentence"].text();
    if (from.has("held_out"))
      s.held_out = {from["held_out"]["chi2"].number(), from["held_out"]["dof"].integer()};
    models.scores.push_back(std::move(s));
  }
  return models;
}

}  // namespace impactrig::reports
