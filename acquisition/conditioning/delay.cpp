// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/delay.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/delay_link.hpp"
#include "datasets/number_text.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;
using datasets::Quantity;
using datasets::TimeSpan;

namespace {

constexpr double between_samples = 0.05;  ///< of a sample: what interpolating an onset may cost
constexpr double no_relation = 0.5;       ///< a misfit above it is none

/// Least squares for one delay.
struct LinkFit {
  double delay = 0.0, squares = 0.0;
  Eigen::VectorXd coefficients, residuals;
};

/// Terms, polynomial and gaps; 0 in the rows of samples that do not count.
Eigen::MatrixXd columns(const Link& link, int terms, double delay) {
  const Signal& y = link.channel;
  const auto n = static_cast<Eigen::Index>(y.values.size());
  const auto gaps = static_cast<Eigen::Index>(link.gaps.size());
  const Eigen::Index first_gap = terms + link.degree + 1;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, first_gap + gaps);
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (link.counting[static_cast<std::size_t>(i)] == 0) continue;
    const double t = y.time(static_cast<std::size_t>(i)) - delay;
    for (Eigen::Index g = 0; g < gaps; ++g)
      matrix(i, first_gap + g) = link.gaps[static_cast<std::size_t>(g)].at(t);
    for (int k = 0; k < terms; ++k) matrix(i, k) = link.basis[static_cast<std::size_t>(k)].at(t);
    const double u = (static_cast<double>(i) - middle) / middle;
    double power = 1.0;
    for (int k = 0; k <= link.degree; ++k, power *= u) matrix(i, terms + k) = power;
  }
  for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
    const double size = matrix.col(k).norm();
    if ((k < terms || k >= first_gap) && size > 0.0) matrix.col(k) /= size;
  }
  return matrix;
}

LinkFit fitted(const Link& link, int terms, double delay) {
  const Eigen::MatrixXd matrix = columns(link, terms, delay);
  Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(link.channel.values.data(), matrix.rows());
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (link.counting[static_cast<std::size_t>(i)] == 0) y[i] = 0.0;
  LinkFit fit;
  fit.delay = delay;
  fit.coefficients = matrix.colPivHouseholderQr().solve(y);
  fit.residuals = y - matrix * fit.coefficients;
  fit.squares = fit.residuals.squaredNorm();
  return fit;
}

/// The delay of least squares within +-range: a scan of half steps, then Brent's method.
LinkFit best_fit(const Link& link, int terms, double range) {
  const auto squares = [&](double delay) { return fitted(link, terms, delay).squares; };
  const double step = std::max(0.5 * link.channel.interval, range / 200.0);
  double best = -range, least = squares(best);
  for (double delay = -range + step; delay <= range + 1e-9 * step; delay += step) {
    const double value = squares(delay);
    if (value >= least) continue;
    best = delay;
    least = value;
  }
  const double delay =
      boost::math::tools::brent_find_minima(squares, best - step, best + step, 30).first;
  if (!(std::abs(delay) < range))
    throw std::invalid_argument(
        fmt::format("no delay within {:g} s makes one channel follow the other: the best one is at "
                    "the edge of that range",
                    range));
  return fitted(link, terms, delay);
}

/// Samples that one independent one stands for, at least what the filter alone makes of them.
double correlation_of(const LinkFit& fit) {
  const Eigen::VectorXd& r = fit.residuals;
  return std::max(0.5 / compared_band,
                  correlation_time({r.data(), static_cast<std::size_t>(r.size())}));
}

/// Variance of a sum of residuals times weights: their autocovariances up to a quarter of the
/// record, tapered so that it stays positive [NeweyWest1987]. Noise that rings needs it: its
/// correlation time is short, and what it does to sums that ring as fast is not.
/// `counted` of the residuals count, the others are 0 with weights of 0.
double coloured_variance(const Eigen::VectorXd& residuals, const Eigen::VectorXd& weights,
                         double counted) {
  const Eigen::Index n = residuals.size(), most = n / 4;
  double variance = 0.0;
  for (Eigen::Index lag = 0; lag < most; ++lag) {
    const double covariance = residuals.head(n - lag).dot(residuals.tail(n - lag)) / counted;
    const double product = weights.head(n - lag).dot(weights.tail(n - lag));
    const double taper = 1.0 - static_cast<double>(lag) / static_cast<double>(most);
    variance += (lag == 0 ? 1.0 : 2.0) * taper * covariance * product;
  }
  return std::max(0.0, variance);
}

