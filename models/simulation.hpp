// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "models/rig.hpp"

namespace impactrig::models {

/// One stay in contact at one stop, from touch to separation.
struct Episode {
  double start = 0.0;                ///< [s] from first touch
  double end = 0.0;                  ///< [s]; the end of the run when `open`
  double peak_force = 0.0;           ///< [N]
  double peak_time = 0.0;            ///< [s]
  double impulse = 0.0;              ///< [N s]
  double max_penetration = 0.0;      ///< [m]
  double approach_velocity = 0.0;    ///< of the struck point at touch, seen from the stop [m/s]
  double separation_velocity = 0.0;  ///< likewise at separation, > 0 when it leaves [m/s]
  double dissipated = 0.0;           ///< by the contact's damping [J]
  bool open = false;                 ///< still touching when the run ended
  int stop = 0;                      ///< 0: struck first; from 1 on as in Rig::further_stops
};

/// The four numbers called restitution; all [-]. Of the first episode but for `law`.
struct Restitution {
  double law = 1.0;        ///< e in the damping law
  double kinematic = 0.0;  ///< Newton: separation over approach speed of the struck point
  double kinetic = 0.0;    ///< Poisson: impulse after over impulse before deepest penetration
  double energetic = 0.0;  ///< Stronge: square root of work returned over work taken by the contact
};

/// What happened at one stop over the run.
struct StopTotals {
  double peak_force = 0.0;       ///< [N]
  double peak_time = 0.0;        ///< [s] from first touch
  double max_penetration = 0.0;  ///< [m]
  double impulse = 0.0;          ///< [N s]
  double dissipated = 0.0;       ///< by the contact's damping [J]
};

/// Where the energy is at the end of the run [J]; imbalance relative to the initial kinetic energy.
struct EnergyAudit {
  /// Kinetic, at first touch. Without a stop: kinetic or what weight and spring can set free; of a
  /// turned hinge the rigid bar's at the full rate.
  double initial = 0.0;
  double kinetic = 0.0;
  double elastic = 0.0;
  double elastic_at_start = 0.0;  ///< of a bar that its weight or its turning stretches
  double spring = 0.0;            ///< stored in the hinge
  double gravitational = 0.0;     ///< relative to first touch
  double contact_stored = 0.0;    ///< in all stops; not zero only when the run ends in contact
  double dissipated = 0.0;        ///< by the damping of all contacts
  double damped = 0.0;            ///< in bar, hinge (friction too) and the stop's damper
  double driven = 0.0;            ///< work of what turns the hinge as stated, since the start
  double stop = 0.0;              ///< left in a compliant stop's head and spring
  /// Kinetic energy of the rigid bar with the same angular momentum about the hinge.
  double rigid_rotation = 0.0;
  double vibration = 0.0;  ///< kinetic + elastic - elastic_at_start - rigid_rotation
  double imbalance = 0.0;  ///< [-]

