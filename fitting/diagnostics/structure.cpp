// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/structure.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace impactrig::fitting {
namespace {

/// For statistics of the noise's spectral density.
double degrees_of_freedom(const NoiseColour& noise) {
  const double n = static_cast<double>(noise.samples);
  return std::max(2.0, noise.coefficients.empty() ? n - 3.0 : n / (2.0 * noise.correlation_time));
}

/// Samples of r = amount · shape, whitened.
Structure regression(std::span<const double> w, const std::vector<double>& shape,
                     const NoiseColour& noise) {
  Structure out;
  const std::vector<double> x = whitened(shape, noise);
  double xw = 0.0, xx = 0.0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    if (!std::isfinite(w[i]) || !std::isfinite(x[i])) continue;
    xw += x[i] * w[i];
    xx += x[i] * x[i];
  }
  const double whole = energy(w);
  if (!(xx > 0.0 && whole > 0.0)) return out;
  out.amount = xw / xx;
  out.std_error = noise.innovation / std::sqrt(xx);
  out.share = xw * xw / (xx * whole);
  const boost::math::students_t distribution(degrees_of_freedom(noise));
  out.p_value = 2.0 * boost::math::cdf(boost::math::complement(
                          distribution, std::abs(out.amount) / out.std_error));
  return out;
}

/// −ṁ by central differences.
std::vector<double> falling(std::span<const double> model, double interval) {
  std::vector<double> out(model.size(), 0.0);
  for (std::size_t i = 0; i < model.size(); ++i) {
    const std::size_t low = i > 0 ? i - 1 : i, high = std::min(i + 1, model.size() - 1);
    if (high > low)
      out[i] = (model[low] - model[high]) / (interval * static_cast<double>(high - low));
  }
  return out;
}

/// Amplitude at a frequency [Hz] of what is not missing, its mean removed.
double amplitude(std::span<const double> x, double frequency, double interval) {
  double mean = 0.0;
  const double n = static_cast<double>(present(x));
  for (const double value : x)
    if (std::isfinite(value)) mean += value / n;
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i]))
      sum += (x[i] - mean) * std::polar(1.0, -2.0 * std::numbers::pi * frequency * interval *
                                                 static_cast<double>(i));
  return 2.0 * std::abs(sum) / n;
}

/// |Σ x e^{−iωt}|² on a grid of `size` / 2 + 1 frequencies, missing samples as zeros.
std::vector<double> power(std::span<const double> x, std::size_t size) {
  std::vector<double> padded(size, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i])) padded[i] = x[i];
  std::vector<std::complex<double>> transform;
  Eigen::FFT<double> fft;
  fft.fwd(transform, padded);
  std::vector<double> out;
  for (std::size_t k = 0; k <= size / 2; ++k) out.push_back(std::norm(transform[k]));
  return out;
}

}  // namespace

std::vector<Structure> structures(const AfterTouch& after, const NoiseColour& noise) {
  std::vector<Structure> out;
  if (!(noise.innovation > 0.0) || after.residual.empty()) return out;
  const std::vector<double> w = whitened(after.residual, noise);
  const auto add = [&](const char* kind, const std::string& unit,
                       const std::vector<double>& shape) {
    out.push_back(regression(w, shape, noise));
    out.back().kind = kind;
    out.back().unit = unit;
  };
  std::vector<double> time(after.residual.size());
  for (std::size_t i = 0; i < time.size(); ++i)
    time[i] = after.start + after.interval * static_cast<double>(i);
  add("delay", "s", falling(after.model, after.interval));
  add("gain", "1", {after.model.begin(), after.model.end()});
  add("offset", after.unit, std::vector<double>(time.size(), 1.0));
  add("drift", after.unit + "/s", time);
  out.push_back(vibration(after, noise));
  return out;
}

Structure vibration(const AfterTouch& after, const NoiseColour& noise) {
  constexpr std::size_t shortest = 64;
  constexpr double periods = 3.0;
  Structure out;
  out.kind = "vibration";
  out.unit = after.unit;
  const double skipped = std::ceil((after.contact_end - after.start) / after.interval);
  std::size_t from = skipped > 0.0 ? static_cast<std::size_t>(skipped) : 0;
  if (from + shortest > after.residual.size()) from = 0;
  const std::span<const double> residual = after.residual.subspan(from);
  const std::vector<double> w = whitened(residual, noise);
  const double n = static_cast<double>(present(w));
  if (n < shortest || !(noise.innovation > 0.0)) return out;
  std::size_t size = 1;
  while (size < 2 * w.size()) size *= 2;
  const std::vector<double> found = power(w, size);
  const double step = 1.0 / (after.interval * static_cast<double>(size));  // [Hz]
  const double lowest = periods / (after.interval * static_cast<double>(w.size()));
  const auto first = static_cast<std::size_t>(std::ceil(lowest / step));
  const auto top = std::max_element(found.begin() + static_cast<long>(first), found.end() - 1);
  out.frequency = step * static_cast<double>(top - found.begin());
  out.amount = amplitude(residual, out.frequency, after.interval);
  out.model_amplitude = amplitude(after.model.subspan(from), out.frequency, after.interval);
  out.std_error = noise.deviation * std::sqrt(2.0 / n);
  const double p = *top / (n * noise.innovation * noise.innovation);
  const double nu = degrees_of_freedom(noise);
  out.p_value = std::min(1.0, n * std::exp(-0.5 * nu * std::log1p(2.0 * p / nu)));
  out.share = std::min(1.0, 2.0 * *top / n / energy(whitened(after.residual, noise)));
  return out;
}

}  // namespace impactrig::fitting
