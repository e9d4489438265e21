// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fitting/bound_interval.hpp"
#include "fitting/covariance.hpp"
#include "fitting/filtered_samples.hpp"
#include "fitting/fit_problem.hpp"
#include "fitting/fit_report.hpp"
#include "fitting/identifiability.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;

// The first pass looks no further than this many contact durations: what follows the first
// separation depends so strongly on the parameters that a fit from afar would run into a false
// minimum.
constexpr double first_window = 1.2;
// What may follow before the whole window is looked at, where that alone does not fit.
constexpr double growing_windows[] = {1.2, 1.7, 2.5, 4.0, 8.0};
constexpr double whole = std::numeric_limits<double>::infinity();
// A first pass that ends with more than this reduced chi-square is started again from other places.
constexpr double poor_fit = 4.0;
// Small motion predicts the fit where it leaves out less than this part of the energy, and to the
// end where the full equations would move no parameter by more than this part of its standard
// error. Up to the third figure its slopes serve the full equations.
constexpr double smallest_motion = 1e-3;
constexpr double harmless_shift = 0.1;
constexpr double near_harmless = 0.3;
constexpr double like_small_motion = 0.1;
// What moves the residuals by less, taken together and in standard deviations, from one bound of a
// parameter to the other is what simulations round differently: its standard error would be a
// thousand times as wide as its bounds.
constexpr double least_influence = 1e-3;

double seconds_since(std::chrono::steady_clock::time_point started) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

class Session {
 public:
  Session(const std::vector<Impact>& impacts, const RigFile& rig, const FitOptions& options)
      : impacts_(impacts),
        options_(options),
        problem_(impacts, rig, options) {}

  Fit run();

 private:
  void choose_motion();
  double pass(const Search& how, double contacts);
  void search();
  void search_first_window();
  void search_from_elsewhere(double reduced);
  double search_finely(const std::vector<double>& tried);
  double grow_window();
  bool same_place(const std::vector<double>& a, const std::vector<double>& b) const;
  template <typename Attempt>
  double try_again(double reduced, const Attempt& attempt);
  bool is_idle(std::size_t number, double slope);
  double spread();
  template <typename Change>
  Eigen::VectorXd shift_by(const Change& change) const;
  double largest(const Eigen::VectorXd& shift) const;
  void predict();
  bool look_beyond_window();
  double most_shift_by_neglect() const;
  double shift_by_full_motion() const;
  void prefer_full_motion();
  void estimate_mesh_shift();
  void keep_within_bounds(Eigen::VectorXd& shift) const;
  Fit report(double chi2);
  bool bound_tells(std::size_t unknown) const;
  void profile(Fit& fit);
  void widen_view(Fit& fit);

  const std::vector<Impact>& impacts_;
  const FitOptions& options_;
  FitProblem problem_;
  std::vector<std::string> warnings_;
  SearchEnd last_;
  int iterations_ = 0;
  bool several_ends_ = false;     // of searches in the first window from different starts
  double first_reached_ = whole;  // there, by predictions that are not rough
  bool out_of_time_ = false;
  Eigen::VectorXd residuals_;
  Eigen::MatrixXd jacobian_;  // at the end, of data and priors
  FitEnd end_;
  std::vector<models::Simulation> predictions_;  // at the end
  std::string skipped_;  // what the predictions leave out, and what that does to the fit
};

/// Small motion is faster by an order and leaves out what a noisy recording seldom shows. One
/// choice for the whole fit: a change between two predictions would be taken for an effect of the
/// parameters.
void Session::choose_motion() {
  double neglected = 0.0;
  const bool full_only = std::ranges::any_of(problem_.variables(), [](const Variable& v) {
    return v.physics && v.physics->of_full_motion_only;
  });
  try {
    problem_.set_motion(models::Motion::small);
    for (const Shot& shot : problem_.shots())
      neglected = std::max(neglected, shot.model->simulate(problem_.rig().rig, 0.0).neglected);
    if (neglected <= smallest_motion && !full_only) return;
  } catch (const std::exception&) {
    neglected = whole;  // the full equations have the last word on what is wrong with the rig
  }
  problem_.set_motion(models::Motion::full);
  if (neglected <= like_small_motion && !full_only) prefer_full_motion();
}

