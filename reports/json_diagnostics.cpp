// SPDX-License-Identifier: BSD-3-Clause
#include "reports/json_parts.hpp"

namespace impactrig::reports {

namespace {

using fitting::ChannelDiagnostics;

Json level_json(const fitting::PhaseLevel& level) {
  return {{"phase", level.phase},     {"samples", level.samples},
          {"rms", level.rms},         {"ratio", level.ratio},
          {"p_value", level.p_value}, {"concentration", level.concentration}};
}

fitting::PhaseLevel level_from(const JsonReader& json) {
  return {
      json["phase"].text(),     json["samples"].integer(),
      json["rms"].number(),     json["ratio"].number(),
      json["p_value"].number(), json.has("concentration") ? json["concentration"].number() : 0.0};
}

Json structure_json(const fitting::Structure& structure) {
  Json json = {{"kind", structure.kind},           {"amount", structure.amount},
               {"std_error", structure.std_error}, {"unit", structure.unit},
               {"share", structure.share},         {"p_value", structure.p_value}};
  if (structure.kind == "vibration") {
    json["frequency_hz"] = structure.frequency;
    json["model_amplitude"] = structure.model_amplitude;
  }
  return json;
}

fitting::Structure structure_from(const JsonReader& json) {
  fitting::Structure out;
  out.kind = json["kind"].text();
  out.amount = json["amount"].number();
  out.std_error = json["std_error"].number();
  out.unit = json["unit"].text();
  out.share = json["share"].number();
  out.p_value = json["p_value"].number();
  if (out.kind == "vibration") {
    out.frequency = json["frequency_hz"].number();
    out.model_amplitude = json["model_amplitude"].number();
  }
  return out;
}

Json whiteness_json(const fitting::Whiteness& whiteness) {
  return {{"lag1", whiteness.lag1},
          {"p_value", whiteness.p_value},
          {"band95", whiteness.band},
          {"autocorrelation", whiteness.autocorrelation},
          {"before_touch", whiteness.before}};
}

fitting::Whiteness whiteness_from(const JsonReader& json) {
  return {json["lag1"].number(), json["p_value"].number(), json["band95"].number(),
          json["autocorrelation"].numbers(), json["before_touch"].numbers()};
}

Json normality_json(const fitting::Normality& normality) {
  return {{"anderson_darling", normality.statistic},
          {"p_value", normality.p_value},
          {"skewness", normality.skewness},
          {"excess_kurtosis", normality.excess_kurtosis},
          {"words", normality.words},
          {"quantiles", normality.quantiles}};
}

fitting::Normality normality_from(const JsonReader& json) {
  return {json["anderson_darling"].number(), json["p_value"].number(), json["skewness"].number(),
          json["excess_kurtosis"].number(),  json["words"].text(),     json["quantiles"].numbers()};
}

Json discrepancy_json(const fitting::Discrepancy& discrepancy) {
  return {{"significant", discrepancy.significant},
          {"p_value", discrepancy.p_value},
          {"length_s", discrepancy.length},
          {"rms", discrepancy.rms},
          {"largest", discrepancy.largest},
          {"largest_std_error", discrepancy.largest_error},
          {"largest_time_s", discrepancy.largest_time},
          {"time_s", discrepancy.time},
          {"mean", discrepancy.mean},
          {"std_error", discrepancy.error}};
}

fitting::Discrepancy discrepancy_from(const JsonReader& json) {
  fitting::Discrepancy out;
  out.significant = json["significant"].boolean();
  out.p_value = json["p_value"].number();
  out.length = json["length_s"].number();
  out.rms = json["rms"].number();
  out.largest = json["largest"].number();
  out.largest_error = json["largest_std_error"].number();
  out.largest_time = json["largest_time_s"].number();
  out.time = json["time_s"].numbers();
  out.mean = json["mean"].numbers();
  out.error = json["std_error"].numbers();
  if (out.mean.size() != out.time.size() || out.error.size() != out.time.size())
    json.fail("time_s, mean and std_error must be of one length");
  return out;
}

}  // namespace

Json diagnostics_json(const ChannelDiagnostics& diagnostics) {
  Json json = {{"judged", diagnostics.judged},
               {"sound", diagnostics.sound},
               {"level", diagnostics.level},
               {"p_value", diagnostics.p_value},
               {"noise", diagnostics.noise},
               {"noise_correlation", diagnostics.noise_correlation},
               {"noise_samples", diagnostics.noise_samples},
               {"coarse", diagnostics.coarse}};
  json["phases"] = Json::array();
  for (const fitting::PhaseLevel& level : diagnostics.phases)
    json["phases"].push_back(level_json(level));
  json["whiteness"] = whiteness_json(diagnostics.whiteness);
  json["normality"] = normality_json(diagnostics.normality);
  json["longest_run"] = {{"samples", diagnostics.run.samples},
                         {"from_s", diagnostics.run.from},
                         {"to_s", diagnostics.run.to},
                         {"p_value", diagnostics.run.p_value}};
  json["structures"] = Json::array();
  for (const fitting::Structure& structure : diagnostics.structures)
    json["structures"].push_back(structure_json(structure));
  json["discrepancy"] = discrepancy_json(diagnostics.discrepancy);
  json["sentence"] = diagnostics.sentence;
  return json;
}

ChannelDiagnostics diagnostics_from(const JsonReader& json) {
  ChannelDiagnostics out;
  out.judged = json["judged"].boolean();
  out.sound = json["sound"].boolean();
  out.level = json["level"].number();
  out.p_value = json["p_value"].number();
  out.noise = json["noise"].number();
  out.noise_correlation = json["noise_correlation"].number();
  out.noise_samples = json["noise_samples"].integer();
  out.coarse = json["coarse"].boolean();
  const JsonReader phases = json["phases"], structures = json["structures"];
  for (std::size_t i = 0; i < phases.size(); ++i)
    out.phases.push_back(level_from(phases.element(i)));
  out.whiteness = whiteness_from(json["whiteness"]);
  out.normality = normality_from(json["normality"]);
  const JsonReader run = json["longest_run"];
  out.run = {run["samples"].integer(), run["from_s"].number(), run["to_s"].number(),
             run["p_value"].number()};
  for (std::size_t i = 0; i < structures.size(); ++i)
    out.structures.push_back(structure_from(structures.element(i)));
  out.discrepancy = discrepancy_from(json["discrepancy"]);
  out.sentence = json["sentence"].text();
  return out;
}

}  // namespace impactrig::reports
