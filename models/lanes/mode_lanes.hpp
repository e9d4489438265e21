// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::models {

/// The motion of modes over a time h under a force given by its Legendre series over h.
struct ModesUnderForce {
  int modes = 0, terms = 0;                          ///< m; of the series, 16 at most
  const double *omega = nullptr, *struck = nullptr;  ///< as of ModalBeam (m)
  const double *damping = nullptr;                   ///< likewise; none: undamped (m)
  double h = 0.0;                                    ///< [s]
  const double *series = nullptr;                    ///< [N] (terms); none: no force
  const double *a = nullptr, *rate = nullptr;        ///< before (m)
  double *end_a = nullptr, *end_rate = nullptr;      ///< after (m)

  /// Of the struck point, after; the acceleration without what the force then does to it.
  double displacement = 0.0, velocity = 0.0, acceleration = 0.0;
};

/// What a step of length h does to modes: the rows and matrices of ModalStep.
struct ModesOverStep {
  static constexpr int most_terms = 256;

  int modes = 0, nodes = 0;                              ///< m, s
  const double *omega = nullptr, *struck = nullptr;      ///< as of ModalBeam (m)
  const double *damping = nullptr;                       ///< likewise; none: undamped (m)
  const double *seen = nullptr;                          ///< likewise of the kernels' point (m)
  double h = 0.0;                                        ///< [s]
  const double *points = nullptr, *to_series = nullptr;  ///< of the rule (s), (s, s)
  /// (s, m), by columns.
  double *displacement_of_a, *displacement_of_rate, *velocity_of_a, *velocity_of_rate;
  double *a_of_force, *rate_of_force;
  double *a_of_a, *a_of_rate, *rate_of_a, *rate_of_rate;  ///< (m)

  int terms = 0;  ///< of the kernels' series, most_terms at most
  /// Legendre series of Σ r s sin(ωτ) / ω and Σ r s cos(ωτ) over the step, r the struck point, s
  /// the one that is seen, with the sign of a force that presses back (terms); with damping of what
  /// then stands for them.
  double *displacement_kernel, *velocity_kernel;
  /// With damping, of the seen point at the nodes (s) under each polynomial of the force's series
  /// over the step (s): what the series leave out of those modes that start early (ModeKernel), over
  /// h; by columns.
  double *early_displacement = nullptr, *early_velocity = nullptr;
};

/// Duhamel's integral, several undamped modes at a time. These use what the processor has.
void advance_modes(ModesUnderForce &modes);
void step_modes(const ModesOverStep &modes);

}  // namespace impactrig::models