/// The full equations, with the slopes of small motion where it has them.
void Session::prefer_full_motion() {
  problem_.set_motion(models::Motion::full);
  try {
    const std::vector<models::RigParameter> any = {
        [](models::Rig& rig) -> double& { return rig.start.velocity; }};
    for (const Shot& shot : problem_.shots())
      if (shot.model->in_small_motion()
              .simulate(problem_.rig().rig, 0.0, any)
              .sensitivities.empty())
        return;
    problem_.take_small_slopes();
  } catch (const std::exception&) {
    return;  // this rig's are differences of simulations
  }
}

/// Searches from the present values within a window; returns the reduced chi-square reached.
double Session::pass(const Search& how, double contacts) {
  problem_.choose_samples(contacts, how.rough, how.one_by_one);
  if (problem_.out_of_time()) {
    last_.converged = false;
    return whole;
  }
  last_ = problem_.search(how);
  iterations_ += last_.iterations;
  const double free = static_cast<double>(problem_.unknowns().size());
  return 2.0 * last_.cost / std::max(1.0, static_cast<double>(problem_.data_size()) - free);
}

/// Cauchy and Tukey take a peak that is far off for outliers: they search from near only.
void Session::search() {
  problem_.set_loss(loss_from_afar(options_.loss));
  search_first_window();
  const std::vector<double> tried = problem_.values();
  double reached = pass(last_search, whole);
  if (reached > misfit) reached = try_again(reached, [&] { return search_finely(tried); });
  // where not even the first contact fits, looking on from contact to contact mends nothing
  if (reached > misfit && first_reached_ <= poor_fit)
    try_again(reached, [&] { return grow_window(); });
  if (problem_.loss() == options_.loss) return;
  problem_.set_loss(options_.loss);
  pass(last_search, whole);
}

/// By rough predictions; from other places too where that ends badly.
void Session::search_first_window() {
  const double reached = pass(first_search, first_window);
  const bool several_starts = std::ranges::any_of(problem_.variables(), [](const Variable& v) {
    return v.name == "contact.restitution" || v.name == "contact.stiffness_factor";
  });
  if (reached > poor_fit && several_starts) search_from_elsewhere(reached);
}

/// Rough predictions may have led astray, a sensor's resonance most easily: with fine ones from the
/// start again, and from where rough searches ended best where they ended at several places.
double Session::search_finely(const std::vector<double>& tried) {
  Search fine = first_search;
  fine.rough = false;
  problem_.set_initial_values();
  first_reached_ = pass(fine, first_window);
  if (several_ends_)
    first_reached_ = try_again(first_reached_, [&] {
      problem_.set_values(tried);
      return pass(fine, first_window);
    });
  return same_place(problem_.values(), tried) ? whole : pass(last_search, whole);
}

/// A false minimum may be the end of another way from the start: keeps what fits better.
template <typename Attempt>
double Session::try_again(double reduced, const Attempt& attempt) {
  const std::vector<double> best = problem_.values();
  const SearchEnd end = last_;
  const double reached = attempt();
  if (reached < reduced) return reached;
  problem_.set_values(best);
  problem_.choose_samples(whole, false);
  last_ = end;
  return reduced;
}

/// Tries other restitutions and stiffnesses, and sensors other than stated where that is asked for,
/// and keeps the best end; two starts, far apart, where these lead to the same place.
void Session::search_from_elsewhere(double reduced) {
  struct Start {
    double restitution, stiffness, sensor;
  };

  constexpr Start starts[] = {
      {0.25, 0.4, 0.8}, {0.8, 2.5, 1.25}, {0.25, 2.5, 1.25}, {0.8, 0.4, 0.8}};
  std::vector<double> best = problem_.values();
  int tried = 0;
  for (const auto& [restitution, stiffness, sensor] : starts) {
    if (reduced <= misfit || (tried++ == 2 && !several_ends_)) break;
    problem_.set_initial_values();
    std::vector<double> start = problem_.values();
    for (std::size_t i = 0; i < start.size(); ++i) {
      const Variable& v = problem_.variables()[i];
      if (v.name == "contact.restitution") start[i] = restitution;
      if (v.name == "contact.stiffness_factor") start[i] = stiffness * v.initial;
      if (v.chain) start[i] = sensor * v.initial;
    }
    problem_.set_values(start);
    const double reached = pass(first_search, first_window);
    several_ends_ = several_ends_ || !same_place(problem_.values(), best);
    if (reached >= reduced) continue;
    reduced = reached;
    best = problem_.values();
  }
  problem_.set_values(best);
}

