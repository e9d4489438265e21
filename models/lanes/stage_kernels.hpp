// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "models/lanes/lane_math.hpp"
#include "models/lanes/stage_lanes.hpp"

namespace impactrig::models {
namespace {

/// map_stages() for N stages of S at a time.
template <int N, int S>
void map_stages_by(const StagesByMap& stages) {
  using M = LaneMath<N>;
  using Real = typename M::Real;
  constexpr int parts = S / N;
  Real map[S][parts], ramp[parts] = {};
  for (int j = 0; j < S; ++j)
    for (int p = 0; p < parts; ++p) map[j][p] = M::load(stages.map + S * j + N * p);
  for (int p = 0; stages.ramp && p < parts; ++p) ramp[p] = M::load(stages.ramp + N * p);
  for (int k = 0; k < stages.columns; ++k) {
    const double* in = stages.in + S * k;
    const double offset = stages.offset ? stages.offset[k] : 0.0;
    Real sum[parts];
    for (int p = 0; p < parts; ++p) sum[p] = M::all(offset);
    if (stages.ramp)
      for (int p = 0; p < parts; ++p) sum[p] += stages.slope[k] * ramp[p];
    for (int j = 0; j < S; ++j)
      for (int p = 0; p < parts; ++p) sum[p] += in[j] * map[j][p];
    for (int p = 0; p < parts; ++p) M::store(sum[p], stages.out + S * k + N * p);
  }
}

/// turn_stages() likewise.
template <int N, int S>
void turn_stages_by(const TurnedStages& stages) {
  using M = LaneMath<N>;
  using Real = typename M::Real;
  for (int lane = 0; lane < S; lane += N) {
    const Real cosine = M::load(stages.cosine + lane), sine = M::load(stages.sine + lane);
    for (int p = 0; p < stages.pairs; ++p) {
      double* const first = stages.columns + S * stages.first[p] + lane;
      double* const second = stages.columns + S * stages.second[p] + lane;
      const Real x = M::load(first), y = M::load(second);
      M::store(cosine * x + sine * y, first);
      M::store(cosine * y - sine * x, second);
    }
  }
}

/// find_residual() likewise.
template <int N, int S>
class AncfForces {
 public:
  explicit AncfForces(const AncfResidual& residual) : chain_(residual) {}

  void find() const {
    for (int lane = 0; lane < S; lane += N) find(lane);
  }

 private:
  using M = LaneMath<N>;
  using Real = typename M::Real;

  /// Value and slope of a node across the bar, then along it.
  struct Nodal {
    Real of[4];
  };

  static Nodal load(const double* from, int node, int lane) {
    Nodal nodal;
    for (int c = 0; c < 4; ++c) nodal.of[c] = M::load(from + S * (4 * node + c) + lane);
    return nodal;
  }

  /// What a node's own acceleration, and that of a neighbour, take.
  static void add_inertia(const AncfNode& node, const Nodal& a, Nodal& sum) {
    for (int d = 0; d < 2; ++d)
      for (int r = 0; r < 2; ++r)
        sum.of[2 * d + r] += node.own[d][r][0] * a.of[2 * d] + node.own[d][r][1] * a.of[2 * d + 1];
  }

  static void couple(const AncfNode& node, const Nodal& a, const Nodal& a_next, Nodal& sum,
                     Nodal& sum_next) {
    for (int d = 0; d < 2; ++d)
      for (int r = 0; r < 2; ++r) {
        sum.of[2 * d + r] +=
            node.next[d][r][0] * a_next.of[2 * d] + node.next[d][r][1] * a_next.of[2 * d + 1];
        sum_next.of[2 * d + r] +=
            node.next[d][0][r] * a.of[2 * d] + node.next[d][1][r] * a.of[2 * d + 1];
      }
  }

