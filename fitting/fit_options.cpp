// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_options.hpp"

#include <algorithm>

namespace impactrig::fitting {

const ParameterSetting* FitOptions::setting_of(std::string_view name) const {
  const auto found = std::ranges::find(settings, name, &ParameterSetting::name);
  return found == settings.end() ? nullptr : &*found;
}

ParameterSetting& FitOptions::setting(std::string_view name) {
  const auto found = std::ranges::find(settings, name, &ParameterSetting::name);
  if (found != settings.end()) return *found;
  return settings.emplace_back(ParameterSetting{.name = std::string(name)});
}

}  // namespace impactrig::fitting