/// Of the impact's own parameters and the sensors'.
bool Session::same_place(const std::vector<double>& a, const std::vector<double>& b) const {
  constexpr double near = 0.02;
  for (const std::size_t i : problem_.unknowns()) {
    const Variable& v = problem_.variables()[i];
    if (!v.physics && !v.chain) continue;
    if (std::abs(a[i] - b[i]) > near * std::max(std::abs(a[i]), std::abs(b[i]))) return false;
  }
  return true;
}

/// The whole window at once may lead into a false minimum, where the model meets the stop a second
/// time too early or too late. Looks on from contact to contact.
double Session::grow_window() {
  problem_.set_initial_values();
  for (const double contacts : growing_windows) pass(first_search, contacts);
  return pass(last_search, whole);
}

/// Whether a parameter does nothing to the residuals: by its slope, and, since that may vanish at
/// one place (a restitution of 0 acts by its square), half-way to its farther bound.
bool Session::is_idle(std::size_t number, double slope) {
  const Variable& v = problem_.variables()[number];
  if (!(slope * (v.upper - v.lower) < least_influence)) return false;
  const std::vector<double> here = problem_.values();
  std::vector<double> there = here;
  there[number] = 0.5 * (v.value + (v.upper - v.value > v.value - v.lower ? v.upper : v.lower));
  Eigen::VectorXd moved;
  try {
    problem_.set_values(there);
    problem_.linearise(moved, nullptr);
  } catch (const std::exception&) {
    moved.resize(0);  // that is an effect
  }
  problem_.set_values(here);
  return moved.size() == residuals_.size() && (moved - residuals_).norm() < least_influence;
}

/// Linearises where the search ended; returns chi-square of the data.
double Session::spread() {
  problem_.linearise(residuals_, &jacobian_);
  std::vector<std::string> names;
  std::vector<bool> held;
  for (const std::size_t i : problem_.unknowns()) {
    const Variable& v = problem_.variables()[i];
    const auto column = static_cast<Eigen::Index>(names.size());
    if (is_idle(i, jacobian_.col(column).norm())) jacobian_.col(column).setZero();
    names.push_back(v.name);
    held.push_back(v.prior || v.role == Variable::Role::touch);
  }
  end_.spread =
      uncertainty(jacobian_, residuals_, problem_.loss(), problem_.data_size(), names, held);
  return residuals_.head(problem_.data_size()).squaredNorm();
}

/// By how much the unknowns would move, to first order, if the residuals changed by change(shot).
template <typename Change>
Eigen::VectorXd Session::shift_by(const Change& change) const {
  Eigen::VectorXd changes = Eigen::VectorXd::Zero(jacobian_.rows());
  Eigen::Index row = 0;
  for (const Shot& shot : problem_.shots()) {
    const Eigen::VectorXd part = change(shot);
    changes.segment(row, part.size()) = part;
    row += part.size();
  }
  return -end_.spread.covariance * (jacobian_.transpose() * changes);
}

/// The largest of some shifts, of a parameter of the impact, in standard errors.
double Session::largest(const Eigen::VectorXd& shift) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < problem_.unknowns().size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double variance = end_.spread.covariance(row, row);
    if (problem_.variables()[problem_.unknowns()[k]].physics && variance > 0.0)
      largest = std::max(largest, std::abs(shift[row]) / std::sqrt(variance));
  }
  return largest;
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
    warnings_.push_back(
        "The fitted window ends in contact: kinematic, kinetic and energetic restitution are those "
        "of the model beyond it, where nothing was fitted. A longer window would show them.");
  return true;
}

/// An upper limit of the next one from what small motion says of itself: of peak, duration and
/// impulse of the first contact it leaves out a part, which changes all that follows as a change of
/// the speed or of the contact by the same part would; histories between these three may change by
/// more. Residuals that change by a length move no parameter by more standard errors. Infinite
/// where none of these is free.
double Session::most_shift_by_neglect() const {
  constexpr double of_histories = 3.0;  // 1.3 seen
  double neglected = 0.0;
  for (const models::Simulation& prediction : predictions_)
    neglected = std::max(neglected, prediction.neglected);
  double by_part = 0.0;  // length of the residuals' change by a relative change
  for (std::size_t k = 0; k < problem_.unknowns().size(); ++k) {
    const Variable& v = problem_.variables()[problem_.unknowns()[k]];
    if (v.name == "contact.restitution" || v.name == "contact.stiffness_factor" ||
        v.name.starts_with("start.velocity"))
      by_part += jacobian_.col(static_cast<Eigen::Index>(k)).norm() * std::abs(v.value);
  }
  if (by_part == 0.0) return whole;
  for (const Shot& shot : problem_.shots()) by_part += shot.cost->signal_size();
  return of_histories * neglected * by_part;
}

