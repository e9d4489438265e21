// SPDX-License-Identifier: BSD-3-Clause
//
// What the program does with bad data: shots of the shipped rig whose recordings are damaged in one
// way each, given to `impactrig fit` as a laboratory would. Truths are drawn as in bench_coverage.
// A shot ends refused (exit code other than 0, without a result), warned (a flag of the impact, a
// warning of the fit, or diagnostics that call the fit unsound) or quiet; and the restitution is
// within 1.96 standard errors of the truth or not. What must not happen is a quiet interval that
// does not hold it. The truth is of the fit's own mesh: what is said of that does not count, nor
// what is said of bounces, which good recordings show as well.

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "acquisition/random_stream.hpp"
#include "bench/recorded_shot.hpp"
#include "datasets/store.hpp"
#include "fitting/all_cores.hpp"
#include "fitting/rig_file.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace impactrig;
using acquisition::RandomStream;

/// One way in which recordings are bad.
struct Kind {
  std::string name;
  /// Of how the shot is recorded; the largest force [N] is known.
  std::function<void(acquisition::SyntheticOptions&, double)> record = {};
  /// Of the record itself: channels' values, one for each sample.
  std::function<void(datasets::Record&, RandomStream&)> damage = {};
  double pre_trigger = 0.5e-3, duration = 4e-3;  // [s]
  double cut = 0.0;  // samples before this are lost [s, first touch at 0]; 0: none
};

datasets::Channel& channel_of(datasets::Record& record, const std::string& name) {
  return *std::ranges::find(record.channels, name, &datasets::Channel::name);
}

void set_values(datasets::Channel& channel, std::vector<double> values) {
  channel.raw = std::move(values);
  channel.scale = 1.0;
  channel.offset = 0.0;
}

void change_values(datasets::Record& record, const std::string& name,
                   const std::function<double(double t, double value)>& change) {
  datasets::Channel& channel = channel_of(record, name);
  std::vector<double> values = channel.values();
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = change(channel.clock.time(k), values[k]);
  set_values(channel, std::move(values));
}

double largest(datasets::Record& record, const std::string& name) {
  double most = 0.0;
  for (const double value : channel_of(record, name).values())
    most = std::max(most, std::abs(value));
  return most;
}

void multiply(datasets::Record& record, const std::string& name, double factor) {
  change_values(record, name, [&](double, double value) { return factor * value; });
}

double first_touch(const datasets::Record& record) {
  return std::stod(record.attributes.at("truth.first_touch"));
}

/// Single samples, of half the largest value either way, at random.
void add_spikes(datasets::Record& record, RandomStream& random) {
  const double height = 0.5 * largest(record, "Force");
  change_values(record, "Force", [&](double, double value) {
    const double drawn = random.uniform(0.0, 1.0);
    return drawn < 0.002 ? value + height : drawn < 0.004 ? value - height : value;
  });
}

/// Somebody else's blow on the stop: half a sine of 40 % of the peak, 100 us long.
void add_foreign_blow(datasets::Record& record, RandomStream& random) {
  const double height = 0.4 * largest(record, "Force");
  const double begins = first_touch(record) + random.uniform(350e-6, 600e-6), length = 100e-6;
  change_values(record, "Force", [&](double t, double value) {
    const double part = (t - begins) / length;
    return part > 0.0 && part < 1.0 ? value + height * std::sin(M_PI * part) : value;
  });
}

/// An amplifier that is overloaded recovers from it slowly.
void add_overload_tail(datasets::Record& record, RandomStream&) {
  const double height = 0.1 * largest(record, "Force");
  const double begins = first_touch(record) + 150e-6;
  change_values(record, "Force", [&](double t, double value) {
    return t > begins ? value - height * std::exp(-(t - begins) / 1e-3) : value;
  });
}

/// The recorder lost a block of the velocity and put the rest together.
void lose_samples(datasets::Record& record, RandomStream&) {
  datasets::Channel& channel = channel_of(record, "Velocity");
  std::vector<double> values = channel.values();
  const auto at = static_cast<std::ptrdiff_t>((first_touch(record) + 400e-6 - channel.clock.start) /
                                              channel.clock.interval);
  values.erase(values.begin() + at, values.begin() + at + 200);
  values.resize(values.size() + 200, values.back());
  set_values(channel, std::move(values));
}

