// SPDX-License-Identifier: BSD-3-Clause
#include "models/collocation/collocation.hpp"

#include <cmath>
#include <stdexcept>

#include "models/integration/gauss.hpp"
#include "models/lanes/clenshaw.hpp"
#include "models/lanes/mode_lanes.hpp"

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

double legendre_sum(const NodeVector& series, double x) {
  static_assert(most_nodes <= ClenshawFactors::most);
  const double t = 2.0 * x - 1.0;
  double here = 0.0, above = 0.0;
  for (Eigen::Index p = series.size() - 1; p >= 0; --p) {
    const double below = series[p] + clenshaw.forward[p] * t * here - clenshaw.back[p] * above;
    above = here;
    here = below;
  }
  return here;
}

void shifted_legendre_integrals(double x, Eigen::Ref<Eigen::VectorXd> values) {
  const Eigen::Index n = values.size();
  const double t = 2.0 * x - 1.0;
  double before = 1.0;  // P_{p-1}, taken as P_0 for p = 0
  double here = 1.0;    // P_p
  for (Eigen::Index p = 0; p < n; ++p) {
    const auto order = static_cast<double>(p);
    const double next = ((2.0 * order + 1.0) * t * here - order * before) / (order + 1.0);
    values[p] = p == 0 ? x : (next - before) / (2.0 * (2.0 * order + 1.0));
    before = here;
    here = next;
  }
}

namespace {

/// Points and weights of ∫₀¹ with the last point at 1: zeros of P_s − P_{s-1} between those of
/// P_{s-1}. [HairerWanner1996, IV.5]
GaussRule radau_rule(int s) {
  const auto count = static_cast<std::size_t>(s);
  GaussRule rule{std::vector<double>(count, 1.0), std::vector<double>(count)};
  Eigen::VectorXd legendre(s + 1);
  const auto value = [&](double x) {
    shifted_legendre(x, legendre);
    return legendre[s] - legendre[s - 1];
  };
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const GaussRule& between = gauss_legendre(s - 1);
    double low = i == 0 ? 0.0 : between.points[i - 1];
    double high = between.points[i];
    const double at_low = value(low);
    while (high - low > 1e-16) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      (value(middle) * at_low > 0.0 ? low : high) = middle;
    }
    rule.points[i] = 0.5 * (low + high);
  }
  for (std::size_t i = 0; i < count; ++i) {
    shifted_legendre(rule.points[i], legendre);
    rule.weights[i] = rule.points[i] / (s * s * legendre[s - 1] * legendre[s - 1]);
  }
  return rule;
}

}  // namespace

const Collocation& Collocation::of(int nodes, Nodes kind) {
  struct Rule {
    std::once_flag once;
    std::unique_ptr<const Collocation> collocation;
  };

  static std::array<std::array<Rule, most_nodes + 1>, 2> rules;
  if (nodes < 1 || nodes > most_nodes)
    throw std::invalid_argument("Collocation: number of nodes out of range");
  Rule& rule = rules[kind == Nodes::gauss ? 0 : 1][static_cast<std::size_t>(nodes)];
  std::call_once(rule.once,
                 [&] { rule.collocation = std::make_unique<const Collocation>(nodes, kind); });
  return *rule.collocation;
}

Collocation::Collocation(int nodes, Nodes kind)
    : points_(nodes),
      weights_(nodes),
      to_series_(nodes, nodes),
      rates_(Eigen::MatrixXd::Zero(nodes + 2, nodes)) {
  const GaussRule rule = kind == Nodes::gauss ? gauss_legendre(nodes) : radau_rule(nodes);
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

NodeMatrix Collocation::integration() const {
  const int s = nodes();
  NodeMatrix integrals(s, s);  // of the polynomials to the nodes
  Eigen::VectorXd row(s);
  for (int i = 0; i < s; ++i) {
    shifted_legendre_integrals(points_[i], row);
    integrals.row(i) = row.transpose();
  }
  return integrals * to_series_;
}

NodeVector Collocation::values_between(const NodeVector& series, double begin, double end) const {
  NodeVector values(nodes());
  find_values({.terms = static_cast<int>(series.size()),
               .nodes = nodes(),
               .series = series.data(),
               .points = points_.data(),
               .begin = begin,
               .length = end - begin,
               .values = values.data()});
  return values;
}

NodeVector Collocation::restricted(const NodeVector& series, double theta) const {
  return to_series_ * values_between(series, 0.0, theta);
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

double truncation(const NodeVector& series) {
  const Eigen::Index s = series.size();
  const double last = series.tail<2>().norm();
  if (last == 0.0) return 0.0;
  const double between = series.segment<2>(s - 3).norm();
  const double before = series.segment<2>(s - 4).norm();
  return std::min(1.0, std::max(3.0 * last / before, std::pow(last / between, 2))) * last;
}

}  // namespace impactrig::models