  /// Internal forces of an element, on its two nodes.
  void add_forces(const AncfNumbers& element, const Nodal& q, const Nodal& q_next, Nodal& sum,
                  Nodal& sum_next) const {
    const double over = element.over_length;
    Real chord[2], pull[2], moment0[2], moment1[2];
    for (int d = 0; d < 2; ++d) {
      chord[d] = (q_next.of[2 * d] - q.of[2 * d]) * over;
      // end rotations against the chord
      const Real bent0 = q.of[2 * d + 1] - chord[d], bent1 = q_next.of[2 * d + 1] - chord[d];
      moment0[d] = element.bending * (4.0 * bent0 + 2.0 * bent1);
      moment1[d] = element.bending * (2.0 * bent0 + 4.0 * bent1);
      pull[d] = -(moment0[d] + moment1[d]);
    }
    for (int g = 0; g < 5; ++g) {
      const AncfGaussPoint& at = chain_.gauss[g];
      Real slope[2];
      for (int d = 0; d < 2; ++d)
        slope[d] =
            at.chord * chord[d] + at.first * q.of[2 * d + 1] + at.second * q_next.of[2 * d + 1];
      const Real strain = 0.5 * (slope[0] * slope[0] + slope[1] * slope[1]) - slope[1];
      const Real tension = (element.stretching * at.weight) * strain;
      const Real along[2] = {tension * slope[0], tension * (slope[1] - 1.0)};
      for (int d = 0; d < 2; ++d) {
        pull[d] += at.chord * along[d];
        moment0[d] += at.first * along[d];
        moment1[d] += at.second * along[d];
      }
    }
    for (int d = 0; d < 2; ++d) {
      sum.of[2 * d] -= pull[d] * over;
      sum.of[2 * d + 1] += moment0[d];
      sum_next.of[2 * d] += pull[d] * over;
      sum_next.of[2 * d + 1] += moment1[d];
    }
  }

  static Nodal weight_off(const AncfNode& node) {
    Nodal sum;
    for (int c = 0; c < 4; ++c) sum.of[c] = M::all(-node.weight[c]);
    return sum;
  }

  void store(const Nodal& sum, int node, int lane) const {
    for (int c = 0; c < 4; ++c) M::store(sum.of[c], chain_.residual + S * (4 * node + c) + lane);
  }

  void find(int lane) const {
    Nodal q = load(chain_.q, 0, lane), a = load(chain_.a, 0, lane);
    Nodal sum = weight_off(chain_.node[0]);
    for (int i = 0;; ++i) {
      add_inertia(chain_.node[i], a, sum);
      if (i == chain_.elements) {
        store(sum, i, lane);
        break;
      }
      const Nodal q_next = load(chain_.q, i + 1, lane), a_next = load(chain_.a, i + 1, lane);
      Nodal sum_next = weight_off(chain_.node[i + 1]);
      couple(chain_.node[i], a, a_next, sum, sum_next);
      add_forces(chain_.element[i], q, q_next, sum, sum_next);
      if (i == 0) sum.of[0] = sum.of[2] = Real{};
      store(sum, i, lane);
      q = q_next;
      a = a_next;
      sum = sum_next;
    }
  }

  const AncfResidual& chain_;
};

/// solve_chain(). A complex product of all systems is two of N numbers, [re, im] times the real
/// part and times the imaginary one, where they fit into a register of N = S; else real and
/// imaginary parts are apart.
template <int N, int S>
class ChainSolve {
 public:
  explicit ChainSolve(const FactoredChain& chain) : chain_(chain) {}

  void solve() const {
    Values before[4], own[4];
    load(0, before);
    for (int i = 1; i < chain_.nodes; ++i) {
      const double* const block = chain_.lower + 16 * S * i;
      load(i, own);
      for (int r = 0; r < 4; ++r) {
        Sum sum;
        for (int c = 0; c < 4; ++c) sum.add(block + S * (4 * r + c), before[c]);
        own[r].take_off(sum);
      }
      store(own, i);
      for (int r = 0; r < 4; ++r) before[r] = own[r];
    }
    Values after[4];
    for (int i = chain_.nodes; i-- > 0;) {
      const double* const block = chain_.inverse + 16 * S * i;
      const double* const next = chain_.lower + 16 * S * (i + 1);
      load(i, own);
      for (int r = 0; r < 4; ++r) {
        Sum sum;
        for (int c = 0; c < 4; ++c) sum.add(block + S * (4 * r + c), own[c]);
        Sum coupled;
        if (i + 1 < chain_.nodes)
          for (int c = 0; c < 4; ++c) coupled.add(next + S * (4 * c + r), after[c]);
        Values y;
        y.set(sum);
        y.take_off(coupled);
        y.store(at(4 * i + r));
      }
      load(i, after);
    }
  }

