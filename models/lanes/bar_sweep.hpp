// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/lanes/bar_lanes.hpp"
#include "models/lanes/lane_chunk.hpp"
#include "models/lanes/lane_math.hpp"

namespace impactrig::models {
namespace {

/// A − σ M of a bar of elements with V values each, for N shifts at a time: eliminated from the tip
/// to the hinge, solved from the hinge to the tip.
template <int N, int V>
class BarSweep {
 public:
  using M = LaneMath<N>;
  using Real = typename M::Real;
  static constexpr int numbers = V * (V + 1) / 2;
  static constexpr int factors = numbers - 3;  // of an element: all rows but the first two

  /// What the sweeps leave of an element.
  struct Step {
    Real factor[factors];  // L, rows of what is eliminated without their 1
    Real own[V - 2];       // e and inside: first what loads leave of them, then what they are
    Real load[V];
  };

  /// What a first solution keeps, and leaves of an element's loads.
  struct Rest {
    Real own[V - 2], load[V];
  };

  /// `work`: from bar_work(); none where nothing is loaded.
  BarSweep(const BarForms& bar, double* work)
      : bar_(bar),
        steps_(aligned(work)),
        rests_(work ? reinterpret_cast<Rest*>(steps_ + bar.elements) : nullptr) {}

  /// Eliminates all but the hinge's rotation; tells how many pivots are negative.
  template <bool Loaded>
  Real eliminate(Real shift, Real scale) {
    Real below = Real{};
    Real tail[3] = {Real{}, Real{}, Real{}}, pull[2] = {Real{}, Real{}};
    for (int e = bar_.elements; e-- > 0;) {
      const double l = bar_.length[e];
      const double* stiffness = bar_.stiffness + e * numbers;
      const double* mass = bar_.mass + e * numbers;
      Real a[numbers], f[V];
      for (int i = 0; i < numbers; ++i) a[i] = stiffness[i] - shift * mass[i];
      const Real moment = l * tail[0] + tail[1];
      a[0] += tail[0];
      a[1] += moment;
      a[2] += l * (moment + tail[1]) + tail[2];
      a[3] += tail[0];
      a[4] += moment;
      a[5] += tail[0];
      a[6] += tail[1];
      a[7] += l * tail[1] + tail[2];
      a[8] += tail[1];
      a[9] += tail[2];
      if constexpr (Loaded) {
        const Real* const load = corrected_ ? rests_[e].load : steps_[e].load;
        for (int i = 0; i < V; ++i) f[i] = scale * load[i];
        f[0] += pull[0];
        f[1] += l * pull[0] + pull[1];
        f[2] += pull[0];
        f[3] += pull[1];
      }
      for (int k = V - 1; k >= 2; --k) {
        Real* const row = a + k * (k + 1) / 2;
        const Real pivot = away_from_zero(row[k]);
        below += pivot < 0.0 ? M::all(1.0) : Real{};
        const Real over = 1.0 / pivot;
        Real factor[V];
        for (int i = 0; i < k; ++i) factor[i] = row[i] * over;
        for (int i = 0; i < k; ++i)
          for (int j = 0; j <= i; ++j) a[i * (i + 1) / 2 + j] -= factor[i] * row[j];
        if constexpr (Loaded) {
          for (int i = 0; i < k; ++i) {
            f[i] -= factor[i] * f[k];
            steps_[e].factor[k * (k + 1) / 2 - 3 + i] = factor[i];
          }
          steps_[e].own[k - 2] = f[k] * over;
        }
      }
      for (int i = 0; i < 3; ++i) tail[i] = a[i];
      if constexpr (Loaded) {
        pull[0] = f[0];
        pull[1] = f[1];
      }
    }
    turn_ = Real{};
    if (bar_.clamped) return below;
    const Real pivot = away_from_zero(tail[2] + bar_.spring);
    if constexpr (Loaded) turn_ = pull[1] / pivot;
    return below + (pivot < 0.0 ? M::all(1.0) : Real{});
  }

