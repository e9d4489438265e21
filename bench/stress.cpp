// SPDX-License-Identifier: BSD-3-Clause
//
// Random scenes far beyond any laboratory: does every one end in time with a sound answer or a
// sentence? Each scene is a rig file drawn from a seed and its number alone, so that
// `--only NUMBER` runs it again and `--rig NUMBER` prints it for the impactrig program. Each is
// solved in a child process of limited processor time and memory, then solved again 30 times as
// accurately. Some have further stops. An answer is sound when every number in it is finite,
// contacts follow each other, no force pulls, the energy balances or a warning says that it does
// not, and when peak force, duration and impulse of the first contact, and the largest force in the
// sensor of a stop that gives way, agree with the second run within the accuracy asked for. Exit
// status 1 when a scene fails.

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

#include "bench/random_scene.hpp"
#include "datasets/record.hpp"
#include "models/simulation.hpp"

namespace {

using namespace impactrig;
using namespace impactrig::bench;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr double finer = 30.0;                      // of the confirming run
constexpr std::uintptr_t most_memory = 4ull << 30;  // of a child [bytes]
constexpr double confirming_time = 4.0;             // as a multiple of the first run's limit
constexpr double grace = 1.2;                       // of the limit, for what is not looked at
constexpr double waiting = 20.0;                    // of wall clock, as a multiple of limits

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
  double sensor = 0.0;   ///< likewise, of what the sensor of a stop that gives way carries at most
  double seconds = 0.0;
  long evaluations = 0, contacts = 0;
  bool small_motion = false;
  bool cut_short = false;  ///< by solver.time_limit

  double error() const { return std::max({peak, duration, impulse, sensor}); }
};

