// SPDX-License-Identifier: BSD-3-Clause
// What is computed several numbers at a time, against the same one by one.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <functional>
#include <random>
#include <vector>

#include "models/lanes/advance_modes.hpp"
#include "models/lanes/lane_bessel.hpp"
#include "models/lanes/processor.hpp"
#include "models/lanes/stage_kernels.hpp"
#include "models/modal/bar_cache.hpp"
#include "tests/models/reference/spherical_bessel.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;
using Two = LaneMath<2>;

TEST(LaneMath, LogarithmIsRightToAnUlp) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> wide(-600.0, 600.0), near(0.5, 2.0);
  for (int i = 0; i < 100000; ++i) {
    const Two::Real x = {std::exp(wide(random)), near(random)};
    const Two::Real logarithm = Two::log(x);
    for (int lane = 0; lane < 2; ++lane) {
      const long double truth = std::log(static_cast<long double>(x[lane]));
      ASSERT_NEAR(logarithm[lane], static_cast<double>(truth),
                  2.3e-16 * static_cast<double>(std::abs(truth)))
          << x[lane];
    }
  }
}

TEST(LaneMath, SineAndCosineAreRightToRounding) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> step(0.0, 400.0), wide(-1e5, 1e5);
  for (int i = 0; i < 100000; ++i) {
    const Two::Real x = {step(random), wide(random)};
    const auto [sine, cosine] = Two::sine_cosine(x);
    for (int lane = 0; lane < 2; ++lane) {
      const long double angle = x[lane];
      ASSERT_NEAR(sine[lane], static_cast<double>(std::sin(angle)), 1.5e-16) << x[lane];
      ASSERT_NEAR(cosine[lane], static_cast<double>(std::cos(angle)), 1.5e-16) << x[lane];
    }
  }
}

// Neighbours of any size: a lane's recurrence begins where the largest needs it to.
TEST(LaneBessel, AgreesWithTheSingleFunction) {
  constexpr int most = 240;
  LaneBessel<2, 256> lanes;
  std::array<double, most> single;
  const std::array<double, 12> places = {
      1e-9, 2e-4, 9.99e-4, 1.01e-3, 0.1, 1.0, 3.0, 3.141592653589793, 9.0, 31.0, 100.0, 179.0};
  for (const double left : places)
    for (const double right : places) {
      for (const int terms : {1, 2, 6, 8, 20, most}) {
        const Two::Real both = {left, right};
        const auto [sine, cosine] = Two::sine_cosine(both);
        lanes.evaluate(both, sine, cosine, terms);
        for (int lane = 0; lane < 2; ++lane) {
          spherical_bessel(both[lane], single);
          for (int n = 0; n < terms; ++n)
            ASSERT_NEAR(lanes[n][lane], single[static_cast<std::size_t>(n)], 3e-15)
                << n << " of " << left << ", " << right << ", " << terms << " terms";
        }
      }
    }
}

/// Modes and their motion by one kind of processor.
struct Moved {
  Eigen::VectorXd a, rate;
  PointMotion struck;
};

Moved moved(const ModalBeam& beam, double h, const NodeVector& series,
            void (*advance_by)(ModesUnderForce&)) {
  const Eigen::VectorXd a = Eigen::VectorXd::LinSpaced(beam.modes(), 1.0, -2.0);
  const Eigen::VectorXd rate = Eigen::VectorXd::LinSpaced(beam.modes(), -3.0, 5.0);
  Moved to{a, rate, {}};
  ModesUnderForce modes{.modes = beam.modes(),
                        .terms = static_cast<int>(series.size()),
                        .omega = beam.omega().data(),
                        .struck = beam.struck().data(),
                        .h = h,
                        .series = series.data(),
                        .a = a.data(),
                        .rate = rate.data(),
                        .end_a = to.a.data(),
                        .end_rate = to.rate.data()};
  advance_by(modes);
  to.struck = {modes.displacement, modes.velocity};
  return to;
}

TEST(Lanes, GiveTheSameOnEveryProcessor) {
  const Rig rig = paper_rig();
  const auto bar = make_modal_bar(rig, hybrid(Basis::pinned_free, 12, 1e-6, 1e-3));
  const ModalBeam& beam = bar->modes();
  const NodeVector series = Eigen::VectorXd::LinSpaced(8, 2.0, -1.0);
  for (const double h : {1e-7, 1e-5, 3e-4, 4e-3}) {
    const auto two = [](ModesUnderForce& modes) { ModeAdvance<2>(modes).advance(); };
    const Moved plain = moved(beam, h, series, two);
    const auto expect_same = [&](const Moved& other) {
      EXPECT_LE((other.a - plain.a).norm(), 1e-14 * plain.a.norm());
      EXPECT_LE((other.rate - plain.rate).norm(), 1e-14 * plain.rate.norm());
      EXPECT_NEAR(other.struck.displacement, plain.struck.displacement, 1e-14 * plain.a.norm());
    };
    if (processor() >= Processor::avx2) expect_same(moved(beam, h, series, advance_modes_avx2));
    if (processor() >= Processor::avx512) expect_same(moved(beam, h, series, advance_modes_avx512));
  }
}

