// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::models {

// What ThirdOrder does with the stations of a bar, a few at a time. These use what the processor
// has.

/// Slopes of n stations and their rates, from m modes.
struct SlopesOfModes {
  int stations = 0, modes = 0;
  const double *slopes = nullptr;                  ///< of the modes, by columns (n, m)
  const double *a = nullptr, *rate = nullptr;      ///< (m)
  double *slope = nullptr, *slope_rate = nullptr;  ///< (n)
};

/// What pulls at the stations' slopes does to the modes: the sum of each mode's own.
struct PullOnModes {
  int stations = 0, modes = 0;
  const double *slopes = nullptr;  ///< of the modes, by columns (n, m)
  const double *pull = nullptr;    ///< (n)
  double *force = nullptr;         ///< (m)
};

/// What pull along the bar and its bending do to the slopes of n stations to third order: the
/// first two lines of Q of ThirdOrder but for the modes' own shapes, uneven stretch and damping.
struct ThirdOrderPull {
  int stations = 0;
  const double *length = nullptr, *weight = nullptr, *strain = nullptr;  ///< (n)
  const double *bending = nullptr;                                       ///< (n - 1)
  const double *slope_before = nullptr, *slope_after = nullptr;          ///< (n)
  const double *momentum_before = nullptr, *momentum_after = nullptr;    ///< further out (n)
  double h = 0.0;                                                        ///< [s]
  bool floats = false;                       ///< whether the bar bends in a frame of its own
  double frame = 0.0;                        ///< that frame's angle [rad]
  double *slope = nullptr, *pull = nullptr;  ///< mean over the step, and what pulls at it (n)
  double of_frame = 0.0;                     ///< what pulls at the frame
};

void find_slopes(const SlopesOfModes &modes);
void find_force_of_pull(const PullOnModes &modes);
void find_third_order_pull(ThirdOrderPull &stations);

}  // namespace impactrig::models
