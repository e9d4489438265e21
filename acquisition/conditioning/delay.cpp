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
#include "acquisition/conditioning/samples.hpp"
#include "datasets/number_text.hpp"
#include "datasets/zero_phase_low_pass.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;
using datasets::Quantity;
using datasets::TimeSpan;

namespace {

constexpr std::size_t most_samples = 4096;  ///< of a segment; longer ones are averaged in blocks
constexpr int most_terms = 4;
constexpr std::size_t least_samples = 24;
constexpr double band = 0.1;              ///< of the sample rate: what is compared
constexpr double between_samples = 0.05;  ///< of a sample: what interpolating an onset may cost
constexpr double no_relation = 0.5;       ///< a misfit above it is none

struct Signal {
  double start = 0.0, interval = 0.0;
  std::vector<double> values;

  double time(std::size_t i) const { return start + interval * static_cast<double>(i); }

  /// The cubic through the four samples about t; the record must reach one sample further.
  double at(double t) const {
    const double last = static_cast<double>(values.size()) - 3.0;
    const double place = (t - start) / interval;
    const double base = std::clamp(std::floor(place), 1.0, std::max(1.0, last));
    const double u = place - base;
    const double* const y = values.data() + static_cast<std::ptrdiff_t>(base) - 1;
    return -u * (u - 1.0) * (u - 2.0) / 6.0 * y[0] +
           (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0 * y[1] - (u + 1.0) * u * (u - 2.0) / 2.0 * y[2] +
           (u + 1.0) * u * (u - 1.0) / 6.0 * y[3];
  }
};

/// The samples within a span, by means of blocks where there are too many.
Signal segment_of(const Channel& channel, const TimeSpan& span) {
  // Interpolated white noise is smaller between samples than on them, which would pull delays to
  // half samples; both channels pass the same filter, so that what links them is left as it is.
  const std::vector<double> all = datasets::zero_phase_low_pass(
      sound_values(channel), channel.clock.interval, {band / channel.clock.interval, 4});
  const IndexRange range = samples_in(channel, span);
  if (range.size() < least_samples)
    throw std::invalid_argument(
        fmt::format("channel '{}' has {} samples between {:g} s and {:g} s; at least {} are needed "
                    "to estimate a delay",
                    channel.name, range.size(), span.begin, span.end, least_samples));
  const std::size_t width = (range.size() + most_samples - 1) / most_samples;
  Signal signal;
  signal.interval = channel.clock.interval * static_cast<double>(width);
  signal.start = channel.clock.time(range.begin) + 0.5 * (signal.interval - channel.clock.interval);
  for (std::size_t i = range.begin; i + width <= range.end; i += width) {
    double sum = 0.0;
    for (std::size_t k = 0; k < width; ++k) sum += all[i + k];
    signal.values.push_back(sum / static_cast<double>(width));
  }
  return signal;
}

Signal integral_of(const Signal& signal) {
  Signal result{signal.start, signal.interval, std::vector<double>(signal.values.size(), 0.0)};
  for (std::size_t i = 1; i < signal.values.size(); ++i)
    result.values[i] =
        result.values[i - 1] + 0.5 * signal.interval * (signal.values[i - 1] + signal.values[i]);
  return result;
}

/// ∫ (t - s)^p f(s) ds from the first sample on, p > -1, exact for an f that is linear between
/// samples and begins at 0: the second differences of m^(p+2), times h^(p+1)/((p+1)(p+2)), are its
/// weights.
Signal fractional_integral(const Signal& signal, double p) {
  const std::size_t n = signal.values.size();
  const auto power = [&](double m) { return m > 0.0 ? std::pow(m, p + 2.0) : 0.0; };
  std::vector<double> weights(n);
  for (std::size_t m = 0; m < n; ++m) {
    const double x = static_cast<double>(m);
    weights[m] = power(x + 1.0) - 2.0 * power(x) + power(x - 1.0);
  }
  const double factor = std::pow(signal.interval, p + 1.0) / ((p + 1.0) * (p + 2.0));
  Signal result{signal.start, signal.interval, std::vector<double>(n, 0.0)};
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j <= i; ++j) sum += signal.values[j] * weights[i - j];
    result.values[i] = factor * sum;
  }
  return result;
}

