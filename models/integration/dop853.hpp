// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace impactrig::models {

/// Explicit Runge-Kutta method of order 8 with error estimates of orders 5 and 3 and dense output
/// of order 7 [HairerNorsettWanner1993, II.5]. One step is tried, looked at, and then accepted or
/// tried again with another size: the caller decides, since only the caller knows about events.
class Dop853 {
 public:
  /// dy/dt = f(t, y); y and dydt of length n.
  using RightHandSide =
      std::function<void(double t, const Eigen::VectorXd& y, Eigen::Ref<Eigen::VectorXd> dydt)>;

  explicit Dop853(int size);

  /// Starts (again) at a state; every discontinuity of f needs this.
  void start(double t, const Eigen::VectorXd& y, const RightHandSide& f);

  /// Tries a step from the current state. Returns its error in the norm √(Σ (w_i e_i)²), to be
  /// compared with 1; not finite when f was not.
  double attempt(double h, const Eigen::VectorXd& weights, const RightHandSide& f);

  /// Makes the attempted step the current state.
  void accept();

  /// What a step of h should have been for an error of 1, within [h/5, 6 h].
  static double suggest(double h, double error);

  double time() const { return t_; }

  double step() const { return h_; }  ///< of the attempt

  const Eigen::VectorXd& state() const { return y_; }

  const Eigen::VectorXd& slope() const { return slope_; }  ///< f at the current state

  const Eigen::VectorXd& attempted() const { return y_new_; }  ///< state at the end of the attempt

  const Eigen::VectorXd& attempted_slope() const { return slope_new_; }

  /// State at t + θ h of the attempt, θ in [0, 1]; three more evaluations the first time.
  void dense(double theta, const RightHandSide& f, Eigen::VectorXd& y);

  /// The same for some rows of the state only; the rest of y is left as it is.
  void dense(double theta, const RightHandSide& f, const std::vector<int>& rows,
             Eigen::VectorXd& y);

  long evaluations() const { return evaluations_; }

 private:
  void evaluate(const RightHandSide& f, double t, const Eigen::VectorXd& y, int stage);
  void prepare_dense(const RightHandSide& f);

  double t_ = 0.0, h_ = 0.0;
  bool dense_ready_ = false;
  long evaluations_ = 0;
  Eigen::VectorXd y_, y_new_, slope_, slope_new_, scratch_;
  Eigen::MatrixXd stages_;  // (n, 16)
  Eigen::MatrixXd dense_;   // (n, 7)
};

}  // namespace impactrig::models
