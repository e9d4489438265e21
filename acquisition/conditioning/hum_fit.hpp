// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// The mean of some quiet samples that follow each other.
struct HumPoint {
  double time, value;  ///< [s], middle of the samples; [the channel's unit]
  double u;            ///< place within its stretch, -1 to 1
  int stretch;
  int samples;
};

/// The quiet samples of a channel, averaged.
struct HumPoints {
  std::vector<HumPoint> points;
  std::size_t stretches = 0;
  double step = 0.0;  ///< of the channel's samples [s]

  double span() const { return points.back().time - points.front().time; }
};

/// Means of at most `widest` [s] within each quiet stretch; samples that are not sound end one.
HumPoints hum_points(const datasets::Channel& channel, const datasets::RemoveHum& hum,
                     std::span<const double> values, double widest);

/// Least squares of a sinusoid, its multiples and a line for each stretch; a point weighs as much
/// as the samples that it is the mean of, in units of their mean number.
struct HumFit {
  double frequency = 0.0;
  std::vector<int> multiples;
  Eigen::VectorXd coefficients;  ///< (2 m + 2 stretches): cosine, sine of each multiple; lines
  Eigen::MatrixXd covariance;    ///< of them
  double squares = 0.0;
  double variance = 0.0;  ///< of a point of weight 1, were they independent (see slow_variance)
  double correction =
      0.0;  ///< of the frequency [Hz]: a step of Gauss and Newton, the coefficients eliminated

  double amplitude(std::size_t m) const;

  /// Of an amplitude: the larger of the standard errors of its two parts.
  double error(std::size_t m) const;

  /// How many standard errors a sinusoid is from none, whatever the phase that it is told by:
  /// √(aᵀ C⁻¹ a), a its two parts and C their covariance; NaN of a constant.
  double significance(std::size_t m) const;

  /// Standard error of the hum at a time.
  double error_at(double time) const;

  /// Takes the hum off samples, the first of which is at `start`.
  void take_off(std::span<double> values, double start, double step) const;
};

enum class HumFigures { squares, correction, errors };

/// Fits at this frequency. `figures`: what is needed beside coefficients and squares.
HumFit fit_hum(const HumPoints& points, double frequency, std::vector<int> multiples,
               HumFigures figures);

/// 1 to `harmonics`.
std::vector<int> hum_multiples(int harmonics);

}  // namespace impactrig::acquisition