Json to_json(const Outcome& o) {
  return {
      {"scene", o.number},
      {"kind", kind_names[static_cast<std::size_t>(o.kind)]},
      {"sentence", o.sentence},
      {"accuracy", o.accuracy},
      {"energy_imbalance", o.imbalance},
      {"difference",
       {{"peak", o.peak}, {"duration", o.duration}, {"impulse", o.impulse}, {"sensor", o.sensor}}},
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
  o.sensor = number(json.at("difference").at("sensor"));
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

/// What cannot be in a result, whatever the scene; "" when it is sound. Contacts pull where the rig
/// file allows that.
std::string unsound(const models::Simulation& run, bool may_pull) {
  if (run.episodes.empty()) return "no contact";
  if (!(run.peak_force > 0.0)) return fmt::format("a peak force of {:g} N", run.peak_force);
  std::vector<double> ends(std::max<std::size_t>(run.stops.size(), 1));
  for (const models::Episode& e : run.episodes) {
    double& before = ends[static_cast<std::size_t>(e.stop)];
    if (e.start < before || e.end < e.start)
      return fmt::format("a contact from {:g} to {:g} s after one that ended at {:g} s", e.start,
                         e.end, before);
    if (!may_pull && e.impulse < -1e-12 * run.impulse)
      return fmt::format("an impulse of {:g} N s", e.impulse);
    if (e.dissipated < -run.solver.accuracy * run.energy.initial)
      return fmt::format("a contact that gives {:g} J", -e.dissipated);
    if (e.stop == 0 && e.peak_force > run.peak_force)
      return "a contact with more than the peak force";
    before = e.end;
  }
  if (may_pull) return "";
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

void judge_alone(const models::Simulation& run, bool may_pull, Outcome& outcome) {
  outcome.imbalance = run.energy.unbalanced();
  outcome.seconds = run.cost.seconds;
  outcome.evaluations = run.cost.evaluations;
  outcome.contacts = static_cast<long>(run.episodes.size());
  outcome.small_motion = run.small_motion;
  outcome.cut_short = warns_of(run, "solver.time_limit");
  outcome.kind = Kind::answered;
  if (!(outcome.sentence = not_finite(run)).empty()) {
    outcome.kind = Kind::not_finite;
  } else if (!(outcome.sentence = unsound(run, may_pull)).empty()) {
    outcome.kind = Kind::unsound;
  } else if (warns_of(run, "energy does not balance") || warns_of(run, "the first contact ") ||
             warns_of(run, "the sensor carries most")) {
    outcome.kind = Kind::warned;
  } else if (!(std::abs(outcome.imbalance) <= 10.0 * run.solver.accuracy + 1e-10)) {
    outcome.kind = Kind::energy;
    outcome.sentence = fmt::format("energy imbalance {:.2g}", outcome.imbalance);
  }
}

/// Of the largest forces in the sensor; none where a run was cut before it, or says that it is not
/// known.
double sensor_difference(const models::Simulation& run, const models::Simulation& fine) {
  if (!run.sensor || warns_of(run, "solver.time_limit") || warns_of(fine, "solver.time_limit") ||
      warns_of(run, "the sensor carries most"))
    return 0.0;
  return std::abs(run.sensor->peak_force / fine.sensor->peak_force - 1.0);
}

void judge_against(const models::Simulation& run, const models::Simulation& fine,
                   Outcome& outcome) {
  const models::Episode& a = run.episodes.front();
  const models::Episode& b = fine.episodes.front();
  const auto difference = [](double x, double y) { return std::abs(x - y) / std::abs(y); };
  outcome.peak = difference(a.peak_force, b.peak_force);
  outcome.duration = difference(a.end, b.end);
  outcome.impulse = difference(a.impulse, b.impulse);
  outcome.sensor = sensor_difference(run, fine);
  if (outcome.error() <= (1.0 + 1.0 / finer) * outcome.accuracy) return;
  if (warns_of(run, "the first contact ")) return;  // that it may be so far off
  if (warns_of(fine, "the first contact ")) {
    outcome.kind = Kind::unconfirmed;
    outcome.sentence = "the finer run says that its own first contact may be far off";
    return;
  }
  outcome.kind = Kind::not_converged;
  outcome.sentence = fmt::format(
      "first contact off by {:.1e} (peak), {:.1e} (duration), {:.1e} (impulse), sensor by "
      "{:.1e} at accuracy {:.1e}",
      outcome.peak, outcome.duration, outcome.impulse, outcome.sensor, outcome.accuracy);
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
    judge_alone(run, scene.file.rig.contact.tension == models::Tension::allow, outcome);
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
                 sorted[i].number, in_words(draw_scene(study.seed, sorted[i].number)));
}

void print_summary(const Study& study, const std::vector<Outcome>& outcomes) {
  fmt::print("\n{} scenes of seed {}\n", outcomes.size(), study.seed);
  std::map<Kind, std::map<std::string, long>> by_family;
  std::map<std::string, long> refusals;
  long explained = 0;
  for (const Outcome& o : outcomes) {
    const Scene scene = draw_scene(study.seed, o.number);
    if (o.kind == Kind::endless && scene.predicted > 0.5 * study.limit) ++explained;
    ++by_family[o.kind][scene.family];
    if (o.kind == Kind::refused) ++refusals[without_numbers(o.sentence)];
  }
  fmt::print("  {:<28}{:>8}", "", "all");
  for (const char* family : scene_families) fmt::print("{:>12}", family);
  for (std::size_t k = 0; k < kind_names.size(); ++k) {
    std::map<std::string, long>& counts = by_family[static_cast<Kind>(k)];
    long all = 0;
    for (const auto& [family, count] : counts) all += count;
    fmt::print("\n  {:<28}{:>8}", kind_names[k], all);
    for (const char* family : scene_families) fmt::print("{:>12}", counts[family]);
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
    const Scene scene = draw_scene(study.seed, number);
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
      fmt::print("{}", draw_scene(study.seed, study.rig).toml);
      return 0;
    }
    return run(study) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
