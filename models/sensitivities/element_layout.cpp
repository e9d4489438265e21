// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/element_layout.hpp"

#include <algorithm>
#include <cmath>

#include "models/beams/assumed_modes.hpp"
#include "models/beams/bar_element.hpp"

namespace impactrig::models {
namespace {

// Of the bar's length: what lies that close behind an element's end lies at it.
constexpr double at_end = 1e-9;

/// Where the bar changes, from the hinge to the tip.
std::vector<double> corners_of(const Rig& rig, bool ends_at_struck_point) {
  std::vector<double> corners = {0.0, rig.beam.length};
  for (const BarElement& piece : bar_pieces(rig.beam)) corners.push_back(piece.x);
  if (ends_at_struck_point) corners.push_back(rig.contact.position);
  std::ranges::sort(corners);
  return corners;
}

std::vector<int> shares_of(const std::vector<BarElement>& elements,
                           const std::vector<double>& corners) {
  std::vector<int> shares(corners.size(), 0);
  for (const BarElement& element : elements) {
    const auto after = std::ranges::upper_bound(corners, element.x + 0.5 * element.length);
    ++shares[static_cast<std::size_t>(after - corners.begin()) - 1];
  }
  return shares;
}

std::vector<BarElement> elements_of(const Rig& rig, const Solver& solver) {
  if (solver.model == BeamModel::rigid) return {};
  return solver.model == BeamModel::ancf
             ? bar_elements(rig.beam, rig.contact.position, solver.elements)
             : elements_of_shapes(rig.beam, solver.modes);
}

/// Where masses, stops and lasers are, but for a stop at an element's end.
std::vector<double> places_of(const Rig& rig, const Solver& solver, const HistoryRequest& history) {
  std::vector<double> places;
  for (const LumpedMass& lump : rig.beam.masses) places.push_back(lump.position);
  for (int stop = solver.model == BeamModel::ancf ? 1 : 0; stop < rig.stops(); ++stop)
    places.push_back(rig.contact_of(stop).position);
  for (const double place : {history.velocity_position, history.displacement_position})
    if (place > 0.0) places.push_back(place);
  return places;
}

}  // namespace

ElementLayout ElementLayout::of(const Rig& rig, const Solver& solver,
                                const HistoryRequest& history) {
  const std::vector<BarElement> elements = elements_of(rig, solver);
  if (elements.empty()) return {};
  const bool ancf = solver.model == BeamModel::ancf;
  ElementLayout layout{.shares = shares_of(elements, corners_of(rig, ancf)), .holds = {}};
  const double near = at_end * rig.beam.length;
  for (const double place : places_of(rig, solver, history)) {
    const bool beyond = place > rig.beam.length + near;
    layout.holds.push_back(beyond ? elements.size() : element_at(elements, place - near));
  }
  return layout;
}

double largest_change_of_elements(const Rig& one, const Rig& other, const Solver& solver,
                                  const HistoryRequest& history) {
  if (ElementLayout::of(one, solver, history) != ElementLayout::of(other, solver, history))
    return 0.0;
  const std::vector<BarElement> elements = elements_of(one, solver);
  const std::vector<BarElement> moved = elements_of(other, solver);
  double largest = 0.0;
  for (std::size_t e = 0; e < elements.size(); ++e)
    largest =
        std::max(largest, std::abs(moved[e].length - elements[e].length) / elements[e].length);
  const std::vector<double> places = places_of(one, solver, history);
  const std::vector<double> moved_places = places_of(other, solver, history);
  // between an element's ends a shape is a polynomial that the stencil differentiates exactly
  const bool moves_on = solver.model == BeamModel::ancf && !elements.empty();
  for (std::size_t i = 0; i < places.size() && moves_on; ++i) {
    const std::size_t e = element_at(elements, places[i]);
    const double change = (moved_places[i] - moved[e].x) - (places[i] - elements[e].x);
    largest = std::max(largest, std::abs(change) / elements[e].length);
  }
  return largest;
}

}  // namespace impactrig::models
