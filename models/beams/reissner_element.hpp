// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "models/beams/bar_element.hpp"

namespace impactrig::models {

/// A two-node element of a plane bar that shears, exact in its geometry [Reissner1972,
/// SimoVuQuoc1986]. X is the displacement across the hanging bar, U along it, Θ the rotation of a
/// section (X' of a bar that turns without shear, to first order). With the unit vectors t = (sin
/// Θ, −cos Θ) normal to the section and n = (cos Θ, sin Θ) in it, and r' = (X', U' − 1),
///
///   Γ = r'·t − 1,   γ = r'·n,   κ = Θ',   U = ½ ∫ EA Γ² + κGA γ² + EI κ² dx
///
/// are stretch, shear and bending; a rigid motion leaves all zero. The material is Kelvin-Voigt's
/// with the retardation time τ: with a strain goes τ its rate.
///
/// X and U are cubic, Θ quadratic: linear between the nodes, with 4 (ξ − ξ²) times X_a, U_a, Θ_b
/// and ξ (1 − ξ) (1 − 2ξ) times X_c, U_c inside. In small motion these are BarElement's w and θ,
/// and with them Hermite's cubics where nothing shears. Three Gauss points: exact there, and
/// whatever Θ, there are X' and U', quadratic, that leave no stretch and no shear at the three, so
/// that no slender bar locks.
///
/// In the plane rotations add up, so the mass matrix is constant.
class ReissnerElement {
 public:
  /// Of its coordinates; the last three, of the second node, are the next element's first.
  enum Place : std::size_t { x0, u0, turn0, xa, ua, xc, uc, turn_b, x1, u1, turn1 };

  static constexpr int values = 11;
  static constexpr int own = 8;

  template <typename Value>
  using Values = std::array<Value, values>;  ///< a Value is a number or lanes of numbers
  using Vector = Eigen::Matrix<double, values, 1>;
  using Matrix = Eigen::Matrix<double, values, values>;

  explicit ReissnerElement(const BarElement& bar);

  const BarElement& bar() const { return bar_; }

  static Vector across(double xi);        ///< X at ξ
  static Vector along(double xi);         ///< U at ξ
  static Vector across_slope(double xi);  ///< dX / dξ
  static Vector turning(double xi);       ///< Θ at ξ

  Matrix mass() const;  ///< ∫ ρA (X'X + U'U) + ρI Θ'Θ dx

  double elastic_energy(const Values<double>& p) const;

  Matrix stiffness(const Values<double>& p) const;  ///< derivative of the elastic forces

  /// Adds ∂U/∂p.
  template <typename Value>
  void add_elastic_force(const Values<Value>& p, Values<Value>& force) const {
    for (const GaussPoint& g : gauss_) {
      const Strains<Value> s = strains(g, p);
      add_force<Value>(g, s, stretching_ * s.stretch, shearing_ * s.shear, bending_ * s.bend,
                       force);
    }
  }

  /// Adds what the material's damping resists with.
  template <typename Value>
  void add_damping_force(double retardation, const Values<Value>& p, const Values<Value>& rates,
                         Values<Value>& force) const {
    for (const GaussPoint& g : gauss_) {
      const Strains<Value> s = strains(g, p);
      const Value x = slope(g, rates, x0), u = slope(g, rates, u0);
      const Value turn =
          g.first * rates[turn0] + g.second * rates[turn1] + g.middle * rates[turn_b];
      add_force<Value>(
          g, s, retardation * stretching_ * (s.sine * x - s.cosine * u + s.shear * turn),
          retardation * shearing_ * (s.cosine * x + s.sine * u - (1.0 + s.stretch) * turn),
          retardation * bending_ * bend(g, rates), force);
    }
  }

 private:
  struct GaussPoint {
    double first, second, middle;  // shares of Θ_0, Θ_1 and Θ_b, X_a, U_a
    double by_middle, by_cubic;    // the latter's, and those of X_c and U_c, in d/dξ
    double weight;
  };

  template <typename Value>
  struct Strains {
    Value sine, cosine;  // of Θ
    Value stretch, shear, bend;
  };

  /// The half angle keeps the digits of 1 − cos Θ.
  template <typename Value>
  Strains<Value> strains(const GaussPoint& g, const Values<Value>& p) const {
    const Value half = 0.5 * (g.first * p[turn0] + g.second * p[turn1] + g.middle * p[turn_b]);
    const Value half_sine = sine(half), half_cosine = cosine(half);
    const Value x = slope(g, p, x0), u = slope(g, p, u0);
    const Value less = 2.0 * half_sine * half_sine;
    Strains<Value> s;
    s.sine = 2.0 * half_sine * half_cosine;
    s.cosine = 1.0 - less;
    s.stretch = x * s.sine - u * s.cosine - less;
    s.shear = x * s.cosine + u * s.sine - s.sine;
    s.bend = bend(g, p);
    return s;
  }

  /// X' (first: x0) or U' (u0).
  template <typename Value>
  Value slope(const GaussPoint& g, const Values<Value>& p, std::size_t first) const {
    return over_length_ *
           (p[first + x1] - p[first] + g.by_middle * p[first + xa] + g.by_cubic * p[first + xc]);
  }

  template <typename Value>
  Value bend(const GaussPoint& g, const Values<Value>& p) const {
    return over_length_ * (p[turn1] - p[turn0] + g.by_middle * p[turn_b]);
  }

  template <typename Value>
  void add_force(const GaussPoint& g, const Strains<Value>& s, const Value& tension,
                 const Value& shear_force, const Value& moment, Values<Value>& force) const {
    const auto pull = [&](std::size_t first, const Value& end) {
      force[first] -= end;
      force[first + x1] += end;
      force[first + xa] += g.by_middle * end;
      force[first + xc] += g.by_cubic * end;
    };
    pull(x0, g.weight * (tension * s.sine + shear_force * s.cosine));
    pull(u0, g.weight * (shear_force * s.sine - tension * s.cosine));
    const Value turn =
        (g.weight * bar_.length) * (tension * s.shear - shear_force * (1.0 + s.stretch));
    const Value bent = g.weight * moment;
    force[turn0] += g.first * turn - bent;
    force[turn1] += g.second * turn + bent;
    force[turn_b] += g.middle * turn + g.by_middle * bent;
  }

  static double sine(double angle) { return std::sin(angle); }

  static double cosine(double angle) { return std::cos(angle); }

  template <typename Lanes>
  static Lanes sine(const Lanes& angle) {
    return angle.sin();
  }

  template <typename Lanes>
  static Lanes cosine(const Lanes& angle) {
    return angle.cos();
  }

  BarElement bar_;
  double over_length_, stretching_, shearing_, bending_;  // 1 / l, EA, κGA, EI
  std::array<GaussPoint, 3> gauss_;
};

}  // namespace impactrig::models
