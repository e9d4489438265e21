// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/zero_phase_low_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace impactrig::datasets {
namespace {

/// One or two of a Butterworth filter's poles, as trapezoidal integrators.
class Section {
 public:
  /// `warped` = tan(pi f h); `damping` = 1/Q of a pair, 0 for a single pole.
  Section(double warped, double damping) : g_(warped), k_(damping), pair_(damping > 0.0) {}

  /// As if the input had been `value` for ever.
  void settle(double value) {
    first_ = pair_ ? 0.0 : value;
    second_ = value;
  }

  double operator()(double input) {
    if (!pair_) {
      const double step = g_ / (1.0 + g_) * (input - first_);
      const double output = first_ + step;
      first_ = output + step;
      return output;
    }
    const double band = (first_ + g_ * (input - second_)) / (1.0 + g_ * (g_ + k_));
    const double low = second_ + g_ * band;
    first_ = 2.0 * band - first_;
    second_ = 2.0 * low - second_;
    return low;
  }

 private:
  double g_, k_;
  bool pair_;
  double first_ = 0.0, second_ = 0.0;
};

using Sections = std::vector<Section>;

double passed(Sections& sections, double value) {
  for (Section& section : sections) value = section(value);
  return value;
}

void pass(Sections& sections, std::span<double> values) {
  for (Section& section : sections) section.settle(values.front());
  for (double& value : values) value = passed(sections, value);
}

/// Both passes over a record that `pad` (< n) reflected samples prolong at either end.
std::vector<double> passed_between_pads(std::span<const double> values, std::size_t pad,
                                        Sections& sections) {
  const std::size_t count = values.size();
  std::vector<double> work;
  work.reserve(count + 2 * pad);
  for (std::size_t i = pad; i > 0; --i) work.push_back(2.0 * values.front() - values[i]);
  work.insert(work.end(), values.begin(), values.end());
  for (std::size_t i = 0; i < pad; ++i) work.push_back(2.0 * values.back() - values[count - 2 - i]);

  pass(sections, work);
  std::ranges::reverse(work);
  pass(sections, work);
  std::ranges::reverse(work);
  work.erase(work.begin(), work.begin() + static_cast<std::ptrdiff_t>(pad));
  work.resize(count);
  return work;
}

/// One period of what a filter makes of a period, `lead` samples after it was at rest.
void pass_periodically(Sections& sections, std::size_t lead, std::span<double> period) {
  for (Section& section : sections) section.settle(0.0);
  const std::size_t n = period.size();
  for (std::size_t i = n - lead % n; i < n && lead % n > 0; ++i) passed(sections, period[i]);
  for (std::size_t turn = 0; turn < lead / n; ++turn)
    for (const double value : period) passed(sections, value);
  for (double& value : period) value = passed(sections, value);
}

/// Both passes over a record of which one reflection is too short: it is reflected again and again.
/// Less the line from its first to its last sample, which the filter leaves alone, that is periodic
/// and without a mean.
std::vector<double> passed_in_periods(std::span<const double> values, std::size_t lead,
                                      Sections& sections) {
  const std::size_t last = values.size() - 1;
  const double slope = (values[last] - values[0]) / static_cast<double>(last);
  const auto line = [&](std::size_t i) { return values[0] + slope * static_cast<double>(i); };
  std::vector<double> period(2 * last, 0.0);
  for (std::size_t i = 1; i < last; ++i) {
    period[i] = values[i] - line(i);
    period[2 * last - i] = -period[i];
  }
  pass_periodically(sections, lead, period);
  std::ranges::reverse(period);
  pass_periodically(sections, lead, period);
  std::ranges::reverse(period);
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i <= last; ++i) result[i] = line(i) + period[i % period.size()];
  return result;
}

Sections sections_of(int order, double warped) {
  Sections sections;
  for (int pair = 0; pair < order / 2; ++pair)
    sections.emplace_back(warped,
                          2.0 * std::sin(std::numbers::pi * (2.0 * pair + 1.0) / (2.0 * order)));
  if (order % 2 == 1) sections.emplace_back(warped, 0.0);
  return sections;
}

void refuse_senseless(const LowPass& filter, double interval) {
  if (!(filter.cutoff > 0.0))
    throw std::invalid_argument(
        fmt::format("a low-pass at {:g} Hz is not above 0 Hz", filter.cutoff));
  // so close to it the slowest pole remembers some ten million samples
  if (!(filter.cutoff * interval < 0.5 * (1.0 - 1e-6)))
    throw std::invalid_argument(
        fmt::format("a low-pass at {:g} Hz is not below half of the sample rate, {:g} Hz, by a "
                    "millionth of it or more",
                    filter.cutoff, 0.5 / interval));
  if (filter.order < 1 || filter.order > 8)
    throw std::invalid_argument(
        fmt::format("the order of a low-pass is 1 to 8, not {}", filter.order));
}

/// tan(pi f h) of each pass's own 3 dB point.
double warped_cutoff(const LowPass& filter, double interval) {
  return std::tan(std::numbers::pi * filter.cutoff * interval) /
         std::pow(std::numbers::sqrt2 - 1.0, 0.5 / filter.order);
}

/// Of a Butterworth filter's slowest poles, on the unit circle: their distance from the axis.
double slowest_part(const LowPass& filter) {
  return std::sin(std::numbers::pi / (2.0 * filter.order));
}

}  // namespace

/// Of the slowest pole z = (1 + w s) / (1 − w s), s of the Butterworth circle.
double low_pass_memory(const LowPass& filter, double interval) {
  const double warped = warped_cutoff(filter, interval);
  return 1.0 / std::atanh(2.0 * warped * slowest_part(filter) / (1.0 + warped * warped));
}

std::vector<double> zero_phase_low_pass(std::span<const double> values, double interval,
                                        const LowPass& filter) {
  refuse_senseless(filter, interval);
  if (values.size() < 2) return {values.begin(), values.end()};

  Sections sections = sections_of(filter.order, warped_cutoff(filter, interval));
  const double decay = std::ceil(21.0 * low_pass_memory(filter, interval));  // 21 = ln 1e9
  const auto lead = static_cast<std::size_t>(std::min(decay, 1e15));
  return lead < values.size() ? passed_between_pads(values, lead, sections)
                              : passed_in_periods(values, lead, sections);
}

}  // namespace impactrig::datasets
