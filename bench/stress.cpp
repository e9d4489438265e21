// SPDX-License-Identifier: BSD-3-Clause
//
// Random scenes far beyond any laboratory: does every one end in time with a sound answer or a
// sentence? Each scene is a rig file drawn from a seed and its number alone, so that
// `--only NUMBER` runs it again and `--rig NUMBER` prints it for the impactrig program. Each is
// solved in a child process of limited processor time and memory, then solved again 30 times as
// accurately. Some have further stops; `--without-stop` has none. An answer is sound when every
// number in it is finite, contacts follow each other, no force pulls, the energy balances or a
// warning says that it does not, and when peak force, duration and impulse of the first contact,
// and the largest force in the sensor of a stop that gives way, agree with the second run within
// the accuracy asked for; without a stop, when displacements over the run do. Exit status 1 when a
// scene fails.

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
#include <string>
#include <vector>

#include "bench/random_scene.hpp"
#include "bench/stress_outcome.hpp"
#include "datasets/record.hpp"
#include "fitting/mesh_choice.hpp"
#include "fitting/rig_file.hpp"
#include "models/mesh_error.hpp"
#include "models/simulation.hpp"

namespace {

using namespace impactrig;
using namespace impactrig::bench;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::uintptr_t most_memory = 4ull << 30;  // of a child [bytes]
constexpr int finer_mesh = 4;                       // of an open mesh, the confirming run's
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
  bool exact = false, confirm_exact = false, without_stop = false;
  Meshes meshes = Meshes::coarse;
  std::string output;

  Scene scene(long number) const { return draw_scene(seed, number, without_stop, meshes); }
};

