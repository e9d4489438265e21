// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "reports/json_reader.hpp"
#include "reports/report_data.hpp"

/// One pair of functions for each value in a report: the JSON of it, and back. What is not finite
/// is written as null and read as NaN.
namespace impactrig::reports {

Json solver_json(const models::Solver& solver);
models::Solver solver_from(const JsonReader& json);
Json simulation_json(const models::Simulation& simulation, const models::Contact& laws);
models::Simulation simulation_from(const JsonReader& json);
Json history_json(const models::History& history);
models::History history_from(const JsonReader& json);

Json rig_json(const fitting::RigFile& rig);
fitting::RigFile rig_from(const JsonReader& json);

Json diagnostics_json(const fitting::ChannelDiagnostics& diagnostics);
fitting::ChannelDiagnostics diagnostics_from(const JsonReader& json);

/// Without speed and restitution of a rebound that is not determined: `absent` says why.
Json rebound_json(const datasets::Rebound& rebound);
Json impact_json(const datasets::Impact& impact);
datasets::Impact impact_from(const JsonReader& json);
Json direct_json(const fitting::DirectRestitution& direct, const std::string& recording);
fitting::DirectRestitution direct_from(const JsonReader& json);
/// `counts`: samples of each channel, for a record that holds none.
Json record_json(const datasets::Record& record, const std::vector<std::size_t>& counts);
datasets::Record record_from(const JsonReader& json, std::vector<std::size_t>& counts);

Json identifiability_json(const fitting::Identifiability& found);
fitting::Identifiability identifiability_from(const JsonReader& json);
Json profile_json(const fitting::Profile& profile);
fitting::Profile profile_from(const JsonReader& json);
Json bootstrap_json(const fitting::Bootstrap& bootstrap);
fitting::Bootstrap bootstrap_from(const JsonReader& json);

Json models_json(const fitting::ModelComparison& models);
fitting::ModelComparison models_from(const JsonReader& json);

Json provenance_json(const ResultProvenance& provenance);
ResultProvenance provenance_from(const JsonReader& json);

/// `json` as text, bytes that are no UTF-8 replaced, in one line.
std::string dumped(const Json& json);

inline Json pair_json(const std::array<double, 2>& pair) {
  return Json::array({pair[0], pair[1]});
}

}  // namespace impactrig::reports
