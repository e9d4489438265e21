// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/low_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/samples.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::LowPass;

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

void pass(std::vector<Section>& sections, std::span<double> values) {
  for (Section& section : sections) section.settle(values.front());
  for (double& value : values)
    for (Section& section : sections) value = section(value);
}

}  // namespace

std::vector<double> zero_phase_low_pass(std::span<const double> values, double interval,
                                        const LowPass& filter) {
  if (!(filter.cutoff > 0.0) || !(filter.cutoff * interval < 0.5))
    throw std::invalid_argument(
        fmt::format("a low-pass at {:g} Hz is not below half of the sample rate, {:g} Hz",
                    filter.cutoff, 0.5 / interval));
  if (filter.order < 1 || filter.order > 8)
    throw std::invalid_argument(
        fmt::format("the order of a low-pass is 1 to 8, not {}", filter.order));
  if (values.empty()) return {};

  const double n = filter.order;
  const double warped = std::tan(std::numbers::pi * filter.cutoff * interval) /
                        std::pow(std::numbers::sqrt2 - 1.0, 0.5 / n);
  std::vector<Section> sections;
  for (int pair = 0; pair < filter.order / 2; ++pair)
    sections.emplace_back(warped,
                          2.0 * std::sin(std::numbers::pi * (2.0 * pair + 1.0) / (2.0 * n)));
  if (filter.order % 2 == 1) sections.emplace_back(warped, 0.0);

  // 21 = ln 1e9 time constants of the slowest pole.
  const double slowest = std::sin(std::numbers::pi / (2.0 * n));
  const double decay = std::ceil(21.0 / (2.0 * warped * slowest));
  const std::size_t count = values.size();
  const auto pad = static_cast<std::size_t>(std::min(decay, static_cast<double>(count - 1)));
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

LowPassed low_pass(Channel& channel, const LowPass& filter) {
  const std::vector<double> before = sound_values(channel);
  std::vector<double> after = zero_phase_low_pass(before, channel.clock.interval, filter);
  const double from = largest_departure(before), to = largest_departure(after);
  LowPassed result;
  result.edit = {"low-pass, zero phase", channel.name, {}};
  auto& parameters = result.edit.parameters;
  parameters["cutoff"] = fmt::format("{:.12g} Hz", filter.cutoff);
  parameters["order"] = fmt::format("{}, forwards and backwards", filter.order);
  parameters["largest departure"] = fmt::format("{:.6g} {}, before {:.6g}", to, channel.unit, from);
  result.lost = from != 0.0 ? 1.0 - std::abs(to / from) : 0.0;
  replace_values(channel, std::move(after));
  return result;
}

}  // namespace impactrig::acquisition
