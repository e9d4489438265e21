// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace impactrig::fitting {

/// What a better fit may cost in parameters; between models of the same samples the smaller is the
/// better. Only differences mean something.
struct InformationCriteria {
  double aic = 0.0;
  double aicc = 0.0;  ///< corrected for few samples; +infinity where n ≤ k + 1
  double bic = 0.0;
};

/// Of a least-squares fit whose noise level is unknown and estimated with it:
///
///   AIC = n ln(RSS / n) + 2 k,   AICc = AIC + 2 k (k + 1) / (n − k − 1),   BIC = n ln(RSS / n) + k
///   ln n
///
/// with n `samples`, RSS the sum of squared residuals [any unit², the same in all models compared]
/// and k `parameters`, the noise level counted as one of them. Samples are taken for independent.
/// Throws std::invalid_argument unless n > 0 and RSS > 0. Source: [BurnhamAnderson2002].
InformationCriteria information_criteria(std::size_t samples, std::size_t parameters,
                                         double residual_sum_of_squares);

}  // namespace impactrig::fitting
