// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fitting/loss.hpp"
#include "fitting/noise_model.hpp"
#include "fitting/shot_model.hpp"
#include "fitting/variables.hpp"

namespace impactrig::fitting {

/// A channel of a recording as the fit weighs it.
struct FittedChannel {
  const datasets::ImpactSignal* signal = nullptr;
  std::vector<double> measured;  ///< what is fitted: the signal's values, or others in their place
  NoiseModel noise;
  bool noise_known = true;  ///< it was seen before the trigger
  bool one_by_one = false;  ///< samples are weighed as if the noise were white
  /// 1 where a sample, and all that a filter made it of, was recorded (n_samples).
  std::vector<std::uint8_t> sound;
  /// One sample in so many is fitted: a filter of the record ties those between to them.
  std::size_t every = 1;
  std::vector<std::size_t> used;  ///< indices of the samples fitted, ascending
};

/// Weighted differences of one recording: measured − background − gain · shown(t − touch − delay),
/// whitened by the channel's noise stretch by stretch of samples in a row. Derivatives to touch,
/// background, gain and delay are exact; so are those to the physics in small motion. The full
/// equations take those of small motion where that is close (`small_slopes`), else differences of
/// simulations, run on all cores. Parameter blocks: the unknowns that concern this recording, each
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
  const std::vector<std::size_t>& blocks() const { return blocks_; }

  /// Slopes of the full equations are those of small motion from now on.
  void take_small_slopes() { small_slopes_ = true; }

  /// Whether Evaluate predicts the slopes with the residuals, before they are asked for: it is
  /// cheaper than to come back for them.
  void look_ahead(bool ahead) { slopes_ahead_ = ahead; }

  /// What went wrong when Evaluate last gave up.
  const std::string& failure() const { return failure_; }

  void forget_failure() { failure_.clear(); }

  long simulations() const { return simulations_; }

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

 private:
  using Prediction = std::shared_ptr<const Shown>;
  using Values = std::vector<double>;  // of slots_

  /// A number of this recording: that of a block times a factor, and an offset.
  struct Slot {
    const Variable* variable;
    std::size_t block;
    double factor, offset;
    std::vector<double> background;  // its shape at the used samples of its channel
  };

  struct Measurement {  // of one channel
    double gain = 1.0;
    double shift = 0.0;  // first touch as this channel shows it, on the record's axis [s]
  };

  /// At a channel's samples, where curves jump.
  struct Look {
    const FittedChannel& channel;
    double shift = 0.0;  // as of Measurement

    struct Elsewhere {
      std::size_t sample, piece;
    };

    std::vector<Elsewhere> elsewhere = {};  // samples that show another piece than their time says

    std::array<double, 2> at(const Shown::Curve& curve, std::size_t sample) const;
  };

  Values values_of(const double* const* parameters) const;
  Values present_values() const;
  const Slot* beyond_bounds(const Values& values) const;
  models::Rig rig_at(const Values& values) const;
  SensorChains chains_at(const Values& values) const;
  WantedSlopes wanted_slopes() const;
  Measurement measurement(datasets::Quantity quantity, const Values& values) const;
  Prediction predict(const Values& values, bool with_slopes) const;
  std::vector<Prediction> predict_all(const std::vector<Values>& places) const;
  std::vector<Shown> physics_differences(const Values& values) const;
  std::vector<const Shown*> slopes_at(const Values& values, const Shown& shown,
                                      std::vector<Shown>& held) const;
  void differences(const Values& values, const Shown& shown, double* residuals) const;
  Look look(const FittedChannel& channel, const Measurement& m, const Shown::Curve& curve) const;
  void derivative(const Slot& slot, const Look& look, double gain, const Shown::Curve& curve,
                  const Shown* slope, std::span<double> out) const;
  void whiten(const FittedChannel& channel, std::span<double> of_used) const;
  void evaluate(const Values& values, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const;

  const RigFile& rig_;
  const ShotModel& model_;
  const std::vector<FittedChannel>& channels_;
  const std::vector<Variable>& variables_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> blocks_;
  Loss loss_;
  int residuals_ = 0;
  bool small_slopes_ = false, slopes_ahead_ = false;
  mutable std::optional<models::Motion> without_slopes_;
  mutable std::map<Values, Prediction> cache_;
  mutable std::string failure_;
  mutable long simulations_ = 0;
};

}  // namespace impactrig::fitting
