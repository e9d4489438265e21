// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/undo_chain.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace impactrig::fitting {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double widest = 0.6;  // half a parabola, in radians of the section's frequency
constexpr double coarsest = 0.8;

/// 1 + a₁ s + a₂ s² of a section whose frequency is omega.
struct Section {
  double omega;          ///< [rad/s]
  double first, second;  ///< a₁ [s], a₂ [s²]
};

/// Of a Butterworth filter; of a high-pass with 1/s in the place of s, likewise.
std::vector<Section> sections_of(const datasets::BandLimit& limit) {
  const double omega = two_pi * limit.frequency;
  std::vector<Section> sections;
  for (int k = 1; k <= limit.order / 2; ++k) {
    const double angle = (2.0 * k - 1.0) * std::numbers::pi / (2.0 * limit.order);
    sections.push_back({omega, 2.0 * std::sin(angle) / omega, 1.0 / (omega * omega)});
  }
  if (limit.order % 2 == 1) sections.push_back({omega, 1.0 / omega, 0.0});
  return sections;
}

std::vector<Section> low_passes(const datasets::Sensor& sensor) {
  std::vector<Section> sections;
  if (sensor.high_cut) sections = sections_of(*sensor.high_cut);
  if (!sensor.resonance) return sections;
  const double omega = two_pi * sensor.resonance->frequency;
  sections.push_back({omega, 1.0 / (sensor.resonance->quality * omega), 1.0 / (omega * omega)});
  return sections;
}

/// y + a₁ ẏ + a₂ ÿ by parabolas; beyond the ends y stays as it is there.
std::vector<double> with_derivatives(const std::vector<double>& y, const Section& section,
                                     double interval) {
  const auto n = static_cast<std::ptrdiff_t>(y.size());
  const auto m =
      std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(widest / (section.omega * interval)));
  double s0 = 0.0, s2 = 0.0, s4 = 0.0;
  for (std::ptrdiff_t j = -m; j <= m; ++j) {
    const auto x2 = static_cast<double>(j * j);
    s0 += 1.0;
    s2 += x2;
    s4 += x2 * x2;
  }
  const double slope = section.first / (s2 * interval);
  const double bend = 2.0 * section.second / ((s0 * s4 - s2 * s2) * interval * interval);
  std::vector<double> x(y.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    double sum = y[static_cast<std::size_t>(i)];
    for (std::ptrdiff_t j = -m; j <= m; ++j) {
      const double value = y[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i + j, 0, n - 1))];
      const auto place = static_cast<double>(j);
      sum += value * (slope * place + bend * (s0 * place * place - s2));
    }
    x[static_cast<std::size_t>(i)] = sum;
  }
  return x;
}

/// y + a₁ω² ∫y + a₂ω⁴ ∬y: of a high-pass section, where 1/s stands for s.
void add_integrals(std::vector<double>& y, const Section& section, double interval) {
  const double squared = section.omega * section.omega;
  const double first = section.first * squared, second = section.second * squared * squared;
  double once = 0.0, twice = 0.0, before = 0.0;
  for (double& value : y) {
    const double last = once;
    once += 0.5 * interval * (before + value);
    twice += 0.5 * interval * (last + once);
    before = value;
    value += first * once + second * twice;
  }
}

}  // namespace

Undone undo_chain(const datasets::Sensor& sensor, std::span<const double> shown, double interval,
                  ChainUndo how) {
  Undone result;
  result.values.assign(shown.begin(), shown.end());
  for (const Section& section : low_passes(sensor)) {
    const bool resolved = section.omega * interval <= coarsest;
    if (how == ChainUndo::all || (how == ChainUndo::resolved && resolved)) {
      result.values = with_derivatives(result.values, section, interval);
    } else {
      result.delay += section.first;
      result.complete = false;
    }
  }
  if (sensor.low_cut && how != ChainUndo::none)
    for (const Section& section : sections_of(*sensor.low_cut))
      add_integrals(result.values, section, interval);
  return result;
}

}  // namespace impactrig::fitting
