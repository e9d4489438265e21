// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/row_of_units.hpp"
#include "acquisition/importers/time_words.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Quantity;

namespace {

/// A unit that stands for nothing else behind "in", a dash, a comma, a slash: "C" may be a channel.
bool is_plain_unit(std::string_view text) {
  constexpr std::string_view letters = "sNVgmA";
  if (text.size() == 1) return letters.find(text.front()) != std::string_view::npos;
  const Quantity quantity = datasets::quantity_of_unit(to_utf8(text));
  return quantity != Quantity::unknown && quantity != Quantity::other;
}

struct QuantityWord {
  std::string_view word;
  Quantity quantity;
};

constexpr auto quantity_words = std::to_array<QuantityWord>({
    {"f", Quantity::force},
    {"force", Quantity::force},
    {"load", Quantity::force},
    {"kraft", Quantity::force},
    {"v", Quantity::velocity},
    {"vel", Quantity::velocity},
    {"velocity", Quantity::velocity},
    {"speed", Quantity::velocity},
    {"geschwindigkeit", Quantity::velocity},
    {"x", Quantity::displacement},
    {"disp", Quantity::displacement},
    {"displacement", Quantity::displacement},
    {"deflection", Quantity::displacement},
    {"weg", Quantity::displacement},
    {"a", Quantity::acceleration},
    {"acc", Quantity::acceleration},
    {"accel", Quantity::acceleration},
    {"acceleration", Quantity::acceleration},
    {"beschleunigung", Quantity::acceleration},
});

/// "N" of "Force_N" and "mm/s" of "velocity_tip_mm_s", which is no valid name elsewhere: what
/// begins with the word of a quantity and ends with a unit of it. "" where it does not.
std::string unit_of_name(std::string_view text) {
  constexpr std::size_t longest = 100;
  if (text.size() > longest) return {};
  const Quantity quantity = quantity_of_first_word(text);
  if (quantity == Quantity::unknown) return {};
  for (std::size_t line = text.find('_'); line != text.npos; line = text.find('_', line + 1)) {
    std::string unit(text.substr(line + 1));
    std::ranges::replace(unit, '_', '/');
    if (datasets::quantity_of_unit(unit) == quantity) return unit;
  }
  return {};
}

/// "m/s" of "v_m/s" and "N/mm" of "load_N/mm", where the slash divides a unit; "" of others.
std::string unit_behind_a_line(std::string_view text, std::size_t slash) {
  const std::size_t line = text.rfind('_', slash);
  if (line == text.npos || line == 0) return {};
  const std::string_view unit = text.substr(line + 1);
  const bool divides = is_plain_unit(text.substr(line + 1, slash - line - 1)) && is_unit(unit);
  return divides ? to_utf8(unit) : std::string();
}

/// "[ms]" and "(kN)": a unit alone.
std::optional<std::string> unit_alone(std::string_view text) {
  if (text.size() < 3) return std::nullopt;
  const bool brackets =
      (text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')');
  const std::string_view unit = trimmed(text.substr(1, text.size() - 2));
  if (!brackets || unit.find_first_of("[]()") != unit.npos || integer_in(unit)) return std::nullopt;
  return is_plain_unit(unit) ? std::optional(to_utf8(unit)) : std::nullopt;
}

/// "msec" of "msec.", where only that is a unit.
std::string_view without_full_stop(std::string_view unit) {
  if (!unit.ends_with('.') || is_unit(unit)) return unit;
  const std::string_view rest = unit.substr(0, unit.size() - 1);
  return is_unit(rest) ? rest : unit;
}

/// "Time in ms", "Time - ms", "Time, ms", "t/ms", "v/mm/s", "rate 1/s", and of times "Time_ms".
std::optional<ColumnHead> unit_behind_a_word(std::string_view text) {
  const auto divided = [text](std::size_t name, std::size_t unit) {
    return ColumnHead{to_utf8(trimmed(text.substr(0, name))), to_utf8(trimmed(text.substr(unit))),
                      ""};
  };
  if (text.starts_with("in ") && is_plain_unit(text.substr(3))) return divided(0, 3);
  for (const std::string_view word : {" in ", " - ", ", "}) {
    const std::size_t at = text.rfind(word);
    if (at == std::string_view::npos || at == 0) continue;
    const std::string_view unit = trimmed(text.substr(at + word.size()));
    if (is_plain_unit(unit) || (unit.find('/') != unit.npos && is_unit(unit)))
      return divided(at, at + word.size());
  }
  // "strain rate 1/s" is no time; "Force 1/N" and "Time 1/s" are the first of several
  const std::size_t one = text.rfind(" 1/");
  if (one != std::string_view::npos && one > 0 && !is_time_name(text.substr(0, one)) &&
      datasets::quantity_of_unit(to_utf8(text.substr(one + 3))) == Quantity::time)
    return divided(one, one + 1);
  const std::size_t colon = text.find(':');  // "Vel:m/s", but no "Channel:A" and no "Force:min"
  if (colon != text.npos && colon > 0) {
    constexpr auto plain = std::to_array<std::string_view>(
        {"N", "kN", "mN", "V", "mV", "kV", "Pa", "kPa", "MPa", "mm", "ms", "us", "Hz", "kHz"});
    const std::string_view unit = trimmed(text.substr(colon + 1));
    if (std::ranges::find(plain, unit) != plain.end() ||
        (unit.find('/') != unit.npos && is_plain_unit(unit)))
      return divided(colon, colon + 1);
  }
  const std::size_t slash = text.find('/');
  if (slash != text.npos)
    if (std::string unit = unit_behind_a_line(text, slash); !unit.empty())
      return ColumnHead{to_utf8(text), std::move(unit), ""};
  // "m/s" and "mV/g" are units, "t/ms" is a time though it could be tonnes
  if (slash != std::string_view::npos && slash > 0 && !is_plain_unit(text) &&
      !is_plain_unit(text.substr(0, slash)) && is_plain_unit(text.substr(slash + 1)))
    return divided(slash, slash + 1);
  const std::size_t blank = text.rfind(' ');  // "Time ms"
  if (blank != std::string_view::npos && is_time_name(trimmed(text.substr(0, blank))) &&
      datasets::quantity_of_unit(to_utf8(text.substr(blank + 1))) == Quantity::time)
    return divided(blank, blank + 1);
  const std::size_t line = text.rfind('_');
  constexpr std::array<std::string_view, 6> times = {"time", "t",       "timestamp",
                                                     "zeit", "elapsed", "elapsed_time"};
  if (line != text.npos && std::ranges::find(times, lowered(text.substr(0, line))) != times.end() &&
      (datasets::quantity_of_unit(to_utf8(text.substr(line + 1))) == Quantity::time ||
       !unit_of_time_in_words(text.substr(line + 1)).empty()))
    return divided(line, line + 1);
  return time_with_unit_at_end(text);
}

/// "mm" of "in mm", which UDUNITS-2 would multiply by an inch; "in lbf" is a torque.
std::string_view without_in(std::string_view unit) {
  if (!unit.starts_with("in ")) return unit;
  const std::string_view rest = trimmed(unit.substr(3));
  const Quantity quantity = datasets::quantity_of_unit(to_utf8(rest));
  const bool newtons = quantity == Quantity::force && rest.ends_with('N');
  const bool metric = quantity == Quantity::displacement || quantity == Quantity::time ||
                      quantity == Quantity::velocity || quantity == Quantity::acceleration ||
                      quantity == Quantity::voltage;
  return newtons || metric ? rest : unit;
}

/// "0-0", "1,2", "Ch 1": what tells a column from others of its name.
bool are_indices(std::string_view text) {
  const bool numbers = text.find_first_of("0123456789") != text.npos &&
                       text.find_first_not_of("0123456789-,:; ") == text.npos;
  const std::string word = lowered(text);
  const bool input = word.starts_with("ch ") || word.starts_with("ch.") ||
                     ((word.starts_with("ch") || word.starts_with("ai")) &&
                      integer_in(trimmed(text.substr(2))).has_value());
  return (numbers && !integer_in(text) && !text.starts_with("10-")) || (input && !is_unit(text));
}

/// "200g", "10 V", "±50 g", "5 kHz", "10%": a range or a limit, for a unit by which one counts has
/// no number before it but a power of ten, written as one, or a part ("0.1 mm").
bool is_range(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" +-<>~"), text.size()));
  if (text.starts_with("\u00b1")) text.remove_prefix(2);
  double number = 0.0;
  const char* const last = text.data() + text.size();
  const char* const end = scan_number(text.data(), last, {'.', false}, number);
  const std::string_view digits(text.data(), static_cast<std::size_t>(end - text.data()));
  const std::string_view unit = trimmed({end, static_cast<std::size_t>(last - end)});
  if (digits.empty() || number < 2.0 || digits.find_first_of("eE") != digits.npos) return false;
  return unit == "%" ||
         (!unit.empty() && unit.find_first_of("^*+-/.0123456789") != 0 && is_unit(unit));
}

