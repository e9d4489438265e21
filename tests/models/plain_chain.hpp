// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "models/rig.hpp"

namespace impactrig::tests {

/// The chain of cubic elements once more, from positions: r(x), r' and r'' by Hermite
/// interpolation, energies by a fine quadrature of their densities.
class PlainChain {
 public:
  PlainChain(const models::Rig& rig, std::array<int, 2> elements) : rig_(rig) {
    nodes_.push_back(0.0);
    for (int i = 1; i <= elements[0]; ++i) nodes_.push_back(rig.contact.position * i / elements[0]);
    for (int i = 1; i <= elements[1]; ++i)
      nodes_.push_back(rig.contact.position +
                       (rig.beam.length - rig.contact.position) * i / elements[1]);
  }

  int dofs() const { return 2 * static_cast<int>(nodes_.size()) - 1; }

  /// Value, first and second derivative at a place inside an element of one direction's field.
  std::array<double, 3> field(const Eigen::VectorXd& part, std::size_t e, double xi) const {
    const double l = nodes_[e + 1] - nodes_[e];
    const int first = 2 * static_cast<int>(e) - 1;
    const double u0 = e == 0 ? 0.0 : part[first];
    const double s0 = part[first + 1];
    const double u1 = part[first + 2];
    const double s1 = part[first + 3];
    // the cubic c0 + c1 ξ + c2 ξ² + c3 ξ³
    const double c1 = l * s0;
    const double c2 = 3.0 * (u1 - u0) - l * (2.0 * s0 + s1);
    const double c3 = 2.0 * (u0 - u1) + l * (s0 + s1);
    return {u0 + xi * (c1 + xi * (c2 + xi * c3)), (c1 + xi * (2.0 * c2 + 3.0 * xi * c3)) / l,
            (2.0 * c2 + 6.0 * c3 * xi) / (l * l)};
  }

  template <typename Density>
  double integral(const Density& density) const {
    // eight points a element: exact up to degree 15
    static constexpr double points[4] = {0.183434642495649805, 0.525532409916328986,
                                         0.796666477413626740, 0.960289856497536232};
    static constexpr double weights[4] = {0.362683783378361983, 0.313706645877887287,
                                          0.222381034453374471, 0.101228536290376259};
    double sum = 0.0;
    for (std::size_t e = 0; e + 1 < nodes_.size(); ++e)
      for (int g = 0; g < 4; ++g)
        for (double side : {-1.0, 1.0})
          sum += 0.5 * (nodes_[e + 1] - nodes_[e]) * weights[g] *
                 density(e, 0.5 * (1.0 + side * points[g]));
    return sum;
  }

  double x(std::size_t e, double xi) const { return nodes_[e] + (nodes_[e + 1] - nodes_[e]) * xi; }

  double kinetic(const Eigen::VectorXd& v) const {
    const Eigen::VectorXd across = v.head(dofs()), along = v.tail(dofs());
    const auto square = [&](std::size_t e, double xi) {
      return std::pow(field(across, e, xi)[0], 2) + std::pow(field(along, e, xi)[0], 2);
    };
    return 0.5 * (line_density() * integral(square) + lumped(square));
  }

  double elastic(const Eigen::VectorXd& q) const {
    const Eigen::VectorXd across = q.head(dofs()), along = q.tail(dofs());
    return integral([&](std::size_t e, double xi) {
      const auto X = field(across, e, xi);
      const auto U = field(along, e, xi);
      const double strain = 0.5 * (X[1] * X[1] + std::pow(U[1] - 1.0, 2) - 1.0);
      return 0.5 * rig_.beam.youngs_modulus *
             (rig_.beam.area * strain * strain +
              rig_.beam.second_moment * (X[2] * X[2] + U[2] * U[2]));
    });
  }

  double gravitational(const Eigen::VectorXd& q) const {
    const Eigen::VectorXd along = q.tail(dofs());
    const Eigen::VectorXd across = q.head(dofs());
    const double sine = std::sin(rig_.gravity_direction), cosine = std::cos(rig_.gravity_direction);
    const auto lift = [&](std::size_t e, double xi) {
      return cosine * field(along, e, xi)[0] + sine * field(across, e, xi)[0];
    };
    return rig_.gravity * (line_density() * integral(lift) + lumped(lift));
  }

  /// Of a density a mass, over the lumped ones.
  template <typename Density>
  double lumped(const Density& density) const {
    double sum = 0.0;
    for (const models::LumpedMass& lump : rig_.beam.masses) {
      std::size_t e = 0;
      while (e + 2 < nodes_.size() && nodes_[e + 1] < lump.position) ++e;
      sum += lump.mass * density(e, (lump.position - nodes_[e]) / (nodes_[e + 1] - nodes_[e]));
    }
    return sum;
  }

 private:
  double line_density() const { return rig_.beam.density * rig_.beam.area; }

  models::Rig rig_;
  std::vector<double> nodes_;
};

}  // namespace impactrig::tests
