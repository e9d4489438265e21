// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/lanes/lane_bessel.hpp"
#include "models/lanes/lane_chunk.hpp"
#include "models/lanes/mode_lanes.hpp"

namespace impactrig::models {
namespace {

/// step_modes() for N modes at a time.
template <int N>
class ModeStep {
 public:
  explicit ModeStep(const ModesOverStep& modes) : modes_(modes) {
    for (int p = 0; p < modes.terms; ++p) displacement_kernel_[p] = velocity_kernel_[p] = Real{};
  }

  void respond() {
    for (int first = 0; first < modes_.modes; first += N) {
      const LaneChunk<N> chunk(first, modes_.modes);
      const Real omega = chunk.load(modes_.omega), struck = chunk.load(modes_.struck);
      respond_to_state(chunk, omega, struck);
      respond_to_force(chunk, omega, struck, chunk.load(modes_.seen));
    }
    for (int p = 0; p < modes_.terms; ++p) {
      modes_.displacement_kernel[p] = M::sum(displacement_kernel_[p]);
      modes_.velocity_kernel[p] = M::sum(velocity_kernel_[p]);
    }
  }

 private:
  using M = LaneMath<N>;
  using Real = typename M::Real;
  static constexpr int most_nodes = 16;

  struct Swing {
    Real cosine, sine_over_omega, minus_omega_sine;
  };

  Swing swing(Real omega, double t) const {
    const Real theta = omega * t;
    const auto [sine, cosine] = M::sine_cosine(theta);
    const Real near = t * (1.0 - theta * theta * (1.0 / 6.0));
    return {cosine, theta < 1e-4 ? near : sine / omega, -omega * sine};
  }

  void respond_to_state(const LaneChunk<N>& chunk, Real omega, Real struck) const {
    const int s = modes_.nodes;
    for (int i = 0; i < s; ++i) {
      const Swing part = swing(omega, modes_.h * modes_.points[i]);
      chunk.store(struck * part.cosine, modes_.of_a + i, 2 * s);
      chunk.store(struck * part.sine_over_omega, modes_.of_rate + i, 2 * s);
      chunk.store(struck * part.minus_omega_sine, modes_.of_a + s + i, 2 * s);
      chunk.store(struck * part.cosine, modes_.of_rate + s + i, 2 * s);
    }
    const Swing whole = swing(omega, modes_.h);
    chunk.store(whole.cosine, modes_.a_of_a);
    chunk.store(whole.sine_over_omega, modes_.a_of_rate);
    chunk.store(whole.minus_omega_sine, modes_.rate_of_a);
    chunk.store(whole.cosine, modes_.rate_of_rate);
  }

  void respond_to_force(const LaneChunk<N>& chunk, Real omega, Real struck, Real seen) {
    const double h = modes_.h;
    const Real z = M::larger(0.5 * h * omega, M::all(1e-9));
    const auto [sine, cosine] = M::sine_cosine(z);
    const int own = LaneBessel<N, 1>::needed(z);
    const int terms = own < modes_.terms ? own : modes_.terms;
    bessel_.evaluate(z, sine, cosine, terms > modes_.nodes ? terms : modes_.nodes);
    // j_p times the parts of iᵖ e^{iz}: moments of sin θτ / θ and cos θτ with P_p
    const Real over = 0.5 / z;
    Real a[most_nodes], rate[most_nodes];
    for (int p = 0; p < terms || p < modes_.nodes; ++p) {
      const Real turned_sine = p % 2 == 0 ? sine : cosine;
      const Real turned_cosine = p % 2 == 0 ? cosine : sine;
      const Real of_sine = (p % 4 < 2 ? bessel_[p] : -bessel_[p]) * turned_sine * over;
      const Real of_cosine = (p % 4 == 0 || p % 4 == 3 ? bessel_[p] : -bessel_[p]) * turned_cosine;
      const double sign = p % 2 == 0 ? 1.0 : -1.0;  // for the time left
      if (p < modes_.nodes) {
        a[p] = sign * of_sine;
        rate[p] = sign * of_cosine;
      }
      if (p >= terms) continue;
      const Real share = -(2.0 * p + 1.0) * struck * seen;
      displacement_kernel_[p] += h * share * of_sine;
      velocity_kernel_[p] += share * of_cosine;
    }
    to_values(chunk, -h * h * struck, a, modes_.a_of_force);
    to_values(chunk, -h * struck, rate, modes_.rate_of_force);
  }

  /// From moments with P_p to those with the polynomials of the nodes.
  void to_values(const LaneChunk<N>& chunk, Real factor, const Real* moments, double* out) const {
    const int s = modes_.nodes;
    for (int i = 0; i < s; ++i) {
      Real sum = Real{};
      for (int p = 0; p < s; ++p) sum += modes_.to_series[i * s + p] * moments[p];
      chunk.store(factor * sum, out + i * modes_.modes);
    }
  }

  const ModesOverStep& modes_;
  LaneBessel<N, ModesOverStep::most_terms> bessel_;
  Real displacement_kernel_[ModesOverStep::most_terms], velocity_kernel_[ModesOverStep::most_terms];
};

}  // namespace
}  // namespace impactrig::models
