// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

namespace impactrig::models {

/// What an elastic law says of a penetration.
template <typename T = double>
struct ForceAndStiffness {
  T force{0.0};      ///< [N]
  T stiffness{0.0};  ///< df/dδ [N/m]
};

/// The same, with all that a damping law may be built on.
struct ElasticState {
  double force = 0.0;      ///< f_0 [N]
  double stiffness = 0.0;  ///< df_0/dδ [N/m]
  double curvature = 0.0;  ///< d²f_0/dδ² [N/m²]
  double energy = 0.0;     ///< ∫ f_0 dδ [J]
};

/// The number in a scalar that carries derivatives (Eigen::AutoDiffScalar) or none.
template <typename T>
double value_of(const T& x) {
  if constexpr (std::is_arithmetic_v<T>)
    return static_cast<double>(x);
  else
    return x.value();
}

}  // namespace impactrig::models
