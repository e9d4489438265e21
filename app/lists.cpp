// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "acquisition/importer.hpp"
#include "acquisition/source.hpp"
#include "app/program.hpp"
#include "models/contact/damping_law.hpp"
#include "models/contact/elastic_law.hpp"

namespace impactrig::app {
namespace {

void list_laws() {
  fmt::print("Elastic (contact.law)\n");
  for (const models::ElasticLawEntry& law : models::elastic_laws())
    fmt::print("  {:<22}{}\n  {:<22}{}\n", law.text.name, law.text.description, "",
               law.text.source);
  fmt::print("\nDamping (contact.damping): f = f0 (1 + d v/v_approach)\n");
  for (const models::DampingLaw& law : models::damping_laws())
    fmt::print("  {:<22}{}\n  {:<22}{}\n", law.text.name, law.text.description, "",
               law.text.source);
}

void list_formats() {
  for (const acquisition::Importer& importer : acquisition::importers())
    fmt::print("{:<16}{}\n", importer.id, importer.description);
}

void list_sources() {
  for (const acquisition::SourceDescription& source : acquisition::sources)
    fmt::print("{:<16}{}\n", source.id, source.description);
}

}  // namespace

void add_lists(CLI::App& program) {
  program.add_subcommand("laws", "List the contact laws")->callback(list_laws);
  program.add_subcommand("formats", "List the recording formats")->callback(list_formats);
  program.add_subcommand("sources", "List the sources `acquire` records from")
      ->callback(list_sources);
}

}  // namespace impactrig::app
