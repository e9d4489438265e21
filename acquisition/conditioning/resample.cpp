// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/resample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/interpolators/makima.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/digitiser_step.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "acquisition/conditioning/trace.hpp"
#include "datasets/band_limited.hpp"

namespace impactrig::acquisition {

using datasets::BandLimited;
using datasets::Channel;

namespace {

constexpr double gap_steps = 2.5;         ///< a longer one lacks two samples or more
constexpr std::ptrdiff_t around_gap = 7;  ///< steps on either side that say what is usual
constexpr double fewest = 16.0;           ///< samples of the result
constexpr double most = 0x1p26;           ///< of them, where the source has not half as many

bool is_sound(const Channel& channel, std::size_t i) {
  return channel.is_valid(i) && std::isfinite(channel.value(i));
}

/// Sound samples at uneven times become samples at even ones from the first sound time on, which
/// `start` becomes.
std::vector<double> joined_evenly(const Channel& channel, double interval, double& start) {
  std::vector<double> times, values;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    if (!is_sound(channel, i)) continue;
    times.push_back(channel.clock.times[i]);
    values.push_back(channel.value(i));
  }
  const bool forwards = std::ranges::adjacent_find(times, std::greater_equal{}) == times.end();
  if (times.size() < 4 || !forwards)
    throw std::invalid_argument(
        fmt::format("channel '{}' cannot be resampled: its times must increase, with at least 4 "
                    "sound samples",
                    channel.name));
  const double first = times.front(), last = times.back();
  start = first;
  boost::math::interpolators::makima curve(std::move(times), std::move(values));
  std::vector<double> even(static_cast<std::size_t>((last - first) / interval * (1.0 + 1e-12)) + 1);
  for (std::size_t i = 0; i < even.size(); ++i)
    even[i] = curve(std::min(last, first + interval * static_cast<double>(i)));
  return even;
}

void refuse_count(const Channel& channel, double rate, double count) {
  const double limit = std::max(most, 2.0 * static_cast<double>(channel.size()));
  if (count >= fewest && count <= limit) return;
  throw std::invalid_argument(
      fmt::format("channel '{}' would have {:.3g} samples at {:g} Hz; {:g} to {:.0f} million are "
                  "possible",
                  channel.name, std::floor(count), rate, fewest, limit / 1e6));
}

/// The new clock's samples, and which of them stand for nothing that was recorded.
class Marks {
 public:
  Marks(double start, double interval, std::size_t n) : start_(start), interval_(interval), n_(n) {}

  /// Marks the samples between two times [s], both left out; returns how many.
  std::size_t add(double from, double to) {
    const double first = std::max(0.0, std::ceil((from - start_) / interval_ + 1e-6));
    const double last =
        std::min(static_cast<double>(n_) - 1.0, std::floor((to - start_) / interval_ - 1e-6));
    std::size_t added = 0;
    for (double k = first; k <= last; ++k) {
      if (valid_.empty()) valid_.assign(n_, 1);
      added += valid_[static_cast<std::size_t>(k)];
      valid_[static_cast<std::size_t>(k)] = 0;
    }
    return added;
  }

  std::vector<std::uint8_t>&& valid() && { return std::move(valid_); }

 private:
  double start_, interval_;
  std::size_t n_;
  std::vector<std::uint8_t> valid_;
};

/// Marks each new sample that has an invalid one within a step of either clock, or lies between an
/// invalid one and its neighbours.
void mark_invalid(const Channel& channel, double interval, Marks& marks) {
  const double reach =
      channel.clock.uniform() ? std::max(interval, channel.clock.interval) : interval;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    if (is_sound(channel, i)) continue;
    const double time = channel.clock.time(i);
    const double before = channel.clock.time(i > 0 ? i - 1 : i);
    const double after = channel.clock.time(i + 1 < channel.size() ? i + 1 : i);
    marks.add(std::min(time - reach, before), std::max(time + reach, after));
  }
}

