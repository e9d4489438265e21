// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/date_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "acquisition/importers/number.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t hour = 3600 * second;
constexpr std::int64_t day = 24 * hour;

bool is_letter(char c) {
  const char lower = static_cast<char>(c | 0x20);
  return lower >= 'a' && lower <= 'z';
}

/// Reads a text from the left. What does not match leaves it where it was.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  bool at_end() const { return text_.empty(); }

  bool take(char c) {
    if (!text_.starts_with(c)) return false;
    text_.remove_prefix(1);
    return true;
  }

  /// Any number of these.
  bool take_any(std::string_view letters) {
    const std::size_t size = std::min(text_.find_first_not_of(letters), text_.size());
    text_.remove_prefix(size);
    return size > 0;
  }

  /// A whole number of at most `most` digits.
  struct Digits {
    int value = 0;
    std::size_t count = 0;
  };

  std::optional<Digits> take_digits(std::size_t most) {
    Digits digits;
    while (digits.count < text_.size() && detail::is_digit(text_[digits.count])) {
      if (digits.count == most) return std::nullopt;
      digits.value = 10 * digits.value + (text_[digits.count++] - '0');
    }
    if (digits.count == 0) return std::nullopt;
    text_.remove_prefix(digits.count);
    return digits;
  }

  /// The digits of a fraction of a second, to the nearest nanosecond.
  std::optional<std::int64_t> take_fraction() {
    std::int64_t nanoseconds = 0;
    std::size_t count = 0;
    for (; count < text_.size() && detail::is_digit(text_[count]); ++count) {
      const int digit = text_[count] - '0';
      if (count < 9) nanoseconds = 10 * nanoseconds + digit;
      if (count == 9 && digit >= 5) ++nanoseconds;
    }
    if (count == 0) return std::nullopt;
    for (std::size_t k = count; k < 9; ++k) nanoseconds *= 10;
    text_.remove_prefix(count);
    return nanoseconds;
  }

  /// Letters, in lower case.
  std::string take_word() {
    std::string word;
    while (word.size() < text_.size() && is_letter(text_[word.size()]))
      word += static_cast<char>(text_[word.size()] | 0x20);
    text_.remove_prefix(word.size());
    return word;
  }

 private:
  std::string_view text_;
};

/// 1 to 12 for an English month or its first three letters; 0 for anything else.
int month_named(std::string_view word) {
  constexpr std::array<std::string_view, 12> months = {
      "january", "february", "march",     "april",   "may",      "june",
      "july",    "august",   "september", "october", "november", "december"};
  for (std::size_t i = 0; i < months.size(); ++i)
    if (word == months[i] || word == months[i].substr(0, 3)) return static_cast<int>(i) + 1;
  return 0;
}

std::optional<std::int32_t> days_to(int year, int month, int day_of_month) {
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day_of_month))};
  if (month < 1 || day_of_month < 1 || !date.ok()) return std::nullopt;
  return static_cast<std::int32_t>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// Of two digits: 1970 to 2069.
int full_year(Scanner::Digits year) {
  return year.count > 2 ? year.value : year.value + (year.value < 70 ? 2000 : 1900);
}

/// "01-Mar-2024", "1 March 24", "Mar 1, 2024".
bool take_date_with_month(Scanner& scan, DateTime& found) {
  Scanner ahead = scan;
  std::optional<Scanner::Digits> date = ahead.take_digits(2);
  if (date && !ahead.take_any("-/. ")) return false;
  const int month = month_named(ahead.take_word());
  if (month == 0) return false;
  ahead.take('.');
  if (!date) {
    ahead.take_any(" ");
    date = ahead.take_digits(2);
    if (!date || !ahead.take_any(", ")) return false;
  } else if (!ahead.take_any("-/. ")) {
    return false;
  }
  const auto year = ahead.take_digits(4);
  if (!year || year->count % 2 != 0) return false;
  const auto days = days_to(full_year(*year), month, date->value);
  if (!days) return false;
  found.date = {date->value, month, year->value};
  found.days = {days, days};
  scan = ahead;
  return true;
}

