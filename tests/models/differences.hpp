// SPDX-License-Identifier: BSD-3-Clause
//
// Differences of simulations at accuracy 1e-12, of the sixth order in the parameter, which know
// nothing of sensitivities.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "models/simulation.hpp"

namespace impactrig::tests {

/// A number of the rig.
struct Named {
  const char* name;
  models::RigParameter of;
};

inline constexpr std::array parameters = {
    Named{"restitution", [](models::Rig& r) -> double& { return r.contact.restitution; }},
    Named{"stiffness_factor", [](models::Rig& r) -> double& { return r.contact.stiffness_factor; }},
    Named{"velocity", [](models::Rig& r) -> double& { return r.start.velocity; }},
    Named{"length", [](models::Rig& r) -> double& { return r.contact.length; }},
    Named{"modulus", [](models::Rig& r) -> double& { return r.contact.modulus; }},
    Named{"radius", [](models::Rig& r) -> double& { return r.contact.radius; }},
    Named{"counter_radius", [](models::Rig& r) -> double& { return r.contact.counter_radius; }},
    Named{"youngs_modulus", [](models::Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"density", [](models::Rig& r) -> double& { return r.beam.density; }},
    Named{"gravity", [](models::Rig& r) -> double& { return r.gravity; }},
    // moving places shift vibrations: differences need scenes where they shift little
    Named{"position", [](models::Rig& r) -> double& { return r.contact.position; }},
    Named{"beam length", [](models::Rig& r) -> double& { return r.beam.length; }},
};

inline constexpr std::span<const Named> without_places =
    std::span(parameters).first(parameters.size() - 2);

/// Of what a bar is made of, with a mass on it.
inline constexpr std::array of_sections = {
    Named{"area", [](models::Rig& r) -> double& { return r.beam.area; }},
    Named{"second moment", [](models::Rig& r) -> double& { return r.beam.second_moment; }},
    Named{"mass", [](models::Rig& r) -> double& { return r.beam.masses[0].mass; }},
    Named{"mass's place", [](models::Rig& r) -> double& { return r.beam.masses[0].position; }},
};

/// Of a bar of two segments.
inline constexpr std::array of_segments = {
    Named{"first length", [](models::Rig& r) -> double& { return r.beam.segments[0].length; }},
    Named{"last length", [](models::Rig& r) -> double& { return r.beam.segments[1].length; }},
    Named{"first area", [](models::Rig& r) -> double& { return r.beam.segments[0].area; }},
    Named{"last second moment",
          [](models::Rig& r) -> double& { return r.beam.segments[1].second_moment; }},
    Named{"last youngs_modulus",
          [](models::Rig& r) -> double& { return *r.beam.segments[1].youngs_modulus; }},
    Named{"last density", [](models::Rig& r) -> double& { return *r.beam.segments[1].density; }},
    Named{"shear_coefficient",
          [](models::Rig& r) -> double& { return r.beam.segments[0].shear_coefficient; }},
    Named{"poisson_ratio", [](models::Rig& r) -> double& { return r.beam.poisson_ratio; }},
};

// An Euler-Bernoulli bar does not know the last two.
inline constexpr std::span<const Named> of_segments_that_bend =
    std::span(of_segments).first(of_segments.size() - 2);

inline constexpr std::array of_gravity = {
    Named{"gravity direction", [](models::Rig& r) -> double& { return r.gravity_direction; }},
    Named{"gravity", [](models::Rig& r) -> double& { return r.gravity; }},
};

inline constexpr std::array of_damped_bars = {
    Named{"mass damping", [](models::Rig& r) -> double& { return r.beam.damping.mass; }},
    Named{"stiffness damping", [](models::Rig& r) -> double& { return r.beam.damping.stiffness; }},
    Named{"viscous hinge", [](models::Rig& r) -> double& { return r.hinge.viscous; }},
    Named{"spring", [](models::Rig& r) -> double& { return r.hinge.spring; }},
    Named{"restitution", [](models::Rig& r) -> double& { return r.contact.restitution; }},
    Named{"velocity", [](models::Rig& r) -> double& { return r.start.velocity; }},
    Named{"youngs_modulus", [](models::Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"density", [](models::Rig& r) -> double& { return r.beam.density; }},
    Named{"position", [](models::Rig& r) -> double& { return r.contact.position; }},
    Named{"beam length", [](models::Rig& r) -> double& { return r.beam.length; }},
};

inline constexpr std::array of_compliant_stops = {
    Named{"stop mass", [](models::Rig& r) -> double& { return r.stop->mass; }},
    Named{"stop stiffness", [](models::Rig& r) -> double& { return r.stop->stiffness; }},
    Named{"stop viscous", [](models::Rig& r) -> double& { return r.stop->viscous; }},
    Named{"restitution", [](models::Rig& r) -> double& { return r.contact.restitution; }},
    Named{"stiffness_factor", [](models::Rig& r) -> double& { return r.contact.stiffness_factor; }},
    Named{"velocity", [](models::Rig& r) -> double& { return r.start.velocity; }},
    Named{"youngs_modulus", [](models::Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"position", [](models::Rig& r) -> double& { return r.contact.position; }},
};

inline constexpr std::array of_further_stops = {
    Named{"gap", [](models::Rig& r) -> double& { return r.further_stops[0].gap; }},
    Named{"its factor",
          [](models::Rig& r) -> double& { return r.further_stops[0].contact.stiffness_factor; }},
    Named{"its restitution",
          [](models::Rig& r) -> double& { return r.further_stops[0].contact.restitution; }},
    Named{"its position",
          [](models::Rig& r) -> double& { return r.further_stops[0].contact.position; }},
    Named{"restitution", [](models::Rig& r) -> double& { return r.contact.restitution; }},
    Named{"stiffness_factor", [](models::Rig& r) -> double& { return r.contact.stiffness_factor; }},
    Named{"velocity", [](models::Rig& r) -> double& { return r.start.velocity; }},
    Named{"youngs_modulus", [](models::Rig& r) -> double& { return r.beam.youngs_modulus; }},
    Named{"density", [](models::Rig& r) -> double& { return r.beam.density; }},
    Named{"position", [](models::Rig& r) -> double& { return r.contact.position; }},
};

/// Of a damped contact, under gravity.
models::Rig damped_rig();

/// At accuracy 1e-12, with a history. Full motion takes no simplification.
models::Simulation sharp(const models::Rig& rig, models::Solver solver, models::Motion motion,
                         std::vector<models::RigParameter> by = {});

/// To which sides of the number differences go.
enum class Side { both, below, above };

/// Expects the derivatives of all that is differentiated, numbers and samples, relative to the
/// value's own size over that of the parameter: where a derivative is nearly zero the differences
/// have nothing more exact to offer. `spacing`: theirs, of the parameter's size.
void expect_equal_derivatives(const models::Rig& rig, const models::Solver& solver,
                              double tolerance, std::span<const Named> of = parameters,
                              double spacing = 1e-3, models::Motion motion = models::Motion::small,
                              Side side = Side::both);

/// Of damped_rig(), stepped down behind the middle, that of the outer segment a material of its
/// own.
models::Rig stepped_rig();

}  // namespace impactrig::tests
