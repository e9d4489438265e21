// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/calculus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "acquisition/conditioning/baseline.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "datasets/number_text.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Quantity;

namespace {

struct Kinship {
  Quantity derivative, integral;
};

constexpr std::array<Kinship, 2> kinships{{
    {Quantity::velocity, Quantity::displacement},  //
    {Quantity::acceleration, Quantity::velocity},  //
}};

void refuse_no_history(const Channel& channel, std::size_t least) {
  const bool history = !channel.complex() && channel.clock.uniform() &&
                       channel.clock.interval > 0.0 && channel.size() >= least;
  if (!history)
    throw std::invalid_argument(
        fmt::format("channel '{}' cannot be integrated or differentiated: it must be a real time "
                    "history of at least {} samples at uniform steps",
                    channel.name, least));
}

/// Everything but the samples and the unit; what is not finite is marked.
Channel offspring_of(const Channel& channel, std::string_view prefix) {
  Channel result;
  result.name = fmt::format("{} {}", prefix, channel.name);
  result.quantity = Quantity::other;
  result.clock = channel.clock;
  result.valid = sound_marks(channel);
  result.delay = channel.delay;
  return result;
}

/// What has no unit gets none: its integral is not in seconds.
std::string over_time(std::string_view unit, bool integral) {
  if (unit.empty()) return {};
  return fmt::format(fmt::runtime(integral ? "({}) s" : "({})/s"), unit);
}

/// Names the quantity where it has a name, and keeps the parent's unit in the new one. The
/// calibration's number is that of both its units over time.
void name_unit(const Channel& parent, bool integral, Channel& result) {
  result.unit = over_time(parent.unit, integral);
  if ((result.calibration = parent.calibration))
    for (std::string* unit :
         {&result.calibration->recorded_unit, &result.calibration->physical_unit})
      *unit = over_time(*unit, integral);
  for (const Kinship& kinship : kinships) {
    const Quantity from = integral ? kinship.derivative : kinship.integral;
    const Quantity to = integral ? kinship.integral : kinship.derivative;
    if (parent.quantity != from) continue;
    result.quantity = to;
    const auto to_si = datasets::conversion(parent.unit, si_unit(from));
    if (!to_si) return;
    result.unit = si_unit(to);
    result.scale = to_si->factor;
    return;
  }
}

}  // namespace

Derived integrate(const Channel& channel, const IntegrationOptions& options) {
  refuse_no_history(channel, 2);
  Derived result{offspring_of(channel, "integral of"), {"integrate", channel.name, {}}};
  Channel copy = channel;
  std::optional<RemovedDrift> drift;
  if (options.quiet) {
    drift = remove_drift(copy, *options.quiet);
    result.edit.parameters = drift->edit.parameters;
  }
  const std::vector<double> f = sound_values(copy);
  std::vector<double> sum(f.size(), 0.0);
  for (std::size_t i = 1; i < f.size(); ++i)
    sum[i] = sum[i - 1] + 0.5 * channel.clock.interval * (f[i - 1] + f[i]);

  const double last = static_cast<double>(f.size() - 1);
  const double zero =
      std::clamp((options.zero_at - channel.clock.start) / channel.clock.interval, 0.0, last);
  const auto i = std::min(static_cast<std::size_t>(zero), f.size() - 2);
  const double part = zero - static_cast<double>(i);
  // The integrand is a straight line between samples, so its integral is a parabola.
  const double origin =
      sum[i] + channel.clock.interval * part * (f[i] + 0.5 * part * (f[i + 1] - f[i]));
  for (double& value : sum) value -= origin;
  result.channel.raw = std::move(sum);
  name_unit(channel, true, result.channel);
  if (drift) {
    const double error = std::max(drift->error_of_sum(zero, 0.0), drift->error_of_sum(zero, last));
    result.edit.parameters["uncertainty of the integral"] =
        fmt::format("{} {} at most",
                    datasets::figures(error * channel.clock.interval * result.channel.scale, 2),
                    result.channel.unit);
  }
  result.edit.parameters["rule"] = "trapezoidal";
  result.edit.parameters["zero at"] =
      fmt::format("{:.12g} s", channel.clock.start + channel.clock.interval * zero);
  return result;
}

Derived differentiate(const Channel& channel) {
  refuse_no_history(channel, 5);
  Derived result{offspring_of(channel, "derivative of"), {"differentiate", channel.name, {}}};
  const std::vector<double> f = sound_values(channel);
  const std::size_t n = f.size();
  // Row k: the derivative at the k-th of five samples, times 12 h.
  constexpr std::array<std::array<double, 5>, 5> stencils{{{-25, 48, -36, 16, -3},
                                                           {-3, -10, 18, -6, 1},
                                                           {1, -8, 0, 8, -1},
                                                           {-1, 6, -18, 10, 3},
                                                           {3, -16, 36, -48, 25}}};
  const std::vector<std::uint8_t> sound =
      result.channel.valid.empty() ? std::vector<std::uint8_t>(n, 1) : result.channel.valid;
  std::vector<double> slope(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t from = std::min(i > 2 ? i - 2 : 0, n - 5);
    const auto& stencil = stencils[i - from];
    double sum = 0.0;
    for (std::size_t k = 0; k < 5; ++k) {
      sum += stencil[k] * f[from + k];
      if (stencil[k] != 0.0 && !sound[from + k]) result.channel.valid[i] = 0;
    }
    slope[i] = sum / (12.0 * channel.clock.interval);
  }
  result.channel.raw = std::move(slope);
  name_unit(channel, false, result.channel);
  result.edit.parameters["rule"] = "five points, fourth order";
  return result;
}

}  // namespace impactrig::acquisition
