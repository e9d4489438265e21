// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/bar_element.hpp"

#include <algorithm>
#include <cmath>

#include "models/integration/gauss.hpp"

namespace impactrig::models {
namespace {

// Of a side, and of the bar: the struck point may be at a step, or at the tip, to the rounding of
// both.
constexpr double smallest_part = 1e-9, rounding = 1e-14;

}  // namespace

double BarElement::shear_share() const {
  return 12.0 * bending_stiffness * shear_compliance / (length * length);
}

double BarElement::wave_number() const {
  return std::pow(line_density / bending_stiffness, 0.25);
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
      over * length * (c - (1.0 - 0.5 * phi) * s - 0.5 * phi * xi), 0.0, 0.0, 0.0;
  if (shears())
    shape.tail<inside>() << 4.0 * (xi - s), length * (2.0 * s - (4.0 * c + 2.0 * xi) / 3.0),
        xi - 3.0 * s + 2.0 * c;
  return shape;
}

BarElement::Shape BarElement::slope(double xi) const {
  const double phi = shear_share();
  const double s = xi * xi;
  const double over = 1.0 / (1.0 + phi);
  const double chord = over * (6.0 * (xi - s) + phi) / length;
  Shape shape;
  shape << -chord, over * (3.0 * s - (4.0 + phi) * xi + 1.0 + 0.5 * phi), chord,
      over * (3.0 * s - (2.0 - phi) * xi - 0.5 * phi), 0.0, 0.0, 0.0;
  if (shears())
    shape.tail<inside>() << (4.0 - 8.0 * xi) / length, 4.0 * (xi - s) - 2.0 / 3.0,
        (1.0 - 6.0 * (xi - s)) / length;
  return shape;
}

BarElement::Shape BarElement::rotation(double xi) const {
  const double phi = shear_share();
  const double s = xi * xi;
  const double over = 1.0 / (1.0 + phi);
  const double chord = over * 6.0 * (xi - s) / length;
  Shape shape;
  shape << -chord, over * (3.0 * s - (4.0 + phi) * xi + 1.0 + phi), chord,
      over * (3.0 * s - (2.0 - phi) * xi), 0.0, 0.0, 0.0;
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
  k(6, 6) = 1.0 / (5.0 * l * shear_compliance);
  return k;
}

/// The nodes' are the turn between the sections and what these turn on average against the chord.
Eigen::Matrix<double, BarElement::values - 2, BarElement::values - 2> BarElement::strain() const {
  const double turn = std::sqrt(bending_stiffness / length);
  const double chord = turn * std::sqrt(3.0 / (1.0 + shear_share()));
  Eigen::Matrix<double, values - 2, values - 2> strain;
  strain.setZero();
  strain(0, 1) = turn;
  strain(1, 0) = -2.0 / length * chord;
  strain(1, 1) = chord;
  if (!shears()) return strain;
  strain(2, 2) = std::sqrt(16.0 / (3.0 * length * shear_compliance));
  strain(3, 3) = std::sqrt(16.0 * bending_stiffness / (3.0 * length) +
                           4.0 * length / (9.0 * shear_compliance));
  strain(4, 4) = std::sqrt(1.0 / (5.0 * length * shear_compliance));
  return strain;
}

namespace {

/// The two sides of the struck point, [from, to].
struct Side {
  double from = 0.0, to = 0.0;
};

std::array<Side, 2> sides(const Beam& beam, double struck) {
  return {Side{0.0, struck}, Side{struck, beam.length}};
}

/// What of the bar's pieces lies on one side; nothing shorter than rounding.
std::vector<BarElement> pieces_of(const Beam& beam, const Side& side) {
  std::vector<BarElement> pieces = bar_pieces(beam);
  for (BarElement& piece : pieces) {
    const double from = std::max(piece.x, side.from);
    piece.length = std::min(piece.x + piece.length, side.to) - from;
    piece.x = from;
  }
  std::erase_if(pieces, [&](const BarElement& piece) {
    return !(piece.length > smallest_part * (side.to - side.from)) ||
           !(piece.length > rounding * beam.length);
  });
  return pieces;
}

/// Shares of the elements, at least one a piece, so that a bending wave meets as many everywhere.
std::vector<int> distribute(const std::vector<BarElement>& pieces, int elements) {
  std::vector<int> shares(pieces.size(), 1);
  const auto waves = [&](std::size_t i) {  // in one element
    return pieces[i].length * pieces[i].wave_number() / shares[i];
  };
  for (int left = elements - static_cast<int>(pieces.size()); left > 0; --left) {
    std::size_t coarsest = 0;
    for (std::size_t i = 1; i < pieces.size(); ++i)
      if (waves(i) > waves(coarsest)) coarsest = i;
    ++shares[coarsest];
  }
  return shares;
}

}  // namespace

BarElement bar_piece(const Beam& beam, const BeamSegment& segment, double x) {
  const double modulus = segment.youngs_modulus.value_or(beam.youngs_modulus);
  const double density = segment.density.value_or(beam.density);
  BarElement piece{.x = x,
                   .length = segment.length,
                   .axial_stiffness = modulus * segment.area,
                   .bending_stiffness = modulus * segment.second_moment,
                   .line_density = density * segment.area};
  if (beam.shears()) {
    const double shear_modulus = modulus / (2.0 * (1.0 + beam.poisson_ratio));
    piece.shear_compliance = 1.0 / (segment.shear_coefficient * shear_modulus * segment.area);
    piece.rotary_inertia = density * segment.second_moment;
  }
  return piece;
}

std::vector<BarElement> bar_pieces(const Beam& beam) {
  std::vector<BarElement> pieces;
  for_each_piece(beam, [&](const BarElement& piece) { pieces.push_back(piece); });
  return pieces;
}

std::vector<BarElement> bar_elements(const Beam& beam, double struck, std::array<int, 2> elements) {
  std::vector<BarElement> bar;
  double x = 0.0;
  for (std::size_t side = 0; side < 2; ++side) {
    if (elements[side] == 0) continue;
    const std::vector<BarElement> pieces = pieces_of(beam, sides(beam, struck)[side]);
    const std::vector<int> shares = distribute(pieces, elements[side]);
    for (std::size_t i = 0; i < pieces.size(); ++i)
      for (int k = 0; k < shares[i]; ++k) {
        BarElement element = pieces[i];
        element.x = x;
        element.length = pieces[i].length / shares[i];
        bar.push_back(element);
        x += element.length;
      }
  }
  return bar;
}

std::array<int, 2> fewest_elements(const Beam& beam, double struck) {
  const auto count = [&](const Side& side) {
    return static_cast<int>(pieces_of(beam, side).size());
  };
  const std::array<Side, 2> both = sides(beam, struck);
  return {count(both[0]), count(both[1])};
}

double mass_between(const std::vector<BarElement>& pieces, double from, double to) {
  double mass = 0.0;
  for (const BarElement& piece : pieces)
    mass += piece.line_density *
            std::max(std::min(piece.x + piece.length, to) - std::max(piece.x, from), 0.0);
  return mass;
}

std::size_t element_at(const std::vector<BarElement>& elements, double x) {
  const auto after = std::partition_point(elements.begin() + 1, elements.end(),
                                          [x](const BarElement& each) { return each.x < x; });
  return static_cast<std::size_t>(after - elements.begin()) - 1;
}

}  // namespace impactrig::models
