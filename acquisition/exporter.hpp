// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

struct OutgoingRecording;
struct SpooledRecording;

/// One format to write: its function in one file of exporters/, one line in exporters.cpp.
struct Exporter {
  std::string_view id;           ///< as the importer's: "uff58b"
  std::string_view description;  ///< one line
  std::string_view endings;      ///< ".uff .bunv"
  /// Returns what of this recording the format has no place for, one sentence each.
  std::vector<std::string> (*write)(const OutgoingRecording& recording, const std::string& path);
};

std::span<const Exporter> exporters();

/// Writes a recording in the format its file name ends in, or in the one `format` names
/// (docs/importing.md says what each keeps). Returns what of marks, calibrations and delays it has
/// no place for, and which names, units and clocks the file, opened again, does not give back, one
/// sentence each. The file appears under its name only when complete; until then
/// it is path.part. Throws datasets::FileError when the file cannot be written, no format has this
/// ending, or the format cannot hold the recording.
std::vector<std::string> export_recording(const datasets::Record& record, const std::string& path,
                                          std::string_view format = {});

/// The same of a recording whose samples lie on the disk; `record` has none. Memory does not grow
/// with the recording.
std::vector<std::string> export_recording(const datasets::Record& record,
                                          const SpooledRecording& samples, const std::string& path,
                                          std::string_view format = {});

}  // namespace impactrig::acquisition
