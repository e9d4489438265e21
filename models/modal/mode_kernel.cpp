// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/mode_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "models/collocation/collocation.hpp"

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

// λh above which the start of a mode that creeps back is early: as many moments of it as a rule has
// nodes follow from each other upwards.
constexpr double early_phase = 0.5 * most_nodes * most_nodes;
// Of the two λ of a mode: from here on both can be told apart, and, for a bar moved a little along
// a slope too, will be.
constexpr double split = 2.0, safely_split = 4.0;

/// How many moments are above rounding.
int moments_needed(double size) {
  return static_cast<int>(size + 16.0 + 6.0 * std::cbrt(size));
}

/// e^z − 1.
double less_one(double z) {
  return std::expm1(z);
}

Complex less_one(Complex z) {
  const double half_sine = std::sin(0.5 * z.imag());
  return {std::expm1(z.real()) * std::cos(z.imag()) - 2.0 * half_sine * half_sine,
          std::exp(z.real()) * std::sin(z.imag())};
}

/// zⁿ / (2n + 1)!! (1 + z² / (2 (2n + 3)) + ...), times e^z.
template <typename Number>
void small_moments(Number z, std::span<Number> moments) {
  Number leading = std::exp(z);
  const Number square = z * z;
  for (std::size_t n = 0; n < moments.size(); ++n) {
    const auto order = static_cast<double>(n);
    const Number third = square * (0.25 / (2.0 * order + 5.0));
    moments[n] = leading * (1.0 + square * (0.5 / (2.0 * order + 3.0)) * (1.0 + third));
    leading *= z * (1.0 / (2.0 * order + 3.0));
  }
}

/// i_{n+1} = i_{n−1} − (2n + 1) i_n / z, times e^z.
void early_moments(double z, std::span<double> moments) {
  const double inverse = 1.0 / z;
  double below = 0.5 * inverse * std::expm1(2.0 * z);
  double here = inverse * (0.5 * (std::exp(2.0 * z) + 1.0) - below);
  for (std::size_t n = 0; n < moments.size(); ++n) {
    moments[n] = below;
    const double above = below - (2.0 * static_cast<double>(n) + 3.0) * inverse * here;
    below = here;
    here = above;
  }
}

/// Miller's recurrence backwards, i_{n−1} = i_{n+1} + (2n + 1) i_n / z; what it grows by down to
/// n = 0 stays far within the range of double.
template <typename Number>
void recurred_moments(Number z, std::span<Number> moments) {
  const Number inverse = 1.0 / z;
  const int count = static_cast<int>(moments.size());
  Number above = 0.0, here = 1e-150;
  const int from = moments_needed(std::abs(z)) + 4;
  for (int n = std::max(from + 1, 0); n < count; ++n) moments[static_cast<std::size_t>(n)] = 0.0;
  Number first = 0.0, second = 0.0;
  for (int n = from; n >= 0; --n) {
    if (n < count) moments[static_cast<std::size_t>(n)] = here;
    if (n == 1) second = here;
    if (n == 0) first = here;
    const Number below = above + (2.0 * n + 1.0) * inverse * here;
    above = here;
    here = below;
  }
  // e^z i_0 and e^z i_1 in closed form; the larger of the two has lost nothing
  const Number zeroth = 0.5 * inverse * less_one(2.0 * z);
  const Number scale = std::norm(first) >= std::norm(second)
                           ? zeroth / first
                           : inverse * (0.5 * (std::exp(2.0 * z) + 1.0) - zeroth) / second;
  for (int n = 0; n < std::min(count, from + 1); ++n) moments[static_cast<std::size_t>(n)] *= scale;
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
  std::abs(z) < small ? small_moments(z, moments) : recurred_moments(z, moments);
}

