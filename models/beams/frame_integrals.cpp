// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/frame_integrals.hpp"

#include <utility>

#include "models/collocation/collocation.hpp"
#include "models/integration/gauss.hpp"
#include "models/lanes/product_lanes.hpp"

namespace impactrig::models {
namespace {

/// Integrals over a part of [0, 1] of Lagrange's polynomials at Gauss points: by their Legendre
/// series, of which those points give every coefficient exactly.
class LagrangeIntegrals {
 public:
  explicit LagrangeIntegrals(int points) : series_(points, points), integrals_(points) {
    const GaussRule& rule = gauss_legendre(points);
    Eigen::VectorXd legendre(points);
    for (int j = 0; j < points; ++j) {
      const auto place = static_cast<std::size_t>(j);
      shifted_legendre(rule.points[place], legendre);
      for (int k = 0; k < points; ++k)
        series_(k, j) = (2.0 * k + 1.0) * rule.weights[place] * legendre[k];
    }
  }

  /// ∫₀ʸ ℓ_j of all.
  Eigen::RowVectorXd to(double y) {
    shifted_legendre_integrals(y, integrals_);
    return integrals_.transpose() * series_;
  }

 private:
  Eigen::MatrixXd series_;
  Eigen::VectorXd integrals_;
};

std::vector<Eigen::Index> stations_in(const FramePart& part, bool last,
                                      const FrameStations& stations) {
  std::vector<Eigen::Index> inside;
  for (Eigen::Index i = 0; i < stations.size; ++i)
    if (stations.x[i] >= part.x && (last || stations.x[i] < part.x + part.length))
      inside.push_back(i);
  return inside;
}

}  // namespace

Eigen::VectorXd gauss_points(const std::vector<FramePart>& parts, int points) {
  const GaussRule& rule = gauss_legendre(points);
  Eigen::VectorXd places(static_cast<Eigen::Index>(parts.size()) * points);
  Eigen::Index i = 0;
  for (const FramePart& part : parts)
    for (const double point : rule.points) places[i++] = part.x + part.length * point;
  return places;
}

FrameIntegrals::FrameIntegrals(const FrameStations& stations, const std::vector<FramePart>& parts,
                               int points, Eigen::MatrixXd slopes_there)
    : places(stations.x),
      masses(stations.mass),
      deflections(stations.bending),
      of_deflections(deflections.transpose()),
      moment(stations.mass.dot(stations.x)),
      inertia(stations.mass.dot(stations.x.cwiseAbs2())),
      axial(stations.axial.transpose() * stations.mass),
      axial_moment(stations.axial.transpose() * stations.mass.cwiseProduct(stations.x)),
      bending(stations.bending.transpose() * stations.mass),
      bending_moment(stations.bending.transpose() * stations.mass.cwiseProduct(stations.x)),
      axial_axial(stations.axial.transpose() * stations.mass.asDiagonal() * stations.axial),
      axial_bending(stations.axial.transpose() * stations.mass.asDiagonal() * stations.bending),
      bending_bending(stations.bending.transpose() * stations.mass.asDiagonal() * stations.bending),
      slopes(std::move(slopes_there)),
      of_slopes(slopes.transpose()),
      run(slopes.rows()),
      run_moment(slopes.rows()),
      run_axial(slopes.rows(), stations.axial.cols()),
      run_bending(slopes.rows(), stations.bending.cols()) {
  if (slopes.cols() == 0) return;
  LagrangeIntegrals lagrange(points);
  const Eigen::VectorXd unit_width = lagrange.to(1.0);
  std::vector<RunningProduct::Part> products(parts.size());
  // sums over the stations beyond the part
  double mass_beyond = 0.0, moment_beyond = 0.0;
  Eigen::RowVectorXd axial_beyond = Eigen::RowVectorXd::Zero(run_axial.cols());
  Eigen::RowVectorXd bending_beyond = Eigen::RowVectorXd::Zero(run_bending.cols());
  for (std::size_t e = parts.size(); e-- > 0;) {
    const std::vector<Eigen::Index> inside = stations_in(parts[e], e + 1 == parts.size(), stations);
    const Eigen::VectorXd m = stations.mass(inside);
    const Eigen::VectorXd moments = m.cwiseProduct(stations.x(inside));
    const Eigen::MatrixXd axial_by_mass = m.asDiagonal() * stations.axial(inside, Eigen::all);
    const Eigen::MatrixXd bending_by_mass = m.asDiagonal() * stations.bending(inside, Eigen::all);
    Eigen::MatrixXd to(points, m.size());  // each station, from where the part begins
    for (Eigen::Index i = 0; i < m.size(); ++i)
      to.col(i) = parts[e].length *
                  lagrange.to((stations.x[inside[static_cast<std::size_t>(i)]] - parts[e].x) /
                              parts[e].length);
    const Eigen::Index first = static_cast<Eigen::Index>(e) * points;
    const Eigen::VectorXd width = parts[e].length * unit_width;
    products[e] = {
        .within = to * m.asDiagonal() * to.transpose() + mass_beyond * width * width.transpose(),
        .width = width,
        .beyond = to * m + mass_beyond * width};
    run.segment(first, points) = products[e].beyond;
    run_moment.segment(first, points) = to * moments + moment_beyond * width;
    run_axial.middleRows(first, points) = to * axial_by_mass + width * axial_beyond;
    run_bending.middleRows(first, points) = to * bending_by_mass + width * bending_beyond;
    mass_beyond += m.sum();
    moment_beyond += moments.sum();
    axial_beyond += axial_by_mass.colwise().sum();
    bending_beyond += bending_by_mass.colwise().sum();
  }
  bending_run = run_bending.transpose();
  run_run = RunningProduct(std::move(products));
}

void RunningProduct::multiply(const Eigen::Ref<const Eigen::MatrixXd>& g,
                              Eigen::Ref<Eigen::MatrixXd> to) const {
  if (parts_.empty()) return;
  const Eigen::Index points = parts_.front().width.size();
  const auto at = [points](std::size_t e) { return static_cast<Eigen::Index>(e) * points; };
  for (std::size_t e = 0; e < parts_.size(); ++e)
    set_product(parts_[e].within, g.middleRows(at(e), points), to.middleRows(at(e), points));
  for (Eigen::Index column = 0; parts_.size() > 1 && column < g.cols(); ++column) {
    double before = 0.0;  // ∫ g to where the part begins
    for (std::size_t e = 0; e < parts_.size(); ++e) {
      to.col(column).segment(at(e), points) += before * parts_[e].beyond;
      before += parts_[e].width.dot(g.col(column).segment(at(e), points));
    }
    double after = 0.0;  // ∫ g (mass beyond) from where it ends
    for (std::size_t e = parts_.size(); e-- > 0;) {
      to.col(column).segment(at(e), points) += after * parts_[e].width;
      after += parts_[e].beyond.dot(g.col(column).segment(at(e), points));
    }
  }
}

}  // namespace impactrig::models
