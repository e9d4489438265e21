// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/slowest_modes.hpp"

#include <Spectra/SymGEigsShiftSolver.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace impactrig::models {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// The sum of what the elements of a bar give, of the coordinates from `held` on.
Sparse assembled(const std::vector<LinearBar::Share>& shares,
                 BarElement::Matrix LinearBar::Share::*of, int held, int size) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const LinearBar::Share& share : shares)
    for (std::size_t r = 0; r < BarElement::values; ++r)
      for (std::size_t c = 0; c < BarElement::values; ++c)
        if (share.places[r] >= held && share.places[c] >= held)
          entries.emplace_back(share.places[r] - held, share.places[c] - held,
                               (share.*of)(static_cast<int>(r), static_cast<int>(c)));
  Sparse sum(size - held, size - held);
  sum.setFromTriplets(entries.begin(), entries.end());
  return sum;
}

/// v to M v.
struct Mass {
  using Scalar = double;

  Sparse matrix;

  Eigen::Index rows() const { return matrix.rows(); }

  Eigen::Index cols() const { return matrix.cols(); }

  void perform_op(const double* v, double* out) const {
    Eigen::VectorXd::Map(out, rows()) = matrix * Eigen::VectorXd::Map(v, rows());
  }
};

/// v to (K - sigma M)^-1 v.
class ShiftedFlexibility {
 public:
  using Scalar = double;

  ShiftedFlexibility(const Sparse& stiffness, const Sparse& mass)
      : stiffness_(&stiffness),
        mass_(&mass) {}

  Eigen::Index rows() const { return stiffness_->rows(); }

  Eigen::Index cols() const { return stiffness_->cols(); }

  void set_shift(double sigma) {
    factor_.compute(*stiffness_ - sigma * *mass_);
    if (factor_.info() != Eigen::Success)
      throw std::runtime_error("the bar's stiffness could not be factored");
  }

  void perform_op(const double* v, double* out) const {
    Eigen::VectorXd::Map(out, rows()) = factor_.solve(Eigen::VectorXd::Map(v, rows()));
  }

 private:
  const Sparse* stiffness_;
  const Sparse* mass_;
  Eigen::SimplicialLLT<Sparse> factor_;
};

/// Between the squares of the slowest and the fastest of so many frequencies, roughly [1/s^2].
double middle_square(const LinearBar& bar, int count) {
  double bending = 0.0, mass = 0.0, length = 0.0;
  for (const BarElement& element : bar.elements()) {
    bending += element.bending_stiffness * element.length;
    mass += element.line_density * element.length;
    length += element.length;
  }
  const double wave_number = std::numbers::pi / length;
  return bending / mass * std::pow(wave_number, 4) * count * count;
}

}  // namespace

SlowestModes slowest_modes(const LinearBar& bar, int held, int count) {
  const std::vector<LinearBar::Share> shares = bar.shares();
  const Sparse stiffness = assembled(shares, &LinearBar::Share::stiffness, held, bar.size());
  Mass mass{assembled(shares, &LinearBar::Share::mass, held, bar.size())};
  ShiftedFlexibility flexibility(stiffness, mass.matrix);
  const Eigen::Index vectors = std::min<Eigen::Index>(2 * count + 20, mass.rows());
  Spectra::SymGEigsShiftSolver<ShiftedFlexibility, Mass, Spectra::GEigsMode::ShiftInvert> lanczos(
      flexibility, mass, count, vectors, -middle_square(bar, count));
  lanczos.init();
  lanczos.compute(Spectra::SortRule::LargestMagn, 1000, 1e-13, Spectra::SortRule::SmallestAlge);
  if (lanczos.info() != Spectra::CompInfo::Successful)
    throw std::runtime_error("the bar's modes could not be computed");
  return {lanczos.eigenvalues().cwiseMax(0.0).cwiseSqrt(), lanczos.eigenvectors()};
}

}  // namespace impactrig::models
