// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string_view>

namespace impactrig::acquisition {

/// Random numbers that depend on a seed and a name only, so that a record keeps its noise when
/// another channel is added. std::mt19937_64 is the same everywhere; std::normal_distribution is
/// not, so the distributions are here (normal: Box–Muller, the same wherever log and cos are).
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name) : engine_(mixed(seed, name)) {}

  /// In [0, 1), 53 bits.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Mean 0, standard deviation 1.
  double normal() {
    if (kept_ready_) {
      kept_ready_ = false;
      return kept_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    kept_ = radius * std::sin(angle);
    kept_ready_ = true;
    return radius * std::cos(angle);
  }

  /// Mean 1: the time to the next event of a Poisson process of rate 1.
  double exponential() { return -std::log(1.0 - uniform()); }

 private:
  /// FNV-1a of the name, then the finaliser of SplitMix64: neighbouring seeds share nothing.
  static std::uint64_t mixed(std::uint64_t seed, std::string_view name) {
    std::uint64_t z = 0xcbf29ce484222325u;
    for (const char c : name) z = (z ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    z += seed * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::mt19937_64 engine_;
  double kept_ = 0.0;
  bool kept_ready_ = false;
};

}  // namespace impactrig::acquisition
