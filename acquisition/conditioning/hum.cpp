// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/hum.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/samples.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;
using datasets::RemoveHum;
using datasets::TimeSpan;

namespace {

constexpr double significant = 4.0;     ///< standard errors
constexpr double enough_periods = 5.0;  ///< to tell the frequency
constexpr double mains_tolerance = 0.02;

/// Means of blocks of quiet samples.
struct Point {
  double time, value;  ///< [s], middle of the block; [the channel's unit]
  double width;        ///< of the block [s]
  double u;            ///< place within its stretch, -1 to 1
  int stretch;
};

/// Blocks of at most `widest` [s] within each stretch; invalid samples end a block.
std::vector<Point> points_of(const Channel& channel, const RemoveHum& hum,
                             std::span<const double> values, double widest) {
  const double step = channel.clock.interval;
  const auto most = static_cast<std::size_t>(std::max(1.0, std::floor(widest / step)));
  std::vector<Point> points;
  for (std::size_t s = 0; s < hum.quiet.size(); ++s) {
    const IndexRange range = samples_in(channel, hum.quiet[s]);
    const double middle = 0.5 * static_cast<double>(range.begin + range.end);
    const double half = std::max(1.0, 0.5 * static_cast<double>(range.size()));
    for (std::size_t i = range.begin; i < range.end;) {
      std::size_t n = 0;
      double sum = 0.0;
      for (; n < most && i + n < range.end && channel.is_valid(i + n); ++n) sum += values[i + n];
      if (n > 0) {
        const double index = static_cast<double>(i) + 0.5 * static_cast<double>(n - 1);
        points.push_back({channel.clock.start + step * index, sum / static_cast<double>(n),
                          step * static_cast<double>(n), (index - middle) / half,
                          static_cast<int>(s)});
      }
      i += std::max<std::size_t>(n, 1);
    }
  }
  return points;
}

/// What averaging over a width does to a sinusoid.
double smoothing(double frequency, double width) {
  const double x = std::numbers::pi * frequency * width;
  return x < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

/// Least squares of lines and sinusoids.
struct HumFit {
  double frequency = 0.0;
  std::vector<int> multiples;
  Eigen::VectorXd coefficients;  ///< (2 m + 2 stretches): cosine, sine of each multiple; lines
  Eigen::MatrixXd covariance;    ///< of them
  double squares = 0.0;
  double variance = 0.0;  ///< of one residual, times their autocorrelation time

  double amplitude(std::size_t m) const {
    return std::hypot(coefficients[2 * index(m)], coefficients[2 * index(m) + 1]);
  }

  /// Of an amplitude: the larger of the standard errors of its two parts.
  double error(std::size_t m) const {
    const Eigen::Index k = 2 * index(m);
    return std::sqrt(std::max(covariance(k, k), covariance(k + 1, k + 1)));
  }

  Eigen::RowVectorXd sinusoids(double time, double width) const {
    Eigen::RowVectorXd row(2 * index(multiples.size()));
    for (std::size_t m = 0; m < multiples.size(); ++m) {
      const double f = frequency * multiples[m];
      const double phase = 2.0 * std::numbers::pi * f * time;
      const double gain = smoothing(f, width);
      row[2 * index(m)] = gain * std::cos(phase);
      row[2 * index(m) + 1] = gain * std::sin(phase);
    }
    return row;
  }

  double at(double time) const {
    const Eigen::RowVectorXd row = sinusoids(time, 0.0);
    return row.dot(coefficients.head(row.size()));
  }

  double error_at(double time) const {
    const Eigen::RowVectorXd row = sinusoids(time, 0.0);
    const auto n = row.size();
    return std::sqrt(std::max(0.0, (row * covariance.topLeftCorner(n, n) * row.transpose())(0, 0)));
  }

  static Eigen::Index index(std::size_t m) { return static_cast<Eigen::Index>(m); }
};

HumFit fitted(const std::vector<Point>& points, std::size_t stretches, double frequency,
              std::vector<int> multiples, bool with_errors) {
  HumFit fit;
  fit.frequency = frequency;
  fit.multiples = std::move(multiples);
  const Eigen::Index waves = 2 * HumFit::index(fit.multiples.size());
  const Eigen::Index terms = waves + 2 * HumFit::index(stretches);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
  const auto row_of = [&](const Point& point) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(terms);
    row.head(waves) = fit.sinusoids(point.time, point.width).transpose();
    row[waves + 2 * point.stretch] = 1.0;
    row[waves + 2 * point.stretch + 1] = point.u;
    return row;
  };
  for (const Point& point : points) {
    const Eigen::VectorXd row = row_of(point);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right += row * point.value;
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal.selfadjointView<Eigen::Lower>());
  fit.coefficients = solver.solve(right);
  std::vector<double> residuals;
  residuals.reserve(points.size());
  for (const Point& point : points)
    residuals.push_back(point.value - row_of(point).dot(fit.coefficients));
  for (const double residual : residuals) fit.squares += residual * residual;
  if (!with_errors) return fit;
  const double freedom =
      std::max(1.0, static_cast<double>(points.size()) - static_cast<double>(terms));
  fit.variance = fit.squares / freedom * correlation_time(residuals);
  fit.covariance = fit.variance * solver.solve(Eigen::MatrixXd::Identity(terms, terms));
  return fit;
}

std::vector<int> multiples_to(int harmonics) {
  std::vector<int> multiples;
  for (int m = 1; m <= harmonics; ++m) multiples.push_back(m);
  return multiples;
}

/// The fundamental within the mains' tolerance: a scan, finer than the width of the minimum, of it
/// alone; then Brent's method with its multiples.
double fundamental(const std::vector<Point>& coarse, const std::vector<Point>& points,
                   std::size_t stretches, double stated, int harmonics, double span) {
  const auto squares = [&](double f) { return fitted(coarse, stretches, f, {1}, false).squares; };
  const double lowest = (1.0 - mains_tolerance) * stated;
  const double highest = (1.0 + mains_tolerance) * stated;
  const double step = std::min(0.2 / span, 0.25 * (highest - lowest));
  double best = stated, least = squares(stated);
  for (double f = lowest; f <= highest; f += step) {
    const double value = squares(f);
    if (value >= least) continue;
    best = f;
    least = value;
  }
  const std::vector<int> all = multiples_to(harmonics);
  const auto squares_of_all = [&](double f) {
    return fitted(points, stretches, f, all, false).squares;
  };
  return boost::math::tools::brent_find_minima(squares_of_all, std::max(lowest, best - step),
                                               std::min(highest, best + step), 24)
      .first;
}

/// Leaves out the least significant multiple until all that is left is significant.
HumFit significant_part(const std::vector<Point>& points, std::size_t stretches, double frequency,
                        int harmonics) {
  std::vector<int> multiples = multiples_to(harmonics);
  for (;;) {
    HumFit fit = fitted(points, stretches, frequency, multiples, true);
    std::size_t weakest = 0;
    double least = INFINITY;
    for (std::size_t m = 0; m < multiples.size(); ++m) {
      const double ratio = fit.amplitude(m) / fit.error(m);
      if (ratio >= least) continue;
      least = ratio;
      weakest = m;
    }
    if (!(least < significant)) return fit;
    multiples.erase(multiples.begin() + static_cast<std::ptrdiff_t>(weakest));
    if (multiples.empty()) return fitted(points, stretches, frequency, {}, true);
  }
}

void refuse_senseless(const Channel& channel, const RemoveHum& hum, double frequency) {
  if (!(frequency > 0.0))
    throw std::invalid_argument(
        fmt::format("a mains frequency of {:g} Hz is not positive", frequency));
  if (hum.harmonics < 1 || hum.harmonics > 20)
    throw std::invalid_argument(fmt::format("hum has 1 to 20 harmonics, not {}", hum.harmonics));
  if (!(4.0 * hum.harmonics * frequency * channel.clock.interval < 1.0))
    throw std::invalid_argument(fmt::format(
        "multiple {} of {:g} Hz is not below a quarter of the sample rate of channel '{}'",
        hum.harmonics, frequency, channel.name));
}

/// The largest standard error of the hum anywhere in the record. Where the frequency is from the
/// data its own error, √6 s / (pi A T √n) [RifeBoorstyn1974], grows with the distance from them.
double largest_error(const Channel& channel, const std::vector<Point>& points, const HumFit& fit,
                     bool frequency_from_data) {
  const double first = points.front().time, last = points.back().time;
  const double n = static_cast<double>(points.size());
  const double drift =  // of the phase, times the amplitude [unit/s]
      frequency_from_data
          ? 2.0 * std::sqrt(6.0 * fit.variance / n) / (last - first) * fit.multiples.back()
          : 0.0;
  constexpr int places = 512;
  const double length = channel.clock.interval * static_cast<double>(channel.size());
  double largest = 0.0;
  for (int i = 0; i <= places; ++i) {
    const double time = channel.clock.start + length * i / places;
    const double error = std::hypot(fit.error_at(time), drift * (time - 0.5 * (first + last)));
    largest = std::max(largest, error);
  }
  return largest;
}

}  // namespace

