// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/full_sensitivities.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace impactrig::models {
namespace {

MotionSlope::Start start_of(const Rig& rig, const SimulationOptions& options) {
  if (follows_swing(rig, options)) return {-*rig.start.release_angle, 0.0};
  return {0.0, touch_velocity(rig) / rig.contact.position};
}

}  // namespace

FullSensitivities::FullSensitivities(const Rig& rig, const Solver& solver,
                                     const SimulationOptions& options, BarMotion& motion,
                                     const StoppedMotion* stopped)
    : RunSensitivities(rig, options, motion, stopped),
      motion_(motion),
      points_(stops_.size()),
      changes_(stops_.size()),
      passing_(stops_.size()) {
  const double accuracy = std::max(solver.accuracy, Solver::finest_accuracy);
  progress_.assign(options.sensitivities.size(), SlopeProgress(accuracy));
  for (const RigParameter parameter : options.sensitivities) {
    auto effect = std::make_unique<RigEffect>(rig, parameter, solver, options.history);
    slopes_.push_back(motion.follow(*effect, solver, options.history));
    known_ = known_ && slopes_.back();
    add(std::move(effect));
  }
}

void FullSensitivities::start() {
  for (int i = 0; i < count(); ++i) {
    const ParameterStencil& by = direction(i).effect->by();
    std::array<MotionSlope::Start, ParameterStencil::places> starts;
    for (std::size_t place = 0; place < starts.size(); ++place)
      starts[place] = start_of(by.rig_at(place), options_);
    slope(i).start(starts);
  }
}

void FullSensitivities::change_hinge() {
  for (int i = 0; i < count(); ++i) slope(i).change_hinge();
}

void FullSensitivities::begin_more(int i) {
  slope(i).look(0.0);
  direction(i).rest = slope(i).spots().displacement;
}

/// The forces' slopes come to the laws under the points' as they are; returns by how much the
/// motion's change for that.
double FullSensitivities::press(int i) {
  Direction& d = direction(i);
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    stops_[k].depth = points_[k].displacement.array() - d.effect->law(static_cast<int>(k)).gap();
    stops_[k].rate = points_[k].velocity;
  }
  drive_laws(d);
  for (std::size_t k = 0; k < stops_.size(); ++k)
    if (stops_[k].presses()) drive_.segment(stops_[k].first_row, rule_.nodes()) -= d.force[k];
  if (drive_.size() == 0) return 0.0;
  answer_.noalias() = inverse_ * drive_;
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    changes_[k].setZero(rule_.nodes());
    if (!stops_[k].presses()) continue;
    changes_[k] = answer_.segment(stops_[k].first_row, rule_.nodes());
    d.force[k] += changes_[k];
  }
  return slope(i).press(changes_);
}

bool FullSensitivities::solve(int i) {
  Direction& d = direction(i);
  for (NodeVector& force : d.force) force.setZero(rule_.nodes());
  slope(i).begin_step(force_);
  SlopeProgress& progress = progress_[static_cast<std::size_t>(i)];
  progress.begin_step();
  auto state = SlopeProgress::State::goes_on;
  while (state == SlopeProgress::State::goes_on) {
    const MotionSlope::Change change = slope(i).improve(d.force, points_);
    state = progress.improved(change, press(i));
  }
  return state == SlopeProgress::State::settled;
}

void FullSensitivities::go_to_place() {
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    Passing& p = passing_[k];
    const PointMotion seen = motion_.struck_at(static_cast<int>(k), place_.part, &p.acceleration);
    p.displacement = seen.displacement;
    p.velocity = seen.velocity;
  }
}

}  // namespace impactrig::models
