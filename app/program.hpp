// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace impactrig::app {

/// Exit codes; scripts depend on them.
enum ExitCode {
  done = 0,
  internal_error = 1,
  wrong_usage = 2,
  invalid_input = 3,  ///< a configuration or a recording says something it may not
  file_error = 4,     ///< cannot read or write; try again when mended
  some_failed = 5,    ///< some of many items; the others are complete
  gate_failed = 6,    ///< computed, but not converged
};

/// Options every subcommand has.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  bool force = false;
  std::vector<std::string> overrides;  ///< --set key=value
};

/// Of an option: a number greater than zero (CLI11's own says so by a range of 300 digits).
inline const CLI::Validator positive(
    [](const std::string& text) {
      double value = 0.0;
      return CLI::detail::lexical_cast(text, value) && value > 0.0 && std::isfinite(value)
                 ? std::string()
                 : "expected a number greater than zero, found " + text;
    },
    "POSITIVE");

/// Ends the program with a code after everything was written; not an error of the program.
struct Exit {
  int code;
};

void add_quiet(CLI::App& command, CommonOptions& options);
void add_json(CLI::App& command, CommonOptions& options);
void add_set(CLI::App& command, CommonOptions& options);
void add_force(CLI::App& command, CommonOptions& options);

/// --set values as key and value. Throws CLI::ValidationError without '='.
std::vector<std::pair<std::string, std::string>> split_overrides(
    const std::vector<std::string>& overrides);

/// The names of a list with commas, without blanks around them.
std::vector<std::string> split_names(const std::string& text);

/// The command line as it was typed, for provenance; set once by main().
const std::vector<std::string>& command_line();
void set_command_line(int argc, char** argv);

void add_acquire(CLI::App& program);
void add_campaign(CLI::App& program);
void add_compare(CLI::App& program);
void add_demo(CLI::App& program);
void add_fit(CLI::App& program);
void add_import(CLI::App& program);
void add_inspect(CLI::App& program);
void add_laws(CLI::App& program);
void add_lists(CLI::App& program);  ///< formats, sources
void add_report(CLI::App& program);
void add_simulate(CLI::App& program);
void add_validate(CLI::App& program);

}  // namespace impactrig::app
