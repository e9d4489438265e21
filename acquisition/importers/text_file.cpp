// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/text_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "acquisition/importers/number.hpp"
#include "acquisition/importers/spool.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::SourcePosition;

namespace {

/// Larger texts that have to be rewritten are rewritten on the disk [bytes].
constexpr std::size_t most_in_memory = std::size_t{1} << 25;
constexpr std::size_t rewritten_at_once = std::size_t{1} << 20;  ///< [bytes]

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

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_sequence(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

/// Windows-1252 differs from latin-1 in 0x80 to 0x9F; 0 where it has no character.
constexpr std::array<std::uint16_t, 32> windows_1252 = {
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

/// Lines that end with \r as lines that end with \n.
std::string line_feeds(std::string_view bytes) {
  std::string text(bytes);
  std::ranges::replace(text, '\r', '\n');
  return text;
}

/// A unit of UTF-16.
std::uint32_t unit_at(std::string_view bytes, std::size_t i, bool little) {
  const auto low = static_cast<unsigned char>(bytes[little ? i : i + 1]);
  const auto high = static_cast<unsigned char>(bytes[little ? i + 1 : i]);
  return static_cast<std::uint32_t>(low | high << 8);
}

bool is_first_surrogate(std::uint32_t unit) {
  return unit >= 0xD800 && unit < 0xDC00;
}

/// Bytes [first, last) of UTF-16.
std::string utf16_part(std::string_view bytes, std::size_t first, std::size_t last, bool little) {
  std::string out;
  out.reserve((last - first) / 2);
  for (std::size_t i = first; i + 1 < last; i += 2) {
    std::uint32_t code = unit_at(bytes, i, little);
    const std::uint32_t next = i + 3 < last ? unit_at(bytes, i + 2, little) : 0;
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

bool may_be_padded(std::string_view bytes) {
  return bytes.ends_with('\0') && !looks_like_utf16(bytes.substr(0, 65536));
}

bool is_little_endian(std::string_view bytes) {
  return bytes.starts_with("\xFF\xFE");
}

}  // namespace

TextFile::TextFile(std::string path, bool head_only)
    : file_(std::move(path)),
      size_(file_.bytes().size() - padding_of(file_)),
      head_only_(head_only) {}

std::string_view TextFile::text() {
  if (!text_.empty()) return is_part() ? std::string_view(text_).substr(0, part_) : text_;
  if (rewritten_) return rewritten_->bytes();
  const std::string_view all = bytes().substr(0, size_);
  if (all.starts_with("\xEF\xBB\xBF")) return all.substr(3);
  const std::string_view head = all.substr(0, 65536);
  if (looks_like_utf16(head)) {
    if (!all.starts_with("\xFF\xFE") && !all.starts_with("\xFE\xFF"))
      throw InputError(byte_position(all.data()),
                       "the text looks like UTF-16 without a byte order mark: save it as UTF-8");
    if (all.size() > most_in_memory) {
      const auto rewrite = [all](std::size_t first, std::size_t last) {
        return utf16_part(all, first, last, is_little_endian(all));
      };
      if (take_first_lines(2, rewrite)) return text();
      rewritten_ = utf16_to_utf8(file_, rewritten_at_once);
      return rewritten_->bytes();
    }
    text_ = utf16_to_utf8(all);
    return text_;
  }
  if (head.find('\r') != std::string_view::npos && head.find('\n') == std::string_view::npos) {
    if (all.size() > most_in_memory) {
      const auto rewrite = [all](std::size_t first, std::size_t last) {
        return line_feeds(all.substr(first, last - first));
      };
      if (take_first_lines(0, rewrite)) return text();
      rewritten_ = with_line_feeds(file_, rewritten_at_once);
      return rewritten_->bytes();
    }
    text_ = line_feeds(all);
    return text_;
  }
  return all;
}

template <typename Rewrite>
bool TextFile::take_first_lines(std::size_t start, const Rewrite& rewrite) {
  if (!head_only_) return false;
  const std::string part = rewrite(start, telling_part);
  text_ = whole_lines(part, part.size());
  if (text_.empty()) return false;
  part_ = text_.size();
  constexpr std::size_t last_part = 65536;  // even, as units of UTF-16 are
  const std::string last = rewrite((size_ - last_part) / 2 * 2, size_);
  text_.append(last, std::min(last.find('\n'), last.size() - 1) + 1);
  expected_size_ = static_cast<double>(part.size()) / static_cast<double>(telling_part - start) *
                   static_cast<double>(size_ - start);
  return true;
}

void TextFile::release(const char* first, const char* last) const {
  const MappedFile& file = rewritten_ ? *rewritten_ : file_;
  const std::string_view all = file.bytes();
  if (first < all.data() || last > all.data() + all.size() || first >= last) return;
  file.release(static_cast<std::size_t>(first - all.data()),
               static_cast<std::size_t>(last - all.data()));
}

SourcePosition TextFile::position(const char* at) const {
  const std::string_view all = bytes();
  const bool in_file = at >= all.data() && at <= all.data() + all.size();
  const char* const rewritten = rewritten_ ? rewritten_->bytes().data() : text_.data();
  const char* const start = in_file ? all.data() : rewritten;
  SourcePosition place;
  place.file = path();
  const char* line = start;
  place.line = 1;
  for (;;) {
    const auto* const end =
        static_cast<const char*>(std::memchr(line, '\n', static_cast<std::size_t>(at - line)));
    if (end == nullptr) break;
    ++place.line;
    line = end + 1;
  }
  place.column = static_cast<std::uint32_t>(at - line) + 1;
  if (in_file) place.byte = static_cast<std::uint64_t>(at - start);
  return place;
}

SourcePosition TextFile::byte_position(const char* at) const {
  return file_.byte_position(static_cast<std::size_t>(at - bytes().data()));
}

std::string_view take_line(const char*& at, const char* end) {
  const char* const start = at;
  const auto* stop =
      static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
  if (stop == nullptr) {
    stop = at = end;
  } else {
    at = stop + 1;
  }
  if (stop != start && stop[-1] == '\r') --stop;
  return {start, static_cast<std::size_t>(stop - start)};
}

std::string_view whole_lines(std::string_view text, std::size_t most) {
  text = text.substr(0, most);
  const std::size_t last = text.rfind('\n');
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
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

std::size_t padding_of(std::string_view bytes) {
  if (!may_be_padded(bytes)) return 0;
  const std::size_t last = bytes.find_last_not_of('\0');
  return last == std::string_view::npos ? 0 : bytes.size() - last - 1;
}

std::size_t padding_of(const MappedFile& file) {
  if (!may_be_padded(file.bytes())) return 0;
  const std::size_t zeros = file.zeros_at_end();
  return zeros == file.bytes().size() ? 0 : zeros;
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
  return utf16_part(bytes, std::min<std::size_t>(2, bytes.size()), bytes.size(),
                    is_little_endian(bytes));
}

std::unique_ptr<MappedFile> utf16_to_utf8(const MappedFile& file, std::size_t piece) {
  const std::string_view bytes = file.bytes();
  const bool little = is_little_endian(bytes);
  Spool spool(file.path());
  for (std::size_t first = std::min<std::size_t>(2, bytes.size()); first < bytes.size();) {
    std::size_t last = first + std::max<std::size_t>(piece / 2 * 2, 4);
    if (last >= bytes.size())
      last = bytes.size();
    else if (is_first_surrogate(unit_at(bytes, last - 2, little)))
      last -= 2;  // its second one is in the next piece
    spool.append(utf16_part(bytes, first, last, little));
    file.release(first, last);
    first = last;
  }
  return spool.map();
}

std::unique_ptr<MappedFile> with_line_feeds(const MappedFile& file, std::size_t piece) {
  const std::string_view bytes = file.bytes().substr(0, file.bytes().size() - padding_of(file));
  Spool spool(file.path());
  for (std::size_t first = 0; first < bytes.size(); first += piece) {
    const std::string part = line_feeds(bytes.substr(first, piece));
    spool.append(part);
    file.release(first, first + part.size());
  }
  return spool.map();
}

}  // namespace impactrig::acquisition