/// Screened on a coarse mesh: what both equations differ by is a matter of the bar's large motion,
/// hardly of its high modes. Where that is anywhere near what matters, the mesh itself decides.
double Session::shift_by_full_motion() const {
  const auto by_full_motion = [&](bool coarse) {
    return largest(shift_by([&](const Shot& shot) {
      const ShotModel small = coarse ? shot.model->coarser() : *shot.model;
      ShotModel full = small;
      full.set_motion(models::Motion::full);
      return shot.cost->change(coarse ? small : *shot.model, full).differences;
    }));
  };
  const double coarse = by_full_motion(true);
  return coarse < near_harmless * harmless_shift ? coarse : by_full_motion(false);
}

/// A mesh twice as fine, compared in small motion: what large rotation adds is the same on both.
void Session::estimate_mesh_shift() {
  if (problem_.rig().solver.model == models::BeamModel::rigid) return;
  const models::Motion motion = problem_.motion();
  try {
    problem_.set_motion(models::Motion::small);
    end_.mesh_shift = shift_by([&](const Shot& shot) {
      ShotCost::Change change = shot.cost->change(*shot.model, shot.model->finer());
      if (&shot == &problem_.shots().front()) end_.mesh_change = change.restitution;
      return std::move(change.differences);
    });
    keep_within_bounds(end_.mesh_shift);
  } catch (const std::exception& error) {
    warnings_.push_back(fmt::format(
        "The mesh error could not be estimated, so that no interval has it: {}", error.what()));
  }
  problem_.set_motion(motion);
}

/// Where an unknown cannot go as far, the others move as they do with it held there.
void Session::keep_within_bounds(Eigen::VectorXd& shift) const {
  Eigen::MatrixXd covariance = end_.spread.covariance;
  for (std::size_t k = 0; k < problem_.unknowns().size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Variable& v = problem_.variables()[problem_.unknowns()[k]];
    const double way = std::clamp(v.value + shift[row], v.lower, v.upper) - v.value - shift[row];
    if (way == 0.0 || !end_.spread.identifiable[k] || !(covariance(row, row) > 0.0)) continue;
    const Eigen::VectorXd along = covariance.col(row) / covariance(row, row);
    shift += along * way;
    covariance -= along * covariance.row(row);  // from here on of the others, this one held
  }
}

