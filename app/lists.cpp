// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "acquisition/exporter.hpp"
#include "acquisition/importer.hpp"
#include "acquisition/source.hpp"
#include "app/program.hpp"

namespace impactrig::app {
namespace {

void list_formats() {
  for (const acquisition::Importer& importer : acquisition::importers())
    fmt::print("{:<16}{}\n", importer.id, importer.description);
  fmt::print("\nwritten, by the ending of -o:\n");
  for (const acquisition::Exporter& exporter : acquisition::exporters())
    fmt::print("{:<16}{} ({})\n", exporter.id, exporter.description, exporter.endings);
}

void list_sources() {
  for (const acquisition::SourceDescription& source : acquisition::sources)
    fmt::print("{:<16}{}\n", source.id, source.description);
}

}  // namespace

void add_lists(CLI::App& program) {
  program.add_subcommand("formats", "List the recording formats")->callback(list_formats);
  program.add_subcommand("sources", "List the sources `acquire` records from")
      ->callback(list_sources);
}

}  // namespace impactrig::app
