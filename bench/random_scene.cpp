// SPDX-License-Identifier: BSD-3-Clause
#include "bench/random_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "acquisition/random_stream.hpp"
#include "models/beams/bar_element.hpp"
#include "models/contact/contact_force.hpp"
#include "models/contact/damping_law.hpp"
#include "models/simulation.hpp"

namespace impactrig::bench {
namespace {

// What resolving a mesh's vibrations over a drawn duration may cost, a fifth of the usual limit: or
// being late would say nothing. Not of the limit stated, on which a scene must not depend.
constexpr double affordable_time = 0.6;       // [s]
constexpr double evaluations_of_step = 13.0;  // events and extrema included

/// Draws the text of a rig file.
class SceneText {
 public:
  SceneText(std::uint64_t seed, long number)
      : random_(seed, fmt::format("scene {}", number)),
        features_(seed, fmt::format("features of scene {}", number)) {
    const double which = random_.uniform();
    family_ = which < 0.55 ? 0 : which < 0.67 ? 1 : which < 0.83 ? 2 : 3;
    draw_beam();
    draw_contact();
    draw_start();
    draw_solver();
  }

  std::string family() const { return scene_families[family_]; }

  /// Such a stop is the only one.
  bool stop_gives_way() const { return gives_way_; }

  const std::string& text() const { return text_; }

  /// Chance in [0, 1) for what is drawn when the text has been read.
  double uniform() { return random_.uniform(); }

 private:
  static double spread_of(acquisition::RandomStream& random, double low, double high) {
    return std::exp(random.uniform(std::log(low), std::log(high)));
  }

  double spread(double low, double high) { return spread_of(random_, low, high); }

  bool chance(double p) { return random_.uniform() < p; }

  bool featured(double p) { return features_.uniform() < p; }

  double feature(double low, double high) { return spread_of(features_, low, high); }

  int choice(int n) { return static_cast<int>(random_.uniform(0.0, n)); }

  template <typename... Args>
  void add(fmt::format_string<Args...> form, Args&&... args) {
    text_ += fmt::format(form, std::forward<Args>(args)...) + "\n";
  }

  bool grazing() const { return family() == "grazing"; }

