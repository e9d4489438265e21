// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/importers/mat_contents.hpp"

namespace impactrig::acquisition {

/// Lists the arrays of a file of version 5, which begins with a header of 128 bytes. Throws
/// datasets::InputError.
void read_mat5(MatContents& contents);

}  // namespace impactrig::acquisition
