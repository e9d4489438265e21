// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "acquisition/importers/mat_contents.hpp"

namespace impactrig::acquisition {

/// True for the first bytes of a MAT-file of version 4, which has no signature: a plausible header
/// of 20 bytes and a name.
bool looks_like_mat4(std::string_view head);

/// Lists the arrays of a file of version 4. Throws datasets::InputError.
void read_mat4(MatContents& contents);

}  // namespace impactrig::acquisition
