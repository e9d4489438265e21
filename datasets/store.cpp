// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/store.hpp"

#include "datasets/store_layout.hpp"

namespace impactrig::datasets {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view nul = "\0"sv;
constexpr std::string_view escaped_nul = "\xc0\x80"sv;

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string result;
  for (std::size_t at = text.find(from); at != std::string_view::npos; at = text.find(from)) {
    result += text.substr(0, at);
    result += to;
    text.remove_prefix(at + from.size());
  }
  return result.append(text);
}

}  // namespace

std::string layout::with_nul_escaped(std::string_view text) {
  return replaced(text, nul, escaped_nul);
}

std::string layout::with_nul_restored(std::string_view text) {
  return replaced(text, escaped_nul, nul);
}

std::uint64_t layout::declared_end(std::string_view head) {
  if (head.size() < 48) return 0;
  const bool old = head[8] == 0;
  const bool known = old || head[8] == 2 || head[8] == 3;
  if (!known || head[old ? 13 : 9] != 8) return 0;
  std::uint64_t end = 0;
  for (std::size_t i = 8; i-- > 0;)
    end = end << 8 | static_cast<unsigned char>(head[(old ? 40 : 28) + i]);
  return end;
}

bool looks_like_hdf5(std::string_view head) {
  return head.starts_with("\x89HDF\r\n\x1a\n"sv);
}

}  // namespace impactrig::datasets
