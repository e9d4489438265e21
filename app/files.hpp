// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::app {

/// Throws datasets::FileError when `path` exists and `force` is not set, or its folder does not
/// exist: called before the work, so that a bad path fails at once.
void check_output(const std::string& path, bool force);

/// Throws datasets::FileError when an output is one of the inputs, by whatever path or link: no
/// --force is meant for that. Called before the work, and before check_output() proposes --force.
void refuse_inputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// Throws CLI::ValidationError when no format has this ending: before the work as well.
void check_ending(const std::string& path);

/// Writes a recording in the format of its ending and says on stderr what that has no place for.
void export_and_tell(const datasets::Record& record, const std::string& path, bool quiet);

/// Writes a result under its name only when complete (path.part, then renamed); "-" is stdout. A
/// file that exists is replaced only with `force` or when its content is the same. Throws
/// datasets::FileError.
void write_output(const std::string& path, std::string_view content, bool force);

/// Whole content of a file. Throws datasets::FileError.
std::string read_text(const std::string& path);

}  // namespace impactrig::app