/// "Time (ms) Run #1", "Force [N] - Plot 0", "Time [ms].1", "acc (g) [Ch 1]": a unit in brackets
/// that something else follows, which is part of the name.
std::optional<ColumnHead> unit_before_a_suffix(std::string_view text) {
  const std::size_t end = text.find_last_of(")]", text.find_last_not_of(")]"));
  const std::size_t last_open = text.ends_with(']') ? text.rfind('[') : text.npos;
  const bool by_index =
      last_open != text.npos &&
      (are_indices(trimmed(text.substr(last_open + 1, text.size() - last_open - 2))) ||
       trimmed(text.substr(0, last_open)).ends_with(')'));
  const std::size_t close = by_index ? text.find_last_of(")]", text.rfind('[')) : end;
  if (close == text.npos || close + 1 == text.size()) return std::nullopt;
  const std::size_t open = text.rfind(text[close] == ')' ? '(' : '[', close);
  if (open == text.npos || open == 0) return std::nullopt;
  const std::string_view unit = without_in(trimmed(text.substr(open + 1, close - open - 1)));
  if (is_range(unit)) return std::nullopt;
  const Quantity quantity = datasets::quantity_of_unit(to_utf8(unit));
  constexpr std::string_view letters = "sNVgm";  // others tell one column from the next
  const bool letter = unit.size() == 1 && letters.find(unit.front()) == letters.npos;
  if (quantity == Quantity::unknown || integer_in(unit) || letter) return std::nullopt;
  const std::string_view suffix = text.substr(close + 1);
  const bool apart = suffix.front() == ' ' || suffix.front() == '*' || suffix.front() == '.' ||
                     suffix.front() == '_' || suffix.front() == '[' || suffix.front() == '(';
  if (!apart) return std::nullopt;
  return ColumnHead{to_utf8(trimmed(text.substr(0, open))) + to_utf8(suffix), to_utf8(unit), ""};
}

