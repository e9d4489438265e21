// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/record.hpp"
#include "fitting/fit.hpp"

namespace impactrig::reports {

/// One input file as a reader needs it to reproduce the result.
struct InputFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// Who made this result from what: the same in every JSON, HDF5 and HTML output.
struct ResultProvenance {
  std::string tool;                      ///< "impactrig"
  std::string version;                   ///< "0.1.0"
  std::string build;                     ///< compiler, build type, library versions
  std::string git;                       ///< commit, "+" when dirty; "" when built without git
  std::vector<std::string> command;      ///< argv
  std::vector<InputFile> inputs;
  std::string config;                    ///< the rig file's text, overrides applied
  std::string config_sha256;
  std::string started;                   ///< ISO 8601 with zone
  double wall_s = 0.0;
  std::string host;
  std::string result_key;                ///< SHA-256 over inputs, resolved configuration, version: equal keys, equal results
};

/// Everything a report says, before any writer turns it into a page.
struct ReportData {
  std::string title;
  fitting::Fit fit;
  std::vector<datasets::Record> records;  ///< conditioned, with provenance and edits; samples may be absent
  ResultProvenance provenance;
};

/// fit --json (docs/../design names), with "curves", "predictions", "records" and "provenance" besides, so that
/// report_from_json(to_json(data)) makes the same report.
std::string to_json(const ReportData& data);
ReportData report_from_json(const std::string& json, const std::string& file_name);

/// One self-contained page: no request leaves it.
std::string to_html(const ReportData& data);

}  // namespace impactrig::reports
