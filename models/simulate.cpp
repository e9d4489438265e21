// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/beams/bar_element.hpp"
#include "models/contact/contact_force.hpp"
#include "models/free_run.hpp"
#include "models/implicit/chain_motion.hpp"
#include "models/implicit/dense_motion.hpp"
#include "models/modal/arrival.hpp"
#include "models/modal/small_motion_run.hpp"
#include "models/rigid_swing.hpp"
#include "models/sensitivities/full_sensitivities.hpp"
#include "models/settled_solution.hpp"
#include "models/settled_swing.hpp"
#include "models/solved_to_size.hpp"
#include "models/stop/sensor_peak.hpp"
#include "models/stop/stopped_motion.hpp"
#include "models/time_limit.hpp"

namespace impactrig::models {
namespace {

// Of the accuracy asked for, what full equations are solved to: scenes may magnify errors (a bar
// that turns back just before it stands on its head: 18 times). A rigid bar costs next to nothing.
constexpr double share_of_full = 0.3, share_of_rigid = 0.03;

// Likewise small motion that follows a swing: a spring's moment, let go, leaves vibration of all
// modes in the bar, with which the force ripples within a step. With the accuracy itself the lower
// of two crests 4 us apart was taken, 2.1 times the accuracy (1e-5) too low.
constexpr double share_of_released = 0.1;

// Of that, what a swing is solved to that is followed with its derivatives, and how far that goes:
// vibration that nothing damps has slopes by ω t times itself, which grow with time, and so do
// errors of its phase. Of a bar of five elements (E = 1e9 Pa, let go 0.5 rad before the stop) the
// peak force errs by 1e-8 at 1e-6 and its slopes by 1.7e-4, by 1e-6 with this.
constexpr double share_of_swings_slopes = 0.01, finest_for_slopes = 1e-10;

// Modes that a fine mesh is tried with, as long as they are no more than share_worth_it of all: of
// more the paper's scene has its answer no sooner, and twice as late where they do not do; fewer
// than worth_it in all are found as soon as some of them. What they leave out may be
// share_of_vibration of the accuracy.
constexpr std::array few_modes = {24,  32,  40,  48,  60,  72,  90,  108, 130, 162,
                                  200, 243, 300, 364, 440, 530, 640, 770, 930, 1120};
constexpr double share_worth_it = 0.6, share_of_vibration = 0.6;
constexpr int worth_it = 100;

// An accuracy at which a solution costs little beside that at a finer one. What it tells of few
// modes falls with this power of their number: of 24 random damped scenes of a fine mesh the median
// needed 4.9 times as many at 1e-5 as at 1e-3 (3.3 to 5.2 times), what is tried being a fifth
// apart.
constexpr double coarse = 1e-3, power_from_coarse = 3.1;

// An element in which a bending wave is such a part of the others' vibrates far faster than they
// do; beyond so many times the slowest mode's frequency steps are too many for small motion to be
// worth it.
constexpr double short_element = 0.1, too_fast = 1e6;

// Of the time allowed, after which small motion goes on only where it will do. Of 190 random scenes
// of flexible bars it takes 0.08 of the full equations' in the median; where it takes longer than
// they, it mostly leaves out too much besides.
constexpr double share_of_trial = 0.5;

/// The same with the time that is left.
Solver in_time(Solver solver, const TimeLimit& limit) {
  solver.time_limit = limit.left();
  return solver;
}

/// What small motion may take.
struct SmallMotionTime {
  TimeLimit limit;
  std::optional<SmallMotionRun::Trial> trial;  ///< where the full equations follow
};

/// A first contact much smaller than it was taken for, or that ends slowly, is solved again in the
/// time that is left.
template <typename Solve>
Simulation solve_to_size(const Solver& solver, const TimeLimit& limit, const Solve& solve) {
  Solved first = solve(in_time(solver, limit));
  if (first.smallness == 1.0) return std::move(first.result);
  const Solver finer = in_time(solver_to_size(solver, first.smallness), limit);
  try {
    return solved_to_size(first.result, solve(finer), first.smallness, solver.accuracy);
  } catch (const std::runtime_error&) {
    return not_solved_to_size(std::move(first));
  }
}

Simulation run_freely(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                      BarMotion& bar) {
  FreeRun free(rig, solver, options, bar);
  std::optional<FreeSensitivities> sensitivities;
  if (!options.sensitivities.empty()) sensitivities.emplace(rig, solver, options, bar);
  const bool known = sensitivities && sensitivities->known();
  if (known) free.follow(*sensitivities);
  free.start();
  Simulation result = free.simulate();
  if (known) result.sensitivities = sensitivities->take_results();
  return result;
}

/// The bar against its stop, if there is one.
Solved run(const Rig& rig, const Solver& solver, const SimulationOptions& options, BarMotion& bar) {
  if (!rig.has_stop()) return {run_freely(rig, solver, options, bar)};
  std::optional<StoppedMotion> stopped;
  if (rig.stop) stopped.emplace(bar, *rig.stop);
  BarMotion& seen = stopped ? static_cast<BarMotion&>(*stopped) : bar;
  CollocationRun run(rig, solver, options, seen);
  std::optional<FullSensitivities> sensitivities;
  if (!options.sensitivities.empty() && contacts_end_smoothly(rig))
    sensitivities.emplace(rig, solver, options, seen, stopped ? &*stopped : nullptr);
  if (sensitivities && sensitivities->known()) {
    if (stopped) stopped->keep_responding();
    run.follow(*sensitivities);
  }
  run.complete();
  Solved solved{.result = {}, .smallness = run.smallness()};
  solved.result = run.conclude();
  if (sensitivities && sensitivities->known())
    solved.result.sensitivities = sensitivities->take_results();
  if (stopped) solved.result.sensor = stopped->sensor(solved.result.impulse);
  return solved;
}

struct SolvedInModes {
  Simulation result;
  double left_out;  ///< SmallMotionRun's, against the accuracy that the run had
};

SolvedInModes solve_in_modes(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                             const SmallMotionTime& time,
                             const std::shared_ptr<const ModalBar>& bar) {
  const ModalBeam& modes = bar->modes();
  if (options.motion != Motion::small && modes.rounding() > solver.accuracy)
    throw std::runtime_error("the modes of elements so different in length are inexact");
  if (options.motion != Motion::small && modes.modes() > 1 &&
      modes.omega().maxCoeff() > too_fast * modes.omega()[1])
    throw std::runtime_error("the modes of elements so different in length are too fast");
  double left_out = 0.0;
  Simulation result = solve_to_size(solver, time.limit, [&](const Solver& used) {
    SmallMotionRun run(rig, used, options, bar);
    run.complete(time.trial);
    Solved solved{.result = {}, .smallness = run.run().smallness()};
    solved.result = run.conclude();
    left_out = run.left_out() / used.accuracy;
    return solved;
  });
  result.solver = solver;
  return {std::move(result), left_out};
}

/// A bar's modes are as exact as its derivatives have to be: these see what damping makes of the
/// weight alone, which the motion itself hardly does.
Solver for_modes(const Solver& solver, const SimulationOptions& options) {
  constexpr double of_derivatives = 1e-2;
  Solver modes = solver;
  if (!options.sensitivities.empty())
    modes.accuracy = std::min(
        solver.accuracy, of_derivatives * std::max(solver.accuracy, options.sensitivity_accuracy));
  return modes;
}

/// What the paper's scene needs without damping in the contact; histories show more of the
/// vibration, and it falls by less.
double fewest_modes(double accuracy, bool shown) {
  return shown ? 32.0 * std::pow(15e-3 / accuracy, 0.2) : 24.0 * std::pow(1e-3 / accuracy, 0.19);
}

bool damps(const Rig& rig) {
  for (int stop = 0; stop < rig.stops(); ++stop)
    if (ContactForce(rig, stop).damped()) return true;
  return false;
}

/// By which power of the number of modes what is left out falls, about: damping takes the speed of
/// the fastest into the force.
double power_of_modes(const Rig& rig) {
  return damps(rig) ? 3.3 : 5.5;
}

/// Of a mesh with elements far shorter than others those that are not theirs alone; of any other
/// none.
int modes_of_long_elements(const Rig& rig, const Solver& solver) {
  std::vector<double> waves;
  for (const BarElement& element : bar_elements(rig.beam, rig.contact.position, solver.elements))
    waves.push_back(element.length * element.wave_number());
  const double longest = std::ranges::max(waves);
  const auto few =
      std::ranges::count_if(waves, [&](double each) { return each < short_element * longest; });
  return few == 0 ? 0 : modes_of(solver) - 2 * static_cast<int>(few);
}

/// How many modes a mesh is tried with, from the fewest that are worth it on.
std::vector<int> numbers_of_modes(const Rig& rig, const Solver& solver, double fewest) {
  const bool computable = small_motion_refusal(rig, solver).empty();
  const double share = modes_of(solver) < worth_it ? 0.0 : share_worth_it;
  const double most = computable ? share * modes_of(solver) : modes_of(solver);
  std::vector<int> numbers;
  for (const int modes : few_modes)
    if (modes >= fewest && modes <= most) numbers.push_back(modes);
  const int slow = modes_of_long_elements(rig, solver);
  if (slow > (numbers.empty() ? 0 : numbers.back())) numbers.push_back(slow);
  return numbers;
}

/// A mesh in few modes; none where they would have to be so many that all are as quick. How many a
/// contact with damping needs differs from scene to scene by a factor of ten: a solution too coarse
/// to cost much tells.
std::optional<Simulation> leave_out_vibration(const Rig& rig, const Solver& solver,
                                              const SimulationOptions& options,
                                              const SmallMotionTime& time, BarCache& bars) {
  if (!may_leave_out_vibration(rig, solver, options)) return std::nullopt;
  Solver used = solver;
  const bool shown = options.history.interval > 0.0;
  double power = power_of_modes(rig), last_excess = 0.0, fewest = 0.0, last = 0.0;
  const auto solve = [&](int modes) {
    return solve_in_modes(rig, used, options, time,
                          bars.reduced_bar(rig, for_modes(solver, options), modes));
  };
  // what is left for vibration, as a part of the accuracy
  const auto room_beside = [&](const SolvedInModes& solved) {
    if (options.motion == Motion::small) return 1.0;
    return 1.0 - (solved.result.neglected - solved.left_out * used.accuracy) / solver.accuracy;
  };
  if (solver.accuracy < coarse && damps(rig)) {
    const std::vector<int> few = numbers_of_modes(rig, solver, fewest_modes(coarse, shown));
    if (few.empty()) return std::nullopt;
    used.accuracy = coarse;
    SolvedInModes solved = solve(few.front());
    const double room = room_beside(solved);
    if (room < 0.0) return std::move(solved.result);  // it will not do as small motion anyway
    const double excess = solved.left_out * coarse / solver.accuracy;
    fewest = few.front() *
             std::pow(excess / std::min(share_of_vibration, room), 1.0 / power_from_coarse);
    used = solver;
  }
  const std::vector<int> numbers =
      numbers_of_modes(rig, solver, fewest_modes(solver.accuracy, shown));
  // where all cannot be computed the most that can may do
  if (!numbers.empty() && !small_motion_refusal(rig, solver).empty())
    fewest = std::min(fewest, static_cast<double>(numbers.back()));
  for (const int modes : numbers) {
    if (modes < fewest) continue;
    SolvedInModes solved = solve(modes);
    solved.result.solver = solver;
    const double room = room_beside(solved);
    if (room <= 0.0) return std::move(solved.result);  // it will not do as small motion anyway
    const double excess = solved.left_out / std::min(share_of_vibration, room);
    if (excess <= 1.0) return std::move(solved.result);
    if (last > 0.0)
      power = std::clamp(std::log(last_excess / excess) / std::log(modes / last), 2.0, 8.0);
    last = modes;
    last_excess = excess;
    fewest = modes * std::pow(excess, 1.0 / power);
  }
  return std::nullopt;
}

/// None where there are more modes than can be computed.
std::optional<Simulation> simulate_small_motion(const Rig& rig, const Solver& solver,
                                                const SimulationOptions& options,
                                                const SmallMotionTime& time) {
  BarCache own;
  BarCache& cache = options.bars ? *options.bars : own;
  if (std::optional<Simulation> result = leave_out_vibration(rig, solver, options, time, cache))
    return result;
  if (!small_motion_refusal(rig, solver).empty()) return std::nullopt;
  const std::shared_ptr<const ModalBar> bar = cache.bar(rig, for_modes(solver, options));
  if (!rig.has_stop()) return swing_freely(rig, solver, options, *bar);
  Solver used = solver;
  if (follows_swing(rig, options)) used.accuracy *= share_of_released;
  return solve_in_modes(rig, used, options, time, bar).result;
}

/// Small motion, where it may be tried and its own estimate of what it leaves out allows it.
std::optional<Simulation> try_small_motion(const Rig& rig, const Solver& solver,
                                           const SimulationOptions& options,
                                           const TimeLimit& limit) {
  const bool asked = options.motion == Motion::small;
  if (!allows_small_motion(rig, options)) return std::nullopt;
  SmallMotionTime time{limit, std::nullopt};
  if (asked) {
    std::optional<Simulation> result = simulate_small_motion(rig, solver, options, time);
    if (!result) throw std::invalid_argument(small_motion_refusal(rig, solver));
    return result;
  }
  time.trial = {limit.sooner((1.0 - share_of_trial) * solver.time_limit), solver.accuracy};
  try {
    std::optional<Simulation> result = simulate_small_motion(rig, solver, options, time);
    if (result && result->neglected <= solver.accuracy) return result;
  } catch (const std::runtime_error&) {
    // what is wrong with the scene the full equations tell
  }
  return std::nullopt;
}

std::unique_ptr<BarMotion> make_motion(const Rig& rig, const Solver& solver,
                                       const HistoryRequest& history) {
  if (solver.model != BeamModel::ancf) return make_dense_motion(rig, solver, history);
  if (rig.beam.shears()) return make_reissner_motion(rig, solver, history);
  return make_ancf_motion(rig, solver, history);
}

Simulation simulate_full_equations(const Rig& rig, const Solver& solver,
                                   const SimulationOptions& options) {
  Solver used = solver;
  used.accuracy *= solver.model == BeamModel::rigid ? share_of_rigid : share_of_full;
  const bool swings = !rig.has_stop() || follows_swing(rig, options);
  if (swings && !options.sensitivities.empty() && solver.model != BeamModel::rigid)
    used.accuracy = std::min(used.accuracy,
                             std::max(share_of_swings_slopes * used.accuracy, finest_for_slopes));
  const TimeLimit limit(solver.time_limit);
  Simulation result = solve_to_size(used, limit, [&](const Solver& finer) {
    const std::unique_ptr<BarMotion> bar = make_motion(rig, finer, options.history);
    return run(rig, in_time(finer, limit), options, *bar);
  });
  result.solver = solver;
  return result;
}

/// Whether it makes itself felt that a bar that is let go does not swing as a rigid one: without a
/// swing the full equations would have nothing of it.
bool feels_release(const Rig& rig, const Solver& solver, const SimulationOptions& options) {
  const bool flexible = rig.has_stop() && solver.model != BeamModel::rigid;
  if (!flexible || !rig.start.release_angle || follows_swing(rig, options)) return false;
  const auto missed = missed_by_rigid_swing(rig);
  return !missed || *missed > solver.accuracy;
}

/// A damper that hardly lets the bar arrive leaves it what the swing's last digits are.
void warn_of_creeping(const Rig& rig, Simulation& result) {
  constexpr double last_digits = 1e-5;  // of the speed it would have without a damper
  if (!rig.start.release_angle || rig.hinge.viscous == 0.0 || result.episodes.empty()) return;
  const double free =
      rig.contact.position * std::sqrt(2.0 * RigidSwing(rig).available(-*rig.start.release_angle) /
                                       rig.beam.hinge_inertia());
  const double speed = result.episodes.front().approach_velocity;
  if (!(speed < last_digits * free)) return;
  result.warnings.push_back(fmt::format(
      "the damper in the hinge lets the bar creep to its stop: it touches at {:.2g} m/s, {:.1g} of "
      "what it would have without, which the last digits of the swing decide, and all numbers of "
      "its contacts with it. State less hinge.viscous, or a start.velocity.",
      speed, speed / free));
}

/// In small motion where that will do, else by the full equations in the time that is left.
Simulation solve(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                 const TimeLimit& limit) {
  std::optional<Simulation> result = try_small_motion(rig, solver, options, limit);
  SimulationOptions used = options;
  if (!result) {
    if (feels_release(rig, solver, options)) used.kept.push_back(Simplification::swing_to_touch);
    const auto settled = rig.has_stop() ? solve_until_settled : solve_swing_until_settled;
    result = settled(rig, in_time(solver, limit), used,
                     [&](const Solver& finer, const SimulationOptions& asked) {
                       return simulate_full_equations(rig, finer, asked);
                     });
  }
  result->solver = solver;
  tell_swing(rig, used, *result);
  warn_of_creeping(rig, *result);
  return *std::move(result);
}

}  // namespace

bool allows(const SimulationOptions& options, Simplification simplification) {
  if (options.exact || std::ranges::count(options.kept, simplification) > 0) return false;
  return simplification != Simplification::small_motion || options.motion != Motion::full;
}

bool follows_swing(const Rig& rig, const SimulationOptions& options) {
  return rig.start.release_angle &&
         (!allows(options, Simplification::swing_to_touch) || spring_bends_bar(rig));
}

bool allows_small_motion(const Rig& rig, const SimulationOptions& options) {
  if (!allows(options, Simplification::small_motion)) return false;
  // what a bent bar's swing lacks as small motion is known to a factor of three only
  const bool asked = options.motion == Motion::small;
  if (follows_swing(rig, options) && spring_bends_bar(rig) && !asked) return false;
  // small motion of a swing has no derivatives
  const bool swings = !rig.has_stop() || follows_swing(rig, options);
  if (swings && !options.sensitivities.empty() && options.motion != Motion::small) return false;
  // small motion has no derivatives by what it leaves out
  const auto known = [&](RigParameter parameter) {
    return RigEffect(rig, parameter).small_motion_knows();
  };
  if (options.motion != Motion::small && !std::ranges::all_of(options.sensitivities, known))
    return false;
  return rig.hinge.friction == 0.0 || allows(options, Simplification::hinge_friction);
}

Simulation simulate(const Rig& rig, const Solver& solver, const SimulationOptions& options) {
  validate(rig, solver);
  const TimeLimit limit(solver.time_limit);
  Simulation result = solve(rig, solver, options, limit);
  if (options.judge_small_motion)
    confirm_sensor_peak(
        solver, options, limit.left(),
        [&](const Solver& used, const SimulationOptions& asked) {
          return solve(rig, used, asked, limit);
        },
        result);
  return result;
}

}  // namespace impactrig::models