Edit remove_hum(Channel& channel, const RemoveHum& hum) {
  std::vector<double> values = sound_values(channel);
  const double stated = hum.frequency.value_or(50.0);
  refuse_senseless(channel, hum, stated);
  const std::size_t stretches = hum.quiet.size();
  double quiet = 0.0;  // [s]
  for (const TimeSpan& stretch : hum.quiet)
    quiet += channel.clock.interval * static_cast<double>(samples_in(channel, stretch).size());
  const double widest = std::min(1.0 / (20.0 * stated * hum.harmonics), quiet / 256.0);
  const std::vector<Point> points = points_of(channel, hum, values, widest);
  if (points.size() < 32)
    throw std::invalid_argument(
        fmt::format("channel '{}' has {} samples at quiet times ({}); at least 32 are needed to "
                    "know its hum",
                    channel.name, points.size(), text_of(hum.quiet)));

  const double span = points.back().time - points.front().time;
  double frequency = stated;
  if (span * stated >= enough_periods)
    frequency = fundamental(points_of(channel, hum, values, 0.05 / stated), points, stretches,
                            stated, hum.harmonics, span);
  const HumFit fit = significant_part(points, stretches, frequency, hum.harmonics);

  Edit edit{"remove hum", channel.name, {{"quiet", text_of(hum.quiet)}}};
  if (fit.multiples.empty()) {
    edit.parameters["found"] = "nothing above the noise, so nothing was taken off";
    return edit;
  }
  double amplitude = 0.0, error = 0.0;
  for (std::size_t m = 0; m < fit.multiples.size(); ++m) {
    amplitude += fit.amplitude(m);
    edit.parameters[fmt::format("amplitude {}", fit.multiples[m])] =
        fmt::format("{:.4g} {}, uncertain by {:.2g}", fit.amplitude(m), channel.unit, fit.error(m));
  }
  error = largest_error(channel, points, fit, span * stated >= enough_periods);
  if (!(error <= 0.5 * amplitude))
    throw std::invalid_argument(fmt::format(
        "the quiet samples of channel '{}' do not tell hum from drift: what would be taken off has "
        "an amplitude of {:.3g} {}, uncertain by up to {:.3g}; record at least a period of the "
        "mains before the trigger, or leave this step out",
        channel.name, amplitude, channel.unit, error));
  edit.parameters["frequency"] =
      fmt::format("{:.6g} Hz{}", frequency, span * stated >= enough_periods ? "" : ", stated");
  edit.parameters["uncertainty"] = fmt::format("{:.2g} {} at most", error, channel.unit);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= fit.at(channel.clock.time(i));
  // Samples that are not sound keep what was recorded.
  if (!channel.valid.empty())
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!channel.is_valid(i)) values[i] = channel.value(i);
  replace_values(channel, std::move(values));
  return edit;
}

}  // namespace impactrig::acquisition
