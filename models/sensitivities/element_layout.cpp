// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/element_layout.hpp"

#include <algorithm>

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

}  // namespace

ElementLayout ElementLayout::of(const Rig& rig, const Solver& solver,
                                const HistoryRequest& history) {
  if (solver.model == BeamModel::rigid) return {};
  const bool ancf = solver.model == BeamModel::ancf;
  const std::vector<BarElement> elements =
      ancf ? bar_elements(rig.beam, rig.contact.position, solver.elements)
           : elements_of_shapes(rig.beam, solver.modes);
  if (elements.empty()) return {};
  ElementLayout layout{.shares = shares_of(elements, corners_of(rig, ancf)), .holds = {}};
  const double near = at_end * rig.beam.length;
  const auto hold = [&](double place) {
    const bool beyond = place > rig.beam.length + near;
    layout.holds.push_back(beyond ? elements.size() : element_at(elements, place - near));
  };
  for (const LumpedMass& lump : rig.beam.masses) hold(lump.position);
  for (int stop = ancf ? 1 : 0; stop < rig.stops(); ++stop) hold(rig.contact_of(stop).position);
  for (const double place : {history.velocity_position, history.displacement_position})
    if (place > 0.0) hold(place);
  return layout;
}

}  // namespace impactrig::models
