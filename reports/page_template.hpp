// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace impactrig::reports {

/// Replaces each {{name}} of the template, once, left to right; what is put in is not looked at
/// again.
std::string filled(std::string_view page,
                   const std::vector<std::pair<std::string_view, std::string>>& parts);

/// JSON that may stand in a <script> element: no </script>, no <!-- in it.
std::string script_safe(const std::string& json);

}  // namespace impactrig::reports
