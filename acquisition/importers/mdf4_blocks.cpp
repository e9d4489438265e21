// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

// So that memory stays bounded whatever a file says.
constexpr std::uint64_t most_text_bytes = std::uint64_t{1} << 26;

/// What stands between '&' and ';' as a character: "lt", "#181", "#xB5"; none: it is nothing of
/// XML, or a character beyond the first 65536.
std::optional<std::string> character_of(std::string_view reference) {
  constexpr std::array<std::pair<std::string_view, char>, 5> entities = {
      {{"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}, {"amp", '&'}}};
  for (const auto& [name, character] : entities)
    if (reference == name) return std::string(1, character);
  if (!reference.starts_with('#')) return std::nullopt;
  reference.remove_prefix(1);
  const bool hexadecimal = reference.starts_with('x');
  if (hexadecimal) reference.remove_prefix(1);
  std::uint16_t code = 0;
  const char* const end = reference.data() + reference.size();
  const auto [at, error] = std::from_chars(reference.data(), end, code, hexadecimal ? 16 : 10);
  if (error != std::errc{} || at != end || code == 0) return std::nullopt;
  if (code < ' ') return " ";
  const std::array<char, 4> utf16 = {'\xFE', '\xFF', static_cast<char>(code >> 8),
                                     static_cast<char>(code & 0xFF)};
  return utf16_to_utf8({utf16.data(), utf16.size()});
}

std::string without_references(std::string_view text) {
  constexpr std::size_t longest = 8;  // "#x0000B5"
  std::string out;
  while (!text.empty()) {
    const std::size_t begin = std::min(text.find('&'), text.size());
    out += text.substr(0, begin);
    text.remove_prefix(begin);
    if (text.empty()) break;
    const std::size_t end = text.substr(0, longest + 2).find(';');
    const auto character =
        end == std::string_view::npos ? std::nullopt : character_of(text.substr(1, end - 1));
    out += character.value_or("&");
    text.remove_prefix(character ? end + 1 : 1);
  }
  return out;
}

}  // namespace

void MdfBlocks::fail(std::uint64_t at, std::string_view problem) const {
  throw InputError(file_->byte_position(std::min(at, size_)), problem);
}

MdfBlock MdfBlocks::block_at(std::uint64_t at, std::string_view what, std::uint64_t most) const {
  ByteCursor in(*file_, false, at);
  MdfBlock block{at, {}, {}, 0, 0};
  const std::string_view id = in.bytes(4, what);
  if (!id.starts_with("##")) fail(at, fmt::format("expected {}, found '{}'", what, to_utf8(id)));
  block.id = to_utf8(id.substr(2));
  in.skip(4);
  const auto length = in.read<std::uint64_t>(what);
  const auto links = in.read<std::uint64_t>(what);
  block.end = length > size_ - at ? size_ : at + length;
  if (length < mdf_block_head || links > (length - mdf_block_head) / 8)
    fail(at, fmt::format("a block {} of {} bytes with {} links", block.id, length, links));
  if (links > in.left() / 8) fail(size_, fmt::format("the file ends within {}", what));
  block.data = in.at() + 8 * links;
  most = std::min(most, links);
  block.links.reserve(most);
  for (std::uint64_t i = 0; i < most; ++i) block.links.push_back(in.read<std::uint64_t>(what));
  return block;
}

MdfBlock MdfBlocks::new_block_at(std::uint64_t at, std::string_view id, std::string_view what) {
  if (!seen_.insert(at).second)
    fail(at, fmt::format("{} is referred to twice: blocks are chained in a circle", what));
  MdfBlock block = block_at(at, what);
  if (!id.empty() && block.id != id)
    fail(at, fmt::format("expected {} ({}), found a block {}", what, id, block.id));
  return block;
}

std::string MdfBlocks::text_at(std::uint64_t at) {
  std::string text = at == 0 ? std::string() : read_text(at);
  text_bytes_ += text.size();
  if (text_bytes_ > most_text_bytes)
    fail(at, fmt::format("there are more than {} bytes of names and comments", most_text_bytes));
  return text;
}

std::string MdfBlocks::read_text(std::uint64_t at) const {
  const MdfBlock block = block_at(at, "a text", 0);
  if (block.id != "TX" && block.id != "MD") return {};
  std::string_view text = file_->bytes().substr(block.data, block.end - block.data);
  text = text.substr(0, std::min<std::size_t>(text.find('\0'), 10000));
  if (block.id == "MD") {
    const std::size_t open = text.find("<TX");
    const std::size_t begin = open == std::string_view::npos ? open : text.find('>', open);
    if (begin == std::string_view::npos || text[begin - 1] == '/') return {};
    text.remove_prefix(begin + 1);
    text = text.substr(0, text.find("</TX>"));
    return trimmed_mdf_text(without_references(to_utf8(text)));
  }
  return trimmed_mdf_text(to_utf8(text));
}

std::string trimmed_mdf_text(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(' ') - first + 1));
}

}  // namespace impactrig::acquisition
