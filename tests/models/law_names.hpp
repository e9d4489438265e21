// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace impactrig::tests {

/// The names of a table of laws as messages list them: a new law changes no test.
template <typename Laws>
std::string names_of(const Laws& laws) {
  std::string names;
  for (const auto& law : laws) names += (names.empty() ? "" : ", ") + std::string(law.text.name);
  return names;
}

}  // namespace impactrig::tests
