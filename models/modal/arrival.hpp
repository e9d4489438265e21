// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"
#include "models/rig.hpp"

namespace impactrig::models {

/// How a bar that was let go straight and from rest arrives at its stop: it has swung like a rigid
/// one, and vibrates about where its weight bends it. Each mode but the pendulum's answers the
/// weight across the bar, which changes as slowly as the bar swings, and what it lacked of that
/// bending as it was let go dies away as its damping has it:
///
///   q + d q̇ / ω² + q̈ / ω² = Q / ω²,   Q / ω² = h cos φ − r sin φ
///
/// φ is the rigid bar's angle from touch, h where gravity from the side holds the mode at touch and
/// r its part of the rigid rotation (the bar's weight along itself). Terms beyond q̈ are left out.
struct Arrival {
  double angle = 0.0;  ///< of the rigid bar, as the struck point touches [rad]
  double rate = 0.0;   ///< [rad/s]
  /// Of the modes, against a straight bar that turns like that (m); 0 of the pendulum's.
  ModalState bending{};
  double vibration = 0.0;  ///< the most of the struck point's speed that is vibration, a part of it
  /// By how much less at most it arrives with than a rigid bar would, or more, likewise.
  double slower = 0.0;
  /// What is left out of the speed, likewise, above all by what the swing's centrifugal force does
  /// to the phase of a vibration; 1 where the struck point may come back before it touches.
  double error = 0.0;
};

/// Of a rig that is released; its spring must not bend the bar. Throws std::invalid_argument where
/// it does not arrive, std::runtime_error where the swing takes too long to be followed.
Arrival arrive(const Rig& rig, const ModalBeam& beam);

/// Arrival::vibration of a rig that is released before a stop, by its slowest modes, which have
/// most of it; none where small motion does not know the rig, its spring bends the bar, or it does
/// not arrive.
std::optional<double> release_vibration(const Rig& rig);

/// The same of all of the speed that a rigid bar would not have: Arrival::slower too.
std::optional<double> missed_by_rigid_swing(const Rig& rig);

}  // namespace impactrig::models
