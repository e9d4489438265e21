// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <string>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/importer.hpp"

namespace impactrig::app {

/// How to read a recording, as typed.
struct ImportArguments {
  std::string format, encoding, delimiter, decimal, time_column, units;
  std::vector<std::string> channels;
  int skip_lines = -1;
  double sample_rate = 0.0;                                ///< [Hz]; 0: the file's
  double from = -std::numeric_limits<double>::infinity();  ///< [s]
  double to = std::numeric_limits<double>::infinity();     ///< [s]
};

void add_import_arguments(CLI::App& command, ImportArguments& arguments);
/// --channel, --from and --to: what of a recording to read.
void add_selection_arguments(CLI::App& command, ImportArguments& arguments);
/// --from and --to alone.
void add_window_arguments(CLI::App& command, ImportArguments& arguments);
acquisition::ImportOptions import_options(const ImportArguments& arguments);

/// How impacts are looked for, as typed.
struct DetectionArguments {
  std::string trigger;
  double threshold = 0.0;    ///< [SI]; 0: from noise and peak
  double pre_trigger = 0.0;  ///< [s]; 0: as find_impacts has it
  double post_trigger = 0.0;
};

/// --trigger, --threshold, --pre-trigger and --post-trigger.
void add_detection_arguments(CLI::App& command, DetectionArguments& arguments);
acquisition::DetectionOptions detection_options(const DetectionArguments& arguments);

}  // namespace impactrig::app
