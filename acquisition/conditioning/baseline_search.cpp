// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/baseline_search.hpp"

#include <cmath>

namespace impactrig::acquisition {

namespace {

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// How much a line rises or falls over its stretch.
double trend(const QuietFit& line) {
  return 2.0 * std::abs(line.coefficients[1]);
}

}  // namespace

QuietFit BaselineSearch::course(std::size_t begin, std::size_t end, int degree) const {
  return fit_quiet(trace_.values, begin, end, degree, grain_, trace_.valid);
}

/// Of the samples of a stretch; 1 where none is, as then all count.
double BaselineSearch::sound_share(const QuietFit& fit) const {
  const auto marks = trace_.marks(fit.begin, fit.end);
  const auto sound = marks.size() - static_cast<std::size_t>(std::ranges::count(marks, 0));
  return sound == 0 ? 1.0 : as_double(sound) / as_double(marks.size());
}

/// The scatter of the trend where there is none.
double BaselineSearch::trend_scatter(const QuietFit& fit) const {
  const double sound = as_double(fit.size()) * sound_share(fit);
  return 2.0 * std::sqrt(3.0 * fit.correlation / sound) * fit.sigma;
}

bool BaselineSearch::scatters_alike(const QuietFit& fit, const QuietFit& nearest) const {
  constexpr double alike = 1.5;
  return noise_above_step(fit.sigma, grain_) <= alike * noise_above_step(nearest.sigma, grain_);
}

/// None where noise alone may slope as much.
std::optional<QuietFit> BaselineSearch::sloping(const QuietFit& fit) const {
  constexpr double significant = 3.0;
  return trend(fit) > significant * trend_scatter(fit) ? std::optional(fit) : std::nullopt;
}

/// The line below a pulse of `length` samples, by what the signal does for as long before sample
/// `end`, where it follows one; `nearest` are the last samples. A slope that they alone have is the
/// pulse's foot, where what lies before is quiet, and hum where it is not, which they tell best.
std::optional<QuietFit> BaselineSearch::line_below(std::size_t end, std::size_t floor,
                                                   std::size_t length,
                                                   const QuietFit& nearest) const {
  const std::size_t size = std::max(nearest.size(), length);
  const std::size_t begin = std::max(floor, end > size ? end - size : 0);
  if (end - begin < std::max<std::size_t>(32, length / 4)) return std::nullopt;
  if (size == nearest.size()) return sloping(nearest);
  if (const QuietFit whole = course(begin, end, 1); scatters_alike(whole, nearest))
    return sloping(whole);
  const bool is_foot =
      nearest.begin < begin + 16 || scatters_alike(course(begin, nearest.begin, 1), nearest);
  return is_foot ? std::nullopt : sloping(nearest);
}

std::optional<Baseline> BaselineSearch::before(std::size_t end, std::size_t floor,
                                               const Pulse& pulse) const {
  constexpr double leans = 0.01;  // of the height, beyond what noise does
  const std::size_t begin = std::max(floor, end > window_ ? end - window_ : 0);
  if (end < begin + 8) return std::nullopt;
  QuietFit nearest = course(begin, end, 1);
  std::size_t size = end - begin;
  Baseline baseline{.steady = true};
  while (trend(nearest) > leans * pulse.height + 4.0 * trend_scatter(nearest)) {
    if (size < 16) return std::nullopt;  // the foot from the begin
    baseline.steady = false;
    size /= 2;
    nearest = course(begin, begin + size, 1);
  }
  std::optional<QuietFit> line;
  if (baseline.steady) line = line_below(end, floor, pulse.length, nearest);
  baseline.line = line.has_value();
  baseline.fit = line ? *line : course(begin, begin + size, 0);
  baseline.constant = baseline.fit.mean;
  baseline.sigma = baseline.fit.sigma;
  baseline.until = std::max(baseline.fit.end, pulse.top) + baseline.fit.size();
  return baseline;
}

}  // namespace impactrig::acquisition