/// "时间(s)" of "时间（s）", whose brackets East Asian text has twice as wide.
std::string with_narrow_brackets(std::string_view cell) {
  constexpr std::array<std::pair<std::string_view, char>, 6> brackets = {{{"\uFF08", '('},
                                                                          {"\uFF09", ')'},
                                                                          {"\uFF3B", '['},
                                                                          {"\uFF3D", ']'},
                                                                          {"\u3010", '['},
                                                                          {"\u3011", ']'}}};
  std::string text(cell);
  for (const auto& [wide, narrow] : brackets)
    for (std::size_t at = text.find(wide); at != text.npos; at = text.find(wide, at))
      text.replace(at, wide.size(), 1, narrow);
  return text;
}

/// "Force_N" of MATLAB's "Force_N_" and R's "Force..N.", who write so for "Force (N)"; "" of
/// others.
std::string without_marks_at_end(std::string_view text) {
  if (!text.ends_with('_') && !text.ends_with('.')) return {};
  std::string result;
  for (const char c : text) {
    const char mark = c == '.' ? '_' : c;
    if (mark != '_' || (!result.empty() && result.back() != '_')) result += mark;
  }
  if (!result.empty()) result.pop_back();
  return result;
}

/// What is left of a mu in another code page, or where a program had no letter for it.
constexpr auto spoilt_mu =
    std::to_array<std::string_view>({"?", "\uFFFD", "\u00C2\u00B5", "\u00C2\u03BC", "\u00CE\u00BC",
                                     "\u00E6", "\u00EF\u00BF\u00BD"});

