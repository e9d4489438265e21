// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cstdio>

#include "app/files.hpp"
#include "app/fit_job.hpp"
#include "reports/text.hpp"

namespace impactrig::app {
namespace {

struct Options {
  FitJob job;
  std::string output;
};

void validate(const Options& options) {
  refuse_inputs({options.output}, inputs_of(options.job));
  check_output(options.output, options.job.common.force);
  const reports::ReportData data = run_fit_job(options.job);
  write_output(options.output, reports::to_html(data), options.job.common.force);
  fmt::print("{}\n", options.job.common.json ? reports::to_json(data) : reports::to_text(data));
  std::fflush(stdout);  // where both streams are one, what follows comes behind
  if (!options.job.common.quiet) fmt::print(stderr, "report written to {}\n", options.output);
  if (data.fit.termination != "converged") throw Exit{gate_failed};
}

}  // namespace

void add_validate(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "validate", "Import recordings, find the impacts, fit, and write a report");
  add_fit_job(*command, options->job);
  add_json(*command, options->job.common);
  command->add_option("-o,--output", options->output, "Report (HTML)")->required();
  command->callback([options] { validate(*options); });
}

}  // namespace impactrig::app
