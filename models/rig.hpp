// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace impactrig::models {

/// A body small against the bar, fixed to its axis: mass without rotary inertia.
struct LumpedMass {
  double position = 0.0;  ///< from the hinge [m]
  double mass = 0.0;      ///< [kg]

  bool operator==(const LumpedMass&) const = default;
};

/// The bar's own damping, Rayleigh's C = α M + τ K. α brakes every point, lumped masses included,
/// against the ground; τ is the retardation time of a Kelvin-Voigt material, σ = E (ε + τ ε̇). A
/// mode of ω has the damping ratio ζ = (α / ω + τ ω) / 2.
struct BarDamping {
  double mass = 0.0;       ///< α [1/s]
  double stiffness = 0.0;  ///< τ [s]

  bool operator==(const BarDamping&) const = default;
};

/// Euler-Bernoulli: sections stay normal to the axis, without inertia of their own. Timoshenko:
/// they shear against it and have rotary inertia.
enum class BeamTheory { euler_bernoulli, timoshenko };

std::string_view name(BeamTheory theory);

/// A length of bar with a section of its own, and a material where it is not the bar's.
struct BeamSegment {
  double length = 0.0;                        ///< [m]
  double area = 0.0;                          ///< A [m^2]
  double second_moment = 0.0;                 ///< I [m^4]
  double shear_coefficient = 0.0;             ///< κ [-]
  std::optional<double> youngs_modulus = {};  ///< E [Pa]
  std::optional<double> density = {};         ///< rho [kg/m^3]

  bool operator==(const BeamSegment&) const = default;
};

/// A straight bar, x from the hinge, and the masses it carries. It is uniform, or made of segments:
/// then `length` is theirs together and area, second moment and shear coefficient are not used.
struct Beam {
  double length = 0.0;          ///< [m]
  double area = 0.0;            ///< A [m^2]
  double second_moment = 0.0;   ///< I [m^4]
  double youngs_modulus = 0.0;  ///< E [Pa]
  double density = 0.0;         ///< rho [kg/m^3]
  std::vector<LumpedMass> masses = {};
  BarDamping damping = {};
  BeamTheory theory = BeamTheory::euler_bernoulli;
  double poisson_ratio = 0.3;      ///< ν [-]
  double shear_coefficient = 0.0;  ///< κ of Timoshenko's theory: shear force κGA γ [-]

  std::vector<BeamSegment> segments = {};  ///< from the hinge on

  bool operator==(const Beam&) const = default;

  bool shears() const { return theory == BeamTheory::timoshenko; }

  double bar_mass() const;       ///< without `masses` [kg]
  double total_mass() const;     ///< with them [kg]
  double first_moment() const;   ///< ∫ x dm [kg m]
  double hinge_inertia() const;  ///< ∫ x² dm, with the sections' own of a Timoshenko bar [kg m^2]
};

/// A hinge that is turned as stated, whatever moment that takes: from rest smoothly up to a rate Ω
/// within a time T, then on at that rate.
///
///   θ(t) = Ω/T [t²/2 + (T/2π)² (cos(2πt/T) − 1)] up to T,   Ω (t − T/2) after
///
/// T = 0: at Ω from the beginning. Source: [KaneEtAl1987], [SimoVuQuoc1986].
struct HingeRotation {
  double rate = 0.0;  ///< Ω, closing > 0 [rad/s]
  double time = 0.0;  ///< T [s]

  /// The hinge's angle since the start, its rate and acceleration at a time t >= 0 [s].
  double angle_at(double t) const;
  double rate_at(double t) const;
  double acceleration_at(double t) const;

  bool operator==(const HingeRotation&) const = default;
};

/// What the hinge does besides holding the bar; its angle is that of the bar's axis at the hinge.
struct Hinge {
  double spring = 0.0;   ///< k, at rest when the bar is as at touch [N m/rad]
  double viscous = 0.0;  ///< c [N m s/rad]
  /// T of Coulomb friction, against the rotation or holding the hinge up to that [N m].
  double friction = 0.0;
  std::optional<HingeRotation> rotation = {};  ///< none: the hinge turns freely

  bool operator==(const Hinge&) const = default;
};

enum class Counterface { groove, cylinder, plane };

/// What becomes of a contact force that would pull.
enum class Tension { clip, allow };

/// The line contact between the bar's side and the stop.
struct Contact {
  double position = 0.0;  ///< L_p, hinge to struck point [m]
  Counterface counterface = Counterface::groove;
  double radius = 0.0;                        ///< R_1 of the bar's contact patch [m]
  double counter_radius = 0.0;                ///< R_2 of groove or cylinder [m]
  double counter_depth = 0.0;                 ///< of a plane, down to what holds it; 0: none [m]
  double length = 0.0;                        ///< h, length of the line [m]
  double modulus = 0.0, poisson_ratio = 0.0;  ///< bar [Pa], [-]
  double counter_modulus = 0.0, counter_poisson_ratio = 0.0;  ///< stop [Pa], [-]
  /// A name of elastic_laws(), or "none": there is no stop, and `position` is just a place.
  std::string law = "goldsmith";
  int exponent = 1;  ///< of the length in Goldsmith's logarithm: 1 (the paper) or 3 (consistent)
  std::optional<double> reference_length = {};  ///< the unit of exponent 1; none: 1 m, told [m]
  double stiffness = 0.0;                       ///< K of laws that take it [N/mⁿ]
  double power = 1.0;                           ///< n of those [-]
  double stiffness_factor = 1.0;                ///< on the force at equal penetration [-]
  std::string damping = "lankarani-nikravesh";  ///< a name of damping_laws()
  double restitution = 1.0;                     ///< e in the damping law [-]
  /// The speed at which e is meant, for all contacts; none: as the damping law has it [m/s].
  std::optional<double> restitution_speed = {};
  std::optional<double> viscous = {};          ///< c of the law "viscous"; none: of e [N s/m]
  std::optional<double> relaxation_time = {};  ///< τ of the law "kuwabara-kono"; none: of e [s]
  /// For damping laws made of a damping ratio; none: of the rigid bar about its hinge [kg].
  std::optional<double> effective_mass = {};
  Tension tension = Tension::clip;