std::vector<Kind> kinds() {
  using Options = acquisition::SyntheticOptions;
  return {{.name = "as a good day"},
          {.name = "force clipped at 70 %",
           .record = [](Options& o, double peak) { o.force.range = 0.7 * peak; }},
          {.name = "force in 6 bits", .record = [](Options& o, double) { o.force.bits = 6; }},
          {.name = "force noise 5 % of the peak",
           .record = [](Options& o, double peak) { o.force.noise = 0.05 * peak; }},
          {.name = "hum 20 % of the peak",
           .record = [](Options& o, double peak) { o.force.hum = 0.2 * peak; }},
          {.name = "drift 10 % of the peak in 1 ms",
           .record = [](Options& o, double peak) { o.force.drift = 100.0 * peak; }},
          {.name = "ground loop, 5 % of the peak",
           .record = [](Options& o, double peak) { o.force.step = 0.05 * peak; }},
          {.name = "laser drops out, 2 a ms",
           .record =
               [](Options& o, double) {
                 o.velocity.dropouts_per_second = 2000.0;
                 o.velocity.dropout_in_contact = true;
               }},
          {.name = "spikes on 0.4 % of the samples", .damage = add_spikes},
          {.name = "overloaded amplifier's tail", .damage = add_overload_tail},
          {.name = "somebody else's blow", .damage = add_foreign_blow},
          {.name = "200 samples of velocity lost", .damage = lose_samples},
          {.name = "force 20 us late",
           .record = [](Options& o, double) { o.force.delay_error = 20e-6; }},
          {.name = "force's gain 10 % off",
           .record = [](Options& o, double) { o.force.gain_error = 0.1; }},
          {.name = "velocity's gain 10 % off",
           .record = [](Options& o, double) { o.velocity.gain_error = 0.1; }},
          {.name = "mV taken for V",
           .damage = [](datasets::Record& r, RandomStream&) { multiply(r, "Force", 1000.0); }},
          {.name = "force upside down",
           .damage = [](datasets::Record& r, RandomStream&) { multiply(r, "Force", -1.0); }},
          {.name = "velocity upside down",
           .damage = [](datasets::Record& r, RandomStream&) { multiply(r, "Velocity", -1.0); }},
          {.name = "velocity channel dead",
           .damage = [](datasets::Record& r, RandomStream&) { multiply(r, "Velocity", 0.0); }},
          {.name = "force of not a number",
           .damage = [](datasets::Record& r, RandomStream&) { multiply(r, "Force", NAN); }},
          {.name = "sampled at 20 kHz", .record = [](Options& o, double) { o.sample_rate = 2e4; }},
          {.name = "begins 30 us after touch", .cut = 30e-6},
          {.name = "ends in the contact", .duration = 0.58e-3},
          {.name = "100 us after the contact only", .duration = 0.8e-3},
          {.name = "no impact in it", .damage = [](datasets::Record& r, RandomStream& random) {
             for (const char* name : {"Force", "Velocity"})
               change_values(r, name,
                             [&](double, double) { return 1e-3 * random.uniform(-1.0, 1.0); });
           }}};
}

/// Loses what comes before.
void cut_before(datasets::Record& record, double time) {
  for (datasets::Channel& channel : record.channels) {
    std::vector<double> values = channel.values();
    const auto lost =
        static_cast<std::ptrdiff_t>((time - channel.clock.start) / channel.clock.interval);
    values.erase(values.begin(), values.begin() + lost);
    channel.clock.start += channel.clock.interval * static_cast<double>(lost);
    set_values(channel, std::move(values));
  }
}

struct Study {
  std::string rig = tests::source_dir + "/datasets/samples/shen2007.toml";
  std::string program = IMPACTRIG_PROGRAM;
  std::vector<std::string> set = {"solver.model=hybrid", "solver.modes=12"};
  std::string only, output;
  std::uint64_t seed = 1;
  int shots = 10;
  bool sentences = false;
};

/// How one shot ended.
struct End {
  bool refused = false, warned = false, inside = false;
  double pull = 0.0, error = 0.0;  // of the restitution; error: fitted - true
  std::vector<std::string> sentences;
};

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

End read_end(int code, const std::string& base, double truth) {
  End end;
  const nlohmann::json result = nlohmann::json::parse(text_of(base + ".json"), nullptr, false);
  if (result.is_discarded()) {
    end.refused = true;
    end.sentences.push_back(fmt::format("exit {}: {}", code, text_of(base + ".txt")));
    return end;
  }
  for (const auto& impact : result["impacts"])
    for (const std::string flag : impact["flags"])
      if (!flag.ends_with("-hit") && !flag.ends_with("-hits"))
        end.sentences.push_back("flag: " + flag);
  for (const std::string warning : result["warnings"])
    if (warning.find("The mesh is coarser") != 0 && warning.find(" second contact") == warning.npos)
      end.sentences.push_back("warning: " + warning);
  for (const auto& channel : result["channels"])
    if (!channel["diagnostics"].value("sound", true))
      end.sentences.push_back("unsound: " + channel["diagnostics"]["sentence"].get<std::string>());
  end.warned = !end.sentences.empty();
  for (const auto& p : result["parameters"]) {
    if (p["name"] != "contact.restitution") continue;
    end.error = p["value"].get<double>() - truth;
    end.pull = p["std_error"].is_null() ? HUGE_VAL : end.error / p["std_error"].get<double>();
    end.inside = std::abs(end.pull) <= 1.96;
  }
  return end;
}