/// Samples before a signal departs from its level.
std::size_t quiet_head(const std::vector<double>& y) {
  const std::size_t head = std::max<std::size_t>(8, y.size() / 20);
  const double level = median({y.begin(), y.begin() + static_cast<std::ptrdiff_t>(head)});
  double peak = 0.0;
  for (const double value : y) peak = std::max(peak, std::abs(value - level));
  const double limit = std::max(6.0 * step_noise(y), 0.05 * peak);
  std::size_t crossing = 0;
  while (crossing < y.size() && std::abs(y[crossing] - level) <= limit) ++crossing;
  return std::max<std::size_t>(1, crossing - crossing / 4);
}

/// A force without what it shows before it rises.
void take_level_off(Signal& force) {
  std::vector<double>& y = force.values;
  const std::size_t quiet = quiet_head(y);
  double mean = 0.0;
  for (std::size_t i = 0; i < quiet; ++i) mean += y[i] / static_cast<double>(quiet);
  for (double& value : y) value -= mean;
}

/// Power of a signal's noise at low frequencies, as of white noise: variance times interval, from
/// the line through what it shows before it moves [unit² s]; 0 where that is too short.
double noise_power(const Signal& signal) {
  const std::size_t quiet = quiet_head(signal.values);
  if (quiet < least_samples) return 0.0;
  const QuietFit line = fit_quiet(signal.values, 0, quiet, 1, 0.0);
  return line.sigma * line.sigma * line.correlation * signal.interval;
}

/// How the channel follows from the reference.
struct Link {
  Signal channel;
  std::vector<Signal> basis;  ///< as many as there may be terms
  int degree = 1;             ///< of the polynomial beside them
  bool expansion = false;     ///< the number of terms is open
  int integrations = 0;       ///< that the one term is of the reference
  double noise_power = 0.0;   ///< of the reference before it is integrated [unit² s]
};

/// Least squares for one delay.
struct LinkFit {
  double delay = 0.0, squares = 0.0;
  Eigen::VectorXd coefficients, residuals;
};

Eigen::MatrixXd columns(const Link& link, int terms, double delay) {
  const Signal& y = link.channel;
  const auto n = static_cast<Eigen::Index>(y.values.size());
  Eigen::MatrixXd matrix(n, terms + link.degree + 1);
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = y.time(static_cast<std::size_t>(i)) - delay;
    for (int k = 0; k < terms; ++k) matrix(i, k) = link.basis[static_cast<std::size_t>(k)].at(t);
    const double u = (static_cast<double>(i) - middle) / middle;
    double power = 1.0;
    for (int k = 0; k <= link.degree; ++k, power *= u) matrix(i, terms + k) = power;
  }
  for (int k = 0; k < terms; ++k) {
    const double size = matrix.col(k).norm();
    if (size > 0.0) matrix.col(k) /= size;
  }
  return matrix;
}

LinkFit fitted(const Link& link, int terms, double delay) {
  const Eigen::MatrixXd matrix = columns(link, terms, delay);
  const Eigen::Map<const Eigen::VectorXd> y(link.channel.values.data(), matrix.rows());
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
  return std::max(0.5 / band, correlation_time({r.data(), static_cast<std::size_t>(r.size())}));
}

