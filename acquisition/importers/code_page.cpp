// SPDX-License-Identifier: BSD-3-Clause
#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <set>
#include <stdexcept>

#include "acquisition/importers/text_encoding.hpp"

namespace impactrig::acquisition {

namespace {

/// ASCII without the escapes by which ISO 2022 changes what it means.
bool is_plain_ascii(std::string_view text) {
  return std::ranges::none_of(text, [](char c) { return (c & 0x80) != 0 || c == '\x1B'; });
}

// --- From a code page to UTF-8, by the C library -------------------------------------------------

/// iconv's state, which goes with the last function that uses it.
class Converter {
 public:
  explicit Converter(const std::string& code_page)
      : state_(iconv_open("UTF-8", code_page.c_str())) {
    if (state_ == reinterpret_cast<iconv_t>(-1))
      throw std::invalid_argument("there is no code page '" + code_page + "'");
  }

  ~Converter() { iconv_close(state_); }

  Converter(const Converter&) = delete;
  Converter& operator=(const Converter&) = delete;

  std::string to_utf8(std::string_view text) const {
    std::string out;
    out.reserve(text.size() + text.size() / 2);
    iconv(state_, nullptr, nullptr, nullptr, nullptr);
    char* from = const_cast<char*>(text.data());  // iconv does not write there
    std::size_t left = text.size();
    std::array<char, 4096> piece{};
    while (left > 0) {
      char* to = piece.data();
      std::size_t room = piece.size();
      const std::size_t done = iconv(state_, &from, &left, &to, &room);
      const int error = done == static_cast<std::size_t>(-1) ? errno : 0;
      out.append(piece.data(), piece.size() - room);
      if (error == 0 || error == E2BIG) continue;
      out += "\uFFFD";  // no character of that code page, or one that the text's end cuts off
      ++from;
      --left;
    }
    return out;
  }

 private:
  iconv_t state_;
};

// --- Which code page a text is of ----------------------------------------------------------------

/// How far the words of a text are those of a code page's language.
struct Support {
  std::size_t usual = 0;          ///< bytes of characters that such text is mostly made of
  std::size_t odd = 0;            ///< of others, or of none
  std::set<unsigned> characters;  ///< usual ones, each once
};

unsigned byte_at(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
}

bool between(unsigned value, unsigned low, unsigned high) {
  return value >= low && value <= high;
}

enum class Kind { usual, neutral, odd };

/// Counts characters of two bytes. `kind` judges a pair; a first byte that `stands_alone` needs no
/// second one.
template <typename Judge, typename Alone>
Support of_pairs(std::string_view text, const Judge& kind, const Alone& stands_alone) {
  Support support;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned first = byte_at(text, i);
    if (first < 0x80 || stands_alone(first)) continue;
    const unsigned second = byte_at(text, i + 1);
    switch (kind(first, second)) {
      case Kind::usual:
        support.usual += 2;
        support.characters.insert(first << 8 | second);
        ++i;
        break;
      case Kind::neutral:
        ++i;
        break;
      case Kind::odd:
        ++support.odd;
    }
  }
  return support;
}

/// GB 18030: the 3755 usual characters of GB 2312 (rows 0xB0 to 0xD7); its signs, full-width
/// letters and Greek are neutral. Of Korean's KS X 1001 the syllables are in 0xB0 to 0xC8.
Support of_chinese_or_korean(std::string_view text, unsigned last_row) {
  return of_pairs(
      text,
      [last_row](unsigned first, unsigned second) {
        if (!between(second, 0xA1, 0xFE)) return Kind::odd;
        if (between(first, 0xB0, last_row)) return Kind::usual;
        return between(first, 0xA1, 0xA3) || first == 0xA6 ? Kind::neutral : Kind::odd;
      },
      [](unsigned) { return false; });
}

/// Shift-JIS: kana and the usual characters of JIS X 0208; half-width kana stand alone.
Support of_japanese(std::string_view text) {
  return of_pairs(
      text,
      [](unsigned first, unsigned second) {
        if (!between(second, 0x40, 0xFC) || second == 0x7F) return Kind::odd;
        const bool kana = (first == 0x82 && second >= 0x9F) || (first == 0x83 && second <= 0x96);
        if (kana || between(first, 0x88, 0x97)) return Kind::usual;
        return between(first, 0x81, 0x84) ? Kind::neutral : Kind::odd;
      },
      [](unsigned first) { return between(first, 0xA1, 0xDF); });
}

bool is_cyrillic(unsigned byte) {
  return byte >= 0xC0 || byte == 0xA8 || byte == 0xB8;
}

bool is_small_cyrillic(unsigned byte) {
  return byte >= 0xE0 || byte == 0xB8;
}

bool is_latin_letter(unsigned byte) {
  return between(byte | 0x20U, 'a', 'z');
}

/// Signs that stand beside words: degree, numero, quotes.
bool may_touch_a_word(unsigned byte) {
  return byte == 0xB0 || byte == 0xB9 || byte == 0xAB || byte == 0xBB;
}

/// Windows-1251: words of three letters and more whose letters are small but for the first one, or
/// all capital. Shorter ones (units) are neutral, signs where they do not touch a letter.
Support of_cyrillic(std::string_view text) {
  Support support;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t first = i;
    while (is_cyrillic(byte_at(text, i))) ++i;
    const std::size_t letters = i - first;
    if (letters == 0) {
      const unsigned sign = byte_at(text, i);
      const bool touches =
          is_cyrillic(byte_at(text, i + 1)) || (i > 0 && is_cyrillic(byte_at(text, i - 1)));
      if (sign >= 0x80 && touches && !may_touch_a_word(sign)) ++support.odd;
      ++i;
      continue;
    }
    const bool beside_latin = (first > 0 && is_latin_letter(byte_at(text, first - 1))) ||
                              is_latin_letter(byte_at(text, i));
    if (letters < 3) {
      if (beside_latin) support.odd += letters;  // "Größe"
      continue;
    }
    const auto small = static_cast<std::size_t>(
        std::count_if(text.begin() + static_cast<std::ptrdiff_t>(first),
                      text.begin() + static_cast<std::ptrdiff_t>(i),
                      [](char c) { return is_small_cyrillic(static_cast<unsigned char>(c)); }));
    const bool begins_small = is_small_cyrillic(byte_at(text, first));
    const bool one_case = small == letters || small == 0 || (!begins_small && small + 1 == letters);
    (one_case && !beside_latin ? support.usual : support.odd) += letters;
  }
  return support;
}

