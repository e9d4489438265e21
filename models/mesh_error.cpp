// SPDX-License-Identifier: BSD-3-Clause
#include "models/mesh_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "models/beams/bar_element.hpp"
#include "models/modal/arrival.hpp"
#include "models/modal/small_motion_run.hpp"
#include "models/run_limits.hpp"
#include "models/time_limit.hpp"

namespace impactrig::models {
namespace {

// What the runs that are compared are solved to: the least error of a mesh worth knowing. Of the
// accuracy asked for, what full equations, which cost more, are solved to; and small motion where a
// mesh has to be that good, unless it is too fine for all of its modes.
constexpr double worth_knowing = 1e-7, share_of_accuracy = 0.1, finest_runs = 1e-12;
// Small motion that leaves out no more of the result tells the error of a mesh to about such a
// part.
constexpr double small_enough = 1e-2;
// With a swing before, which takes the full equations a minute.
constexpr double small_enough_with_swing = 0.1;
// Of what half of the elements change, twice as many change the 16th at least, as cubic elements
// converge: meshes that agree better do so by chance more often than not.
constexpr double best_ratio = 1.0 / 16.0;
// Of the accuracy asked for, the mesh's; the rest is for the steps in time.
constexpr double share_of_mesh = 0.5;
// Of the time a run may take, what may be spent on the choice of its mesh, and what is left to the
// run though that took longer; of the former, what may be spent on one run to the end.
constexpr double share_of_time = 0.5, least_share_of_run = 0.25, share_of_whole_run = 0.125;
constexpr int coarsest = 8;

/// The rig with what small motion does not know left out, the weight of a bar that stands:
/// missing_weight().
Rig within_small_motion(const Rig& rig) {
  Rig plain = rig;
  if (rig.gravity_along() < 0.0) plain.gravity_direction = 0.0;
  return plain;
}

/// What that weight would do to a first contact of this time [s], as a part of its impulse.
double missing_weight(const Rig& rig, const Episode& first, double time) {
  if (rig.gravity_along() >= 0.0) return 0.0;
  const double angle = touch_velocity(rig) * time / rig.contact.position;
  const double moment =
      rig.gravity * rig.beam.first_moment() *
      (std::abs(std::sin(rig.gravity_direction)) + (1.0 - std::cos(rig.gravity_direction)) * angle);
  return moment * time / (rig.contact.position * first.impulse);
}

/// Whether what a release leaves in the bar, whose phase at touch hangs on the mesh, moves the
/// result by more than a part of it.
bool feels_release(const Rig& rig, double part) {
  if (!rig.start.release_angle) return false;
  if (spring_bends_bar(rig)) return true;
  const auto vibration = release_vibration(rig);
  return !vibration || *vibration > part;
}

/// The rig from first touch on.
Rig touching(const Rig& rig) {
  Rig begun = rig;
  begun.start.velocity = touch_velocity(rig);
  begun.start.release_angle.reset();
  return begun;
}

/// The force of a contact that is a graze beside the others, at most [N].
double largest_graze(std::span<const Episode> episodes) {
  constexpr double share = 0.02;
  double largest = 0.0;
  for (const Episode& episode : episodes) largest = std::max(largest, episode.peak_force);
  return share * largest;
}

/// Of a run, what meshes are compared by.
struct Told {
  Episode contact;                     // the first that is more than a graze
  std::optional<SensorForce> sensor;   // where the stop gives way
  std::optional<double> sensor_until;  // [s], MeshError::sensor_until
};

/// The first contact of a scene that is more than a graze, on one mesh after the other, by small
/// motion where that sees what a mesh does to it; and what a sensor carries, over the run where
/// that can be known.
class FirstContacts {
 public:
  /// By small motion to such an accuracy, in so much time [s], of which a whole run that a sensor
  /// needs may take a share. `released`: the swing before counts.
  FirstContacts(const Rig& rig, const Solver& solver, double accuracy, double time,
                double share_of_one, bool released)
      : rig_(released ? rig : touching(rig)),
        plain_(released ? rig_ : within_small_motion(rig_)),
        accuracy_of_small_(accuracy),
        accuracy_of_full_(std::max(worth_knowing, share_of_accuracy * solver.accuracy)),
        longest_(solver.duration.value_or(longest_default_run)),
        time_(time),
        limit_(time),
        share_of_whole_run_(share_of_one) {}