/// What stood within quotes, as RFC 4180 has it: doubled quotes stand for one; breaks become
/// blanks.
std::string one_line(std::string_view cell) {
  std::string text;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const bool breaks = cell[i] == '\r' || cell[i] == '\n';
    if (cell.substr(i, 2) == "\"\"") ++i;
    if (!breaks)
      text += cell[i];
    else if (!text.empty() && text.back() != ' ')
      text += ' ';
  }
  return text;
}

}  // namespace

std::string with_mu(const std::string& unit) {
  constexpr std::string_view mended_units = "smVNgA";  // "?C" and "?F" may be degrees
  for (const std::string_view letter : spoilt_mu)
    if (unit.starts_with(letter) && unit.size() > letter.size() &&
        mended_units.find(unit[letter.size()]) != mended_units.npos)
      if (std::string mended = "\u00B5" + unit.substr(letter.size());
          mended.size() > 2 && is_unit(mended))
        return mended;
  return unit;
}

std::string spoilt_unit(std::string_view text, const std::string& unit) {
  if (!unit.starts_with("\u00B5")) return {};
  const std::string written = to_utf8(text);
  for (const std::string_view letter : spoilt_mu)
    if (std::string spoilt = std::string(letter) + unit.substr(2);
        written.find(spoilt) != written.npos)
      return spoilt;
  return {};
}

Quantity quantity_of_first_word(std::string_view text) {
  const std::string name = lowered(text);
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto letters = std::ranges::find_if_not(name, is_letter) - name.begin();
  const std::string_view first =
      std::string_view(name).substr(0, static_cast<std::size_t>(letters));
  const auto word = std::ranges::find(quantity_words, first, &QuantityWord::word);
  return word == quantity_words.end() ? Quantity::unknown : word->quantity;
}

std::string_view without_channel(std::string_view value) {
  const std::size_t colon = value.find(':');
  const bool is_channel =
      colon != std::string_view::npos &&
      (value.substr(0, colon) == "Analog" ||
       (value.starts_with("CH") && integer_in(value.substr(2, colon - 2)).has_value()));
  return is_channel ? trimmed(value.substr(colon + 1)) : value;
}

bool is_time_name(std::string_view name) {
  constexpr auto words = std::to_array<std::string_view>(
      {"time",          "t",         "zeit",      "temps",        "tiempo",   "tempo",
       "seconds",       "second",    "x-axis",    "elapsed",      "x_time",   "time_s",
       "time stamp",    "timestamp", "x [s]",     "elapsed time", "czas",     "tijd",
       "relative time", "rel time",  "rel. time", "tid",          "aika",     "čas",
       "running time",  "run time",  "test time", "time elapsed", "uptime",   "laufzeit",
       "elapsed_time",  "time axis", "idő",       "zaman",        "время",    "Время",
       "时间",          "時間",      "时刻",      "時刻",         "经过时间", "経過時間",
       "시간"});
  return std::find(words.begin(), words.end(), lowered(name)) != words.end();
}

