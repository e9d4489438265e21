// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/free_sensitivities.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "models/free_run.hpp"

namespace impactrig::models {
namespace {

/// Nothing is struck: histories alone are known.
Sensitivity without_numbers() {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  return {.peak_force = unknown,
          .max_penetration = unknown,
          .duration = unknown,
          .impulse = unknown,
          .separation_velocity = unknown,
          .restitution = {0.0, unknown, unknown, unknown},
          .history = {}};
}

}  // namespace

FreeSensitivities::FreeSensitivities(const Rig& rig, const Solver& solver,
                                     const SimulationOptions& options, BarMotion& motion)
    : options_(options),
      turned_(rig.hinge.rotation.has_value()),
      no_force_(1, NodeVector::Zero(motion.rule().nodes())) {
  const double accuracy = std::max(solver.accuracy, Solver::finest_accuracy);
  for (const RigParameter parameter : options.sensitivities) {
    auto effect = std::make_unique<RigEffect>(rig, parameter, solver, options.history);
    auto slope = motion.follow(*effect, solver, options.history);
    known_ = known_ && slope;
    directions_.push_back(
        {std::move(effect), std::move(slope), SlopeProgress(accuracy), 0.0, without_numbers()});
  }
}

void FreeSensitivities::start(std::size_t samples) {
  for (Direction& d : directions_) {
    std::array<MotionSlope::Start, ParameterStencil::places> starts;
    for (std::size_t place = 0; place < starts.size(); ++place)
      starts[place] = free_start(d.effect->by().rig_at(place));
    d.slope->start(starts);
    History& history = d.result.history;
    history.interval = options_.history.interval;
    for (const auto values :
         {&History::velocity, &History::displacement, &History::deflection, &History::extension})
      (history.*values).reserve(samples);
  }
}

bool FreeSensitivities::solve(Direction& d) {
  d.slope->begin_step(no_force_);
  d.progress.begin_step();
  auto state = SlopeProgress::State::goes_on;
  while (state == SlopeProgress::State::goes_on)
    state = d.progress.improved(d.slope->improve(no_force_, {}));
  return state == SlopeProgress::State::settled;
}

bool FreeSensitivities::solve() {
  return std::ranges::all_of(directions_, [this](Direction& d) { return solve(d); });
}

void FreeSensitivities::show(Direction& d, double part) {
  d.slope->look(part);
  const MotionSlope::Spots spots = d.slope->spots();
  History& history = d.result.history;
  history.velocity.push_back(spots.velocity - d.time * spots.velocity_rate);
  history.displacement.push_back(spots.displacement - d.time * spots.displacement_rate);
  if (!turned_) return;  // as stated it knows no events
  history.deflection.push_back(spots.deflection);
  history.extension.push_back(spots.extension);
}

void FreeSensitivities::sample(double first, double spacing, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k)
    for (Direction& d : directions_) show(d, first + static_cast<double>(k) * spacing);
}

void FreeSensitivities::take(bool changes) {
  for (Direction& d : directions_) {
    const double shift = changes ? d.slope->hinge_shift() : 0.0;
    d.time += shift;
    d.slope->take(shift);
  }
}

void FreeSensitivities::change_hinge() {
  for (Direction& d : directions_) d.slope->change_hinge();
}

std::vector<Sensitivity> FreeSensitivities::take_results() {
  std::vector<Sensitivity> results;
  for (Direction& d : directions_) results.push_back(std::move(d.result));
  return results;
}

}  // namespace impactrig::models
