// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "models/sensitivities/law_effect.hpp"
#include "models/sensitivities/parameter_stencil.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// What a parameter of the rig changes of a run, whatever the equations of the bar, the run's own
/// course apart: how it begins, the laws at its stops, what is shown before touch. By differences
/// of closed forms, none of simulations.
class RigEffect {
 public:
  /// What it changes at all; for slopes of a bar of elements the stencil has to know these.
  RigEffect(const Rig& rig, RigParameter parameter);
  RigEffect(const Rig& rig, RigParameter parameter, const Solver& solver,
            const HistoryRequest& history);
  RigEffect(const RigEffect&) = delete;
  RigEffect& operator=(const RigEffect&) = delete;

  const ParameterStencil& by() const { return by_; }

  double size() const { return by_.size(); }

  LawEffect& law(int stop) { return laws_[static_cast<std::size_t>(stop)]; }

  const LawEffect& law(int stop) const { return laws_[static_cast<std::size_t>(stop)]; }

  /// Whether bar and hinge, and the places of the stops, stay as they are.
  bool keeps_bar() const { return keeps_bar_; }

  /// Whether small motion has what it changes: not dry friction in the hinge, nor what would hold a
  /// pendulum that nothing holds, or have it stand.
  bool small_motion_knows() const;

  /// Whether the full equations have slopes by it: not by friction that is none, nor by the time of
  /// a rotation that takes none, which cannot be moved both ways.
  bool has_slopes() const;

  /// Of touch_velocity() [m/s a unit]; without a stop 0.
  double touch_speed() const { return touch_speed_; }

  /// Of what the history shows up to touch, when the struck point arrives at this speed [m/s] whose
  /// slope is known too [m/s a unit].
  History lead(const HistoryRequest& wanted, double speed, double slope) const;

 private:
  explicit RigEffect(ParameterStencil by);
  History still(const HistoryRequest& wanted) const;

  bool moves_gap() const {
    return std::ranges::any_of(laws_, [](const LawEffect& law) { return law.gap() != 0.0; });
  }

  ParameterStencil by_;
  std::vector<LawEffect> laws_;
  bool keeps_bar_, moves_friction_;
  double touch_speed_;
};

}  // namespace impactrig::models
