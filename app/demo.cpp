// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cstdio>

#include <filesystem>

#include "app/embedded.hpp"
#include "app/files.hpp"
#include "app/fit_job.hpp"
#include "datasets/input_error.hpp"
#include "reports/text.hpp"

namespace impactrig::app {
namespace {

struct Options {
  std::string folder = "impactrig-demo";
  CommonOptions common;
};

void demo(const Options& options) {
  namespace fs = std::filesystem;
  std::error_code failure;
  fs::create_directories(options.folder, failure);
  if (failure) throw datasets::FileError(options.folder, "cannot be made: " + failure.message());
  const auto in_folder = [&](const char* name) {
    return (fs::path(options.folder) / name).string();
  };
  FitJob job;
  job.rig = in_folder("shen2007.toml");
  job.recordings = {in_folder("shot.uff")};
  job.title = "The rig of Shen et al. (2007), a synthetic shot";
  job.common = options.common;
  const std::string report = in_folder("report.html");
  write_output(job.rig, embedded::shen2007_toml.bytes, options.common.force);
  write_output(job.recordings.front(), embedded::shen2007_1_uff.bytes, options.common.force);
  check_output(report, options.common.force);
  const reports::ReportData data = run_fit_job(job);
  write_output(report, reports::to_html(data), options.common.force);
  fmt::print("{}\n", reports::to_text(data));
  std::fflush(stdout);  // where both streams are one, what follows comes behind
  if (options.common.quiet) return;
  fmt::print(
      stderr,
      "report written to {}\nthe same by hand: impactrig validate {} --rig {} -o report.html\n",
      report, job.recordings.front(), job.rig);
}

}  // namespace

void add_demo(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("demo", "Run the main job on the shipped example");
  command
      ->add_option("-o,--output", options->folder, "Folder for the example's files and the report")
      ->capture_default_str();
  add_quiet(*command, options->common);
  add_force(*command, options->common);
  command->callback([options] { demo(*options); });
}

}  // namespace impactrig::app