/// The process is killed after this long at work [s]: other work on the machine does not count.
void limit_work(double seconds) {
  const double whole = std::floor(seconds);
  const itimerval timer{
      {}, {static_cast<time_t>(whole), static_cast<suseconds_t>(1e6 * (seconds - whole))}};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

/// As stated, or as the program chooses it.
models::ChosenMesh mesh_of(const Scene& scene, const models::Solver& solver) {
  if (scene.file.mesh_stated) return {.solver = solver, .error = 0.0};
  return models::choose_mesh(scene.file.rig, solver, fitting::finest_mesh);
}

/// That the mesh is not as good as asked for, or that it is not known, is a warning.
void tell_mesh(const models::ChosenMesh& mesh, Outcome& outcome) {
  if (outcome.kind != Kind::answered && outcome.kind != Kind::warned) return;
  if (mesh.error <= outcome.accuracy) return;
  outcome.kind = Kind::warned;
  outcome.sentence = fmt::format("the mesh errs by {:.1g}", mesh.error);
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
  const double with_mesh = scene.file.mesh_stated ? 1.0 : 1.5;  // of the limit: choosing takes half
  limit_work(grace * with_mesh * study.limit);
  solver.time_limit = study.limit;
  guarded(outcome, [&] {
    options.history.interval = solver.duration.value_or(0.1) / 500.0;
    const models::ChosenMesh mesh = mesh_of(scene, solver);
    solver = mesh.solver;
    run = models::simulate(scene.file.rig, solver, options);
    // of what the sensor carries later the mesh's error is not told, and the sentence says so
    if (run.sensor && run.sensor->peak_time > mesh.sensor_until.value_or(run.duration))
      run.sensor->peak_known = false;
    judge_alone(scene.file.rig, run, outcome);
    tell_mesh(mesh, outcome);
  });
  tell();
  const bool of_mesh = outcome.kind == Kind::warned && !outcome.sentence.empty();
  if (of_mesh || (outcome.kind != Kind::answered && outcome.kind != Kind::warned)) return;
  Outcome finer_run;
  limit_work(grace * confirming_time * study.limit);
  solver.time_limit = confirming_time * study.limit;
  guarded(finer_run, [&] {
    solver.accuracy = std::max(solver.accuracy / finer, 1e-13);
    if (!scene.file.mesh_stated)
      for (int& elements : solver.elements) elements *= finer_mesh;
    if (!scene.without_stop) options.history.interval = 0.0;
    options.exact = study.exact || study.confirm_exact;
    const models::Simulation fine = models::simulate(scene.file.rig, solver, options);
    finer_run.kind = Kind::answered;
    judge_against(scene.file.rig, run, fine, outcome);
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
  outcome = outcome_of(Json::parse(told.substr(begin, end - begin)));
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

std::string in_words(const models::Solver& solver) {
  std::string words(name(solver.model));
  if (solver.model == models::BeamModel::hybrid)
    words += fmt::format(" {}+{} {}", solver.modes, solver.axial_modes, name(solver.basis));
  if (solver.model == models::BeamModel::ancf)
    words += fmt::format(" [{}, {}]", solver.elements[0], solver.elements[1]);
  return words;
}

std::string impact_in_words(const models::Rig& rig) {
  const models::Contact& contact = rig.contact;
  return fmt::format("R/L {:.1e}, E ratio {:.0e}, at {:.3g} L, {:.3g} m/s, {}{} {} e {:.2g}",
                     contact.radius / rig.beam.length, contact.counter_modulus / contact.modulus,
                     contact.position / rig.beam.length, touch_velocity(rig), contact.law,
                     contact.law == "goldsmith" ? fmt::format(" {}", contact.exponent) : "",
                     contact.damping, contact.restitution);
}

std::string swing_in_words(const models::Rig& rig) {
  if (rig.hinge.rotation)
    return fmt::format("to {:.3g} rad/s in {:.3g} s", rig.hinge.rotation->rate,
                       rig.hinge.rotation->time);
  if (rig.start.release_angle) return fmt::format("from {:.3g} rad", *rig.start.release_angle);
  return fmt::format("{:.3g} m/s at the tip", rig.start.velocity);
}

std::string in_words(const Scene& scene) {
  if (!scene.refusal.empty()) return scene.family + ": " + scene.refusal;
  const models::Rig& rig = scene.file.rig;
  const models::Solver& solver = scene.file.solver;
  const double duration = solver.duration.value_or(0.1);
  const std::string what = scene.without_stop ? swing_in_words(rig) : impact_in_words(rig);
  const std::string contacts =
      scene.without_stop ? "" : fmt::format(" = {:.1e} contacts", duration / scene.contact_time);
  return fmt::format(
      "{}: {}, L {:.3g} m, E {:.1e} Pa, {}, g {:.3g}, accuracy {:.1e}, {:.1e} s{} = {:.1e} "
      "periods, {:.1e} s if each takes a step",
      scene.family, in_words(solver), rig.beam.length, rig.beam.youngs_modulus, what, rig.gravity,
      solver.accuracy, duration, contacts, scene.periods, scene.predicted);
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
                 sorted[i].number, in_words(study.scene(sorted[i].number)));
}

void print_summary(const Study& study, const std::vector<Outcome>& outcomes) {
  fmt::print("\n{} scenes of seed {}\n", outcomes.size(), study.seed);
  std::map<Kind, std::map<std::string, long>> by_family;
  std::map<std::string, long> refusals;
  long explained = 0;
  for (const Outcome& o : outcomes) {
    const Scene scene = study.scene(o.number);
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
               {"without_stop", study.without_stop},
               {"meshes", study.meshes},
               {"exact", study.exact},
               {"confirm_exact", study.confirm_exact}};
  const auto started = Clock::now();
  std::vector<Outcome> outcomes;
  bool sound = true;
  for (const long number : numbers) {
    const Scene scene = study.scene(number);
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
  program.add_flag("--without-stop", study.without_stop,
                   "Bars that swing freely or whose hinge is turned, in place of impacts");
  program.add_option("--meshes", study.meshes, "coarse, open or fine")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Meshes>{
          {"coarse", Meshes::coarse}, {"open", Meshes::open}, {"fine", Meshes::fine}}));
  program.add_flag("--exact", study.exact, "Take no simplification");
  program.add_flag("--confirm-exact", study.confirm_exact, "Take none in the finer run");
  program.add_option("-o,--output", study.output, "Every scene, as JSON");
  CLI11_PARSE(program, argc, argv);
  try {
    if (study.rig >= 0) {
      fmt::print("{}", study.scene(study.rig).toml);
      return 0;
    }
    return run(study) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