Fit Session::report(double chi2) {
  Fit fit;
  fit.goodness.chi2 = chi2;
  const double reduced = report_goodness(problem_, end_.spread, fit.goodness);
  const bool rescale =
      !problem_.noise_known() || (reduced > misfit && problem_.loss() == Loss::squares);
  end_.inflation = rescale ? std::sqrt(reduced) : 1.0;
  report_parameters(problem_, end_, fit);
  report_channels(problem_, fit);
  fit.rig = fitted_rig(problem_);
  fit.predictions = std::move(predictions_);
  for (std::size_t i = 0; i < fit.predictions.size(); ++i) {
    std::vector<std::string>& skipped = fit.predictions[i].skipped;
    if (!skipped_.empty()) skipped.push_back(skipped_);
    for (const FittedChannel& channel : problem_.shots()[i].channels)
      if (channel.every > 1) skipped.push_back(thinning_sentence(*channel.signal));
  }
  report_restitution(problem_, end_, fit);
  fit.identifiability = identifiability(problem_, jacobian_, end_.inflation,
                                        fit.predictions.front().episodes.empty()
                                            ? 0.0
                                            : fit.predictions.front().episodes.front().peak_force);
  if (!fit.identifiability.remedy.empty())
    fit.not_identifiable.push_back(fit.identifiability.remedy);
  fit.impacts = impacts_;
  if (last_.converged)
    fit.termination = "converged";
  else if (out_of_time_)
    fit.termination = fmt::format("stopped after {:g} s, fit.time_limit, without converging",
                                  options_.time_limit);
  else
    fit.termination =
        fmt::format("stopped after {} iterations without converging", last_.iterations);
  fit.iterations = iterations_;
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

/// Along what the data do not determine, draws stay where their search began: that is no spread.
void forget_unknown(Fit& fit) {
  constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
  for (const Parameter& of_fit : fit.parameters)
    for (Bootstrap::Parameter& p : fit.bootstrap->parameters) {
      if (p.name != of_fit.name || of_fit.identifiable) continue;
      p.bias = p.std_error = not_known;
      p.ci95 = {not_known, not_known};
    }
}

/// Whether a likelihood may tell an interval of what is at a bound: not where the model does not
/// explain the data at all, nor where they want more than two standard errors beyond. A standard
/// error wider than the bounds knows neither.
bool Session::bound_tells(std::size_t unknown) const {
  constexpr double hopeless = 10.0;  // times what the noise leaves
  if (out_of_time_ || end_.inflation > hopeless) return false;
  const auto k = static_cast<Eigen::Index>(unknown);
  const Variable& v = problem_.variables()[problem_.unknowns()[unknown]];
  const double error = std::sqrt(end_.spread.covariance(k, k));
  if (!(end_.inflation * error < v.upper - v.lower)) return true;
  return std::abs(jacobian_.col(k).dot(residuals_)) * error <= 2.0 * end_.inflation;
}

/// Profile likelihoods of what is at a bound, of all else where the options ask for them.
void Session::profile(Fit& fit) {
  if (problem_.loss() != Loss::squares) {
    if (options_.profile)
      fit.warnings.push_back(fmt::format(
          "No profile likelihood was made: a likelihood goes with the loss squares, not with {}.",
          name(problem_.loss())));
    return;
  }
  std::vector<std::size_t> numbers;
  std::vector<double> std_errors;
  for (std::size_t k = 0; k < problem_.unknowns().size(); ++k) {
    const std::size_t i = problem_.unknowns()[k];
    const Parameter& p = fit.parameters[i];
    const bool wanted = options_.profile || (p.at_bound && bound_tells(k));
    if (!problem_.variables()[i].of_interest() || !wanted) continue;
    numbers.push_back(i);
    std_errors.push_back(p.at_bound ? 0.0 : p.std_error);
  }
  fit.profiles = profiles(problem_, numbers, std_errors, end_.inflation);
  for (const Profile& profile : fit.profiles)
    if (profile.found_better)
      fit.warnings.push_back(
          fmt::format("The profile of {} found values that fit better: the fit ended in a false "
                      "minimum. Start from another {} or fix a parameter.",
                      profile.name, profile.name));
}

/// Intervals of other kinds: at bounds, and where the options ask for them.
void Session::widen_view(Fit& fit) {
  profile(fit);
  settle_bounds(fit);
  if (options_.bootstrap > 0) {
    fit.bootstrap = bootstrap(
        problem_, jacobian_, end_.inflation,
        {.kind = options_.bootstrap_kind, .draws = options_.bootstrap, .seed = options_.seed});
    forget_unknown(fit);
    if (fit.bootstrap->draws < Bootstrap::fewest_for_interval)
      fit.warnings.push_back(
          fmt::format("{} draws of the bootstrap tell standard errors, no 95 % interval: that "
                      "takes {}, and some "
                      "hundreds for one that is not a matter of chance.",
                      fit.bootstrap->draws, Bootstrap::fewest_for_interval));
    if (!fit.bootstrap->at_bounds.empty())
      fit.warnings.push_back(fmt::format(
          "Fits of the bootstrap end with {} at a bound: its intervals are quantiles of the draws "
          "and not mirrored about the best fit.",
          fmt::join(fit.bootstrap->at_bounds, ", ")));
    if (fit.bootstrap->failed > 0)
      fit.warnings.push_back(fmt::format("{} of {} fits of the bootstrap did not converge.",
                                         fit.bootstrap->failed, fit.bootstrap->draws));
  }
}

Fit Session::run() {
  const auto started = std::chrono::steady_clock::now();
  problem_.limit_time(options_.time_limit);
  choose_motion();
  search();
  double chi2 = spread();
  predict();
  if (problem_.motion() == models::Motion::small) {
    double shift = most_shift_by_neglect();
    if (shift > harmless_shift) shift = shift_by_full_motion();
    if (shift <= harmless_shift) {
      skipped_ = fmt::format(
          "in the fit: with the full equations no parameter of the impact would move by more than "
          "{:.2g} standard errors",
          shift);
    } else {
      prefer_full_motion();
      pass(last_search, whole);
      chi2 = spread();
      predict();
    }
  }
  out_of_time_ = problem_.out_of_time();
  problem_.limit_time(whole);
  const bool beyond = look_beyond_window();
  estimate_mesh_shift();
  Fit fit = report(chi2);
  if (beyond) problem_.choose_samples(whole, false);
  fit.seconds = seconds_since(started) - fit.judging_seconds;
  widen_view(fit);
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