  double time_left() const { return limit_.left(); }  ///< [s]

  /// On the mesh of `mesh`. Throws as simulate() does, or std::runtime_error when there is no time
  /// left. Where the sensor turns out not to compare for so long, those before are to be had anew.
  Told on(const Solver& mesh) {
    if (!is_small_)
      if (const std::optional<Told> told = try_small_motion(mesh)) return *told;
    try {
      const Simulation run = *is_small_ ? by_small_motion(mesh, false) : by_full_equations(mesh);
      if (compares(run)) return told_by(run);
      shorten(run);
    } catch (const std::runtime_error&) {
      if (!shares_time()) throw;
      share_of_whole_run_ = 1.0;  // its first contact alone may take longer
      is_small_.reset();
    }
    return on(mesh);
  }

 private:
  Told told_by(const Simulation& run) {
    return {run.episodes[number_of(run)], run.sensor, sensor_until_};
  }

  /// compared_contact() of a run, none where it has but grazes: the first run, a whole one, tells
  /// what these are.
  std::optional<std::size_t> found_in(const Simulation& run) {
    if (least_peak_ == 0.0) least_peak_ = largest_graze(run.episodes);
    const auto found = std::ranges::find_if(
        run.episodes, [this](const Episode& episode) { return episode.peak_force >= least_peak_; });
    if (found == run.episodes.end()) return std::nullopt;
    return static_cast<std::size_t>(found - run.episodes.begin());
  }

  /// Likewise; the first of a run that has but grazes.
  std::size_t number_of(const Simulation& run) { return found_in(run).value_or(0); }

  /// Whether what its sensor carries can be compared with that on other meshes.
  bool compares(const Simulation& run) const {
    return !run.sensor || sensor_until_ || (run.sensor->peak_known && !run.cut_short);
  }

  /// Leaves out what the sensor carries beyond the touch after the contact that is compared.
  void shorten(const Simulation& run) {
    const std::size_t next = number_of(run) + 1;
    sensor_until_ = next < run.episodes.size() ? run.episodes[next].start : run.duration;
    is_small_.reset();
  }

  /// None where it leaves out too much; either way the first run decides for all.
  std::optional<Told> try_small_motion(const Solver& mesh) {
    is_small_ = false;
    try {
      const Simulation run = by_small_motion(mesh, true);
      if (!compares(run)) {
        shorten(run);
        return try_small_motion(mesh);
      }
      const Episode& first = run.episodes[number_of(run)];
      const double time = first.open ? run.duration : first.end;
      const double most = rig_.start.release_angle ? small_enough_with_swing : small_enough;
      is_small_ = run.neglected + missing_weight(rig_, first, time) <= most;
      if (*is_small_) return told_by(run);
    } catch (const std::exception&) {
      // full equations may know the rig, or say what is wrong with it
    }
    return std::nullopt;
  }

  Simulation by_small_motion(Solver mesh, bool judged) {
    const double finest = small_motion_refusal(plain_, mesh).empty() ? finest_runs : worth_knowing;
    mesh.accuracy = std::max(finest, accuracy_of_small_);
    SimulationOptions options;
    options.motion = Motion::small;
    options.judge_small_motion = judged;
    return until_compared(plain_, mesh, options);
  }

  Simulation by_full_equations(Solver mesh) {
    mesh.accuracy = accuracy_of_full_;
    return until_compared(rig_, mesh, {});
  }

  /// A run until the first contact ends, and as long as its sensor is compared, no longer than
  /// needed.
  Simulation until_compared(const Rig& rig, Solver mesh, const SimulationOptions& options) {
    constexpr double far_longer = 8.0;
    for (double time = needed();; time *= far_longer) {
      mesh.duration = std::min(time, longest_);
      mesh.time_limit = limit_.left();
      if (shares_time()) mesh.time_limit = std::min(mesh.time_limit, share_of_whole_run_ * time_);
      Simulation run = simulate(rig, mesh, options);
      const std::optional<std::size_t> number = found_in(run);
      const bool over = number && !run.episodes[*number].open;
      if (over) contact_time_ = run.episodes[*number].end;
      if (over || time >= longest_) return run;
      if (limit_.over()) throw std::runtime_error("no time is left for the error of the mesh");
    }
  }

