// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/mode_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace impactrig::models {
namespace {

using Complex = std::complex<double>;

// Of |z|: below, three terms of the power series of i_n are as good as all.
constexpr double small = 1e-3;
// Of the phase with damping over h: below, two exponentials would differ by little, and powers of
// time up to this of the sine and the cosine are as good as all.
constexpr double critical_phase = 0.05;
constexpr std::size_t powers = 7;
constexpr std::size_t most_moments = ModesOverStep::most_terms + powers;

/// How many moments are above rounding.
int moments_needed(double size) {
  return static_cast<int>(size + 16.0 + 6.0 * std::cbrt(size));
}

/// e^z − 1.
Complex less_one(Complex z) {
  const double half_sine = std::sin(0.5 * z.imag());
  return {std::expm1(z.real()) * std::cos(z.imag()) - 2.0 * half_sine * half_sine,
          std::exp(z.real()) * std::sin(z.imag())};
}

/// zⁿ / (2n + 1)!! (1 + z² / (2 (2n + 3)) + ...), times e^z.
void small_moments(Complex z, std::span<Complex> moments) {
  Complex leading = std::exp(z);
  const Complex square = z * z;
  for (std::size_t n = 0; n < moments.size(); ++n) {
    const auto order = static_cast<double>(n);
    const Complex third = square * (0.25 / (2.0 * order + 5.0));
    moments[n] = leading * (1.0 + square * (0.5 / (2.0 * order + 3.0)) * (1.0 + third));
    leading *= z * (1.0 / (2.0 * order + 3.0));
  }
}

/// From the moments of a function of τ to those of τ times it, one fewer.
void multiply_by_time(std::span<double> moments) {
  double below = 0.0;
  for (std::size_t n = 0; n + 1 < moments.size(); ++n) {
    const auto order = static_cast<double>(n);
    const double beside = ((order + 1.0) * moments[n + 1] + order * below) / (2.0 * order + 1.0);
    below = moments[n];
    moments[n] = 0.5 * (below + beside);
  }
}

}  // namespace

void exponential_moments(Complex exponent, std::span<Complex> moments) {
  const Complex z = 0.5 * exponent;
  const double size = std::abs(z);
  if (size < small) return small_moments(z, moments);
  // Miller's recurrence backwards, i_{n−1} = i_{n+1} + (2n + 1) i_n / z; what it grows by down to
  // n = 0 stays far within the range of double
  const Complex inverse = 1.0 / z;
  const int count = static_cast<int>(moments.size());
  Complex above = 0.0, here = 1e-150;
  const int from = moments_needed(size) + 4;
  for (int n = std::max(from + 1, 0); n < count; ++n) moments[static_cast<std::size_t>(n)] = 0.0;
  Complex first, second;
  for (int n = from; n >= 0; --n) {
    if (n < count) moments[static_cast<std::size_t>(n)] = here;
    if (n == 1) second = here;
    if (n == 0) first = here;
    const Complex below = above + (2.0 * n + 1.0) * inverse * here;
    above = here;
    here = below;
  }
  // e^z i_0 and e^z i_1 in closed form; the larger of the two has lost nothing
  const Complex zeroth = 0.5 * inverse * less_one(exponent);
  const Complex scale = std::norm(first) >= std::norm(second)
                            ? zeroth / first
                            : inverse * (0.5 * (std::exp(exponent) + 1.0) - zeroth) / second;
  for (int n = 0; n < std::min(count, from + 1); ++n) moments[static_cast<std::size_t>(n)] *= scale;
}

ModeKernel::ModeKernel(double omega, double damping)
    : omega_(omega),
      half_damping_(0.5 * damping),
      square_((omega - half_damping_) * (omega + half_damping_)) {}

ModeKernel::Value ModeKernel::at(double t) const {
  const double phase = std::sqrt(std::abs(square_)) * t;
  const double near = t * (1.0 - std::copysign(phase * phase, square_) / 6.0);
  if (square_ >= 0.0) {
    const double decay = std::exp(-half_damping_ * t);
    const double sine = phase < 1e-4 ? near : std::sin(phase) / phase * t;
    return {decay * sine, decay * (std::cos(phase) - half_damping_ * sine)};
  }
  if (phase < 1.0) {
    const double decay = std::exp(-half_damping_ * t);
    const double sine = phase < 1e-4 ? near : std::sinh(phase) / phase * t;
    return {decay * sine, decay * (std::cosh(phase) - half_damping_ * sine)};
  }
  const double spread = std::sqrt(-square_);
  const double fast = half_damping_ + spread, slow = omega_ * omega_ / fast;
  const double late = std::exp(-slow * t), early = std::exp(-fast * t);
  return {(late - early) / (2.0 * spread), (fast * early - slow * late) / (2.0 * spread)};
}

/// g = t e^{−dt/2} (1 − q t² / 3! + ...), ġ = e^{−dt/2} (1 − q t² / 2! + ...) − d g / 2, q the
/// square.
void ModeKernel::near_critical(double h, std::span<double> answer, std::span<double> rate) const {
  const std::size_t count = answer.size();
  std::array<Complex, most_moments> late;
  exponential_moments(-half_damping_ * h, std::span(late).first(count + powers));
  std::array<double, most_moments> moments;
  for (std::size_t n = 0; n < count + powers; ++n) moments[n] = late[n].real();
  std::ranges::fill(answer, 0.0);
  std::ranges::fill(rate, 0.0);
  double factor = 1.0;  // of the power of τ
  for (std::size_t power = 0; power <= powers; ++power) {
    const bool even = power % 2 == 0;
    if (power > 0) {
      multiply_by_time(std::span(moments).first(count + powers + 1 - power));
      factor *= (even ? -square_ * h : h) / static_cast<double>(power);
    }
    for (std::size_t n = 0; n < count; ++n) (even ? rate[n] : answer[n]) += factor * moments[n];
  }
  for (std::size_t n = 0; n < count; ++n) rate[n] -= half_damping_ * answer[n];
}