// A force constant in time, in long double; steps end on events however close by.
TEST(Lanes, MoveTheModesAsExactlyOverAnyTime) {
  const auto bar = make_modal_bar(paper_rig(), hybrid(Basis::pinned_free, 5, 1e-6, 1e-3));
  const ModalBeam& beam = bar->modes();
  NodeVector series = NodeVector::Zero(6);
  series[0] = 3.0;
  ModalState from, to;
  from.a = to.a = Eigen::VectorXd::LinSpaced(beam.modes(), 1e-6, -2e-6);
  from.rate = to.rate = Eigen::VectorXd::LinSpaced(beam.modes(), -3e-3, 5e-3);
  for (const double h : {1e-18, 1e-14, 1e-12, 1e-9, 1e-6, 1e-4}) {
    advance(beam, h, series, from, to);
    for (int k = 1; k < beam.modes(); ++k) {
      const long double omega = beam.omega()[k], t = h, force = 3.0L * beam.struck()[k];
      const long double half = std::sin(0.5L * omega * t);
      const long double sine = std::sin(omega * t), cosine = std::cos(omega * t);
      const long double a = from.a[k] * cosine + from.rate[k] * sine / omega -
                            force * 2.0L * half * half / (omega * omega);
      const long double rate =
          from.rate[k] * cosine - from.a[k] * omega * sine - force * sine / omega;
      EXPECT_NEAR(to.a[k], static_cast<double>(a), 2e-15 * std::abs(from.a[k])) << h << ' ' << k;
      EXPECT_NEAR(to.rate[k], static_cast<double>(rate),
                  1e-14 * (std::abs(from.rate[k]) +
                           static_cast<double>(std::abs(from.a[k] * omega * sine))))
          << h << ' ' << k;
    }
  }
}

/// A kernel for registers of every width, and as it is compiled for each newer processor.
template <typename Work>
struct Kernel {
  using Run = void (*)(const Work&);
  std::array<Run, 3> of_width;
  Run avx2, avx512;
};

/// What each makes of the same; those for processors that this machine does not have do not run.
template <typename Work>
std::vector<std::vector<double>> by_every(const Kernel<Work>& kernel, Work work,
                                          const std::vector<double>& values,
                                          double* Work::*result) {
  std::vector<typename Kernel<Work>::Run> runs(kernel.of_width.begin(), kernel.of_width.end());
  if (processor() >= Processor::avx2) runs.push_back(kernel.avx2);
  if (processor() >= Processor::avx512) runs.push_back(kernel.avx512);
  std::vector<std::vector<double>> all;
  for (const auto run : runs) {
    std::vector<double>& own = all.emplace_back(values);
    work.*result = own.data();
    run(work);
  }
  return all;
}

constexpr Kernel<StagesByMap> map_kernel{
    {map_stages_in<2>, map_stages_in<4>, map_stages_in<8>}, map_stages_avx2, map_stages_avx512};
constexpr Kernel<TurnedStages> turn_kernel{
    {turn_stages_in<2>, turn_stages_in<4>, turn_stages_in<8>},
    turn_stages_avx2,
    turn_stages_avx512};
constexpr Kernel<AncfResidual> residual_kernel{
    {find_residual_in<2>, find_residual_in<4>, find_residual_in<8>},
    find_residual_avx2,
    find_residual_avx512};
constexpr Kernel<FactoredChain> solve_kernel{
    {solve_chain_in<2>, solve_chain_in<4>, solve_chain_in<8>},
    solve_chain_avx2,
    solve_chain_avx512};

void expect_equal(const std::vector<std::vector<double>>& found, const Eigen::MatrixXd& expected) {
  for (const std::vector<double>& values : found)
    for (Eigen::Index i = 0; i < expected.size(); ++i)
      ASSERT_NEAR(values[static_cast<std::size_t>(i)], expected.data()[i],
                  1e-13 * expected.cwiseAbs().maxCoeff())
          << i;
}

