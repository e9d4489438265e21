// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include "acquisition/importer.hpp"

namespace impactrig::app {

/// How to read a recording, as typed.
struct ImportArguments {
  std::string format, delimiter, decimal, time_column, units;
  int skip_lines = -1;
  double sample_rate = 0.0;
};

void add_import_arguments(CLI::App& command, ImportArguments& arguments);
acquisition::ImportOptions import_options(const ImportArguments& arguments);

}  // namespace impactrig::app
