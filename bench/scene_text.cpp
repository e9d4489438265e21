// SPDX-License-Identifier: BSD-3-Clause
#include "bench/scene_text.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "models/contact/damping_law.hpp"

namespace impactrig::bench {

SceneText SceneText::with_stop(std::uint64_t seed, long number, Meshes meshes) {
  SceneText text(seed, fmt::format("scene {}", number), meshes);
  const double which = text.random_.uniform();
  text.family_ = which < 0.55   ? "impact"
                 : which < 0.67 ? "to the end"
                 : which < 0.83 ? "bounces"
                                : "grazing";
  text.draw_beam();
  text.draw_contact();
  text.draw_start();
  text.draw_solver();
  return text;
}

SceneText SceneText::without_stop(std::uint64_t seed, long number, Meshes meshes) {
  SceneText text(seed, fmt::format("scene {} without a stop", number), meshes);
  text.family_ = text.chance(0.6) ? "swing" : "spin-up";
  text.at_tip_ = true;
  text.draw_beam();
  if (text.spins_up())
    text.draw_rotation();
  else
    text.draw_swing();
  text.draw_solver();
  return text;
}

void SceneText::draw_beam() {
  length_ = spread(0.01, 100.0);
  radius_ = length_ * spread(3e-4, 0.1);
  modulus_ = grazing() ? spread(1e6, 1e9) : spread(1e6, 2.1e11);
  // rubber 1000, steel 7850 kg/m^3, and what lies between
  const double stiffness = std::log(modulus_ / 1e6) / std::log(2.1e5);
  const double density =
      1000.0 * std::pow(7.85, std::min(stiffness, 1.0)) * random_.uniform(0.7, 1.4);
  mass_ = density * std::numbers::pi * radius_ * radius_ * length_;
  // of a free round bar's first bending mode
  slowest_ = 15.4 * std::sqrt(modulus_ / density) * 0.5 * radius_ / (length_ * length_);
  const std::string section = draw_section();
  add("[beam]");
  if (featured(0.1)) {
    draw_segments();
  } else {
    add("length = \"{:.17g} m\"\nsection = {}", length_, section);
  }
  add("youngs_modulus = \"{:.17g} Pa\"\npoisson_ratio = {:.6f}\ndensity = \"{:.17g} kg/m^3\"",
      modulus_, random_.uniform(0.0, 0.5), density);
  if (chance(0.25)) add("theory = \"timoshenko\"");
  if (featured(0.2))
    add("damping = {{ mass = \"{:.17g} 1/s\", stiffness = \"{:.17g} s\" }}",
        featured(0.7) ? 0.0 : slowest_ * feature(1e-4, 1.0),
        featured(0.3) ? 0.0 : feature(1e-7, 0.3) / slowest_);
}

std::string SceneText::draw_section() {
  switch (choice(4)) {
    case 0:
      return fmt::format(
          "{{ shape = \"rectangle\", width = \"{:.17g} m\", height = \"{:.17g} m\" }}",
          radius_ * spread(0.1, 10.0), 2.0 * radius_);
    case 1:
      return fmt::format("{{ shape = \"tube\", radius = \"{:.17g} m\", wall = \"{:.17g} m\" }}",
                         radius_, radius_ * spread(0.01, 0.9));
    default:
      return fmt::format("{{ shape = \"circle\", radius = \"{:.17g} m\" }}", radius_);
  }
}

/// Two or three round ones.
void SceneText::draw_segments() {
  const int count = featured(0.5) ? 2 : 3;
  text_ += "segments = [";
  double left = 1.0;
  for (int k = 0; k < count; ++k) {
    const double part = k + 1 < count ? left * features_.uniform(0.1, 0.9) : left;
    left -= part;
    text_ += fmt::format(
        "{}{{ length = \"{:.17g} m\", section = {{ shape = \"circle\", radius = \"{:.17g} m\" }} "
        "}}",
        k > 0 ? ", " : "", part * length_, radius_ * feature(0.3, 3.0));
  }
  add("]");
}

/// On the axis, from what the bar hardly feels to what makes it a shaft.
void SceneText::draw_masses() {
  if (!featured(0.15)) return;
  const int count = featured(0.6) ? 1 : 2;
  for (int k = 0; k < count; ++k)
    add("\n[[beam.masses]]\nposition = \"{:.17g} m\"\nmass = \"{:.17g} kg\"",
        (featured(0.5) ? 1.0 : features_.uniform(0.01, 1.0)) * length_,
        mass_ * feature(1e-4, 30.0));
}

void SceneText::draw_hinge(double friction) {
  const bool sprung = featured(0.15), damped = featured(0.1);
  if (friction == 0.0 && !sprung && !damped) return;
  add("\n[hinge]");
  if (friction > 0.0) add("friction = \"{:.17g} N.m\"", friction);
  if (sprung)
    add("spring = \"{:.17g} N.m/rad\"",
        modulus_ * std::pow(radius_, 4) / length_ * feature(1e-5, 30.0));
  if (damped)
    add("viscous = \"{:.17g} N.m.s/rad\"",
        mass_ * length_ * length_ * slowest_ * feature(1e-6, 1.0));
}

void SceneText::draw_stop() {
  if (!featured(0.12)) return;
  gives_way_ = true;
  const double mass = mass_ * feature(1e-3, 1e2);
  const double stiffness = modulus_ * radius_ * feature(1e-4, 1e4);
  add("\n[stop]\nmass = \"{:.17g} kg\"\nstiffness = \"{:.17g} N/m\"", mass, stiffness);
  if (featured(0.5))
    add("viscous = \"{:.17g} N.s/m\"", std::sqrt(mass * stiffness) * feature(1e-4, 4.0));
}

void SceneText::draw_contact() {
  at_tip_ = chance(0.1);
  const double position = at_tip_        ? 1.0
                          : grazing()    ? random_.uniform(0.03, 0.4)
                          : chance(0.15) ? spread(1e-3, 0.1)
                          : chance(0.1)  ? 1.0 - spread(1e-6, 1e-2)
                                         : random_.uniform(0.05, 0.999);
  add("\n[contact]\nposition = \"{:.17g} m\"", position * length_);
  add("radius = \"{:.17g} m\"", radius_);
  const int face = choice(3);
  switch (face) {
    case 0:
      add("counterface = {{ shape = \"groove\", radius = \"{:.17g} m\" }}",
          radius_ * (1.0 + spread(1e-6, 1.0)));
      break;
    case 1:
      add("counterface = {{ shape = \"cylinder\", radius = \"{:.17g} m\" }}",
          radius_ * spread(0.01, 100.0));
      break;
    default:
      add("counterface = {{ shape = \"plane\", depth = \"{:.17g} m\" }}", 3.0 * radius_);
  }
  const double line = radius_ * spread(0.1, 10.0);
  add("length = \"{:.17g} m\"\ncounter_modulus = \"{:.17g} Pa\"\ncounter_poisson_ratio = {:.6f}",
      line, modulus_ * spread(1e-4, 1e4), random_.uniform(0.0, 0.5));
  draw_elastic_law(face, line);
  draw_damping();
}

/// One that knows the counterface: 0 a groove, 1 a cylinder, 2 a plane.
void SceneText::draw_elastic_law(int face, double line) {
  if (chance(0.2)) {
    add("law = \"linear\"\nstiffness = \"{:.17g} N/m\"", modulus_ * line * spread(1e-4, 10.0));
    return;
  }
  if (chance(0.4)) {
    add("law = \"goldsmith\"\nexponent = {}", chance(0.5) ? 1 : 3);
    return;
  }
  if (chance(0.1)) {  // f = K δⁿ as stiff as the linear ones at a thousandth of the line
    const double power = random_.uniform(1.0, 3.0);
    add("law = \"lankarani-nikravesh-cylinder\"\nstiffness = \"{:.17g} N/m^{:.6f}\"",
        modulus_ * line * spread(1e-4, 10.0) * std::pow(1e-3 * line, 1.0 - power), power);
    return;
  }
  constexpr std::array everywhere = {"dubowsky-freudenstein", "johnson", "palmgren", "brandlein",
                                     "hertz-point"};
  constexpr std::array with_radius = {"esdu-78035", "radzimovsky", "radzimovsky-1.60", "pereira"};
  constexpr std::array in_groove = {"liu", "persson"};
  const auto pick = [&](const auto& names) {
    add("law = \"{}\"", names[static_cast<std::size_t>(choice(static_cast<int>(names.size())))]);
  };
  if (face == 0 && chance(0.3))
    pick(in_groove);
  else if (face < 2 && chance(0.4))
    pick(with_radius);
  else
    pick(everywhere);
}

void SceneText::draw_damping() {
  const auto laws = models::damping_laws();
  const models::DampingLaw& damping =
      laws[static_cast<std::size_t>(choice(static_cast<int>(laws.size())))];
  double e = chance(0.05) ? 0.0 : chance(0.05) ? 1.0 : random_.uniform();
  e = std::max(e, damping.text.smallest_restitution);
  if (chance(0.15)) add("tension = \"allow\"");
  add("damping = \"{}\"\nrestitution = {:.17g}", damping.text.name, e);
}

void SceneText::draw_start() {
  const bool released = chance(0.08);
  double gravity = chance(0.3) ? 0.0 : chance(0.6) ? 9.81 : spread(0.01, 1000.0);
  if ((released || family_ == "bounces" || grazing()) && gravity == 0.0) gravity = 9.81;
  const double angle = released ? spread(1e-6, 3.1) : 0.0;
  const double speed = grazing() ? spread(1e-6, 1e-2) : spread(1e-3, 50.0);
  set_moving(released ? std::optional(angle) : std::nullopt, speed, gravity, 0.2);
  draw_masses();
  draw_stop();
  draw_environment(gravity);
}

/// By a release or a speed, with some chance against friction: from what an impact does not see to
/// what ends the swing within it.
void SceneText::set_moving(std::optional<double> angle, double speed, double gravity,
                           double chance_of_friction) {
  if (angle)
    add("\n[start]\nrelease_angle = \"{:.17g} rad\"", *angle);
  else
    add("\n[start]\nvelocity = \"{:.17g} m/s\"", speed);
  draw_hinge(chance(chance_of_friction)
                 ? mass_ * (angle ? gravity * length_ * *angle * spread(1e-5, 1.0)
                                  : speed * speed * spread(1e-4, 1e3))
                 : 0.0);
}

void SceneText::draw_solver() {
  if (meshes_ == Meshes::open) {
    add("\n[solver]\nmodel = \"ancf\"\naccuracy = {:.6e}", spread(3e-6, 1e-3));
    return;
  }
  const bool fine = meshes_ == Meshes::fine;
  switch (fine ? 1 + choice(2) : choice(3)) {
    case 0:
      add("\n[solver]\nmodel = \"rigid\"");
      break;
    case 1: {
      const int axial = chance(0.25) ? 1 + choice(4) : 0;
      const double modes = fine ? spread(40.0, 120.0) : spread(1.0, 40.0);
      add("\n[solver]\nmodel = \"hybrid\"\nmodes = {}\naxial_modes = {}\nbasis = \"{}\"",
          static_cast<int>(modes), axial, chance(0.5) || spins_up() ? "cantilever" : "pinned-free");
      break;
    }
    default:
      fine ? draw_elements(40.0, 800.0, 200.0) : draw_elements(1.0, 40.0, 10.0);
  }
  add("accuracy = {:.6e}", fine ? spread(1e-10, 1e-7) : spread(1e-8, 1e-3));
}

void SceneText::draw_elements(double fewest, double most, double most_beyond) {
  const int before = static_cast<int>(spread(fewest, most));
  add("\n[solver]\nmodel = \"ancf\"\nelements = [{}, {}]", before,
      at_tip_ ? 0 : static_cast<int>(spread(1.0, most_beyond)));
}

/// From the least to a turn and more, under its weight, its spring or neither.
void SceneText::draw_swing() {
  const bool released = chance(0.7);
  const double gravity = !released && chance(0.3) ? 0.0 : chance(0.6) ? 9.81 : spread(0.01, 1000.0);
  const double angle = released ? spread(1e-6, 3.1) : 0.0;
  const double speed = spread(1e-3, 50.0);
  set_moving(released ? std::optional(angle) : std::nullopt, speed, gravity, 0.25);
  draw_masses();
  draw_environment(gravity);
}

/// The tip's speed is that of impacts; from at once to many periods of the slowest bending.
void SceneText::draw_rotation() {
  const double rate = spread(1e-3, 50.0) / length_ * (chance(0.3) ? -1.0 : 1.0);
  const double time = chance(0.15) ? 0.0 : spread(0.1, 100.0) / slowest_;
  if (chance(0.2)) add("\n[start]\nrelease_angle = \"{:.17g} rad\"", random_.uniform(0.0, 3.1));
  add("\n[hinge]\nrotation = {{ rate = \"{:.17g} rad/s\", time = \"{:.17g} s\" }}", rate, time);
  draw_masses();
  draw_environment(chance(0.5) ? 0.0 : chance(0.6) ? 9.81 : spread(0.01, 1000.0));
}

void SceneText::draw_environment(double gravity) {
  add("\n[environment]\ngravity = \"{:.17g} m/s^2\"", gravity);
  if (featured(0.2)) add("gravity_direction = \"{:.17g} rad\"", features_.uniform(-3.1, 3.1));
}

}  // namespace impactrig::bench
