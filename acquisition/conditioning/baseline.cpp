// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/baseline.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
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

/// The course of a channel within a span, in its own unit, and what its error follows from.
struct Course {
  QuietFit fit;
  /// (2, 2), of its value in the middle of the span and its change from there to an end.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();

  double of_level() const { return std::sqrt(covariance(0, 0)); }

  double of_rise() const { return std::sqrt(covariance(1, 1)); }

  double error_at(double index) const {
    const Eigen::Vector2d row(1.0, (index - fit.middle) / fit.half);
    return std::sqrt(row.dot(covariance * row));
  }
};

/// Of a course through samples of variance 1, of which those count, not evenly spread, that have a
/// residual.
Eigen::Matrix2d unit_covariance(const QuietFit& fit, const std::vector<double>& residuals,
                                int degree) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    if (std::isnan(residuals[k])) continue;
    const Eigen::Vector2d row(1.0, (static_cast<double>(fit.begin + k) - fit.middle) / fit.half);
    normal += row * row.transpose();
  }
  if (degree > 0) return normal.inverse();
  Eigen::Matrix2d of_level = Eigen::Matrix2d::Zero();
  of_level(0, 0) = 1.0 / normal(0, 0);
  return of_level;
}

Course course_within(const Channel& channel, const TimeSpan& quiet, int degree, std::size_t least) {
  const IndexRange range = samples_in(channel, quiet);
  const std::size_t sound = sound_samples(channel, range);
  if (sound < least)
    throw std::invalid_argument(fmt::format(
        "channel '{}' has {} {}samples between {:.12g} s and {:.12g} s; at least {} are needed to "
        "know its baseline",
        channel.name, sound, sound < range.size() ? "sound " : "", quiet.begin, quiet.end, least));
  const std::vector<double> values = sound_values(channel);
  const std::vector<std::uint8_t> marks = sound_marks(channel);
  const double quantum = quantum_of(values, marks);
  Course course{fit_quiet(values, range.begin, range.end, degree, quantum, marks)};
  QuietResiduals about;
  for (std::size_t i = range.begin; i < range.end; ++i)
    about.residuals.push_back(marks.empty() || marks[i] != 0
                                  ? values[i] - course.fit.at(static_cast<double>(i))
                                  : std::numeric_limits<double>::quiet_NaN());
  about.scatter = course.fit.sigma;
  about.quantum = quantum;
  about.rise = 2.0 * std::abs(course.fit.coefficients[1]);
  about.terms = degree + 1;
  course.covariance = unit_covariance(course.fit, about.residuals, degree);
  course.covariance *= slow_variance(std::move(about));
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

RemovedBaseline remove_baseline(Channel& channel, const TimeSpan& quiet) {
  const Course course = course_within(channel, quiet, 0, 3);
  const double baseline = course.fit.mean;
  channel.offset -= baseline;
  Edit edit{"remove baseline", channel.name, span_of(quiet)};
  edit.parameters["offset"] = fmt::format("{} {}", baseline, channel.unit);
  edit.parameters["uncertainty"] = uncertain(course.of_level(), channel, "");
  return {std::move(edit), course.of_level(), course.fit.sigma, course.fit.correlation};
}

double RemovedDrift::error_of_sum(double from, double to) const {
  const double length = to - from;
  const double moment = 0.5 * length * (to + from - 2.0 * middle) / half;
  const double by_line =
      length * length * of_level + moment * moment * of_rise + 2.0 * length * moment * of_both;
  return std::sqrt(by_line + noise * noise * correlation * std::abs(length));
}

RemovedDrift remove_drift(Channel& channel, const TimeSpan& quiet) {
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
                  uncertain(course.of_level(), channel, ""));
  edit.parameters["slope"] =
      fmt::format("{} {}/s, uncertain by {}", line.coefficients[1] / span, channel.unit,
                  uncertain(course.of_rise() / span, channel, "/s"));
  edit.parameters["uncertainty"] =
      uncertain(std::max(course.error_at(0.0), course.error_at(last)), channel, " at most");
  return {.edit = std::move(edit),
          .middle = line.middle,
          .half = line.half,
          .of_level = course.covariance(0, 0),
          .of_rise = course.covariance(1, 1),
          .of_both = course.covariance(0, 1),
          .noise = line.sigma,
          .correlation = line.correlation};
}

}  // namespace impactrig::acquisition
