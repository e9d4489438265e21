// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/reduced_bar.hpp"

#include <optional>
#include <stdexcept>
#include <utility>

namespace impactrig::models {

ReducedBar::ReducedBar(std::shared_ptr<const LinearBar> bar, std::vector<double> points, int modes)
    : bar_(std::move(bar)),
      finder_(std::make_shared<BarModeFinder>(*bar_)),
      points_(std::move(points)) {
  find_modes(modes, nullptr);
}

ReducedBar::ReducedBar(const ReducedBar& fewer, int modes)
    : bar_(fewer.bar_),
      finder_(fewer.finder_),
      points_(fewer.points_) {
  find_modes(modes, &fewer.modes_);
}

void ReducedBar::find_modes(int modes, const BarModes* fewer) {
  std::vector<LinearBar::Row> rows;
  for (const double x : points_) rows.push_back(bar_->row_at(x));
  std::optional<BarModes> found = finder_->slowest(modes, rows, fewer);
  if (!found) throw std::runtime_error("two of the bar's modes are too close to be told apart");
  modes_ = *std::move(found);
}

SmallMotion ReducedBar::small_motion() const {
  const Eigen::Index m = modes_.squares.size(), held = modes_.weight.rows();
  SmallMotion motion{.mass = Eigen::MatrixXd::Identity(m, m),
                     .stiffness = modes_.squares.asDiagonal(),
                     .gravity = Eigen::MatrixXd::Zero(m, m),
                     .load = small_motion_load(),
                     .hinge = modes_.hinge,
                     .spring = bar_->spring(),
                     .rigid = modes_.rigid};
  motion.gravity.topLeftCorner(held, held) = modes_.weight;
  motion.stiffness -= motion.gravity + motion.spring * motion.hinge * motion.hinge.transpose();
  return motion;
}

std::optional<BarModes> ReducedBar::modes() const {
  return BarModes{.squares = modes_.squares,
                  .rows = {},
                  .own = modes_.own,
                  .left_out = modes_.left_out,
                  .weight = modes_.weight,
                  .hinge = modes_.hinge,
                  .rigid = modes_.rigid};
}

Eigen::VectorXd ReducedBar::small_motion_load() const {
  return modes_.rows * bar_->small_motion_load();
}

Eigen::MatrixXd ReducedBar::strains(const Eigen::MatrixXd& own) const {
  return bar_->strains(bar_->own_values(modes_.rows.transpose() * own));
}

Eigen::VectorXd ReducedBar::small_motion_row(double x) const {
  const LinearBar::Row at = bar_->row_at(x);
  Eigen::VectorXd row = Eigen::VectorXd::Zero(modes_.squares.size());
  for (std::size_t i = 0; i < BarElement::values; ++i)
    if (at.places[i] >= 0) row += at.values[static_cast<int>(i)] * modes_.rows.col(at.places[i]);
  return row;
}

}  // namespace impactrig::models
