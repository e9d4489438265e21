// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/tdms_objects.hpp"
#include "acquisition/recording_reader.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What groups and channels of a TDMS file, in the order of their first mention, say becomes a
/// record: names, units, scales, clocks. `record` has the warnings so far. Throws
/// datasets::InputError when the channel of times that the user states is not there.
std::unique_ptr<RecordingReader> tdms_recording(std::unique_ptr<MappedFile> file,
                                                const std::vector<TdmsObject>& objects,
                                                datasets::Record record,
                                                const ImportOptions& options);

}  // namespace impactrig::acquisition