/// The head of a text may end within a character.
std::string_view without_cut_character(std::string_view head) {
  std::size_t behind = 0;
  while (behind < std::min<std::size_t>(3, head.size()) && (head[head.size() - 1 - behind] & 0x80))
    ++behind;
  return head.substr(0, head.size() - behind);
}

/// Windows-1252: "Größe", "°C" and "µm/m²" have no three such bytes in a row but in rules ("———").
bool may_be_western(std::string_view text) {
  for (std::size_t i = 0; i + 2 < text.size(); ++i) {
    const std::string_view three = text.substr(i, 3);
    const bool letters = std::ranges::all_of(three, [](char c) { return (c & 0x80) != 0; });
    if (letters && three.find_first_not_of(three[0]) != three.npos) return false;
  }
  return true;
}

}  // namespace

bool is_code_page(const std::string& name) try {
  constexpr std::string_view ascii = "Time [s],1.5e-3\n";
  return !name.empty() &&
         Converter(name).to_utf8(ascii) == ascii;  // of UTF-16 it is something else

} catch (const std::invalid_argument&) {
  return false;
}

Rewriting code_page_rewriting(const std::string& code_page, bool returns) {
  const char line_end = returns ? '\r' : '\n';
  return {.part =
              [converter = std::make_shared<Converter>(code_page), returns](std::string_view part) {
                std::string text =
                    is_plain_ascii(part) ? std::string(part) : converter->to_utf8(part);
                if (returns) std::ranges::replace(text, '\r', '\n');
                return text;
              },
          // no character of two bytes holds the end of a line
          .end =
              [line_end](std::string_view bytes, std::size_t first, std::size_t last) {
                const std::size_t before = bytes.rfind(line_end, last - 1);
                if (before != bytes.npos && before >= first) return before + 1;
                const std::size_t behind = bytes.find(line_end, last);
                return behind == bytes.npos ? bytes.size() : behind + 1;
              },
          .line_end = std::string(1, line_end)};
}

std::string likely_code_page(std::string_view head) {
  if (is_utf8(without_cut_character(head)) || may_be_western(head)) return {};
  constexpr std::size_t least = 4;  // bytes: two characters, or a word
  constexpr std::size_t telling_characters = 10;
  const auto fits = [](const Support& support) {
    return support.usual >= least && 10 * support.odd <= support.usual;
  };
  if (fits(of_japanese(head))) return "CP932";
  if (fits(of_cyrillic(head))) return "CP1251";
  const Support chinese = of_chinese_or_korean(head, 0xD7);
  // "µ±²³" are characters too
  const bool signs = std::ranges::all_of(
      chinese.characters, [](unsigned pair) { return pair >> 8 < 0xC0 && (pair & 0xFF) < 0xC0; });
  if (!fits(chinese) || signs) return {};
  // so many characters of Chinese are not all in the first 25 of 40 rows
  const Support korean = of_chinese_or_korean(head, 0xC8);
  return fits(korean) && korean.characters.size() >= telling_characters ? "CP949" : "GB18030";
}

}  // namespace impactrig::acquisition
