// SPDX-License-Identifier: BSD-3-Clause
// Modes of a chain of elements, several at a time, by code for each kind of processor: against the
// same bar's modes by a dense solver, written down here anew.
#include "models/lanes/bar_lanes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <vector>

#include "models/beams/bar_element.hpp"
#include "models/lanes/bar_sweep.hpp"
#include "models/lanes/processor.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

constexpr int elements = 9;

/// Equal elements, pinned at the left: once as the lanes take them, once as matrices of (θ_0, w_1,
/// θ_1, ...).
struct Chain {
  explicit Chain(bool shears) {
    BarElement element{.length = 0.1,
                       .bending_stiffness = 3.0,
                       .line_density = 2.0,
                       .shear_compliance = shears ? 1e-3 : 0.0,
                       .rotary_inertia = shears ? 1e-2 : 0.0};
    values = shears ? BarElement::values : 4;
    BarElement::Matrix own = BarElement::Matrix::Identity();  // (w, θ, ...) of (u, e, ...)
    own.block<2, 2>(2, 0) << 1.0, element.length, 0.0, 1.0;
    const BarElement::Matrix bent = own.transpose() * element.stiffness() * own;
    const BarElement::Matrix moved = own.transpose() * element.mass() * own;
    const int each = values - 2;
    const Eigen::Index n = 1 + elements * each;
    stiffness.setZero(n, n);
    mass.setZero(n, n);
    for (int e = 0; e < elements; ++e) {
      length.push_back(element.length);
      wave_number.push_back(std::pow(element.line_density / element.bending_stiffness, 0.25));
      wave.push_back((e + 1) * element.length * wave_number.back());
      for (int i = 0; i < values; ++i)
        for (int j = 0; j <= i; ++j) {
          own_stiffness.push_back(j < 2 ? 0.0 : bent(i, j));
          own_mass.push_back(moved(i, j));
        }
      const auto place = [&](int i) {
        if (i < 2) return e == 0 ? i - 1 : 1 + (e - 1) * each + i;
        return 1 + e * each + i - 2;
      };
      for (int i = 0; i < values; ++i)
        for (int j = 0; j < values; ++j)
          if (place(i) >= 0 && place(j) >= 0) {
            stiffness(place(i), place(j)) += element.stiffness()(i, j);
            mass(place(i), place(j)) += element.mass()(i, j);
          }
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense(stiffness, mass);
    squares = dense.eigenvalues();
  }

  BarForms forms() const {
    return {.elements = elements,
            .values = values,
            .length = length.data(),
            .wave = wave.data(),
            .wave_number = wave_number.data(),
            .stiffness = own_stiffness.data(),
            .mass = own_mass.data()};
  }

  int values;
  std::vector<double> length, wave, wave_number, own_stiffness, own_mass;
  Eigen::MatrixXd stiffness, mass;
  Eigen::VectorXd squares;
};

/// A kernel for registers of every width, and as it is compiled for each newer processor.
template <typename Work>
std::vector<std::function<void(const Work&)>> all_of(void (*two)(const Work&),
                                                     void (*four)(const Work&),
                                                     void (*eight)(const Work&),
                                                     void (*avx2)(const Work&),
                                                     void (*avx512)(const Work&)) {
  std::vector<std::function<void(const Work&)>> all = {two, four, eight};
  if (processor() >= Processor::avx2) all.push_back(avx2);
  if (processor() >= Processor::avx512) all.push_back(avx512);
  return all;
}

const auto counting = all_of<BarShifts>(count_modes_by<2>, count_modes_by<4>, count_modes_by<8>,
                                        count_modes_avx2, count_modes_avx512);
const auto finding = all_of<BarModesBetween>(find_modes_by<2>, find_modes_by<4>, find_modes_by<8>,
                                             find_modes_avx2, find_modes_avx512);
const auto moving = all_of<BarUnderLoads>(find_motion_by<2>, find_motion_by<4>, find_motion_by<8>,
                                          find_motion_avx2, find_motion_avx512);

// Sylvester's law of inertia.
TEST(BarLanes, CountModesBelowAnyShift) {
  for (const bool shears : {false, true}) {
    const Chain chain(shears);
    const BarForms bar = chain.forms();
    std::vector<double> shifts = {-1.0};
    for (Eigen::Index k = 0; k + 1 < chain.squares.size(); ++k)
      shifts.push_back(0.5 * (chain.squares[k] + chain.squares[k + 1]));
    for (const auto& count : counting) {
      std::vector<double> below(shifts.size(), -1.0);
      count({.bar = &bar,
             .shifts = static_cast<int>(shifts.size()),
             .shift = shifts.data(),
             .below = below.data()});
      for (std::size_t k = 0; k < shifts.size(); ++k) EXPECT_EQ(below[k], static_cast<double>(k));
    }
  }
}

TEST(BarLanes, FindModesWhereverTheyBegin) {
  for (const bool shears : {false, true})
    for (const double part : {0.01, 0.5, 0.99}) {
      const Chain chain(shears);
      const BarForms bar = chain.forms();
      const Eigen::Index n = chain.squares.size();
      Eigen::VectorXd index(n), above(n), below(n), start(n);
      for (Eigen::Index k = 0; k < n; ++k) {
        index[k] = static_cast<double>(k);
        above[k] = k == 0 ? -chain.squares[1] : 0.5 * (chain.squares[k - 1] + chain.squares[k]);
        below[k] =
            k + 1 == n ? 2.0 * chain.squares[k] : 0.5 * (chain.squares[k] + chain.squares[k + 1]);
        start[k] = above[k] + part * (below[k] - above[k]);
      }
      for (const auto& find : finding) {
        Eigen::VectorXd squares(n), converged(n);
        Eigen::MatrixXd rows(n, n);
        std::vector<double> work(static_cast<std::size_t>(bar_work(bar)));
        find({.bar = &bar,
              .modes = static_cast<int>(n),
              .index = index.data(),
              .above = above.data(),
              .start = start.data(),
              .below = below.data(),
              .work = work.data(),
              .square = squares.data(),
              .converged = converged.data(),
              .turn = rows.data(),
              .shape = rows.data() + n,
              .stride = static_cast<int>(n)});
        EXPECT_EQ(converged, Eigen::VectorXd::Ones(n));
        const double largest = chain.squares[n - 1];
        EXPECT_LT((squares - chain.squares).cwiseAbs().maxCoeff(), 1e-13 * largest);
        const Eigen::MatrixXd unit = rows * chain.mass * rows.transpose();
        EXPECT_LT((unit - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-9);
        const Eigen::MatrixXd diagonal = rows * chain.stiffness * rows.transpose();
        EXPECT_LT((diagonal - Eigen::MatrixXd(squares.asDiagonal())).cwiseAbs().maxCoeff(),
                  1e-9 * largest);
      }
    }
}

// A bar that has no mode in a bracket: the pass ends and says so.
TEST(BarLanes, SayWhereThereIsNoMode) {
  const Chain chain(false);
  const BarForms bar = chain.forms();
  const double index = 3.0, above = 1.01 * chain.squares[2], below = 0.99 * chain.squares[3];
  const double start = 0.5 * (above + below);
  for (const auto& find : finding) {
    double square = 0.0, converged = -1.0;
    Eigen::VectorXd row(chain.squares.size());
    std::vector<double> work(static_cast<std::size_t>(bar_work(bar)));
    find({.bar = &bar,
          .modes = 1,
          .index = &index,
          .above = &above,
          .start = &start,
          .below = &below,
          .work = work.data(),
          .square = &square,
          .converged = &converged,
          .turn = row.data(),
          .shape = row.data() + 1,
          .stride = 1});
    EXPECT_EQ(converged, 0.0);
  }
}

TEST(BarLanes, MoveAsTheMatricesSay) {
  for (const bool shears : {false, true}) {
    const Chain chain(shears);
    const BarForms bar = chain.forms();
    const Eigen::Index n = chain.squares.size(), values = chain.values;
    const double shift = -chain.squares[1];
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(3, elements * values), forces(n, 3);
    forces.setZero();
    for (int i = 0; i < 3; ++i) {  // across the right end of an element, and about it
      const int e = 3 * i;
      const double force = 1.0 + i, moment = 0.1 * i, l = chain.length[0];
      loads(i, e * values) = force;
      loads(i, e * values + 1) = l * force + moment;
      loads(i, e * values + 2) = force;
      loads(i, e * values + 3) = moment;
      forces(1 + e * (values - 2), i) = force;
      forces(2 + e * (values - 2), i) = moment;
    }
    const Eigen::MatrixXd expected = (chain.stiffness - shift * chain.mass).llt().solve(forces);
    for (const auto& move : moving) {
      Eigen::MatrixXd rows(3, n);
      std::vector<double> work(static_cast<std::size_t>(bar_work(bar)));
      move({.bar = &bar,
            .loads = 3,
            .shift = shift,
            .load = loads.data(),
            .work = work.data(),
            .turn = rows.data(),
            .motion = rows.data() + 3,
            .stride = 3});
      EXPECT_LT((rows.transpose() - expected).norm(), 1e-11 * expected.norm());
    }
  }
}

}  // namespace
}  // namespace impactrig::tests
