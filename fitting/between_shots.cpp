// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/between_shots.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <stdexcept>

#include "fitting/line_fit.hpp"
#include "fitting/random_effects.hpp"

namespace impactrig::fitting {
namespace {

constexpr double level = 0.05;
constexpr double least_spread = 3.0;  // of speeds, in standard errors

struct Columns {
  Eigen::MatrixXd design;  ///< a column of ones
  Eigen::VectorXd values, variances;
};

/// Of all shots but `left_out`.
Columns columns_of(std::span<const ShotValue> shots, std::size_t left_out) {
  const auto n = static_cast<Eigen::Index>(shots.size() - (left_out < shots.size() ? 1 : 0));
  Columns out{Eigen::MatrixXd::Ones(n, 1), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    if (i == left_out) continue;
    if (!(shots[i].std_error > 0.0))
      throw std::invalid_argument("between shots: a standard error must be above 0");
    out.values[row] = shots[i].value;
    out.variances[row++] = shots[i].std_error * shots[i].std_error;
  }
  return out;
}

Columns columns_of(std::span<const ShotValue> shots) {
  return columns_of(shots, shots.size());
}

double student_quantile(long dof) {
  return boost::math::quantile(boost::math::students_t(static_cast<double>(dof)),
                               1.0 - level / 2.0);
}

double two_sided(double t, long dof) {
  return 2.0 * boost::math::cdf(boost::math::complement(
                   boost::math::students_t(static_cast<double>(dof)), std::abs(t)));
}

std::vector<ShotDeviation> deviations(std::span<const ShotValue> shots) {
  std::vector<ShotDeviation> out;
  if (shots.size() < 3) return out;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const Columns others = columns_of(shots, i);
    const RandomEffects fit = random_effects(others.design, others.values, others.variances);
    const double variance =
        shots[i].std_error * shots[i].std_error + fit.variance + fit.covariance(0, 0);
    ShotDeviation& found = out.emplace_back();
    found.residual = (shots[i].value - fit.coefficients[0]) / std::sqrt(variance);
    found.p_value = two_sided(found.residual, static_cast<long>(shots.size()) - 2);
    found.outlier = found.p_value < level / static_cast<double>(shots.size());
  }
  return out;
}

double spread(std::span<const double> values, double mean) {
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

}  // namespace

BetweenShots between_shots(std::span<const ShotValue> shots) {
  if (shots.size() < 2) throw std::invalid_argument("between shots: two shots are needed");
  const Columns all = columns_of(shots);
  const RandomEffects fit = random_effects(all.design, all.values, all.variances);
  BetweenShots out;
  out.shots = shots.size();
  out.mean = fit.coefficients[0];
  out.std_error = std::sqrt(fit.covariance(0, 0));
  const double half = student_quantile(fit.dof) * out.std_error;
  out.ci95 = {out.mean - half, out.mean + half};
  out.tau = std::sqrt(fit.variance);
  out.q = fit.q;
  out.dof = fit.dof;
  const boost::math::chi_squared chi2(static_cast<double>(fit.dof));
  const auto tau_at = [&](double probability) {
    return std::sqrt(variance_where_q_is(boost::math::quantile(chi2, probability), all.design,
                                         all.values, all.variances));
  };
  out.tau_ci95 = {tau_at(1.0 - level / 2.0), tau_at(level / 2.0)};
  out.p_value = boost::math::cdf(boost::math::complement(chi2, fit.q));
  const auto dof = static_cast<double>(fit.dof);
  out.i2 = fit.q > dof ? 1.0 - dof / fit.q : 0.0;
  out.scatter = std::sqrt(fit.q / dof);
  out.deviations = deviations(shots);
  return out;
}

ShotAgreement agreement(const BetweenShots& found) {
  if (found.p_value < level) return ShotAgreement::scatter;
  return found.p_value > 1.0 - level ? ShotAgreement::too_well : ShotAgreement::agree;
}

std::optional<SpeedTrend> speed_trend(std::span<const ShotValue> shots,
                                      std::span<const ShotSpeed> speeds) {
  if (shots.size() != speeds.size())
    throw std::invalid_argument("speed trend: one speed a shot is needed");
  if (shots.size() < 4) return std::nullopt;
  SpeedTrend out;
  std::vector<double> values, errors;
  for (const ShotSpeed& speed : speeds) {
    values.push_back(speed.speed);
    errors.push_back(speed.std_error);
    out.mean_speed += speed.speed / static_cast<double>(speeds.size());
  }
  std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
  const double range = spread(values, out.mean_speed);
  if (!(range > 0.0) || !std::isfinite(range) || range < least_spread * errors[errors.size() / 2])
    return std::nullopt;
  std::vector<LinePoint> points;
  for (std::size_t i = 0; i < shots.size(); ++i)
    points.push_back({speeds[i].speed - out.mean_speed, shots[i].value, speeds[i].std_error,
                      shots[i].std_error, speeds[i].correlation});
  out.dof = static_cast<long>(shots.size()) - 2;
  out.q = fit_line(points).q;
  const double variance = line_variance_where_q_is(static_cast<double>(out.dof), points);
  const LineFit line = fit_line(points, variance);
  if (!line.converged) return std::nullopt;
  out.slope = line.slope;
  out.std_error = line.slope_error;
  const double half = student_quantile(out.dof) * out.std_error;
  out.ci95 = {out.slope - half, out.slope + half};
  out.p_value = two_sided(out.slope / out.std_error, out.dof);
  out.at_mean_speed = line.intercept;
  out.tau = std::sqrt(variance);
  return out;
}

}  // namespace impactrig::fitting