void exponential_moments(double exponent, std::span<double> moments) {
  const double z = 0.5 * exponent;
  const auto square = static_cast<double>(moments.size() * moments.size());
  if (std::abs(z) < small)
    small_moments(z, moments);
  else if (-4.0 * z >= square)
    early_moments(z, moments);
  else
    recurred_moments(z, moments);
}

ModeKernel::ModeKernel(double omega, double damping)
    : omega_(omega),
      half_damping_(0.5 * damping),
      square_((omega - half_damping_) * (omega + half_damping_)),
      spread_(std::sqrt(std::abs(square_))) {
  if (square_ >= 0.0) return;
  fast_ = half_damping_ + spread_;
  slow_ = omega_ * omega_ / fast_;
}

bool ModeKernel::is_split(double ratio) const {
  return square_ < 0.0 && half_damping_ > 0.0 && fast_ > ratio * slow_;
}

bool ModeKernel::starts_early(double h) const {
  return is_split(split) && fast_ * h >= early_phase;
}

double ModeKernel::lasting_rate() const {
  return is_split(safely_split) ? slow_ : fastest_rate();
}

double ModeKernel::rate_in_series(double h) const {
  return starts_early(h) ? slow_ : fastest_rate();
}

ModeKernel::Value ModeKernel::at(double t) const {
  const double phase = spread_ * t;
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
  const double late = std::exp(-slow_ * t), early = std::exp(-fast_ * t);
  return {(late - early) / (2.0 * spread_), (fast_ * early - slow_ * late) / (2.0 * spread_)};
}

/// g = t e^{−dt/2} (1 − q t² / 3! + ...), ġ = e^{−dt/2} (1 − q t² / 2! + ...) − d g / 2, q the
/// square.
void ModeKernel::near_critical(double h, std::span<double> answer, std::span<double> rate) const {
  const std::size_t count = answer.size();
  std::array<double, most_moments> moments;
  exponential_moments(-half_damping_ * h, std::span(moments).first(count + powers));
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
  if (spread_ * h < critical_phase) {
    near_critical(h, answer.first(count), rate.first(count));
    return;
  }
  if (square_ > 0.0) {
    std::array<Complex, most_moments> moments;
    const Complex exponent(-half_damping_, spread_);
    exponential_moments(exponent * h, std::span(moments).first(count));
    for (std::size_t n = 0; n < count; ++n) {
      answer[n] = moments[n].imag() / spread_;
      rate[n] = (exponent * moments[n]).imag() / spread_;
    }
    return;
  }
  late_moments(h, answer.first(count), rate.first(count));
  std::array<double, most_moments> moments;
  exponential_moments(-fast_ * h, std::span(moments).first(count));
  for (std::size_t n = 0; n < count; ++n) {
    answer[n] += early().answer * moments[n];
    rate[n] += early().rate * moments[n];
  }
}

