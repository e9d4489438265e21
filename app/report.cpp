// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "app/files.hpp"
#include "app/program.hpp"
#include "reports/report_data.hpp"

namespace impactrig::app {
namespace {

struct Options {
  std::string result;
  std::string output;
  CommonOptions common;
};

void report(const Options& options) {
  refuse_inputs({options.output}, {options.result});
  check_output(options.output, options.common.force);
  const reports::ReportData data =
      reports::report_from_json(read_text(options.result), options.result);
  write_output(options.output, reports::to_html(data), options.common.force);
  if (!options.common.quiet) fmt::print(stderr, "report written to {}\n", options.output);
}

}  // namespace

void add_report(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("report", "Write the report of a fit that was kept as JSON");
  command->add_option("result", options->result, "What `impactrig fit -o` wrote")->required();
  command->add_option("-o,--output", options->output, "Report (HTML)")->required();
  add_quiet(*command, options->common);
  add_force(*command, options->common);
  command->callback([options] { report(*options); });
}

}  // namespace impactrig::app
