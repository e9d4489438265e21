// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace impactrig::fitting {

/// Standard uncertainties of a comparison, all in the unit of what is compared, ≥ 0.
struct ComparisonUncertainty {
  double numerical = 0.0;  ///< u_num of S: time steps, mesh (Richardson, mesh error)
  double input = 0.0;      ///< u_input of S: √Σ (∂S/∂x u_x)² over the inputs x
  double data = 0.0;       ///< u_D: calibration, noise, scatter of repeats
  /// cov(S, D) of inputs both share, for example the approach speed [unit²].
  double covariance = 0.0;
};

/// What a comparison error says beside its uncertainty.
enum class ComparisonVerdict {
  within_noise,  ///< |E| ≤ u_val: no model error can be told; not a proof that there is none
  unresolved,    ///< u_val < |E| ≤ k u_val: the interval of the model error holds zero
  model_error,   ///< |E| > k u_val: the model is off by about E
};

std::string_view name(ComparisonVerdict verdict);  ///< "within noise"

/// E of a simulated scalar against a measured one, with what is known about it.
struct ComparisonError {
  double error = 0.0;        ///< E = S − D
  double uncertainty = 0.0;  ///< u_val, standard
  double low = 0.0;          ///< E − k u_val
  double high = 0.0;         ///< E + k u_val: the model error lies between
  ComparisonVerdict verdict = ComparisonVerdict::within_noise;
};

/// ASME V&V 20:
///
///   E = S − D,   u_val = √(u_num² + u_input² + u_D² − 2 cov(S, D)),   δ_model in E ± k u_val
///
/// A small E with a large u_val is no success: what is claimed is |δ_model| up to |E| + k u_val.
/// Throws std::invalid_argument for a negative uncertainty, a covariance above what the
/// uncertainties allow, or k ≤ 0. Source: [ASMEVV20].
ComparisonError comparison_error(double simulated, double measured,
                                 const ComparisonUncertainty& uncertainty,
                                 double coverage_factor = 2.0);

}  // namespace impactrig::fitting