  /// Whether what is solved may be much more than a first contact.
  bool shares_time() const { return rig_.stop && !sensor_until_ && share_of_whole_run_ < 1.0; }

  /// How much of a run, as far as it is known [s].
  double needed() const {
    constexpr double longer = 1.5;
    if (sensor_until_) return *sensor_until_;
    return rig_.stop ? longest_ : longer * contact_time_;
  }

  Rig rig_, plain_;
  double accuracy_of_small_, accuracy_of_full_;
  double longest_;  // [s]
  double time_;     // [s]
  TimeLimit limit_;
  double share_of_whole_run_;
  std::optional<double> sensor_until_;  // [s]
  std::optional<bool> is_small_;
  double contact_time_ = std::numeric_limits<double>::infinity();  // until its end [s]
  double least_peak_ = 0.0;                                        // of more than a graze [N]
};

/// How much `finer` has more, relative.
MeshError difference(const Told& coarse, const Told& finer) {
  const Episode &here = coarse.contact, &there = finer.contact;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  MeshError error;
  error.peak_force = there.peak_force / here.peak_force - 1.0;
  error.duration = !here.open && !there.open
                       ? (there.end - there.start) / (here.end - here.start) - 1.0
                       : unknown;
  error.impulse = here.open == there.open ? there.impulse / here.impulse - 1.0 : unknown;
  if (coarse.sensor)
    error.sensor_peak_force = finer.sensor->peak_force / coarse.sensor->peak_force - 1.0;
  error.sensor_until = finer.sensor_until;
  return error;
}

MeshError times_two(MeshError error) {
  for (double* const part : {&error.peak_force, &error.duration, &error.impulse}) *part *= 2.0;
  if (error.sensor_peak_force) *error.sensor_peak_force *= 2.0;
  return error;
}

/// Shapes without shear converge on a bar with it as 1/n: what twice as many change is half of what
/// is left.
bool converges_slowly(const Rig& rig, const Solver& solver) {
  return solver.model == BeamModel::hybrid && rig.beam.shears();
}

/// The largest part of it; infinite where one ends and the other does not.
double change(const Told& coarse, const Told& finer) {
  if (coarse.contact.open != finer.contact.open) return std::numeric_limits<double>::infinity();
  return difference(coarse, finer).largest();
}

}  // namespace

std::size_t compared_contact(std::span<const Episode> episodes) {
  const double graze = largest_graze(episodes);
  const auto found = std::ranges::find_if(
      episodes, [graze](const Episode& episode) { return episode.peak_force >= graze; });
  return found == episodes.end() ? 0 : static_cast<std::size_t>(found - episodes.begin());
}

double MeshError::largest() const {
  double largest = std::abs(peak_force);
  for (const double other : {duration, impulse, sensor_peak_force.value_or(0.0)})
    if (std::isfinite(other)) largest = std::max(largest, std::abs(other));
  return largest;
}

Solver refined(const Solver& solver) {
  Solver finer = solver;
  finer.elements = {2 * solver.elements[0], 2 * solver.elements[1]};
  finer.modes = 2 * solver.modes;
  finer.axial_modes = 2 * solver.axial_modes;
  return finer;
}

namespace {

/// Whether half the elements are whole ones, and enough for where the bar changes.
bool can_be_halved(const Rig& rig, const std::array<int, 2>& elements) {
  const std::array<int, 2> fewest = fewest_elements(rig.beam, rig.contact.position);
  return elements[0] % 2 == 0 && elements[1] % 2 == 0 && elements[0] / 2 >= fewest[0] &&
         elements[1] / 2 >= fewest[1];
}

}  // namespace

std::optional<Solver> halved(const Rig& rig, const Solver& solver) {
  constexpr int fewest_modes = 2;
  Solver coarser = solver;
  coarser.elements = {solver.elements[0] / 2, solver.elements[1] / 2};
  coarser.modes = solver.modes / 2;
  coarser.axial_modes = solver.axial_modes / 2;
  if (solver.model == BeamModel::ancf && can_be_halved(rig, solver.elements)) return coarser;
  if (solver.model == BeamModel::hybrid && coarser.modes >= fewest_modes) return coarser;
  return std::nullopt;
}

Solver coarsened(const Rig& rig, const Solver& solver) {
  constexpr int few_modes = 4, few_elements = 16;
  Solver coarser = solver;
  coarser.modes = std::min(solver.modes, few_modes);
  coarser.axial_modes = 0;
  std::array<int, 2>& elements = coarser.elements;
  while (elements[0] + elements[1] > few_elements && can_be_halved(rig, elements))
    elements = {elements[0] / 2, elements[1] / 2};
  return coarser;
}

std::optional<MeshError> mesh_error(const Rig& rig, const Solver& solver, double time_limit) {
  if (solver.model == BeamModel::rigid || !rig.has_stop()) return std::nullopt;
  try {
    constexpr double all = 1.0;  // of the time
    const bool released =
        feels_release(rig, std::max(worth_knowing, share_of_accuracy * solver.accuracy));
    FirstContacts contacts(rig, solver, worth_knowing, time_limit, all, released);
    Told coarse = contacts.on(solver);
    const Solver finer = refined(solver);
    const Told fine = contacts.on(finer);
    if (fine.sensor_until != coarse.sensor_until) coarse = contacts.on(solver);
    MeshError error = difference(coarse, fine);
    if (converges_slowly(rig, solver)) error = times_two(error);
    error.finer = finer;
    return error;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

namespace {

/// The mesh with twice the elements, but for a part whose elements are far shorter than the
/// other's: a bar struck close to its tip needs none there.
Solver refined_where_long(const Solver& mesh, const Rig& rig) {
  constexpr double far_shorter = 0.125;
  const std::array<double, 2> parts = {rig.contact.position,
                                       rig.beam.length - rig.contact.position};
  Solver finer = refined(mesh);
  for (const std::size_t k : {0U, 1U}) {
    if (mesh.elements[k] == 0 || mesh.elements[1 - k] == 0) continue;
    const double own = parts[k] / mesh.elements[k], other = parts[1 - k] / mesh.elements[1 - k];
    if (own < far_shorter * other) finer.elements[k] = mesh.elements[k];
  }
  return finer;
}

/// choose_mesh() in so much time [s], with the swing before or without.
ChosenMesh choose_mesh(const Rig& rig, const Solver& solver, int finest, double time,
                       bool released) {
  ChosenMesh chosen{.solver = solver, .error = std::numeric_limits<double>::quiet_NaN()};
  FirstContacts contacts(rig, solver, std::min(worth_knowing, share_of_accuracy * solver.accuracy),
                         time, share_of_whole_run, released);
  const auto split = [&](int total) {
    Solver mesh = solver;
    mesh.elements = split_elements(total, rig);
    return mesh;
  };
  // Each mesh holds the nodes of the one before: split anew, where the bar is struck moves against
  // the elements, which may change as much as their number does.
  Solver mesh = split(coarsest);
  try {
    Told coarser = contacts.on(split(coarsest / 2));
    Told here = contacts.on(mesh);
    if (here.sensor_until != coarser.sensor_until) coarser = contacts.on(split(coarsest / 2));
    double before = change(coarser, here);
    double last = 0.0;  // what the mesh before took [s]; the next takes twice as long at least
    while (true) {
      chosen.end = ChosenMesh::End::finest;
      if (mesh.elements[0] + mesh.elements[1] > finest) break;
      chosen.end = ChosenMesh::End::time;
      if (2.0 * last > contacts.time_left()) break;
      const Solver twice = refined_where_long(mesh, rig);
      const double left = contacts.time_left();
      Told finer;
      try {
        finer = contacts.on(twice);
      } catch (const std::invalid_argument&) {
        // too fine to be compared: what is left is less than what its half lacks
        if (chosen.solver.elements != mesh.elements && std::isfinite(chosen.error)) {
          chosen.solver.elements = mesh.elements;
          chosen.error = before;
          chosen.difference.reset();
        }
        chosen.end = ChosenMesh::End::not_compared;
        break;
      }
      last = left - contacts.time_left();
      if (finer.sensor_until != here.sensor_until) here = contacts.on(mesh);
      const double changed = change(here, finer);
      chosen.solver.elements = mesh.elements;
      chosen.error = std::max(changed, best_ratio * before);
      chosen.sensor_until = finer.sensor_until;
      chosen.difference = difference(here, finer);
      chosen.difference->finer = twice;
      chosen.end = ChosenMesh::End::accurate;
      if (chosen.error <= share_of_mesh * solver.accuracy) break;
      before = changed;
      here = finer;
      mesh = twice;
    }
  } catch (const std::exception&) {
    // the finest mesh whose error is known
    chosen.end = contacts.time_left() > 0.0 ? ChosenMesh::End::not_compared : ChosenMesh::End::time;
  }
  return chosen;
}

/// How far the tip is from where it is on another mesh, over a run of both: at most, as a part of
/// the bar's length.
double apart(const History& a, const History& b, double length) {
  const auto between = [](const std::vector<double>& x, const std::vector<double>& y) {
    double most = 0.0;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
      most = std::max(most, std::abs(x[i] - y[i]));
    return most;
  };
  return std::max({between(a.displacement, b.displacement), between(a.deflection, b.deflection),
                   between(a.extension, b.extension)}) /
         length;
}

/// choose_mesh() of a bar that strikes nothing.
ChosenMesh choose_mesh_of_swing(const Rig& rig, const Solver& solver, int finest) {
  constexpr int samples = 512;
  const TimeLimit limit(solver.time_limit);
  const TimeLimit of_choice(share_of_time * solver.time_limit);
  ChosenMesh chosen{.solver = solver, .error = std::numeric_limits<double>::quiet_NaN()};
  SimulationOptions options;
  options.history.interval = solver.duration.value_or(longest_default_run) / samples;
  options.history.displacement_position = rig.beam.length;
  const auto swing_on = [&](const Solver& mesh) {
    Solver used = mesh;
    used.accuracy = std::max(worth_knowing, share_of_accuracy * solver.accuracy);
    used.time_limit = of_choice.left();
    return simulate(rig, used, options).history;
  };
  Solver mesh = solver;
  mesh.elements = split_elements(coarsest, rig);
  chosen.solver.elements = mesh.elements;
  try {
    History here = swing_on(mesh);
    double last = 0.0;  // [s]
    while (true) {
      chosen.end = ChosenMesh::End::finest;
      if (mesh.elements[0] + mesh.elements[1] > finest) break;
      chosen.end = ChosenMesh::End::time;
      if (2.0 * last > of_choice.left()) break;
      const double left = of_choice.left();
      const Solver twice = refined(mesh);
      History finer = swing_on(twice);
      last = left - of_choice.left();
      chosen.solver.elements = mesh.elements;
      chosen.error = apart(here, finer, rig.beam.length);
      chosen.end = ChosenMesh::End::accurate;
      if (chosen.error <= share_of_mesh * solver.accuracy) break;
      here = std::move(finer);
      mesh = twice;
    }
  } catch (const std::exception&) {
    // the finest mesh whose error is known; what is wrong with the rig simulate() says
    chosen.end = of_choice.left() > 0.0 ? ChosenMesh::End::not_compared : ChosenMesh::End::time;
  }
  chosen.solver.time_limit = std::max(limit.left(), least_share_of_run * solver.time_limit);
  return chosen;
}

}  // namespace

ChosenMesh choose_mesh(const Rig& rig, const Solver& solver, int finest) {
  if (!rig.has_stop()) return choose_mesh_of_swing(rig, solver, finest);
  const TimeLimit limit(solver.time_limit);
  const double time = share_of_time * solver.time_limit;
  const bool released = feels_release(rig, share_of_accuracy * solver.accuracy);
  // half of it is left where the swing takes too long
  ChosenMesh chosen = choose_mesh(rig, solver, finest, released ? 0.5 * time : time, released);
  if (released && !std::isfinite(chosen.error)) {
    chosen = choose_mesh(rig, solver, finest,
                         limit.left() - (1.0 - share_of_time) * solver.time_limit, false);
    chosen.error = std::numeric_limits<double>::quiet_NaN();  // of the swing it is not known
    chosen.difference.reset();
  }
  chosen.solver.time_limit = std::max(limit.left(), least_share_of_run * solver.time_limit);
  return chosen;
}

std::array<int, 2> split_elements(int total, const Rig& rig) {
  const std::array<int, 2> fewest = fewest_elements(rig.beam, rig.contact.position);
  if (fewest[1] == 0) return {std::max(total, fewest[0]), 0};
  const int first = static_cast<int>(std::lround(total * rig.contact.position / rig.beam.length));
  const int before = std::clamp(first, 1, std::max(total - 1, 1));
  return {std::max(before, fewest[0]), std::max({total - before, 1, fewest[1]})};
}

}  // namespace impactrig::models
