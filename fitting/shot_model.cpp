// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/sensor_response.hpp"
#include "models/mesh_error.hpp"

namespace impactrig::fitting {
namespace {

// Finer than the recording by this, so that interpolation and the chain's linear hold stay far
// below the noise.
constexpr double oversampling = 4.0;
constexpr double coarsest = 0.5e-6;  // [s]

Shown::Curve curve(const std::optional<datasets::Sensor>& sensor, const models::History& history,
                   const std::vector<double>& values) {
  Shown::Curve shown{.start = history.start, .interval = history.interval, .values = values};
  if (sensor) shown.values = datasets::sensor_response(*sensor, values, history.interval);
  return shown;
}

}  // namespace

std::array<double, 2> Shown::Curve::at(double t) const {
  const double place = (t - start) / interval;
  const double last = static_cast<double>(values.size()) - 1.0;
  if (!(place > 1.0)) return {values.front(), 0.0};
  if (!(place < last - 1.0)) return {values.back(), 0.0};
  const auto k = static_cast<std::size_t>(place);
  const double s = place - static_cast<double>(k);
  // cubic through four neighbours at −1, 0, 1, 2
  const double a = values[k - 1], b = values[k], c = values[k + 1], d = values[k + 2];
  const double c1 = c - a / 3.0 - b / 2.0 - d / 6.0;
  const double c2 = (a + c) / 2.0 - b;
  const double c3 = (d - a) / 6.0 + (b - c) / 2.0;
  return {b + s * (c1 + s * (c2 + s * c3)), (c1 + s * (2.0 * c2 + 3.0 * s * c3)) / interval};
}

ShotModel::ShotModel(const RigFile& rig, const datasets::Impact& impact, double lead, double end,
                     double step)
    : file_(&rig),
      solver_(rig.solver),
      force_(impact.force.has_value()),
      velocity_(impact.velocity.has_value()),
      displacement_(impact.displacement.has_value()),
      lead_(lead),
      end_(end),
      interval_(std::min(step / oversampling, coarsest)) {}

ShotModel ShotModel::finer() const {
  ShotModel model = *this;
  model.solver_ = models::refined(solver_);
  model.bars_ = std::make_shared<models::BarCache>();
  return model;
}

models::Simulation ShotModel::simulate(const models::Rig& rig, double interval,
                                       const std::vector<models::RigParameter>& by) const {
  models::Solver solver = solver_;
  solver.duration = end_;
  models::SimulationOptions options;
  options.history = {.interval = interval, .lead = lead_};
  options.motion = motion_;
  options.bars = bars_.get();
  options.sensitivities = by;
  if (file_->velocity) options.history.velocity_position = file_->velocity->position;
  if (file_->displacement) options.history.displacement_position = file_->displacement->position;
  return models::simulate(rig, solver, options);
}

/// A history, or its derivatives: the sensors' chains are linear.
Shown ShotModel::show(const models::History& history) const {
  Shown shown;
  if (force_) shown.force = curve(file_->force, history, history.seen_force());
  if (velocity_) shown.velocity = curve(file_->velocity, history, history.velocity);
  if (displacement_) shown.displacement = curve(file_->displacement, history, history.displacement);
  return shown;
}

Shown ShotModel::predict(const models::Rig& rig,
                         const std::vector<models::RigParameter>& by) const {
  const models::Simulation simulation = simulate(rig, interval_, by);
  Shown shown = show(simulation.history);
  shown.restitution = simulation.restitution;
  for (const models::Sensitivity& sensitivity : simulation.sensitivities) {
    shown.slopes.push_back(show(sensitivity.history));
    shown.slopes.back().restitution = sensitivity.restitution;
  }
  return shown;
}

}  // namespace impactrig::fitting
