// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/steady_drift.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr int blocks = 128, few = blocks / 16;
constexpr double mains[] = {50.0, 60.0};  // [Hz]

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

double middle_of(const Eigen::VectorXd& values) {
  return median({values.begin(), values.end()});
}

/// A few values that tell a course, and where they lie [samples].
struct Points {
  double samples;  ///< of the record
  Eigen::VectorXd at, values;

  double begin() const { return middle_of(values.head(few)); }

  double end() const { return middle_of(values.tail(few)); }
};

/// Medians of blocks: no spike and no noise to speak of.
Points medians(std::span<const double> y) {
  Points points{as_double(y.size()), Eigen::VectorXd(blocks), Eigen::VectorXd(blocks)};
  for (int k = 0; k < blocks; ++k) {
    const std::size_t begin = y.size() * static_cast<std::size_t>(k) / blocks;
    const std::size_t end = y.size() * static_cast<std::size_t>(k + 1) / blocks;
    points.at[k] = 0.5 * (as_double(begin) + as_double(end) - 1.0);
    points.values[k] = median(evenly_spread(y.subspan(begin, end - begin), 256));
  }
  return points;
}

/// What a drift leaves of the points.
struct Fit {
  SteadyDrift drift;
  Eigen::VectorXd off;
  double spread = INFINITY;  ///< of the points that are no pulse's
  double sum = INFINITY;     ///< of all distances: what few points tell counts too

  double way(const Points& points) const {
    const Eigen::VectorXd course = points.values - off;
    return course.maxCoeff() - course.minCoeff();
  }

  /// Whether the record begins and ends in it, as one does that has its pulses inside and the same
  /// drift on both sides.
  bool holds_at_both_ends(double error) const {
    const double first = std::abs(off[0]), last = std::abs(off[blocks - 1]);
    return std::abs(middle_of(off.head(few))) <= error &&
           std::abs(middle_of(off.tail(few))) <= error && std::max(first, last) <= 2.5 * error;
  }
};

/// By least squares with weights of 1 over the distance, in rounds, pulses count little; at last,
/// those do not that are far off.
Fit fit_points(const Points& points, const SteadyDrift::Shape& shape) {
  constexpr int rounds = 24, last_rounds = 3;
  constexpr double far = 3.0;  // of the spread
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, blocks,
                             SteadyDrift::most_terms>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, SteadyDrift::most_terms,
                               SteadyDrift::most_terms>;
  Fit fit{.drift = SteadyDrift(shape, points.samples), .off = {}};
  Rows terms(blocks, fit.drift.terms()), weighted;
  for (int i = 0; i < blocks; ++i) terms.row(i) = fit.drift.terms_at(points.at[i]);
  std::vector<double> distance(blocks), weight(blocks, 1.0);
  for (int round = 0; round < rounds; ++round) {
    weighted = Eigen::Map<const Eigen::VectorXd>(weight.data(), blocks).asDiagonal() * terms;
    const Square normal = weighted.transpose() * terms;
    fit.drift.coefficients = normal.ldlt().solve(weighted.transpose() * points.values).transpose();
    fit.off = points.values - terms * fit.drift.coefficients.transpose();
    for (std::size_t i = 0; i < blocks; ++i)
      distance[i] = std::abs(fit.off[static_cast<Eigen::Index>(i)]);
    fit.spread = normal_mad * median(distance);
    fit.sum = fit.off.cwiseAbs().sum();
    const double least = std::max(0.1 * fit.spread, 1e-12 * points.values.cwiseAbs().maxCoeff());
    if (least == 0.0) break;
    const bool is_last = round + 1 >= rounds - last_rounds;
    for (std::size_t i = 0; i < blocks; ++i)
      weight[i] = is_last ? (distance[i] <= far * fit.spread ? 1.0 : 0.0)
                          : 1.0 / std::max(distance[i], least);
  }
  return fit;
}

