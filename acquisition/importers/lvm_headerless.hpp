// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "acquisition/importer.hpp"

namespace impactrig::acquisition {

/// Reads a LabVIEW measurement file without a header: a table of numbers, but that columns are
/// counted from 1, as LabVIEW's users do, and end where their values do. `by_blocks`: by way of the
/// disk, in memory that does not grow with the file; its head then has estimates.
std::unique_ptr<RecordingReader> open_lvm_without_header(const std::string& path,
                                                         const ImportOptions& options,
                                                         bool by_blocks);

}  // namespace impactrig::acquisition
