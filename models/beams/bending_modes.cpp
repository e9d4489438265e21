// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/bending_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/integration/gauss.hpp"

namespace impactrig::models {
namespace {

/// Root of the frequency equation, z = βL.
double frequency_root(Basis basis, int number) {
  const double k = static_cast<double>(number);
  double z =
      basis == Basis::cantilever ? (k - 0.5) * std::numbers::pi : (k + 0.25) * std::numbers::pi;
  if (basis == Basis::cantilever && number == 1) z = 1.875;
  for (int i = 0; i < 20; ++i) {
    double f = 0.0;
    double slope = 0.0;
    if (basis == Basis::cantilever) {
      f = std::cos(z) + 1.0 / std::cosh(z);
      slope = -std::sin(z) - std::tanh(z) / std::cosh(z);
    } else {
      f = std::sin(z) - std::cos(z) * std::tanh(z);
      slope =
          std::cos(z) + std::sin(z) * std::tanh(z) - std::cos(z) / (std::cosh(z) * std::cosh(z));
    }
    const double step = f / slope;
    z -= step;
    if (std::abs(step) < 1e-16 * z) break;
  }
  return z;
}

/// Shape as a function of ξ = βx, without scale: value and derivatives with respect to ξ.
ModeShape cantilever_shape(double xi, double z) {
  const double s = std::sin(z);
  const double c = std::cos(z);
  const double decay = std::exp(-z);
  const double denominator = 1.0 - decay * decay + 2.0 * decay * s;
  const double grow = (s - c - decay) / denominator * std::exp(xi - z);  // (1 − σ) e^ξ / 2
  const double sigma = (1.0 + decay * decay + 2.0 * decay * c) / denominator;
  const double fall = 0.5 * (1.0 + sigma) * std::exp(-xi);
  return {grow + fall - std::cos(xi) + sigma * std::sin(xi),
          grow - fall + std::sin(xi) + sigma * std::cos(xi),
          grow + fall + std::cos(xi) - sigma * std::sin(xi)};
}

ModeShape pinned_free_shape(double xi, double z) {
  // sin z / sinh z · (sinh ξ, cosh ξ)
  const double factor = std::sin(z) * std::exp(xi - z) / (1.0 - std::exp(-2.0 * z));
  const double sinh_part = factor * (1.0 - std::exp(-2.0 * xi));
  const double cosh_part = factor * (1.0 + std::exp(-2.0 * xi));
  return {std::sin(xi) + sinh_part, std::cos(xi) + cosh_part, -std::sin(xi) + sinh_part};
}

}  // namespace

BendingMode::BendingMode(const Beam& beam, Basis basis, int number)
    : basis_(basis),
      length_(beam.length),
      z_(frequency_root(basis, number)) {
  const double beta = z_ / length_;
  omega_ = beta * beta *
           std::sqrt(beam.youngs_modulus * beam.second_moment / (beam.density * beam.area));
  // ∫ φ² dx = (L/4) φ(L)² for both families [Blevins1979]: the tip value sets the scale.
  const double tip = at(length_).value;
  scale_ = 2.0 / (std::abs(tip) * std::sqrt(beam.bar_mass()));
}

ModeShape BendingMode::at(double x) const {
  const double beta = z_ / length_;
  const ModeShape shape = basis_ == Basis::cantilever ? cantilever_shape(beta * x, z_)
                                                      : pinned_free_shape(beta * x, z_);
  return {scale_ * shape.value, scale_ * beta * shape.slope,
          scale_ * beta * beta * shape.curvature};
}

std::vector<BendingMode> bending_modes(const Beam& beam, Basis basis, int count) {
  std::vector<BendingMode> modes;
  for (int number = 1; number <= count; ++number) modes.emplace_back(beam, basis, number);
  return modes;
}

double elastic_compliance(const Beam& beam, double x) {
  const double turned = x / beam.hinge_inertia();  // angular acceleration under a unit force
  const double length = beam.length;
  // bending moment at s, from the loads beyond it
  const auto moment = [&](double s) {
    double load =
        beam.density * beam.area *
        ((length * length * length - s * s * s) / 3.0 - 0.5 * s * (length * length - s * s));
    for (const LumpedMass& lump : beam.masses)
      load += lump.mass * lump.position * std::max(lump.position - s, 0.0);
    return std::max(x - s, 0.0) - turned * load;
  };
  std::vector<double> corners = {0.0, x, length};
  for (const LumpedMass& lump : beam.masses) corners.push_back(lump.position);
  std::ranges::sort(corners);
  const GaussRule& rule = gauss_legendre(4);  // M² has degree six between the corners
  double sum = 0.0;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const double panel = corners[i] - corners[i - 1];
    for (std::size_t g = 0; g < rule.points.size(); ++g)
      sum += panel * rule.weights[g] * std::pow(moment(corners[i - 1] + panel * rule.points[g]), 2);
  }
  return sum / (beam.youngs_modulus * beam.second_moment);
}

}  // namespace impactrig::models
