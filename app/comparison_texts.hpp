// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "acquisition/conditioning/pair_histories.hpp"
#include "fitting/metrics/comparison.hpp"
#include "fitting/metrics/comparison_error.hpp"
#include "fitting/metrics/repeated_shots.hpp"

namespace impactrig::app {

/// A file that took part in a comparison.
struct ComparedFile {
  std::string file, format, channel, unit, sha256;
};

/// What a scalar of the pulse says.
struct ComparedScalar {
  std::string key, title, unit;  ///< "peak_time", "Time of peak", "s"
  double measured = 0.0;         ///< of the first shot
  double predicted = 0.0;
  std::vector<double> shots;  ///< measured ones, repeats included; only with repeats
  double area = 0.0;          ///< area metric between `shots` and the prediction
  fitting::ComparisonUncertainty uncertainty;
  bool has_uncertainty = false;  ///< stated, or from the scatter of repeats
  fitting::ComparisonError validation;

  double error() const { return predicted - measured; }
};

/// What repeats say of the whole history.
struct ComparedRepeats {
  double chi2_per_sample = 0.0;
  fitting::BandCoverage coverage;  ///< of m̄ ± k s
};

/// Everything `impactrig compare` says.
struct ComparisonResult {
  ComparedFile measured, predicted;
  std::vector<ComparedFile> repeats;
  double shift = 0.0;  ///< [s]
  double coverage_factor = 2.0;
  acquisition::PairedHistories pair;
  fitting::Comparison metrics;
  double impulse_ratio = 0.0;
  std::vector<ComparedScalar> scalars;
  ComparedRepeats scatter;
  std::vector<std::string> warnings;
};

/// compare --json; what is not defined is null.
nlohmann::ordered_json to_json(const ComparisonResult& result);

/// For the terminal.
std::string to_text(const ComparisonResult& result);

}  // namespace impactrig::app
