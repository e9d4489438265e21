// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// What a signal follows beside its pulses: a straight line, alone or with mains hum, or
/// c + a exp(-i / T) as an amplifier's that comes back from an overload or a reset.
class SteadyDrift {
 public:
  /// What is not linear in it.
  struct Shape {
    double time = 0.0;   ///< T [samples]; 0: a line
    double omega = 0.0;  ///< of the hum [radians per sample]; 0: none
    int multiples = 0;   ///< of that: odd ones, most_multiples at most
  };

  SteadyDrift(const Shape& shape, double samples) : shape_(shape), samples_(samples) {}

  bool decays() const { return shape_.time > 0.0; }

  int terms() const { return 2 + 2 * shape_.multiples; }

  static constexpr int most_multiples = 2, most_terms = 2 + 2 * most_multiples;
  using Terms = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, most_terms>;

  /// At i samples from the begin of the record.
  Terms terms_at(double index) const;

  double at(double index) const { return terms_at(index).dot(coefficients); }

  Terms coefficients;  ///< of the terms [SI]

 private:
  Shape shape_;
  double samples_;  ///< of the record
};

/// From the begin of the record to the end: where it goes by more than 2 % of what the highest
/// pulse does beside it, and leaves nothing but noise, or 2 % of its way, 0.3 % of a decay's. None
/// elsewhere. `grain`: grain_of() the signal.
std::optional<SteadyDrift> steady_drift(const Trace& trace, double grain);

}  // namespace impactrig::acquisition
