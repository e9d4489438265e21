// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/time_axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "acquisition/importers/number.hpp"

namespace impactrig::acquisition {

namespace {

/// The decimal number with the fewest digits that lies within `tolerance` of `value`.
double fewest_digits(double value, double tolerance) {
  for (int digits = 0; digits < 17; ++digits) {
    const double candidate = number_in(fmt::format("{:.{}e}", value, digits)).value_or(value);
    if (std::abs(candidate - value) <= tolerance) return candidate;
  }
  return value;
}

/// Significant digits of the shortest decimal that reads back as `value`.
int significant_digits(double value) {
  for (int digits = 1; digits < 17; ++digits)
    if (number_in(fmt::format("{:.{}e}", value, digits - 1)) == value) return digits;
  return 17;
}

/// The same of a number that was converted, "0.1953" of ms to s, and may be the next double to that
/// of its digits: where it has a few. 17 otherwise.
int converted_digits(double value) {
  constexpr int most = 12;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  for (int digits = 1; digits <= most; ++digits) {
    const auto candidate = number_in(fmt::format("{:.{}e}", value, digits - 1));
    if (candidate && std::abs(*candidate - value) <= epsilon * std::abs(value)) return digits;
  }
  return 17;
}

/// -2 of 0.0345.
int power_of_ten(double value) {
  return static_cast<int>(std::floor(std::log10(std::abs(value))));
}

/// The last bit [s] of the largest of times that are numbers of single precision, in s, ms or us,
/// by the digits that they are printed with, and those digits where they do not tell; 0 of others.
double single_precision_bit(std::span<const double> times, double printed) {
  constexpr std::size_t fewest = 20;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  if (times.size() < fewest) return 0.0;
  const auto [low, high] = std::ranges::minmax(times);
  const double largest = std::max(-low, high);
  for (const double per_second : {1.0, 1e3, 1e6}) {
    const auto is_single = [&](double time) {
      const double number = time * per_second;
      const double digits = 0.51 * printed * per_second + 2.0 * epsilon * std::abs(number);
      return std::abs(number - static_cast<double>(static_cast<float>(number))) <= digits;
    };
    const auto number = static_cast<float>(largest * per_second);
    const float next = std::nextafter(number, std::numeric_limits<float>::infinity());
    const double bit = static_cast<double>(next - number) / per_second;
    if (printed >= bit) return 0.0;
    if (4.0 * printed >= bit) return bit + printed;
    if (std::ranges::all_of(times, is_single)) return bit;
  }
  return 0.0;
}

/// What is left of an integer without its factors 2 and 5; 1 is the roundest.
long odd_part(long number) {
  for (const long factor : {2L, 5L})
    while (number % factor == 0) number /= factor;
  return number;
}

/// Every how many times one is looked at: not a multiple of 2 or 5, as those times are rounder than
/// the others.
std::uint64_t example_stride(std::uint64_t times) {
  std::uint64_t stride = std::max<std::uint64_t>(1, times / 1000);
  while (stride > 1 && (stride % 2 == 0 || stride % 5 == 0)) ++stride;
  return stride;
}

}  // namespace

double printed_resolution(std::span<const double> times) {
  const std::uint64_t stride = example_stride(times.size());
  const double largest = std::max(std::abs(times.front()), std::abs(times.back()));
  const auto most_digits = [&](int (*digits_of)(double)) {
    int digits = std::max(digits_of(times.front()), digits_of(times.back()));
    for (std::size_t i = 0; i < times.size(); i += stride)
      digits = std::max(digits, digits_of(times[i]));
    return digits;
  };
  int digits = most_digits(significant_digits);
  // 15 digits survive any conversion, and a number with 17 was not rounded on purpose; that a list
  // of such needs 16 at most is no chance
  constexpr std::size_t many = 50;
  const int most = times.size() / stride >= many ? 16 : 14;
  if (digits > most) digits = most_digits(converted_digits);
  if (largest == 0.0 || digits > most) return 0.0;
  return std::pow(10.0, std::floor(std::log10(largest)) - digits + 1);
}

TimeAxisCheck::TimeAxisCheck(double first, double last, std::uint64_t samples, double stated)
    : first_(first),
      last_(last),
      samples_(samples),
      stated_(stated) {
  if (samples > 1) step_ = (last - first) / static_cast<double>(samples - 1);
}

void TimeAxisCheck::add(std::span<const double> times) {
  const std::uint64_t stride = example_stride(samples_);
  if (seen_ == 0 && !times.empty()) first_seen_ = times.front();
  double before = last_seen_;
  for (const double time : times) {
    if (seen_ > 0) {
      const double this_step = time - before;
      if (!(this_step > 0.0) && !backwards_) backwards_ = Backwards{seen_, before, time};
      falls_ = falls_ || this_step < 0.0;
      if (this_step > 0.0) {
        ++rises_;
        risen_ += this_step;
        last_change_ = {seen_, time};
        smallest_change_ = std::min(smallest_change_, this_step);
        largest_change_ = std::max(largest_change_, this_step);
        if (!first_change_) first_change_ = last_change_;
      }
      const double line = first_ + step_ * static_cast<double>(seen_);
      all_finite_ = all_finite_ && std::isfinite(time);
      largest_step_error_ = std::max(largest_step_error_, std::abs(this_step - step_));
      largest_deviation_ = std::max(largest_deviation_, std::abs(time - line));
    }
    if (seen_ % stride == 0 && examples_.size() < 2000) examples_.push_back(time);
    before = time;
    ++seen_;
  }
  last_seen_ = before;
}

bool TimeAxisCheck::as_expected() const {
  return seen_ == samples_ && (seen_ == 0 || (first_seen_ == first_ && last_seen_ == last_));
}

bool TimeAxisCheck::all_equal() const {
  return seen_ > 1 && all_finite_ && step_ == 0.0 && largest_deviation_ == 0.0;
}

bool TimeAxisCheck::even() const {
  return all_finite_ && step_ > 0.0 && largest_step_error_ <= 1e-3 * step_ &&
         largest_deviation_ <= 0.05 * step_;
}

double TimeAxisCheck::last_bit() const {
  const double largest = std::max(std::abs(first_), std::abs(last_));
  return std::numeric_limits<double>::epsilon() * largest;
}

double TimeAxisCheck::resolution() const {
  if (explains_deviations(last_bit())) return last_bit();
  std::vector<double> examples = examples_;
  examples.push_back(last_seen_);
  // many equal times show their steps, which may be other than a digit's: 60 s, 1/64 s
  const bool stepped = std::isfinite(smallest_change_) && smallest_change_ >= 2.0 * step_;
  const double printed = printed_resolution(examples);
  return std::max(
      {printed, single_precision_bit(examples, printed), stepped ? smallest_change_ : 0.0});
}

bool TimeAxisCheck::explains_deviations(double resolution) const {
  // between a fifth of a step and a whole one, a lost sample looks the same as a rounded time
  return resolution > 0.0 &&
         (resolution <= 0.2 * step_ || resolution > step_ || fills(resolution)) &&
         largest_deviation_ <= 1.01 * resolution;
}

/// Whether no sample is lost by the interval that is stated, or that the times tell.
bool TimeAxisCheck::fills(double resolution) const {
  const double interval = stated_ > 0.0 ? stated_ : told_interval();
  return interval > 0.0 && samples_ > 1 &&
         std::abs(interval * static_cast<double>(samples_ - 1) - (last_ - first_)) <=
             1.01 * resolution;
}

/// The interval by which all examples are where they are printed, each to half of the last digit
/// that times of its size have: of times with a few digits the small ones tell it. 0 where there is
/// none, or it leaves open whether a sample is lost.
double TimeAxisCheck::told_interval() const {
  constexpr int most_digits = 8;
  std::map<int, int> decimals;  // the most that times of a power of ten have
  for (const double time : examples_) {
    if (time == 0.0) continue;
    const int digits = converted_digits(time);
    if (digits > most_digits) return 0.0;
    int& most = decimals.try_emplace(power_of_ten(time), -1000).first->second;
    most = std::max(most, digits - 1 - power_of_ten(time));
  }
  // as many decimals everywhere tell nothing that the steps do not
  if (decimals.empty() || std::ranges::all_of(decimals, [&decimals](const auto& of_size) {
        return of_size.second <= decimals.rbegin()->second;
      }))
    return 0.0;
  const auto rounding = [&decimals](double time) {
    const int of_size = time == 0.0 ? decimals.begin()->second : decimals.at(power_of_ten(time));
    return 0.505 * std::pow(10.0, -of_size);
  };
  // counted from the time that is known best
  const auto best = std::ranges::min_element(examples_, {}, rounding);
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  for (auto time = examples_.begin(); time != examples_.end(); ++time) {
    if (time == best) continue;
    const double steps =
        static_cast<double>(time - best) * static_cast<double>(example_stride(samples_));
    const double unsure = (rounding(*time) + rounding(*best)) / std::abs(steps);
    low = std::max(low, (*time - *best) / steps - unsure);
    high = std::min(high, (*time - *best) / steps + unsure);
  }
  if (!(low <= high) || (high - low) * static_cast<double>(samples_ - 1) > 0.5 * step_) return 0.0;
  return fewest_digits(0.5 * (low + high), 0.5 * (high - low));
}

/// A few times that stand twice among even ones: rounding to almost the step would make that too.
bool TimeAxisCheck::few_stand_twice() const {
  constexpr double few = 0.02;
  const std::uint64_t twice = seen_ - 1 - rises_;
  const bool stated = stated_ > 0.0 && fills(smallest_change_);
  return twice > 0 && static_cast<double>(twice) <= few * static_cast<double>(seen_) && !stated &&
         largest_change_ <= 1.1 * smallest_change_;
}

bool TimeAxisCheck::rounded() const {
  return all_finite_ && !falls_ && step_ > 0.0 && !few_stand_twice() &&
         explains_deviations(resolution());
}

bool TimeAxisCheck::uniform() const {
  return seen_ < 2 || all_equal() || even() || rounded();
}

/// Of times that many samples share: the step between the first and the last change.
TimeAxis TimeAxisCheck::shared_times() const {
  TimeAxis axis;
  const std::uint64_t steps = first_change_ ? last_change_.sample - first_change_->sample : 0;
  if (steps == 0) {
    axis.warning = fmt::format(
        "{}: they do not tell the sample interval (--sample-rate states it)",
        first_change_ ? fmt::format("the times change once, by {:.3g} s", smallest_change_)
                      : fmt::format("all times are {:.9g} s", first_));
    return axis;
  }
  axis.clock.interval = (last_change_.time - first_change_->time) / static_cast<double>(steps);
  axis.warning = fmt::format(
      "the times are rounded to {:.3g} s, and several samples share one: they are taken as "
      "uniform, with a step of {:.9g} s, which they tell to 1 in {} (--sample-rate states it)",
      smallest_change_, axis.clock.interval, steps);
  return axis;
}

TimeAxis TimeAxisCheck::axis() const {
  TimeAxis axis;
  if (seen_ == 0) return axis;
  axis.clock.start = first_;
  if (seen_ == 1) {
    axis.warning = "there is one sample only: the sample interval is not known";
    return axis;
  }
  const bool even_steps = even();
  if (!even_steps && !all_equal() && rounded() && fills(resolution())) {
    axis.clock.interval = stated_ > 0.0 ? stated_ : told_interval();
    axis.warning = fmt::format(
        "the times are rounded to {:.3g} s: they are taken as uniform, with the interval of {:.9g} "
        "s that {}",
        resolution(), axis.clock.interval,
        stated_ > 0.0 ? "is stated" : "those of them with finer digits tell");
    return axis;
  }
  const bool many_share = !even_steps && rounded() && resolution() > step_;
  if (all_equal() || many_share) {
    axis = shared_times();
    axis.clock.start = first_;
    return axis;
  }
  if (even_steps || rounded()) {
    // the last bits of the mean step are rounding of the times: leave them off where a shorter
    // number says the same
    const double rounding = 4.0 * last_bit();
    axis.clock.interval = fewest_digits(step_, rounding / static_cast<double>(samples_ - 1));
    if (!even_steps)
      axis.warning = fmt::format(
          "the times are rounded to {:.3g} s: they are taken as uniform, with the mean step of "
          "{:.9g} s",
          resolution(), axis.clock.interval);
    return axis;
  }
  // times that begin again say nothing by their ends
  axis.clock.interval = falls_ && rises_ > 0 ? risen_ / static_cast<double>(rises_) : step_;
  if (backwards_) {
    axis.warning = fmt::format(
        "time does not increase from sample {} ({:.9g} s) to sample {} ({:.9g} s)",
        backwards_->sample - 1, backwards_->before, backwards_->sample, backwards_->time);
  } else {
    axis.warning = fmt::format(
        "the samples are not evenly spaced (steps differ from their mean of {:.6g} s by up to "
        "{:.3g} s): every "
        "time is kept",
        step_, largest_step_error_);
  }
  return axis;
}

TimeAxis time_axis(std::vector<double> times, double stated) {
  if (times.empty()) return {};
  TimeAxisCheck check(times.front(), times.back(), times.size(), stated);
  check.add(times);
  TimeAxis axis = check.axis();
  if (!check.uniform()) axis.clock.times = std::move(times);
  return axis;
}

bool may_count_days(double first, double step) {
  constexpr double smallest_step = 5e-8;
  const bool of_spreadsheet = first > 30000.0 && first < 70000.0;
  const bool of_matlab = first > 700000.0 && first < 770000.0;
  return (of_spreadsheet || of_matlab) && step > 0.0 && step < smallest_step;
}

std::optional<double> nice_rate(double interval) {
  const double stated = 1.0 / interval;
  if (!(interval > 0.0) || !std::isfinite(stated) || stated > 1e15) return std::nullopt;
  if (significant_digits(interval) > 6) return std::nullopt;
  // a rate that is an integer, or an interval with few digits, needs no help
  if (std::abs(stated - std::round(stated)) <= 1e-9 * stated || significant_digits(interval) < 6)
    return std::nullopt;
  const double last_digit = std::pow(10.0, std::floor(std::log10(interval)) - 5);
  const double low = 1.0 / (interval + 0.5 * last_digit);
  const double high = 1.0 / (interval - 0.5 * last_digit);
  if (high - low > 1e5) return std::nullopt;
  std::optional<long> best;
  for (long rate = static_cast<long>(std::ceil(low)); rate <= static_cast<long>(high); ++rate) {
    if (rate < 1) continue;
    const bool rounder =
        !best || odd_part(rate) < odd_part(*best) ||
        (odd_part(rate) == odd_part(*best) && std::abs(static_cast<double>(rate) - stated) <
                                                  std::abs(static_cast<double>(*best) - stated));
    if (rounder) best = rate;
  }
  if (!best) return std::nullopt;
  return static_cast<double>(*best);
}

void set_abscissa(datasets::Channel& channel, std::string_view domain, std::string_view unit,
                  double first, double increment) {
  channel.attributes["domain"] = domain;
  channel.attributes["abscissa unit"] = unit;
  channel.attributes["abscissa first"] = fmt::format("{}", first);
  channel.attributes["abscissa increment"] = fmt::format("{}", increment);
}

std::string iso_utc(std::int64_t seconds, std::uint32_t microseconds) {
  constexpr std::int64_t year_1 = -62135596800;
  constexpr std::int64_t year_10000 = 253402300800;
  if (seconds < year_1 || seconds >= year_10000) return {};
  const std::chrono::sys_seconds point{std::chrono::seconds(seconds)};
  const auto day = std::chrono::floor<std::chrono::days>(point);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss clock{point - day};
  std::string text =
      fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", static_cast<int>(date.year()),
                  static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                  clock.hours().count(), clock.minutes().count(), clock.seconds().count());
  if (microseconds != 0) {
    text += fmt::format(".{:06}", microseconds);
    text.resize(text.find_last_not_of('0') + 1);
  }
  return text + "Z";
}

