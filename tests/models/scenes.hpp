// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "models/simulation.hpp"

namespace impactrig::tests {

/// Round aluminium bar in a groove of Shen et al., their table 1; no gravity unless a test sets it.
inline models::Rig paper_rig() {
  models::Rig rig;
  const double radius = 0.015;
  rig.beam = {.length = 0.8,
              .area = std::numbers::pi * radius * radius,
              .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
              .youngs_modulus = 6.8952e10,
              .density = 2766.7};
  rig.contact.position = 0.69;
  rig.contact.counterface = models::Counterface::groove;
  rig.contact.radius = radius;
  rig.contact.counter_radius = 0.0175;
  rig.contact.length = 0.02;
  rig.contact.modulus = rig.contact.counter_modulus = 6.8952e10;
  rig.contact.poisson_ratio = rig.contact.counter_poisson_ratio = 0.3;
  rig.contact.reference_length = 1.0;
  rig.contact.damping = "none";
  rig.start.velocity = 0.441;
  rig.gravity = 0.0;
  return rig;
}

/// I_O / L_p² [kg]: the mass a rigid bar opposes to a force at the struck point.
inline double effective_mass(const models::Rig& rig) {
  return rig.beam.hinge_inertia() / (rig.contact.position * rig.contact.position);
}

inline models::Solver rigid(double accuracy) {
  models::Solver solver;
  solver.model = models::BeamModel::rigid;
  solver.accuracy = accuracy;
  return solver;
}

inline models::Solver hybrid(models::Basis basis, int modes, double accuracy, double duration) {
  models::Solver solver;
  solver.model = models::BeamModel::hybrid;
  solver.basis = basis;
  solver.modes = modes;
  solver.accuracy = accuracy;
  solver.duration = duration;
  return solver;
}

inline models::Solver ancf(int before, int beyond, double accuracy, double duration) {
  models::Solver solver;
  solver.model = models::BeamModel::ancf;
  solver.elements = {before, beyond};
  solver.accuracy = accuracy;
  solver.duration = duration;
  return solver;
}

}  // namespace impactrig::tests
