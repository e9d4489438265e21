// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace impactrig::app {

/// What a displacement alone shows of the bar's speeds (reports::rebound_json), in a line; the
/// speed of the approach before it [m/s].
std::string rebound_text(const nlohmann::ordered_json& approach,
                         const nlohmann::ordered_json& rebound);

}  // namespace impactrig::app