/// Variance of a sum of residuals times weights: their autocovariances up to a quarter of the
/// record, tapered so that it stays positive [NeweyWest1987]. Noise that rings needs it: its
/// correlation time is short, and what it does to sums that ring as fast is not.
double coloured_variance(const Eigen::VectorXd& residuals, const Eigen::VectorXd& weights) {
  const Eigen::Index n = residuals.size(), most = n / 4;
  double variance = 0.0;
  for (Eigen::Index lag = 0; lag < most; ++lag) {
    const double covariance =
        residuals.head(n - lag).dot(residuals.tail(n - lag)) / static_cast<double>(n);
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
    squares += std::pow(link.basis.front().at(link.channel.time(i) - delay), 2);
  for (int k = 0; k < link.integrations; ++k) {
    for (Eigen::Index i = weights.size() - 1; i > 0; --i) weights[i - 1] += weights[i];
    if (k > 0) weights *= step;
  }
  return coefficient * coefficient / squares * link.noise_power * step * weights.squaredNorm();
}

/// Standard error of the delay beside all coefficients.
double delay_error(const Link& link, int terms, const LinkFit& fit) {
  Eigen::MatrixXd jacobian = columns(link, terms, fit.delay);
  const double h = 0.25 * link.channel.interval;
  // Coefficients are of columns of unit length: take the lengths at this delay for both sides.
  const auto model = [&](double delay) {
    const Signal& y = link.channel;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(jacobian.rows());
    for (int k = 0; k < terms; ++k) {
      Eigen::VectorXd here(jacobian.rows()), there(jacobian.rows());
      const Signal& basis = link.basis[static_cast<std::size_t>(k)];
      for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
        const double t = y.time(static_cast<std::size_t>(i));
        here[i] = basis.at(t - fit.delay);
        there[i] = basis.at(t - delay);
      }
      const double size = here.norm();
      if (size > 0.0) sum += fit.coefficients[k] / size * there;
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
  const double n = static_cast<double>(jacobian.rows());
  const double freedom = std::max(1.0, n - static_cast<double>(p) - 1.0);
  const double white = fit.squares / freedom * correlation_of(fit) / own.squaredNorm();
  const Eigen::VectorXd weights = own / own.squaredNorm();
  const double coloured = n / freedom * coloured_variance(fit.residuals, weights);
  const double wandering = wandering_variance(link, fit.delay, fit.coefficients[0], weights);
  return std::sqrt(std::max(white, coloured) + wandering) / scale;
}

double misfit_of(const Link& link, int terms, const LinkFit& fit) {
  const Eigen::MatrixXd matrix = columns(link, terms, fit.delay);
  const Eigen::VectorXd part = matrix.leftCols(terms) * fit.coefficients.head(terms);
  const double follows = (part.array() - part.mean()).matrix().norm();
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
DelayEstimate estimate(const Link& link, double range) {
  const int most = link.expansion ? most_terms : 1;
  std::vector<LinkFit> fits;
  for (int terms = 1; terms <= most; ++terms) fits.push_back(best_fit(link, terms, range));
  const double n = static_cast<double>(link.channel.values.size());
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

/// How often a displacement is differentiated; none for what is no motion.
std::optional<int> derivative_of(Quantity quantity) {
  if (quantity == Quantity::displacement) return 0;
  if (quantity == Quantity::velocity) return 1;
  if (quantity == Quantity::acceleration) return 2;
  return std::nullopt;
}

TimeSpan widened(const TimeSpan& window, double by) {
  return {window.begin - by, window.end + by};
}

/// Leaves only samples of the channel whose references, however delayed, exist.
void cut_to_reference(const Signal& reference, double range, Signal& channel) {
  const double margin = range + 2.0 * reference.interval;
  const double from = reference.start + margin;
  const double to = reference.time(reference.values.size() - 1) - margin;
  Signal cut{0.0, channel.interval, {}};
  for (std::size_t i = 0; i < channel.values.size(); ++i) {
    const double t = channel.time(i);
    if (t < from || t > to) continue;
    if (cut.values.empty()) cut.start = t;
    cut.values.push_back(channel.values[i]);
  }
  if (cut.values.size() < least_samples)
    throw std::invalid_argument(
        "the two channels share too little time to estimate a delay between them");
  channel = std::move(cut);
}

Link link_between(const Channel& reference, const Channel& channel, const TimeSpan& window,
                  double range) {
  Link link;
  const double margin = range + 4.0 * reference.clock.interval;
  Signal x = segment_of(reference, widened(window, margin));
  link.channel = segment_of(channel, window);
  const auto from = derivative_of(reference.quantity), to = derivative_of(channel.quantity);
  if (reference.quantity == Quantity::force && to) {
    take_level_off(x);
    if (*to == 2) link.channel = integral_of(link.channel);
    const double first = *to == 0 ? 0.5 : -0.5;
    for (int k = 0; k < most_terms; ++k)
      link.basis.push_back(fractional_integral(x, first + 0.5 * k));
    link.degree = *to == 0 ? 2 : 1;
    link.expansion = true;
  } else {
    link.integrations = from && to ? *from - *to : 0;
    if (link.integrations > 0) link.noise_power = noise_power(x);
    for (int i = 0; i < link.integrations; ++i) x = integral_of(x);
    link.degree = 1 + link.integrations;
    link.basis.push_back(x);
  }
  cut_to_reference(link.basis.front(), range, link.channel);
  return link;
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

}  // namespace impactrig::acquisition