  void draw_beam() {
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

  std::string draw_section() {
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
  void draw_segments() {
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
  void draw_masses() {
    if (!featured(0.15)) return;
    const int count = featured(0.6) ? 1 : 2;
    for (int k = 0; k < count; ++k)
      add("\n[[beam.masses]]\nposition = \"{:.17g} m\"\nmass = \"{:.17g} kg\"",
          (featured(0.5) ? 1.0 : features_.uniform(0.01, 1.0)) * length_,
          mass_ * feature(1e-4, 30.0));
  }

  void draw_hinge(double friction) {
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

  void draw_stop() {
    if (!featured(0.12)) return;
    gives_way_ = true;
    const double mass = mass_ * feature(1e-3, 1e2);
    const double stiffness = modulus_ * radius_ * feature(1e-4, 1e4);
    add("\n[stop]\nmass = \"{:.17g} kg\"\nstiffness = \"{:.17g} N/m\"", mass, stiffness);
    if (featured(0.5))
      add("viscous = \"{:.17g} N.s/m\"", std::sqrt(mass * stiffness) * feature(1e-4, 4.0));
  }

  void draw_contact() {
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
  void draw_elastic_law(int face, double line) {
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

  void draw_damping() {
    const auto laws = models::damping_laws();
    const models::DampingLaw& damping =
        laws[static_cast<std::size_t>(choice(static_cast<int>(laws.size())))];
    double e = chance(0.05) ? 0.0 : chance(0.05) ? 1.0 : random_.uniform();
    e = std::max(e, damping.text.smallest_restitution);
    if (chance(0.15)) add("tension = \"allow\"");
    add("damping = \"{}\"\nrestitution = {:.17g}", damping.text.name, e);
  }

  void draw_start() {
    const bool released = chance(0.08);
    double gravity = chance(0.3) ? 0.0 : chance(0.6) ? 9.81 : spread(0.01, 1000.0);
    if ((released || family() == "bounces" || grazing()) && gravity == 0.0) gravity = 9.81;
    const double angle = released ? spread(1e-6, 3.1) : 0.0;
    const double speed = grazing() ? spread(1e-6, 1e-2) : spread(1e-3, 50.0);
    if (released)
      add("\n[start]\nrelease_angle = \"{:.17g} rad\"", angle);
    else
      add("\n[start]\nvelocity = \"{:.17g} m/s\"", speed);
    // from what the impact does not see to what ends the swing within it
    draw_hinge(chance(0.2) ? mass_ * (released ? gravity * length_ * angle * spread(1e-5, 1.0)
                                               : speed * speed * spread(1e-4, 1e3))
                           : 0.0);
    draw_masses();
    draw_stop();
    add("\n[environment]\ngravity = \"{:.17g} m/s^2\"", gravity);
    if (featured(0.2)) add("gravity_direction = \"{:.17g} rad\"", features_.uniform(-3.1, 3.1));
  }

  void draw_solver() {
    switch (choice(3)) {
      case 0:
        add("\n[solver]\nmodel = \"rigid\"");
        break;
      case 1: {
        const int axial = chance(0.25) ? 1 + choice(4) : 0;
        add("\n[solver]\nmodel = \"hybrid\"\nmodes = {}\naxial_modes = {}\nbasis = \"{}\"",
            static_cast<int>(spread(1.0, 40.0)), axial, chance(0.5) ? "cantilever" : "pinned-free");
        break;
      }
      default:
        add("\n[solver]\nmodel = \"ancf\"\nelements = [{}, {}]",
            static_cast<int>(spread(1.0, 40.0)), at_tip_ ? 0 : static_cast<int>(spread(1.0, 10.0)));
    }
    add("accuracy = {:.6e}", spread(1e-8, 1e-3));
  }

  acquisition::RandomStream random_, features_;
  std::size_t family_ = 0;
  std::string text_;
  double length_ = 0.0, radius_ = 0.0, modulus_ = 0.0;
  double mass_ = 0.0;     // of a round bar
  double slowest_ = 0.0;  // [rad/s]
  bool at_tip_ = false, gives_way_ = false;
};

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
  const double period =
      2.0 * std::numbers::pi /
      std::max(fastest_vibration(rig, scene.file.solver), 1.0 / scene.contact_time);
  const double affordable =
      affordable_time / (evaluations_of_step * evaluation_time(scene.file.solver)) * period;
  return std::min(wanted, std::max(affordable, 2.0 * scene.contact_time));
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

/// What the rig file leaves open, and what the scene is: of a rig file that can be read.
void complete_scene(std::uint64_t seed, SceneText& text, Scene& scene) {
  const std::string name = fmt::format("scene {}", scene.number);
  scene.file = fitting::parse_rig_file(scene.toml, name);
  const models::Rig& rig = scene.file.rig;
  const double speed = touch_velocity(rig);
  const double turned = speed / rig.contact.position;
  const double energy = 0.5 * rig.beam.hinge_inertia() * turned * turned;
  scene.contact_time = 3.0 * models::penetration_storing(models::ContactForce(rig), energy) / speed;
  const double duration = draw_duration(text, scene);
  if (duration > 0.0) scene.toml += fmt::format("duration = \"{:.9g} s\"\n", duration);
  if (!text.stop_gives_way()) scene.toml += draw_further_stops(seed, scene);
  scene.file = fitting::parse_rig_file(scene.toml, name);
  scene.periods = (duration > 0.0 ? duration : 0.1) * fastest_vibration(rig, scene.file.solver) /
                  (2.0 * std::numbers::pi);
  scene.predicted = scene.periods * evaluations_of_step * evaluation_time(scene.file.solver);
}

}  // namespace

Scene draw_scene(std::uint64_t seed, long number) {
  SceneText text(seed, number);
  Scene scene;
  scene.number = number;
  scene.family = text.family();
  scene.toml = text.text();
  try {
    complete_scene(seed, text, scene);
  } catch (const std::exception& problem) {
    scene.refusal = problem.what();
  }
  return scene;
}

}  // namespace impactrig::bench