void ModeKernel::moments(double h, std::span<double> answer, std::span<double> rate) const {
  const std::size_t count = std::min(answer.size(), rate.size());
  const double spread = std::sqrt(std::abs(square_));
  std::array<Complex, most_moments> late;
  if (spread * h < critical_phase) {
    near_critical(h, answer.first(count), rate.first(count));
    return;
  }
  if (square_ > 0.0) {
    const Complex exponent(-half_damping_, spread);
    exponential_moments(exponent * h, std::span(late).first(count));
    for (std::size_t n = 0; n < count; ++n) {
      answer[n] = late[n].imag() / spread;
      rate[n] = (exponent * late[n]).imag() / spread;
    }
    return;
  }
  std::array<Complex, most_moments> early;
  const double fast = half_damping_ + spread, slow = omega_ * omega_ / fast;
  exponential_moments(-slow * h, std::span(late).first(count));
  exponential_moments(-fast * h, std::span(early).first(count));
  for (std::size_t n = 0; n < count; ++n) {
    answer[n] = (late[n].real() - early[n].real()) / (2.0 * spread);
    rate[n] = (fast * early[n].real() - slow * late[n].real()) / (2.0 * spread);
  }
}

void advance_damped_modes(ModesUnderForce& modes) {
  std::array<double, 16> answer, rate;
  const auto terms = static_cast<std::size_t>(modes.series ? modes.terms : 0);
  modes.displacement = modes.velocity = modes.acceleration = 0.0;
  for (int m = 0; m < modes.modes; ++m) {
    const double square = modes.omega[m] * modes.omega[m];
    const ModeKernel kernel(modes.omega[m], modes.damping[m]);
    const auto [g, slope] = kernel.at(modes.h);
    double a = (slope + modes.damping[m] * g) * modes.a[m] + g * modes.rate[m];
    double speed = slope * modes.rate[m] - square * g * modes.a[m];
    if (terms > 0)
      kernel.moments(modes.h, std::span(answer).first(terms), std::span(rate).first(terms));
    for (std::size_t p = 0; p < terms; ++p) {
      // with the sign of (−1)ᵖ for the time left
      const double force = (p % 2 == 0 ? -1.0 : 1.0) * modes.struck[m] * modes.h * modes.series[p];
      a += force * answer[p];
      speed += force * rate[p];
    }
    modes.end_a[m] = a;
    modes.end_rate[m] = speed;
    modes.displacement += modes.struck[m] * a;
    modes.velocity += modes.struck[m] * speed;
    modes.acceleration -= modes.struck[m] * (square * a + modes.damping[m] * speed);
  }
}

void step_damped_modes(const ModesOverStep& modes) {
  const int s = modes.nodes, terms = std::max(modes.terms, s);
  std::array<double, ModesOverStep::most_terms> answer, rate;
  std::fill_n(modes.displacement_kernel, modes.terms, 0.0);
  std::fill_n(modes.velocity_kernel, modes.terms, 0.0);
  for (int m = 0; m < modes.modes; ++m) {
    const double damping = modes.damping[m], square = modes.omega[m] * modes.omega[m];
    const double struck = modes.struck[m];
    const ModeKernel kernel(modes.omega[m], damping);
    for (int i = 0; i < s; ++i) {
      const auto [g, slope] = kernel.at(modes.h * modes.points[i]);
      modes.displacement_of_a[i + m * s] = struck * (slope + damping * g);
      modes.displacement_of_rate[i + m * s] = struck * g;
      modes.velocity_of_a[i + m * s] = -struck * square * g;
      modes.velocity_of_rate[i + m * s] = struck * slope;
    }
    const auto [g, slope] = kernel.at(modes.h);
    modes.a_of_a[m] = slope + damping * g;
    modes.a_of_rate[m] = g;
    modes.rate_of_a[m] = -square * g;
    modes.rate_of_rate[m] = slope;
    const auto count = static_cast<std::size_t>(terms);
    kernel.moments(modes.h, std::span(answer).first(count), std::span(rate).first(count));
    for (int p = 0; p < modes.terms; ++p) {
      const double share = -(2.0 * p + 1.0) * struck * modes.seen[m];
      modes.displacement_kernel[p] += share * answer[static_cast<std::size_t>(p)];
      modes.velocity_kernel[p] += share * rate[static_cast<std::size_t>(p)];
    }
    for (int i = 0; i < s; ++i) {
      double of_a = 0.0, of_rate = 0.0;
      for (int p = 0; p < s; ++p) {
        const double part = (p % 2 == 0 ? 1.0 : -1.0) * modes.to_series[i * s + p];
        of_a += part * answer[static_cast<std::size_t>(p)];
        of_rate += part * rate[static_cast<std::size_t>(p)];
      }
      modes.a_of_force[i + m * s] = -modes.h * struck * of_a;
      modes.rate_of_force[i + m * s] = -modes.h * struck * of_rate;
    }
  }
}

}  // namespace impactrig::models
