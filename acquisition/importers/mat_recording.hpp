// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "acquisition/importers/mat_contents.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// True for what our own exporter wrote, saved again by MATLAB or not: a structure `recording` that
/// says so.
bool is_mat_recording(const MatContents& contents);

/// Each structure beside it that has a start, an interval and values is a channel; `units` are what
/// the user states. docs/formats.md has the layout. Throws datasets::InputError when there are more
/// units than channels.
std::unique_ptr<RecordingReader> reader_of_mat_recording(MatContents contents,
                                                         const std::vector<std::string>& units);

}  // namespace impactrig::acquisition