// By matrices of Eigen's.
TEST(StageLanes, MapAndTurnColumnsOnEveryProcessor) {
  for (const int s : {4, 8}) {
    const int n = 7;
    const Eigen::MatrixXd map = Eigen::MatrixXd::Random(s, s), in = Eigen::MatrixXd::Random(s, n);
    const Eigen::VectorXd ramp = Eigen::VectorXd::Random(s), slope = Eigen::VectorXd::Random(n),
                          offset = Eigen::VectorXd::Random(n);
    StagesByMap stages{.stages = s, .columns = n, .map = map.data(), .in = in.data()};
    const std::vector<double> nothing(static_cast<std::size_t>(s * n));
    const auto mapped = [&] { return by_every(map_kernel, stages, nothing, &StagesByMap::out); };
    expect_equal(mapped(), map * in);
    stages.offset = offset.data();
    const Eigen::MatrixXd shifted = map * in + Eigen::VectorXd::Ones(s) * offset.transpose();
    expect_equal(mapped(), shifted);
    stages.ramp = ramp.data();
    stages.slope = slope.data();
    expect_equal(mapped(), shifted + ramp * slope.transpose());

    const std::vector<int> first = {0, 3}, second = {2, 6};
    const Eigen::ArrayXd cosine = Eigen::ArrayXd::Random(s), sine = Eigen::ArrayXd::Random(s);
    Eigen::MatrixXd turned = in;
    for (std::size_t p = 0; p < 2; ++p) {
      turned.col(first[p]) =
          (cosine * in.col(first[p]).array() + sine * in.col(second[p]).array()).matrix();
      turned.col(second[p]) =
          (cosine * in.col(second[p]).array() - sine * in.col(first[p]).array()).matrix();
    }
    const TurnedStages turn{.stages = s,
                            .pairs = 2,
                            .first = first.data(),
                            .second = second.data(),
                            .cosine = cosine.data(),
                            .sine = sine.data()};
    const std::vector<double> columns(in.data(), in.data() + in.size());
    expect_equal(by_every(turn_kernel, turn, columns, &TurnedStages::columns), turned);
  }
}

/// The factored systems of a chain by an arrow of full matrices: L of the blocks below the
/// diagonal, D⁻¹ of those on it, and what solves L D L' x = b.
template <int K>
void expect_solved_chain() {
  constexpr int s = 2 * K, nodes = 3, n = 4 * nodes;
  using Complex = std::complex<double>;
  std::vector<double> inverse(16 * s * nodes), lower(inverse.size()), x(s * n);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (double& number : inverse) number = any(random);
  for (double& number : lower) number = any(random);
  for (double& number : x) number = any(random);
  const auto entry = [](const std::vector<double>& of, int place, int system) {
    const auto at = static_cast<std::size_t>(s * place + system);
    return Complex(of[at], of[at + K]);
  };
  Eigen::MatrixXd expected(s, n);
  for (int k = 0; k < K; ++k) {
    Eigen::MatrixXcd l = Eigen::MatrixXcd::Identity(n, n), d = Eigen::MatrixXcd::Zero(n, n);
    Eigen::VectorXcd b(n);
    for (int i = 0; i < n; ++i) b[i] = entry(x, i, k);
    for (int node = 0; node < nodes; ++node)
      for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) {
          const int place = 16 * node + 4 * r + c;
          d(4 * node + r, 4 * node + c) = entry(inverse, place, k);
          if (node > 0) l(4 * node + r, 4 * node - 4 + c) = entry(lower, place, k);
        }
    const Eigen::VectorXcd solved = l.transpose().triangularView<Eigen::UnitUpper>().solve(
        d * l.triangularView<Eigen::UnitLower>().solve(b));
    for (int i = 0; i < n; ++i) {
      expected(k, i) = solved[i].real();
      expected(K + k, i) = solved[i].imag();
    }
  }
  const FactoredChain chain{
      .stages = s, .nodes = nodes, .inverse = inverse.data(), .lower = lower.data()};
  expect_equal(by_every(solve_kernel, chain, x, &FactoredChain::x), expected);
}

TEST(StageLanes, SolveAFactoredChainOnEveryProcessor) {
  expect_solved_chain<2>();
  expect_solved_chain<4>();
}

// All widths give the same; that it is right is AncfChain's test.
TEST(StageLanes, FindTheResidualOnEveryProcessor) {
  const std::vector<AncfNumbers> elements = {{3.0, 50.0, 2.0}, {4.0, 20.0, 1.0}};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::vector<AncfNode> nodes(3);
  for (AncfNode& node : nodes) {
    for (auto& block : {std::ref(node.own), std::ref(node.next)})
      for (auto& direction : block.get())
        for (auto& row : direction)
          for (double& number : row) number = any(random);
    for (double& weight : node.weight) weight = any(random);
  }
  const std::vector<AncfGaussPoint> gauss(5, {0.7, -0.2, 0.5, 0.2});
  for (const int s : {4, 8}) {
    std::vector<double> q(static_cast<std::size_t>(12 * s)), a(q.size());
    for (double& number : q) number = any(random);
    for (double& number : a) number = any(random);
    const AncfResidual residual{.stages = s,
                                .elements = 2,
                                .element = elements.data(),
                                .node = nodes.data(),
                                .gauss = gauss.data(),
                                .q = q.data(),
                                .a = a.data()};
    const auto found =
        by_every(residual_kernel, residual, std::vector<double>(q.size()), &AncfResidual::residual);
    expect_equal(found, Eigen::Map<const Eigen::MatrixXd>(found[0].data(), s, 12));
    for (const int held : {0, 2})
      for (int i = 0; i < s; ++i) EXPECT_EQ(found[0][static_cast<std::size_t>(s * held + i)], 0.0);
  }
}

}  // namespace
}  // namespace impactrig::tests