/// Variance that the integrated noise of the reference gives a sum of the channel's samples times
/// weights. It wanders like a random walk, and over the length of a record residuals do not tell
/// how far. `coefficient` is of a column of unit length.
double wandering_variance(const Link& link, double delay, double coefficient,
                          Eigen::VectorXd weights) {
  if (link.integrations == 0) return 0.0;
  const double step = link.channel.interval;
  double squares = 0.0;
  for (std::size_t i = 0; i < link.channel.values.size(); ++i)
    if (link.counting[i] != 0)
      squares += std::pow(link.basis.front().at(link.channel.time(i) - delay), 2);
  for (int k = 0; k < link.integrations; ++k) {
    for (Eigen::Index i = weights.size() - 1; i > 0; --i) weights[i - 1] += weights[i];
    if (k > 0) weights *= step;
  }
  return coefficient * coefficient / squares * link.noise_power * step * weights.squaredNorm();
}

/// By how much noise of the reference makes the delay less sure than `squares`, those of the
/// model's slope by it, say: of these a share b is noise, which cancels in the curvature of least
/// squares, as the residuals hold it too, and works against the channel's own noise, a part c of
/// both. The variance is (1 − b + b c) / (1 − b)² times as large. b is what the residuals' slopes
/// tell, by the reference's part of the noise.
double unsure_by_reference(const Link& link, const LinkFit& fit, double coefficient,
                           double squares) {
  constexpr double least_signal = 0.05;  // where hardly any of the slope is, that is hardly known
  Signal residuals = link.channel;
  residuals.values.assign(fit.residuals.data(), fit.residuals.data() + fit.residuals.size());
  const double h = 0.25 * link.channel.interval;
  double slopes = 0.0;
  for (std::size_t i = 1; i + 1 < residuals.values.size(); ++i) {
    if (link.counting[i] == 0) continue;
    const double t = residuals.time(i);
    slopes += std::pow((residuals.at(t + h) - residuals.at(t - h)) / (2.0 * h), 2);
  }
  const double of_reference = std::pow(coefficient * step_noise(link.basis.front().values), 2);
  const double of_channel = std::pow(step_noise(link.channel.values), 2);
  const double both = of_reference + of_channel;
  if (!(both > 0.0)) return 1.0;
  const double noise = std::min(slopes * of_reference / both / squares, 1.0 - least_signal);
  return std::sqrt(1.0 - noise + noise * of_channel / both) / (1.0 - noise);
}

/// Standard error of the delay beside all coefficients.
double delay_error(const Link& link, int terms, const LinkFit& fit) {
  Eigen::MatrixXd jacobian = columns(link, terms, fit.delay);
  const double h = 0.25 * link.channel.interval;
  double of_reference = 0.0;  // in the model
  // Coefficients are of columns of unit length: take the lengths at this delay for both sides.
  const auto model = [&](double delay) {
    const Signal& y = link.channel;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(jacobian.rows());
    for (int k = 0; k < terms; ++k) {
      Eigen::VectorXd here(jacobian.rows()), there(jacobian.rows());
      const Signal& basis = link.basis[static_cast<std::size_t>(k)];
      for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
        here[i] = there[i] = 0.0;
        if (link.counting[static_cast<std::size_t>(i)] == 0) continue;
        const double t = y.time(static_cast<std::size_t>(i));
        here[i] = basis.at(t - fit.delay);
        there[i] = basis.at(t - delay);
      }
      const double size = here.norm();
      if (size > 0.0) sum += fit.coefficients[k] / size * there;
      if (size > 0.0 && k == 0) of_reference = fit.coefficients[k] / size;
    }
    return sum;
  };
  const Eigen::Index p = jacobian.cols();
  jacobian.conservativeResize(Eigen::NoChange, p + 1);
  jacobian.col(p) = (model(fit.delay + h) - model(fit.delay - h)) / (2.0 * h);
  const double scale = jacobian.col(p).norm();
  if (!(scale > 0.0)) return INFINITY;
  jacobian.col(p) /= scale;
  // What of the last column the others cannot make.
  const Eigen::MatrixXd others = jacobian.leftCols(p);
  const Eigen::VectorXd own =
      jacobian.col(p) - others * others.colPivHouseholderQr().solve(jacobian.col(p));
  const double n = static_cast<double>(link.counted());
  const double freedom = std::max(1.0, n - static_cast<double>(p) - 1.0);
  const double white = fit.squares / freedom * correlation_of(fit) / own.squaredNorm();
  const Eigen::VectorXd weights = own / own.squaredNorm();
  const double coloured = n / freedom * coloured_variance(fit.residuals, weights, n);
  const double wandering = wandering_variance(link, fit.delay, fit.coefficients[0], weights);
  const double unsure =
      unsure_by_reference(link, fit, of_reference, scale * scale * own.squaredNorm());
  return std::sqrt(std::max(white, coloured) + wandering) / scale * unsure;
}

