// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/time_words.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

namespace impactrig::acquisition {
namespace {

constexpr auto of_seconds = std::to_array<std::string_view>(
    {"sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden", "seconde", "secondes",
     "secondo", "secondi", "segundo", "segundos", "s"});
constexpr auto of_minutes = std::to_array<std::string_view>(
    {"mins", "mn", "minute", "minutes", "minuten", "minuto", "minuti", "minutos"});
constexpr auto of_hours =
    std::to_array<std::string_view>({"hr", "hrs", "hour", "hours", "stunde", "stunden", "std",
                                     "heure", "heures", "ora", "ore", "hora", "horas"});

constexpr auto parts = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"milli", "ms"}, {"mili", "ms"}, {"mikro", "us"}, {"micro", "us"}, {"nano", "ns"}});
constexpr auto short_parts = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"m", "ms"}, {"u", "us"}, {"mu", "us"}, {"n", "ns"}});

bool holds(std::span<const std::string_view> words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

/// Ways to write a unit where it ends a name, without words that stand for something else there
/// ("min").
std::string short_unit(std::string_view text) {
  for (const std::string_view unit : {"s", "ms", "us", "ns", "\u00b5s", "\u03bcs"})
    if (text == unit) return std::string(text);
  const std::string small = lowered(text);
  const bool in_words =
      small == "mus" || small.find("sec") != small.npos || small.find("sek") != small.npos;
  return in_words ? unit_of_time_in_words(text) : std::string();
}

/// Whether a word of the name says that it is a time: "Messzeit", "sample time", "t".
bool speaks_of_time(std::string_view name) {
  if (is_time_name(name)) return true;
  const std::string small = lowered(name);
  constexpr auto words = std::to_array<std::string_view>(
      {"time", "zeit", "temps", "tempo", "tiempo", "elapsed", "duration", "dauer"});
  for (const std::string_view word : words) {
    const std::size_t at = small.find(word);
    if (at == small.npos) continue;
    const std::size_t end = at + word.size();
    const auto is_letter = [&](std::size_t i) { return small[i] >= 'a' && small[i] <= 'z'; };
    if (word == "zeit" || at == 0 || end == small.size() || !is_letter(at - 1) || !is_letter(end))
      return true;
  }
  return false;
}

/// "Zeit" of "Zeit_in" and "time" of "time_": what stands before the unit.
std::string_view without_link(std::string_view name) {
  constexpr std::string_view marks = " _.-";
  const auto cut = [&] {
    while (!name.empty() && marks.find(name.back()) != marks.npos) name.remove_suffix(1);
  };
  cut();
  if (name.size() > 3 && name.ends_with("in") && marks.find(name[name.size() - 3]) != marks.npos)
    name.remove_suffix(2);
  cut();
  return name;
}

}  // namespace

std::string unit_of_time_in_words(std::string_view text) {
  const std::string small = lowered(text);
  for (const std::string_view unit : {"ms", "us", "ns"})
    if (small == unit) return small;
  if (text == "\u00b5S" || text == "\u03bcS") return "us";
  if (small == "millis") return "ms";
  if (small == "micros") return "us";
  if (holds(of_seconds, small)) return "s";
  if (holds(of_minutes, small)) return "min";
  if (holds(of_hours, small)) return "h";
  const std::string_view word = small;
  for (const auto& [part, unit] : parts)
    if (word.starts_with(part) && holds(of_seconds, word.substr(part.size())))
      return std::string(unit);
  for (const auto& [part, unit] : short_parts)
    if (word.starts_with(part) && word.size() <= part.size() + 4 &&
        holds(of_seconds, word.substr(part.size())))
      return std::string(unit);
  return {};
}

std::string unit_named(std::string_view name) {
  constexpr std::size_t shortest = 4;
  const std::string small = lowered(name);
  const bool may_be_another = small == "second" || small == "seconde" || small == "secondo" ||
                              small == "segundo" || small == "minute" || small == "hour" ||
                              small == "minuto" || small == "hora" || small == "heure";
  return small.size() < shortest || may_be_another ? std::string() : unit_of_time_in_words(name);
}

std::optional<ColumnHead> time_with_unit_at_end(std::string_view text) {
  for (const std::string_view end : {"_rel", "_abs"})
    if (text.ends_with(end))
      if (auto divided = time_with_unit_at_end(text.substr(0, text.size() - end.size()))) {
        divided->name += end;
        return divided;
      }
  const std::size_t mark = text.find_last_of(" _.-");
  if (mark != text.npos && mark > 0) {
    const std::string unit = short_unit(text.substr(mark + 1));
    const std::string_view name = without_link(text.substr(0, mark));
    const bool is_axis = lowered(name) == "x" && unit != "s";
    if (unit.empty() || !(speaks_of_time(name) || is_axis)) return std::nullopt;
    return ColumnHead{to_utf8(name), unit, ""};
  }
  for (const std::string_view unit : {"Ms", "Us", "Ns", "Sec", "Millis", "Micros"}) {
    if (!text.ends_with(unit)) continue;
    const std::string_view name = text.substr(0, text.size() - unit.size());
    if (is_time_name(name)) return ColumnHead{to_utf8(name), unit_of_time_in_words(unit), ""};
  }
  return std::nullopt;
}

bool counts_no_time(std::string_view unit) {
  constexpr auto words = std::to_array<std::string_view>(
      {"samples", "sample", "ticks", "tick", "frames", "frame", "cycles", "steps", "clk", "counts",
       "points", "a.u.", "pts"});
  return holds(words, lowered(unit));
}

}  // namespace impactrig::acquisition