void ModeKernel::late_moments(double h, std::span<double> answer, std::span<double> rate) const {
  const std::size_t count = std::min(answer.size(), rate.size());
  exponential_moments(-slow_ * h, answer.first(count));
  for (std::size_t n = 0; n < count; ++n) {
    answer[n] *= 0.5 / spread_;
    rate[n] = -slow_ * answer[n];
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

namespace {

/// ∫₀ˣ e^{−k(x − σ)} P_p(2σ − 1) dσ, k large: by parts, P_p being the derivative of a multiple of
/// P_{p+1} − P_{p−1}, upwards.
void early_convolutions(double k, double x, std::span<double> values) {
  const double inverse = 1.0 / k, t = 2.0 * x - 1.0, decay = std::exp(-k * x);
  double below = -std::expm1(-k * x) * inverse;
  double here = (t + decay - 2.0 * below) * inverse;
  double before = 1.0, legendre = t;
  for (std::size_t p = 0; p < values.size(); ++p) {
    values[p] = below;
    const double order = static_cast<double>(p) + 1.0;
    const double next = ((2.0 * order + 1.0) * t * legendre - order * before) / (order + 1.0);
    const double above = below + inverse * ((next - before) - 2.0 * (2.0 * order + 1.0) * here);
    below = here;
    here = above;
    before = legendre;
    legendre = next;
  }
}

/// What the early start of a mode adds to the seen point at the nodes.
void add_early(const ModesOverStep& modes, const ModeKernel::Early& early, double share) {
  const int s = modes.nodes;
  std::array<double, most_nodes> values;
  for (int i = 0; i < s; ++i) {
    early_convolutions(early.exponent * modes.h, modes.points[i],
                       std::span(values).first(static_cast<std::size_t>(s)));
    for (int p = 0; p < s; ++p) {
      const double value = share * values[static_cast<std::size_t>(p)];
      modes.early_displacement[i + p * s] += early.answer * value;
      modes.early_velocity[i + p * s] += early.rate * value;
    }
  }
}

}  // namespace

void step_damped_modes(const ModesOverStep& modes) {
  const int s = modes.nodes;
  std::array<double, ModesOverStep::most_terms> answer, rate;
  std::fill_n(modes.displacement_kernel, modes.terms, 0.0);
  std::fill_n(modes.velocity_kernel, modes.terms, 0.0);
  std::fill_n(modes.early_displacement, s * s, 0.0);
  std::fill_n(modes.early_velocity, s * s, 0.0);
  for (int m = 0; m < modes.modes; ++m) {
    const double damping = modes.damping[m], square = modes.omega[m] * modes.omega[m];
    const double struck = modes.struck[m];
    const ModeKernel kernel(modes.omega[m], damping);
    for (int i = 0; i < s; ++i) {
      const auto [g, slope] = kernel.at(modes.h * modes.points[i]);
      const int row = i + 2 * s * m;
      modes.of_a[row] = struck * (slope + damping * g);
      modes.of_rate[row] = struck * g;
      modes.of_a[row + s] = -struck * square * g;
      modes.of_rate[row + s] = struck * slope;
    }
    const auto [g, slope] = kernel.at(modes.h);
    modes.a_of_a[m] = slope + damping * g;
    modes.a_of_rate[m] = g;
    modes.rate_of_a[m] = -square * g;
    modes.rate_of_rate[m] = slope;
    const bool early = kernel.starts_early(modes.h);
    const int needed = moments_needed(0.5 * kernel.rate_in_series(modes.h) * modes.h);
    const int terms = std::max(std::min(modes.terms, needed), s);
    const auto first = [](std::array<double, ModesOverStep::most_terms>& moments, int count) {
      return std::span(moments).first(static_cast<std::size_t>(count));
    };
    if (early)
      kernel.late_moments(modes.h, first(answer, terms), first(rate, terms));
    else
      kernel.moments(modes.h, first(answer, terms), first(rate, terms));
    const double seen = -struck * modes.seen[m];
    for (int p = 0; p < terms; ++p) {
      modes.displacement_kernel[p] += (2.0 * p + 1.0) * seen * answer[static_cast<std::size_t>(p)];
      modes.velocity_kernel[p] += (2.0 * p + 1.0) * seen * rate[static_cast<std::size_t>(p)];
    }
    if (early) {
      add_early(modes, kernel.early(), seen);
      kernel.moments(modes.h, first(answer, s), first(rate, s));
    }
    for (int i = 0; i < s; ++i) {
      double of_a = 0.0, of_rate = 0.0;
      for (int p = 0; p < s; ++p) {
        const double part = (p % 2 == 0 ? 1.0 : -1.0) * modes.to_series[i * s + p];
        of_a += part * answer[static_cast<std::size_t>(p)];
        of_rate += part * rate[static_cast<std::size_t>(p)];
      }
      modes.a_of_force[m + i * modes.modes] = -modes.h * struck * of_a;
      modes.rate_of_force[m + i * modes.modes] = -modes.h * struck * of_rate;
    }
  }
}

}  // namespace impactrig::models
