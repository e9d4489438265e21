// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/unit_spelling.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <span>

namespace impactrig::datasets {

namespace {

struct Replacement {
  std::string_view from;
  std::string_view to;
};

/// Signs UDUNITS-2 does not know, or knows in one combination only. A superscript that follows
/// another belongs to the same exponent, so the caret is added later.
constexpr std::array<Replacement, 18> signs{{
    {"\u22c5", "."},       // dot operator
    {"\u00b7", "."},       // middle dot
    {"\u00d7", "."},       // multiplication sign
    {"\u2212", "-"},       // minus sign
    {"\u00a0", " "},       // no-break space
    {"\u202f", " "},       // narrow no-break space
    {"\u03bc", "\u00b5"},  // Greek mu to micro sign
    {"\u00ba", "\u00b0"},  // masculine ordinal, taken for the degree sign
    {"\u2103", "degC"},
    {"\u339b", "um"},  // squares of East Asian text
    {"\u339c", "mm"},
    {"\u33a7", "m/s"},
    {"\u33a8", "m/s^2"},
    {"\u33aa", "kPa"},
    {"\u33ab", "MPa"},
    {"\u33b2", "us"},
    {"\u33b3", "ms"},
    {"\u33b7", "mV"},
}};

constexpr std::array<Replacement, 11> superscripts{{
    {"\u207b", "-"},
    {"\u2070", "0"},
    {"\u00b9", "1"},
    {"\u00b2", "2"},
    {"\u00b3", "3"},
    {"\u2074", "4"},
    {"\u2075", "5"},
    {"\u2076", "6"},
    {"\u2077", "7"},
    {"\u2078", "8"},
    {"\u2079", "9"},
}};

/// Whole words. UDUNITS-2 knows degree and rpm to 14 or 15 digits only, and takes "ue" for the
/// micro-electron-charge.
constexpr std::array<Replacement, 36> words{{
    {"deg", "(0.017453292519943295 rad)"},
    {"degree", "(0.017453292519943295 rad)"},
    {"degrees", "(0.017453292519943295 rad)"},
    {"\u00b0", "(0.017453292519943295 rad)"},
    {"rpm", "(0.10471975511965977 rad/s)"},
    {"RPM", "(0.10471975511965977 rad/s)"},
    {"hz", "Hz"},
    {"HZ", "Hz"},
    {"khz", "kHz"},
    {"KHz", "kHz"},
    {"KHZ", "kHz"},
    {"hrs", "h"},
    {"Nm", "(N.m)"},
    {"strain", "1"},
    {"\u03b5", "1"},
    {"microstrain", "1e-6"},
    {"ustrain", "1e-6"},
    {"\u00b5strain", "1e-6"},
    {"ue", "1e-6"},
    {"uE", "1e-6"},
    {"\u00b5\u03b5", "1e-6"},
    {"u\u03b5", "1e-6"},
    {"gn", "gravity"},
    {"G", "gravity"},
    {"gs", "gravity"},
    {"Gs", "gravity"},  // UDUNITS-2: gigasecond
    {"lbs", "lb"},
    {"Lbs", "lb"},
    {"LBS", "lb"},
    {"VDC", "V"},
    {"KN", "kN"},
    {"kp", "kgf"},
    {"tf", "(1e3 kgf)"},
    {"dyn", "(1e-5 N)"},
    {"ips", "(in/s)"},
    {"mps", "(m/s)"},
}};

/// Symbols of GOST 8.417 and Chinese names of units, as laboratories head columns with them.
constexpr std::array<Replacement, 59> translations{{
    {"sek", "s"},
    {"msek", "ms"},
    {"с", "s"},
    {"мс", "ms"},
    {"мкс", "us"},
    {"mks", "us"},  // in Latin letters
    {"нс", "ns"},
    {"мин", "min"},
    {"ч", "h"},
    {"Н", "N"},
    {"кН", "kN"},
    {"МН", "MN"},
    {"мН", "mN"},
    {"гс", "(1e-3 kgf)"},
    {"кгс", "kgf"},
    {"тс", "(1e3 kgf)"},
    {"м", "m"},
    {"см", "cm"},
    {"мм", "mm"},
    {"мкм", "um"},
    {"нм", "nm"},
    {"км", "km"},
    {"В", "V"},
    {"мВ", "mV"},
    {"мкВ", "uV"},
    {"кВ", "kV"},
    {"А", "A"},
    {"мА", "mA"},
    {"Кл", "C"},
    {"нКл", "nC"},
    {"пКл", "pC"},
    {"Па", "Pa"},
    {"кПа", "kPa"},
    {"МПа", "MPa"},
    {"ГПа", "GPa"},
    {"Гц", "Hz"},
    {"кГц", "kHz"},
    {"МГц", "MHz"},
    {"кг", "kg"},
    {"Дж", "J"},
    {"мДж", "mJ"},
    {"рад", "rad"},
    {"град", "(0.017453292519943295 rad)"},
    {"об", "(6.283185307179586 rad)"},
    {"\u00b0С", "degC"},
    {"秒", "s"},
    {"毫秒", "ms"},
    {"微秒", "us"},
    {"牛", "N"},
    {"牛顿", "N"},
    {"千牛", "kN"},
    {"米", "m"},
    {"毫米", "mm"},
    {"微米", "um"},
    {"伏", "V"},
    {"毫伏", "mV"},
    {"帕", "Pa"},
    {"兆帕", "MPa"},
    {"赫兹", "Hz"},
}};

/// Words that are a mass to UDUNITS-2 and may mean its weight or an acceleration in a laboratory.
constexpr std::array<Replacement, 10> masses{{
    {"g", "gravity"},
    {"mg", "(1e-3 gravity)"},
    {"ug", "(1e-6 gravity)"},
    {"\u00b5g", "(1e-6 gravity)"},
    {"lb", "lbf"},
    {"pound", "lbf"},
    {"pounds", "lbf"},
    {"Pound", "lbf"},
    {"Pounds", "lbf"},
    {"POUNDS", "lbf"},
}};

/// Units to UDUNITS-2 (gravity, atto-cubic-centimetre, centi-hour), which head a column as names.
constexpr std::array<std::string_view, 3> names{"force", "acc", "ch"};

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Letters, and every byte of a character outside ASCII.
bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

/// "Force", "force (N)", which UDUNITS-2 would multiply.
bool begins_with_a_name(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && is_word(text[end])) ++end;
  const std::string_view first = text.substr(0, end);
  return std::ranges::any_of(names, [first](std::string_view name) {
    return std::ranges::equal(first, name, {}, [](unsigned char c) { return std::tolower(c); });
  });
}

/// "g-force", "G force": UDUNITS-2 reads grams of force.
bool is_g_force(std::string_view text) {
  std::string letters;
  for (const char c : text)
    if (c != '-' && c != '_' && !is_blank(c)) letters += static_cast<char>(std::tolower(c));
  return letters == "gforce" || letters == "gforces";
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

const Replacement* prefix_in(std::span<const Replacement> table, std::string_view text) {
  const auto found =
      std::ranges::find_if(table, [&](const auto& entry) { return text.starts_with(entry.from); });
  return found == table.end() ? nullptr : &*found;
}

/// "N" of a full-width one, which East Asian text may have (U+FF01 to U+FF5E).
std::optional<char> narrow_sign(std::string_view text) {
  if (text.size() < 3 || text[0] != '\xEF') return std::nullopt;
  const auto second = static_cast<unsigned char>(text[1]);
  const auto third = static_cast<unsigned char>(text[2]);
  const int code = (second & 0x3F) << 6 | (third & 0x3F);
  if ((second != 0xBC && second != 0xBD) || (third & 0xC0) != 0x80) return std::nullopt;
  constexpr int first = 0xF01, last = 0xF5E;
  return code >= first && code <= last ? std::optional(static_cast<char>(code - first + '!'))
                                       : std::nullopt;
}

std::string with_ascii_signs(std::string_view text) {
  std::string result;
  bool in_exponent = false;
  while (!text.empty()) {
    if (const auto narrow = narrow_sign(text)) {
      in_exponent = false;
      result += *narrow;
      text.remove_prefix(3);
      continue;
    }
    if (const Replacement* digit = prefix_in(superscripts, text)) {
      if (!in_exponent) result += '^';
      in_exponent = true;
      result += digit->to;
      text.remove_prefix(digit->from.size());
      continue;
    }
    in_exponent = false;
    const Replacement* sign = prefix_in(signs, text);
    result += sign != nullptr ? sign->to : text.substr(0, 1);
    text.remove_prefix(sign != nullptr ? sign->from.size() : 1);
  }
  return result;
}

std::string with_words_replaced(std::string_view text, std::span<const Replacement> table) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin;
    while (end < text.size() && is_word(text[end])) ++end;
    if (end == begin) {
      result += text[begin++];
      continue;
    }
    const std::string_view word = text.substr(begin, end - begin);
    const auto found = std::ranges::find(table, word, &Replacement::from);
    result += found == table.end() ? word : found->to;
    begin = end;
  }
  return result;
}

