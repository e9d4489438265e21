// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/text_file.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

#include "acquisition/importers/quoted_lines.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::SourcePosition;

namespace {

/// Larger texts that have to be rewritten are rewritten on the disk [bytes].
constexpr std::size_t most_in_memory = std::size_t{1} << 25;
constexpr std::size_t rewritten_at_once = std::size_t{1} << 20;  ///< [bytes]
constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";

bool may_be_padded(std::string_view bytes) {
  return bytes.ends_with('\0') && !looks_like_utf16(bytes.substr(0, 65536));
}

std::size_t mark_of(std::string_view bytes) {
  return bytes.starts_with(utf8_mark) ? utf8_mark.size() : 0;
}

}  // namespace

TextFile::TextFile(std::string path, bool head_only, std::string code_page)
    : file_(std::move(path)),
      size_(file_.bytes().size() - padding_of(file_)),
      head_only_(head_only),
      code_page_(std::move(code_page)) {}

std::string_view TextFile::text() {
  if (turned_) return turned_->text();
  if (!text_.empty()) return is_part() ? std::string_view(text_).substr(0, part_) : text_;
  if (rewritten_) return rewritten_->bytes();
  const std::string_view all = bytes().substr(0, size_);
  const auto how = rewriting();
  if (!how) return all.substr(mark_of(all));
  if (all.size() <= most_in_memory) {
    text_ = how->part(all.substr(how->mark));
    return text_;
  }
  if (take_first_lines(*how)) return text();
  rewritten_ = rewritten(file_, *how, rewritten_at_once);
  return rewritten_->bytes();
}

std::optional<Rewriting> TextFile::rewriting() const {
  const std::string_view all = bytes().substr(0, size_);
  auto of_bytes = rewriting_of_bytes();
  const std::size_t mark = of_bytes ? of_bytes->mark : mark_of(all);
  const std::string_view head = all.substr(std::min(mark, all.size()), 65536);
  const bool quoted = of_bytes ? has_quoted_lines(of_bytes->part(head)) : has_quoted_lines(head);
  if (!quoted) return of_bytes;
  return without_quoted_lines(of_bytes ? *std::move(of_bytes) : no_rewriting(mark));
}

std::optional<Rewriting> TextFile::rewriting_of_bytes() const {
  const std::string_view all = bytes().substr(0, size_);
  if (mark_of(all) > 0) return std::nullopt;
  const std::string_view head = all.substr(0, 65536);
  if (looks_like_utf16(head)) {
    if (!all.starts_with("\xFF\xFE") && !all.starts_with("\xFE\xFF"))
      throw InputError(byte_position(all.data()),
                       "the text looks like UTF-16 without a byte order mark: save it as UTF-8");
    return utf16_rewriting(all);
  }
  const bool returns =
      head.find('\r') != std::string_view::npos && head.find('\n') == std::string_view::npos;
  if (!code_page_.empty()) return code_page_rewriting(code_page_, returns);
  return returns ? std::optional(line_feed_rewriting()) : std::nullopt;
}

bool TextFile::take_first_lines(const Rewriting& rewriting) {
  if (!head_only_) return false;
  const std::string_view all = bytes().substr(0, size_);
  const std::string part =
      rewriting.part(all.substr(rewriting.mark, telling_part - rewriting.mark));
  text_ = whole_lines(part, part.size());
  if (text_.empty()) return false;
  part_ = text_.size();
  constexpr std::size_t last_part = 65536;  // even, as units of UTF-16 are
  const std::string last = rewriting.part(all.substr((size_ - last_part) / 2 * 2));
  text_.append(last, std::min(last.find('\n'), last.size() - 1) + 1);
  expected_size_ = static_cast<double>(part.size()) /
                   static_cast<double>(telling_part - rewriting.mark) *
                   static_cast<double>(size_ - rewriting.mark);
  return true;
}

void TextFile::release(const char* first, const char* last) const {
  if (turned_ && first >= turned_->text().data() &&
      last <= turned_->text().data() + turned_->text().size())
    return turned_->release(first, last);
  const MappedFile& file = rewritten_ ? *rewritten_ : file_;
  const std::string_view all = file.bytes();
  if (first < all.data() || last > all.data() + all.size() || first >= last) return;
  file.release(static_cast<std::size_t>(first - all.data()),
               static_cast<std::size_t>(last - all.data()));
}

SourcePosition TextFile::position(const char* at) const {
  if (turned_) at = turned_->origin(at);
  const std::string_view all = bytes();
  const bool in_file = at >= all.data() && at <= all.data() + all.size();
  const char* const made = rewritten_ ? rewritten_->bytes().data() : text_.data();
  const char* const start = in_file ? all.data() : made;
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

}  // namespace impactrig::acquisition
