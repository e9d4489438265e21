// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fitting/shot_model.hpp"
#include "fitting/variables.hpp"

namespace impactrig::fitting {

/// A channel of a recording as the fit weighs it.
struct FittedChannel {
  const datasets::ImpactSignal* signal = nullptr;
  double sigma = 0.0;             ///< standard deviation of a sample [SI]
  double correlation = 1.0;       ///< samples that count as one
  bool noise_known = true;        ///< sigma was seen before the trigger
  std::vector<std::size_t> used;  ///< indices of the samples fitted
};

/// Weighted differences of one recording: (measured − background − gain · shown(t − touch − delay))
/// / (σ √correlation). Derivatives to touch, background, gain and delay are exact; so are those to
/// the physics in small motion. With full equations they are differences of simulations, run on all
/// cores. Parameter blocks: the
/// variables that concern this recording, each of size 1, divided by its scale.
class ShotCost : public ceres::CostFunction {
 public:
  ShotCost(const RigFile& rig, const ShotModel& model, std::vector<FittedChannel> channels,
           std::vector<const Variable*> variables);

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

  /// Where derivatives to the physics are differences: central from now on, for the covariance;
  /// before, a step ahead is enough for the solver and half the simulations.
  void use_central_differences() { central_ = true; }

  /// What went wrong when Evaluate last gave up.
  const std::string& failure() const { return failure_; }

  long simulations() const { return simulations_; }

  /// Model values of a channel at all its samples, for these values of the variables (not divided
  /// by their scale).
  std::vector<double> model_values(const FittedChannel& channel,
                                   const std::vector<double>& values) const;

  /// Derivatives of restitution.{kinematic, kinetic, energetic} to each variable (3, n_variables).
  Eigen::MatrixXd restitution_gradient(const std::vector<double>& values) const;

  /// By how much the weighted differences change when another model predicts (n_residuals).
  Eigen::VectorXd change_by(const ShotModel& other, const std::vector<double>& values) const;

  models::Rig rig_at(const std::vector<double>& values) const;

 private:
  using Prediction = std::shared_ptr<const Shown>;

  struct Measurement {  // of one channel

    struct Term {
      BackgroundShape shape;
      double amplitude;
    };

    std::vector<Term> background;
    double gain = 1.0;
    double origin = 0.0;  // of the background's time: the impact as found [s]
    double shift = 0.0;   // first touch as this channel shows it, on the record's axis [s]

    /// What the model shows at an instant of the record's axis.
    double value(const Shown::Curve& curve, double t) const;
  };

  Measurement measurement(datasets::Quantity quantity, const std::vector<double>& values) const;
  std::vector<Prediction> predict(const std::vector<models::Rig>& rigs) const;
  Prediction predict_cached(const std::vector<double>& values, bool with_slopes = false) const;
  void physics_pairs(const std::vector<double>& values, bool central,
                     std::vector<Prediction>& predictions, std::vector<double>& spans) const;
  void fill_jacobian(const std::vector<double>& values, const Shown& shown,
                     double** jacobians) const;

  const RigFile& rig_;
  const ShotModel& model_;
  std::vector<FittedChannel> channels_;
  std::vector<const Variable*> variables_;
  int residuals_ = 0;
  bool central_ = false;
  mutable std::map<std::vector<double>, Prediction> cache_;
  mutable std::string failure_;
  mutable long simulations_ = 0;
};

}  // namespace impactrig::fitting
