// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "models/sensitivities/motion_slope.hpp"
#include "models/sensitivities/run_sensitivities.hpp"
#include "models/sensitivities/slope_progress.hpp"

namespace impactrig::models {

/// Derivatives of a run of the full equations: a MotionSlope a parameter, and
/// the contact laws, solved in turn until both are at rest.
class FullSensitivities final : public RunSensitivities {
 public:
  FullSensitivities(const Rig& rig, const Solver& solver, const SimulationOptions& options,
                    BarMotion& motion, const StoppedMotion* stopped);

  /// False where the motion cannot be followed; then it is of no further use.
  bool known() const { return known_; }

  void start() override;
  void change_hinge() override;

 private:
  void prepare() override { linearise_laws(); }

  bool solve(int i) override;

  const BarMotion::Response& response(int point, int stop) override {
    return motion_.response(point, stop);
  }

  void go_to_place() override;

  Passing passing(std::size_t stop) const override { return passing_[stop]; }

  void follow_to_place(int i) override { slope(i).look(place_.part); }

  PointMotion struck(int i, std::size_t stop) const override {
    return slope(i).struck(static_cast<int>(stop));
  }

  PointMotion struck_at_place(int i, std::size_t stop) const override {
    return slope(i).struck_at_place(static_cast<int>(stop));
  }

  Spots spots(int i) const override { return slope(i).spots(); }

  void move_on(int i, double shift) override { slope(i).take(shift); }

  void begin_more(int i) override;

  double hinge_shift(int i) override { return slope(i).hinge_shift(); }

  MotionSlope& slope(int i) const { return *slopes_[static_cast<std::size_t>(i)]; }

  double press(int i);

  BarMotion& motion_;
  bool known_ = true;
  std::vector<std::unique_ptr<MotionSlope>> slopes_;  // a direction each
  std::vector<SlopeProgress> progress_;               // likewise
  std::vector<MotionSlope::Nodes> points_;            // before the stops
  std::vector<NodeVector> changes_;                   // of the forces' slopes
  Eigen::VectorXd answer_;
  std::vector<Passing> passing_;  // at the place
};

}  // namespace impactrig::models
