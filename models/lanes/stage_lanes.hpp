// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::models {

// What a step of the full equations does with the values of its stages, 4 or 8 of them: a column of
// S numbers for each coordinate of a chain, as of StageArray. These use what the processor has.

/// out_k = map in_k + ramp slope_k + offset_k, for each of n columns.
struct StagesByMap {
  int stages = 0, columns = 0;     ///< S, n
  const double *map = nullptr;     ///< by columns (S, S)
  const double *in = nullptr;      ///< (S, n)
  const double *ramp = nullptr;    ///< (S); none: without what follows
  const double *slope = nullptr;   ///< (n)
  const double *offset = nullptr;  ///< (n); none: 0
  double *out = nullptr;           ///< (S, n); may be `in`
};

/// Turns pairs of columns, stage by stage: (x, y) becomes (c x + s y, c y - s x).
struct TurnedStages {
  int stages = 0, pairs = 0;                        ///< S, p
  const int *first = nullptr, *second = nullptr;    ///< columns (p)
  const double *cosine = nullptr, *sine = nullptr;  ///< (S)
  double *columns = nullptr;                        ///< (S, n)
};

/// An element of an AncfChain.
struct AncfNumbers {
  double over_length = 0.0;  ///< 1 / l [1/m]
  double stretching = 0.0;   ///< EA l [N m]
  double bending = 0.0;      ///< EI / l [N m]
};

/// A node of an AncfChain, across the bar and along it: its mass matrix, and what couples it to the
/// next, (value, slope) by rows; the weight on its four coordinates.
struct AncfNode {
  double own[2][2][2] = {}, next[2][2][2] = {};
  double weight[4] = {};
};

/// Shares of an element's chord and end slopes in its slope at a Gauss point.
struct AncfGaussPoint {
  double chord = 0.0, first = 0.0, second = 0.0, weight = 0.0;
};

/// M a + internal forces - weight of an AncfChain, the hinge's spring apart; zero for the hinge's
/// own two displacements.
struct AncfResidual {
  int stages = 0, elements = 0;
  const AncfNumbers *element = nullptr;     ///< (elements)
  const AncfNode *node = nullptr;           ///< (elements + 1)
  const AncfGaussPoint *gauss = nullptr;    ///< (5)
  const double *q = nullptr, *a = nullptr;  ///< (S, 4 nodes)
  double *residual = nullptr;               ///< likewise
};

/// The S / 2 complex systems of a BlockTridiagonal, factored: blocks of four by four complex
/// numbers by rows, each S / 2 real parts and as many imaginary ones.
struct FactoredChain {
  int stages = 0, nodes = 0;
  const double *inverse = nullptr, *lower = nullptr;  ///< (nodes) blocks
  double *x = nullptr;                                ///< (S, 4 nodes), likewise; solved in place
};

void map_stages(const StagesByMap &stages);
void turn_stages(const TurnedStages &stages);
void find_residual(const AncfResidual &residual);
void solve_chain(const FactoredChain &chain);

}  // namespace impactrig::models
