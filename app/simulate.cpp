// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>

#include "acquisition/exporter.hpp"
#include "app/files.hpp"
#include "app/program.hpp"
#include "datasets/record.hpp"
#include "fitting/rig_file.hpp"
#include "models/explain.hpp"
#include "models/mesh_error.hpp"
#include "models/simulation.hpp"
#include "reports/report_data.hpp"
#include "reports/text.hpp"

namespace impactrig::app {
namespace {

constexpr double most_samples = 2e7;
constexpr double longest_explanation = 10.0;  // what a run without one simplification may take [s]

struct Options {
  std::string rig;
  std::string output;
  double interval = 1e-6;
  bool explain = false;
  bool exact = false;
  CommonOptions common;
};

datasets::Record history_record(const models::History& history, const fitting::RigFile& rig) {
  datasets::Record record;
  record.title = rig.rig.has_stop() ? "simulated impact" : "simulated swing";
  record.provenance.program = datasets::program_version();
  record.provenance.source_file = rig.path;
  record.provenance.sha256 = rig.sha256;
  const auto add = [&](const std::string& name, datasets::Quantity quantity,
                       const std::vector<double>& values) {
    datasets::Channel channel;
    channel.name = name;
    channel.quantity = quantity;
    channel.unit = datasets::si_unit(quantity);
    channel.clock = {.start = history.start, .interval = history.interval, .times = {}};
    channel.raw = values;
    record.channels.push_back(std::move(channel));
  };
  if (rig.rig.has_stop()) add("Force", datasets::Quantity::force, history.seen_force());
  add("Velocity", datasets::Quantity::velocity, history.velocity);
  add("Displacement", datasets::Quantity::displacement, history.displacement);
  if (rig.rig.hinge.rotation) {
    add("Deflection", datasets::Quantity::displacement, history.deflection);
    add("Extension", datasets::Quantity::displacement, history.extension);
  }
  if (rig.rig.has_stop()) add("Penetration", datasets::Quantity::displacement, history.penetration);
  if (!history.sensor_force.empty()) add("Contact force", datasets::Quantity::force, history.force);
  for (std::size_t i = 0; i < history.further.size(); ++i) {
    add(fmt::format("Force at stop {}", i + 1), datasets::Quantity::force,
        history.further[i].force);
    add(fmt::format("Penetration at stop {}", i + 1), datasets::Quantity::displacement,
        history.further[i].penetration);
  }
  return record;
}

std::string duration_text(double seconds) {
  return seconds < 1.0 ? fmt::format("{:.3g} ms", 1e3 * seconds) : fmt::format("{:.3g} s", seconds);
}

/// What a simplification changed and saved.
std::string effect(const models::Explanation& explanation) {
  if (!explanation.failure.empty()) return "without it: " + explanation.failure;
  const std::string saved =
      fmt::format("takes {} instead of {}", duration_text(explanation.seconds),
                  duration_text(explanation.seconds_without));
  if (!std::isfinite(explanation.peak_force)) return saved;
  return fmt::format(
      "changes the first contact's peak force by {:.1e}, duration by {:.1e}, impulse by {:.1e}; {}",
      explanation.peak_force, explanation.duration, explanation.impulse, saved);
}

void print_explanations(const std::string& chosen,
                        const std::vector<models::Explanation>& explanations) {
  fmt::print("\nSimplifications taken:\n");
  if (!chosen.empty()) fmt::print("  - {}\n", chosen);
  if (chosen.empty() && explanations.empty()) fmt::print("  none\n");
  for (const models::Explanation& explanation : explanations)
    fmt::print("  - {}\n    {}\n", explanation.sentence, effect(explanation));
}

void simulate(const Options& options) {
  if (!options.output.empty()) {
    refuse_inputs({options.output}, {options.rig});
    check_output(options.output, options.common.force);
    check_ending(options.output);
  }
  fitting::RigFile rig =
      fitting::read_rig_file(options.rig, split_overrides(options.common.overrides));
  const std::string chosen = fitting::choose_mesh(rig);
  models::SimulationOptions request;
  const double longest = rig.solver.duration.value_or(0.1);
  if (!options.output.empty() && longest / options.interval > most_samples)
    throw CLI::ValidationError(
        "--interval", fmt::format("{:g} s over {:g} s are more than {:g} samples", options.interval,
                                  longest, most_samples));
  request.exact = options.exact;
  if (!options.output.empty()) {
    request.history.interval = options.interval;
    if (rig.velocity) request.history.velocity_position = rig.velocity->position;
    if (rig.displacement) request.history.displacement_position = rig.displacement->position;
  }
  models::Simulation simulation = models::simulate(rig.rig, rig.solver, request);
  if (!chosen.empty()) simulation.skipped.insert(simulation.skipped.begin(), chosen);
  simulation.mesh_error = models::mesh_error(rig.rig, simulation.solver);
  if (!options.output.empty())
    acquisition::export_recording(history_record(simulation.history, rig), options.output);
  std::optional<std::vector<models::Explanation>> explanations;
  if (options.explain)
    explanations = models::explain(rig.rig, rig.solver, request, longest_explanation);
  if (options.common.json) {
    fmt::print("{}\n", reports::simulation_to_json(simulation, rig.rig, explanations));
    return;
  }
  fmt::print("{}", reports::to_text(simulation, rig.rig));
  if (explanations) print_explanations(chosen, *explanations);
}

}  // namespace

void add_simulate(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("simulate", "Predict one impact of a rig");
  command->add_option("rig", options->rig, "Rig file (TOML)")->required();
  command->add_option("-o,--output", options->output, "History: .h5, .mat, .csv or .uff");
  command->add_option("--interval", options->interval, "Sample interval of the history [s]")
      ->check(positive)
      ->capture_default_str();
  command->add_flag("--explain", options->explain,
                    "List the simplifications taken, and why they are safe here");
  command->add_flag("--exact", options->exact, "Take no simplification");
  add_json(*command, options->common);
  add_set(*command, options->common);
  add_force(*command, options->common);
  command->callback([options] { simulate(*options); });
}

}  // namespace impactrig::app