/// The decay that is nearest to the points.
Fit best_decay(const Points& points) {
  constexpr double fastest = 0.02, slowest = 10.0, step = 1.4, last_step = 1.002;
  double best_time = fastest * points.samples;
  Fit best = fit_points(points, {.time = best_time});
  const auto try_time = [&](double time) {
    Fit fit = fit_points(points, {.time = time});
    if (fit.sum >= best.sum) return;
    best = std::move(fit);
    best_time = time;
  };
  for (double part = fastest; part < slowest; part *= step) try_time(part * points.samples);
  for (double reach = step; reach > last_step; reach = std::sqrt(reach)) {
    const double time = best_time;
    try_time(time / reach);
    try_time(time * reach);
  }
  return best;
}

/// The line with hum and its multiples that is nearest to the points, of whose periods the record
/// has a part that tells it from a line, and not so many that they drift apart.
Fit best_hum(const Points& points, double interval, int multiples) {
  constexpr double whole_turn = 2.0 * std::numbers::pi, most_turns = 20.0;
  const double least_turn = multiples > 1 ? whole_turn : 0.5;
  Fit best{.drift = SteadyDrift({}, points.samples), .off = {}};
  for (const double frequency : mains) {
    const double omega = whole_turn * frequency * interval, turned = omega * points.samples;
    if (turned < least_turn || turned > most_turns * whole_turn) continue;
    Fit fit = fit_points(points, {.omega = omega, .multiples = multiples});
    if (fit.sum < best.sum) best = std::move(fit);
  }
  return best;
}

}  // namespace

SteadyDrift::Terms SteadyDrift::terms_at(double index) const {
  Terms terms(this->terms());
  terms[0] = 1.0;
  terms[1] = shape_.time > 0.0 ? std::exp(-index / shape_.time) : index / samples_;
  for (int k = 0; k < shape_.multiples; ++k) {
    const double phase = (2 * k + 1) * shape_.omega * index;
    terms.segment<2>(2 + 2 * k) << std::cos(phase), std::sin(phase);
  }
  return terms;
}

std::optional<SteadyDrift> steady_drift(const Trace& trace, double grain) {
  constexpr std::size_t fewest = 256;
  constexpr double matters = 0.02, like_noise = 1.6, significant = 8.0;
  constexpr double hardly = 0.02, hardly_of_decay = 0.003;
  const std::vector<double>& y = trace.values;
  if (y.size() < fewest) return std::nullopt;
  const Points points = medians(y);
  const double noise = std::max(step_noise(y, trace.valid), grain);
  const double of_points = noise / std::sqrt(points.samples / blocks);
  const auto highest = [](std::span<const double> values, double level) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value - level));
    return most;
  };
  // most signals go nowhere; a line goes 2.7 such spreads, a fast decay is seen at the begin
  const Spread spread = robust_spread({points.values.data(), blocks});
  const double goes = std::max(5.0 * spread.sigma, std::abs(points.begin() - points.end()));
  if (goes <= 5.0 * like_noise * of_points || goes < matters * highest(y, spread.centre))
    return std::nullopt;
  const auto explains = [&](const Fit& fit) {
    if (!std::isfinite(fit.spread)) return false;
    const double way = fit.way(points);
    // a record that begins within a contact falls nearly like a decay
    const double part = fit.drift.decays() ? hardly_of_decay : hardly;
    const double error = std::max(like_noise * of_points, part * way);
    return way > significant * of_points && fit.spread <= error && fit.holds_at_both_ends(error);
  };
  Fit fit = fit_points(points, {});
  if (!explains(fit)) {
    Fit decay = best_decay(points), hum = best_hum(points, trace.interval, 1);
    fit = decay.sum < hum.sum ? std::move(decay) : std::move(hum);
  }
  if (!explains(fit)) fit = best_hum(points, trace.interval, 2);
  if (!explains(fit)) return std::nullopt;
  std::vector<double> left(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) left[i] = y[i] - fit.drift.at(as_double(i));
  const bool is_notable = fit.way(points) > matters * highest(left, 0.0);
  return is_notable ? std::optional(fit.drift) : std::nullopt;
}

}  // namespace impactrig::acquisition
