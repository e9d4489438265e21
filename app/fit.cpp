// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "app/files.hpp"
#include "app/fit_job.hpp"
#include "reports/text.hpp"

namespace impactrig::app {
namespace {

struct Options {
  FitJob job;
  std::string output;
};

void fit(const Options& options) {
  if (!options.output.empty()) {
    refuse_inputs({options.output}, inputs_of(options.job));
    check_output(options.output, options.job.common.force);
  }
  const reports::ReportData data = run_fit_job(options.job);
  const std::string json = reports::to_json(data);
  if (!options.output.empty()) write_output(options.output, json, options.job.common.force);
  fmt::print("{}\n", options.job.common.json ? json : reports::to_text(data));
  if (data.fit.termination != "converged") throw Exit{gate_failed};
}

}  // namespace

void add_fit(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("fit", "Fit restitution and contact parameters to recordings");
  add_fit_job(*command, options->job);
  add_json(*command, options->job.common);
  command->add_option("-o,--output", options->output,
                      "Result with everything a report needs (JSON)");
  command->callback([options] { fit(*options); });
}

}  // namespace impactrig::app
