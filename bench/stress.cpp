// SPDX-License-Identifier: BSD-3-Clause
//
// Random scenes far beyond any laboratory: does every one end in time with a sound answer or a
// sentence? Each scene is a rig file drawn from a seed and its number alone, so that
// `--only NUMBER` runs it again and `--rig NUMBER` prints it for the impactrig program. Each is
// solved in a child process of limited processor time and memory, then solved again 30 times as
// accurately. Some have further stops. An answer is sound when every number in it is finite,
// contacts follow each other, no force pulls, the energy balances or a warning says that it does
// not, and when peak force, duration and impulse of the first contact agree with the second run
// within the accuracy asked for. Exit status 1 when a scene fails.

#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "acquisition/random_stream.hpp"
#include "datasets/record.hpp"
#include "fitting/rig_file.hpp"
#include "models/contact/contact_force.hpp"
#include "models/contact/damping_law.hpp"
#include "models/simulation.hpp"

namespace {

using namespace impactrig;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

// What resolving a mesh's vibrations over a drawn duration may cost, a fifth of the usual limit: or
// being late would say nothing. Not of the limit stated, on which a scene must not depend.
constexpr double affordable_time = 0.6;             // [s]
constexpr double evaluations_of_step = 13.0;        // events and extrema included
constexpr double finer = 30.0;                      // of the confirming run
constexpr std::uintptr_t most_memory = 4ull << 30;  // of a child [bytes]
constexpr double confirming_time = 4.0;             // as a multiple of the first run's limit
constexpr double grace =
    4.0;  // of the limit: small motion and twice the full equations may reach it
constexpr double waiting = 20.0;  // of wall clock, as a multiple of limits
constexpr std::array families = {"impact", "to the end", "bounces", "grazing"};

struct Study {
  std::uint64_t seed = 1;
  long scenes = 300;
  long first = 0;
  std::vector<long> only;
  long rig = -1;  // to print, not to run
  double limit = 3.0;
  bool exact = false, confirm_exact = false;
  std::string output;
};

struct Scene {
  long number = 0;
  std::string family;
  std::string toml;
  std::string refusal;  ///< by the reader of rig files; then no more is drawn
  fitting::RigFile file;
  double contact_time = 0.0;  ///< of a rigid bar on the elastic law, roughly [s]
  double periods = 0.0;       ///< of the fastest vibration within the duration, roughly
  double predicted = 0.0;     ///< what a step for each of them costs, roughly [s]
};

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

