// SPDX-License-Identifier: BSD-3-Clause
#include "app/law_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "app/embedded.hpp"
#include "models/contact/damping/exact.hpp"

namespace impactrig::app {
namespace {

using models::Contact;
using models::DampingForm;

/// How far a rebound may be from the restitution asked for before that is told.
constexpr double small_difference = 0.02;

/// ζ is what the factor of these forms is.
bool made_of_damping_ratio(DampingForm form) {
  return form == DampingForm::constant || form == DampingForm::natural ||
         form == DampingForm::tangent || form == DampingForm::closing;
}

std::string face(const Contact& contact) {
  switch (contact.counterface) {
    case models::Counterface::groove:
      return fmt::format("in a groove of {:.4g} mm", 1e3 * contact.counter_radius);
    case models::Counterface::cylinder:
      return fmt::format("on a cylinder of {:.4g} mm", 1e3 * contact.counter_radius);
    case models::Counterface::plane:
      return "on a plane";
  }
  return "";
}

std::string described(const std::string& origin, const LawScene& scene) {
  const Contact& c = scene.rig.contact;
  std::string text = origin + ": ";
  if (c.counter_radius > 0.0 || c.counterface == models::Counterface::plane)
    text += fmt::format("R1 {:.4g} mm {}, ", 1e3 * c.radius, face(c));
  if (c.length > 0.0) text += fmt::format("L {:.4g} mm, ", 1e3 * c.length);
  if (c.counter_modulus > 0.0)
    text += fmt::format("E {:.5g} and {:.5g} GPa, nu {:g} and {:g}, ", 1e-9 * c.modulus,
                        1e-9 * c.counter_modulus, c.poisson_ratio, c.counter_poisson_ratio);
  return text +
         fmt::format("rigid bar of {:.4g} kg (I/x^2) at {:.4g} m/s", scene.mass, scene.speed);
}

}  // namespace

LawScene law_scene(const std::string& path, const std::vector<fitting::Override>& overrides) {
  const embedded::EmbeddedFile& example = embedded::shen2007_toml;
  const fitting::RigFile file = path.empty()
                                    ? fitting::parse_rig_file(std::string(example.bytes),
                                                              std::string(example.name), overrides)
                                    : fitting::read_rig_file(path, overrides);
  if (!file.rig.has_stop())
    throw std::invalid_argument(path + ": the rig has no [contact], so no contact law");
  LawScene scene{.rig = file.rig, .solver = file.solver, .origin = {}};
  scene.mass = scene.rig.effective_mass(0);
  scene.speed = models::touch_velocity(scene.rig);
  scene.energy = 0.5 * scene.mass * scene.speed * scene.speed;
  scene.depth = models::penetration_storing(models::elastic_law(scene.rig.contact), scene.energy);
  scene.origin = described(
      path.empty() ? fmt::format("the shipped example, {} (Shen et al. 2007)", example.name) : path,
      scene);
  return scene;
}

LawContact with_elastic(const LawScene& scene, std::string_view law) {
  LawContact choice;
  models::Rig rig = scene.rig;
  rig.contact.law = law;
  const models::LawNeeds& needs = models::elastic_law_entry(law).text.needs;
  if (needs.stiffness && scene.rig.contact.law != law) {
    const double power = needs.power ? 1.5 : 1.0;
    rig.contact.power = power;
    rig.contact.stiffness = (power + 1.0) * scene.energy / std::pow(scene.depth, power + 1.0) /
                            rig.contact.stiffness_factor;
    choice.stand_in = fmt::format(
        "the rig states no stiffness for '{}'; {:.4g} N/m{} stands in, which takes the impact's "
        "energy as deep as '{}' does. State yours: --set contact.law={} --set "
        "contact.stiffness=\"...\"",
        law, rig.contact.stiffness, needs.power ? "^1.5" : "", scene.rig.contact.law, law);
  }
  models::validate(rig, scene.solver);
  choice.contact = rig.contact;
  return choice;
}

Contact with_damping(const LawScene& scene, std::string_view law, double restitution,
                     bool as_stated) {
  models::Rig rig = scene.rig;
  if (!as_stated || rig.contact.damping != law)
    rig.contact.viscous = rig.contact.relaxation_time = std::nullopt;
  rig.contact.damping = law;
  rig.contact.restitution = restitution;
  models::validate(rig, scene.solver);
  return rig.contact;
}

std::optional<double> limit_force(const models::ElasticLaw& law) {
  if (const auto* logarithmic = std::get_if<models::LogarithmicContact<>>(&law))
    return logarithmic->limit_force;
  const double limit = models::limit_penetration(law);
  if (!std::isfinite(limit)) return std::nullopt;
  return models::elastic_force(law, limit);
}

ElasticFigures elastic_figures(const Contact& contact, double penetration) {
  const models::ElasticLaw law = models::elastic_law(contact);
  const models::ElasticState state = models::elastic_state(law, penetration);
  ElasticFigures figures{.penetration = penetration,
                         .force = state.force,
                         .stiffness = state.stiffness,
                         .energy = state.energy,
                         .limit_force = limit_force(law)};
  if (const double half = models::half_width(contact, state.force); half > 0.0)
    figures.half_width = half / contact.radius;
  figures.derivatives = models::elastic_derivatives(contact, penetration);
  figures.warnings = models::elastic_limits(contact, penetration);
  if (std::string unit = models::unit_dependence(contact, penetration); !unit.empty())
    figures.warnings.push_back(std::move(unit));
  return figures;
}

models::FreeImpact free_rigid_impact(const LawScene& scene, const Contact& contact, bool loop,
                                     int steps) {
  models::ContactForce force(contact, scene.mass);
  force.begin_episode(scene.speed);
  return models::free_impact(force, scene.mass, scene.speed, steps, loop);
}

std::optional<double> free_rebound(const LawScene& scene, const Contact& contact) {
  const models::DampingLawText& law = models::damping_law(contact.damping).text;
  if (contact.restitution < law.smallest_restitution) return std::nullopt;
  try {
    if (law.form != DampingForm::proportional)
      return free_rigid_impact(scene, contact).rebound_ratio;
    models::ContactForce force(contact, scene.mass);
    force.begin_episode(scene.speed);
    return models::free_rebound_ratio(force.strength() * scene.speed);
  } catch (const std::runtime_error&) {  // no finite force on the way
    return std::nullopt;
  }
}

bool DampingFigures::tension_matters() const {
  return std::ranges::any_of(curve, [](const ReboundPoint& point) {
    return point.clipped && point.tension && std::abs(*point.clipped - *point.tension) > 1e-9;
  });
}

DampingFigures damping_figures(const LawScene& scene, const Contact& contact) {
  const models::DampingLaw& law = models::damping_law(contact.damping);
  const DampingForm form = law.text.form;
  const double e = contact.restitution;
  DampingFigures figures{.rebound = free_rebound(scene, contact)};
  if (!contact.viscous && !contact.relaxation_time) figures.restitution = e;
  if (form == DampingForm::proportional || form == DampingForm::implicit)
    figures.factor = law.factor(e);
  if (made_of_damping_ratio(form) && !contact.viscous) figures.damping_ratio = law.factor(e);
  if (form == DampingForm::relaxing) {
    models::ContactForce force(contact, scene.mass);
    force.begin_episode(scene.speed);
    figures.relaxation_time = force.strength();
  }
  Contact trial = contact;
  trial.viscous = trial.relaxation_time = std::nullopt;
  for (int i = 1; i <= 20; ++i) {
    trial.restitution = i / 20.0;
    trial.tension = models::Tension::clip;
    ReboundPoint point{.restitution = trial.restitution, .clipped = free_rebound(scene, trial)};
    trial.tension = models::Tension::allow;
    point.tension = free_rebound(scene, trial);
    figures.curve.push_back(point);
  }
  if (contact.damping != "none" && figures.restitution && figures.rebound &&
      std::abs(*figures.rebound - e) > small_difference)
    figures.warnings.push_back(fmt::format(
        "a free rigid impact rebounds with {:.4f} where {:g} was asked for; the law 'exact' "
        "rebounds with what it is asked for",
        *figures.rebound, e));
  return figures;
}

std::vector<ReboundRow> rebound_table(const LawScene& scene) {
  constexpr int steps = 128;  // 1e-7: the table shows four digits
  const Contact goldsmith = with_elastic(scene, "goldsmith").contact;
  // linear: as stiff as takes the energy to Goldsmith's depth
  LawScene sprung = scene;
  sprung.rig.contact = goldsmith;
  sprung.depth = models::penetration_storing(models::elastic_law(goldsmith), scene.energy);
  std::vector<ReboundRow> rows;
  for (const models::DampingLaw& law : models::damping_laws())
    for (const std::string_view family : {"goldsmith", "hertz-point", "linear"}) {
      LawScene own = sprung;
      own.rig.contact = with_elastic(sprung, family).contact;
      ReboundRow row{law.text.name, family};
      for (std::size_t i = 0; i < row.rebound.size(); ++i) {
        const double e = (static_cast<double>(i) + 1.0) / 10.0;
        if (e < law.text.smallest_restitution) continue;
        const Contact contact = with_damping(own, law.text.name, e);
        row.rebound[i] = free_rigid_impact(own, contact, false, steps).rebound_ratio;
      }
      rows.push_back(row);
    }
  return rows;
}

LawComparison compare_laws(const LawScene& scene) {
  LawComparison comparison;
  for (const models::ElasticLawEntry& law : models::elastic_laws()) try {
      LawContact choice = with_elastic(scene, law.text.name);
      choice.contact.damping = "none";
      const models::ElasticLaw own = models::elastic_law(choice.contact);
      comparison.elastic.push_back({&law.text, choice.contact, choice.stand_in,
                                    free_rigid_impact(scene, choice.contact),
                                    models::elastic_force(own, scene.depth)});
    } catch (const std::exception& error) {
      comparison.refused.push_back({law.text.name, error.what()});
    }
  for (const models::DampingLaw& law : models::damping_laws()) try {
      const Contact contact =
          with_damping(scene, law.text.name, scene.rig.contact.restitution, true);
      comparison.damping.push_back({&law.text, free_rigid_impact(scene, contact, true, 128)});
    } catch (const std::exception& error) {
      comparison.refused.push_back({law.text.name, error.what()});
    }
  std::ranges::stable_sort(comparison.elastic, std::greater{}, &ElasticCurve::force);
  std::ranges::stable_sort(comparison.damping, std::greater{},
                           [](const DampingLoop& loop) { return loop.impact.peak_force; });
  return comparison;
}

}  // namespace impactrig::app
