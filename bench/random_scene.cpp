// SPDX-License-Identifier: BSD-3-Clause
#include "bench/random_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/random_stream.hpp"
#include "models/beams/bar_element.hpp"
#include "models/contact/contact_force.hpp"
#include "models/simulation.hpp"

namespace impactrig::bench {
namespace {

// What resolving a mesh's vibrations over a drawn duration may cost, a fifth of the usual limit: or
// being late would say nothing. Not of the limit stated, on which a scene must not depend.
constexpr double affordable_time = 0.6;       // [s]
constexpr double evaluations_of_step = 13.0;  // events and extrema included

/// Highest angular frequency of the mesh or the modes, to a factor of two [rad/s].
double fastest_vibration(const models::Rig& rig, const models::Solver& solver) {
  const models::Beam& beam = rig.beam;
  const double wave_speed = std::sqrt(beam.youngs_modulus / beam.density);
  double gyration = 0.0;  // of its thickest part
  for (const models::BarElement& piece : models::bar_pieces(beam))
    gyration = std::max(gyration, std::sqrt(piece.bending_stiffness / piece.axial_stiffness));
  if (solver.model == models::BeamModel::rigid) return 0.0;
  if (solver.model == models::BeamModel::hybrid) {
    const double wave_number = (solver.modes + 0.25) * std::numbers::pi / beam.length;
    return wave_speed * std::max(gyration * wave_number * wave_number,
                                 solver.axial_modes * std::numbers::pi / beam.length);
  }
  double shortest = rig.contact.position / solver.elements[0];
  if (solver.elements[1] > 0)
    shortest = std::min(shortest, (beam.length - rig.contact.position) / solver.elements[1]);
  // √8400 and √180 bound a free element's bending and axial vibration; assembled ones have half
  return wave_speed * std::max(45.0 * gyration / (shortest * shortest), 7.0 / shortest);
}

/// What the right-hand side costs, to a factor of two [s].
double evaluation_time(const models::Solver& solver) {
  const double modes = solver.modes + solver.axial_modes;
  switch (solver.model) {
    case models::BeamModel::rigid:
      return 1e-6;
    case models::BeamModel::hybrid:
      return 1e-6 + 1e-9 * (20.0 + 4.0 * modes) * (10.0 + modes * modes);
    case models::BeamModel::ancf:
      return 0.15e-6 * (solver.elements[0] + solver.elements[1]);
  }
  return 0.0;
}

/// What can be afforded, where the fastest vibration has to be resolved [s].
double affordable_duration(const Scene& scene, double longest_period) {
  const models::Solver& solver = scene.file.solver;
  const double fastest = std::max(fastest_vibration(scene.file.rig, solver), 1.0 / longest_period);
  return affordable_time / (evaluations_of_step * evaluation_time(solver)) * 2.0 *
         std::numbers::pi / fastest;
}

/// How long to simulate [s]; 0: the rig file leaves it to simulate().
double draw_duration(SceneText& text, const Scene& scene) {
  const models::Rig& rig = scene.file.rig;
  const double chance = text.uniform();
  if (scene.family == "impact") return scene.contact_time * std::exp(chance * std::log(30.0));
  if (scene.family == "to the end") return 0.0;
  // Gravity brings a rigid bar back after half a swing, however hard it left.
  const double half_swing = std::numbers::pi / std::sqrt(1.5 * rig.gravity / rig.beam.length);
  const double wanted = scene.family == "bounces"
                            ? half_swing * std::exp(chance * std::log(100.0))
                            : scene.contact_time * std::exp(chance * std::log(1e4));
  const double affordable = affordable_duration(scene, scene.contact_time);
  return std::min(wanted, std::max(affordable, 2.0 * scene.contact_time));
}

/// Of a bar without a stop: parts of a swing, or of its being turned, to some tens of them [s].
double draw_free_duration(SceneText& text, const Scene& scene) {
  const models::Rig& rig = scene.file.rig;
  double time = 0.0;
  if (rig.hinge.rotation) {
    time = std::max(rig.hinge.rotation->time, 1.0 / std::abs(rig.hinge.rotation->rate));
  } else {
    const double rate = rig.start.velocity / rig.beam.length;
    time = 1.0 / std::sqrt(1.5 * rig.gravity / rig.beam.length + rate * rate +
                           rig.hinge.spring / rig.beam.hinge_inertia());
  }
  const double wanted = time * std::exp(text.uniform() * std::log(1e3) - std::log(10.0));
  return std::min(wanted, affordable_duration(scene, time));
}

/// Tables of one to three further stops, in one scene of four; gaps from none to far beyond the
/// penetration.
std::string draw_further_stops(std::uint64_t seed, const Scene& scene) {
  acquisition::RandomStream random(seed, fmt::format("further stops {}", scene.number));
  if (random.uniform() >= 0.25) return "";
  const models::Rig& rig = scene.file.rig;
  const double turned = touch_velocity(rig) / rig.contact.position;
  const double energy = 0.5 * rig.beam.hinge_inertia() * turned * turned;
  const double depth = models::penetration_storing(models::ContactForce(rig), energy);
  const int count = 1 + static_cast<int>(random.uniform(0.0, 3.0));
  std::string text;
  for (int k = 0; k < count; ++k) {
    const bool far = random.uniform() < 0.5;
    const double place = random.uniform() < 0.2 ? 1.0 : random.uniform(0.02, 0.999);
    double gap = random.uniform() < 0.15 ? 0.0 : depth * std::exp(random.uniform(-5.0, 8.0));
    if (far && rig.start.release_angle) gap += 1.001 * place * rig.beam.length;
    const double e = std::max(random.uniform(), 0.005);
    text += fmt::format(
        "\n[[contacts]]\nside = \"{}\"\nposition = \"{:.17g} m\"\ngap = \"{:.17g} m\"\n"
        "restitution = {:.17g}\nstiffness_factor = {:.17g}\n",
        far ? "far" : "near", place * rig.beam.length, gap, e, std::exp(random.uniform(-2.0, 2.0)));
  }
  return text;
}

/// A rigid bar's on the elastic law, roughly [s].
double contact_time_of(const models::Rig& rig) {
  const double speed = touch_velocity(rig);
  const double turned = speed / rig.contact.position;
  const double energy = 0.5 * rig.beam.hinge_inertia() * turned * turned;
  return 3.0 * models::penetration_storing(models::ContactForce(rig), energy) / speed;
}

/// What the rig file leaves open, and what the scene is: of a rig file that can be read.
void complete_scene(std::uint64_t seed, SceneText& text, Scene& scene) {
  const std::string name = fmt::format("scene {}", scene.number);
  const auto state_duration = [&](double duration) {
    if (duration > 0.0) scene.toml += fmt::format("duration = \"{:.9g} s\"\n", duration);
  };
  double duration = 0.0;
  if (scene.without_stop) {
    // how long is drawn by what the rig is, which cannot be read without it
    scene.file = fitting::parse_rig_file(scene.toml + "duration = \"1 s\"\n", name);
    duration = draw_free_duration(text, scene);
    state_duration(duration);
  } else {
    scene.file = fitting::parse_rig_file(scene.toml, name);
    scene.contact_time = contact_time_of(scene.file.rig);
    duration = draw_duration(text, scene);
    state_duration(duration);
    if (!text.stop_gives_way()) scene.toml += draw_further_stops(seed, scene);
  }
  scene.file = fitting::parse_rig_file(scene.toml, name);
  scene.periods = (duration > 0.0 ? duration : 0.1) *
                  fastest_vibration(scene.file.rig, scene.file.solver) / (2.0 * std::numbers::pi);
  scene.predicted = scene.periods * evaluations_of_step * evaluation_time(scene.file.solver);
}

}  // namespace

Scene draw_scene(std::uint64_t seed, long number, bool without_stop, Meshes meshes) {
  SceneText text = without_stop ? SceneText::without_stop(seed, number, meshes)
                                : SceneText::with_stop(seed, number, meshes);
  Scene scene;
  scene.number = number;
  scene.family = text.family();
  scene.without_stop = without_stop;
  scene.toml = text.text();
  try {
    complete_scene(seed, text, scene);
  } catch (const std::exception& problem) {
    scene.refusal = problem.what();
  }
  return scene;
}

}  // namespace impactrig::bench
