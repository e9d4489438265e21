// SPDX-License-Identifier: BSD-3-Clause
#include "app/rebound_texts.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace impactrig::app {

using nlohmann::ordered_json;

std::string rebound_text(const ordered_json& approach, const ordered_json& rebound) {
  const auto of = [&](const char* key) { return rebound[key].get<double>(); };
  const std::string before = fmt::format("approach {:.6g} +- {:.2g} m/s, ", approach.get<double>(),
                                         of("approach_std_error_m_s"));
  if (rebound.contains("absent"))
    return before + "rebound not determined: " + rebound["absent"].get<std::string>();
  return before + fmt::format(
                      "rebound {:.6g} +- {:.2g} m/s (mean from {:.6g} to {:.6g} s), e = {:.4g} "
                      "(95 %: {:.4g} to {:.4g})",
                      of("velocity_m_s"), of("velocity_std_error_m_s"), of("from_s"), of("to_s"),
                      of("restitution"), rebound["restitution_ci95"][0].get<double>(),
                      rebound["restitution_ci95"][1].get<double>());
}

}  // namespace impactrig::app
