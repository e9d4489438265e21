// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/comparison_error.hpp"

#include <cmath>
#include <stdexcept>

namespace impactrig::fitting {

std::string_view name(ComparisonVerdict verdict) {
  switch (verdict) {
    case ComparisonVerdict::within_noise:
      return "within noise";
    case ComparisonVerdict::unresolved:
      return "unresolved";
    case ComparisonVerdict::model_error:
      return "model error";
  }
  return "";
}

ComparisonError comparison_error(double simulated, double measured,
                                 const ComparisonUncertainty& uncertainty, double coverage_factor) {
  const auto [numerical, input, data, covariance] = uncertainty;
  if (!(numerical >= 0.0) || !(input >= 0.0) || !(data >= 0.0))
    throw std::invalid_argument("standard uncertainties must not be negative");
  if (!(coverage_factor > 0.0))
    throw std::invalid_argument("a coverage factor must be greater than zero");
  const double simulated_u = std::hypot(numerical, input);
  if (!(std::abs(covariance) <= simulated_u * data * (1.0 + 1e-12)))
    throw std::invalid_argument(
        "the covariance must not exceed the product of the uncertainties of simulation and data");
  ComparisonError result;
  result.error = simulated - measured;
  result.uncertainty =
      covariance == 0.0
          ? std::hypot(simulated_u, data)
          : std::sqrt(std::max(0.0, simulated_u * simulated_u + data * data - 2.0 * covariance));
  result.low = result.error - coverage_factor * result.uncertainty;
  result.high = result.error + coverage_factor * result.uncertainty;
  const double size = std::abs(result.error);
  result.verdict = size <= result.uncertainty                     ? ComparisonVerdict::within_noise
                   : size <= coverage_factor * result.uncertainty ? ComparisonVerdict::unresolved
                                                                  : ComparisonVerdict::model_error;
  return result;
}

}  // namespace impactrig::fitting