  /// Whether the damping law is made of e: "none" is not, nor one whose coefficient is stated.
  bool takes_restitution() const { return damping != "none" && !viscous && !relaxation_time; }

  bool operator==(const Contact&) const = default;
};

/// A stop that gives way: the struck head, a mass on the spring and damper of its sensor, which the
/// ground carries.
struct Stop {
  double mass = 0.0;       ///< m of the head and what moves with it [kg], > 0
  double stiffness = 0.0;  ///< k [N/m], > 0
  double viscous = 0.0;    ///< c [N s/m]

  bool operator==(const Stop&) const = default;
};

/// Where a stop stands: where the bar swings to, or where it rebounds to.
enum class StopSide { near, far };

std::string_view name(StopSide side);

/// A stop besides the one that is struck first, rigid and with a contact of its own.
struct FurtherStop {
  Contact contact;
  StopSide side = StopSide::near;
  double gap = 0.0;  ///< to the bar as it is at touch, straight [m], >= 0

  /// Sign with which the bar's motion towards closing closes the gap.
  double direction() const { return side == StopSide::near ? 1.0 : -1.0; }

  bool operator==(const FurtherStop&) const = default;
};

/// How the impact begins: a given speed of the struck point at first touch, or a release from rest.
struct Start {
  double velocity = 0.0;  ///< closing speed of the struck point [m/s], > 0
  /// From where the bar touches [rad]; then `velocity` is not used.
  std::optional<double> release_angle;

  bool operator==(const Start&) const = default;
};

/// The experiment, without sensors and without numerics. All SI.
struct Rig {
  Beam beam;
  Contact contact;
  Start start;
  Hinge hinge = {};
  std::optional<Stop> stop = {};  ///< none: rigid
  std::vector<FurtherStop> further_stops = {};
  double gravity = 9.81;  ///< [m/s^2]
  /// Where gravity points, from the direction hinge to tip of the bar at touch towards closing
  /// [rad]: 0 the bar hangs, π/2 it is pulled into the stop, π it stands upright.
  double gravity_direction = 0.0;

  bool has_stop() const { return contact.law != "none"; }

  /// How many there are; `contact` is that of number 0.
  int stops() const { return has_stop() ? 1 + static_cast<int>(further_stops.size()) : 0; }

  const Contact& contact_of(int number) const;

  /// Of the rigid bar about its hinge, seen from a struck point: I / x² [kg].
  double effective_mass(int number) const;

  /// Parts of gravity from the hinge to the tip and towards closing, of the bar at touch [m/s^2].
  double gravity_along() const;
  double gravity_across() const;

  bool operator==(const Rig&) const = default;
};

/// A number of the rig, by reference.
using RigParameter = double& (*)(Rig& rig);

/// Whether anything but the contact takes energy.
bool damped(const Rig& rig);

/// What of the rig small motion does not know, as rig-file keys; empty when it knows all.
std::string beyond_small_motion(const Rig& rig);

enum class BeamModel { rigid, hybrid, ancf };
enum class Basis { cantilever, pinned_free };

std::string_view name(BeamModel model);
std::string_view name(Basis basis);

/// How to solve. Defaults are what simulate() chooses when the rig file is silent.
struct Solver {
  BeamModel model = BeamModel::ancf;
  /// ANCF: hinge to struck point, struck point to tip; the second may be 0.
  std::array<int, 2> elements = {14, 2};
  int modes = 7;                          ///< hybrid: bending modes
  int axial_modes = 0;                    ///< hybrid
  Basis basis = Basis::cantilever;        ///< hybrid
  static constexpr int most_modes = 120;  ///< stated; a finer run that tells their error has twice
  static constexpr double finest_accuracy = 1e-13, coarsest_accuracy = 0.1;
  double accuracy = 1e-6;          ///< relative, of the time integration
  std::optional<double> duration;  ///< from first touch [s]; none: until the bar has left for good
  double time_limit = 60.0;        ///< processor time a run may take [s]

  bool operator==(const Solver&) const = default;
};

/// Whether the spring of the hinge bends the bar noticeably: then a release from rest is no swing
/// of a rigid bar.
bool spring_bends_bar(const Rig& rig);

/// Closing speed of the struck point at first touch [m/s]: as stated, or the rigid bar's after its
/// release. Throws std::invalid_argument when a released bar does not arrive.
double touch_velocity(const Rig& rig);

/// Throws std::invalid_argument with one sentence that names the rig-file key when a value makes no
/// sense: a struck point beyond the bar, e outside [0, 1], a groove not wider than the bar, ...
void validate(const Rig& rig, const Solver& solver);

}  // namespace impactrig::models
