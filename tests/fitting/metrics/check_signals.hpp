// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of histories whose metrics are known to ten digits.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "fitting/metrics/history_pair.hpp"

namespace impactrig::tests {

struct CheckPair {
  std::vector<double> measured, computed;

  fitting::HistoryPair pair() const { return {measured, computed}; }

  fitting::HistoryPair reversed() const { return {computed, measured}; }
};

template <typename Measured, typename Computed>
CheckPair sampled(int samples, double step, Measured m, Computed c) {
  CheckPair result;
  for (int i = 0; i < samples; ++i) {
    result.measured.push_back(m(step * i));
    result.computed.push_back(c(step * i));
  }
  return result;
}

inline double pulse(double t, double height, double start, double width) {
  return t >= start && t <= start + width
             ? height * std::sin(std::numbers::pi * (t - start) / width)
             : 0.0;
}

/// "damped_sine", "haversine_pulse", "scaled_1p2", "sign_flip", "quarter_shift", "offset".
inline CheckPair check_signals(const std::string& name) {
  constexpr double pi = std::numbers::pi;
  const auto wave = [](double t) { return std::sin(2 * pi * t) + 0.3 * std::cos(6 * pi * t); };
  if (name == "damped_sine")
    return sampled(
        201, 0.005, [](double t) { return std::exp(-3 * t) * std::sin(4 * pi * t); },
        [](double t) { return 1.1 * std::exp(-2.8 * t) * std::sin(4 * pi * (t - 0.01)); });
  if (name == "haversine_pulse")
    return sampled(
        401, 1e-6, [](double t) { return pulse(t, 4500.0, 50e-6, 220e-6); },
        [](double t) { return pulse(t, 4800.0, 60e-6, 200e-6); });
  if (name == "scaled_1p2")
    return sampled(101, 0.01, wave, [&](double t) { return 1.2 * wave(t); });
  if (name == "sign_flip") return sampled(101, 0.01, wave, [&](double t) { return -wave(t); });
  if (name == "quarter_shift")
    return sampled(
        1000, 0.001, [](double t) { return std::sin(2 * pi * t); },
        [](double t) { return std::sin(2 * pi * (t - 0.25)); });
  return sampled(
      301, 0.01, [](double t) { return 2.0 + std::sin(3 * t); },
      [](double t) { return 2.0 + std::sin(3 * t) + 0.1; });
}

}  // namespace impactrig::tests
