// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace impactrig::acquisition {

/// Least squares through quiet samples.
struct QuietResiduals {
  /// (n_samples), in their order; NaN where one did not count, whatever it was.
  std::vector<double> residuals;
  double scatter = 0.0;  ///< their standard deviation, without what is no noise
  double quantum = 0.0;  ///< one digitiser step; 0 when not seen
  double rise = 0.0;     ///< from the lowest to the highest value of the course
  int terms = 1;         ///< that were fitted
};

/// Variance that independent samples would have through which the course were known as well as
/// through these [unit²]: n times that of their mean.
///
///   S = s² t / (1 − p (2 m + 1) / n) + b² n / max(1, rise/q)
///
/// s² is the scatter, t its integrated autocorrelation time, summed up to the lag m, p the terms
/// and n the number of samples that count; products of others are 0 in t, as they are in the
/// variance of the mean. The course takes some of the slow noise with it, p S / n of the
/// autocovariance at each of 2 m + 1 lags: of a line through 50 correlation times S would be stated
/// a third too small. Where less than a tenth were left, a tenth. Residuals beyond 4 s or 1.6 steps
/// do not count, as in fit_quiet().
///
/// b is the standard deviation of what a digitiser's steps q hide of the level from all samples on
/// a step alike. A course that rises by a step or more shows the noise between them,
/// σ² = s² − q²/12, of which [WidrowKollar2008] have b² < q²/12 exp(−(2 pi σ/q)²). On one step
/// there are two values, of shares w and 1 − w, and the level is anywhere up to (1/2 − w) q from
/// their mean: b² = (q²/4 − s²) / 3, since s² = w (1 − w) q²; from s = q/2 on there are more, and b
/// is 0.
double slow_variance(QuietResiduals of);

}  // namespace impactrig::acquisition
