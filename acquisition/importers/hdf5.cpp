// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/formats.hpp"
#include "datasets/store.hpp"

namespace impactrig::acquisition {

int recognises_hdf5(std::string_view, std::string_view head) {
  if (!datasets::looks_like_hdf5(head)) return 0;
  // an attribute of the root, which is the first object of the file
  return head.find("impactrig-recording") != std::string_view::npos ? 100 : 50;
}

datasets::Record read_hdf5(const std::string& path, const ImportOptions&) {
  datasets::Record record = datasets::read_record(path);
  // the provenance will name this file; where the record first came from stays with it
  const datasets::Provenance& origin = record.provenance;
  if (!origin.source_file.empty()) record.attributes.emplace("origin file", origin.source_file);
  if (!origin.sha256.empty()) record.attributes.emplace("origin sha256", origin.sha256);
  if (!origin.importer.empty()) record.attributes.emplace("origin format", origin.importer);
  if (!origin.program.empty()) record.attributes.emplace("origin program", origin.program);
  record.provenance.importer.clear();
  return record;
}

}  // namespace impactrig::acquisition