/// "20240301T120000.5", "20240301T1200": the basic format of ISO 8601.
bool take_basic_date_and_time(Scanner& scan, DateTime& found) {
  Scanner ahead = scan;
  const auto date = ahead.take_digits(8);
  if (!date || date->count != 8 || !ahead.take('T')) return false;
  const auto time = ahead.take_digits(6);
  if (!time || time->count % 2 != 0 || time->count < 4) return false;
  const int of_day = time->count == 6 ? time->value : time->value * 100;
  const int hours = of_day / 10000, minutes = of_day / 100 % 100, seconds = of_day % 100;
  found.date = {date->value / 10000, date->value / 100 % 100, date->value % 100};
  found.days.fill(days_to(found.date[0], found.date[1], found.date[2]));
  if (!found.days[0] || hours > 24 || minutes > 59 || seconds > 60) return false;
  found.nanoseconds = (hours * 3600 + minutes * 60 + seconds) * second;
  if (time->count == 6 && (ahead.take('.') || ahead.take(','))) {
    const auto fraction = ahead.take_fraction();
    if (!fraction) return false;
    found.nanoseconds += *fraction;
  }
  found.has_date = found.has_time = true;
  found.period = day;
  scan = ahead;
  return true;
}

/// "0.5 sec", "-2 min", "1e-05 sec" and "0.1 hr", as MATLAB writes durations, and other units.
std::optional<DateTime> duration_in(std::string_view text) {
  struct Unit {
    std::string_view word;
    double seconds;
  };

  constexpr auto units = std::to_array<Unit>({{"sec", 1.0},
                                              {"s", 1.0},
                                              {"min", 60.0},
                                              {"hr", 3600.0},
                                              {"h", 3600.0},
                                              {"days", 86400.0},
                                              {"ms", 1e-3},
                                              {"us", 1e-6}});
  constexpr double longest = 1e9;  // [s]; nanoseconds count to nine times that
  text = trimmed(text);
  if (text.size() > 1 && text.starts_with('"') && text.ends_with('"'))
    text = trimmed(text.substr(1, text.size() - 2));
  double number = 0.0;
  const char* const last = text.data() + text.size();
  const char* const end = scan_number(text.data(), last, {'.', false}, number);
  const std::string_view rest(end, static_cast<std::size_t>(last - end));
  if (end == text.data() || !rest.starts_with(' ')) return std::nullopt;
  const auto unit = std::ranges::find(units, rest.substr(1), &Unit::word);
  if (unit == units.end() || !(std::abs(number * unit->seconds) < longest)) return std::nullopt;
  DateTime found;
  found.has_time = found.elapsed = true;
  found.nanoseconds = std::llround(number * unit->seconds * static_cast<double>(second));
  return found;
}

bool take_date_of_numbers(Scanner& scan, DateTime& found) {
  Scanner ahead = scan;
  const auto first = ahead.take_digits(4);
  if (!first) return false;
  char mark = 0;
  for (const char c : {'-', '/', '.'})
    if (mark == 0 && ahead.take(c)) mark = c;
  const auto middle = ahead.take_digits(2);
  if (mark == 0 || !middle || !ahead.take(mark)) return false;
  const auto last = ahead.take_digits(4);
  if (!last) return false;
  const bool short_year = first->count <= 2 && last->count == 2;
  if (first->count == 4 && last->count <= 2) {
    found.days.fill(days_to(first->value, middle->value, last->value));
  } else if (first->count <= 2 && (last->count == 4 || (short_year && mark == '.'))) {
    found.days[0] = days_to(full_year(*last), middle->value, first->value);
    found.days[1] = mark == '.' ? found.days[0] : days_to(last->value, first->value, middle->value);
  } else if (!short_year) {
    return false;
  }
  const bool any_year = short_year && mark != '.';  // "24-03-01": which is the year is open
  if (!any_year && !found.days[0] && !found.days[1]) return false;
  found.date = {first->value, middle->value, last->value};
  scan = ahead;
  return true;
}

