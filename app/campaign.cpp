// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>

#include "acquisition/importer.hpp"
#include "app/campaign_items.hpp"
#include "app/campaign_plan.hpp"
#include "app/files.hpp"
#include "app/fit_job.hpp"
#include "app/progress.hpp"
#include "app/worker_processes.hpp"
#include "datasets/input_error.hpp"
#include "fitting/all_cores.hpp"
#include "reports/campaign.hpp"

namespace impactrig::app {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_reports = 100;  // written without being asked for

struct Options {
  FitJob job;
  std::string output;
  int jobs = 0;
  bool reports = false;
  bool dry = false;
  const CLI::Option* reports_stated = nullptr;  ///< that or --no-reports
};

/// A campaign on its way: what is done and what is left.
struct Run {
  const Options& options;
  std::vector<CampaignItem> items;
  bool reports = false;
  std::map<std::string, reports::CampaignShot> shots;  ///< by item name
  reports::Campaign campaign;

  std::string path(const std::string& name) const {
    return (fs::path(options.output) / name).string();
  }

  std::string result_path(const CampaignItem& item) const {
    return path("fits/" + item.name + ".json");
  }

  std::string report_path(const CampaignItem& item) const {
    return path("reports/" + item.name + ".html");
  }

  bool quiet() const { return options.job.common.quiet; }
};

/// Throws datasets::FileError unless the folder is new or holds a campaign.
void check_folder(const Run& run) {
  std::error_code failure;
  const fs::path folder = run.options.output;
  if (fs::exists(folder, failure) && !fs::is_directory(folder, failure))
    throw datasets::FileError(folder.string(), "cannot be written: it is no folder");
  if (fs::is_directory(folder, failure) && !fs::is_empty(folder, failure) &&
      !fs::is_directory(folder / "fits", failure) && !run.options.job.common.force)
    throw datasets::FileError(folder.string(),
                              "is a folder with something else in it; choose another name or add "
                              "--force to write a campaign into it");
}

/// Throws datasets::FileError where a recording or the rig file is what the campaign will write,
/// or clear away.
void refuse_inputs_of(const Run& run) {
  std::vector<std::string> outputs = {run.path("summary.json"), run.path("summary.csv"),
                                      run.path("index.html"), run.path("failed.json")};
  std::vector<std::string> inputs = {run.options.job.rig};
  for (const CampaignItem& item : run.items) {
    outputs.push_back(run.result_path(item));
    outputs.push_back(run.report_path(item));
    inputs.push_back(item.path);
  }
  refuse_inputs(outputs, inputs);
}

void prepare_folder(const Run& run) {
  check_folder(run);
  std::error_code failure;
  const fs::path folder = run.options.output;
  fs::create_directories(folder / "fits", failure);
  if (!failure && run.reports) fs::create_directories(folder / "reports", failure);
  if (failure) throw datasets::FileError(folder.string(), "cannot be made: " + failure.message());
}

/// Keys of all recordings; those that cannot be read have failed, copies are left out.
void hash_items(Run& run, const std::string& config_sha256) {
  std::vector<CampaignItem> readable;
  std::map<std::string, std::string> seen;
  for (CampaignItem& item : run.items) {
    try {
      if (std::error_code ignored; fs::file_size(item.path, ignored) == 0)
        throw datasets::InputError({.file = item.path}, "the file is empty");
      item.sha256 = acquisition::sha256_of_recording(item.path);
    } catch (const std::exception& error) {
      run.campaign.failed.push_back({item.path, error.what()});
      continue;
    }
    if (const auto [first, is_new] = seen.emplace(item.sha256, item.path); !is_new) {
      run.campaign.left_out.push_back(
          {item.path, fmt::format("is the same recording as {}; it counts once", first->second)});
      continue;
    }
    item.key = result_key(run.options.job, config_sha256, {item.sha256});
    readable.push_back(item);
  }
  run.items = std::move(readable);
}

void keep(Run& run, const CampaignItem& item, const reports::ReportData& data) {
  reports::CampaignShot shot = reports::campaign_shot(data);
  shot.file = item.path;
  shot.name = item.name;
  shot.has_report = run.reports;
  run.shots[item.name] = std::move(shot);
}

/// A report that is missing, or older than its result, as after an end in between.
void complete_report(const Run& run, const CampaignItem& item, const reports::ReportData& data) {
  if (!run.reports) return;
  std::error_code failure;
  const std::string report = run.report_path(item);
  const auto written = fs::last_write_time(report, failure);
  if (!failure && written >= fs::last_write_time(run.result_path(item), failure)) return;
  write_output(report, reports::to_html(data), true);
}

/// False where there is no file, or one that is no JSON: a result that was cut off is made anew.
bool is_result(const std::string& path) {
  return fs::exists(path) && nlohmann::json::accept(read_text(path));
}

/// A result that is there and has the same key.
std::optional<reports::ReportData> stored_result(const Run& run, const CampaignItem& item) {
  const std::string path = run.result_path(item);
  if (fs::exists(path)) try {
      reports::ReportData data = reports::report_from_json(read_text(path), path);
      if (data.provenance.result_key == item.key) return data;
    } catch (const datasets::InputError&) {
      return std::nullopt;  // no result of this version
    }
  return std::nullopt;
}

/// Takes the results that are there with the same key; returns what is left to do. Throws
/// datasets::FileError where results of something else are in the way.
std::vector<CampaignItem> take_stored(Run& run) {
  std::vector<CampaignItem> todo;
  std::size_t others = 0;
  for (const CampaignItem& item : run.items) {
    if (const auto data = stored_result(run, item)) {
      complete_report(run, item, *data);
      keep(run, item, *data);
      continue;
    }
    others += is_result(run.result_path(item)) ? 1 : 0;
    todo.push_back(item);
  }
  if (others > 0 && !run.options.job.common.force)
    throw datasets::FileError(
        run.options.output,
        fmt::format("holds {} of {} results that were made from other recordings, options or by "
                    "another version; choose another folder, or add --force to make these anew",
                    others, run.items.size()));
  return todo;
}

/// What would be done to each recording, in their order; nothing is written.
std::vector<PlannedItem> plan_of(const Run& run) {
  std::vector<PlannedItem> plan;
  for (const CampaignItem& item : run.items) {
    const bool other = is_result(run.result_path(item));
    const PlannedItem::What what = stored_result(run, item)       ? PlannedItem::What::reuse
                                   : !other                       ? PlannedItem::What::fit
                                   : run.options.job.common.force ? PlannedItem::What::replace
                                                                  : PlannedItem::What::refuse;
    plan.push_back({item.path, what, run.result_path(item)});
  }
  for (const reports::CampaignFailure& copy : run.campaign.left_out)
    plan.push_back({copy.file, PlannedItem::What::leave_out, copy.sentence});
  for (const reports::CampaignFailure& failed : run.campaign.failed)
    plan.push_back({failed.file, PlannedItem::What::fail, failed.sentence});
  return plan;
}

/// In the worker's process: everything that can go wrong is a code and a sentence.
WorkEnd fit_one(const Run& run, const CampaignItem& item, std::size_t cores) {
  fitting::limit_cores(cores);
  FitJob job = run.options.job;
  job.recordings = {item.path};
  job.common.quiet = true;
  try {
    const reports::ReportData data = run_fit_job(job);
    write_output(run.result_path(item), reports::to_json(data), true);
    if (run.reports) write_output(run.report_path(item), reports::to_html(data), true);
    return {};
  } catch (const datasets::FileError& error) {
    return {file_error, error.what()};
  } catch (const std::bad_alloc&) {
    return {internal_error, "out of memory"};
  } catch (const std::exception& error) {
    return {invalid_input, error.what()};
  }
}

void remove_parts(const Run& run, const CampaignItem& item) {
  std::error_code ignored;
  fs::remove(run.result_path(item) + ".part", ignored);
  fs::remove(run.report_path(item) + ".part", ignored);
}

/// What failed leaves nothing of an older fit behind.
void ended(Run& run, const CampaignItem& item, const WorkEnd& end) {
  if (end.code == done) {
    const std::string path = run.result_path(item);
    keep(run, item, reports::report_from_json(read_text(path), path));
    return;
  }
  remove_parts(run, item);
  std::error_code ignored;
  fs::remove(run.result_path(item), ignored);
  fs::remove(run.report_path(item), ignored);
  run.campaign.failed.push_back({item.path, end.sentence});
}

void fit_all(Run& run, const std::vector<CampaignItem>& todo) {
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t wanted =
      run.options.jobs > 0 ? static_cast<std::size_t>(run.options.jobs) : cores;
  const std::size_t jobs = std::max<std::size_t>(1, std::min(wanted, todo.size()));
  if (!run.quiet())
    fmt::print(stderr, "{} recordings: {} results reused, {} to fit, {} at a time\n",
               run.items.size(), run.items.size() - todo.size(), todo.size(), jobs);
  Progress progress("fitting", todo.size(), run.quiet());
  const int signal = run_in_processes(
      todo.size(), jobs,
      [&](std::size_t i) { return fit_one(run, todo[i], std::max<std::size_t>(1, cores / jobs)); },
      [&](std::size_t i, const WorkEnd& end) {
        ended(run, todo[i], end);
        progress.add(1);
      },
      [&](std::size_t i) { remove_parts(run, todo[i]); });
  if (signal == 0) return;
  fmt::print(stderr,
             "\nimpactrig: interrupted; {} of {} results are kept in {}, and the same command goes "
             "on from there\n",
             run.shots.size(), run.items.size(), run.options.output);
  throw Exit{128 + signal};
}

/// Recordings in their order, whenever each was done.
void write_summary(Run& run) {
  reports::Campaign& campaign = run.campaign;
  std::string keys;
  for (const CampaignItem& item : run.items) {
    const auto found = run.shots.find(item.name);
    if (found == run.shots.end()) continue;
    campaign.shots.push_back(found->second);
    campaign.provenance.inputs.push_back(
        {item.path, acquisition::bytes_of_recording(item.path), item.sha256});
    keys += item.key + "\n";
  }
  campaign.provenance.result_key = datasets::sha256_of(keys);
  std::sort(campaign.failed.begin(), campaign.failed.end(),
            [](const auto& a, const auto& b) { return a.file < b.file; });
  reports::summarise(campaign);
  write_output(run.path("summary.json"), reports::to_json(campaign), true);
  write_output(run.path("summary.csv"), reports::to_csv(campaign), true);
  write_output(run.path("index.html"), reports::to_html(campaign), true);
  std::error_code ignored;
  if (campaign.failed.empty())
    fs::remove(run.path("failed.json"), ignored);
  else
    write_output(run.path("failed.json"), reports::failed_json(campaign), true);
}

void campaign(const Options& options) {
  if (!options.job.shared.empty())
    throw CLI::ValidationError("--shared",
                               "a campaign fits every recording by itself, which shares nothing; "
                               "`impactrig fit` takes several recordings at once");
  const auto started = std::chrono::steady_clock::now();
  Run run{.options = options,
          .items = campaign_items(options.job.recordings),
          .reports = false,
          .shots = {},
          .campaign = {}};
  refuse_inputs_of(run);
  run.reports =
      options.reports_stated->count() > 0 ? options.reports : run.items.size() <= most_reports;
  run.campaign.provenance = provenance_of(options.job);
  run.campaign.title =
      !options.job.title.empty()
          ? options.job.title
          : fmt::format("Campaign of {}", fs::path(options.job.rig).filename().string());
  if (options.dry) {
    check_folder(run);
    hash_items(run, run.campaign.provenance.config_sha256);
    const std::vector<PlannedItem> plan = plan_of(run);
    fmt::print("{}", options.job.common.json ? plan_json(plan) : plan_text(plan));
    return;
  }
  prepare_folder(run);
  hash_items(run, run.campaign.provenance.config_sha256);
  fit_all(run, take_stored(run));
  run.campaign.provenance.wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  write_summary(run);
  fmt::print("{}", options.job.common.json ? reports::to_json(run.campaign)
                                           : reports::to_text(run.campaign));
  if (!run.quiet()) fmt::print(stderr, "summary written to {}\n", run.path("index.html"));
  if (!run.campaign.failed.empty()) throw Exit{some_failed};
  for (const reports::CampaignShot& shot : run.campaign.shots)
    if (!shot.converged) throw Exit{gate_failed};
}

}  // namespace

void add_campaign(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "campaign", "Fit many recordings of one rig, each by itself, and sum them up");
  add_fit_job(*command, options->job);
  add_json(*command, options->job.common);
  command
      ->add_option("-o,--output", options->output,
                   "Folder of results and summary; one that is there already is gone on with")
      ->required();
  command->add_option("-j,--jobs", options->jobs, "Fits at a time; default one a core")
      ->check(CLI::Range(1, 4096));
  options->reports_stated = command->add_flag("--reports,!--no-reports", options->reports,
                                              "A report (HTML) each; default up to 100 recordings");
  command->add_flag("--dry-run", options->dry,
                    "Say what would be done to each recording, and do nothing");
  command->callback([options] { campaign(*options); });
}

}  // namespace impactrig::app