/// UDUNITS-2 takes "m^0.5" for "m^0 5", so an exponent with a decimal point must not reach it.
bool has_broken_exponent(std::string_view text) {
  for (std::size_t dot = 1; dot + 1 < text.size(); ++dot) {
    if (text[dot] != '.' || !is_digit(text[dot - 1]) || !is_digit(text[dot + 1])) continue;
    std::size_t start = dot;
    while (start > 0 && is_digit(text[start - 1])) --start;
    if (start > 0 && (text[start - 1] == '-' || text[start - 1] == '+')) --start;
    if (start == 0) continue;
    const char before = text[start - 1];
    if (is_word(before) || before == '^' || before == ')') return true;
  }
  return false;
}

/// "m/s 2" may mean a square as well as a factor.
bool has_number_inside(std::string_view text) {
  for (std::size_t i = 1; i + 1 < text.size(); ++i)
    if (is_blank(text[i]) && is_digit(text[i + 1])) return true;
  return false;
}

/// "m/s (rms)" without what stands in the last parentheses.
std::string_view without_comment(std::string_view text) {
  if (!text.ends_with(')')) return text;
  const std::size_t open = text.rfind('(');
  if (open == std::string_view::npos || open == 0 || !is_blank(text[open - 1])) return text;
  return trimmed(text.substr(0, open));
}

