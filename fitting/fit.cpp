// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "datasets/number_text.hpp"
#include "fitting/filtered_samples.hpp"
#include "fitting/fit_problem.hpp"
#include "fitting/fit_report.hpp"
#include "fitting/fit_search.hpp"
#include "fitting/further_intervals.hpp"
#include "fitting/identifiability.hpp"
#include "fitting/mesh_shift.hpp"
#include "fitting/motion_choice.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;

constexpr double whole = std::numeric_limits<double>::infinity();

double seconds_since(std::chrono::steady_clock::time_point started) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

class Session {
 public:
  Session(const std::vector<Impact>& impacts, const RigFile& rig, const FitOptions& options)
      : impacts_(impacts),
        options_(options),
        problem_(impacts, rig, options),
        search_(problem_, options.loss, options.window > 0.0) {}

  Fit run();

 private:
  void settle();
  void settle_motion();
  void predict();
  void tell_early_end();
  bool look_beyond_window();
  Fit report();
  void report_predictions(Fit& fit);
  std::string termination() const;

  const std::vector<Impact>& impacts_;
  const FitOptions& options_;
  FitProblem problem_;
  FitSearch search_;
  std::vector<std::string> warnings_;
  bool out_of_time_ = false;
  FitEnd end_;
  std::vector<models::Simulation> predictions_;  // at the end
  std::string skipped_;  // what the predictions leave out, and what that does to the fit
};

/// Where the search ended.
void Session::settle() {
  end_ = linearised_end(problem_);
  predict();
}

void Session::tell_early_end() {
  if (!search_.early_end()) return;
  const FitSearch::EarlyEnd& end = *search_.early_end();
  const std::string with =
      end.whole ? fmt::format("{} with it, ", datasets::figures(*end.whole, 3)) : "";
  warnings_.push_back(fmt::format(
      "The fit ends {:.3g} ms after first touch, before the second contact: what the bar does from "
      "then on depends on all that the model and its mesh lack (reduced chi-square {}{} without). "
      "--window states another end.",
      1e3 * end.window, with, datasets::figures(end.early, 3)));
}

/// The full equations where those of small motion leave out what the data tell.
void Session::settle_motion() {
  if (problem_.motion() != models::Motion::small) return;
  const double shift = shift_by_full_motion(problem_, end_, predictions_);
  if (shift <= harmless_shift) {
    skipped_ = fmt::format(
        "in the fit: with the full equations no parameter of the impact would move by more than "
        "{:.2g} standard errors",
        shift);
    return;
  }
  prefer_full_motion(problem_);
  search_.finish();
  settle();
}

/// At the present values, with history, one a recording.
void Session::predict() {
  predictions_.clear();
  for (const Shot& shot : problem_.shots()) {
    const double interval = std::min(1e-6, shot.channels.front().signal->interval);
    predictions_.push_back(shot.model->simulate(shot.cost->rig(), interval));
  }
}

/// A window that ends in the first contact leaves what follows to the prediction, which goes on for
/// that until the bar has left. Returns whether it does.
bool Session::look_beyond_window() {
  const auto in_contact = [](const models::Simulation& prediction) {
    return !prediction.episodes.empty() && prediction.episodes.front().open;
  };
  if (std::ranges::none_of(predictions_, in_contact)) return false;
  problem_.see_separation();
  predict();
  if (std::ranges::none_of(predictions_, in_contact))
    warnings_.emplace_back(
        "The fitted window ends in contact: kinematic, kinetic and energetic restitution are those "
        "of the model beyond it, where nothing was fitted. A longer window would show them.");
  return true;
}

std::string Session::termination() const {
  if (search_.end().converged) return "converged";
  if (out_of_time_)
    return fmt::format("stopped after {:g} s, fit.time_limit, without converging",
                       options_.time_limit);
  return fmt::format("stopped after {} iterations without converging", search_.end().iterations);
}

void Session::report_predictions(Fit& fit) {
  fit.predictions = std::move(predictions_);
  for (std::size_t i = 0; i < fit.predictions.size(); ++i) {
    std::vector<std::string>& skipped = fit.predictions[i].skipped;
    if (!skipped_.empty()) skipped.push_back(skipped_);
    for (const FittedChannel& channel : problem_.shots()[i].channels)
      if (channel.every > 1) skipped.push_back(thinning_sentence(*channel.signal));
  }
}

Fit Session::report() {
  Fit fit;
  fit.goodness.chi2 = end_.residuals.head(problem_.data_size()).squaredNorm();
  const double reduced = report_goodness(problem_, end_.spread, fit.goodness);
  const bool rescale =
      !problem_.noise_known() || (reduced > misfit && problem_.loss() == Loss::squares);
  end_.inflation = rescale ? std::sqrt(reduced) : 1.0;
  report_parameters(problem_, end_, fit);
  report_channels(problem_, fit);
  fit.rig = fitted_rig(problem_);
  report_predictions(fit);
  report_restitution(problem_, end_, fit);
  fit.identifiability = identifiability(problem_, end_.jacobian, end_.inflation,
                                        fit.predictions.front().episodes.empty()
                                            ? 0.0
                                            : fit.predictions.front().episodes.front().peak_force);
  if (!fit.identifiability.remedy.empty())
    fit.not_identifiable.push_back(fit.identifiability.remedy);
  fit.impacts = impacts_;
  for (const Shot& shot : problem_.shots()) fit.window = std::max(fit.window, shot.window);
  fit.termination = termination();
  fit.iterations = search_.iterations();
  fit.warnings = problem_.warnings();
  fit.warnings.insert(fit.warnings.end(), warnings_.begin(), warnings_.end());
  fit.loss = options_.loss;
  if (options_.for_report) {
    const auto started = std::chrono::steady_clock::now();
    report_more(problem_, fit);
    fit.judging_seconds = seconds_since(started);
  }
  report_warnings(problem_, end_, fit);
  fit.simulations = problem_.simulations() + static_cast<long>(problem_.shots().size());
  return fit;
}

Fit Session::run() {
  const auto started = std::chrono::steady_clock::now();
  problem_.limit_time(options_.time_limit);
  choose_motion(problem_);
  search_.run();
  settle();
  settle_motion();
  tell_early_end();
  out_of_time_ = problem_.out_of_time();
  problem_.limit_time(whole);
  const bool beyond = look_beyond_window();
  estimate_mesh_shift(problem_, end_, warnings_);
  Fit fit = report();
  if (beyond) problem_.choose_samples(whole, false);
  fit.seconds = seconds_since(started) - fit.judging_seconds;
  add_further_intervals(problem_, end_, options_, out_of_time_, fit);
  return fit;
}

}  // namespace

Fit fit(const std::vector<datasets::Impact>& impacts, const RigFile& rig,
        const FitOptions& options) {
  if (!rig.rig.has_stop())
    throw std::invalid_argument("the rig has no [contact]: there is no impact to fit");
  return Session(impacts, rig, options).run();
}

Fit fit(const std::vector<datasets::Impact>& impacts, const RigFile& rig) {
  return fit(impacts, rig, rig.fit);
}

}  // namespace impactrig::fitting
