// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/impact.hpp"
#include "fitting/fit_options.hpp"
#include "fitting/rig_file.hpp"
#include "fitting/shot.hpp"
#include "fitting/solver_options.hpp"
#include "fitting/variables.hpp"

namespace impactrig::fitting {

struct SearchEnd {
  bool started = false;
  bool strayed = false;  ///< tried beyond bounds, and may have ended for that
  double cost = 0.0;     ///< ½ Σρ of data and priors
  bool converged = false;
  int iterations = 0;
  std::string message;
};

/// What a fit minimises: the variables, the recordings' weighted differences from what the model
/// and the sensors' chains make of them, priors and bounds. Variables carry the present values;
/// searches move them.
class FitProblem {
 public:
  /// The impacts must live as long. Throws std::invalid_argument where there is nothing to fit.
  FitProblem(const std::vector<datasets::Impact>& impacts, const RigFile& rig,
             const FitOptions& options);

  /// Another problem of the same models, with values of its own: to search in at the same time.
  FitProblem copy() const;

  const RigFile& rig() const { return *rig_; }

  const std::vector<Variable>& variables() const { return *variables_; }

  double value(std::size_t number) const { return (*variables_)[number].value; }

  std::vector<double> values() const;  ///< of all variables
  /// Predicts, until samples are chosen again, as long as the rig file says, or for twice the
  /// contact as it was found, however short the window is.
  void see_separation();

  /// Sets the unknowns and, with them, what is tied to them.
  void set_values(const std::vector<double>& values);
  void set_initial_values();

  /// Replaces the mean of a variable's prior.
  void set_prior_mean(std::size_t number, double mean);

  /// Numbers of the variables that are unknowns: not tied, and with something to tell them.
  const std::vector<std::size_t>& unknowns() const { return unknowns_; }

  std::vector<Shot>& shots() { return shots_; }

  const std::vector<Shot>& shots() const { return shots_; }

  /// Takes the sound samples from each record's beginning to a share of its window, in contact
  /// durations, or all; what is predicted of them from now on may be rough, and they may be weighed
  /// one by one.
  void choose_samples(double contacts, bool rough = false, bool one_by_one = false);

  /// After a change of a channel's `used` or `noise`.
  void rebuild_costs();

  void set_motion(models::Motion motion);
  models::Motion motion() const;

  /// These predict from now on, one a shot, of the same meshes and motion.
  void set_models(const std::vector<ShotModel>& models);

  /// Slopes of the full equations are those of small motion from now on.
  void take_small_slopes();

  /// No search goes on, and none begins, beyond this from now on [s]; infinite: no limit.
  void limit_time(double seconds);

  bool out_of_time() const { return time_left() <= 0.0; }

  /// Levenberg-Marquardt from the present values; `held` variables stay. Where bounds are in the
  /// way, the unknowns that press against theirs are held there, and released when that no longer
  /// pays. Throws std::runtime_error where it cannot start.
  SearchEnd search(const Search& how, const std::vector<std::size_t>& held = {});

  /// The cost that a search from the present values would end with if all were linear and nothing
  /// bounded, by one linearisation; `held` variables stay.
  double linear_end(const std::vector<std::size_t>& held = {}) const;

  /// Weighted differences of the data and of the priors, and their derivatives by the unknowns in
  /// their own units (n_data + n_priors, n_unknowns), at the present values.
  void linearise(Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const;

  Eigen::Index data_size() const;  ///< residuals that are data

  /// Of the unknowns, one a residual: priors, in the order of linearise().
  const std::vector<std::size_t>& priors() const { return priors_; }

  Loss loss() const { return loss_; }

  void set_loss(Loss loss);

  long simulations() const;

  /// Those of a copy count as well.
  void add_simulations(long count) { past_simulations_ += count; }

  const std::vector<std::string>& warnings() const { return warnings_; }

  /// The most of the speed at touch that may be vibration of a bar that was let go, a part of it:
  /// the fit has that speed and no vibration.
  double release_vibration() const { return release_vibration_; }

  bool noise_known() const { return noise_known_; }

 private:
  FitProblem() = default;
  void add_shot(const datasets::Impact& impact, int number, const FitOptions& options);
  void add_channels(const FitOptions& options, Shot& shot);
  void warn_of_constant(const datasets::Impact& impact, const datasets::ImpactSignal& signal);
  void warn_of_short_pre_trigger(const datasets::Impact& impact,
                                 const datasets::ImpactSignal& signal);
  void warn_of_unseen_noise(const datasets::Impact& impact, const datasets::ImpactSignal& signal);
  void warn_of_unused(const FitOptions& options);
  void follow_ties();
  double time_left() const;
  using Priors = std::vector<std::unique_ptr<ceres::CostFunction>>;
  Priors state(const std::vector<std::size_t>& held, std::vector<double>& x,
               ceres::Problem& problem) const;
  SearchEnd search_once(const Search& how, const std::vector<std::size_t>& held);

  std::shared_ptr<const RigFile> rig_;
  std::unique_ptr<std::vector<Variable>> variables_;
  std::vector<std::size_t> unknowns_, priors_;
  std::vector<Shot> shots_;
  Loss loss_ = Loss::squares;
  bool noise_known_ = true, small_slopes_ = false;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
  std::vector<std::string> warnings_;
  double release_vibration_ = 0.0;
  long past_simulations_ = 0;  // of costs that are gone
};

}  // namespace impactrig::fitting
