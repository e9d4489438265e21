// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/lanes/lane_math.hpp"
#include "models/lanes/step_lanes.hpp"

namespace impactrig::models {
namespace {

/// solve_steps() for N lanes of bars at S nodes.
template <int N, int S>
class StepSolver {
 public:
  StepSolver(StepLanes& lanes, int first) : lanes_(lanes), first_(first) {}

  void solve() {
    load();
    coast();
    if (M::any(pressed_)) find_force();
    finish();
  }

 private:
  using M = LaneMath<N>;
  using Real = typename M::Real;
  using Mask = typename M::Mask;
  static constexpr int most_iterations = 12;

  Real& at(LaneRow& row) { return M::at(row.at + first_); }

  /// What the elastic law says of a penetration, continued as an odd function.
  struct Law {
    Real force, stiffness;
  };

  void load() {
    pressed_ = at(lanes_.pressed) != 0.0;
    slack_ = at(lanes_.slack) != 0.0;
    mu_ = at(lanes_.mu);
    linear_ = at(lanes_.compliance) == 0.0;
    compliance_ = linear_ ? M::all(1.0) : at(lanes_.compliance);
    limit_force_ = linear_ ? M::all(1.0) : at(lanes_.limit_force);
    limit_ = compliance_ * 0.9 * limit_force_ * limit_bracket;
    for (int i = 0; i < S; ++i) force_[i] = at(lanes_.force[i]);
    failed_ = Mask{};
    at(lanes_.iterations) = Real{};
  }

  /// The struck point under the guessed force too.
  void coast() {
    for (int i = 0; i < S; ++i) {
      x_[i] = at(lanes_.displacement[i]);
      v_[i] = at(lanes_.velocity[i]);
    }
    respond(force_);
  }

  void respond(const Real* change) {
    for (int j = 0; j < S; ++j)
      for (int i = 0; i < S; ++i) {
        x_[i] += at(lanes_.displacement_of_force[j * S + i]) * change[j];
        v_[i] += at(lanes_.velocity_of_force[j * S + i]) * change[j];
      }
  }

  /// u − ln u = 1 − ln y, u > 1, by an iteration of fourth order [FritschEtAl1973]; see Goldsmith.
  Real bracket(Real log_y, Mask wanted) {
    Real u = 1.0 - log_y + M::log(1.0 - log_y);
    for (int i = 0; i < 20; ++i) {
      const Real z = log_y - 1.0 - M::log(u) + u;
      const Real near = 1.0 - u;
      const Real q = 2.0 * near * (near + z * (2.0 / 3.0));
      const Real part = z / near * (q - z) / (q - 2.0 * z);
      u = wanted ? u + u * part : u;
      // the next change would be of the fourth power of this one
      wanted &= M::magnitude(part) > 5e-4 * M::smaller(M::all(1.0), near * near);
      if (!M::any(wanted)) break;
    }
    return u;
  }

  Law law(Real penetration) {
    const Real depth = M::larger(M::magnitude(penetration), M::all(1e-290));
    const Mask inside = depth <= limit_;
    const Real used = inside ? depth : limit_;
    const Real u = bracket(M::log(used / (compliance_ * limit_force_)), pressed_ | slack_);
    const Real stiffness = 1.0 / (compliance_ * (u - 1.0));
    const Real size = used / (compliance_ * u) + (depth - used) * stiffness;
    const Real spring = at(lanes_.spring);
    return {M::with_sign(linear_ ? spring * depth : size, penetration),
            linear_ ? spring : stiffness};
  }

  void find_force() {
    Real residual[S], jacobian[S][S], steepness[S], mixed[S], change[S];
    Mask active = pressed_;
    for (int iteration = 0; iteration < most_iterations && M::any(active); ++iteration) {
      for (int i = 0; i < S; ++i) {
        const Law here = law(x_[i]);
        const Real pull = 1.0 + mu_ * v_[i];
        const Real to_depth = here.stiffness * pull, to_rate = here.force * mu_;
        steepness[i] = M::magnitude(to_depth);
        mixed[i] = M::magnitude(here.stiffness * mu_);
        elastic_[i] = active ? here.force - here.stiffness * x_[i] : elastic_[i];
        stiffness_[i] = active ? here.stiffness : stiffness_[i];
        at(lanes_.to_depth[i]) = active ? to_depth : at(lanes_.to_depth[i]);
        at(lanes_.to_rate[i]) = active ? to_rate : at(lanes_.to_rate[i]);
        residual[i] = force_[i] - here.force * pull;
        for (int j = 0; j < S; ++j)
          jacobian[i][j] = -to_depth * at(lanes_.displacement_of_force[j * S + i]) -
                           to_rate * at(lanes_.velocity_of_force[j * S + i]);
        jacobian[i][i] += 1.0;
      }
      eliminate(jacobian, residual);
      for (int i = 0; i < S; ++i) change[i] = active ? -residual[i] : Real{};
      at(lanes_.iterations) += active ? M::all(1.0) : Real{};
      const Real left = move(change, steepness, mixed);
      failed_ |= active & (left * 0.0 != 0.0);  // not finite
      active &= left > at(lanes_.tolerance);
      active &= ~failed_;
    }
    failed_ |= active;
  }

