// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/bending_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "models/beams/bar_element.hpp"
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

namespace {

/// Inertia loads of the bar turning rigidly at 1 rad/s²: what those beyond s do to the section
/// there.
struct RigidLoad {
  double moment = 0.0;  ///< [kg m^2]
  double force = 0.0;   ///< [kg m]
};

RigidLoad rigid_load(const std::vector<BarElement>& pieces, const Beam& beam, double s) {
  RigidLoad load;
  for (const BarElement& piece : pieces) {
    const double to = piece.x + piece.length;
    const double from = std::max(piece.x, s);
    if (!(to > from)) continue;
    const double force = 0.5 * piece.line_density * (to * to - from * from);
    load.force += force;
    load.moment += piece.line_density * (to * to * to - from * from * from) / 3.0 - s * force +
                   piece.rotary_inertia * (to - from);
  }
  for (const LumpedMass& lump : beam.masses)
    if (lump.position > s) {
      load.force += lump.mass * lump.position;
      load.moment += lump.mass * lump.position * (lump.position - s);
    }
  return load;
}

}  // namespace

double slowest_vibration(const Beam& beam) {
  constexpr double share_at_tip = 0.25;  // of the bar's own mass, as Rayleigh has it
  double weakest = std::numeric_limits<double>::infinity();
  for (const BarElement& piece : bar_pieces(beam))
    weakest = std::min(weakest, piece.bending_stiffness);
  const double lumped = beam.total_mass() - beam.bar_mass();
  return std::sqrt(3.0 * weakest /
                   (std::pow(beam.length, 3) * (lumped + share_at_tip * beam.bar_mass())));
}

double clamped_compliance(const Beam& beam, double x) {
  double sum = 0.0;
  for (const BarElement& piece : bar_pieces(beam)) {
    const double near_by = x - piece.x, far = std::max(near_by - piece.length, 0.0);
    if (near_by <= 0.0) break;
    sum += (std::pow(near_by, 3) - std::pow(far, 3)) / (3.0 * piece.bending_stiffness) +
           (near_by - far) * piece.shear_compliance;
  }
  return sum;
}

double elastic_compliance(const Beam& beam, double x) {
  const double turned = x / beam.hinge_inertia();  // angular acceleration under a unit force
  const std::vector<BarElement> pieces = bar_pieces(beam);
  const GaussRule& rule = gauss_legendre(4);  // M² has degree six between the corners
  double sum = 0.0;
  for (const BarElement& piece : pieces) {
    const double end = piece.x + piece.length;
    std::vector<double> corners = {piece.x, end};
    const auto add_corner = [&](double at) {
      if (at > piece.x && at < end) corners.push_back(at);
    };
    add_corner(x);
    for (const LumpedMass& lump : beam.masses) add_corner(lump.position);
    std::ranges::sort(corners);
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const double panel = corners[i] - corners[i - 1];
      for (std::size_t g = 0; g < rule.points.size(); ++g) {
        const double s = corners[i - 1] + panel * rule.points[g];
        const RigidLoad load = rigid_load(pieces, beam, s);
        const double moment = std::max(x - s, 0.0) - turned * load.moment;
        const double force = (x > s ? 1.0 : 0.0) - turned * load.force;
        sum += panel * rule.weights[g] *
               (moment * moment / piece.bending_stiffness + force * force * piece.shear_compliance);
      }
    }
  }
  return sum;
}

}  // namespace impactrig::models