/// "Z", "UTC", "+01:00", "+0100", "-5".
bool take_zone(Scanner& scan, DateTime& found) {
  Scanner ahead = scan;
  ahead.take_any(" ");
  const std::string word = ahead.take_word();
  if (word == "z" || word == "utc" || word == "gmt") {
    found.zone = 0;
    scan = ahead;
    return true;
  }
  if (!word.empty()) return false;
  const bool west = ahead.take('-');
  if (!west && !ahead.take('+')) return false;
  const auto hours = ahead.take_digits(4);
  if (!hours || hours->count == 3) return false;
  int minutes =
      hours->count == 4 ? hours->value / 100 * 60 + hours->value % 100 : hours->value * 60;
  if (hours->count <= 2 && ahead.take(':')) {
    const auto more = ahead.take_digits(2);
    if (!more || more->count != 2 || more->value > 59) return false;
    minutes += more->value;
  }
  if (minutes > 14 * 60) return false;
  found.zone = west ? -minutes : minutes;
  scan = ahead;
  return true;
}

/// The hour by "AM" or "PM" behind the time. False for 0 PM and 13 AM.
bool take_half_of_day(Scanner& scan, int& hours) {
  Scanner ahead = scan;
  ahead.take_any(" \t\",;|");
  std::string word;
  for (int k = 0; k < 2; ++k) {  // "p.m."
    word += ahead.take_word();
    if (word == "a" || word == "p") ahead.take('.');
  }
  if (word != "am" && word != "pm") return true;
  ahead.take('.');
  if (hours < 1 || hours > 12) return false;
  hours = hours % 12 + (word == "pm" ? 12 : 0);
  scan = ahead;
  return true;
}

/// "12:00:00.5", "12:00:00,5", "12:00:00:500", "1:00:00 PM"; "30:15.3"; beside a date "12:00".
bool take_time(Scanner& scan, DateTime& found) {
  Scanner ahead = scan;
  const auto first = ahead.take_digits(4);
  if (!first || !ahead.take(':')) return false;
  const auto next = ahead.take_digits(2);
  if (!next || next->count != 2 || next->value > 59) return false;
  int seconds = 0;
  const bool has_seconds = ahead.take(':');
  if (has_seconds) {
    const auto last = ahead.take_digits(2);
    if (!last || last->count != 2 || last->value > 60) return false;
    seconds = last->value;
  }
  std::optional<std::int64_t> fraction;
  Scanner behind = ahead;
  if (behind.take('.') || behind.take(',')) {
    fraction = behind.take_fraction();
  } else if (has_seconds && behind.take(':')) {
    const auto parts = behind.take_digits(9);  // milli-, micro- or nanoseconds
    if (!parts || parts->count % 3 != 0) return false;
    std::int64_t nanoseconds = parts->value;
    for (std::size_t digits = parts->count; digits < 9; ++digits) nanoseconds *= 10;
    fraction = nanoseconds;
  }
  if (fraction) ahead = behind;
  int hours = first->value;
  int minutes = next->value;
  const bool from_minutes = fraction && !has_seconds;  // a fraction belongs to seconds
  if (from_minutes) {
    if (first->value > 59) return false;
    seconds = std::exchange(minutes, std::exchange(hours, 0));
  } else if (!has_seconds && !found.has_date) {
    return false;
  }
  if (!from_minutes && !take_half_of_day(ahead, hours)) return false;
  found.nanoseconds = (hours * 3600 + minutes * 60 + seconds) * second + fraction.value_or(0);
  found.period = from_minutes ? hour : hours < 24 ? day : 0;
  scan = ahead;
  return true;
}