/// "N (2%)", "V(10 V)": UDUNITS-2 would multiply by what is a remark.
bool ends_with_a_number_in_parentheses(std::string_view text) {
  const std::size_t open = text.rfind('(');
  if (!text.ends_with(')') || open == text.npos || open == 0) return false;
  const std::string_view before = trimmed(text.substr(0, open));
  const std::size_t number = text.find_first_not_of(" +-.", open + 1);
  return !before.empty() &&
         (is_word(before.back()) || is_digit(before.back()) || before.back() == ')' ||
          before.back() == '%') &&
         is_digit(text[number]);
}

/// Parentheses, of which UDUNITS-2 passes over one too many.
bool are_paired(std::string_view text) {
  int depth = 0;
  for (const char c : text) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (depth < 0) return false;
  }
  return depth == 0;
}

/// "% mV/N": an uncertainty beside a unit, which UDUNITS-2 would multiply by a hundredth.
bool has_percent_of_a_unit(std::string_view text) {
  const std::size_t at = text.find('%');
  if (at == text.npos) return false;
  const std::string_view before = trimmed(text.substr(0, at)),
                         behind = trimmed(text.substr(at + 1));
  const bool divided = before.empty() ? behind.starts_with('/') : before.ends_with('/');
  return !divided && !(before.empty() && (behind.empty() || behind.starts_with('(')));
}

constexpr std::array<std::string_view, 6> times_signs{"\u00d7", "\u00b7", "\u22c5", "x", "X", "*"};

/// "10³" of "×10³" and "x 10³"; none where no number follows such a sign.
std::optional<std::string_view> after_times_sign(std::string_view text) {
  for (const std::string_view sign : times_signs) {
    if (!text.starts_with(sign)) continue;
    const std::string_view rest = trimmed(text.substr(sign.size()));
    if (!rest.empty() && is_digit(rest.front())) return rest;
  }
  return std::nullopt;
}

bool is_factor(std::string_view text) {
  const std::string plain = with_ascii_signs(text);
  return plain.find_first_not_of("0123456789.^*eE+-") == plain.npos;
}

/// A probe's or an amplifier's, which the numbers may have been divided by already.
bool may_be_a_gain(std::string_view factor) {
  return factor == "1" || factor == "10" || factor == "100";
}