  /// Changes the force and moves the struck point with it; what the law's curvature leaves of that,
  /// as CollocationRun estimates it.
  Real move(const Real* change, const Real* steepness, const Real* mixed) {
    Real from[S], at_rate[S];
    for (int i = 0; i < S; ++i) {
      force_[i] += change[i];
      from[i] = x_[i];
      at_rate[i] = v_[i];
    }
    respond(change);
    Real left = Real{};
    for (int i = 0; i < S; ++i) {
      const Real deeper = M::magnitude(x_[i] - from[i]);
      const Real faster = M::magnitude(v_[i] - at_rate[i]);
      const Real part =
          deeper * (steepness[i] * deeper / M::magnitude(from[i]) + mixed[i] * faster);
      left = M::larger(part, left) + 0.0 * part;  // not a number where one of them is not
    }
    return left;
  }

  /// Gauss's elimination without pivoting: the matrix is the identity and what a stiff spring adds
  /// along the step. Where that does not do, Newton's method does not end and the lane says so.
  static void eliminate(Real (&matrix)[S][S], Real (&side)[S]) {
    for (int k = 0; k < S; ++k) {
      const Real inverse = 1.0 / matrix[k][k];
      for (int i = k + 1; i < S; ++i) {
        const Real factor = matrix[i][k] * inverse;
        for (int j = k + 1; j < S; ++j) matrix[i][j] -= factor * matrix[k][j];
        side[i] -= factor * side[k];
      }
      matrix[k][k] = inverse;
    }
    for (int k = S; k-- > 0;) {
      Real sum = side[k];
      for (int j = k + 1; j < S; ++j) sum -= matrix[k][j] * side[j];
      side[k] = sum * matrix[k][k];
    }
  }

  void finish() {
    const bool slack = M::any(slack_);
    for (int i = 0; i < S; ++i) {
      // the law along its tangent: Newton's last change was small
      Real loss = pressed_ ? (elastic_[i] + stiffness_[i] * x_[i]) * mu_ * v_[i] * v_[i] : Real{};
      if (slack) loss = slack_ ? -law(x_[i]).force * v_[i] : loss;
      loss_[i] = loss;
      at(lanes_.force[i]) = force_[i];
      at(lanes_.displacement[i]) = x_[i];
      at(lanes_.velocity[i]) = v_[i];
      at(lanes_.dissipation[i]) = loss;
    }
    to_series(force_, lanes_.force_series);
    to_series(x_, lanes_.displacement_series);
    to_series(loss_, lanes_.dissipation_series);
    at(lanes_.solved) = failed_ ? Real{} : M::all(1.0);
  }

  void to_series(const Real* values, LaneRow* series) {
    for (int p = 0; p < S; ++p) {
      Real sum = Real{};
      for (int i = 0; i < S; ++i) sum += lanes_.to_series[i * S + p] * values[i];
      at(series[p]) = sum;
    }
  }

  static constexpr double limit_bracket = 1.10536051565782628123;  // 1 − ln 0.9

  StepLanes& lanes_;
  int first_;
  Mask pressed_, slack_, linear_, failed_;
  Real mu_, compliance_, limit_force_, limit_;
  Real force_[S], x_[S], v_[S], loss_[S];
  Real elastic_[S] = {}, stiffness_[S] = {};  // the law's tangent
};

template <int N>
void solve_steps_by(StepLanes& lanes) {
  for (int first = 0; first < lane_count; first += N) {
    if (lanes.nodes == 6) StepSolver<N, 6>(lanes, first).solve();
    if (lanes.nodes == 8) StepSolver<N, 8>(lanes, first).solve();
  }
}

}  // namespace
}  // namespace impactrig::models
