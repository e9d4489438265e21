// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "acquisition/importer.hpp"
#include "tests/acquisition/sigrok_bytes.hpp"
#include "tests/acquisition/tdm_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition::tests {

/// Imports a description whose samples, "shot.tdx" in its words, lie beside it under its own name;
/// a missing clock is a warning, and the warning that the name is another is left out.
inline datasets::Record imported_shot(const std::string& description, const std::string& samples,
                                      ImportOptions options = {}) {
  const WrittenFile beside(samples, ".tdx");
  options.require_clock = false;
  const WrittenFile file(description, ".tdm");
  datasets::Record record = import_recording(file.path(), options);
  std::erase_if(record.warnings, [](const std::string& warning) {
    return warning.starts_with("the description names its samples 'shot.tdx'");
  });
  return record;
}

/// What importing it throws, with the description's name as FILE.
inline std::string shot_error(const std::string& description, const std::string& samples) {
  const WrittenFile beside(samples, ".tdx");
  return import_error(description, {}, ".tdm");
}

}  // namespace impactrig::acquisition::tests
