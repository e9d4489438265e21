// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/baseline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;

namespace {

/// The course of a channel within a span, in its own unit.
QuietFit course_within(const Channel& channel, const TimeSpan& quiet, int degree,
                       std::size_t least) {
  const double n = static_cast<double>(channel.size());
  const auto& clock = channel.clock;
  // A ten-thousandth of a step of grace: times are rounded.
  const double from = std::ceil((quiet.begin - clock.start) / clock.interval - 1e-4);
  const double to = std::floor((quiet.end - clock.start) / clock.interval + 1e-4) + 1.0;
  const auto begin = static_cast<std::size_t>(std::clamp(from, 0.0, n));
  const auto end = static_cast<std::size_t>(std::clamp(to, 0.0, n));
  if (end < begin + least)
    throw std::invalid_argument(
        fmt::format("channel '{}' has {} samples between {} s and {} s; at least {} are needed to "
                    "know its baseline",
                    channel.name, end > begin ? end - begin : 0, quiet.begin, quiet.end, least));
  std::vector<double> values = channel.values();
  bridge_invalid(values, channel.valid);
  return fit_quiet(values, begin, end, degree, quantum_of(values));
}

std::map<std::string, std::string> span_of(const TimeSpan& quiet) {
  return {{"from", fmt::format("{} s", quiet.begin)}, {"to", fmt::format("{} s", quiet.end)}};
}

}  // namespace

Edit remove_baseline(Channel& channel, const TimeSpan& quiet) {
  const double baseline = course_within(channel, quiet, 0, 3).mean;
  channel.offset -= baseline;
  Edit edit{"remove baseline", channel.name, span_of(quiet)};
  edit.parameters["offset"] = fmt::format("{} {}", baseline, channel.unit);
  return edit;
}

Edit remove_drift(Channel& channel, const TimeSpan& quiet) {
  const QuietFit course = course_within(channel, quiet, 1, 8);
  std::vector<double> values = channel.values();
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= course.at(static_cast<double>(i));
  channel.raw = std::move(values);
  channel.scale = 1.0;
  channel.offset = 0.0;
  const double slope = course.coefficients[1] / (course.half * channel.clock.interval);
  Edit edit{"remove drift", channel.name, span_of(quiet)};
  edit.parameters["offset"] = fmt::format("{} {}", course.at(course.middle), channel.unit);
  edit.parameters["slope"] = fmt::format("{} {}/s", slope, channel.unit);
  return edit;
}

}  // namespace impactrig::acquisition