std::string uff_date(std::string_view text) {
  constexpr std::array<std::string_view, 12> months = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                       "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const std::string source(text);
  int year = 0;
  int month = 0;
  int day = 0;
  int used = 0;
  if (std::sscanf(source.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &used) != 3 || used != 10)
    return source;
  const bool clear =
      year >= 1970 && year < 2070 && month >= 1 && month <= 12 && day >= 1 && day <= 31;
  const std::string_view rest = std::string_view(source).substr(10);
  if (!clear || !(rest.empty() || (rest.size() == 9 && rest[0] == 'T'))) return source;
  std::string date =
      fmt::format("{:02}-{}-{:02}", day, months[static_cast<std::size_t>(month - 1)], year % 100);
  if (!rest.empty()) date += " " + std::string(rest.substr(1));
  return iso_date(date) == source ? date : source;
}

std::string iso_date(std::string_view text) {
  constexpr std::array<std::string_view, 12> months = {"jan", "feb", "mar", "apr", "may", "jun",
                                                       "jul", "aug", "sep", "oct", "nov", "dec"};
  const std::string source(trimmed(text));
  int day = 0;
  int year = 0;
  int hour = 0;
  int minute = 0;
  int second = 0;
  std::array<char, 4> month{};
  int used = 0;
  const int found = std::sscanf(source.c_str(), "%2d-%3[A-Za-z]-%4d %2d:%2d:%2d%n", &day,
                                month.data(), &year, &hour, &minute, &second, &used);
  if (found < 3 || (found > 3 && found < 6)) return source;
  std::string lower(month.data());
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto* const which = std::find(months.begin(), months.end(), lower);
  if (which == months.end() || day < 1 || day > 31) return source;
  if (year < 100) year += year < 70 ? 2000 : 1900;
  const auto number = which - months.begin() + 1;
  if (found == 3) {
    const auto date_end = source.find_last_of("0123456789");
    if (date_end + 1 != source.size() || source.size() > 11) return source;
    return fmt::format("{:04}-{:02}-{:02}", year, number, day);
  }
  if (static_cast<std::size_t>(used) != source.size() || hour > 23 || minute > 59 || second > 60)
    return source;
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", year, number, day, hour, minute,
                     second);
}

bool is_since_1970(double seconds) {
  constexpr double year = 365.25 * 86400.0;
  return seconds > 30.0 * year && seconds < 90.0 * year;
}

std::string unit_since_1970(double time) {
  for (const auto& [unit, seconds] : {std::pair{"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}})
    if (is_since_1970(time * seconds)) return unit;
  return {};
}

std::string counts_since_1970(std::string_view name, std::string_view unit) {
  return fmt::format(
      "'{}' states no unit; by their size its numbers count {} since 1970 (--units states another)",
      name, unit);
}

}  // namespace impactrig::acquisition
