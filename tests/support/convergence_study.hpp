// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace impactrig::tests {

/// Errors at several step sizes (or mesh widths): the order is the slope of log error over log
/// step.
class ConvergenceStudy {
 public:
  /// step > 0, error > 0, in any unit.
  void add(double step, double error) {
    log_step_.push_back(std::log(step));
    log_error_.push_back(std::log(error));
  }

  std::size_t size() const { return log_step_.size(); }

  /// Least-squares slope [-]; NaN with fewer than two points.
  double order() const {
    return covariance(log_step_, log_error_) / covariance(log_step_, log_step_);
  }

  /// Of the logarithms, in [-1, 1]: 1 when the points lie on a rising line.
  double correlation() const {
    return covariance(log_step_, log_error_) /
           std::sqrt(covariance(log_step_, log_step_) * covariance(log_error_, log_error_));
  }

 private:
  static double covariance(const std::vector<double>& a, const std::vector<double>& b) {
    double mean_a = 0.0;
    double mean_b = 0.0;
    const double n = static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      mean_a += a[i] / n;
      mean_b += b[i] / n;
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
    return sum;
  }

  std::vector<double> log_step_, log_error_;
};

}  // namespace impactrig::tests
