// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/modal/spherical_bessel.hpp"

namespace impactrig::models {
namespace {

constexpr int most_terms = Collocation::block_size * Collocation::blocks;
// Phase of the highest mode over a step whose series has that many terms, with some to spare.
constexpr double longest_phase = 360.0;
// A bar moved along a slope by a little vibrates a little faster than the ladder of steps knows.
constexpr double slack = 0.01;

/// sin(θτ) = Σ (2n+1) s_n P_n(τ), cos(θτ) = Σ (2n+1) c_n P_n(τ), τ in [0, 1], by
/// e^{izx} = Σ (2n+1) iⁿ j_n(z) P_n(x) [DLMF2010, 10.60.7] with z = θ/2, x = 2τ − 1.
class KernelSeries {
 public:
  explicit KernelSeries(double theta, int terms)
      : z_(0.5 * theta),
        real_(std::cos(z_)),
        imaginary_(std::sin(z_)),
        terms_(std::min(terms, most_terms)) {
    spherical_bessel(z_, {bessel_.data(), static_cast<std::size_t>(terms_)});
  }

  double sine(int n) const { return bessel_[static_cast<std::size_t>(n)] * turned(n, true); }

  double cosine(int n) const { return bessel_[static_cast<std::size_t>(n)] * turned(n, false); }

  /// How many terms matter.
  static int needed(double theta) {
    const double z = 0.5 * theta;
    return static_cast<int>(z + 14.0 + 6.0 * std::cbrt(z));
  }

 private:
  /// Imaginary or real part of iⁿ e^{iz}.
  double turned(int n, bool imaginary) const {
    switch (n % 4) {
      case 0:
        return imaginary ? imaginary_ : real_;
      case 1:
        return imaginary ? real_ : -imaginary_;
      case 2:
        return imaginary ? -imaginary_ : -real_;
      default:
        return imaginary ? -real_ : imaginary_;
    }
  }

