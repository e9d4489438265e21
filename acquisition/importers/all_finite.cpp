// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/all_finite.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace impactrig::acquisition {

namespace {

/// A product with zero is zero, or not a number. Each sum waits for itself only, so that the
/// processor adds many at once: 256 bytes of them are eight of its registers, or sixteen.
template <typename Number>
[[gnu::always_inline]] inline bool products_are_zero(std::span<const Number> samples) {
  std::array<Number, 256 / sizeof(Number)> sums{};
  const Number* at = samples.data();
  const Number* const end = at + samples.size();
  for (const Number* const whole = end - samples.size() % sums.size(); at != whole;
       at += sums.size())
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += at[k] * Number{};
  for (; at != end; ++at) sums[0] += *at * Number{};
  Number sum{};
  for (const Number one : sums) sum += one;
  return sum == Number{};
}

#if defined(__x86_64__) && defined(__GNUC__)

/// As above, for processors that have twice as wide registers and add a product in one step.
template <typename Number>
[[gnu::target("avx2,fma")]] bool products_are_zero_wide(std::span<const Number> samples) {
  return products_are_zero(samples);
}

template <typename Number>
bool choose(std::span<const Number> samples) {
  static const bool wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return wide ? products_are_zero_wide(samples) : products_are_zero(samples);
}

#else

template <typename Number>
bool choose(std::span<const Number> samples) {
  return products_are_zero(samples);
}

#endif

}  // namespace

bool all_finite(std::span<const float> samples) {
  return choose(samples);
}

bool all_finite(std::span<const double> samples) {
  return choose(samples);
}

}  // namespace impactrig::acquisition
