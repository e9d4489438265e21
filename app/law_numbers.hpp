// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fitting/rig_file.hpp"
#include "models/contact/damping_law.hpp"
#include "models/contact/elastic_law.hpp"
#include "models/contact/free_impact.hpp"
#include "models/rig.hpp"

/// What `impactrig laws` tells of a law, as numbers.
namespace impactrig::app {

/// Where laws are compared: a contact and the free impact of a rigid body on it.
struct LawScene {
  models::Rig rig;
  models::Solver solver;
  std::string origin;   ///< of the rig, for the reader
  double mass = 0.0;    ///< of the rigid bar about its hinge [kg]
  double speed = 0.0;   ///< at touch [m/s]
  double energy = 0.0;  ///< m v² / 2 [J]
  double depth = 0.0;   ///< where the rig's own elastic law has stored that [m]
};

/// Of a rig file, or of the shipped example where `path` is empty. Throws datasets::InputError and
/// FileError as reading does, std::invalid_argument for a rig without a stop.
LawScene law_scene(const std::string& path, const std::vector<fitting::Override>& overrides);

/// A contact with a law in place of its own.
struct LawContact {
  models::Contact contact;
  std::string stand_in = {};  ///< a sentence on a stiffness the rig does not state; "" none
};

/// Throws std::invalid_argument where the law has no formula for the contact.
LawContact with_elastic(const LawScene& scene, std::string_view law);

/// What the rig states of damping besides the restitution (`viscous`, `relaxation_time`) is kept
/// only for its own law, and only when `as_stated`. Throws std::invalid_argument where the law
/// cannot have the restitution.
models::Contact with_damping(const LawScene& scene, std::string_view law, double restitution,
                             bool as_stated = false);

struct ElasticFigures {
  double penetration = 0.0, force = 0.0, stiffness = 0.0, energy = 0.0;  ///< SI
  std::optional<double> limit_force = {};  ///< where the law ends [N]; none: it goes on
  std::optional<double> half_width = {};   ///< of the contact, of the bar's radius [-]
  std::vector<models::LawDerivative> derivatives = {};
  std::vector<std::string> warnings = {};
};

ElasticFigures elastic_figures(const models::Contact& contact, double penetration);

/// Where the law ends: f* of the logarithmic ones, the force at limit_penetration() of others [N].
std::optional<double> limit_force(const models::ElasticLaw& law);

/// −v₊/v₋ of a free rigid impact: by the closed form where damping is in proportion to the elastic
/// force, else by free_impact(). None where the law cannot have the restitution.
std::optional<double> free_rebound(const LawScene& scene, const models::Contact& contact);

/// The free rigid impact itself.
models::FreeImpact free_rigid_impact(const LawScene& scene, const models::Contact& contact,
                                     bool loop = false, int steps = 512);

struct ReboundPoint {
  double restitution = 0.0;
  std::optional<double> clipped = {}, tension = {};  ///< rebound with tension kept at zero, allowed
};

struct DampingFigures {
  std::optional<double> restitution = {};      ///< asked for; none: the rig states a coefficient
  std::optional<double> factor = {};           ///< d, of proportional and implicit laws
  std::optional<double> damping_ratio = {};    ///< ζ, of laws made of one
  std::optional<double> relaxation_time = {};  ///< τ [s]
  std::optional<double> rebound = {};
  std::vector<ReboundPoint> curve = {};  ///< e = 0.05, 0.10, ... 1
  std::vector<std::string> warnings = {};

  bool tension_matters() const;
};

DampingFigures damping_figures(const LawScene& scene, const models::Contact& contact);

/// The e_out of a damping law beside one elastic law, for e_in = 0.1, 0.2, ... 1.
struct ReboundRow {
  std::string_view damping, elastic;
  std::array<std::optional<double>, 10> rebound = {};
};

/// All damping laws beside three families, three rows each.
std::vector<ReboundRow> rebound_table(const LawScene& scene);

struct ElasticCurve {
  const models::ElasticLawText* law;
  models::Contact contact;
  std::string stand_in;
  models::FreeImpact impact;  ///< undamped
  double force = 0.0;         ///< at the depth of the rig's impact [N]
};

struct DampingLoop {
  const models::DampingLawText* law;
  models::FreeImpact impact;  ///< with its loop
};

struct Refusal {
  std::string_view law;
  std::string reason;
};

struct LawComparison {
  std::vector<ElasticCurve> elastic;  ///< by force, largest first
  std::vector<DampingLoop> damping;   ///< by peak force, largest first
  std::vector<Refusal> refused;
};

LawComparison compare_laws(const LawScene& scene);

}  // namespace impactrig::app