  double z_, real_, imaginary_;
  int terms_;
  std::array<double, most_terms> bessel_;
};

/// sin(ωh) / ω, also for ω = 0.
double sine_over(double omega, double h) {
  const double theta = omega * h;
  return theta < 1e-4 ? h * (1.0 - theta * theta / 6.0) : std::sin(theta) / omega;
}

/// (−1)^p ∫₀¹ sin(θτ) P_p(τ) dτ / θ, also for θ = 0, where only p = 0 and 1 are left.
double sine_moment(const KernelSeries& kernel, double theta, int p) {
  const double sign = p % 2 == 0 ? 1.0 : -1.0;
  if (theta < 1e-9) return p == 0 ? 0.5 : p == 1 ? -1.0 / 6.0 : 0.0;
  return sign * kernel.sine(p) / theta;
}

}  // namespace

double ModalStep::longest(const ModalBeam& beam) {
  const double highest = beam.omega().maxCoeff();
  return highest > 0.0 ? longest_phase / highest : std::numeric_limits<double>::infinity();
}

ModalStep::ModalStep(const ModalBeam& beam, const Collocation& rule, double h)
    : h_(h),
      a_of_force_(beam.modes(), rule.nodes()),
      rate_of_force_(beam.modes(), rule.nodes()) {
  if (h > longest(beam) * (1.0 + slack))
    throw std::logic_error("ModalStep: the step is too long for the highest mode");
  respond_to_state(beam, rule);
  respond_to_force(beam, rule);
}

void ModalStep::respond_to_state(const ModalBeam& beam, const Collocation& rule) {
  const int m = beam.modes();
  const int s = rule.nodes();
  const Eigen::ArrayXd theta = h_ * beam.omega().array();
  cosine_ = theta.cos();
  minus_omega_sine_ = -beam.omega().array() * theta.sin();
  sine_over_omega_.resize(m);
  for (int k = 0; k < m; ++k) sine_over_omega_[k] = sine_over(beam.omega()[k], h_);
  Response& r = response_;
  r.displacement_of_a.resize(s, m);
  r.displacement_of_rate.resize(s, m);
  r.velocity_of_a.resize(s, m);
  for (int k = 0; k < m; ++k)
    for (int i = 0; i < s; ++i) {
      const double omega = beam.omega()[k];
      const double share = beam.struck()[k];
      const double t = h_ * rule.points()[i];
      const double sine = std::sin(omega * t);
      r.displacement_of_a(i, k) = share * std::cos(omega * t);
      r.displacement_of_rate(i, k) = share * (theta[k] < 1e-4 ? sine_over(omega, t) : sine / omega);
      r.velocity_of_a(i, k) = -share * omega * sine;
    }
  r.velocity_of_rate = r.displacement_of_a;
}

void ModalStep::respond_to_force(const ModalBeam& beam, const Collocation& rule) {
  const int m = beam.modes();
  const int s = rule.nodes();
  const Eigen::ArrayXd theta = h_ * beam.omega().array();
  const int terms = std::max(KernelSeries::needed(theta.maxCoeff()), s);
  const int blocks = (terms + Collocation::block_size - 1) / Collocation::block_size;
  // Σ r² sin(θτ)/ω and Σ r² cos(θτ), with the sign of a force that presses back
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(blocks * Collocation::block_size);
  Eigen::VectorXd velocity = displacement;
  Eigen::VectorXd a_series(s), rate_series(s);
  for (int k = 0; k < m; ++k) {
    const double share = -beam.struck()[k] * beam.struck()[k];
    const int own = std::max(KernelSeries::needed(theta[k]), s);
    const KernelSeries kernel(theta[k], own);
    if (theta[k] < 1e-9) {
      displacement[0] += 0.5 * share * h_;
      displacement[1] += 0.5 * share * h_;
      velocity[0] += share;
    } else {
      const double over = share * h_ / theta[k];
      for (int n = 0; n < own; ++n) {
        displacement[n] += (2.0 * n + 1.0) * over * kernel.sine(n);
        velocity[n] += (2.0 * n + 1.0) * share * kernel.cosine(n);
      }
    }
    for (int p = 0; p < s; ++p) {
      a_series[p] = h_ * h_ * sine_moment(kernel, theta[k], p);
      rate_series[p] = h_ * (p % 2 == 0 ? 1.0 : -1.0) * kernel.cosine(p);
    }
    a_of_force_.row(k) = -beam.struck()[k] * a_series.transpose() * rule.to_series();
    rate_of_force_.row(k) = -beam.struck()[k] * rate_series.transpose() * rule.to_series();
  }
  Eigen::VectorXd displacement_at_nodes = Eigen::VectorXd::Zero(s * s);
  Eigen::VectorXd velocity_at_nodes = displacement_at_nodes;
  for (int b = 0; b < blocks; ++b) {
    const Eigen::MatrixXd& convolutions = rule.convolutions(b);
    const auto part = Eigen::seqN(b * Collocation::block_size, Collocation::block_size);
    displacement_at_nodes.noalias() += convolutions * displacement(part);
    velocity_at_nodes.noalias() += convolutions * velocity(part);
  }
  using Square = Eigen::Map<const Eigen::MatrixXd>;
  response_.of_force.displacement_of_force = h_ * Square(displacement_at_nodes.data(), s, s);
  response_.of_force.velocity_of_force = h_ * Square(velocity_at_nodes.data(), s, s);
}

void ModalStep::coast(const ModalState& from, ModalState& to) const {
  to.a.array() = cosine_ * from.a.array() + sine_over_omega_ * from.rate.array();
  to.rate.array() = minus_omega_sine_ * from.a.array() + cosine_ * from.rate.array();
}

void ModalStep::advance(const ModalState& from, const NodeVector& force, ModalState& to) const {
  coast(from, to);
  to.a.noalias() += a_of_force_ * force;
  to.rate.noalias() += rate_of_force_ * force;
}

void ModalJump::set(const ModalBeam& beam, double h, int terms) {
  const int m = beam.modes();
  cosine_.resize(m);
  sine_over_omega_.resize(m);
  minus_omega_sine_.resize(m);
  a_of_series_.resize(m, terms);
  rate_of_series_.resize(m, terms);
  for (int k = 0; k < m; ++k) {
    const double omega = beam.omega()[k];
    const double theta = omega * h;
    cosine_[k] = std::cos(theta);
    sine_over_omega_[k] = sine_over(omega, h);
    minus_omega_sine_[k] = -omega * std::sin(theta);
    const KernelSeries kernel(theta, terms);
    for (int p = 0; p < terms; ++p) {
      const double sign = p % 2 == 0 ? 1.0 : -1.0;
      a_of_series_(k, p) = -beam.struck()[k] * h * h * sine_moment(kernel, theta, p);
      rate_of_series_(k, p) = -beam.struck()[k] * h * sign * kernel.cosine(p);
    }
  }
}

void ModalJump::advance(const NodeVector& series, const ModalState& from, ModalState& to) const {
  to.a.array() = cosine_ * from.a.array() + sine_over_omega_ * from.rate.array();
  to.rate.array() = minus_omega_sine_ * from.a.array() + cosine_ * from.rate.array();
  if (!series.any()) return;
  to.a.noalias() += a_of_series_ * series;
  to.rate.noalias() += rate_of_series_ * series;
}

}  // namespace impactrig::models
