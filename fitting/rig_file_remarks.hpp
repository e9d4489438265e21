// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "fitting/rig_file.hpp"

namespace impactrig::fitting {

/// A sentence for each number that a rig file states in vain, or twice. Such a file is read all the
/// same: laws and models may be exchanged by overrides.
std::vector<std::string> remarks_on(const toml::table& document, const RigFile& file);

}  // namespace impactrig::fitting
