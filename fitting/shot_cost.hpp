// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "fitting/fitted_channel.hpp"
#include "fitting/loss.hpp"
#include "fitting/samples_at_jumps.hpp"
#include "fitting/shot_model.hpp"
#include "fitting/shot_numbers.hpp"
#include "fitting/shot_predictions.hpp"
#include "fitting/variables.hpp"

namespace impactrig::fitting {

/// Weighted differences of one recording: measured − background − gain · shown(t − touch − delay),
/// whitened by the channel's noise stretch by stretch of samples in a row. Derivatives to touch,
/// background, gain and delay are exact; those to the physics are as good as the predictions'
/// slopes. Parameter blocks: the unknowns that concern this recording, each
/// of size 1, by its coordinate; a number tied to an unknown moves with it.
class ShotCost : public ceres::CostFunction {
 public:
  /// `numbers`: of the variables that concern this recording. Model, channels and variables must
  /// live as long.
  ShotCost(const RigFile& rig, const ShotModel& model, const std::vector<FittedChannel>& channels,
           const std::vector<Variable>& variables, const std::vector<std::size_t>& numbers,
           Loss loss);

  /// The residuals that the solver squares: with a loss other than squares, loss_residual() of the
  /// weighted differences.
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

  /// Weighted differences and their derivatives by the unknowns in their own units (n_residuals,
  /// n_blocks), at the variables' present values. Throws what the simulation throws.
  void linearise(Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const;

  /// Numbers of the unknowns that are the parameter blocks, in order.
  const std::vector<std::size_t>& blocks() const { return numbers_.blocks(); }

  /// Slopes of the full equations are those of small motion from now on.
  void take_small_slopes() { predictions_.take_small_slopes(); }

  /// Whether Evaluate predicts the slopes with the residuals, before they are asked for: it is
  /// cheaper than to come back for them.
  void look_ahead(bool ahead) { slopes_ahead_ = ahead; }

  /// What went wrong when Evaluate last gave up.
  const std::string& failure() const { return failure_; }

  void forget_failure() { failure_.clear(); }

  long simulations() const { return predictions_.simulations(); }

  /// Model values of a channel at all its samples, at the variables' present values.
  std::vector<double> model_values(const FittedChannel& channel) const;

  /// Derivatives of restitution.{kinematic, kinetic, energetic} to each block (3, n_blocks).
  Eigen::MatrixXd restitution_gradient() const;

  /// What changes when another model predicts instead of one.
  struct Change {
    Eigen::VectorXd differences;      ///< weighted (n_residuals)
    models::Restitution restitution;  ///< all but that of the law
  };

  Change change(const ShotModel& one, const ShotModel& other) const;

  /// Length of what the model shows, weighted as the differences are.
  double signal_size() const;

  /// The rig at the variables' present values.
  models::Rig rig() const;

  /// Likewise the sensors.
  SensorChains chains() const;

 private:
  using Values = ShotNumbers::Values;
  using Slot = ShotNumbers::Slot;

  void find_backgrounds();
  bool is_background_of(const Slot& slot, const FittedChannel& channel) const;
  SamplesAtJumps samples_of(const FittedChannel& channel, const Measurement& measurement,
                            const Shown& shown) const;
  void differences(const Values& values, const Shown& shown, double* residuals) const;
  void derivative(std::size_t slot, const SamplesAtJumps& samples, double gain,
                  const Shown::Curve& curve, const Shown* slope, std::span<double> out) const;
  void evaluate(const Values& values, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const;
  Eigen::MatrixXd jacobian_at(const Values& values, const Shown& shown) const;

  const ShotModel& model_;
  const std::vector<FittedChannel>& channels_;
  ShotNumbers numbers_;
  ShotPredictions predictions_;
  std::vector<std::vector<double>> backgrounds_;  // of each slot, at its channel's used samples
  Loss loss_;
  int residuals_ = 0;
  bool slopes_ahead_ = false;
  mutable std::string failure_;
};

}  // namespace impactrig::fitting
