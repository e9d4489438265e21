// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <string>
#include <vector>

#include "acquisition/importer.hpp"

namespace impactrig::app {

/// How to read a recording, as typed.
struct ImportArguments {
  std::string format, delimiter, decimal, time_column, units;
  std::vector<std::string> channels;
  int skip_lines = -1;
  double sample_rate = 0.0;
  double from = -std::numeric_limits<double>::infinity();  ///< [s]
  double to = std::numeric_limits<double>::infinity();     ///< [s]
};

void add_import_arguments(CLI::App& command, ImportArguments& arguments);
/// --channel, --from and --to: what of a recording to read.
void add_selection_arguments(CLI::App& command, ImportArguments& arguments);
acquisition::ImportOptions import_options(const ImportArguments& arguments);

}  // namespace impactrig::app