  /// After eliminate<true>(): by what the solution leaves of the loads, where `mask` is one, it is
  /// mended [Higham2002, 12.1]. A part of the bar from the tip on that vibrates as fast by itself,
  /// clamped, as the shift says costs elimination as many digits as the two agree to.
  void correct(Real shift, Real scale, Real mask) {
    Real left[2] = {Real{}, turn_};
    for (int e = 0; e < bar_.elements; ++e) {
      Rest& rest = rests_[e];
      Real x[V];
      find_values(steps_[e], left, x);
      for (int i = 0; i < V; ++i) {
        rest.load[i] = scale * steps_[e].load[i];
        for (int j = 0; j < V; ++j) {
          const int at = e * numbers + (i > j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i);
          rest.load[i] -= (bar_.stiffness[at] - shift * bar_.mass[at]) * x[j];
        }
      }
      if (e == 0) rest.load[1] -= bar_.spring * turn_;
      for (Real& left_over : rest.load) left_over *= mask;
      for (int i = 2; i < V; ++i) rest.own[i - 2] = x[i];
      pass(e, x, left);
    }
    first_turn_ = turn_;
    corrected_ = true;
    eliminate<true>(shift, M::all(1.0));
  }

  /// What the bar does under its loads; what it takes from them and its mass. Its inertia is the
  /// next load.
  void give_way(Real& taken, Real& weight) {
    taken = weight = Real{};
    if (corrected_) add_corrections();
    Real left[2] = {Real{}, turn_};
    for (int e = 0; e < bar_.elements; ++e) {
      Step& step = steps_[e];
      Real x[V] = {left[0], left[1]};
      if (corrected_)
        for (int i = 2; i < V; ++i) x[i] = step.own[i - 2];
      else
        find_values(step, left, x);
      for (int i = 0; i < V; ++i) taken += x[i] * step.load[i];
      weight += find_inertia(e, x, step.load);
      for (int i = 2; i < V; ++i) step.own[i - 2] = x[i];
      pass(e, x, left);
    }
    corrected_ = false;
  }

  /// The inertia of a bending wave of ω² as the load, of a rigid rotation where that is next to
  /// zero; tells what makes its mass one.
  Real wave(Real square) {
    const double longest = 1e-3 / bar_.wave[bar_.elements - 1];
    const Real root = M::larger(M::root(M::root(M::magnitude(square))), M::all(longest));
    Real weight = Real{}, left[2] = {Real{}, Real{}};
    if (!bar_.clamped) left[1] = root * bar_.wave_number[0];
    for (int e = 0; e < bar_.elements; ++e) {
      const auto [sine, cosine] = M::sine_cosine(root * bar_.wave[e]);
      const Real right[2] = {sine, root * bar_.wave_number[e] * cosine};
      Real x[V] = {left[0], left[1], right[0] - left[0] - bar_.length[e] * left[1],
                   right[1] - left[1]};
      for (int i = 4; i < V; ++i) x[i] = Real{};
      weight += find_inertia(e, x, steps_[e].load);
      left[0] = right[0];
      left[1] = right[1];
    }
    return 1.0 / M::root(weight);
  }

  /// After give_way(): A's and M's forms of the motion.
  void measure(Real& stiffness, Real& mass) const {
    mass = Real{};
    stiffness = bar_.spring * turn_ * turn_;
    Real left[2] = {Real{}, turn_};
    for (int e = 0; e < bar_.elements; ++e) {
      const Step& step = steps_[e];
      Real x[V] = {left[0], left[1]};
      for (int i = 2; i < V; ++i) x[i] = step.own[i - 2];
      const double* form = bar_.stiffness + e * numbers;
      for (int i = 0; i < V; ++i) {
        Real force = 0.5 * form[i * (i + 1) / 2 + i] * x[i];
        for (int j = 0; j < i; ++j) force += form[i * (i + 1) / 2 + j] * x[j];
        stiffness += 2.0 * x[i] * force;
        mass += x[i] * step.load[i];
      }
      pass(e, x, left);
    }
  }

