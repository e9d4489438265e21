// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// The clock a column of times stands for, and a sentence for the user where that needs one.
struct TimeAxis {
  datasets::SampleClock clock;
  std::string warning;  ///< "" = nothing to say
};

/// Times [s] to a clock. Uniform when every step is within 1e-3 of the mean step and no time is
/// further than 5e-2 of it from the straight line, or when the deviations are explained by the
/// digits the times were printed with; then start and mean step are kept, else all times, and the
/// mean step, of times that go back that of the steps forward. Times of single precision have the
/// digits of such numbers; a few that stand twice among even ones are kept. Where
/// many samples share a time, the step is that between the first and the last change; with fewer
/// than two changes it is not known, and the interval 0. `stated`: the interval that a head states
/// [s], 0 if none; where so many samples fill the time to its last digit, printed times differ by
/// rounding alone, and it is the interval. So does one that times with a few digits tell, of which
/// the small ones have finer ones.
TimeAxis time_axis(std::vector<double> times, double stated = 0.0);

/// The unit in which a number counts the time since 1970, so that it is in the years 2000 to 2060;
/// "" for numbers of other sizes, and for seconds.
std::string unit_since_1970(double time);

/// Whether a time [s] is one of recordings, from 2000 to 2060, counted from 1970.
bool is_since_1970(double seconds);

/// Whether times may be days, as spreadsheets and MATLAB count them: of that size, and in steps
/// that as seconds would be those of 20 MHz and more.
bool may_count_days(double first, double step);

/// What is said of an array of such times.
std::string counts_since_1970(std::string_view name, std::string_view unit);

/// Judges times as they come, as time_axis() does, without keeping them.
class TimeAxisCheck {
 public:
  /// So many times are expected, from `first` to `last` [s].
  TimeAxisCheck(double first, double last, std::uint64_t samples, double stated = 0.0);

  void add(std::span<const double> times);

  /// False when other times came than were expected: the judgement is then worth nothing.
  bool as_expected() const;

  std::uint64_t samples() const { return seen_; }

  /// Of the times that came.
  double first() const { return first_seen_; }

  double last() const { return last_seen_; }

  /// True when start and mean step stand for all times.
  bool uniform() const;

  /// The clock, without times where it is not uniform, and what there is to say.
  TimeAxis axis() const;

 private:
  bool all_equal() const;
  bool even() const;
  bool rounded() const;
  bool few_stand_twice() const;
  double resolution() const;
  double last_bit() const;  ///< of the largest time [s]
  bool explains_deviations(double resolution) const;
  bool fills(double resolution) const;
  double told_interval() const;
  TimeAxis shared_times() const;

  double first_;
  double last_;
  std::uint64_t samples_;
  double stated_;
  double step_ = 0.0;
  std::uint64_t seen_ = 0;
  double first_seen_ = 0.0;
  double last_seen_ = 0.0;
  double largest_step_error_ = 0.0;
  double largest_deviation_ = 0.0;
  bool all_finite_ = true;

  struct Backwards {
    std::uint64_t sample;
    double before, time;
  };

  std::optional<Backwards> backwards_;
  bool falls_ = false;       ///< a time is before another that precedes it: no rounding makes that
  std::uint64_t rises_ = 0;  ///< steps forward
  double risen_ = 0.0;       ///< their sum [s]

  struct Change {
    std::uint64_t sample;
    double time;
  };

  std::optional<Change> first_change_;  // the first time that is later than the one before
  Change last_change_{};
  double smallest_change_ = std::numeric_limits<double>::infinity(), largest_change_ = 0.0;
  std::vector<double> examples_;  // a thousand of the times, to see how they were printed
};

/// The last digit a list of times was printed with, at its largest magnitude [s]; 0 when it looks
/// like full precision.
double printed_resolution(std::span<const double> times);

/// The round rate [Hz] that a writer with six digits must have meant by `interval` [s]: the nearest
/// rate with the fewest prime factors beside 2 and 5 among those that give the same six digits.
/// None when the interval is round as it stands.
std::optional<double> nice_rate(double interval);

/// Says of a channel whose abscissa is no time ("frequency", "Hz", ...) what the abscissa is:
/// attributes "domain", "abscissa unit", "abscissa first", "abscissa increment". Its clock stays
/// unset (interval 0).
void set_abscissa(datasets::Channel& channel, std::string_view domain, std::string_view unit,
                  double first, double increment);

/// Seconds and microseconds since 1970-01-01 00:00 UTC as "2020-04-30T19:12:52.5Z", with the digits
/// that are not zero; "" outside of the years 1 to 9999.
std::string iso_utc(std::int64_t seconds, std::uint32_t microseconds);

/// "30-Apr-20 19:12:52" as "2020-04-30T19:12:52"; anything else as it is. Years 70 to 99 are of the
/// last century.
std::string iso_date(std::string_view text);

/// "2020-04-30T19:12:52" as universal files have it, "30-Apr-20 19:12:52"; anything else, and other
/// centuries, as it is.
std::string uff_date(std::string_view text);

}  // namespace impactrig::acquisition
