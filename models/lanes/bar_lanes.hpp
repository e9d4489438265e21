// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::models {

/// A bar of elements from hinge to tip, as quadratic forms of each in its own values: deflection
/// and rotation u (2) of its left end, which the hinge holds and lets turn, what its right end
/// deflects and turns beyond them as a rigid rod would, e (2), and its values inside (0 or 3). A
/// right end is R u + e, R = [1 l; 0 1]. So written a rigid motion bends nothing, and a fine mesh
/// costs no digits. Lower triangles, row by row.
struct BarForms {
  int elements = 0, values = 4;  ///< N; v, 4 or 7
  const double* length;          ///< l [m] (N)
  /// Of bending waves over ω^½: phase from the hinge to each right end, and its rate (N).
  const double *wave, *wave_number;
  const double* stiffness;  ///< A: elastic and of the weight (N, v (v + 1) / 2)
  const double* mass;       ///< M (N, v (v + 1) / 2)
  double spring = 0.0;      ///< of the hinge
  bool clamped = false;     ///< the hinge does not turn

  int numbers() const { return values * (values + 1) / 2; }
};

/// How many ω² of the bar are below each shift: by how many pivots of A − σ M are negative.
struct BarShifts {
  const BarForms* bar;
  int shifts = 0;
  const double* shift;  ///< σ (shifts)
  double* below;        ///< (shifts)
};

/// Modes of the bar, each alone between two numbers, by inverse iteration with Rayleigh's quotient
/// as the shift, within what is known of each [Parlett1998, 4.6 and 4.9].
struct BarModesBetween {
  const BarForms* bar;
  int modes = 0;                        ///< m
  const double* index;                  ///< how many modes are slower (m)
  const double *above, *start, *below;  ///< of ω²: (m)
  double* work;                         ///< bar_work()
  double* square;                       ///< ω² (m)
  double* converged;                    ///< 0 where it did not (m)
  /// Of unit modal mass: the rotation at the hinge (m); u and the values inside after each element,
  /// (N, v − 2) places of m numbers.
  double *turn, *shape;
  int stride = 0;  ///< from one place to the next
};

/// How the bar gives way to loads with a shift that is no mode's: (A − σ M) x = b.
struct BarUnderLoads {
  const BarForms* bar;
  int loads = 0;          ///< m
  double shift = 0.0;     ///< σ
  const double* load;     ///< b, in the elements' values; (N, v) by m
  double* work;           ///< bar_work()
  double *turn, *motion;  ///< as `turn` and `shape` of BarModesBetween
  int stride = 0;         ///< likewise
};

/// How many numbers these need to work with.
int bar_work(const BarForms& bar);

/// Several shifts, modes or loads at a time; what is found of one does not depend on the others.
/// These use what the processor has.
void count_modes_below(const BarShifts& shifts);
void find_modes_between(const BarModesBetween& modes);
void find_motion_under(const BarUnderLoads& loads);

}  // namespace impactrig::models
