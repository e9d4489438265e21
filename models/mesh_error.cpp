// SPDX-License-Identifier: BSD-3-Clause
#include "models/mesh_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/beams/bar_element.hpp"
#include "models/modal/small_motion_run.hpp"

namespace impactrig::models {
namespace {

// Of the runs that are compared: far below any mesh error worth knowing. Meshes too fine for all of
// their modes, whose error is next to nothing, are compared to a part of the accuracy asked for.
constexpr double time_accuracy = 1e-7, part_of_accuracy = 1e-2;
constexpr int coarsest = 8;
constexpr int finest = 64;
// Cubic elements converge with the fourth power at best.
constexpr double best_ratio = 1.0 / 16.0;

/// The rig with what small motion does not know left out: the mesh has to carry the same waves,
/// damping would only take from them, and weight is nothing against the contact's forces.
Rig within_small_motion(const Rig& rig) {
  Rig plain = rig;
  plain.start.velocity = touch_velocity(rig);
  plain.start.release_angle.reset();
  plain.hinge.viscous = plain.hinge.friction = 0.0;
  plain.beam.damping = {};
  plain.gravity_direction = 0.0;
  return plain;
}

double accuracy_of_runs(const Rig& rig, const Solver& solver, const Solver& finer) {
  if (small_motion_refusal(rig, finer).empty()) return time_accuracy;
  return std::max(time_accuracy, part_of_accuracy * solver.accuracy);
}

}  // namespace

double MeshError::largest() const {
  double largest = std::abs(peak_force);
  for (const double other : {duration, impulse})
    if (std::isfinite(other)) largest = std::max(largest, std::abs(other));
  return largest;
}

Solver refined(const Solver& solver) {
  Solver finer = solver;
  finer.elements = {2 * solver.elements[0], 2 * solver.elements[1]};
  finer.modes = 2 * solver.modes;
  finer.axial_modes = 2 * solver.axial_modes;
  return finer;
}

Solver coarsened(const Solver& solver) {
  constexpr int few_modes = 4, few_elements = 16;
  Solver coarser = solver;
  coarser.modes = std::min(solver.modes, few_modes);
  coarser.axial_modes = 0;
  auto& [before, beyond] = coarser.elements;
  while (before + beyond > few_elements && before % 2 == 0 && beyond % 2 == 0) {
    before /= 2;
    beyond /= 2;
  }
  return coarser;
}

std::optional<MeshError> mesh_error(const Rig& rig, const Solver& solver) {
  if (solver.model == BeamModel::rigid || !rig.has_stop()) return std::nullopt;
  MeshError error;
  error.finer = refined(solver);
  const Rig plain = within_small_motion(rig);
  SimulationOptions options;
  options.motion = Motion::small;
  const double accuracy = accuracy_of_runs(plain, solver, error.finer);
  const auto first_contact = [&](Solver mesh) {
    mesh.accuracy = accuracy;
    return simulate(plain, mesh, options).episodes.front();
  };
  try {
    const Episode coarse = first_contact(solver);
    const Episode fine = first_contact(error.finer);
    const bool ends = !coarse.open && !fine.open;
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    error.peak_force = fine.peak_force / coarse.peak_force - 1.0;
    error.duration = ends ? fine.end / coarse.end - 1.0 : unknown;
    error.impulse = ends ? fine.impulse / coarse.impulse - 1.0 : unknown;
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return error;
}

Solver choose_mesh(const Rig& rig, const Solver& solver, double& error) {
  Solver mesh = solver;
  double before = 0.0;
  for (int total = coarsest; total < finest; total *= 2) {
    mesh.elements = split_elements(total, rig);
    const std::optional<MeshError> found = mesh_error(rig, mesh);
    if (!found) return solver;
    before = error;
    error = found->largest();
    if (error <= solver.accuracy) return mesh;
  }
  mesh.elements = split_elements(finest, rig);
  error *= std::clamp(error / before, best_ratio, 1.0);
  return mesh;
}

std::array<int, 2> split_elements(int total, const Rig& rig) {
  if (rig.contact.position >= rig.beam.length)
    return {std::max(total, fewest_elements(rig.beam, rig.contact.position)[0]), 0};
  const int first = static_cast<int>(std::lround(total * rig.contact.position / rig.beam.length));
  const int before = std::clamp(first, 1, std::max(total - 1, 1));
  const std::array<int, 2> fewest = fewest_elements(rig.beam, rig.contact.position);
  return {std::max(before, fewest[0]), std::max({total - before, 1, fewest[1]})};
}

}  // namespace impactrig::models
