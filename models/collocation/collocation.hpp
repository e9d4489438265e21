// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <mutex>

namespace impactrig::models {

inline constexpr int most_nodes = 16;

using NodeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_nodes, 1>;
using NodeMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_nodes, most_nodes>;

/// Shifted Legendre polynomials P_0(x) ... P_{n-1}(x), P_p(1) = 1, of x in [0, 1].
void shifted_legendre(double x, Eigen::Ref<Eigen::VectorXd> values);

/// Σ c_p P_p(x), by Clenshaw's recurrence.
double legendre_sum(const NodeVector& series, double x);

/// ∫₀ˣ P_p for p = 0 ... n-1.
void shifted_legendre_integrals(double x, Eigen::Ref<Eigen::VectorXd> values);

/// What collocation at the s nodes of a step needs and what does not depend on the step. A function
/// over the step, σ in [0, 1], is given by its values at the nodes or by the coefficients of its
/// Legendre series of s terms.
class Collocation {
 public:
  enum class Nodes {
    gauss,  ///< inside the step, order 2s
    radau   ///< the last at the step's end, order 2s − 1: stiff vibration dies instead of ringing
  };

  /// The rule of s nodes, 1 <= s <= most_nodes; one object a process.
  static const Collocation& of(int nodes, Nodes kind = Nodes::gauss);

  Collocation(int nodes, Nodes kind);

  int nodes() const { return static_cast<int>(points_.size()); }

  const NodeVector& points() const { return points_; }  ///< in (0, 1], rising

  const NodeVector& weights() const { return weights_; }  ///< of ∫₀¹

  /// Coefficients of values at the nodes: c = to_series() f (s, s).
  const NodeMatrix& to_series() const { return to_series_; }

  /// Rate of a series, d/dσ, at σ = 0, the nodes and 1: rates() c (s + 2, s).
  const Eigen::MatrixXd& rates() const { return rates_; }

  /// Integrals from 0 to the nodes of values at the nodes (s, s): the Runge-Kutta matrix.
  NodeMatrix integration() const;

  /// Coefficients, over the part [0, θ], of a series over [0, 1].
  NodeVector restricted(const NodeVector& series, double theta) const;

  /// Values of a series over [0, 1] at the nodes of its part [begin, end].
  NodeVector values_between(const NodeVector& series, double begin, double end) const;

  /// Convolution of Legendre polynomials with Lagrange's at the nodes:
  /// column n, row i + s j: ∫₀^{c_i} P_n(c_i − σ) ℓ_j(σ) dσ, for n < 32 (block + 1).
  const Eigen::MatrixXd& convolutions(int block) const;

  static constexpr int block_size = 32;
  static constexpr int blocks = 8;

 private:
  Eigen::MatrixXd make_convolutions(int block) const;

  NodeVector points_, weights_;
  NodeMatrix to_series_;
  Eigen::MatrixXd rates_;
  mutable std::array<std::once_flag, blocks> once_;
  mutable std::array<Eigen::MatrixXd, blocks> convolutions_;
};

/// What a Legendre series of at least four terms leaves out, by its last pair: less where the pairs
/// before fall towards it, which neither a corner nearby nor vibration on a large smooth part lets
/// them.
double truncation(const NodeVector& series);

}  // namespace impactrig::models
