// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/low_pass.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "acquisition/conditioning/digitiser_step.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "datasets/zero_phase_low_pass.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::LowPass;

namespace {

/// Slower than a period in the record, all that is left is how the record was prolonged.
void refuse_shorter_than_a_period(const Channel& channel, const LowPass& filter) {
  const double length = channel.clock.interval * static_cast<double>(channel.size());
  if (!(filter.cutoff > 0.0) || filter.cutoff * length >= 1.0 - 1e-9) return;
  throw std::invalid_argument(
      fmt::format("a low-pass at {:g} Hz has less than one period in the {:g} s of channel '{}'; "
                  "filter at {:g} Hz or more, or take a straight line off (step = \"drift\")",
                  filter.cutoff, length, channel.name, 1.0 / length));
}

}  // namespace

LowPassed low_pass(Channel& channel, const LowPass& filter) {
  const std::vector<double> before = sound_values(channel);
  refuse_shorter_than_a_period(channel, filter);
  std::vector<double> after = datasets::zero_phase_low_pass(before, channel.clock.interval, filter);
  const double from = largest_departure(before), to = largest_departure(after);
  LowPassed result;
  result.edit = {"low-pass, zero phase", channel.name, {}};
  auto& parameters = result.edit.parameters;
  parameters["cutoff"] = fmt::format("{:.12g} Hz", filter.cutoff);
  parameters["order"] = fmt::format("{}, forwards and backwards", filter.order);
  parameters["largest departure"] = fmt::format("{:.6g} {}, before {:.6g}", to, channel.unit, from);
  note_digitiser_step(before, channel.valid, channel, result.edit);
  result.lost = from != 0.0 ? 1.0 - std::abs(to / from) : 0.0;
  channel.valid = sound_marks(channel);
  replace_values(channel, std::move(after));
  return result;
}

}  // namespace impactrig::acquisition
