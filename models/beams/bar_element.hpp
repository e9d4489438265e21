// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "models/rig.hpp"

namespace impactrig::models {

/// A two-node element of a straight bar, with the constants of its section.
///
/// Nodal values are (w, θ) of the first node, then of the second: deflection of the axis, rotation
/// of the section; w' − θ is the shear strain. Interpolation is the static solution of a Timoshenko
/// bar loaded at its ends, with Φ = 12 EI / (κGA l²) [FriedmanKosmatka1993]: w cubic, θ quadratic,
/// no locking, exact for end loads. With Φ = 0 w is Hermite's cubic and θ = w', all there is.
///
/// In a bar that moves, inertia loads vary the shear force along the element: three more values a,
/// b and c inside it, w = 4 (ξ − ξ²) a, θ = 4 (ξ − ξ²) b with its w of constant shear strain, and w
/// = ξ (1 − ξ) (1 − 2ξ) c, make w any cubic and θ any quadratic, those of ReissnerElement where it
/// moves little. Without them frequencies of a bar that shears would err with the second power of l
/// only; with them it is the fourth. They couple elastically neither to the nodes nor to each
/// other. ξ runs from 0 to 1.
struct BarElement {
  static constexpr int values = 7;  ///< four of the nodes, a [m], b [-] and c [m]
  static constexpr int inside = 3;  ///< the last of them; zero with Φ = 0
  using Shape = Eigen::Matrix<double, values, 1>;
  using Matrix = Eigen::Matrix<double, values, values>;

  double x = 0.0;                  ///< of its first node [m]
  double length = 0.0;             ///< l [m]
  double axial_stiffness = 0.0;    ///< EA [N]
  double bending_stiffness = 0.0;  ///< EI [N m^2]
  double line_density = 0.0;       ///< ρA [kg/m]
  double shear_compliance = 0.0;   ///< 1 / (κGA) [1/N]; 0: sections stay normal to the axis
  double rotary_inertia = 0.0;     ///< of the sections, ρI [kg m]

  bool shears() const { return shear_compliance > 0.0; }

  Shape deflection(double xi) const;  ///< w
  Shape slope(double xi) const;       ///< w'
  Shape rotation(double xi) const;    ///< θ

  Matrix mass() const;       ///< ∫ ρA w'w + ρI θ'θ dx
  Matrix stiffness() const;  ///< of bending and shear
  /// Each strain by the root of what resists it, by what the second node deflects and turns beyond
  /// a rigid element and the values inside: the stiffness is its product with itself.
  Eigen::Matrix<double, values - 2, values - 2> strain() const;

  double shear_share() const;  ///< Φ [-]

  /// Wave number of a bending wave over ω^½ [s^½/m], of a bar that does not shear.
  double wave_number() const;
};

/// A segment of the bar, x from the hinge.
BarElement bar_piece(const Beam& beam, const BeamSegment& segment, double x);

/// The parts of the bar within which nothing of its section changes, from hinge to tip.
std::vector<BarElement> bar_pieces(const Beam& beam);

/// The same one after the other, without memory.
template <typename Visitor>
void for_each_piece(const Beam& beam, Visitor&& visit) {
  if (beam.segments.empty()) {
    visit(
        bar_piece(beam, {beam.length, beam.area, beam.second_moment, beam.shear_coefficient}, 0.0));
    return;
  }
  double x = 0.0;
  for (const BeamSegment& segment : beam.segments) {
    visit(bar_piece(beam, segment, x));
    x += segment.length;
  }
}

/// The bar from hinge to tip: so many elements up to the struck point, so many beyond. They end
/// where the section changes too, and share a side by the lengths of its bending waves.
std::vector<BarElement> bar_elements(const Beam& beam, double struck, std::array<int, 2> elements);

/// How few elements the sides of the struck point can have; none beyond one that is the tip.
std::array<int, 2> fewest_elements(const Beam& beam, double struck);

/// Of the bar without its lumped masses [kg].
double mass_between(const std::vector<BarElement>& pieces, double from, double to);

/// The element that holds a place of the bar; the first of two at a node.
std::size_t element_at(const std::vector<BarElement>& elements, double x);

}  // namespace impactrig::models
