// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/baseline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/course_error.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "datasets/number_text.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;

namespace {

/// The course of a channel within a span, in its own unit, and standard errors of it.
struct Course {
  QuietFit fit;
  double of_level = 0.0;  ///< of its value in the middle of the span
  double of_rise = 0.0;   ///< of how much it changes from there to an end of the span

  double error_at(double index) const {
    return std::hypot(of_level, of_rise * (index - fit.middle) / fit.half);
  }
};

Course course_within(const Channel& channel, const TimeSpan& quiet, int degree, std::size_t least) {
  const IndexRange range = samples_in(channel, quiet);
  const std::size_t sound = sound_samples(channel, range);
  if (sound < least)
    throw std::invalid_argument(fmt::format(
        "channel '{}' has {} {}samples between {:.12g} s and {:.12g} s; at least {} are needed to "
        "know its baseline",
        channel.name, sound, sound < range.size() ? "sound " : "", quiet.begin, quiet.end, least));
  const std::vector<double> values = sound_values(channel);
  const double quantum = quantum_of(values);
  Course course{fit_quiet(values, range.begin, range.end, degree, quantum)};
  QuietResiduals about;
  for (std::size_t i = range.begin; i < range.end; ++i)
    about.residuals.push_back(values[i] - course.fit.at(static_cast<double>(i)));
  about.scatter = course.fit.sigma;
  about.quantum = quantum;
  about.rise = 2.0 * std::abs(course.fit.coefficients[1]);
  about.terms = degree + 1;
  course.of_level = std::sqrt(slow_variance(std::move(about)) / static_cast<double>(sound));
  if (degree > 0) course.of_rise = std::sqrt(3.0) * course.of_level;
  return course;
}

std::string uncertain(double value, const Channel& channel, const char* ending) {
  return fmt::format("{} {}{}", datasets::figures(value, 2), channel.unit, ending);
}

std::map<std::string, std::string> span_of(const TimeSpan& quiet) {
  return {{"from", fmt::format("{:.12g} s", quiet.begin)},
          {"to", fmt::format("{:.12g} s", quiet.end)}};
}

}  // namespace

Edit remove_baseline(Channel& channel, const TimeSpan& quiet) {
  const Course course = course_within(channel, quiet, 0, 3);
  const double baseline = course.fit.mean;
  channel.offset -= baseline;
  Edit edit{"remove baseline", channel.name, span_of(quiet)};
  edit.parameters["offset"] = fmt::format("{} {}", baseline, channel.unit);
  edit.parameters["uncertainty"] = uncertain(course.of_level, channel, "");
  return edit;
}

Edit remove_drift(Channel& channel, const TimeSpan& quiet) {
  const Course course = course_within(channel, quiet, 1, 8);
  const QuietFit& line = course.fit;
  std::vector<double> values = channel.values();
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= line.at(static_cast<double>(i));
  const double last = static_cast<double>(values.size()) - 1.0;
  replace_values(channel, std::move(values));
  const double span = line.half * channel.clock.interval;  // [s]
  Edit edit{"remove drift", channel.name, span_of(quiet)};
  edit.parameters["offset"] =
      fmt::format("{} {} at {:.9g} s, uncertain by {}", line.at(line.middle), channel.unit,
                  channel.clock.start + channel.clock.interval * line.middle,
                  uncertain(course.of_level, channel, ""));
  edit.parameters["slope"] =
      fmt::format("{} {}/s, uncertain by {}", line.coefficients[1] / span, channel.unit,
                  uncertain(course.of_rise / span, channel, "/s"));
  edit.parameters["uncertainty"] =
      uncertain(std::max(course.error_at(0.0), course.error_at(last)), channel, " at most");
  return edit;
}

}  // namespace impactrig::acquisition
