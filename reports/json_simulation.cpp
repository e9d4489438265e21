// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "reports/json_parts.hpp"

namespace impactrig::reports {

namespace {

/// "model" and what belongs to it. "elements" is empty where the model has none.
void add_solver(Json& json, const models::Solver& solver) {
  json["model"] = std::string(models::name(solver.model));
  json["elements"] = Json::array();
  if (solver.model == models::BeamModel::ancf)
    json["elements"] = {solver.elements[0], solver.elements[1]};
  if (solver.model == models::BeamModel::hybrid) {
    json["modes"] = solver.modes;
    json["axial_modes"] = solver.axial_modes;
    json["basis"] = std::string(models::name(solver.basis));
  }
}

}  // namespace

Json solver_json(const models::Solver& solver) {
  Json json;
  add_solver(json, solver);
  json["accuracy"] = solver.accuracy;
  json["duration_asked_s"] = solver.duration ? Json(*solver.duration) : Json(nullptr);
  return json;
}

models::Solver solver_from(const JsonReader& json) {
  models::Solver solver;
  const std::string model = json["model"].text();
  bool known = false;
  for (const auto candidate :
       {models::BeamModel::rigid, models::BeamModel::hybrid, models::BeamModel::ancf})
    if (model == models::name(candidate)) {
      solver.model = candidate;
      known = true;
    }
  if (!known) json["model"].fail("expected rigid, hybrid or ancf, found \"" + model + "\"");
  if (solver.model == models::BeamModel::ancf) {
    const JsonReader elements = json["elements"];
    if (elements.size() != 2) elements.fail("expected two counts, hinge to contact and to the tip");
    for (std::size_t i = 0; i < 2; ++i)
      solver.elements[i] = static_cast<int>(elements.element(i).integer());
  }
  if (solver.model == models::BeamModel::hybrid) {
    solver.modes = static_cast<int>(json["modes"].integer());
    solver.axial_modes = static_cast<int>(json["axial_modes"].integer());
    const std::string basis = json["basis"].text();
    solver.basis = basis == models::name(models::Basis::cantilever) ? models::Basis::cantilever
                                                                    : models::Basis::pinned_free;
    if (basis != models::name(solver.basis))
      json["basis"].fail("expected cantilever or pinned-free, found \"" + basis + "\"");
  }
  solver.accuracy = json["accuracy"].number();
  if (json.has("duration_asked_s")) solver.duration = json["duration_asked_s"].number();
  return solver;
}

namespace {

Json episode_json(const models::Episode& episode) {
  return {{"start_s", episode.start},
          {"end_s", episode.end},
          {"peak_force_n", episode.peak_force},
          {"impulse_ns", episode.impulse},
          {"max_penetration_m", episode.max_penetration},
          {"approach_velocity_m_s", episode.approach_velocity},
          {"separation_velocity_m_s", episode.separation_velocity},
          {"dissipated_j", episode.dissipated},
          {"peak_time_s", episode.peak_time},
          {"open", episode.open},
          {"stop", episode.stop}};
}

models::Episode episode_from(const JsonReader& json) {
  models::Episode episode;
  episode.start = json["start_s"].number();
  episode.end = json["end_s"].number();
  episode.peak_force = json["peak_force_n"].number();
  episode.impulse = json["impulse_ns"].number();
  episode.max_penetration = json["max_penetration_m"].number();
  episode.approach_velocity = json["approach_velocity_m_s"].number();
  episode.separation_velocity = json["separation_velocity_m_s"].number();
  episode.dissipated = json["dissipated_j"].number();
  episode.peak_time = json["peak_time_s"].number();
  episode.open = json["open"].boolean();
  if (json.has("stop")) episode.stop = static_cast<int>(json["stop"].integer());
  return episode;
}

Json stop_json(const models::StopTotals& stop) {
  return {{"peak_force_n", stop.peak_force},
          {"peak_time_s", stop.peak_time},
          {"max_penetration_m", stop.max_penetration},
          {"impulse_ns", stop.impulse},
          {"dissipated_j", stop.dissipated}};
}

models::StopTotals stop_from(const JsonReader& json) {
  return {.peak_force = json["peak_force_n"].number(),
          .peak_time = json["peak_time_s"].number(),
          .max_penetration = json["max_penetration_m"].number(),
          .impulse = json["impulse_ns"].number(),
          .dissipated = json["dissipated_j"].number()};
}

Json energy_json(const models::EnergyAudit& energy) {
  return {{"initial_j", energy.initial},
          {"dissipated_j", energy.dissipated},
          {"vibration_j", energy.vibration},
          {"imbalance", energy.imbalance},
          {"kinetic_j", energy.kinetic},
          {"elastic_j", energy.elastic},
          {"elastic_at_start_j", energy.elastic_at_start},
          {"gravitational_j", energy.gravitational},
          {"contact_stored_j", energy.contact_stored},
          {"rigid_rotation_j", energy.rigid_rotation},
          {"damped_j", energy.damped},
          {"spring_j", energy.spring},
          {"stop_j", energy.stop},
          {"driven_j", energy.driven}};
}

models::EnergyAudit energy_from(const JsonReader& json) {
  models::EnergyAudit energy;
  energy.initial = json["initial_j"].number();
  energy.dissipated = json["dissipated_j"].number();
  energy.vibration = json["vibration_j"].number();
  energy.imbalance = json["imbalance"].number();
  energy.kinetic = json["kinetic_j"].number();
  energy.elastic = json["elastic_j"].number();
  if (json.has("elastic_at_start_j")) energy.elastic_at_start = json["elastic_at_start_j"].number();
  energy.gravitational = json["gravitational_j"].number();
  energy.contact_stored = json["contact_stored_j"].number();
  energy.rigid_rotation = json["rigid_rotation_j"].number();
  if (json.has("damped_j")) energy.damped = json["damped_j"].number();
  if (json.has("spring_j")) energy.spring = json["spring_j"].number();
  if (json.has("stop_j")) energy.stop = json["stop_j"].number();
  if (json.has("driven_j")) energy.driven = json["driven_j"].number();
  return energy;
}

/// Changes are null where they are unknown, and where the run without it gave no answer.
Json explanation_json(const models::Explanation& explanation) {
  const bool answered = explanation.failure.empty();
  const auto known = [&](double value) {
    return answered && std::isfinite(value) ? Json(value) : Json(nullptr);
  };
  return {{"name", std::string(models::name(explanation.what))},
          {"sentence", explanation.sentence},
          {"change",
           {{"peak_force", known(explanation.peak_force)},
            {"duration", known(explanation.duration)},
            {"impulse", known(explanation.impulse)}}},
          {"solve_s", known(explanation.seconds)},
          {"solve_s_without", known(explanation.seconds_without)},
          {"failure", answered ? Json(nullptr) : Json(explanation.failure)}};
}

}  // namespace

Json simulation_json(const models::Simulation& simulation, const models::Contact& laws) {
  Json json;
  add_solver(json, simulation.solver);
  json["elastic_law"] = laws.law;
  json["damping_law"] = laws.damping;
  json["peak_force_n"] = simulation.peak_force;
  json["peak_time_s"] = simulation.peak_time;
  json["max_penetration_m"] = simulation.max_penetration;
  json["impulse_ns"] = simulation.impulse;
  if (const auto& sensor = simulation.sensor)
    json["sensor"] = {{"peak_force_n", sensor->peak_force},
                      {"peak_time_s", sensor->peak_time},
                      {"peak_known", sensor->peak_known},
                      {"impulse_ns", sensor->impulse}};
  json["episodes"] = Json::array();
  for (const models::Episode& episode : simulation.episodes)
    json["episodes"].push_back(episode_json(episode));
  for (const models::StopTotals& stop : simulation.stops) json["stops"].push_back(stop_json(stop));
  json["restitution"] = {{"law", simulation.restitution.law},
                         {"kinematic", simulation.restitution.kinematic},
                         {"kinetic", simulation.restitution.kinetic},
                         {"energetic", simulation.restitution.energetic}};
  json["energy"] = energy_json(simulation.energy);
  json["cost"] = {{"steps", simulation.cost.steps},
                  {"rejected", simulation.cost.rejected},
                  {"evaluations", simulation.cost.evaluations},
                  {"solve_s", simulation.cost.seconds}};
  if (const auto& error = simulation.mesh_error) {
    json["mesh_error"] = {{"peak_force", error->peak_force},
                          {"duration", error->duration},
                          {"impulse", error->impulse},
                          {"elements", error->finer.elements},
                          {"modes", error->finer.modes}};
    if (error->sensor_peak_force)
      json["mesh_error"]["sensor_peak_force"] = *error->sensor_peak_force;
    if (error->sensor_until) json["mesh_error"]["sensor_until_s"] = *error->sensor_until;
  }
  json["skipped"] = simulation.skipped;
  json["warnings"] = simulation.warnings;
  json["termination"] = simulation.termination;
  json["cut_short"] = simulation.cut_short;
  json["duration_s"] = simulation.duration;
  json["accuracy"] = simulation.solver.accuracy;
  json["duration_asked_s"] =
      simulation.solver.duration ? Json(*simulation.solver.duration) : Json(nullptr);
  return json;
}

models::Simulation simulation_from(const JsonReader& json) {
  models::Simulation simulation;
  simulation.solver = solver_from(json);
  simulation.peak_force = json["peak_force_n"].number();
  simulation.peak_time = json["peak_time_s"].number();
  simulation.max_penetration = json["max_penetration_m"].number();
  simulation.impulse = json["impulse_ns"].number();
  simulation.duration = json["duration_s"].number();
  if (json.has("sensor"))
    simulation.sensor = {.peak_force = json["sensor"]["peak_force_n"].number(),
                         .peak_time = json["sensor"]["peak_time_s"].number(),
                         .impulse = json["sensor"]["impulse_ns"].number(),
                         .peak_known = json["sensor"]["peak_known"].boolean()};
  const JsonReader episodes = json["episodes"];
  for (std::size_t i = 0; i < episodes.size(); ++i)
    simulation.episodes.push_back(episode_from(episodes.element(i)));
  for (std::size_t i = 0; json.has("stops") && i < json["stops"].size(); ++i)
    simulation.stops.push_back(stop_from(json["stops"].element(i)));
  const JsonReader restitution = json["restitution"];
  simulation.restitution = {restitution["law"].number(), restitution["kinematic"].number(),
                            restitution["kinetic"].number(), restitution["energetic"].number()};
  simulation.energy = energy_from(json["energy"]);
  const JsonReader cost = json["cost"];
  simulation.cost = {cost["steps"].integer(), cost["rejected"].integer(),
                     cost["evaluations"].integer(), cost["solve_s"].number()};
  simulation.skipped = json["skipped"].texts();
  simulation.warnings = json["warnings"].texts();
  simulation.termination = json["termination"].text();
  if (json.has("cut_short")) simulation.cut_short = json["cut_short"].boolean();
  return simulation;
}

Json history_json(const models::History& history) {
  Json json = {{"start_s", history.start},         {"interval_s", history.interval},
               {"force_n", history.force},         {"penetration_m", history.penetration},
               {"velocity_m_s", history.velocity}, {"displacement_m", history.displacement}};
  if (!history.sensor_force.empty()) json["sensor_force_n"] = history.sensor_force;
  for (const models::StopHistory& stop : history.further)
    json["further"].push_back({{"force_n", stop.force}, {"penetration_m", stop.penetration}});
  return json;
}

models::History history_from(const JsonReader& json) {
  models::History history;
  history.start = json["start_s"].number();
  history.interval = json["interval_s"].number();
  history.force = json["force_n"].numbers();
  history.penetration = json["penetration_m"].numbers();
  history.velocity = json["velocity_m_s"].numbers();
  history.displacement = json["displacement_m"].numbers();
  if (json.has("sensor_force_n")) history.sensor_force = json["sensor_force_n"].numbers();
  for (std::size_t i = 0; json.has("further") && i < json["further"].size(); ++i)
    history.further.push_back({json["further"].element(i)["force_n"].numbers(),
                               json["further"].element(i)["penetration_m"].numbers()});
  return history;
}

namespace {

/// Derivatives are null where they are not known; then a sentence says why.
Json sensitivity_json(const models::Simulation& simulation, const SensitivityEntry& entry) {
  Json json = {{"parameter", entry.parameter.name},
               {"unit", entry.parameter.unit},
               {"value", entry.parameter.value},
               {"derivative", nullptr},
               {"relative", nullptr},
               {"not_known", nullptr}};
  if (!entry.not_known.empty()) {
    json["not_known"] = entry.not_known;
    return json;
  }
  json["derivative"] = json["relative"] = Json::object();
  for (const Observable& observable : observables(simulation)) {
    json["derivative"][observable.si_key] = observable.slope(entry.slope);
    json["relative"][observable.key] = relative_slope(observable, simulation, entry);
  }
  return json;
}

}  // namespace

std::string simulation_to_json(const models::Simulation& simulation, const models::Rig& rig,
                               const std::optional<std::vector<models::Explanation>>& explanations,
                               const std::vector<SensitivityEntry>& sensitivities) {
  Json json = simulation_json(simulation, rig.contact);
  if (explanations) {
    json["simplifications"] = Json::array();
    for (const models::Explanation& explanation : *explanations)
      json["simplifications"].push_back(explanation_json(explanation));
  }
  for (const SensitivityEntry& entry : sensitivities)
    json["sensitivities"].push_back(sensitivity_json(simulation, entry));
  return dumped(json);
}

}  // namespace impactrig::reports