double misfit_of(const Link& link, int terms, const LinkFit& fit) {
  const Eigen::MatrixXd matrix = columns(link, terms, fit.delay);
  const Eigen::VectorXd part = matrix.leftCols(terms) * fit.coefficients.head(terms);
  const double n = static_cast<double>(link.counted());  // other rows are 0
  const double follows = std::sqrt(std::max(0.0, part.squaredNorm() - part.sum() * part.sum() / n));
  return follows > 0.0 ? std::sqrt(fit.squares) / follows : INFINITY;
}

/// By how much the delay moves where the window ends a part of what follows the onset earlier,
/// beyond what noise does to it: of a right model the difference has the variance of the one less
/// that of the other [Hausman1978]. 0 where few samples are left.
double moved_by_earlier_end(const Link& link, int terms, double range, const DelayEstimate& whole,
                            double part) {
  const std::vector<double>& driving = link.basis.front().values;
  double most = 0.0;
  for (const double value : driving) most = std::max(most, std::abs(value));
  const auto onset =
      std::ranges::find_if(driving, [&](double v) { return std::abs(v) > 0.05 * most; });
  const double touch = link.basis.front().time(static_cast<std::size_t>(onset - driving.begin()));
  const std::size_t n = link.channel.values.size();
  const double cut =
      std::max(0.0, part * (link.channel.time(n - 1) - touch) / link.channel.interval);
  if (static_cast<double>(n) < cut + static_cast<double>(least_samples)) return 0.0;
  Link shorter = link;
  shorter.channel.values.resize(n - static_cast<std::size_t>(cut));
  shorter.counting.resize(shorter.channel.values.size());
  if (shorter.counted() < least_samples) return 0.0;
  try {
    const LinkFit fit = best_fit(shorter, terms, range);
    const double error = delay_error(shorter, terms, fit);
    const double by_noise = std::max(0.0, error * error - whole.uncertainty * whole.uncertainty);
    return std::sqrt(std::max(0.0, std::pow(fit.delay - whole.value, 2) - by_noise));
  } catch (const std::invalid_argument&) {
    return 0.0;  // at the edge of the range: noise alone
  }
}

/// One fit, or as many terms as lower Schwarz's criterion.
DelayEstimate estimate(Link link, double range) {
  // Which samples count depends on the delay.
  if (!link.reference.sound.empty()) link.count_at(best_fit(link, 1, range).delay);
  const int most = link.expansion ? most_terms : 1;
  std::vector<LinkFit> fits;
  for (int terms = 1; terms <= most; ++terms) fits.push_back(best_fit(link, terms, range));
  const double n = static_cast<double>(link.counted());
  const double independent = n / correlation_of(fits.back());
  std::size_t best = 0;
  const auto criterion = [&](std::size_t k) {
    return independent * std::log(fits[k].squares / n) +
           static_cast<double>(k) * std::log(independent);
  };
  for (std::size_t k = 1; k < fits.size(); ++k)
    if (criterion(k) < criterion(best)) best = k;
  const int terms = static_cast<int>(best) + 1;
  DelayEstimate result;
  result.value = fits[best].delay;
  result.terms = terms;
  result.misfit = misfit_of(link, terms, fits[best]);
  result.uncertainty = delay_error(link, terms, fits[best]);
  if (!link.expansion) return result;
  // What the expansion leaves out, the echo of a near end above all, shows where the window ends
  // earlier: with a right model the delay stays.
  double moved = 0.0;
  for (const double part : {1.0 / 3.0, 0.5})
    moved = std::max(moved, moved_by_earlier_end(link, terms, range, result, part));
  const std::size_t other = best + 1 < fits.size() ? best + 1 : best - 1;
  result.uncertainty = std::hypot(result.uncertainty, fits[other].delay - fits[best].delay,
                                  between_samples * link.channel.interval);
  result.uncertainty = std::hypot(result.uncertainty, moved);
  // Other numbers of terms by their weights exp(-criterion/2), where half of the criterion counts:
  // how many samples are independent is known to a factor of two.
  double weights = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const double weight = std::exp(-0.25 * (criterion(k) - criterion(best)));
    weights += weight;
    squares += weight * std::pow(fits[k].delay - fits[best].delay, 2);
  }
  result.uncertainty = std::hypot(result.uncertainty, std::sqrt(squares / weights));
  return result;
}

}  // namespace