End run_shot(const Study& study, const Kind& kind, std::uint64_t seed, const std::string& base) {
  std::string settings;
  for (const std::string& text : study.set) settings += fmt::format(" --set '{}'", text);
  fitting::RigFile truth = fitting::read_rig_file(study.rig, bench::overrides(study.set));
  bench::draw_truth(seed, truth.rig);
  bench::RecordedShot shot = bench::record_shot(
      truth, {.pre_trigger = kind.pre_trigger,
              .duration = kind.duration,
              .accuracy = 1e-5,
              .change = [&](acquisition::SyntheticOptions& options, double peak) {
                options.seed = seed;
                acquisition::draw_calibration_errors(bench::sensors_of(truth), seed, options);
                if (kind.record) kind.record(options, peak);
              }});
  RandomStream damage(seed, "damage");
  if (kind.damage) kind.damage(shot.record, damage);
  if (kind.cut > 0.0) cut_before(shot.record, first_touch(shot.record) + kind.cut);
  std::filesystem::remove(base + ".h5");
  datasets::write_record(shot.record, base + ".h5");
  const std::string command =
      fmt::format("'{0}' fit -q --json '{1}.h5' --rig '{2}'{3} > '{1}.json' 2> '{1}.txt'",
                  study.program, base, study.rig, settings);
  const int code = std::system(command.c_str());
  return read_end(WEXITSTATUS(code), base, truth.rig.contact.restitution);
}

/// How often each sentence was said, without its numbers.
void print_sentences(const std::vector<End>& ends) {
  std::map<std::string, std::pair<int, std::string>> said;
  for (const End& end : ends)
    for (const std::string& sentence : end.sentences) {
      std::string key;
      for (const char c : sentence.substr(0, 60))
        if (std::isdigit(static_cast<unsigned char>(c)) == 0) key += c;
      auto& [times, first] = said[key];
      if (times++ == 0) first = sentence;
    }
  for (const auto& [key, what] : said)
    fmt::print("      {} x {}\n", what.first,
               what.second.substr(0, what.second.find_last_not_of('\n') + 1));
}

void run(const Study& study) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("bad-data-{}", getpid());
  std::filesystem::create_directory(folder);
  nlohmann::ordered_json json = {{"schema", "impactrig/bad-data/1"},
                                 {"program", datasets::program_version()},
                                 {"first_seed", study.seed},
                                 {"shots", study.shots},
                                 {"set", study.set}};
  fmt::print("{:<32} {:>8} {:>8} {:>8} {:>8} {:>12} {:>10} {:>10}\n", "recording", "refused",
             "warned", "quiet", "e inside", "quiet, wrong", "median |z|", "worst e");
  for (const Kind& kind : kinds()) {
    if (kind.name.find(study.only) == std::string::npos) continue;
    std::vector<End> ends(static_cast<std::size_t>(study.shots));
    fitting::run_on_all_cores(ends.size(), [&](std::size_t k, std::size_t worker) {
      ends[k] = run_shot(study, kind, study.seed + k, folder / fmt::format("{}", worker));
    });
    const auto count = [&](auto&& test) { return std::ranges::count_if(ends, test); };
    const auto fitted = count([](const End& e) { return !e.refused; });
    std::vector<double> pulls;
    double worst = 0.0;
    for (const End& end : ends) {
      if (end.refused) continue;
      pulls.push_back(std::abs(end.pull));
      if (std::abs(end.error) > std::abs(worst)) worst = end.error;
    }
    std::ranges::sort(pulls);
    const auto warned = count([](const End& e) { return !e.refused && e.warned; });
    const auto inside = count([](const End& e) { return !e.refused && e.inside; });
    const auto bad = count([](const End& e) { return !e.refused && !e.warned && !e.inside; });
    fmt::print("{:<32} {:>8} {:>8} {:>8} {:>5}/{:<2} {:>12} {:>10.2f} {:>+10.4f}\n", kind.name,
               study.shots - fitted, warned, fitted - warned, inside, fitted, bad,
               pulls.empty() ? NAN : pulls[pulls.size() / 2], worst);
    if (study.sentences) print_sentences(ends);
    std::fflush(stdout);
    json["kinds"].push_back({{"name", kind.name},
                             {"refused", study.shots - fitted},
                             {"warned", warned},
                             {"inside", inside},
                             {"quiet_and_wrong", bad},
                             {"worst_error", worst}});
  }
  std::filesystem::remove_all(folder);
  if (!study.output.empty()) std::ofstream(study.output) << json.dump(1) << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  Study study;
  CLI::App program("What `impactrig fit` does with bad data");
  program.add_option("--rig", study.rig, "Rig file")->capture_default_str();
  program.add_option("--program", study.program, "impactrig")->capture_default_str();
  program.add_option("--set", study.set, "key=value of the rig file");
  program.add_option("--shots", study.shots, "Of every kind")->check(CLI::Range(1, 100000));
  program.add_option("--seed", study.seed, "Of the first shot")->capture_default_str();
  program.add_option("--only", study.only, "Kinds whose name has this in it");
  program.add_flag("--sentences", study.sentences, "What was said, and how often");
  program.add_option("-o,--output", study.output, "The table as JSON");
  CLI11_PARSE(program, argc, argv);
  try {
    run(study);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
