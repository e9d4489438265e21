// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/collocation.hpp"

#include <stdexcept>

#include "models/integration/gauss.hpp"

namespace impactrig::models {

void shifted_legendre(double x, Eigen::Ref<Eigen::VectorXd> values) {
  const double t = 2.0 * x - 1.0;
  const Eigen::Index n = values.size();
  if (n > 0) values[0] = 1.0;
  if (n > 1) values[1] = t;
  for (Eigen::Index p = 2; p < n; ++p) {
    const auto order = static_cast<double>(p);
    values[p] = ((2.0 * order - 1.0) * t * values[p - 1] - (order - 1.0) * values[p - 2]) / order;
  }
}

const Collocation& Collocation::of(int nodes) {
  static std::array<std::once_flag, most_nodes + 1> once;
  static std::array<std::unique_ptr<const Collocation>, most_nodes + 1> rules;
  if (nodes < 1 || nodes > most_nodes)
    throw std::invalid_argument("Collocation: number of nodes out of range");
  const auto k = static_cast<std::size_t>(nodes);
  std::call_once(once[k], [&] { rules[k] = std::make_unique<const Collocation>(nodes); });
  return *rules[k];
}

Collocation::Collocation(int nodes)
    : points_(nodes),
      weights_(nodes),
      to_series_(nodes, nodes),
      rates_(Eigen::MatrixXd::Zero(nodes + 2, nodes)) {
  const GaussRule& rule = gauss_legendre(nodes);
  Eigen::VectorXd legendre(nodes);
  for (int i = 0; i < nodes; ++i) {
    points_[i] = rule.points[static_cast<std::size_t>(i)];
    weights_[i] = rule.weights[static_cast<std::size_t>(i)];
    shifted_legendre(points_[i], legendre);
    for (int p = 0; p < nodes; ++p) to_series_(p, i) = (2.0 * p + 1.0) * weights_[i] * legendre[p];
  }
  for (int i = 0; i < nodes + 2; ++i) {
    const double x = i == 0 ? 0.0 : i > nodes ? 1.0 : points_[i - 1];
    shifted_legendre(x, legendre);
    // P'_p = P'_{p-2} + 2 (2p − 1) P_{p-1}
    for (int p = 1; p < nodes; ++p)
      rates_(i, p) = (p > 1 ? rates_(i, p - 2) : 0.0) + 2.0 * (2.0 * p - 1.0) * legendre[p - 1];
  }
}

NodeMatrix Collocation::restriction(double theta) const {
  const int s = nodes();
  NodeMatrix values(s, s);  // of the whole step's polynomials at the part's nodes
  NodeVector legendre(s);
  for (int i = 0; i < s; ++i) {
    shifted_legendre(theta * points_[i], legendre);
    values.row(i) = legendre.transpose();
  }
  return to_series_ * values;
}

const Eigen::MatrixXd& Collocation::convolutions(int block) const {
  const auto k = static_cast<std::size_t>(block);
  std::call_once(once_.at(k), [&] { convolutions_[k] = make_convolutions(block); });
  return convolutions_[k];
}

Eigen::MatrixXd Collocation::make_convolutions(int block) const {
  const int s = nodes();
  const int most = block_size * (block + 1);
  const GaussRule& rule = gauss_legendre((most + s) / 2 + 1);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(s * s, block_size);
  Eigen::VectorXd kernel(most), series(s);
  for (int i = 0; i < s; ++i)
    for (std::size_t q = 0; q < rule.points.size(); ++q) {
      const double sigma = points_[i] * rule.points[q];
      shifted_legendre(points_[i] - sigma, kernel);
      shifted_legendre(sigma, series);
      const NodeVector lagrange = to_series_.transpose() * series;  // ℓ_j(σ)
      for (int j = 0; j < s; ++j)
        result.row(i + s * j) +=
            points_[i] * rule.weights[q] * lagrange[j] * kernel.tail(block_size).transpose();
    }
  return result;
}

}  // namespace impactrig::models