/// Of two dates as they stand. Where both numbers may be the month, it is the one that stays: no
/// recording takes a row each month.
std::optional<std::int64_t> days_between(const DateTime& from, const DateTime& to) {
  constexpr std::int64_t within_month = 11;  // of days up to the 12th
  std::optional<std::int64_t> days;
  for (const std::size_t order : {0U, 1U}) {
    if (!from.days[order] || !to.days[order]) continue;
    const std::int64_t found = *to.days[order] - *from.days[order];
    if (days && *days != found && std::min(std::abs(*days), std::abs(found)) > within_month)
      return std::nullopt;
    if (!days || std::abs(found) < std::abs(*days)) days = found;
  }
  return days;
}

/// Of a hyphen or a minus sign that a text begins with.
std::size_t length_of_minus(std::string_view text) {
  constexpr std::string_view minus = "\u2212";
  return text.starts_with(minus) ? minus.size() : text.starts_with('-') ? 1 : 0;
}

/// Takes "0 days " and "-1 days " off a duration of pandas.
std::optional<std::int64_t> take_days(std::string_view& text) {
  constexpr std::string_view word = " days ";
  constexpr std::size_t most_digits = 5;
  const std::size_t end = text.find(word);
  if (end == text.npos || end > most_digits + 1) return std::nullopt;
  const auto days = integer_in(text.substr(0, end));
  if (days) text.remove_prefix(end + word.size());
  return days;
}

/// "00:00:00.1" behind a minus, and "2 min".
std::optional<DateTime> time_before(std::string_view text) {
  auto found = date_time_in(text);
  if (!found || found->has_date || found->zone) return std::nullopt;
  found->nanoseconds = -found->nanoseconds;
  found->before_zero = !found->elapsed;
  found->period = 0;
  return found;
}

}  // namespace

std::optional<DateTime> date_time_in(std::string_view text) {
  constexpr std::string_view between = " \t\",;|";
  text.remove_prefix(std::min(text.find_first_not_of(" \t\""), text.size()));
  DateTime found;
  const auto days = take_days(text);
  found.elapsed = days.has_value();
  if (!days) {
    const std::size_t sign = length_of_minus(text);
    const bool signed_digit = sign < text.size() && detail::is_digit(text[sign]);
    if (sign > 0 && signed_digit) return time_before(text.substr(sign));
  }
  if (text.size() > 1 && text.front() == '+' && detail::is_digit(text[1])) text.remove_prefix(1);
  Scanner scan(text);
  scan.take_any(between);
  const auto take_date = [&] {
    return take_date_with_month(scan, found) || take_date_of_numbers(scan, found);
  };
  const bool basic = take_basic_date_and_time(scan, found);
  if (!basic) found.has_date = take_date();
  if (basic) {
    // both are there
  } else if (found.has_date) {
    Scanner ahead = scan;
    if (ahead.take('T') || ahead.take('t') || ahead.take('_') || ahead.take_any(between))
      found.has_time = take_time(ahead, found);
    if (found.has_time) scan = ahead;
  } else {
    found.has_time = take_time(scan, found);
    Scanner ahead = scan;
    if (found.has_time && ahead.take_any(between)) {
      std::swap(scan, ahead);
      found.has_date = take_date();
      if (!found.has_date) std::swap(scan, ahead);
    }
  }
  if (!found.has_date && !found.has_time) return found.elapsed ? std::nullopt : duration_in(text);
  if (found.has_time && take_zone(scan, found)) found.nanoseconds -= *found.zone * 60 * second;
  found.nanoseconds += days.value_or(0) * day;
  if (days) found.period = 0;
  scan.take_any(" \t\"");
  if (!scan.at_end()) return std::nullopt;
  return found;
}

