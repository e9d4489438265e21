// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/reissner_element.hpp"

#include <stdexcept>

#include "models/integration/gauss.hpp"

namespace impactrig::models {

ReissnerElement::ReissnerElement(const BarElement& bar)
    : bar_(bar),
      over_length_(1.0 / bar.length),
      stretching_(bar.axial_stiffness),
      shearing_(1.0 / bar.shear_compliance),
      bending_(bar.bending_stiffness) {
  if (!bar.shears()) throw std::invalid_argument("ReissnerElement: the bar does not shear");
  const GaussRule& rule = gauss_legendre(3);
  for (std::size_t g = 0; g < 3; ++g) {
    const double xi = rule.points[g];
    const double s = xi - xi * xi;
    gauss_[g] = {.first = 1.0 - xi,
                 .second = xi,
                 .middle = 4.0 * s,
                 .by_middle = 4.0 - 8.0 * xi,
                 .by_cubic = 1.0 - 6.0 * s,
                 .weight = rule.weights[g]};
  }
}

ReissnerElement::Vector ReissnerElement::across(double xi) {
  Vector shape = Vector::Zero();
  const double s = xi - xi * xi;
  shape[x0] = 1.0 - xi;
  shape[x1] = xi;
  shape[xa] = 4.0 * s;
  shape[xc] = s * (1.0 - 2.0 * xi);
  return shape;
}

ReissnerElement::Vector ReissnerElement::across_slope(double xi) {
  Vector shape = Vector::Zero();
  shape[x0] = -1.0;
  shape[x1] = 1.0;
  shape[xa] = 4.0 - 8.0 * xi;
  shape[xc] = 1.0 - 6.0 * (xi - xi * xi);
  return shape;
}

ReissnerElement::Vector ReissnerElement::along(double xi) {
  const Vector x = across(xi);
  Vector shape = Vector::Zero();
  for (const std::size_t place : {x0, x1, xa, xc}) shape[place + u0] = x[place];
  return shape;
}

ReissnerElement::Vector ReissnerElement::turning(double xi) {
  Vector shape = Vector::Zero();
  shape[turn0] = 1.0 - xi;
  shape[turn1] = xi;
  shape[turn_b] = 4.0 * (xi - xi * xi);
  return shape;
}

ReissnerElement::Matrix ReissnerElement::mass() const {
  const GaussRule& rule = gauss_legendre(4);  // the product of two cubics
  Matrix sum = Matrix::Zero();
  for (std::size_t g = 0; g < rule.points.size(); ++g) {
    const double xi = rule.points[g];
    const Vector x = across(xi), u = along(xi), turn = turning(xi);
    sum += rule.weights[g] * bar_.length *
           (bar_.line_density * (x * x.transpose() + u * u.transpose()) +
            bar_.rotary_inertia * turn * turn.transpose());
  }
  return sum;
}

double ReissnerElement::elastic_energy(const Values<double>& p) const {
  double energy = 0.0;
  for (const GaussPoint& g : gauss_) {
    const Strains<double> s = strains(g, p);
    energy += 0.5 * g.weight * bar_.length *
              (stretching_ * s.stretch * s.stretch + shearing_ * s.shear * s.shear +
               bending_ * s.bend * s.bend);
  }
  return energy;
}

ReissnerElement::Matrix ReissnerElement::stiffness(const Values<double>& p) const {
  using Local = Eigen::Matrix4d;  // of X', U', Θ, Θ'
  Matrix sum = Matrix::Zero();
  for (const GaussPoint& g : gauss_) {
    const Strains<double> s = strains(g, p);
    const Eigen::Vector4d stretch(s.sine, -s.cosine, s.shear, 0.0);
    const Eigen::Vector4d shear(s.cosine, s.sine, -1.0 - s.stretch, 0.0);
    const double tension = stretching_ * s.stretch, shear_force = shearing_ * s.shear;
    Local local =
        stretching_ * stretch * stretch.transpose() + shearing_ * shear * shear.transpose();
    local(3, 3) = bending_;
    local(0, 2) += tension * s.cosine - shear_force * s.sine;
    local(1, 2) += tension * s.sine + shear_force * s.cosine;
    local(2, 2) -= tension * (1.0 + s.stretch) + shear_force * s.shear;
    local(2, 0) = local(0, 2);
    local(2, 1) = local(1, 2);
    Eigen::Matrix<double, 4, values> to_local = Eigen::Matrix<double, 4, values>::Zero();
    for (const int row : {0, 1}) {
      const auto first = static_cast<std::size_t>(row);
      to_local(row, first + x0) = -over_length_;
      to_local(row, first + x1) = over_length_;
      to_local(row, first + xa) = over_length_ * g.by_middle;
      to_local(row, first + xc) = over_length_ * g.by_cubic;
    }
    to_local(2, turn0) = g.first;
    to_local(2, turn1) = g.second;
    to_local(2, turn_b) = g.middle;
    to_local(3, turn0) = -over_length_;
    to_local(3, turn1) = over_length_;
    to_local(3, turn_b) = over_length_ * g.by_middle;
    sum += g.weight * bar_.length * to_local.transpose() * local * to_local;
  }
  return sum;
}

}  // namespace impactrig::models
