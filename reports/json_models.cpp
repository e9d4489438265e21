// SPDX-License-Identifier: BSD-3-Clause
#include "reports/json_parts.hpp"

namespace impactrig::reports {

Json models_json(const fitting::ModelComparison& models) {
  Json scores = Json::array();
  for (const fitting::ModelScore& s : models.scores)
    scores.push_back(
        {{"label", s.label},
         {"failure", s.failure.empty() ? Json(nullptr) : Json(s.failure)},
         {"chi2", s.chi2},
         {"dof", s.dof},
         {"unknowns", s.unknowns},
         {"aicc", s.aicc},
         {"bic", s.bic},
         {"delta", s.delta},
         {"weight", s.weight},
         {"sound", s.sound},
         {"sentence", s.sentence},
         {"held_out", s.held_out ? Json{{"chi2", s.held_out->chi2}, {"dof", s.held_out->dof}}
                                 : Json(nullptr)}});
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
    if (from.has("failure")) s.failure = from["failure"].text();
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
