// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "models/beams/linear_bar.hpp"
#include "models/lanes/bar_lanes.hpp"
#include "models/modal/small_motion.hpp"

namespace impactrig::models {

/// Finds modes of a LinearBar in a time that grows with its elements and with the number of modes.
/// Each is fenced off from the others by counts of negative pivots, then found by inverse iteration
/// [Parlett1998, 3.3 and 4.6]. Each is right to nearly all digits, however stiff an element is.
class BarModeFinder {
 public:
  /// `clamped`: the hinge does not turn, its coordinate is zero.
  explicit BarModeFinder(const LinearBar& bar, bool clamped = false);

  /// All modes; none where two cannot be told apart.
  std::optional<BarModes> all();

  /// As many of the slowest, and what bends the bar under forces at these points without them: with
  /// it the bar gives way to steady forces as it does with all modes. That is one mode more a
  /// point, at most twice as fast as the fastest of the bar's own: a spring needs no mass. `fewer`
  /// that are known are not sought again.
  std::optional<BarModes> slowest(int modes, const std::vector<LinearBar::Row>& points,
                                  const BarModes* fewer = nullptr);

 private:
  static constexpr int most_values = BarElement::values;
  using Rows = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  using Form = Eigen::Matrix<double, most_values, most_values>;

  /// A number above so many modes' ω².
  struct Fence {
    double at;
    int below;
  };

  int size() const { return 1 + bar_.elements * (bar_.values - 2); }

  int most() const { return bar_.clamped ? size() - 1 : size(); }

  Form form(const std::vector<double>& triangles, int element) const;
  Eigen::MatrixXd form_of(const std::vector<double>& triangles, const Rows& rows) const;
  void find_values(const Rows& rows, int element, Eigen::MatrixXd& values) const;
  void count(std::vector<double> at);
  std::optional<Fence> fence_below(int mode) const, fence_above(int mode) const;
  std::optional<double> next_fence(int mode) const;
  bool fence_off(int known, int modes);
  std::optional<BarModes> find(int modes, int more, const BarModes* fewer);
  int moved_by_weight(const Rows& rows, const Eigen::Ref<const Eigen::VectorXd>& squares) const;
  void find_weight(BarModes& modes) const;
  Eigen::MatrixXd inertia_of(const Rows& rows) const;
  void find_rotation(BarModes& modes) const;
  Eigen::MatrixXd give_way(const Eigen::MatrixXd& loads, double shift);
  void stand_in(BarModes& modes, const std::vector<LinearBar::Row>& points);

  bool hangs_;
  double negligible_weight_;                                            // of ω²
  std::vector<double> length_, wave_, wave_number_, stiffness_, mass_;  // as of BarForms
  std::vector<double> weight_;                                          // what of A is the weight's
  BarForms bar_;
  std::vector<Fence> fences_;  // in ascending order
  std::unique_ptr<double[]> work_;
};

}  // namespace impactrig::models
