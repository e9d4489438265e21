// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "datasets/impact.hpp"

namespace impactrig::app {

/// What a displacement alone shows of the bar's speeds, for `inspect --json`.
nlohmann::ordered_json rebound_json(const datasets::Rebound& rebound);

/// The same as a line of text, the speed of the approach before it [m/s].
std::string rebound_text(const nlohmann::ordered_json& approach,
                         const nlohmann::ordered_json& rebound);

}  // namespace impactrig::app
