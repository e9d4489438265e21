// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "acquisition/exporter.hpp"
#include "acquisition/importer.hpp"
#include "app/files.hpp"
#include "app/import_options.hpp"
#include "app/program.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::app {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string output;
  ImportArguments reading;
  CommonOptions common;
};

/// Several files become one record with the channels of all, in order; the first one's provenance
/// leads.
void import(const Options& options) {
  check_output(options.output, options.common.force);
  check_ending(options.output);
  datasets::Record record;
  for (const std::string& path : options.files) {
    datasets::Record next = acquisition::import_recording(path, import_options(options.reading));
    if (next.channels.empty())
      throw datasets::InputError(
          {.file = path},
          "there are no recordings in this file; `impactrig inspect` shows what it holds");
    if (record.channels.empty()) {
      record = std::move(next);
      continue;
    }
    record.provenance.edits.push_back({"join recording",
                                       "",
                                       {{"file", path},
                                        {"sha256", next.provenance.sha256},
                                        {"channels", std::to_string(next.channels.size())}}});
    for (datasets::Channel& channel : next.channels) record.channels.push_back(std::move(channel));
    for (std::string& warning : next.warnings) record.warnings.push_back(std::move(warning));
  }
  acquisition::export_recording(record, options.output);
  if (options.common.quiet) return;
  for (const std::string& warning : record.warnings) fmt::print(stderr, "warning: {}\n", warning);
  fmt::print(stderr, "{} channel(s) written to {}\n", record.channels.size(), options.output);
}

}  // namespace

void add_import(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "import", "Convert recordings of any format to our HDF5 (or .uff, .csv)");
  command->add_option("file", options->files, "Recordings")->required();
  command->add_option("-o,--output", options->output, "Result; its ending says the format")
      ->required();
  add_import_arguments(*command, options->reading);
  add_quiet(*command, options->common);
  add_force(*command, options->common);
  command->callback([options] { import(*options); });
}

}  // namespace impactrig::app
