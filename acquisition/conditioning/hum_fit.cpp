// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/hum_fit.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

#include "acquisition/conditioning/course_error.hpp"
#include "acquisition/conditioning/samples.hpp"

namespace impactrig::acquisition {

namespace {

using Index = Eigen::Index;
using std::numbers::pi;

Index index(std::size_t m) {
  return static_cast<Index>(m);
}

/// What the mean of n samples does to a sinusoid, sin(n x) / (n sin x) with x = pi f step, and its
/// derivative by f.
struct Smoothing {
  double gain = 1.0, slope = 0.0;

  Smoothing(double frequency, double step, int samples) {
    if (samples == 1) return;
    const double n = samples;
    const double x = pi * frequency * step;
    gain = std::sin(n * x) / (n * std::sin(x));
    slope = pi * step * (std::cos(n * x) / std::sin(x) - gain / std::tan(x));
  }
};

/// The rows of a least squares problem: sinusoids at a frequency and lines.
class Rows {
 public:
  Rows(const HumPoints& all, const HumFit& fit)
      : all_(all),
        fit_(fit),
        middle_(all.points.front().time + 0.5 * all.span()) {
    for (const int m : fit.multiples) gains_.push_back(gains_of(m));
    double samples = 0.0;
    for (const HumPoint& point : all.points) samples += point.samples;
    mean_samples_ = samples / static_cast<double>(all.points.size());
  }

  /// Of a point: its samples over their mean number.
  double weight(const HumPoint& point) const { return point.samples / mean_samples_; }

  Index terms() const { return 2 * index(fit_.multiples.size() + all_.stretches); }

  void write(const HumPoint& point, Eigen::Ref<Eigen::VectorXd> row) const {
    row.setZero();
    const double phase = 2.0 * pi * fit_.frequency * point.time;
    for (std::size_t m = 0; m < fit_.multiples.size(); ++m) {
      const double gain = smoothing(m, point).gain;
      const double angle = phase * fit_.multiples[m];
      row[2 * index(m)] = gain * std::cos(angle);
      row[2 * index(m) + 1] = gain * std::sin(angle);
    }
    const Index line = 2 * index(fit_.multiples.size()) + 2 * point.stretch;
    row[line] = 1.0;
    row[line + 1] = point.u;
  }

  /// The derivative of the fitted sinusoids by the frequency, their phases held in the middle.
  double slope(const HumPoint& point, const Eigen::Ref<const Eigen::VectorXd>& row) const {
    double slope = 0.0;
    for (std::size_t m = 0; m < fit_.multiples.size(); ++m) {
      const double a = fit_.coefficients[2 * index(m)], b = fit_.coefficients[2 * index(m) + 1];
      const double c = row[2 * index(m)], s = row[2 * index(m) + 1];
      const Smoothing& smooth = smoothing(m, point);
      const int times = fit_.multiples[m];
      slope += 2.0 * pi * times * (point.time - middle_) * (b * c - a * s) +
               times * smooth.slope / smooth.gain * (a * c + b * s);
    }
    return slope;
  }

 private:
  /// By the number of samples, from 1.
  std::vector<Smoothing> gains_of(int multiple) const {
    int most = 1;
    for (const HumPoint& point : all_.points) most = std::max(most, point.samples);
    std::vector<Smoothing> gains;
    for (int n = 1; n <= most; ++n) gains.emplace_back(fit_.frequency * multiple, all_.step, n);
    return gains;
  }

  const Smoothing& smoothing(std::size_t m, const HumPoint& point) const {
    return gains_[m][static_cast<std::size_t>(point.samples - 1)];
  }

