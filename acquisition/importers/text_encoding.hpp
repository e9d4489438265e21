// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "acquisition/importers/mapped_file.hpp"

namespace impactrig::acquisition {

bool is_utf8(std::string_view text);

/// Text of a file as UTF-8: what is valid UTF-8 stays, anything else is read as Windows-1252
/// (latin-1 with its additions); control characters become blanks.
std::string to_utf8(std::string_view text);

/// The same with control characters as they are: for text that is no attribute of a foreign file.
std::string to_utf8_with_controls(std::string_view text);

/// True for UTF-16, with or without byte order mark.
bool looks_like_utf16(std::string_view head);

/// UTF-16 with byte order mark to UTF-8; unpaired surrogates become U+FFFD.
std::string utf16_to_utf8(std::string_view bytes);

/// How a text in other bytes becomes UTF-8 with \n at the ends of its lines, a part at a time.
struct Rewriting {
  std::size_t mark = 0;  ///< bytes before the text
  std::function<std::string(std::string_view part)> part;
  /// Where a part of `bytes` that begins at `first` may end, `last` at best: behind `first`.
  std::function<std::size_t(std::string_view bytes, std::size_t first, std::size_t last)> end;
  std::string line_end = "\n";  ///< as the bytes spell it: as many as a unit of them has
};

/// Of a text whose bytes stay as they are, behind `mark` of them.
Rewriting no_rewriting(std::size_t mark);

/// Of UTF-16, whose byte order mark `bytes` begin with.
Rewriting utf16_rewriting(std::string_view bytes);

/// Of lines that end with \r.
Rewriting line_feed_rewriting();

/// Of a code page by a name that iconv knows; what stands for no character becomes U+FFFD.
/// `returns`: lines end with \r. Throws std::invalid_argument for a name that is not known.
Rewriting code_page_rewriting(const std::string& code_page, bool returns);

/// A text on the disk, which holds `piece` bytes of it in memory at a time (at least 4).
std::unique_ptr<MappedFile> rewritten(const MappedFile& file, const Rewriting& rewriting,
                                      std::size_t piece);

/// Whether iconv knows a code page of that name in which ASCII is itself.
bool is_code_page(const std::string& name);

/// The code page that the words of a text are likely of: "CP932" (Shift-JIS), "GB18030" (Chinese),
/// "CP949" (Korean), "CP1251" (Cyrillic). "" for UTF-8 and where Windows-1252 may be meant.
std::string likely_code_page(std::string_view head);

}  // namespace impactrig::acquisition
