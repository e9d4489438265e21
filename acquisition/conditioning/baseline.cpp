// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/baseline.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/samples.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;

namespace {

/// The course of a channel within a span, in its own unit.
QuietFit course_within(const Channel& channel, const TimeSpan& quiet, int degree,
                       std::size_t least) {
  const IndexRange range = samples_in(channel, quiet);
  const std::size_t sound = sound_samples(channel, range);
  if (sound < least)
    throw std::invalid_argument(fmt::format(
        "channel '{}' has {} {}samples between {:.12g} s and {:.12g} s; at least {} are needed to "
        "know its baseline",
        channel.name, sound, sound < range.size() ? "sound " : "", quiet.begin, quiet.end, least));
  const std::vector<double> values = sound_values(channel);
  return fit_quiet(values, range.begin, range.end, degree, quantum_of(values));
}

std::map<std::string, std::string> span_of(const TimeSpan& quiet) {
  return {{"from", fmt::format("{:.12g} s", quiet.begin)},
          {"to", fmt::format("{:.12g} s", quiet.end)}};
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
  replace_values(channel, std::move(values));
  const double slope = course.coefficients[1] / (course.half * channel.clock.interval);
  Edit edit{"remove drift", channel.name, span_of(quiet)};
  edit.parameters["offset"] = fmt::format("{} {}", course.at(course.middle), channel.unit);
  edit.parameters["slope"] = fmt::format("{} {}/s", slope, channel.unit);
  return edit;
}

}  // namespace impactrig::acquisition