  /// The imbalance relative to what came into play: where weight or spring set free more than the
  /// initial energy, as after a slow touch, that is what errors are a part of.
  double unbalanced() const {
    return imbalance * initial /
           std::max(initial, kinetic + std::abs(elastic - elastic_at_start) + dissipated + damped);
  }
};

struct Cost {
  long steps = 0;
  long rejected = 0;
  long evaluations = 0;
  double seconds = 0.0;
};

/// What to sample while integrating; nothing by default.
struct HistoryRequest {
  double interval = 0.0;           ///< [s]; 0 = no history
  double lead = 0.0;               ///< before first touch [s], continued backwards as a rigid swing
  double velocity_position = 0.0;  ///< laser spot, from the hinge [m]; 0 = the struck point
  double displacement_position = 0.0;  ///< [m]; 0 = the struck point
  bool spot_slopes = false;            ///< also how both change along the bar
};

/// What a history shows at a further stop.
struct StopHistory {
  std::vector<double> force;        ///< compression > 0 [N] (n)
  std::vector<double> penetration;  ///< > 0 in contact, negative: gap [m] (n)
};

/// Where the first stop's force is not continuous: damping that begins or ceases to act at once.
struct ForceJump {
  double time = 0.0;                 ///< [s] from first touch
  double before = 0.0, after = 0.0;  ///< the force to both sides [N]
};

/// What the first stop's force passes on from the sample before to this one, between which its
/// contact begins, changes or ends.
struct SampleImpulse {
  double time = 0.0;  ///< when it does [s]
  std::size_t sample = 0;
  double impulse = 0.0;  ///< [N s]
};

/// Uniform samples of the true motion; sample k is at start + k interval, first touch at 0. Without
/// a stop the run begins at 0, has neither force nor penetration, and the displacement is that from
/// hanging straight.
struct History {
  double start = 0.0;
  double interval = 0.0;
  std::vector<double> force;        ///< at the first stop, compression > 0 [N] (n)
  std::vector<double> penetration;  ///< there, > 0 in contact, negative: gap [m] (n)
  std::vector<double> velocity;     ///< closing > 0, at velocity_position [m/s] (n)
  /// Closing > 0, 0 at first touch, at displacement_position [m] (n).
  std::vector<double> displacement;
  /// How both change along the bar at the lasers' spots [1/s], [-] (n); empty where not asked for.
  std::vector<double> velocity_slope, displacement_slope;
  /// What the sensor of a compliant stop carries, compression > 0 [N] (n); empty where it is rigid.
  std::vector<double> sensor_force;
  std::vector<StopHistory> further;  ///< as Rig::further_stops

  /// Of seen_force(), in order of time; a sample on a jump shows the force before it. In a
  /// Sensitivity the derivatives of these three numbers of each.
  std::vector<ForceJump> jumps;
  /// Of a rigid stop's force, in order of time; in a Sensitivity the derivatives of `impulse`, the
  /// samples' times held.
  std::vector<SampleImpulse> impulses;

  /// Of a hinge that is turned as stated: where the point at displacement_position is against the
  /// straight bar at the hinge's angle, across it (closing > 0) and along it [m] (n).
  std::vector<double> deflection, extension;
  std::vector<double> deflection_slope, extension_slope;  ///< as displacement_slope [-] (n)

  /// What a force sensor in the stop sees [N] (n).
  const std::vector<double>& seen_force() const {
    return sensor_force.empty() ? force : sensor_force;
  }
};

/// What the spring and damper of a compliant stop carried over the run.
struct SensorForce {
  double peak_force = 0.0;  ///< [N]
  double peak_time = 0.0;   ///< [s] from first touch
  double impulse = 0.0;     ///< [N s]
  /// Largest from the second touch on, where it is half of the peak or more [N].
  double later_peak_force = 0.0;
  /// Whether the accuracy holds for the peak: each contact magnifies the errors of those before it
  /// (models/stop/sensor_peak.hpp).
  bool peak_known = true;
};

/// How much a mesh twice as fine changes the prediction, relative: nearly the error of the mesh,
/// since what is left then is several times smaller. Of the first contact, until the run's end
/// where it does not end.
struct MeshError {
  double peak_force = 0.0;
  double duration = 0.0;  ///< NaN where it does not end
  double impulse = 0.0;   ///< NaN where it ends on one mesh alone
  /// Of SensorForce::peak_force; none where the stop does not give way.
  std::optional<double> sensor_peak_force;
  /// Where what the sensor carries later is not known, or takes too long to solve: until when it is
  /// compared, about the second touch [s] from the first. None: over the run.
  std::optional<double> sensor_until;
  Solver finer;  ///< what it was compared with

