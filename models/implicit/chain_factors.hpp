// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>
#include <vector>

#include "models/collocation/bar_motion.hpp"
#include "models/implicit/chain_points.hpp"
#include "models/implicit/complex_lanes.hpp"
#include "models/implicit/radau_stages.hpp"

namespace impactrig::models {

/// The linear systems of Radau steps of S stages of a chain at one tangent, kept by the length of
/// the step, each with what the bar answers to forces of the stops.
template <int S, typename Chain>
class ChainFactors {
 public:
  static constexpr int pairs = S / 2;
  using Complex = ComplexLanes<pairs>;
  using Systems = typename Chain::template Systems<pairs>;
  using Shares = SystemShares<pairs>;

  struct Factor {
    double h = 0.0;  ///< of the step [s]; 0: of an older tangent
    Systems systems;
    std::vector<std::vector<Complex>> pressed;   ///< solution for a unit force of each stop
    std::vector<BarMotion::Response> responses;  ///< of all stops at the first, then the others
  };

  /// `stops`: what makes up the displacement before each, of the chain's coordinates.
  ChainFactors(const Chain& chain, std::span<const ChainPoints::Shares> stops) : chain_(chain) {
    const auto coordinates = static_cast<std::size_t>(chain.coordinates());
    factors_.reserve(kept);
    for (std::size_t i = 0; i < kept; ++i)
      factors_.push_back(
          {.systems = chain.template make_systems<pairs>(),
           .pressed = std::vector(stops.size(), std::vector<Complex>(coordinates)),
           .responses = std::vector<BarMotion::Response>(stops.size() * stops.size())});
  }

  /// Of another tangent than those to come.
  void forget() {
    for (Factor& factor : factors_) factor.h = 0.0;
  }

  /// Of a step of this length to a thousandth. One that is not at hand takes the place of the
  /// oldest, its systems made by `factorise(shares, systems)`.
  template <typename Factorise>
  Factor& of(double h, std::span<const ChainPoints::Shares> stops, const Factorise& factorise) {
    for (Factor& factor : factors_)
      if (std::abs(factor.h - h) <= 1e-3 * h) return factor;
    Factor& factor = factors_[next_];
    next_ = (next_ + 1) % factors_.size();
    factor.h = h;
    factorise(shares_of(h), factor.systems);
    for (std::size_t stop = 0; stop < stops.size(); ++stop) respond_to(stop, stops, factor);
    return factor;
  }

 private:
  static constexpr std::size_t kept = 6;

  /// Of mass, stiffness and hinge in the system of each pair of stages.
  Shares shares_of(double h) const {
    const BarDamping& damping = chain_.damping();
    Shares shares;
    const auto put = [](const std::complex<double>& value, int j, Complex& share) {
      share.re[j] = value.real();
      share.im[j] = value.imag();
    };
    for (int j = 0; j < pairs; ++j) {
      const std::complex<double> z = h * stages_.eigenvalues[j];
      put(1.0 + z * damping.mass, j, shares.mass);
      put(z * z + z * damping.stiffness, j, shares.stiffness);
      put(z * z * chain_.hinge().spring + z * chain_.hinge().viscous, j, shares.first_node);
    }
    return shares;
  }

  /// All points to a unit force of a stop.
  void respond_to(std::size_t stop, std::span<const ChainPoints::Shares> stops,
                  Factor& factor) const {
    std::vector<Complex>& pressed = factor.pressed[stop];
    std::ranges::fill(pressed, Complex{});
    for (const auto& [k, w] : stops[stop]) pressed[static_cast<std::size_t>(k)].re += w;
    factor.systems.solve_in_place(pressed);
    for (std::size_t point = 0; point < stops.size(); ++point) {
      // acceleration across the bar before the point under a unit force at each node
      Complex own{};
      for (const auto& [k, w] : stops[point]) {
        own.re += w * pressed[static_cast<std::size_t>(k)].re;
        own.im += w * pressed[static_cast<std::size_t>(k)].im;
      }
      set_response(own, factor.h, factor.responses[point * stops.size() + stop]);
    }
  }

  void set_response(const Complex& own, double h, BarMotion::Response& response) const {
    Eigen::Matrix<double, S, S> acceleration = Eigen::Matrix<double, S, S>::Zero();
    for (int j = 0; j < pairs; ++j) {
      const auto re = own.re[j] * stages_.into_re.row(j) - own.im[j] * stages_.into_im.row(j);
      const auto im = own.re[j] * stages_.into_im.row(j) + own.im[j] * stages_.into_re.row(j);
      acceleration += stages_.out_re.col(j) * re - stages_.out_im.col(j) * im;
    }
    response.displacement_of_force = -h * h * stages_.to_displacement * acceleration;
    response.velocity_of_force = -h * stages_.to_velocity * acceleration;
    response.set_most();
  }

  const Chain& chain_;
  const RadauStages<S>& stages_ = RadauStages<S>::get();
  std::vector<Factor> factors_;
  std::size_t next_ = 0;
};

}  // namespace impactrig::models