  /// Likewise: writes the motion, so many times as large.
  void write(const LaneChunk<N>& chunk, Real scale, int stride, double* turn,
             double* motion) const {
    chunk.store(scale * turn_, turn);
    Real left[2] = {Real{}, turn_};
    for (int e = 0; e < bar_.elements; ++e) {
      Real x[V] = {left[0], left[1]};
      for (int i = 2; i < V; ++i) x[i] = steps_[e].own[i - 2];
      pass(e, x, left);
      double* const to = motion + static_cast<long>(e) * (V - 2) * stride;
      chunk.store(scale * left[0], to);
      chunk.store(scale * left[1], to + stride);
      for (int i = 4; i < V; ++i) chunk.store(scale * x[i], to + (i - 2) * stride);
    }
  }

  Step* steps() { return steps_; }

 private:
  static Step* aligned(double* work) {
    constexpr std::uintptr_t last = alignof(Step) - 1;
    return reinterpret_cast<Step*>((reinterpret_cast<std::uintptr_t>(work) + last) & ~last);
  }

  static Real away_from_zero(Real pivot) {
    constexpr double smallest = 1e-100;  // so that squares are numbers too
    return M::magnitude(pivot) > smallest ? pivot : M::all(smallest);
  }

  /// Tells x M x.
  Real find_inertia(int e, const Real* x, Real* inertia) const {
    const double* mass = bar_.mass + e * numbers;
    Real sum = Real{};
    for (int i = 0; i < V; ++i) {
      inertia[i] = Real{};
      for (int j = 0; j < V; ++j)
        inertia[i] += x[j] * mass[i > j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
      sum += x[i] * inertia[i];
    }
    return sum;
  }

  void add_corrections() {
    Real left[2] = {Real{}, turn_};
    for (int e = 0; e < bar_.elements; ++e) {
      Real x[V];
      find_values(steps_[e], left, x);
      for (int i = 2; i < V; ++i) steps_[e].own[i - 2] = rests_[e].own[i - 2] + x[i];
      pass(e, x, left);
    }
    turn_ += first_turn_;
  }

  void find_values(const Step& step, const Real* left, Real* x) const {
    x[0] = left[0];
    x[1] = left[1];
    for (int k = 2; k < V; ++k) {
      x[k] = step.own[k - 2];
      for (int i = 0; i < k; ++i) x[k] -= step.factor[k * (k + 1) / 2 - 3 + i] * x[i];
    }
  }

  /// To the right end.
  void pass(int e, const Real* x, Real* left) const {
    left[0] += bar_.length[e] * left[1] + x[2];
    left[1] += x[3];
  }

  const BarForms& bar_;
  Step* steps_;
  Rest* rests_;
  Real turn_ = Real{}, first_turn_ = Real{};
  bool corrected_ = false;
};

template <int N, int V>
void count_below(const BarShifts& shifts) {
  for (int first = 0; first < shifts.shifts; first += N) {
    const LaneChunk<N> chunk(first, shifts.shifts);
    using Real = typename BarSweep<N, V>::Real;
    BarSweep<N, V> sweep(*shifts.bar, nullptr);
    chunk.store(sweep.template eliminate<false>(chunk.load(shifts.shift), Real{}), shifts.below);
  }
}

template <int N, int V>
class ModesBetween {
 public:
  explicit ModesBetween(const BarModesBetween& modes)
      : modes_(modes),
        sweep_(*modes.bar, modes.work) {}

  void find() {
    for (int first = 0; first < modes_.modes; first += N) {
      const LaneChunk<N> chunk(first, modes_.modes);
      find(chunk);
    }
  }

 private:
  using Sweep = BarSweep<N, V>;
  using M = typename Sweep::M;
  using Real = typename Sweep::Real;
  static constexpr int most_passes = 60;
  // How near the shift was, of the distance to the next mode or, where that is next to nothing, of
  // ω² itself: the next pass would change the shape by its square.
  static constexpr double small = 1e-10, rounding = 1e-11;

  /// Lanes without a mode of their own do what the first does.
  static Real load(const LaneChunk<N>& chunk, const double* values) {
    Real lanes = chunk.load(values);
    for (int i = chunk.count; i < N; ++i) lanes[i] = lanes[0];
    return lanes;
  }

