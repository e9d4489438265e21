// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/assumed_modes.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "models/beams/bar_modes.hpp"
#include "models/beams/linear_bar.hpp"
#include "models/integration/gauss.hpp"

namespace impactrig::models {

std::vector<BarElement> elements_of_shapes(const Beam& beam, int count) {
  if (!beam.shears() && beam.segments.empty()) return {};
  const int pieces = static_cast<int>(bar_pieces(beam).size());
  return bar_elements(beam, beam.length, {std::max(64 + 8 * count, 8 * pieces), 0});
}

AssumedModes::AssumedModes(const Beam& beam, Basis basis, int count)
    : beam_(beam),
      omega_(count),
      elements_(elements_of_shapes(beam, count)) {
  if (elements_.empty()) {
    closed_ = bending_modes(beam, basis, count);
    for (int k = 0; k < count; ++k)
      omega_[k] = closed_[static_cast<std::size_t>(k)].angular_frequency();
  } else {
    solve(beam, basis, count);
  }
}

void AssumedModes::solve(const Beam& beam, Basis basis, int count) {
  Rig bare;
  bare.beam = beam;
  bare.beam.masses.clear();
  bare.gravity = 0.0;
  const LinearBar bar(bare, elements_);
  for (std::size_t e = 0; e < elements_.size(); ++e) places_of_.push_back(bar.places(e));
  rows_ = Eigen::MatrixXd::Zero(count, bar.size());
  if (count == 0) return;
  // clamped, the section at the hinge does not turn; pinned, the first mode is the rotation
  const bool clamped = basis == Basis::cantilever;
  const int skipped = clamped ? 0 : 1;
  const std::optional<BarModes> modes = BarModeFinder(bar, clamped).slowest(skipped + count, {});
  if (!modes) throw std::runtime_error("two of the bar's modes are too close to be told apart");
  omega_ = modes->squares.tail(count).cwiseSqrt();
  rows_ = modes->rows.bottomRows(count);
  // the finder's signs are those of rounding; bars that differ a little have shapes that do
  const int tip = places_of_.back()[2];
  for (int k = 0; k < count; ++k)
    if (rows_(k, tip) < 0.0) rows_.row(k) *= -1.0;
}

Eigen::VectorXd AssumedModes::shown(double x,
                                    BarElement::Shape (BarElement::*shape)(double) const) const {
  const std::size_t e = element_at(elements_, x);
  const BarElement& element = elements_[e];
  const BarElement::Shape share = (element.*shape)((x - element.x) / element.length);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(count());
  for (std::size_t i = 0; i < BarElement::values; ++i)
    if (const int place = places_of_[e][i]; place >= 0)
      sum += share[static_cast<int>(i)] * rows_.col(place);
  return sum;
}

Eigen::VectorXd AssumedModes::deflection(double x) const {
  if (!elements_.empty()) return shown(x, &BarElement::deflection);
  Eigen::VectorXd values(count());
  for (int k = 0; k < count(); ++k) values[k] = closed_[static_cast<std::size_t>(k)].at(x).value;
  return values;
}

Eigen::VectorXd AssumedModes::slope(double x) const {
  if (!elements_.empty()) return shown(x, &BarElement::slope);
  Eigen::VectorXd slopes(count());
  for (int k = 0; k < count(); ++k) slopes[k] = closed_[static_cast<std::size_t>(k)].at(x).slope;
  return slopes;
}

Eigen::VectorXd AssumedModes::rotation_at_hinge() const {
  return elements_.empty() ? slope(0.0) : shown(0.0, &BarElement::rotation);
}

Eigen::MatrixXd AssumedModes::rotary_inertia() const {
  Eigen::MatrixXd inertia = Eigen::MatrixXd::Zero(count() + 1, count() + 1);
  const GaussRule& rule = gauss_legendre(3);  // the product of two quadratics
  Eigen::VectorXd turned = Eigen::VectorXd::Ones(count() + 1);
  for (const BarElement& element : elements_)
    for (std::size_t g = 0; g < rule.points.size() && element.rotary_inertia > 0.0; ++g) {
      const double x = element.x + rule.points[g] * element.length;
      turned.tail(count()) = shown(x, &BarElement::rotation);
      inertia +=
          element.rotary_inertia * element.length * rule.weights[g] * turned * turned.transpose();
    }
  return inertia;
}

std::vector<AssumedModes::Place> AssumedModes::places(int fineness) const {
  const bool meshed = !elements_.empty();
  const std::vector<BarElement> parts = meshed ? elements_ : bar_pieces(beam_);
  const GaussRule& rule = gauss_legendre(meshed ? 4 : fineness);  // the product of two cubics
  std::vector<Place> places;
  double below = 0.0;
  for (const BarElement& part : parts) below += part.line_density * part.length;
  for (const BarElement& part : parts) {
    for (std::size_t g = 0; g < rule.points.size(); ++g) {
      const double width = part.length * rule.weights[g];
      places.push_back({.x = part.x + part.length * rule.points[g],
                        .width = width,
                        .mass = part.line_density * width,
                        .below = below - part.line_density * part.length * rule.points[g]});
    }
    below -= part.line_density * part.length;
  }
  return places;
}

}  // namespace impactrig::models