std::string lowered(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

namespace {

/// Where the bracket opens that ends a text, those between apart: "(m/(s^2))". The last one where
/// they do not pair.
std::size_t opening_of_last(std::string_view text) {
  const char close = text.back(), open = close == ']' ? '[' : '(';
  int depth = 0;
  for (std::size_t i = text.size(); i-- > 0;) {
    depth += text[i] == close ? 1 : text[i] == open ? -1 : 0;
    if (depth == 0) return i;
  }
  return text.rfind(open);
}

/// "m/" of "m/(s^2)" is no name.
bool is_open_product(std::string_view text) {
  return !text.empty() && std::string_view("/*^").find(text.back()) != text.npos;
}

/// "F (N)", "t [s]": a text that ends in a bracket.
ColumnHead unit_in_brackets(std::string_view text) {
  ColumnHead head;
  head.name = to_utf8(text);
  const char close = text.back();
  const std::size_t open = opening_of_last(text);
  if (is_open_product(text.substr(0, open))) {
    head.unit = unit_of_name(text);
    return head;
  }
  if (open != std::string_view::npos && open > 0) {
    const std::string_view unit =
        without_full_stop(without_in(trimmed(text.substr(open + 1, text.size() - open - 2))));
    const auto index = close == ']' ? integer_in(unit) : std::nullopt;  // "Y[0]"; "strain [1]"
    const bool counts = index && (index != 1 || text[open - 1] != ' ');
    const bool of_time = text.substr(open) == "(t)" && text[open - 1] != ' ';  // "Y(t)"
    // "F (N) (10 V)", "F (N) (A)"
    const bool ticks = is_time_name(trimmed(text.substr(0, open)));  // "Time (10 us)"
    const bool range = !ticks && is_range(unit);
    const char last = trimmed(text.substr(0, open)).back();
    const bool input = close == ']' && last == ')' && !is_unit(unit);
    if ((close == ')' && (last == ')' || last == ']')) || range || input)
      if (const auto before = unit_before_a_suffix(text)) return *before;
    if (range) return head;
    const std::string mended = with_mu(to_utf8(unit));
    const bool counted = ticks && (!unit_of_time_in_words(unit).empty() || counts_no_time(unit));
    if (close == ']' ? !counts && !are_indices(unit) : (is_unit(mended) || counted) && !of_time) {
      std::string_view name = trimmed(text.substr(0, open));
      if (name.ends_with(" /")) name = trimmed(name.substr(0, name.size() - 1));  // DIN 461
      head.name = to_utf8(name);
      head.unit = mended;
      constexpr std::string_view no_break = "\u00A0";
      if (head.name.ends_with(no_break)) head.name.resize(head.name.size() - no_break.size());
      return head;
    }
  }
  return unit_before_a_suffix(text).value_or(head);
}

/// split_head() by letters and brackets alone.
ColumnHead divided_head(std::string_view cell) {
  std::string_view text = trimmed(cell);
  while (text.size() > 1 && std::string_view(",;:").find(text.back()) != text.npos)
    text = trimmed(text.substr(0, text.size() - 1));
  ColumnHead head;
  head.name = to_utf8(text);
  if (text.empty()) return head;
  if (const std::string narrow = with_narrow_brackets(text); narrow != text) {
    const ColumnHead divided = divided_head(narrow);
    return divided.unit.empty() ? head : divided;
  }
  if (const auto unit = unit_alone(text)) return {"", *unit, ""};
  if (text.back() == '}' && text.find('{') != text.npos && text.find('{') > 0) {
    const std::size_t open = text.rfind('{');
    const std::string_view unit = trimmed(text.substr(open + 1, text.size() - open - 2));
    if (is_unit(unit) && !integer_in(unit))  // "data{1}" is the first of several
      return {to_utf8(trimmed(text.substr(0, open))), to_utf8(unit), ""};
  }
  if (text.back() == ']' || text.back() == ')') return unit_in_brackets(text);
  const std::size_t slash = text.rfind(" / ");  // as DIN 461 labels an axis: t / s
  if (slash != std::string_view::npos && is_unit(text.substr(slash + 3))) {
    head.name = to_utf8(trimmed(text.substr(0, slash)));
    head.unit = to_utf8(trimmed(text.substr(slash + 3)));
    return head;
  }
  if (const auto divided = unit_behind_a_word(text)) return *divided;
  if (const auto divided = unit_before_a_suffix(text)) return *divided;
  if (const std::string spelt = without_marks_at_end(text); !spelt.empty()) {
    if (ColumnHead divided = unit_behind_a_word(spelt).value_or(ColumnHead{});
        is_time_name(divided.name))
      return divided;
    head.unit = unit_of_name(spelt);
    return head;
  }
  head.unit = unit_of_name(text);
  return head;
}

}  // namespace

ColumnHead split_head(std::string_view cell) {
  if (cell.find_first_of("\r\n") != cell.npos || cell.find("\"\"") != cell.npos)
    return split_head(one_line(cell));
  ColumnHead head = divided_head(cell);
  if (is_time_name(head.name) && datasets::quantity_of_unit(head.unit) != Quantity::time)
    if (std::string unit = unit_of_time_in_words(head.unit); !unit.empty())
      head.unit = std::move(unit);
  if (head.unit.empty()) head.unit = unit_named(head.name);
  return head;
}

}  // namespace impactrig::acquisition
