// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/decay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/baseline.hpp"
#include "acquisition/conditioning/decay_fit.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "datasets/number_text.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;

namespace {

/// What was fitted, and what that is uncertain by. Refuses where the data do not tell T.
void state(const Channel& channel, const FittedDecay& fitted, bool time_known, Edit& edit) {
  const Decay& decay = fitted.decay;
  const auto text = [](double value) { return datasets::figures(value, 2); };
  if (time_known) {
    edit.parameters["time constant"] = fmt::format("{:.12g} s, stated", decay.time);
  } else {
    const double uncertainty = fitted.errors.of_time;
    if (!(uncertainty < 0.5 * decay.time))
      throw std::invalid_argument(fmt::format(
          "the quiet samples of channel '{}' do not tell the time constant of a decay "
          "({:.3g} s, uncertain by {:.3g} s); state time_constant, or take a straight line off "
          "(step = \"drift\")",
          channel.name, decay.time, uncertainty));
    edit.parameters["time constant"] = fmt::format("{:.6g} s, from the data", decay.time);
    edit.parameters["uncertainty"] = fmt::format("{:.3g} s", uncertainty);
  }
  edit.parameters["offset"] =
      fmt::format("{:.6g} {}, uncertain by {} {}", decay.constant, channel.unit,
                  text(fitted.errors.of_constant), channel.unit);
  edit.parameters["amplitude"] =
      fmt::format("{:.6g} {} at {:.9g} s, uncertain by {} {}", decay.amplitude, channel.unit,
                  decay.origin, text(fitted.errors.of_amplitude), channel.unit);
  edit.parameters["uncertainty of what came off"] =
      fmt::format("{} {} at most", text(fitted.errors.at_most), channel.unit);
  if (fitted.errors.misfit > 0.0)
    edit.parameters["misfit"] =
        fmt::format("{} {} at most", text(fitted.errors.misfit), channel.unit);
  if (decay.hum > 0.0)
    edit.parameters["fitted beside"] = fmt::format("hum of {:.6g} Hz", decay.hum);
}

}  // namespace

Edit remove_decay(Channel& channel, const datasets::RemoveDecay& wanted,
                  const datasets::RemoveHum* hum) {
  const FittedDecay fitted = fit_decay(channel, wanted, hum);
  Edit edit{"remove decay", channel.name, {{"quiet", text_of(wanted.quiet)}}};
  state(channel, fitted, wanted.time_constant.has_value(), edit);
  std::vector<double> values = channel.values();
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] -= fitted.decay.at(channel.clock.time(i));
  replace_values(channel, std::move(values));
  return edit;
}

namespace {

/// Standard error of the sum of `values` where lines bridge what is not valid, in their unit: of
/// noise, whose two samples beside a gap of n stand for all within it, and of a corner in the
/// middle of the gap between the courses on both sides, of as many samples.
double error_of_bridged(const std::vector<double>& values, const std::vector<std::uint8_t>& marks,
                        const RemovedBaseline& noise) {
  double variance = 0.0;
  const std::size_t size = marks.size();
  for (std::size_t begin = 0; begin < size; ++begin) {
    if (marks[begin] != 0) continue;
    std::size_t end = begin;
    while (end < size && marks[end] == 0) ++end;
    const std::size_t reach = std::max<std::size_t>(3, end - begin);
    const auto slope = [&](std::size_t from, std::size_t to) {
      if (to < from + 3) return 0.0;
      const QuietFit course = fit_quiet(values, from, to, 1, 0.0, marks);
      return course.coefficients[1] / course.half;
    };
    const double n = static_cast<double>(end - begin);
    const double bend =
        slope(begin > reach ? begin - reach : 0, begin) - slope(end, std::min(size, end + reach));
    variance += noise.noise * noise.noise * (0.5 * n * n + noise.correlation * n) +
                std::pow((n + 1.0) * (n + 1.0) / 8.0 * bend, 2);
    begin = end;
  }
  return std::sqrt(variance);
}

}  // namespace

Edit undo_low_cut(Channel& channel, const datasets::UndoLowCut& low_cut) {
  if (!(low_cut.frequency > 0.0))
    throw std::invalid_argument(
        fmt::format("a low cut at {:g} Hz is not positive", low_cut.frequency));
  Edit edit{"undo low cut", channel.name, {}};
  if (low_cut.quiet) {
    RemovedBaseline baseline = remove_baseline(channel, *low_cut.quiet);
    edit.parameters = std::move(baseline.edit.parameters);
    const double grown = 1.0 + 2.0 * std::numbers::pi * low_cut.frequency * channel.clock.interval *
                                   static_cast<double>(channel.size());
    const double step = 2.0 * std::numbers::pi * low_cut.frequency * channel.clock.interval;
    const double error =
        std::hypot(grown * baseline.uncertainty,
                   step * error_of_bridged(sound_values(channel), sound_marks(channel), baseline));
    edit.parameters["uncertainty"] =
        fmt::format("{} {} at most", datasets::figures(error, 2), channel.unit);
  }
  edit.parameters["frequency"] = fmt::format("{:.12g} Hz, first order", low_cut.frequency);
  std::vector<double> values = sound_values(channel);
  const double half_step = std::numbers::pi * low_cut.frequency * channel.clock.interval;
  double previous = values.front(), integral = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double value = values[i];
    integral += half_step * (previous + value);
    previous = value;
    values[i] = value + integral;
  }
  channel.valid = sound_marks(channel);
  replace_values(channel, std::move(values));
  return edit;
}

}  // namespace impactrig::acquisition