/// Marks what falls into steps so much longer than those before and behind that samples are
/// missing there, each of which counts as an invalid one. A change of the rate is no gap.
void mark_gaps(const Channel& channel, double interval, Marks& marks, Resampled& result) {
  const std::vector<double>& times = channel.clock.times;
  const auto n = static_cast<std::ptrdiff_t>(times.size());
  const auto step = [&](std::ptrdiff_t i) {  // from sample i to the next one
    return times[static_cast<std::size_t>(i) + 1] - times[static_cast<std::size_t>(i)];
  };
  const auto usual = [&](std::ptrdiff_t from, std::ptrdiff_t to) {  // the median
    std::vector<double> steps;
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, from); i < std::min(to, n - 1); ++i)
      steps.push_back(step(i));
    if (steps.empty()) return 0.0;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::ranges::nth_element(steps, middle);
    return *middle;
  };
  for (std::ptrdiff_t i = 0; i + 1 < n; ++i) {
    const double around = std::max(usual(i - around_gap, i), usual(i + 1, i + 1 + around_gap));
    if (!(around > 0.0) || step(i) <= gap_steps * around) continue;
    const double reach = std::max(interval, around);
    const double from = times[static_cast<std::size_t>(i)];
    const std::size_t marked = marks.add(from + around - reach, from + step(i) - around + reach);
    if (marked == 0) continue;
    ++result.gaps;
    result.in_gaps += marked;
    result.longest_gap = std::max(result.longest_gap, step(i));
  }
}

}  // namespace

Resampled resample(Channel& channel, const datasets::Resample& to) {
  if (!(to.rate > 0.0) || !std::isfinite(to.rate))
    throw std::invalid_argument(fmt::format("a sample rate of {:g} Hz is not positive", to.rate));
  double start = channel.clock.uniform() || channel.size() == 0 ? channel.clock.start
                                                                : channel.clock.times.front();
  const double interval = 1.0 / to.rate;
  const bool uneven = !channel.clock.uniform() && channel.size() > 0 && !channel.complex();
  Resampled result;
  result.edit = {"resample", channel.name, {}};
  auto& parameters = result.edit.parameters;
  std::vector<double> source;
  double source_interval = channel.clock.interval;
  if (uneven) {
    const double span = channel.clock.times.back() - channel.clock.times.front();
    refuse_count(channel, to.rate, span / interval);
    source_interval = std::min(interval, span / static_cast<double>(channel.size() - 1));
    source = joined_evenly(channel, source_interval, start);
    parameters["from"] = "uneven times, joined by modified Akima cubics";
  } else {
    source = sound_values(channel, 4);
    note_digitiser_step(source, channel.valid, channel, result.edit);
    parameters["from"] = fmt::format("{:.12g} Hz", 1.0 / source_interval);
  }
  const double count =
      std::floor(source_interval * static_cast<double>(source.size() - 1) / interval + 1e-6) + 1.0;
  refuse_count(channel, to.rate, count);
  const double ratio = interval / source_interval;
  std::vector<double> values(static_cast<std::size_t>(count));
  if (std::abs(ratio - 1.0) < 1e-12) {
    values.assign(source.begin(), source.begin() + static_cast<std::ptrdiff_t>(values.size()));
  } else {
    const BandLimited signal(source, std::max(1.0, ratio));
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = signal(ratio * static_cast<double>(i));
  }
  const double from = largest_departure(source), left = largest_departure(values);
  result.lost = from != 0.0 ? 1.0 - std::abs(left / from) : 0.0;
  parameters["largest departure"] =
      fmt::format("{:.6g} {}, before {:.6g}", left, channel.unit, from);
  Marks marks(start, interval, values.size());
  mark_invalid(channel, interval, marks);
  if (uneven) mark_gaps(channel, interval, marks, result);
  if (result.gaps > 0)
    parameters["gaps"] = fmt::format("{}, the longest {:.12g} s: {} samples are not valid",
                                     result.gaps, result.longest_gap, result.in_gaps);
  channel.valid = std::move(marks).valid();
  channel.clock = {start, interval, {}};
  parameters["to"] = fmt::format("{:.12g} Hz", to.rate);
  parameters["kernel"] = fmt::format("sinc, {} crossings, Kaiser window {}", BandLimited::crossings,
                                     BandLimited::beta);
  replace_values(channel, std::move(values));
  return result;
}

}  // namespace impactrig::acquisition
