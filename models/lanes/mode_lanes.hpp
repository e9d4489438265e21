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
  double *of_a, *of_rate;              ///< as of PointAtNodes, for the struck point
  double *a_of_force, *rate_of_force;  ///< as of ModesAtEnd
  double *a_of_a, *a_of_rate, *rate_of_a, *rate_of_rate;  ///< likewise

  int terms = 0;  ///< of the kernels' series, most_terms at most
  /// Legendre series of Σ r s sin(ωτ) / ω and Σ r s cos(ωτ) over the step, r the struck point, s
  /// the one that is seen, with the sign of a force that presses back (terms); with damping of what
  /// then stands for them.
  double *displacement_kernel, *velocity_kernel;
  /// With damping, of the seen point at the nodes (s) under each polynomial of the force's series
  /// over the step (s): what the series leave out of those modes that start early (ModeKernel),
  /// over h; by columns.
  double *early_displacement = nullptr, *early_velocity = nullptr;
};

/// A point at the nodes of a step under the state at its beginning.
struct PointAtNodes {
  int modes = 0, rows = 0;                           ///< m; 2 s: displacements, then velocities
  const double *of_a = nullptr, *of_rate = nullptr;  ///< by columns (2 s, m)
  const double *a = nullptr, *rate = nullptr;        ///< (m)
  double *motion = nullptr;                          ///< (2 s)
};

/// Modes at the end of a step, free or under a force at its nodes.
struct ModesAtEnd {
  int modes = 0, nodes = 0;                                      ///< m, s
  const double *a_of_a = nullptr, *a_of_rate = nullptr;          ///< (m)
  const double *rate_of_a = nullptr, *rate_of_rate = nullptr;    ///< (m)
  const double *a_of_force = nullptr, *rate_of_force = nullptr;  ///< by columns (m, s)
  const double *a = nullptr, *rate = nullptr;                    ///< before (m)
  const double *force = nullptr;                                 ///< [N] (s); none: free
  double *end_a = nullptr, *end_rate = nullptr;                  ///< after (m)
};

/// A Legendre series over [0, 1] at the nodes of a part of it.
struct SeriesAtNodes {
  int terms = 0, nodes = 0;
  const double *series = nullptr;    ///< (terms)
  const double *points = nullptr;    ///< of the nodes, in [0, 1] of the part (nodes)
  double begin = 0.0, length = 1.0;  ///< of the part
  double *values = nullptr;          ///< (nodes)
};

/// Arrays of numbers, weighted and summed.
struct WeightedSum {
  int count = 0, terms = 0;               ///< n; of the sum, 1 at least
  const double *const *arrays = nullptr;  ///< (terms), each (n)
  const double *weights = nullptr;        ///< (terms)
  const double *factors = nullptr;        ///< of the sum's numbers (n); none: 1
  double *sum = nullptr;                  ///< (n)
};

void find_sum(const WeightedSum &sum);
void find_values(const SeriesAtNodes &series);
void find_at_nodes(const PointAtNodes &point);
void find_at_end(const ModesAtEnd &modes);

/// Duhamel's integral, several undamped modes at a time. These use what the processor has.
void advance_modes(ModesUnderForce &modes);
void step_modes(const ModesOverStep &modes);

}  // namespace impactrig::models
