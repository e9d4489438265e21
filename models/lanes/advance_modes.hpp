// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "models/lanes/lane_bessel.hpp"
#include "models/lanes/lane_chunk.hpp"
#include "models/lanes/mode_lanes.hpp"

namespace impactrig::models {
namespace {

/// advance_modes() for N modes at a time.
template <int N>
class ModeAdvance {
 public:
  explicit ModeAdvance(ModesUnderForce& modes) : modes_(modes) {}

  void advance() {
    if (modes_.terms == 6) return advance(std::integral_constant<int, 6>{});
    if (modes_.terms == 8) return advance(std::integral_constant<int, 8>{});
    advance(modes_.terms);
  }

 private:
  using M = LaneMath<N>;
  using Real = typename M::Real;
  static constexpr int most_terms = 16;

  struct State {
    Real a, rate;
  };

  /// Under a series of so many terms, which the compiler may know.
  void advance(auto terms) {
    Real displacement = Real{}, velocity = Real{}, acceleration = Real{};
    by_chunks<N>(modes_.modes, [&](const auto& chunk) {
      const Real omega = chunk.load(modes_.omega), struck = chunk.load(modes_.struck);
      const State end =
          advance(omega, struck, {chunk.load(modes_.a), chunk.load(modes_.rate)}, terms);
      chunk.store(end.a, modes_.end_a);
      chunk.store(end.rate, modes_.end_rate);
      displacement += struck * end.a;
      velocity += struck * end.rate;
      acceleration -= struck * omega * omega * end.a;
    });
    modes_.displacement = M::sum(displacement);
    modes_.velocity = M::sum(velocity);
    modes_.acceleration = M::sum(acceleration);
  }

  State advance(Real omega, Real struck, const State& begin, auto terms) {
    const double h = modes_.h;
    const Real theta = omega * h;
    const Real half = 0.5 * theta;
    const auto [half_sine, cosine] = M::sine_cosine(half);
    const Real whole_sine = 2.0 * half_sine * cosine;
    const Real whole_cosine = 1.0 - 2.0 * half_sine * half_sine;
    const Real over = theta < 1e-4 ? h * (1.0 - theta * theta * (1.0 / 6.0)) : whole_sine / omega;
    State end{whole_cosine * begin.a + over * begin.rate,
              whole_cosine * begin.rate - omega * whole_sine * begin.a};
    if (!modes_.series) return end;
    const Real z = M::larger(half, M::all(1e-9));  // as good as zero, and no zero
    const Real sine = half < 1e-9 ? z : half_sine;
    bessel_.evaluate(z, sine, cosine, terms);
    // moments of sin θτ and cos θτ with P_p: j_p times the parts of iᵖ e^{iz}
    Real a = Real{}, rate = Real{};
    count_up(terms, [&](int p) {
      const Real share = bessel_[p] * modes_.series[p];
      // with the sign of (−1)ᵖ for the time left
      a += (p % 4 == 0 || p % 4 == 3 ? share : -share) * (p % 2 == 0 ? sine : cosine);
      rate += (p % 4 == 0 || p % 4 == 1 ? share : -share) * (p % 2 == 0 ? cosine : sine);
    });
    end.a -= struck * (h * h) * a / (2.0 * z);
    end.rate -= struck * h * rate;
    return end;
  }

  ModesUnderForce& modes_;
  LaneBessel<N, most_terms> bessel_;
};

}  // namespace
}  // namespace impactrig::models
