// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "datasets/number_text.hpp"
#include "fitting/filtered_samples.hpp"
#include "fitting/fit_problem.hpp"
#include "fitting/fit_report.hpp"
#include "fitting/fit_search.hpp"
#include "fitting/further_intervals.hpp"
#include "fitting/identifiability.hpp"
#include "fitting/mesh_choice.hpp"
#include "fitting/mesh_shift.hpp"
#include "fitting/motion_choice.hpp"
#include "models/mesh_error.hpp"

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

  /// Where the best fit is, from the present values on, by the equations that are tried first.
  void search(double seconds_left);

  /// From where the fit on a coarser mesh ended, within its window.
  void search_near(const Session& coarser, double seconds_left);

  /// The rig on a mesh twice as fine, where the rig file leaves the mesh open and it is what the
  /// residuals are too large for.
  std::optional<RigFile> on_finer_mesh();

  /// All that there is in the windows.
  bool fits_all() const;

  /// Than one on a coarser mesh, by so much that the finer one is worth its time.
  bool fits_better_than(const Session& coarser) const;

  /// Settles what the search left open, and reports; `started`: the first of all searches.
  Fit finish(std::chrono::steady_clock::time_point started);

  void tell_finer_mesh(const Session& before);

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
  bool within_whole_windows_ = true;  // a search near a coarser mesh's end, at least
  bool out_of_time_ = false;
  FitEnd end_;
  double reduced_ = 0.0;                         // chi-square of the search's end
  std::vector<models::Simulation> predictions_;  // at the end
  std::string skipped_;  // what the predictions leave out, and what that does to the fit
};

/// Where the search ended.
void Session::settle() {
  end_ = linearised_end(problem_);
  Goodness goodness;
  goodness.chi2 = end_.residuals.head(problem_.data_size()).squaredNorm();
  reduced_ = report_goodness(problem_, end_.spread, goodness);
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
  const std::optional<double> estimated = estimated_shift(problem_, end_, predictions_);
  LearnedShift found =
      estimated ? LearnedShift{*estimated, false} : shift_by_learning(problem_, end_);
  if (found.shift <= harmless_shift) {
    skipped_ = fmt::format(
        "in the fit: with the full equations no parameter of the impact would move by more than "
        "{:.2g} standard errors",
        found.shift);
    return;
  }
  constexpr int most_rounds = 3;
  // what is left out changes by so little that the parameters it moves need not be looked at again
  constexpr double surely_harmless = 20.0 * harmless_shift;
  const bool hits_once = std::ranges::all_of(
      predictions_,
      [](const models::Simulation& prediction) { return prediction.episodes.size() <= 1; });
  for (int round = 0; round < most_rounds && found.learned; ++round) {
    const bool is_last = hits_once && found.shift <= surely_harmless;
    search_.finish();
    settle();
    if (is_last) return;
    found = shift_by_learning(problem_, end_);
    if (found.shift <= harmless_shift) return;
  }
  forget_full_motion(problem_);
  prefer_full_motion(problem_);
  search_.finish();
  settle();
}

/// At the present values, with history, one a recording.
void Session::predict() {
  predictions_.clear();
  for (const Shot& shot : problem_.shots()) {
    const double interval = std::min(1e-6, shot.channels.front().signal->interval);
    predictions_.push_back(shot.model->as_learned().simulate(shot.cost->rig(), interval));
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

void Session::search(double seconds_left) {
  problem_.limit_time(seconds_left);
  choose_motion(problem_);
  search_.run();
  settle();
}

void Session::search_near(const Session& coarser, double seconds_left) {
  problem_.limit_time(seconds_left);
  choose_motion(problem_);
  problem_.set_values(coarser.problem_.values());
  std::vector<double> windows;
  for (std::size_t i = 0; i < problem_.shots().size(); ++i) {
    windows.push_back(problem_.shots()[i].window);
    problem_.shots()[i].window = coarser.problem_.shots()[i].window;
    within_whole_windows_ &= problem_.shots()[i].window == windows.back();
  }
  search_.search_near();
  settle();
  for (std::size_t i = 0; i < windows.size(); ++i) problem_.shots()[i].window = windows[i];
}

std::optional<RigFile> Session::on_finer_mesh() {
  constexpr double worth_it = 0.1;  // of what is too large, the mesh's part
  if (!problem_.rig().mesh_chosen || problem_.loss() != Loss::squares || !(reduced_ > misfit) ||
      problem_.out_of_time())
    return std::nullopt;
  RigFile finer = problem_.rig();
  finer.solver = models::refined(finer.solver);
  if (finer.solver.elements[0] + finer.solver.elements[1] > finest_mesh) return std::nullopt;
  if (!(part_left_by_mesh(problem_, end_) > worth_it)) return std::nullopt;
  return finer;
}

bool Session::fits_all() const {
  return reduced_ <= misfit && within_whole_windows_;
}

bool Session::fits_better_than(const Session& coarser) const {
  constexpr double clearly = 0.9;
  if (problem_.out_of_time()) return false;
  if (coarser.search_.early_end() && !search_.early_end() && reduced_ <= misfit) return true;
  return reduced_ < clearly * coarser.reduced_;
}

void Session::tell_finer_mesh(const Session& before) {
  const auto& [first, last] = problem_.rig().solver.elements;
  const auto& [first_before, last_before] = before.problem_.rig().solver.elements;
  warnings_.push_back(fmt::format(
      "The data ask for a finer mesh than solver.accuracy does: ANCF with [{}, {}] elements was "
      "taken, reduced chi-square {}; with [{}, {}] it is {}.",
      first, last, datasets::figures(reduced_, 3), first_before, last_before,
      datasets::figures(before.reduced_, 3)));
}

Fit Session::finish(std::chrono::steady_clock::time_point started) {
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

/// On the last of the finer meshes that each fit better than the one before, searched as thoroughly
/// as the first where it does not fit all the data as it is; none: nullptr.
std::unique_ptr<Session> on_finer_meshes(const std::vector<Impact>& impacts,
                                         const FitOptions& options, Session& first,
                                         const std::function<double()>& seconds_left) {
  std::unique_ptr<Session> finest;
  Session* last = &first;
  try {
    while (const std::optional<RigFile> finer = last->on_finer_mesh()) {
      auto next = std::make_unique<Session>(impacts, *finer, options);
      next->search_near(*last, seconds_left());
      if (!next->fits_better_than(*last)) break;
      finest = std::move(next);
      last = finest.get();
    }
    if (finest && !finest->fits_all()) finest->search(seconds_left());
  } catch (const std::exception&) {
    return nullptr;  // a mesh that cannot be solved in time is no better
  }
  if (!finest || !finest->fits_better_than(first)) return nullptr;
  finest->tell_finer_mesh(first);
  return finest;
}

}  // namespace

Fit fit(const std::vector<datasets::Impact>& impacts, const RigFile& rig,
        const FitOptions& options) {
  if (!rig.rig.has_stop())
    throw std::invalid_argument("the rig has no [contact]: there is no impact to fit");
  const auto started = std::chrono::steady_clock::now();
  const auto left = [&] { return options.time_limit - seconds_since(started); };
  auto session = std::make_unique<Session>(impacts, rig, options);
  session->search(left());
  if (auto finer = on_finer_meshes(impacts, options, *session, left)) session = std::move(finer);
  return session->finish(started);
}

Fit fit(const std::vector<datasets::Impact>& impacts, const RigFile& rig) {
  return fit(impacts, rig, rig.fit);
}

}  // namespace impactrig::fitting