  const HumPoints& all_;
  const HumFit& fit_;
  double middle_;
  double mean_samples_ = 1.0;
  std::vector<std::vector<Smoothing>> gains_;
};

/// Hands the rows of all points to `use(first, rows)`, one a column, some hundred at a time.
template <typename Use>
void for_each_piece(const HumPoints& all, const Rows& rows, const Use& use) {
  constexpr std::size_t at_once = 256;
  Eigen::MatrixXd piece(rows.terms(), at_once);
  for (std::size_t first = 0; first < all.points.size(); first += at_once) {
    const std::size_t n = std::min(at_once, all.points.size() - first);
    for (std::size_t i = 0; i < n; ++i) rows.write(all.points[first + i], piece.col(index(i)));
    use(first, piece.leftCols(index(n)));
  }
}

}  // namespace

HumPoints hum_points(const datasets::Channel& channel, const datasets::RemoveHum& hum,
                     std::span<const double> values, double widest) {
  const double step = channel.clock.interval;
  const auto most = static_cast<std::size_t>(std::max(1.0, std::floor(widest / step)));
  const std::vector<std::uint8_t> marks = sound_marks(channel);
  HumPoints all{{}, hum.quiet.size(), step};
  for (std::size_t s = 0; s < hum.quiet.size(); ++s) {
    const IndexRange range = samples_in(channel, hum.quiet[s]);
    const auto sound = [&](std::size_t i) { return marks.empty() || marks[i] != 0; };
    const double middle = 0.5 * static_cast<double>(range.begin + range.end);
    const double half = std::max(1.0, 0.5 * static_cast<double>(range.size()));
    for (std::size_t i = range.begin; i < range.end;) {
      std::size_t n = 0;
      double sum = 0.0;
      for (; n < most && i + n < range.end && sound(i + n); ++n) sum += values[i + n];
      if (n > 0) {
        const double place = static_cast<double>(i) + 0.5 * static_cast<double>(n - 1);
        all.points.push_back({channel.clock.start + step * place, sum / static_cast<double>(n),
                              (place - middle) / half, static_cast<int>(s), static_cast<int>(n)});
      }
      i += std::max<std::size_t>(n, 1);
    }
  }
  return all;
}

double HumFit::amplitude(std::size_t m) const {
  return std::hypot(coefficients[2 * index(m)], coefficients[2 * index(m) + 1]);
}

double HumFit::error(std::size_t m) const {
  const Index k = 2 * index(m);
  return std::sqrt(std::max(covariance(k, k), covariance(k + 1, k + 1)));
}

double HumFit::significance(std::size_t m) const {
  const Index k = 2 * index(m);
  const Eigen::Vector2d parts = coefficients.segment<2>(k);
  const Eigen::Matrix2d inverse = covariance.block<2, 2>(k, k).inverse();
  return std::sqrt(parts.dot(inverse * parts));
}

double HumFit::error_at(double time) const {
  const Index n = 2 * index(multiples.size());
  Eigen::VectorXd row(n);
  for (std::size_t m = 0; m < multiples.size(); ++m) {
    const double phase = 2.0 * pi * frequency * multiples[m] * time;
    row[2 * index(m)] = std::cos(phase);
    row[2 * index(m) + 1] = std::sin(phase);
  }
  return std::sqrt(std::max(0.0, row.dot(covariance.topLeftCorner(n, n) * row)));
}

void HumFit::take_off(std::span<double> values, double start, double step) const {
  constexpr std::size_t at_once = 256;  // phasors are turned so often before they are made anew
  for (std::size_t m = 0; m < multiples.size(); ++m) {
    const double omega = 2.0 * pi * frequency * multiples[m];
    const std::complex<double> turn = std::polar(1.0, omega * step);
    const std::complex<double> parts(coefficients[2 * index(m)], -coefficients[2 * index(m) + 1]);
    for (std::size_t first = 0; first < values.size(); first += at_once) {
      const double time = start + step * static_cast<double>(first);
      std::complex<double> phasor = parts * std::polar(1.0, omega * time);
      for (double& value : values.subspan(first, std::min(at_once, values.size() - first))) {
        value -= phasor.real();
        phasor = {phasor.real() * turn.real() - phasor.imag() * turn.imag(),
                  phasor.real() * turn.imag() + phasor.imag() * turn.real()};
      }
    }
  }
}

HumFit fit_hum(const HumPoints& all, double frequency, std::vector<int> multiples,
               HumFigures figures) {
  HumFit fit;
  fit.frequency = frequency;
  fit.multiples = std::move(multiples);
  const Rows rows(all, fit);
  const Index terms = rows.terms();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
  for_each_piece(all, rows, [&](std::size_t first, const auto& piece) {
    for (Index i = 0; i < piece.cols(); ++i)
      normal.selfadjointView<Eigen::Lower>().rankUpdate(
          piece.col(i), rows.weight(all.points[first + static_cast<std::size_t>(i)]));
    for (Index i = 0; i < piece.cols(); ++i) {
      const HumPoint& point = all.points[first + static_cast<std::size_t>(i)];
      right += piece.col(i) * (rows.weight(point) * point.value);
    }
  });
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal.selfadjointView<Eigen::Lower>());
  fit.coefficients = solver.solve(right);

  const bool corrected = figures == HumFigures::correction;
  Eigen::VectorXd shared = Eigen::VectorXd::Zero(terms);  // of slopes and rows
  double slopes = 0.0, pull = 0.0;
  QuietResiduals about;
  for_each_piece(all, rows, [&](std::size_t first, const auto& piece) {
    for (Index i = 0; i < piece.cols(); ++i) {
      const HumPoint& point = all.points[first + static_cast<std::size_t>(i)];
      const double residual = point.value - piece.col(i).dot(fit.coefficients);
      const double weight = rows.weight(point);
      fit.squares += weight * residual * residual;
      if (figures == HumFigures::errors) about.residuals.push_back(weight * residual);
      if (!corrected) continue;
      const double slope = rows.slope(point, piece.col(i));
      shared += piece.col(i) * (weight * slope);
      slopes += weight * slope * slope;
      pull += weight * slope * residual;
    }
  });
  if (corrected) {
    const double own = slopes - shared.dot(solver.solve(shared));
    fit.correction = own > 0.0 ? pull / own : 0.0;
  }
  if (figures != HumFigures::errors) return fit;
  const double freedom =
      std::max(1.0, static_cast<double>(all.points.size()) - static_cast<double>(terms));
  const double squares = std::transform_reduce(about.residuals.begin(), about.residuals.end(), 0.0,
                                               std::plus<>(), [](double r) { return r * r; });
  about.scatter = std::sqrt(squares / freedom);
  about.terms = static_cast<int>(terms);
  fit.variance = slow_variance(std::move(about));
  fit.covariance = fit.variance * solver.solve(Eigen::MatrixXd::Identity(terms, terms));
  return fit;
}

std::vector<int> hum_multiples(int harmonics) {
  std::vector<int> multiples;
  for (int m = 1; m <= harmonics; ++m) multiples.push_back(m);
  return multiples;
}

}  // namespace impactrig::acquisition
