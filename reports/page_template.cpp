// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page_template.hpp"

namespace impactrig::reports {

std::string filled(std::string_view page,
                   const std::vector<std::pair<std::string_view, std::string>>& parts) {
  std::string out;
  while (true) {
    const std::size_t open = page.find("{{"), close = page.find("}}", open);
    out += page.substr(0, open);
    if (open == std::string_view::npos || close == std::string_view::npos) return out;
    const std::string_view name = page.substr(open + 2, close - open - 2);
    for (const auto& [key, value] : parts)
      if (key == name) out += value;
    page.remove_prefix(close + 2);
  }
}

std::string script_safe(const std::string& json) {
  std::string out;
  for (const char c : json) {
    if (c == '<')  // in JSON only within strings
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

}  // namespace impactrig::reports