  double largest() const;
};

/// Derivatives of what simulate() gives by one number of the rig; events move with it. Of the first
/// contact, and NaN where that does not end.
struct Sensitivity {
  double peak_force = 0.0;
  double max_penetration = 0.0;
  double duration = 0.0;
  double impulse = 0.0;
  double separation_velocity = 0.0;
  double sensor_peak_force = 0.0;          ///< SensorForce::peak_force, over the run
  Restitution restitution = {.law = 0.0};  ///< `law` stays zero
  History history;  ///< sample by sample at the same times; none asked for: empty
};

/// What simulate() leaves out where a scene does not need it.
enum class Simplification {
  small_motion,    ///< foreshortening and large rotation of the bar
  fast_vibration,  ///< vibration of a fine mesh too fast to matter; it follows the force as a
                   ///< spring
  swing_to_touch,  ///< the swing from release to first touch; its end state is known
  flight_at_once,  ///< steps of a flight in which the gap cannot close
  hinge_friction   ///< friction in the hinge whose impulse is too small to matter
};

/// What simulate() gives; peak, penetration, impulse and restitution are those of the first stop.
/// `termination` says in a sentence why the run ended.
struct Simulation {
  Solver solver;                      ///< as used
  double peak_force = 0.0;            ///< over the run [N]
  double peak_time = 0.0;             ///< [s] from first touch
  double max_penetration = 0.0;       ///< [m]
  double impulse = 0.0;               ///< over the run [N s]
  double duration = 0.0;              ///< simulated, from first touch [s]
  std::optional<SensorForce> sensor;  ///< of a compliant stop
  std::vector<Episode> episodes;      ///< at all stops, in the order they begin
  std::vector<StopTotals> stops;      ///< of each, the first first; empty where there is but one
  Restitution restitution;
  EnergyAudit energy;
  Cost cost;
  History history;
  std::string termination;
  /// By the time limit, or where no step was short enough: what comes later is not in it.
  bool cut_short = false;
  bool small_motion = false;  ///< solved as Motion::small
  /// Estimated relative error of peak force, duration and impulse by the simplifications taken.
  double neglected = 0.0;
  /// As asked for, in that order; empty where they are not known (SimulationOptions).
  std::vector<Sensitivity> sensitivities;
  std::optional<MeshError> mesh_error;  ///< not estimated by simulate() itself
  std::vector<Simplification> taken;    ///< simplifications
  std::vector<std::string> skipped;     ///< of each a sentence: what, why it is safe here
  std::vector<std::string> warnings;    ///< one sentence each
};

/// Which equations of the bar are solved.
enum class Motion {
  by_accuracy,  ///< small motion where what it leaves out is below the accuracy asked for
  small,        ///< linear about hanging straight, solved in the bar's modes
  full          ///< as the model has them, foreshortening and large rotation kept
};

class BarCache;

struct SimulationOptions {
  HistoryRequest history;
  /// Shared by runs of the same bar (models/modal/bar_cache.hpp); not owned.
  BarCache* bars = nullptr;
  Motion motion = Motion::by_accuracy;
  bool exact = false;                     ///< take no simplification
  std::vector<Simplification> kept = {};  ///< simplifications not to take
  /// Numbers of the rig by which to differentiate. Against stops whose contacts end smoothly
  /// (ContactForce::ends_smoothly()). Small motion knows them of runs that begin at touch, by what
  /// it does not leave out: of swings, by the hinge's friction and by what holds a pendulum that
  /// nothing holds, the full equations are solved, unless Motion::small is asked for.
  /// derivative_refusal() says by which they are not known. Without a stop they are those of the
  /// history.
  std::vector<RigParameter> sensitivities = {};
  /// Steps need not be shorter for the derivatives than this relative accuracy of theirs asks for,
  /// where solver.accuracy is finer: they are less smooth than what they are of.
  double sensitivity_accuracy = 0.0;
  /// Estimate what small motion neglects. For callers that know it, with Motion::small, which takes
  /// that whatever it is: false saves half of a run, and Simulation::neglected is 0. Nor is a
  /// sensor's largest force confirmed then (models/stop/sensor_peak.hpp).
  bool judge_small_motion = true;
};

/// Whether a simplification may be taken.
bool allows(const SimulationOptions& options, Simplification simplification);

/// Whether a release from rest is followed until the bar touches.
bool follows_swing(const Rig& rig, const SimulationOptions& options);

/// Whether small motion may be taken, with all it leaves out of this rig.
bool allows_small_motion(const Rig& rig, const SimulationOptions& options);

/// Predicts one impact of the rig, or, without a stop, its swing. Throws std::invalid_argument as
/// validate() does or when small motion is asked for of a mesh too fine for it or of a rig it does
/// not know, and std::runtime_error with a sentence when the integration cannot go on.
Simulation simulate(const Rig& rig, const Solver& solver, const SimulationOptions& options = {});

}  // namespace impactrig::models
