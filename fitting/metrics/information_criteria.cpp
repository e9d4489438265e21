// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/information_criteria.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace impactrig::fitting {

InformationCriteria information_criteria(std::size_t samples, std::size_t parameters,
                                         double residual_sum_of_squares) {
  if (samples == 0 || !(residual_sum_of_squares > 0.0))
    throw std::invalid_argument(
        "information criteria need samples and a residual sum of squares greater than zero");
  const double n = static_cast<double>(samples), k = static_cast<double>(parameters);
  const double misfit = n * std::log(residual_sum_of_squares / n);
  InformationCriteria result;
  result.aic = misfit + 2.0 * k;
  result.aicc = n > k + 1.0 ? result.aic + 2.0 * k * (k + 1.0) / (n - k - 1.0)
                            : std::numeric_limits<double>::infinity();
  result.bic = misfit + k * std::log(n);
  return result;
}

}  // namespace impactrig::fitting