/// "1000 N" of "N x 1000", "N (×1000)" and "x1000 N": the same text where nothing is multiplied,
/// none where "V (x10)" may be a gain.
std::string with_factor_first(std::string_view unit) {
  if (const auto rest = after_times_sign(unit)) return std::string(*rest);
  for (std::size_t at = 1; at < unit.size(); ++at) {
    const bool enclosed = unit[at] == '(' && unit.ends_with(')');
    if (!enclosed && !is_blank(unit[at])) continue;
    const std::string_view tail =
        trimmed(unit.substr(at + 1, unit.size() - at - 1 - (enclosed ? 1 : 0)));
    const auto factor = after_times_sign(tail);
    if (!factor || !is_factor(*factor)) continue;
    if (may_be_a_gain(*factor)) return {};
    return std::string(*factor) + " (" + std::string(trimmed(unit.substr(0, at))) + ")";
  }
  return std::string(unit);
}

/// "g" of "g pk", "g-pk" and "V rms".
std::string_view without_detector(std::string_view text) {
  for (const std::string_view word : {"rms", "RMS", "pk", "Pk", "peak", "Peak"}) {
    if (text.size() < word.size() + 2 || !text.ends_with(word)) continue;
    const std::string_view rest = text.substr(0, text.size() - word.size());
    if (is_blank(rest.back()) || rest.back() == '-' || rest.back() == '_')
      return trimmed(rest.substr(0, rest.size() - 1));
  }
  return text;
}

/// The unit in UDUNITS-2's spelling; empty where there is none that could be meant.
std::string normalised(std::string_view unit) {
  unit = trimmed(unit);
  if (unit.size() > 2 && unit.front() == '[' && unit.back() == ']')
    unit = trimmed(unit.substr(1, unit.size() - 2));
  const bool control = std::ranges::any_of(unit, [](unsigned char c) { return c < 0x20; });
  // '@' shifts the origin and "re" makes a level: neither is a unit a recording's numbers are in.
  if (unit.empty() || unit.size() > 200 || control || unit.find('@') != std::string_view::npos)
    return {};
  if (unit == "kg (kilo-g)" || unit == "kilo-g") return "(1000 gravity)";
  if (unit == "g's" || unit == "G's" || unit == "g\u2019s") return "gravity";
  std::string text = with_ascii_signs(with_factor_first(without_detector(unit)));
  if (is_g_force(text)) return "gravity";
  if (text == "ms-2" || text == "ms^-2") return "m.s-2";  // UDUNITS-2: per square millisecond
  if (text == "ms-1" || text == "ms^-1") return "m.s-1";  // UDUNITS-2: per millisecond
  return has_broken_exponent(text) || has_number_inside(text) ? std::string() : text;
}

}  // namespace

std::vector<std::string> spellings_of(std::string_view unit) {
  const std::string text = normalised(unit);
  std::vector<std::string> spellings;
  for (const std::string_view candidate : {std::string_view(text), without_comment(text)})
    if (!begins_with_a_name(candidate) && !ends_with_a_number_in_parentheses(candidate) &&
        !has_percent_of_a_unit(candidate) && are_paired(candidate))
      spellings.push_back(with_words_replaced(with_words_replaced(candidate, translations), words));
  return spellings;
}

std::string with_weights_for_masses(std::string_view spelling) {
  return with_words_replaced(spelling, masses);
}

std::string in_small_letters(std::string_view unit) {
  const auto is_small = [](char c) { return c >= 'a' && c <= 'z'; };
  if (unit.size() < 2 || unit == "NM" || std::ranges::any_of(unit, is_small)) return {};
  std::string text(unit);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text == unit ? std::string() : text;
}

bool is_strain(std::string_view unit) {
  static constexpr std::array<std::string_view, 8> ratios{"m/m",  "mm/m",  "um/m",  "\u00b5m/m",
                                                          "nm/m", "mm/mm", "in/in", "uin/in"};
  const std::string text =
      with_words_replaced(with_ascii_signs(without_comment(normalised(unit))), translations);
  if (std::ranges::find(ratios, text) != ratios.end()) return true;
  const auto word = std::ranges::find(words, text, &Replacement::from);
  return word != words.end() && (word->to == "1" || word->to == "1e-6");
}

}  // namespace impactrig::datasets
