// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/exporter.hpp"
#include "app/files.hpp"
#include "app/program.hpp"
#include "app/quantity_option.hpp"
#include "datasets/record.hpp"
#include "fitting/mesh_choice.hpp"
#include "fitting/rig_file.hpp"
#include "fitting/sensitivity_parameters.hpp"
#include "models/explain.hpp"
#include "models/mesh_error.hpp"
#include "models/sensitivities/add_sensitivity.hpp"
#include "models/sensitivities/derivative_refusal.hpp"
#include "models/simulation.hpp"
#include "models/time_limit.hpp"
#include "reports/report_data.hpp"
#include "reports/sensitivities.hpp"
#include "reports/text.hpp"

namespace impactrig::app {
namespace {

constexpr double most_samples = 2e7;
constexpr double longest_explanation = 10.0;  // what a run without one simplification may take [s]

struct Options {
  std::string rig;
  std::string output;
  double interval = 1e-6;
  std::string sensitivities;  ///< names with commas
  bool explain = false;
  bool exact = false;
  bool small_motion = false;
  CommonOptions common;
};

/// What a history shows, and what it is called.
struct HistoryChannel {
  std::string name;
  datasets::Quantity quantity;
  std::vector<double> values;
};

/// The same of a history and of its derivatives.
std::vector<HistoryChannel> channels_of(const models::History& history, const models::Rig& rig) {
  using enum datasets::Quantity;
  std::vector<HistoryChannel> all;
  if (rig.has_stop()) all.push_back({"Force", force, history.seen_force()});
  all.push_back({"Velocity", velocity, history.velocity});
  all.push_back({"Displacement", displacement, history.displacement});
  if (rig.hinge.rotation) {
    all.push_back({"Deflection", displacement, history.deflection});
    all.push_back({"Extension", displacement, history.extension});
  }
  if (rig.has_stop()) all.push_back({"Penetration", displacement, history.penetration});
  if (!history.sensor_force.empty()) all.push_back({"Contact force", force, history.force});
  for (std::size_t i = 0; i < history.further.size(); ++i) {
    all.push_back({fmt::format("Force at stop {}", i + 1), force, history.further[i].force});
    all.push_back({fmt::format("Penetration at stop {}", i + 1), displacement,
                   history.further[i].penetration});
  }
  return all;
}

/// With derivatives in channels of their own, "Force by contact.restitution".
datasets::Record history_record(const models::History& history, const fitting::RigFile& rig,
                                const std::vector<reports::SensitivityEntry>& sensitivities) {
  datasets::Record record;
  record.title = rig.rig.has_stop() ? "simulated impact" : "simulated swing";
  record.provenance.program = datasets::program_version();
  record.provenance.source_file = rig.path;
  record.provenance.sha256 = rig.sha256;
  const auto add = [&](HistoryChannel&& shown, const std::string& unit) {
    datasets::Channel channel;
    channel.name = std::move(shown.name);
    channel.quantity = shown.quantity;
    channel.unit = unit;
    channel.clock = {.start = history.start, .interval = history.interval, .times = {}};
    channel.raw = std::move(shown.values);
    record.channels.push_back(std::move(channel));
  };
  for (HistoryChannel& shown : channels_of(history, rig.rig)) {
    const std::string unit(datasets::si_unit(shown.quantity));
    add(std::move(shown), unit);
  }
  for (const reports::SensitivityEntry& entry : sensitivities) {
    if (!entry.not_known.empty()) continue;
    for (HistoryChannel& shown : channels_of(entry.slope.history, rig.rig)) {
      const std::string unit =
          fmt::format("{}/({})", datasets::si_unit(shown.quantity), entry.parameter.unit);
      shown.name += fmt::format(" by {}", entry.parameter.name);
      shown.quantity = datasets::Quantity::other;
      add(std::move(shown), unit);
    }
  }
  return record;
}

/// What is to be differentiated by; asks the simulation for what it can tell.
std::vector<reports::SensitivityEntry> ask_for_sensitivities(const Options& options,
                                                             const fitting::RigFile& file,
                                                             models::SimulationOptions& request) {
  const std::string& names = options.sensitivities;
  std::vector<reports::SensitivityEntry> entries;
  if (names.empty()) return entries;
  try {
    for (fitting::SensitivityParameter& parameter :
         fitting::sensitivity_parameters(file, split_names(names)))
      entries.push_back({.parameter = std::move(parameter), .not_known = {}, .slope = {}});
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--sensitivities", error.what());
  }
  for (reports::SensitivityEntry& entry : entries) {
    if (entry.parameter.spot) request.history.spot_slopes = true;
    for (const auto& part : entry.parameter.parts) {
      if (entry.not_known.empty())
        entry.not_known = models::derivative_refusal(file.rig, file.solver, part.of);
      if (entry.not_known.empty() && options.small_motion)
        entry.not_known = models::small_motion_derivative_refusal(file.rig, part.of);
    }
    if (!entry.not_known.empty()) continue;
    for (const auto& part : entry.parameter.parts)
      if (std::ranges::find(request.sensitivities, part.of) == request.sensitivities.end())
        request.sensitivities.push_back(part.of);
  }
  return entries;
}

/// What the simulation told, to those that asked. Of all numbers, those that change nothing go.
void tell_sensitivities(const models::Simulation& simulation,
                        const models::SimulationOptions& request, bool of_all,
                        std::vector<reports::SensitivityEntry>& entries) {
  for (reports::SensitivityEntry& entry : entries) {
    if (!entry.not_known.empty()) continue;
    if (entry.parameter.spot) {
      entry.slope.history = models::spot_sensitivity(simulation.history, *entry.parameter.spot);
      continue;
    }
    if (simulation.sensitivities.empty()) {
      entry.not_known = "the equations that were solved have none";
      continue;
    }
    for (const auto& part : entry.parameter.parts) {
      const auto asked = std::ranges::find(request.sensitivities, part.of);
      const auto number = static_cast<std::size_t>(asked - request.sensitivities.begin());
      models::add_sensitivity(part.slope, simulation.sensitivities.at(number), entry.slope);
    }
  }
  if (of_all)
    std::erase_if(entries, [&](const reports::SensitivityEntry& entry) {
      return reports::changes_nothing(simulation, entry);
    });
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

/// Warns where small motion would not have been taken by itself.
void tell_asked_motion(const models::Solver& solver, models::Simulation& result) {
  if (result.neglected <= solver.accuracy) return;
  result.warnings.push_back(fmt::format(
      "Small motion was asked for: by its estimate it leaves out {:.1e} of the result, more than "
      "the accuracy of {:g}; the full equations do not.",
      result.neglected, solver.accuracy));
}

/// Where small motion does not see it, a mesh twice as fine takes some times as long; no longer
/// than what is `left` of the time that all may take [s].
double time_for_mesh_error(const models::Cost& cost, double left) {
  return std::min(std::max(1.0, 4.0 * cost.seconds), left);
}

void refuse_too_many_samples(const Options& options, double longest, double channels) {
  if (options.output.empty() || channels * longest / options.interval <= most_samples) return;
  throw CLI::ValidationError(
      "--interval", fmt::format("{:g} s over {:g} s are more than {:g} samples", options.interval,
                                longest, most_samples / channels));
}

void simulate(const Options& options) {
  if (!options.output.empty()) {
    refuse_inputs({options.output}, {options.rig});
    check_output(options.output, options.common.force);
    check_ending(options.output);
  }
  fitting::RigFile rig =
      fitting::read_rig_file(options.rig, split_overrides(options.common.overrides));
  const double longest = rig.solver.duration.value_or(0.1);
  refuse_too_many_samples(options, longest, 1.0);  // before a mesh is chosen, which takes a while
  const models::TimeLimit limit(rig.solver.time_limit);
  const fitting::MeshChoice chosen = fitting::choose_mesh(rig, fitting::finest_mesh);
  models::SimulationOptions request;
  std::vector<reports::SensitivityEntry> sensitivities =
      ask_for_sensitivities(options, rig, request);
  refuse_too_many_samples(options, longest, 1.0 + static_cast<double>(sensitivities.size()));
  request.exact = options.exact;
  if (options.small_motion) request.motion = models::Motion::small;
  if (!options.output.empty()) {
    request.history.interval = options.interval;
    if (rig.velocity) request.history.velocity_position = rig.velocity->position;
    if (rig.displacement) request.history.displacement_position = rig.displacement->position;
  }
  models::Simulation simulation = models::simulate(rig.rig, rig.solver, request);
  simulation.warnings.insert(simulation.warnings.begin(), rig.remarks.begin(), rig.remarks.end());
  if (options.small_motion) tell_asked_motion(rig.solver, simulation);
  tell_sensitivities(simulation, request, options.sensitivities == "all", sensitivities);
  if (!chosen.sentence.empty())
    simulation.skipped.insert(simulation.skipped.begin(), chosen.sentence);
  if (!chosen.warning.empty()) simulation.warnings.push_back(chosen.warning);
  simulation.mesh_error = chosen.difference;
  if (!simulation.mesh_error)
    simulation.mesh_error = models::mesh_error(rig.rig, simulation.solver,
                                               time_for_mesh_error(simulation.cost, limit.left()));
  for (std::string& warning : fitting::mesh_warnings(rig, simulation))
    simulation.warnings.push_back(std::move(warning));
  if (!options.output.empty())
    acquisition::export_recording(history_record(simulation.history, rig, sensitivities),
                                  options.output);
  std::optional<std::vector<models::Explanation>> explanations;
  if (options.explain)
    explanations = models::explain(rig.rig, rig.solver, request, longest_explanation);
  if (options.common.json) {
    fmt::print("{}\n",
               reports::simulation_to_json(simulation, rig.rig, explanations, sensitivities));
    return;
  }
  fmt::print("{}", reports::to_text(simulation, rig.rig));
  if (!options.sensitivities.empty())
    fmt::print("{}", reports::sensitivities_text(simulation, sensitivities));
  if (explanations) print_explanations(chosen.sentence, *explanations);
}

}  // namespace

void add_simulate(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("simulate", "Predict one impact of a rig");
  command->add_option("rig", options->rig, "Rig file (TOML)")->required();
  command->add_option("-o,--output", options->output, "History: .h5, .mat, .csv or .uff");
  command->add_option("--interval", options->interval, "Sample interval of the history [s]")
      ->transform(with_unit("s"))
      ->check(positive)
      ->capture_default_str();
  command
      ->add_option("--sensitivities", options->sensitivities,
                   "Numbers of the rig to differentiate by, as fit --free names them: "
                   "contact.restitution,beam.density; all")
      ->check([](const std::string& names) {
        return split_names(names).empty()
                   ? fmt::format("expected names with commas, or all, found '{}'", names)
                   : std::string();
      })
      ->type_name("NAMES");
  command->add_flag("--explain", options->explain,
                    "List the simplifications taken, and why they are safe here");
  CLI::Option* exact = command->add_flag("--exact", options->exact, "Take no simplification");
  command
      ->add_flag("--small-motion", options->small_motion,
                 "Solve the bar in its modes whatever that leaves out, which is told")
      ->excludes(exact);
  add_json(*command, options->common);
  add_set(*command, options->common);
  add_force(*command, options->common);
  command->callback([options] { simulate(*options); });
}

}  // namespace impactrig::app
