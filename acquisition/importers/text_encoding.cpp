// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/text_encoding.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "acquisition/importers/spool.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

namespace {

void append_utf8(std::string& out, std::uint32_t code) {
  const auto byte = [&out](std::uint32_t value) { out += static_cast<char>(value); };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xC0 | code >> 6);
    byte(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    byte(0xE0 | code >> 12);
    byte(0x80 | (code >> 6 & 0x3F));
    byte(0x80 | (code & 0x3F));
  } else {
    byte(0xF0 | code >> 18);
    byte(0x80 | (code >> 12 & 0x3F));
    byte(0x80 | (code >> 6 & 0x3F));
    byte(0x80 | (code & 0x3F));
  }
}

/// Length of the valid UTF-8 sequence at the start of `text`, 0 when there is none [RFC 3629: no
/// overlong forms, no surrogates, nothing above U+10FFFF].
std::size_t utf8_sequence(std::string_view text) {
  const auto at = [text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const auto follows = [&at](std::size_t i) { return (at(i) & 0xC0) == 0x80; };
  const unsigned lead = at(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return follows(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    if (lead == 0xE0 && at(1) < 0xA0) return 0;
    if (lead == 0xED && at(1) > 0x9F) return 0;
    return follows(1) && follows(2) ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    if (lead == 0xF0 && at(1) < 0x90) return 0;
    if (lead == 0xF4 && at(1) > 0x8F) return 0;
    return follows(1) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

/// Windows-1252 differs from latin-1 in 0x80 to 0x9F; 0 where it has no character.
constexpr std::array<std::uint16_t, 32> windows_1252 = {
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

/// A unit of UTF-16.
std::uint32_t unit_at(std::string_view bytes, std::size_t i, bool little) {
  const auto low = static_cast<unsigned char>(bytes[little ? i : i + 1]);
  const auto high = static_cast<unsigned char>(bytes[little ? i + 1 : i]);
  return static_cast<std::uint32_t>(low | high << 8);
}

bool is_first_surrogate(std::uint32_t unit) {
  return unit >= 0xD800 && unit < 0xDC00;
}

/// UTF-16 without its mark.
std::string utf16_part(std::string_view bytes, bool little) {
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit_at(bytes, i, little);
    const std::uint32_t next = i + 3 < bytes.size() ? unit_at(bytes, i + 2, little) : 0;
    if (is_first_surrogate(code) && next >= 0xDC00 && next < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10) + (next - 0xDC00);
      i += 2;
    } else if (code >= 0xD800 && code < 0xE000) {
      code = 0xFFFD;
    }
    append_utf8(out, code);
  }
  return out;
}

std::string line_feeds(std::string_view bytes) {
  std::string text(bytes);
  std::ranges::replace(text, '\r', '\n');
  return text;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_sequence(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string to_utf8(std::string_view text) {
  std::string out = to_utf8_with_controls(text);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return out;
}

std::string to_utf8_with_controls(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  const bool utf8 = is_utf8(text);
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (utf8 || byte < 0x80) {
      out += c;
    } else if (byte < 0xA0) {
      const std::uint16_t code = windows_1252[byte - 0x80U];
      append_utf8(out, code != 0 ? code : 0xFFFD);
    } else {
      append_utf8(out, byte);
    }
  }
  return out;
}

bool looks_like_utf16(std::string_view head) {
  if (head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF")) return true;
  // without a mark: every other byte of mostly ASCII text is 0
  head = head.substr(0, 256);
  if (head.size() < 8) return false;
  std::array<std::size_t, 2> zeros{};
  for (std::size_t i = 0; i < head.size(); ++i)
    if (head[i] == '\0') ++zeros[i % 2];
  const std::size_t half = head.size() / 2;
  const auto printable = [](char c) {
    return (c >= ' ' && c < 0x7F) || c == '\t' || c == '\r' || c == '\n';
  };
  for (const std::size_t parity : {std::size_t{0}, std::size_t{1}}) {
    if (zeros[parity] != (parity == 0 ? head.size() - half : half) || zeros[1 - parity] != 0)
      continue;
    bool text = true;
    for (std::size_t i = 1 - parity; i < head.size(); i += 2) text = text && printable(head[i]);
    if (text) return true;
  }
  return false;
}

std::string utf16_to_utf8(std::string_view bytes) {
  const Rewriting rewriting = utf16_rewriting(bytes);
  return rewriting.part(bytes.substr(std::min(rewriting.mark, bytes.size())));
}

Rewriting utf16_rewriting(std::string_view bytes) {
  const bool little = bytes.starts_with("\xFF\xFE");
  return {.mark = 2,
          .part = [little](std::string_view part) { return utf16_part(part, little); },
          .end =
              [little](std::string_view all, std::size_t first, std::size_t last) {
                last = first + std::max<std::size_t>((last - first) / 2 * 2, 4);
                // the second one of a pair is in the same part
                return is_first_surrogate(unit_at(all, last - 2, little)) ? last - 2 : last;
              },
          .line_end = little ? std::string("\n\0", 2) : std::string("\0\n", 2)};
}

Rewriting no_rewriting(std::size_t mark) {
  return {.mark = mark,
          .part = [](std::string_view part) { return std::string(part); },
          .end = [](std::string_view, std::size_t, std::size_t last) { return last; }};
}

Rewriting line_feed_rewriting() {
  return {.part = line_feeds,
          .end = [](std::string_view, std::size_t, std::size_t last) { return last; },
          .line_end = "\r"};
}

std::unique_ptr<MappedFile> rewritten(const MappedFile& file, const Rewriting& rewriting,
                                      std::size_t piece) {
  const std::string_view bytes = file.bytes().substr(0, file.bytes().size() - padding_of(file));
  Spool spool(file.path());
  for (std::size_t first = std::min(rewriting.mark, bytes.size()); first < bytes.size();) {
    std::size_t last = bytes.size();
    if (last - first > std::max<std::size_t>(piece, 4))
      last = rewriting.end(bytes, first, first + std::max<std::size_t>(piece, 4));
    spool.append(rewriting.part(bytes.substr(first, last - first)));
    file.release(first, last);
    first = last;
  }
  return spool.map();
}

}  // namespace impactrig::acquisition
