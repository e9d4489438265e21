// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/band_cholesky.hpp"

#include <cmath>
#include <stdexcept>

namespace impactrig::models {

BandCholesky::BandCholesky(const BandMatrix& matrix) : lower_(4, matrix.size()) {
  lower_.setZero();
  for (int j = 0; j < matrix.size(); ++j) {
    double pivot = matrix.at(j, j);
    for (int d = 1; d <= 3 && d <= j; ++d) pivot -= lower_(d, j - d) * lower_(d, j - d);
    if (!(pivot > 0.0))
      throw std::invalid_argument("BandCholesky: the matrix is not positive definite");
    lower_(0, j) = 1.0 / std::sqrt(pivot);
    for (int d = 1; d <= 3 && j + d < matrix.size(); ++d) {
      double entry = matrix.at(j + d, j);
      for (int k = 1; d + k <= 3 && k <= j; ++k) entry -= lower_(d + k, j - k) * lower_(k, j - k);
      lower_(d, j) = entry * lower_(0, j);
    }
  }
}

}  // namespace impactrig::models
