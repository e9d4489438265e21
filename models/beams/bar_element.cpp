// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/bar_element.hpp"

#include "models/integration/gauss.hpp"

namespace impactrig::models {

double BarElement::shear_share() const {
  return 12.0 * bending_stiffness * shear_compliance / (length * length);
}

BarElement::Shape BarElement::deflection(double xi) const {
  const double phi = shear_share();
  const double s = xi * xi;
  const double c = s * xi;
  const double over = 1.0 / (1.0 + phi);
  Shape shape;
  shape << over * (2.0 * c - 3.0 * s - phi * xi + 1.0 + phi),
      over * length * (c - (2.0 + 0.5 * phi) * s + (1.0 + 0.5 * phi) * xi),
      over * (-2.0 * c + 3.0 * s + phi * xi),
      over * length * (c - (1.0 - 0.5 * phi) * s - 0.5 * phi * xi), 0.0, 0.0;
  if (shears()) shape.tail<2>() << 4.0 * (xi - s), length * (2.0 * s - (4.0 * c + 2.0 * xi) / 3.0);
  return shape;
}

BarElement::Shape BarElement::slope(double xi) const {
  const double phi = shear_share();
  const double s = xi * xi;
  const double over = 1.0 / (1.0 + phi);
  const double chord = over * (6.0 * (xi - s) + phi) / length;
  Shape shape;
  shape << -chord, over * (3.0 * s - (4.0 + phi) * xi + 1.0 + 0.5 * phi), chord,
      over * (3.0 * s - (2.0 - phi) * xi - 0.5 * phi), 0.0, 0.0;
  if (shears()) shape.tail<2>() << (4.0 - 8.0 * xi) / length, 4.0 * (xi - s) - 2.0 / 3.0;
  return shape;
}

BarElement::Shape BarElement::rotation(double xi) const {
  const double phi = shear_share();
  const double s = xi * xi;
  const double over = 1.0 / (1.0 + phi);
  const double chord = over * 6.0 * (xi - s) / length;
  Shape shape;
  shape << -chord, over * (3.0 * s - (4.0 + phi) * xi + 1.0 + phi), chord,
      over * (3.0 * s - (2.0 - phi) * xi), 0.0, 0.0;
  if (shears()) shape[5] = 4.0 * (xi - s);
  return shape;
}

BarElement::Matrix BarElement::mass() const {
  const GaussRule& rule = gauss_legendre(4);  // the product of two cubics
  Matrix sum = Matrix::Zero();
  for (std::size_t g = 0; g < rule.points.size(); ++g) {
    const double weight = rule.weights[g] * length;
    const Shape w = deflection(rule.points[g]);
    sum += weight * line_density * w * w.transpose();
    if (rotary_inertia == 0.0) continue;
    const Shape theta = rotation(rule.points[g]);
    sum += weight * rotary_inertia * theta * theta.transpose();
  }
  return sum;
}

BarElement::Matrix BarElement::stiffness() const {
  const double phi = shear_share();
  const double l = length;
  const double near = (4.0 + phi) * l * l;
  const double far = (2.0 - phi) * l * l;
  Eigen::Matrix4d nodes;
  nodes << 12.0, 6.0 * l, -12.0, 6.0 * l,  //
      6.0 * l, near, -6.0 * l, far,        //
      -12.0, -6.0 * l, 12.0, -6.0 * l,     //
      6.0 * l, far, -6.0 * l, near;
  Matrix k = Matrix::Zero();
  k.topLeftCorner<4, 4>() = nodes * (bending_stiffness / (l * l * l * (1.0 + phi)));
  if (!shears()) return k;
  k(4, 4) = 16.0 / (3.0 * l * shear_compliance);
  k(5, 5) = 16.0 * bending_stiffness / (3.0 * l) + 4.0 * l / (9.0 * shear_compliance);
  return k;
}

std::vector<BarElement> bar_pieces(const Beam& beam) {
  BarElement piece{.length = beam.length,
                   .axial_stiffness = beam.youngs_modulus * beam.area,
                   .bending_stiffness = beam.youngs_modulus * beam.second_moment,
                   .line_density = beam.density * beam.area};
  if (beam.shears()) {
    const double shear_modulus = beam.youngs_modulus / (2.0 * (1.0 + beam.poisson_ratio));
    piece.shear_compliance = 1.0 / (beam.shear_coefficient * shear_modulus * beam.area);
    piece.rotary_inertia = beam.density * beam.second_moment;
  }
  return {piece};
}

std::vector<BarElement> bar_elements(const Beam& beam, double struck, std::array<int, 2> elements) {
  BarElement element = bar_pieces(beam).front();
  std::vector<BarElement> bar;
  const std::array<double, 2> parts = {struck, beam.length - struck};
  double x = 0.0;
  for (std::size_t part = 0; part < 2; ++part)
    for (int i = 0; i < elements[part]; ++i) {
      element.x = x;
      element.length = parts[part] / elements[part];
      bar.push_back(element);
      x += element.length;
    }
  return bar;
}

std::size_t element_at(const std::vector<BarElement>& elements, double x) {
  std::size_t e = 0;
  while (e + 1 < elements.size() && x > elements[e + 1].x) ++e;
  return e;
}

}  // namespace impactrig::models