 private:
  static constexpr int K = S / 2;
  using M = LaneMath<N>;
  using Real = typename M::Real;

  double* at(int coordinate) const { return chain_.x + S * coordinate; }

  /// Real and imaginary parts apart, N of K systems at a time.
  struct Apart {
    static constexpr int parts = K < N ? 1 : K / N;

    struct Values {
      Real re[parts], im[parts];

      void load(const double* x) {
        for (int p = 0; p < parts; ++p) {
          re[p] = M::load(x + N * p);
          im[p] = M::load(x + K + N * p);
        }
      }

      void store(double* x) const {
        for (int p = 0; p < parts; ++p) {
          M::store(re[p], x + N * p);
          M::store(im[p], x + K + N * p);
        }
      }

      void set(const Apart& sum) {
        for (int p = 0; p < parts; ++p) {
          re[p] = sum.re[p];
          im[p] = sum.im[p];
        }
      }

      void take_off(const Apart& sum) {
        for (int p = 0; p < parts; ++p) {
          re[p] -= sum.re[p];
          im[p] -= sum.im[p];
        }
      }
    };

    Real re[parts] = {}, im[parts] = {};

    void add(const double* a, const Values& b) {
      for (int p = 0; p < parts; ++p) {
        const Real a_re = M::load(a + N * p), a_im = M::load(a + K + N * p);
        re[p] += a_re * b.re[p];
        re[p] -= a_im * b.im[p];
        im[p] += a_re * b.im[p];
        im[p] += a_im * b.re[p];
      }
    }
  };

  /// All in one register.
  struct Together {
    struct Values {
      Real both;

      void load(const double* x) { both = M::load(x); }

      void store(double* x) const { M::store(both, x); }

      void set(const Together& sum) { both = sum.total(); }

      void take_off(const Together& sum) { both -= sum.total(); }
    };

    Real by_re = Real{}, by_im = Real{};

    void add(const double* a, const Values& b) {
      by_re += M::twice(a) * b.both;
      by_im += M::twice(a + K) * b.both;
    }

    /// i (re + i im) is [-im, re].
    Real total() const {
      Real signs = M::all(1.0);
      for (int lane = 0; lane < K; ++lane) signs[lane] = -1.0;
      return by_re + signs * M::template turned<K>(by_im);
    }
  };

  using Sum = std::conditional_t<N == S, Together, Apart>;
  using Values = typename Sum::Values;

  void load(int node, Values (&values)[4]) const {
    for (int c = 0; c < 4; ++c) values[c].load(at(4 * node + c));
  }

  void store(const Values (&values)[4], int node) const {
    for (int c = 0; c < 4; ++c) values[c].store(at(4 * node + c));
  }

  const FactoredChain& chain_;
};

/// The widest registers that S stages fill.
template <int N, int S>
inline constexpr int lanes_of = N < S ? N : S;

template <int N>
void map_stages_in(const StagesByMap& stages) {
  if (stages.stages == 4) map_stages_by<lanes_of<N, 4>, 4>(stages);
  if (stages.stages == 8) map_stages_by<lanes_of<N, 8>, 8>(stages);
}

template <int N>
void turn_stages_in(const TurnedStages& stages) {
  if (stages.stages == 4) turn_stages_by<lanes_of<N, 4>, 4>(stages);
  if (stages.stages == 8) turn_stages_by<lanes_of<N, 8>, 8>(stages);
}

template <int N>
void find_residual_in(const AncfResidual& residual) {
  if (residual.stages == 4) AncfForces<lanes_of<N, 4>, 4>(residual).find();
  if (residual.stages == 8) AncfForces<lanes_of<N, 8>, 8>(residual).find();
}

template <int N>
void solve_chain_in(const FactoredChain& chain) {
  if (chain.stages == 4) ChainSolve<lanes_of<N, 4>, 4>(chain).solve();
  if (chain.stages == 8) ChainSolve<lanes_of<N, 8>, 8>(chain).solve();
}

}  // namespace
}  // namespace impactrig::models
