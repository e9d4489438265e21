// SPDX-License-Identifier: BSD-3-Clause
#include "models/integration/dop853.hpp"

#include <algorithm>
#include <cmath>

#include "models/integration/dop853_table.hpp"

namespace impactrig::models {

Dop853::Dop853(int size)
    : y_(size),
      y_new_(size),
      slope_(size),
      slope_new_(size),
      scratch_(size),
      stages_(size, dop853::dense_stages),
      dense_(size, 7) {}

void Dop853::evaluate(const RightHandSide& f, double t, const Eigen::VectorXd& y, int stage) {
  f(t, y, stages_.col(stage));
  ++evaluations_;
}

void Dop853::start(double t, const Eigen::VectorXd& y, const RightHandSide& f) {
  t_ = t;
  y_ = y;
  evaluate(f, t_, y_, 0);
  slope_ = stages_.col(0);
  dense_ready_ = false;
}

double Dop853::attempt(double h, const Eigen::VectorXd& weights, const RightHandSide& f) {
  using namespace dop853;
  h_ = h;
  dense_ready_ = false;
  stages_.col(0) = slope_;
  for (std::size_t s = 1; s < stages; ++s) {
    y_new_ = y_;
    for (std::size_t j = 0; j < s; ++j)
      if (a[s][j] != 0.0) y_new_ += h * a[s][j] * stages_.col(static_cast<int>(j));
    evaluate(f, t_ + c[s] * h, y_new_, static_cast<int>(s));
  }
  y_new_ = y_;
  double fifth = 0.0;
  double third = 0.0;
  scratch_.setZero();
  for (std::size_t s = 0; s < stages; ++s)
    if (b[s] != 0.0) scratch_ += b[s] * stages_.col(static_cast<int>(s));
  y_new_ += h * scratch_;
  for (Eigen::Index i = 0; i < y_.size(); ++i) {
    double e5_sum = 0.0;
    double e3_sum = 0.0;
    for (std::size_t s = 0; s < stages; ++s) {
      const double k = stages_(i, static_cast<int>(s));
      e5_sum += e5[s] * k;
      e3_sum += e3[s] * k;
    }
    fifth += (weights[i] * e5_sum) * (weights[i] * e5_sum);
    third += (weights[i] * e3_sum) * (weights[i] * e3_sum);
  }
  evaluate(f, t_ + h, y_new_, stages);
  slope_new_ = stages_.col(stages);
  if (fifth == 0.0 && third == 0.0) return 0.0;
  return std::abs(h) * fifth / std::sqrt(fifth + 0.01 * third);
}

void Dop853::accept() {
  t_ += h_;
  y_.swap(y_new_);
  slope_.swap(slope_new_);
  dense_ready_ = false;
}

double Dop853::suggest(double h, double error) {
  if (!std::isfinite(error)) return 0.2 * h;
  return h * std::clamp(0.9 * std::pow(std::max(error, 1e-12), -0.125), 0.2, 6.0);
}

void Dop853::prepare_dense(const RightHandSide& f) {
  using namespace dop853;
  for (std::size_t s = 13; s < dense_stages; ++s) {
    scratch_ = y_;
    for (std::size_t j = 0; j < s; ++j)
      if (a[s][j] != 0.0) scratch_ += h_ * a[s][j] * stages_.col(static_cast<int>(j));
    evaluate(f, t_ + c[s] * h_, scratch_, static_cast<int>(s));
  }
  const auto first = stages_.col(0);
  const auto last = stages_.col(stages);
  dense_.col(0) = y_new_ - y_;
  dense_.col(1) = h_ * first - dense_.col(0);
  dense_.col(2) = 2.0 * dense_.col(0) - h_ * (last + first);
  for (std::size_t row = 0; row < 4; ++row) {
    auto column = dense_.col(3 + static_cast<int>(row));
    column.setZero();
    for (std::size_t s = 0; s < dense_stages; ++s)
      if (d[row][s] != 0.0) column += h_ * d[row][s] * stages_.col(static_cast<int>(s));
  }
  dense_ready_ = true;
}

void Dop853::dense(double theta, const RightHandSide& f, Eigen::VectorXd& y) {
  if (!dense_ready_) prepare_dense(f);
  // Hairer's nested form: alternate factors θ and 1 − θ.
  const double rest = 1.0 - theta;
  y = dense_.col(6);
  for (int k = 5; k >= 0; --k) y = dense_.col(k) + (k % 2 == 1 ? theta : rest) * y;
  y = y_ + theta * y;
}

void Dop853::dense(double theta, const RightHandSide& f, const std::vector<int>& rows,
                   Eigen::VectorXd& y) {
  if (!dense_ready_) prepare_dense(f);
  const double rest = 1.0 - theta;
  for (const int row : rows) {
    double value = dense_(row, 6);
    for (int k = 5; k >= 0; --k) value = dense_(row, k) + (k % 2 == 1 ? theta : rest) * value;
    y[row] = y_[row] + theta * value;
  }
}

}  // namespace impactrig::models
