// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/linear_bar.hpp"

#include <algorithm>
#include <utility>

#include "models/beams/bar_modes.hpp"
#include "models/integration/gauss.hpp"

namespace impactrig::models {

double LinearBar::negligible_weight_at(double accuracy) {
  constexpr double fewest_modes = 1e-7, most_modes = 1e-12;
  return std::clamp(accuracy, most_modes, fewest_modes);
}

LinearBar::LinearBar(const Rig& rig, std::vector<BarElement> elements, double negligible_weight)
    : elements_(std::move(elements)),
      masses_(rig.beam.masses),
      gravity_(rig.gravity_along()),
      gravity_across_(rig.gravity_across()),
      spring_(rig.hinge.spring),
      negligible_weight_(negligible_weight) {}

int LinearBar::size() const {
  return 1 + values_of_element() * static_cast<int>(elements_.size());
}

std::array<int, BarElement::values> LinearBar::places(std::size_t element) const {
  const int each = values_of_element(), after = 1 + each * static_cast<int>(element);
  std::array<int, BarElement::values> at = {
      after - each, after - each + 1, after, after + 1, -1, -1, -1};
  if (element == 0) {
    at[0] = -1;
    at[1] = 0;
  }
  for (int i = 2; i < each; ++i) at[static_cast<std::size_t>(2 + i)] = after + i;
  return at;
}

namespace {

bool alike(const BarElement& a, const BarElement& b) {
  return a.length == b.length && a.bending_stiffness == b.bending_stiffness &&
         a.line_density == b.line_density && a.shear_compliance == b.shear_compliance &&
         a.rotary_inertia == b.rotary_inertia;
}

/// Through the tension T that a mass leaves in the hanging bar up to a part of the element: ∫ T
/// w'w' dx over the gravity.
BarElement::Matrix hanging(const BarElement& element, double mass, double part) {
  const GaussRule& rule = gauss_legendre(3);  // w' is quadratic
  BarElement::Matrix weight = BarElement::Matrix::Zero();
  for (std::size_t g = 0; g < rule.points.size(); ++g) {
    const BarElement::Shape s = element.slope(part * rule.points[g]);
    weight += mass * part * rule.weights[g] * element.length * s * s.transpose();
  }
  return weight;
}

/// Likewise by the element's own mass: T falls towards its end.
BarElement::Matrix hanging_itself(const BarElement& element) {
  const GaussRule& rule = gauss_legendre(3);
  BarElement::Matrix weight = BarElement::Matrix::Zero();
  for (std::size_t g = 0; g < rule.points.size(); ++g) {
    const double xi = rule.points[g];
    const BarElement::Shape s = element.slope(xi);
    weight += element.line_density * element.length * (1.0 - xi) * rule.weights[g] *
              element.length * s * s.transpose();
  }
  return weight;
}

}  // namespace

/// Lumped masses are on one element each, and pull at all from the hinge to there.
std::vector<LinearBar::Share> LinearBar::shares() const {
  std::vector<Share> shares(elements_.size());
  BarElement::Matrix mass, stiffness, by_below, by_itself;
  double below = 0.0;  // mass of the bar beyond the element
  for (std::size_t e = elements_.size(); e-- > 0;) {
    const BarElement& element = elements_[e];
    if (e + 1 == elements_.size() || !alike(element, elements_[e + 1])) {
      mass = element.mass();
      stiffness = element.stiffness();
      by_below = hanging(element, 1.0, 1.0);
      by_itself = hanging_itself(element);
    }
    shares[e] = {places(e), mass, stiffness, gravity_ * (below * by_below + by_itself)};
    below += element.line_density * element.length;
  }
  for (const LumpedMass& lump : masses_) {
    const std::size_t on = element_at(elements_, lump.position);
    for (std::size_t e = 0; e <= on; ++e) {
      const BarElement& element = elements_[e];
      const double part = std::min((lump.position - element.x) / element.length, 1.0);
      shares[e].gravity += gravity_ * hanging(element, lump.mass, part);
      if (e < on) continue;
      const BarElement::Shape s = element.deflection(part);
      shares[e].mass += lump.mass * s * s.transpose();
    }
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
    const std::array<int, BarElement::values> at = places(e);
    rigid[at[2]] = -(elements_[e].x + elements_[e].length);
    rigid[at[3]] = -1.0;
  }
  return rigid;
}

SmallMotion LinearBar::small_motion() const {
  const int n = size();
  SmallMotion motion;
  motion.mass = motion.stiffness = motion.gravity = Eigen::MatrixXd::Zero(n, n);
  motion.load = small_motion_load();
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

Eigen::VectorXd LinearBar::small_motion_load() const {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(size());
  if (gravity_across_ == 0.0) return load;
  const auto add = [&](std::size_t element, double xi, double mass) {
    const std::array<int, BarElement::values> at = places(element);
    const BarElement::Shape values = elements_[element].deflection(xi);
    for (std::size_t i = 0; i < BarElement::values; ++i)
      if (at[i] >= 0) load[at[i]] -= gravity_across_ * mass * values[static_cast<int>(i)];
  };
  const GaussRule& rule = gauss_legendre(2);  // w is cubic
  for (std::size_t e = 0; e < elements_.size(); ++e)
    for (std::size_t g = 0; g < rule.points.size(); ++g)
      add(e, rule.points[g], rule.weights[g] * elements_[e].line_density * elements_[e].length);
  for (const LumpedMass& lump : masses_) {
    const std::size_t on = element_at(elements_, lump.position);
    const BarElement& element = elements_[on];
    add(on, std::min((lump.position - element.x) / element.length, 1.0), lump.mass);
  }
  return load;
}

Eigen::MatrixXd LinearBar::own_values(const Eigen::MatrixXd& shapes) const {
  Eigen::MatrixXd own = shapes;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const std::array<int, BarElement::values> at = places(e);
    if (at[0] >= 0) own.row(at[2]) -= shapes.row(at[0]);
    own.row(at[2]) -= elements_[e].length * shapes.row(at[1]);
    own.row(at[3]) -= shapes.row(at[1]);
  }
  return own;
}

Eigen::MatrixXd LinearBar::shapes_of(const Eigen::MatrixXd& own) const {
  Eigen::MatrixXd shapes = own;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const std::array<int, BarElement::values> at = places(e);
    if (at[0] >= 0) shapes.row(at[2]) += shapes.row(at[0]);
    shapes.row(at[2]) += elements_[e].length * shapes.row(at[1]);
    shapes.row(at[3]) += shapes.row(at[1]);
  }
  return shapes;
}

Eigen::MatrixXd LinearBar::strains(const Eigen::MatrixXd& own) const {
  const int each = values_of_element();
  Eigen::MatrixXd strains(each * static_cast<Eigen::Index>(elements_.size()), own.cols());
  for (std::size_t e = 0; e < elements_.size(); ++e)
    strains.middleRows(each * static_cast<Eigen::Index>(e), each).noalias() =
        elements_[e].strain().topLeftCorner(each, each) * own.middleRows(places(e)[2], each);
  return strains;
}

std::optional<BarModes> LinearBar::modes() const {
  return BarModeFinder(*this).all();
}

LinearBar::Row LinearBar::row_at(double x) const {
  const std::size_t e = element_at(elements_, x);
  const BarElement& element = elements_[e];
  return {static_cast<int>(e), places(e), -element.deflection((x - element.x) / element.length)};
}

Eigen::VectorXd LinearBar::small_motion_row(double x) const {
  const Row at = row_at(x);
  Eigen::VectorXd row = Eigen::VectorXd::Zero(size());
  for (std::size_t i = 0; i < BarElement::values; ++i)
    if (at.places[i] >= 0) row[at.places[i]] = at.values[static_cast<int>(i)];
  return row;
}

}  // namespace impactrig::models
