// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/record.hpp"
#include "fitting/fit.hpp"
#include "fitting/model_comparison.hpp"
#include "models/explain.hpp"
#include "reports/sensitivities.hpp"

namespace impactrig::reports {

/// One input file as a reader needs it to reproduce the result.
struct InputFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// Who made this result from what: the same in every JSON, HDF5 and HTML output.
struct ResultProvenance {
  std::string tool;                  ///< "impactrig"
  std::string version;               ///< "0.1.0"
  std::string build;                 ///< compiler, build type, library versions
  std::string git;                   ///< commit, "+" when dirty; "" when built without git
  std::vector<std::string> command;  ///< argv
  std::vector<InputFile> inputs;
  std::string config;  ///< the rig file's text, overrides applied
  std::string config_sha256;
  std::string started;  ///< ISO 8601 with zone
  double wall_s = 0.0;
  std::string host;
  std::string result_key;  ///< SHA-256 over inputs, resolved configuration, version: equal keys,
                           ///< equal results
};

/// Everything a report says, before any writer turns it into a page.
struct ReportData {
  std::string title;
  fitting::Fit fit;
  /// Conditioned, with provenance and edits; samples may be absent.
  std::vector<datasets::Record> records;
  ResultProvenance provenance;
  std::optional<fitting::ModelComparison> models;  ///< of other models, where they were asked for
  /// Samples a channel had, [record][channel], where `records` holds none: after report_from_json.
  std::vector<std::vector<std::size_t>> sample_counts;
};

/// fit --json (names of the design page), then what a report needs besides: "schema"
/// ("impactrig/fit/1"), "curves", "predictions", "records", "rig", "provenance".
/// Doubles survive bit for bit; what is not finite becomes null.
std::string to_json(const ReportData& data);

/// What to_json wrote: to_json(report_from_json(to_json(data), "")) == to_json(data), and both give
/// the same page. Samples of records and of Impact::force, velocity, displacement are not in it.
/// Throws datasets::InputError, which names `file_name` and the place, on a broken or foreign
/// document.
ReportData report_from_json(const std::string& json, const std::string& file_name);

/// simulate --json: one object, without the history. The laws' names come from the rig. With
/// explanations, "simplifications": what each changed and saved. With entries, "sensitivities": of
/// each parameter its derivatives in SI, and relative ones; null where they are not known.
std::string simulation_to_json(
    const models::Simulation& simulation, const models::Rig& rig,
    const std::optional<std::vector<models::Explanation>>& explanations = std::nullopt,
    const std::vector<SensitivityEntry>& sensitivities = {});

/// One self-contained page: no request leaves it.
std::string to_html(const ReportData& data);

}  // namespace impactrig::reports
