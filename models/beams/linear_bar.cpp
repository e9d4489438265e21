// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/linear_bar.hpp"

#include <algorithm>
#include <utility>

#include "models/integration/gauss.hpp"

namespace impactrig::models {

LinearBar::LinearBar(const Rig& rig, std::vector<BarElement> elements)
    : elements_(std::move(elements)),
      masses_(rig.beam.masses),
      gravity_(rig.gravity_along()),
      spring_(rig.hinge.spring) {}

int LinearBar::size() const {
  const int inside = elements_.front().shears() ? BarElement::inside : 0;
  return nodal() + inside * static_cast<int>(elements_.size());
}

std::array<int, BarElement::values> LinearBar::coordinates(std::size_t element) const {
  const int e = static_cast<int>(element);
  std::array<int, BarElement::values> places = {2 * e - 1, 2 * e, 2 * e + 1, 2 * e + 2, -1, -1, -1};
  if (elements_[element].shears())
    for (int i = 0; i < BarElement::inside; ++i)
      places[static_cast<std::size_t>(4 + i)] = nodal() + BarElement::inside * e + i;
  return places;
}

/// With the lumped masses on it, each in one element.
BarElement::Matrix LinearBar::mass_of(std::size_t e) const {
  const BarElement& element = elements_[e];
  BarElement::Matrix mass = element.mass();
  for (const LumpedMass& lump : masses_) {
    if (element_at(elements_, lump.position) != e) continue;
    const BarElement::Shape s = element.deflection((lump.position - element.x) / element.length);
    mass += lump.mass * s * s.transpose();
  }
  return mass;
}

/// Through the tension that the weight below an element leaves in the hanging bar: ∫ T w'w' dx.
BarElement::Matrix LinearBar::hanging_weight_of(const BarElement& element, double below) const {
  const GaussRule& rule = gauss_legendre(3);  // T linear, w' quadratic
  BarElement::Matrix weight = BarElement::Matrix::Zero();
  const auto add = [&](double xi, double mass, double part) {
    const BarElement::Shape s = element.slope(xi);
    weight += mass * gravity_ * part * element.length * s * s.transpose();
  };
  for (std::size_t g = 0; g < rule.points.size(); ++g) {
    const double xi = rule.points[g];
    add(xi, below + element.line_density * element.length * (1.0 - xi), rule.weights[g]);
    for (const LumpedMass& lump : masses_) {
      const double part = std::clamp((lump.position - element.x) / element.length, 0.0, 1.0);
      if (part > 0.0) add(part * xi, lump.mass, part * rule.weights[g]);
    }
  }
  return weight;
}

std::vector<LinearBar::Share> LinearBar::shares() const {
  std::vector<Share> shares(elements_.size());
  double below = 0.0;  // mass of the bar beyond the element
  for (std::size_t e = elements_.size(); e-- > 0;) {
    const BarElement& element = elements_[e];
    shares[e] = {coordinates(e), mass_of(e), element.stiffness(),
                 hanging_weight_of(element, below)};
    below += element.line_density * element.length;
  }
  return shares;
}

Eigen::VectorXd LinearBar::hinge() const {
  return -Eigen::VectorXd::Unit(size(), 0);
}

Eigen::VectorXd LinearBar::rigid() const {
  Eigen::VectorXd rigid = Eigen::VectorXd::Zero(size());
  rigid[0] = -1.0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const std::array<int, BarElement::values> places = coordinates(e);
    rigid[places[2]] = -(elements_[e].x + elements_[e].length);
    rigid[places[3]] = -1.0;
  }
  return rigid;
}

SmallMotion LinearBar::small_motion() const {
  const int n = size();
  SmallMotion motion;
  motion.mass = motion.stiffness = motion.gravity = Eigen::MatrixXd::Zero(n, n);
  motion.rigid = rigid();
  motion.hinge = hinge();
  motion.spring = spring_;
  for (const Share& share : shares()) {
    const auto add = [&](Eigen::MatrixXd& to, const BarElement::Matrix& of) {
      for (std::size_t r = 0; r < BarElement::values; ++r)
        for (std::size_t c = 0; c < BarElement::values; ++c)
          if (share.places[r] >= 0 && share.places[c] >= 0)
            to(share.places[r], share.places[c]) += of(static_cast<int>(r), static_cast<int>(c));
    };
    add(motion.mass, share.mass);
    add(motion.stiffness, share.stiffness);
    add(motion.gravity, share.gravity);
  }
  return motion;
}

LinearBar::Row LinearBar::row_at(double x) const {
  const std::size_t e = element_at(elements_, x);
  const BarElement& element = elements_[e];
  return {coordinates(e), -element.deflection((x - element.x) / element.length)};
}

Eigen::VectorXd LinearBar::small_motion_row(double x) const {
  const Row at = row_at(x);
  Eigen::VectorXd row = Eigen::VectorXd::Zero(size());
  for (std::size_t i = 0; i < BarElement::values; ++i)
    if (at.places[i] >= 0) row[at.places[i]] = at.values[static_cast<int>(i)];
  return row;
}

}  // namespace impactrig::models