  void find(const LaneChunk<N>& chunk) {
    const Real index = load(chunk, modes_.index), start = load(chunk, modes_.start);
    const Real above = load(chunk, modes_.above), below = load(chunk, modes_.below);
    Real low = above, high = below, shift = start, next = start, done = Real{};
    Real scale = sweep_.wave(start);
    for (int pass = 0; pass < most_passes; ++pass) {
      const Real slower = sweep_.template eliminate<true>(shift, scale);
      Real taken, weight;
      sweep_.give_way(taken, weight);
      next = shift + scale * taken / weight;
      scale = 1.0 / M::root(weight);
      // the slowest has none below, and may be zero
      const Real room = index > 0.0 ? M::smaller(next - above, below - next) : below - next;
      const Real near = M::larger(small * room, rounding * M::magnitude(next));
      done = scale <= near ? M::all(1.0) : done;
      if (!M::any(done < 1.0)) break;
      low = slower > index ? low : M::larger(low, shift);
      high = slower > index ? M::smaller(high, shift) : high;
      const typename M::Mask inside = (low < next) & (next < high);
      const Real other = inside ? next : 0.5 * (low + high);
      shift = done > 0.0 ? shift : other;
    }
    if (M::any(done < 1.0)) stay_apart(above, below, shift, next, scale, done);
    Real stiffness, mass;
    sweep_.measure(stiffness, mass);
    chunk.store(stiffness / mass, modes_.square);
    chunk.store(done, modes_.converged);
    sweep_.write(chunk, 1.0 / M::root(mass), modes_.stride, modes_.turn, modes_.shape);
  }

  /// Where rounding keeps the shift from coming near, a shift apart from it will do: each pass
  /// still leaves but a part `apart` of what is not the mode.
  void stay_apart(Real above, Real below, Real shift, Real next, Real scale, Real& done) {
    constexpr double apart = 1e-6;
    constexpr int passes = 5;
    const Real sought = 1.0 - done;
    shift = done > 0.0 ? shift : next * (1.0 - apart);
    Real change = Real{};
    for (int pass = 0; pass < passes; ++pass) {
      sweep_.template eliminate<true>(shift, scale);
      sweep_.correct(shift, scale, sought);
      Real taken, weight;
      sweep_.give_way(taken, weight);
      change = M::magnitude(shift + scale * taken / weight - next);
      next = shift + scale * taken / weight;
      scale = 1.0 / M::root(weight);
    }
    const typename M::Mask found =
        (above < next) & (next < below) & (change <= rounding * M::magnitude(next));
    done = found ? M::all(1.0) : done;
  }

  const BarModesBetween& modes_;
  Sweep sweep_;
};

template <int N, int V>
void find_motion(const BarUnderLoads& loads) {
  using Sweep = BarSweep<N, V>;
  using M = typename Sweep::M;
  using Real = typename Sweep::Real;
  Sweep sweep(*loads.bar, loads.work);
  for (int first = 0; first < loads.loads; first += N) {
    const LaneChunk<N> chunk(first, loads.loads);
    for (int e = 0; e < loads.bar->elements; ++e)
      for (int i = 0; i < V; ++i)
        sweep.steps()[e].load[i] =
            chunk.load(loads.load + static_cast<long>(e * V + i) * loads.loads);
    sweep.template eliminate<true>(M::all(loads.shift), M::all(1.0));
    Real taken, weight;
    sweep.give_way(taken, weight);
    sweep.write(chunk, M::all(1.0), loads.stride, loads.turn, loads.motion);
  }
}

template <int N>
void count_modes_by(const BarShifts& shifts) {
  shifts.bar->values == 4 ? count_below<N, 4>(shifts) : count_below<N, 7>(shifts);
}

template <int N>
void find_modes_by(const BarModesBetween& modes) {
  modes.bar->values == 4 ? ModesBetween<N, 4>(modes).find() : ModesBetween<N, 7>(modes).find();
}

template <int N>
void find_motion_by(const BarUnderLoads& loads) {
  loads.bar->values == 4 ? find_motion<N, 4>(loads) : find_motion<N, 7>(loads);
}

}  // namespace
}  // namespace impactrig::models