DelayEstimate estimate_delay(const Channel& reference, const Channel& channel,
                             const TimeSpan& window, double range) {
  if (!(range > 0.0))
    throw std::invalid_argument(fmt::format("a range of delays of {:g} s is not positive", range));
  const auto from = derivative_of(reference.quantity), to = derivative_of(channel.quantity);
  const bool motions = from && to;
  const bool struck = (reference.quantity == Quantity::force && to) ||
                      (channel.quantity == Quantity::force && from);
  if (!motions && !struck && reference.quantity != channel.quantity)
    throw std::invalid_argument(fmt::format(
        "channel '{}' ({}) does not follow from '{}' ({}), so no delay between them "
        "can be estimated",
        channel.name, name(channel.quantity), reference.name, name(reference.quantity)));
  // What integrates is the reference.
  const bool swapped = motions ? *from < *to : channel.quantity == Quantity::force && from;
  DelayEstimate result = swapped ? estimate(link_between(channel, reference, window, range), range)
                                 : estimate(link_between(reference, channel, window, range), range);
  if (swapped) result.value = -result.value;
  if (!(result.misfit < no_relation))
    throw std::invalid_argument(
        fmt::format("channel '{}' does not follow '{}': what is left over is {} of what does",
                    channel.name, reference.name, datasets::figures(result.misfit, 2)));
  // a delay of which nothing is known is that unsure
  if (const double unknown = range / std::sqrt(3.0); result.uncertainty > unknown)
    throw std::invalid_argument(fmt::format(
        "the delay of channel '{}' against '{}' is uncertain by {:.2g} s, as much as if nothing "
        "but "
        "the range of {:.2g} s either way were known; a low-pass before may help, else state the "
        "delay",
        channel.name, reference.name, result.uncertainty, range));
  return result;
}

Edit remove_estimated_delay(const DelayEstimate& estimate, const std::string& reference,
                            Channel& channel) {
  channel.clock.start -= estimate.value;
  const double known = channel.delay && channel.delay->removed ? channel.delay->value : 0.0;
  channel.delay = {known + estimate.value, estimate.uncertainty, true};
  Edit edit{"align", channel.name, {{"reference", reference}}};
  edit.parameters["delay"] = fmt::format("{:.4g} s", estimate.value);
  edit.parameters["uncertainty"] = fmt::format("{:.2g} s", estimate.uncertainty);
  edit.parameters["terms"] = std::to_string(estimate.terms);
  edit.parameters["left over"] = fmt::format("{:.2g} of what follows", estimate.misfit);
  return edit;
}

bool says_something(const datasets::Delay& delay) {
  return delay.value != 0.0 || delay.uncertainty != 0.0;
}

std::optional<Edit> remove_known_delay(Channel& channel, const datasets::Delay& stated) {
  if (channel.delay && channel.delay->removed) return std::nullopt;
  datasets::Delay delay = channel.delay && !says_something(stated) ? *channel.delay : stated;
  channel.clock.start -= delay.value;
  for (double& time : channel.clock.times) time -= delay.value;
  delay.removed = true;
  channel.delay = delay;
  if (delay.value == 0.0) return std::nullopt;
  return Edit{"remove delay",
              channel.name,
              {{"delay", fmt::format("{:.12g} s", delay.value)},
               {"uncertainty", fmt::format("{:.12g} s", delay.uncertainty)}}};
}

}  // namespace impactrig::acquisition
