// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "models/rig.hpp"

namespace impactrig::tests {

/// An inextensible bar of any rotation, without a model of the project: rigid massless links of
/// equal length, their ends carrying the mass, torsion springs EI / h between them; the first turns
/// freely on the hinge. Coordinates are the links' angles from hanging straight, closing < 0.
/// Errors go with the square, and then the fourth power, of the links' length.
class LinkChain {
 public:
  using State = std::vector<double>;  // angles (n) [rad], rates (n) [rad/s]

  struct Point {
    double across = 0.0;  ///< X [m], closing < 0
    double along = 0.0;   ///< distance below the hinge [m]
    double across_rate = 0.0;
  };

  LinkChain(const models::Rig& rig, int links)
      : rig_(rig),
        n_(links),
        h_(rig.beam.length / links),
        spring_(rig.beam.youngs_modulus * rig.beam.second_moment / h_),
        carried_(static_cast<std::size_t>(links)),
        mass_(links, links),
        rhs_(links),
        sine_(links),
        cosine_(links) {
    const double node = rig.beam.density * rig.beam.area * h_;
    for (int i = 0; i < links; ++i)
      carried_[static_cast<std::size_t>(i)] = node * (links - i - 0.5);
  }

  int links() const { return n_; }

  double link() const { return h_; }

  /// Rate of the state under a force on the end of link `at` (from 1), positive across.
  void slope(const State& y, State& d, int at = 0, double force = 0.0) {
    for (int i = 0; i < n_; ++i) {
      sine_[i] = std::sin(y[index(i)]);
      cosine_[i] = std::cos(y[index(i)]);
    }
    for (int i = 0; i < n_; ++i) {
      double sum = -carried(i) * h_ * rig_.gravity * sine_[i];
      if (i < at) sum += force * h_ * cosine_[i];
      if (i > 0) sum -= spring_ * (y[index(i)] - y[index(i - 1)]);
      if (i + 1 < n_) sum += spring_ * (y[index(i + 1)] - y[index(i)]);
      for (int k = 0; k < n_; ++k) {
        const double inertia = carried(i > k ? i : k) * h_ * h_;
        const double rate = y[index(n_ + k)];
        // cosine and sine of the angle between the links
        if (k <= i) mass_(i, k) = inertia * (cosine_[i] * cosine_[k] + sine_[i] * sine_[k]);
        sum -= inertia * (sine_[i] * cosine_[k] - cosine_[i] * sine_[k]) * rate * rate;
      }
      rhs_[i] = sum;
    }
    factor_.compute(mass_);  // of the lower triangle
    factor_.solveInPlace(rhs_);
    for (int i = 0; i < n_; ++i) {
      d[index(i)] = y[index(n_ + i)];
      d[index(n_ + i)] = rhs_[i];
    }
  }

  /// The end of link `at`, from 1.
  Point point(const State& y, int at) const {
    Point p;
    for (int i = 0; i < at; ++i) {
      p.across += h_ * std::sin(y[index(i)]);
      p.along += h_ * std::cos(y[index(i)]);
      p.across_rate += h_ * std::cos(y[index(i)]) * y[index(n_ + i)];
    }
    return p;
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  double carried(int i) const { return carried_[index(i)]; }

  models::Rig rig_;
  int n_;
  double h_;
  double spring_;                // [N m]
  std::vector<double> carried_;  // mass beyond the beginning of a link, its own end's included [kg]
  Eigen::MatrixXd mass_;
  Eigen::VectorXd rhs_, sine_, cosine_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// Limit of values at links of length h, h/2, h/4 with errors of h² and h⁴.
inline double extrapolated(double coarse, double medium, double fine) {
  const double first = medium + (medium - coarse) / 3.0;
  const double second = fine + (fine - medium) / 3.0;
  return second + (second - first) / 15.0;
}

}  // namespace impactrig::tests
