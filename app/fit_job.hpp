// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/import_options.hpp"
#include "app/program.hpp"
#include "reports/report_data.hpp"

namespace impactrig::app {

/// What validate, fit and demo share: recordings and a rig in, a fit with its provenance out.
struct FitJob {
  std::vector<std::string> recordings;
  std::string rig;
  std::string free;                               ///< comma between
  std::string fix, shared, own, log;              ///< names of parameters, comma between
  std::vector<std::string> priors, bounds, ties;  ///< fitting/fit_keys.hpp
  std::string loss;
  std::vector<std::string> against;  ///< KEY=VALUE,VALUE: models to compare
  bool profile = false;
  int bootstrap = 0;
  std::string bootstrap_kind;
  std::optional<std::uint64_t> seed;
  std::string channels;  ///< comma between
  std::string title;
  double window = 0.0;  ///< [s]
  int impact = 1;       ///< which of a recording's impacts, from 1
  ImportArguments reading;
  DetectionArguments detection;
  CommonOptions common;
};

void add_fit_job(CLI::App& command, FitJob& job);

/// The files that are read: recordings and rig.
std::vector<std::string> inputs_of(const FitJob& job);

/// Imports, conditions, finds the impact of each recording, and fits. Throws what those throw;
/// datasets::InputError when a recording holds no impact.
reports::ReportData run_fit_job(const FitJob& job);

/// Of a run that begins now: program, command, host, and the rig file with its overrides. Throws
/// what reading the rig file and the options throws, so that a bad one fails before the work.
reports::ResultProvenance provenance_of(const FitJob& job);

/// SHA-256 over all that decides the numbers: content of the recordings, resolved rig file,
/// options, version. Equal keys, equal results.
std::string result_key(const FitJob& job, const std::string& config_sha256,
                       const std::vector<std::string>& inputs_sha256);

}  // namespace impactrig::app
