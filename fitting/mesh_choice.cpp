// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/mesh_choice.hpp"

#include <fmt/format.h>

#include <cmath>

#include "models/mesh_error.hpp"

namespace impactrig::fitting {

MeshChoice choose_mesh(RigFile& file, int finest) {
  if (file.mesh_stated) return {};
  const double time_limit = file.solver.time_limit;
  const models::ChosenMesh chosen = models::choose_mesh(file.rig, file.solver, finest);
  file.solver = chosen.solver;
  file.mesh_stated = file.mesh_chosen = true;
  const models::Solver& solver = file.solver;
  const std::string taken =
      fmt::format("The rig file leaves the mesh open: ANCF with [{}, {}] elements was taken; ",
                  solver.elements[0], solver.elements[1]);
  if (!std::isfinite(chosen.error))
    return {.sentence = taken + "its error could not be estimated.",
            .warning =
                "The error of the mesh that was taken could not be estimated: state "
                "solver.elements, and compare with twice as many.",
            .difference = {}};
  std::string sensor;
  if (file.rig.stop) sensor = ", and the sensor's largest force,";
  if (chosen.sensor_until)
    sensor = fmt::format(", and the sensor's largest force up to {:.4g} s,", *chosen.sensor_until);
  const std::string of_what = file.rig.has_stop()
                                  ? "in peak force, duration and impulse" + sensor
                                  : "in where the tip is, as a part of the bar's length,";
  const std::string estimate =
      fmt::format("its error {} is estimated at {:.1g} at most", of_what, chosen.error);
  if (chosen.error <= solver.accuracy)
    return {
        .sentence = fmt::format("{}{}, for an accuracy of {:g}.", taken, estimate, solver.accuracy),
        .warning = {},
        .difference = chosen.difference};
  using End = models::ChosenMesh::End;
  const std::string why =
      chosen.end == End::finest
          ? fmt::format("no more than {} elements are taken by themselves", finest)
      : chosen.end == End::time
          ? fmt::format("finer ones would take more than half of solver.time_limit, {:g} s",
                        time_limit)
          : "finer ones could not be compared";
  return {
      .sentence = fmt::format("{}{}, more than the accuracy of {:g} asked for; {}.", taken,
                              estimate, solver.accuracy, why),
      .warning = fmt::format("The mesh is too coarse for the accuracy of {:g} asked for: {}; "
                             "{}. State solver.elements, a longer solver.time_limit or a larger "
                             "solver.accuracy.",
                             solver.accuracy, estimate, why),
      .difference = chosen.difference};
}

std::vector<std::string> mesh_warnings(const RigFile& file, const models::Simulation& result) {
  if (!result.mesh_error) return {};
  std::vector<std::string> warnings;
  const models::MeshError& error = *result.mesh_error;
  const models::Solver& solver = result.solver;
  if (solver.model == models::BeamModel::hybrid && !file.modes_stated &&
      error.largest() > solver.accuracy)
    warnings.push_back(fmt::format(
        "{} modes, as many as solver.modes is unless stated, are too few for the accuracy of {:g} "
        "asked for: with twice as many peak force, duration or impulse differ by {:.1g}. State "
        "solver.modes, or the model \"ancf\", whose mesh is chosen.",
        solver.modes, solver.accuracy, error.largest()));
  if (result.sensor && error.sensor_until && result.sensor->peak_time > *error.sensor_until)
    warnings.push_back(
        fmt::format("the sensor carries most {:.4g} s after first touch, and meshes were compared "
                    "for the first "
                    "{:.4g} s only: what the mesh does to that force is not known. State a longer "
                    "solver.time_limit, or solver.elements, and compare with twice as many.",
                    result.sensor->peak_time, *error.sensor_until));
  return warnings;
}

}  // namespace impactrig::fitting
