// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "models/beams/bar_modes.hpp"
#include "models/beams/linear_bar.hpp"
#include "models/modal/small_motion.hpp"

namespace impactrig::models {

/// A bar of many elements in few coordinates, those that matter where forces press it at known
/// points: its slowest modes, and for each point one that stands for all the others. It bends under
/// steady forces there exactly as the bar does; the others follow a force as springs do unless it
/// changes as fast as they vibrate [MacNeal1971].
class ReducedBar : public SmallMotionBeam {
 public:
  /// Throws std::runtime_error where two modes cannot be told apart.
  ReducedBar(std::shared_ptr<const LinearBar> bar, std::vector<double> points, int modes);

  /// The same bar in more modes, of which those of `fewer` are not sought again.
  ReducedBar(const ReducedBar& fewer, int modes);

  SmallMotion small_motion() const override;
  Eigen::VectorXd small_motion_row(double x) const override;
  Eigen::VectorXd small_motion_load() const override;
  Eigen::MatrixXd strains(const Eigen::MatrixXd& own) const override;
  std::optional<BarModes> modes() const override;

  std::vector<BarElement> stretching_elements() const override {
    return bar_->stretching_elements();
  }

  /// How many of the coordinates are modes of the bar.
  int own_modes() const { return modes_.own; }

  /// BarModes::left_out.
  const Eigen::VectorXd& left_out() const { return modes_.left_out; }

 private:
  void find_modes(int modes, const BarModes* fewer);

  std::shared_ptr<const LinearBar> bar_;
  std::shared_ptr<BarModeFinder> finder_;  // used while modes are sought only
  std::vector<double> points_;
  BarModes modes_;
};

}  // namespace impactrig::models