  std::string family() const { return families[family_]; }

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
    switch (choice(3)) {
      case 0:
        add("counterface = {{ shape = \"groove\", radius = \"{:.17g} m\" }}",
            radius_ * (1.0 + spread(1e-6, 1.0)));
        break;
      case 1:
        add("counterface = {{ shape = \"cylinder\", radius = \"{:.17g} m\" }}",
            radius_ * spread(0.01, 100.0));
        break;
      default:
        add("counterface = {{ shape = \"plane\" }}");
    }
    const double line = radius_ * spread(0.1, 10.0);
    add("length = \"{:.17g} m\"\ncounter_modulus = \"{:.17g} Pa\"\ncounter_poisson_ratio = {:.6f}",
        line, modulus_ * spread(1e-4, 1e4), random_.uniform(0.0, 0.5));
    if (chance(0.2))
      add("law = \"linear\"\nstiffness = \"{:.17g} N/m\"", modulus_ * line * spread(1e-4, 10.0));
    else
      add("law = \"goldsmith\"\nexponent = {}", chance(0.5) ? 1 : 3);
    const auto laws = models::damping_laws();
    const models::DampingLaw& damping =
        laws[static_cast<std::size_t>(choice(static_cast<int>(laws.size())))];
    double e = chance(0.05) ? 0.0 : chance(0.05) ? 1.0 : random_.uniform();
    e = std::max(e, damping.smallest_restitution);
    add("damping = \"{}\"\nrestitution = {:.17g}", damping.name, e);
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
  const double gyration = std::sqrt(beam.second_moment / beam.area);
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
std::string draw_further_stops(const Study& study, const Scene& scene) {
  acquisition::RandomStream random(study.seed, fmt::format("further stops {}", scene.number));
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
void complete_scene(const Study& study, SceneText& text, Scene& scene) {
  const std::string name = fmt::format("scene {}", scene.number);
  scene.file = fitting::parse_rig_file(scene.toml, name);
  const models::Rig& rig = scene.file.rig;
  const double speed = touch_velocity(rig);
  const double turned = speed / rig.contact.position;
  const double energy = 0.5 * rig.beam.hinge_inertia() * turned * turned;
  scene.contact_time = 3.0 * models::penetration_storing(models::ContactForce(rig), energy) / speed;
  const double duration = draw_duration(text, scene);
  if (duration > 0.0) scene.toml += fmt::format("duration = \"{:.9g} s\"\n", duration);
  if (!text.stop_gives_way()) scene.toml += draw_further_stops(study, scene);
  scene.file = fitting::parse_rig_file(scene.toml, name);
  scene.periods = (duration > 0.0 ? duration : 0.1) * fastest_vibration(rig, scene.file.solver) /
                  (2.0 * std::numbers::pi);
  scene.predicted = scene.periods * evaluations_of_step * evaluation_time(scene.file.solver);
}

Scene draw_scene(const Study& study, long number) {
  SceneText text(study.seed, number);
  Scene scene;
  scene.number = number;
  scene.family = text.family();
  scene.toml = text.text();
  try {
    complete_scene(study, text, scene);
  } catch (const std::exception& problem) {
    scene.refusal = problem.what();
  }
  return scene;
}

enum class Kind {
  answered,
  warned,         ///< answered, with a warning that the energy or the accuracy does not hold
  refused,        ///< with a sentence
  unconfirmed,    ///< answered, but the finer run was refused or late
  not_finite,     ///< from here on: failures
  unsound,        ///< contacts out of order, a pulling force
  energy,         ///< out of balance without a warning
  not_converged,  ///< the finer run differs by more than the accuracy
  endless,
  crashed,
  no_sentence  ///< an exception of another type, or without words
};

constexpr std::array kind_names = {"answered",
                                   "answered with a warning",
                                   "refused with a sentence",
                                   "not confirmed",
                                   "not finite",
                                   "unsound",
                                   "energy out of balance",
                                   "not converged",
                                   "over the limit",
                                   "crashed",
                                   "no sentence"};

bool failed(Kind kind) {
  return kind >= Kind::not_finite;
}

struct Outcome {
  long number = 0;
  Kind kind = Kind::crashed;
  std::string sentence;
  double accuracy = 0.0, imbalance = 0.0;
  double peak = 0.0, duration = 0.0,
         impulse = 0.0;  ///< of the first contact, finer run less this one, relative
  double seconds = 0.0;
  long evaluations = 0, contacts = 0;
  bool small_motion = false;
  bool cut_short = false;  ///< by solver.time_limit

  double error() const { return std::max({peak, duration, impulse}); }
};

Json to_json(const Outcome& o) {
  return {{"scene", o.number},
          {"kind", kind_names[static_cast<std::size_t>(o.kind)]},
          {"sentence", o.sentence},
          {"accuracy", o.accuracy},
          {"energy_imbalance", o.imbalance},
          {"difference", {{"peak", o.peak}, {"duration", o.duration}, {"impulse", o.impulse}}},
          {"solve_s", o.seconds},
          {"evaluations", o.evaluations},
          {"contacts", o.contacts},
          {"small_motion", o.small_motion},
          {"cut_short", o.cut_short}};
}

Outcome from_json(const Json& json) {
  const auto number = [](const Json& j) { return j.is_null() ? std::nan("") : j.get<double>(); };
  Outcome o;
  const std::string kind = json.at("kind");
  o.kind = static_cast<Kind>(std::ranges::find(kind_names, kind) - kind_names.begin());
  o.number = json.at("scene");
  o.sentence = json.at("sentence");
  o.accuracy = json.at("accuracy");
  o.imbalance = number(json.at("energy_imbalance"));
  o.peak = number(json.at("difference").at("peak"));
  o.duration = number(json.at("difference").at("duration"));
  o.impulse = number(json.at("difference").at("impulse"));
  o.seconds = json.at("solve_s");
  o.evaluations = json.at("evaluations");
  o.contacts = json.at("contacts");
  o.small_motion = json.at("small_motion");
  o.cut_short = json.at("cut_short");
  return o;
}

/// The first number of a result that is not finite where it should be; "" when all are.
std::string not_finite(const models::Simulation& run) {
  std::string found;
  const auto look = [&](const char* what, double value) {
    if (found.empty() && !std::isfinite(value)) found = fmt::format("{} is {}", what, value);
  };
  look("peak_force", run.peak_force);
  look("peak_time", run.peak_time);
  look("max_penetration", run.max_penetration);
  look("impulse", run.impulse);
  look("duration", run.duration);
  for (const models::Episode& e : run.episodes) {
    for (const double value : {e.start, e.end, e.peak_force, e.peak_time, e.impulse,
                               e.max_penetration, e.approach_velocity, e.dissipated})
      look("a number of a contact", value);
    if (!e.open) look("a separation velocity", e.separation_velocity);
  }
  if (!run.episodes.empty() && !run.episodes.front().open)
    for (const double value :
         {run.restitution.kinematic, run.restitution.kinetic, run.restitution.energetic})
      look("a restitution", value);
  const models::EnergyAudit& a = run.energy;
  for (const double value : {a.initial, a.kinetic, a.elastic, a.gravitational, a.contact_stored,
                             a.dissipated, a.rigid_rotation, a.vibration, a.imbalance})
    look("an energy", value);
  for (const std::vector<double>* samples : {&run.history.force, &run.history.penetration,
                                             &run.history.velocity, &run.history.displacement})
    for (const double value : *samples) look("a sample of the history", value);
  for (const models::StopHistory& stop : run.history.further)
    for (const std::vector<double>* samples : {&stop.force, &stop.penetration})
      for (const double value : *samples) look("a sample at a further stop", value);
  return found;
}

/// What cannot be in a result, whatever the scene; "" when it is sound.
std::string unsound(const models::Simulation& run) {
  if (run.episodes.empty()) return "no contact";
  if (!(run.peak_force > 0.0)) return fmt::format("a peak force of {:g} N", run.peak_force);
  std::vector<double> ends(std::max<std::size_t>(run.stops.size(), 1));
  for (const models::Episode& e : run.episodes) {
    double& before = ends[static_cast<std::size_t>(e.stop)];
    if (e.start < before || e.end < e.start)
      return fmt::format("a contact from {:g} to {:g} s after one that ended at {:g} s", e.start,
                         e.end, before);
    if (e.impulse < -run.solver.accuracy * run.impulse)
      return fmt::format("an impulse of {:g} N s", e.impulse);
    if (e.dissipated < -run.solver.accuracy * run.energy.initial)
      return fmt::format("a contact that gives {:g} J", -e.dissipated);
    if (e.stop == 0 && e.peak_force > run.peak_force)
      return "a contact with more than the peak force";
    before = e.end;
  }
  for (const double force : run.history.force)
    if (force < 0.0) return fmt::format("a pulling force of {:g} N", force);
  for (const models::StopHistory& stop : run.history.further)
    for (const double force : stop.force)
      if (force < 0.0) return fmt::format("a pulling force of {:g} N at a further stop", force);
  return "";
}

bool warns_of(const models::Simulation& run, const char* words) {
  return std::ranges::any_of(run.warnings, [&](const std::string& warning) {
    return warning.find(words) != std::string::npos;
  });
}

/// Turns what simulate() throws into a kind.
template <typename Call>
void guarded(Outcome& outcome, Call call) {
  try {
    call();
  } catch (const std::exception& problem) {
    const bool expected = dynamic_cast<const std::runtime_error*>(&problem) != nullptr ||
                          dynamic_cast<const std::invalid_argument*>(&problem) != nullptr;
    outcome.sentence = problem.what();
    outcome.kind = expected && outcome.sentence.size() > 40 ? Kind::refused : Kind::no_sentence;
  }
}

void judge_alone(const models::Simulation& run, Outcome& outcome) {
  outcome.imbalance = run.energy.imbalance;
  outcome.seconds = run.cost.seconds;
  outcome.evaluations = run.cost.evaluations;
  outcome.contacts = static_cast<long>(run.episodes.size());
  outcome.small_motion = run.small_motion;
  outcome.cut_short = warns_of(run, "solver.time_limit");
  outcome.kind = Kind::answered;
  if (!(outcome.sentence = not_finite(run)).empty()) {
    outcome.kind = Kind::not_finite;
  } else if (!(outcome.sentence = unsound(run)).empty()) {
    outcome.kind = Kind::unsound;
  } else if (warns_of(run, "energy does not balance") || warns_of(run, "the first contact ")) {
    outcome.kind = Kind::warned;
  } else if (!(std::abs(run.energy.imbalance) <= 10.0 * run.solver.accuracy + 1e-10)) {
    outcome.kind = Kind::energy;
    outcome.sentence = fmt::format("energy imbalance {:.2g}", run.energy.imbalance);
  }
}

void judge_against(const models::Simulation& run, const models::Simulation& fine,
                   Outcome& outcome) {
  const models::Episode& a = run.episodes.front();
  const models::Episode& b = fine.episodes.front();
  const auto difference = [](double x, double y) { return std::abs(x - y) / std::abs(y); };
  outcome.peak = difference(a.peak_force, b.peak_force);
  // strongest damping lets the bar creep out of the contact, so that rounding decides whether it
  // ends within the run
  outcome.duration = a.open == b.open ? difference(a.end, b.end) : 0.0;
  outcome.impulse = difference(a.impulse, b.impulse);
  if (outcome.error() <= (1.0 + 1.0 / finer) * outcome.accuracy) return;
  if (outcome.kind == Kind::warned) return;
  outcome.kind = Kind::not_converged;
  outcome.sentence = fmt::format(
      "first contact off by {:.1e} (peak), {:.1e} (duration), {:.1e} (impulse) at accuracy {:.1e}",
      outcome.peak, outcome.duration, outcome.impulse, outcome.accuracy);
}

/// The process is killed after this long at work [s]: other work on the machine does not count.
void limit_work(double seconds) {
  const double whole = std::floor(seconds);
  const itimerval timer{
      {}, {static_cast<time_t>(whole), static_cast<suseconds_t>(1e6 * (seconds - whole))}};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

/// The child's work: one line after the first run, one at the end.
void run_scene(const Study& study, const Scene& scene, int pipe) {
  Outcome outcome;
  const auto tell = [&] {
    const std::string line =
        to_json(outcome).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    for (std::size_t sent = 0; sent < line.size();) {
      const ssize_t n = write(pipe, line.data() + sent, line.size() - sent);
      if (n <= 0) return;
      sent += static_cast<std::size_t>(n);
    }
  };
  models::Solver solver = scene.file.solver;
  models::SimulationOptions options;
  options.exact = study.exact;
  models::Simulation run;
  outcome.number = scene.number;
  outcome.accuracy = solver.accuracy;
  limit_work(grace * study.limit);
  solver.time_limit = study.limit;
  guarded(outcome, [&] {
    options.history.interval = solver.duration.value_or(0.1) / 500.0;
    run = models::simulate(scene.file.rig, solver, options);
    judge_alone(run, outcome);
  });
  tell();
  if (outcome.kind != Kind::answered && outcome.kind != Kind::warned) return;
  Outcome finer_run;
  limit_work(grace * confirming_time * study.limit);
  solver.time_limit = confirming_time * study.limit;
  guarded(finer_run, [&] {
    solver.accuracy = std::max(solver.accuracy / finer, 1e-13);
    options.history.interval = 0.0;
    options.exact = study.exact || study.confirm_exact;
    const models::Simulation fine = models::simulate(scene.file.rig, solver, options);
    finer_run.kind = Kind::answered;
    judge_against(run, fine, outcome);
  });
  if (finer_run.kind != Kind::answered) {
    outcome.kind = Kind::unconfirmed;
    outcome.sentence = "the finer run says: " + finer_run.sentence;
  }
  tell();
}

/// Runs a scene in a child process and reads what it tells until it ends or is late.
Outcome run_guarded(const Study& study, const Scene& scene) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe to a child process");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no child process");
  if (child == 0) {
    close(ends[0]);
    const rlimit memory{most_memory, most_memory};
    setrlimit(RLIMIT_AS, &memory);
    run_scene(study, scene, ends[1]);
    _exit(0);
  }
  close(ends[1]);
  const auto started = Clock::now();
  const double limit = waiting * grace * (1.0 + confirming_time) * study.limit;
  bool late = false;
  std::string told;
  for (;;) {
    const double left = limit - std::chrono::duration<double>(Clock::now() - started).count();
    pollfd readable{ends[0], POLLIN, 0};
    if (left <= 0.0 || poll(&readable, 1, static_cast<int>(1e3 * left) + 1) == 0) {
      late = true;
      kill(child, SIGKILL);
      break;
    }
    std::array<char, 4096> buffer{};
    const ssize_t n = read(ends[0], buffer.data(), buffer.size());
    if (n <= 0) break;
    told.append(buffer.data(), static_cast<std::size_t>(n));
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  late = late || (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF);

  Outcome outcome;
  outcome.number = scene.number;
  outcome.accuracy = scene.file.solver.accuracy;
  const std::size_t end = told.rfind('\n');
  if (end == std::string::npos) {
    outcome.kind = late ? Kind::endless : Kind::crashed;
    outcome.seconds = std::chrono::duration<double>(Clock::now() - started).count();
    outcome.sentence = late ? fmt::format("no answer within {:g} s", study.limit)
                            : fmt::format("the process ended with status {}", status);
    return outcome;
  }
  const std::size_t begin = end == 0 ? 0 : told.rfind('\n', end - 1) + 1;  // npos + 1 = 0
  outcome = from_json(Json::parse(told.substr(begin, end - begin)));
  if (!late && status == 0) return outcome;
  outcome.kind = late ? Kind::unconfirmed : Kind::crashed;
  outcome.sentence = late ? "the finer run was over its limit" : "the finer run crashed";
  return outcome;
}

Outcome refused(const Scene& scene) {
  Outcome outcome;
  outcome.number = scene.number;
  outcome.kind = Kind::refused;
  outcome.sentence = scene.refusal;
  return outcome;
}

std::string in_words(const Scene& scene) {
  if (!scene.refusal.empty()) return scene.family + ": " + scene.refusal;
  const models::Rig& rig = scene.file.rig;
  const models::Solver& solver = scene.file.solver;
  std::string model(name(solver.model));
  if (solver.model == models::BeamModel::hybrid)
    model += fmt::format(" {}+{} {}", solver.modes, solver.axial_modes, name(solver.basis));
  if (solver.model == models::BeamModel::ancf)
    model += fmt::format(" [{}, {}]", solver.elements[0], solver.elements[1]);
  return fmt::format(
      "{}: {}, L {:.3g} m, R/L {:.1e}, E {:.1e} Pa, E ratio {:.0e}, at {:.3g} L, {:.3g} m/s, {}{} "
      "{} "
      "e {:.2g}, g {:.3g}, accuracy {:.1e}, {:.1e} s = {:.1e} contacts = {:.1e} periods, {:.1e} s "
      "if each takes a "
      "step",
      scene.family, model, rig.beam.length, rig.contact.radius / rig.beam.length,
      rig.beam.youngs_modulus, rig.contact.counter_modulus / rig.contact.modulus,
      rig.contact.position / rig.beam.length, touch_velocity(rig), rig.contact.law,
      rig.contact.law == "goldsmith" ? fmt::format(" {}", rig.contact.exponent) : "",
      rig.contact.damping, rig.contact.restitution, rig.gravity, solver.accuracy,
      solver.duration.value_or(0.1), solver.duration.value_or(0.1) / scene.contact_time,
      scene.periods, scene.predicted);
}

/// A sentence without its numbers, to count its like.
std::string without_numbers(const std::string& sentence) {
  std::string text;
  for (const char c : sentence)
    if (std::isdigit(static_cast<unsigned char>(c)) == 0)
      text += c;
    else if (text.empty() || text.back() != '#')
      text += '#';
  return text.substr(0, 100);
}

void print_worst(const Study& study, const std::vector<Outcome>& outcomes, const char* title,
                 double (*badness)(const Outcome&)) {
  std::vector<Outcome> sorted = outcomes;
  std::ranges::stable_sort(sorted, std::greater{}, badness);
  fmt::print("\n{}\n", title);
  for (std::size_t i = 0; i < std::min<std::size_t>(5, sorted.size()); ++i)
    if (badness(sorted[i]) > 0.0)
      fmt::print("  {:<10.3g} --seed {} --only {}: {}\n", badness(sorted[i]), study.seed,
                 sorted[i].number, in_words(draw_scene(study, sorted[i].number)));
}

void print_summary(const Study& study, const std::vector<Outcome>& outcomes) {
  fmt::print("\n{} scenes of seed {}\n", outcomes.size(), study.seed);
  std::map<Kind, std::map<std::string, long>> by_family;
  std::map<std::string, long> refusals;
  long explained = 0;
  for (const Outcome& o : outcomes) {
    const Scene scene = draw_scene(study, o.number);
    if (o.kind == Kind::endless && scene.predicted > 0.5 * study.limit) ++explained;
    ++by_family[o.kind][scene.family];
    if (o.kind == Kind::refused) ++refusals[without_numbers(o.sentence)];
  }
  fmt::print("  {:<28}{:>8}", "", "all");
  for (const char* family : families) fmt::print("{:>12}", family);
  for (std::size_t k = 0; k < kind_names.size(); ++k) {
    std::map<std::string, long>& counts = by_family[static_cast<Kind>(k)];
    long all = 0;
    for (const auto& [family, count] : counts) all += count;
    fmt::print("\n  {:<28}{:>8}", kind_names[k], all);
    for (const char* family : families) fmt::print("{:>12}", counts[family]);
  }
  fmt::print(
      "\n\nof the answers {} by small motion, {} cut short by solver.time_limit; of the late {} "
      "are as "
      "slow as the mesh's fastest vibration explains\n",
      std::ranges::count(outcomes, true, &Outcome::small_motion),
      std::ranges::count(outcomes, true, &Outcome::cut_short), explained);
  fmt::print("\nrefusals, numbers as #\n");
  for (const auto& [sentence, count] : refusals) fmt::print("  {:>5}  {}\n", count, sentence);
  print_worst(study, outcomes, "energy imbalance over the accuracy",
              [](const Outcome& o) { return std::abs(o.imbalance) / o.accuracy; });
  print_worst(study, outcomes, "difference from the finer run over the accuracy",
              [](const Outcome& o) { return o.error() / o.accuracy; });
  print_worst(study, outcomes, "seconds of the first run",
              [](const Outcome& o) { return o.seconds; });
}

/// Runs the scenes; tells at once what is wrong with one. True when none failed.
bool run(const Study& study) {
  std::vector<long> numbers = study.only;
  if (numbers.empty())
    for (long k = 0; k < study.scenes; ++k) numbers.push_back(study.first + k);
  Json json = {{"schema", "impactrig/stress/1"},
               {"program", datasets::program_version()},
               {"seed", study.seed},
               {"limit_s", study.limit},
               {"exact", study.exact},
               {"confirm_exact", study.confirm_exact}};
  const auto started = Clock::now();
  std::vector<Outcome> outcomes;
  bool sound = true;
  for (const long number : numbers) {
    const Scene scene = draw_scene(study, number);
    std::fflush(stdout);
    const Outcome outcome = scene.refusal.empty() ? run_guarded(study, scene) : refused(scene);
    outcomes.push_back(outcome);
    Json entry = to_json(outcome);
    entry["family"] = scene.family;
    if (failed(outcome.kind) || !study.only.empty()) {
      fmt::print("{}: {}. {}\n    {}\n", number, kind_names[static_cast<std::size_t>(outcome.kind)],
                 outcome.sentence, in_words(scene));
      entry["rig"] = scene.toml;
    }
    sound = sound && !failed(outcome.kind);
    json["results"].push_back(std::move(entry));
  }
  print_summary(study, outcomes);
  const double seconds = std::chrono::duration<double>(Clock::now() - started).count();
  fmt::print("\n{:.0f} s in all\n", seconds);
  json["seconds"] = seconds;
  if (!study.output.empty())
    std::ofstream(study.output) << json.dump(1, ' ', false, Json::error_handler_t::replace) << "\n";
  return sound;
}

}  // namespace

int main(int argc, char** argv) {
  Study study;
  CLI::App program("Random scenes, absurd but physical: sound answers or sentences, in time");
  program.add_option("--scenes", study.scenes, "How many")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  program.add_option("--seed", study.seed, "Of the study")->capture_default_str();
  program.add_option("--first", study.first, "Number of the first scene")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  program.add_option("--only", study.only, "Numbers of the scenes to run")->delimiter(',');
  program.add_option("--rig", study.rig, "Print the rig file of a scene instead");
  program.add_option("--limit", study.limit, "Processor time for one run of a scene [s]")
      ->capture_default_str();
  program.add_flag("--exact", study.exact, "Take no simplification");
  program.add_flag("--confirm-exact", study.confirm_exact, "Take none in the finer run");
  program.add_option("-o,--output", study.output, "Every scene, as JSON");
  CLI11_PARSE(program, argc, argv);
  try {
    if (study.rig >= 0) {
      fmt::print("{}", draw_scene(study, study.rig).toml);
      return 0;
    }
    return run(study) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