std::optional<DateTime> clock_of_numbers(std::span<const double> numbers) {
  if (numbers.size() != 3 && numbers.size() != 6) return std::nullopt;
  const auto is_whole = [](double number) { return number == std::floor(number); };
  const auto time = numbers.last(3);
  if (!std::ranges::all_of(numbers.first(numbers.size() - 1), is_whole)) return std::nullopt;
  if (!(time[0] >= 0.0 && time[0] < 10'000.0 && time[1] >= 0.0 && time[1] < 60.0 &&
        time[2] >= 0.0 && time[2] < 61.0))
    return std::nullopt;
  DateTime found;
  found.has_time = true;
  found.nanoseconds = std::llround(3600.0 * time[0] + 60.0 * time[1]) * second +
                      std::llround(time[2] * static_cast<double>(second));
  found.period = time[0] < 24.0 ? day : 0;
  if (numbers.size() == 3) return found;
  constexpr double most = 9999.0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(numbers[k] >= 1.0 && numbers[k] <= most)) return std::nullopt;
    found.date[k] = static_cast<int>(numbers[k]);
  }
  found.days.fill(days_to(found.date[0], found.date[1], found.date[2]));
  if (!found.days[0] || time[0] >= 24.0) return std::nullopt;
  found.has_date = true;
  return found;
}

std::optional<DateTime> whole_seconds_in(std::string_view text) {
  constexpr std::int64_t since_1970 = 100'000'000, most = 9'000'000'000;
  const auto seconds = integer_in(text);
  if (!seconds || *seconds < 0 || *seconds > most) return std::nullopt;
  DateTime found;
  found.has_time = true;
  found.has_date = *seconds >= since_1970;
  found.nanoseconds = *seconds * second;
  if (!found.has_date) return found;
  constexpr std::int64_t of_day = day / second;
  const auto days = static_cast<std::int32_t>(*seconds / of_day);
  const std::chrono::year_month_day stated{std::chrono::sys_days(std::chrono::days(days))};
  found.date = {static_cast<int>(stated.year()), static_cast<int>(unsigned(stated.month())),
                static_cast<int>(unsigned(stated.day()))};
  found.days.fill(days);
  found.nanoseconds = *seconds % of_day * second;
  found.zone = 0;
  return found;
}

std::optional<double> seconds_between(const DateTime& from, const DateTime& to) {
  if (from.has_date != to.has_date || from.has_time != to.has_time || from.elapsed != to.elapsed ||
      from.zone.has_value() != to.zone.has_value())
    return std::nullopt;
  std::int64_t elapsed = to.nanoseconds - from.nanoseconds;
  if (!from.has_date) {
    if (elapsed < 0 && !to.before_zero) elapsed += from.period;
  } else if (from.date != to.date) {
    const auto days = days_between(from, to);
    constexpr std::int64_t most_days = 36525;  // a century: 2^63 ns are almost three
    if (!days || std::abs(*days) > most_days) return std::nullopt;
    elapsed += *days * day;
  }
  return static_cast<double>(elapsed) / static_cast<double>(second);
}

std::string DateTime::iso() const {
  if (!has_date) return {};
  const auto known = days[0] && days[1] && *days[0] != *days[1] ? std::nullopt
                     : days[0]                                  ? days[0]
                                                                : days[1];
  if (!known) return {};
  const std::int64_t local = nanoseconds + zone.value_or(0) * 60 * second;
  const std::chrono::year_month_day stated{std::chrono::sys_days(std::chrono::days(*known))};
  std::string text =
      fmt::format("{:04}-{:02}-{:02}", static_cast<int>(stated.year()),
                  static_cast<unsigned>(stated.month()), static_cast<unsigned>(stated.day()));
  if (!has_time) return text;
  const std::int64_t whole = local / second;
  text += fmt::format("T{:02}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  if (local % second != 0) {
    text += fmt::format(".{:09}", local % second);
    text.resize(text.find_last_not_of('0') + 1);
  }
  if (!zone) return text;
  if (*zone == 0) return text + "Z";
  return text + fmt::format("{}{:02}:{:02}", *zone < 0 ? '-' : '+', std::abs(*zone) / 60,
                            std::abs(*zone) % 60);
}

}  // namespace impactrig::acquisition
