// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "models/beams/ancf.hpp"
#include "models/collocation/collocation.hpp"
#include "models/implicit/ancf_chain.hpp"
#include "models/implicit/block_tridiagonal.hpp"
#include "models/implicit/chain_motion.hpp"
#include "models/implicit/radau_stages.hpp"
#include "tests/models/reference/impact_run.hpp"
#include "tests/models/scenes.hpp"

namespace impactrig::tests {
namespace {

using namespace models;

TEST(RadauRule, IntegratesPolynomialsAndEndsWithTheStep) {
  for (const int s : {1, 2, 4, 8, 12}) {
    const Collocation& rule = Collocation::of(s, Collocation::Nodes::radau);
    EXPECT_DOUBLE_EQ(rule.points()[s - 1], 1.0);
    for (int degree = 0; degree <= 2 * s - 2; ++degree) {
      const double sum = (rule.weights().array() * rule.points().array().pow(degree)).sum();
      EXPECT_NEAR(sum, 1.0 / (degree + 1.0), 1e-14) << s << " nodes, degree " << degree;
    }
    // degree 2s − 1 is beyond it
    const double sum = (rule.weights().array() * rule.points().array().pow(2 * s - 1)).sum();
    if (s <= 8) {
      EXPECT_GT(std::abs(sum - 0.5 / s), 1e-13);
    }
  }
}

TEST(RadauRule, RungeKuttaMatrixIsThePublishedOne) {
  // Radau IIA of order 5 [HairerWanner1996, table IV.5.6]
  const Collocation& rule = Collocation::of(3, Collocation::Nodes::radau);
  const double root = std::sqrt(6.0);
  EXPECT_NEAR(rule.points()[0], (4.0 - root) / 10.0, 1e-15);
  EXPECT_NEAR(rule.points()[1], (4.0 + root) / 10.0, 1e-15);
  const NodeMatrix a = rule.integration();
  EXPECT_NEAR(a(0, 0), (88.0 - 7.0 * root) / 360.0, 1e-15);
  EXPECT_NEAR(a(0, 1), (296.0 - 169.0 * root) / 1800.0, 1e-15);
  EXPECT_NEAR(a(0, 2), (-2.0 + 3.0 * root) / 225.0, 1e-15);
  EXPECT_NEAR(a(2, 0), (16.0 - root) / 36.0, 1e-15);
  EXPECT_NEAR(a(2, 2), 1.0 / 9.0, 1e-15);
}

template <int S>
void expect_apart_as_together() {
  const RadauStages<S>& stages = RadauStages<S>::get();
  Eigen::Matrix<double, S, S> matrix = Eigen::Matrix<double, S, S>::Zero();
  for (int j = 0; j < S / 2; ++j) {
    const auto re = stages.eigenvalues[j].real() * stages.into_re.row(j) -
                    stages.eigenvalues[j].imag() * stages.into_im.row(j);
    const auto im = stages.eigenvalues[j].real() * stages.into_im.row(j) +
                    stages.eigenvalues[j].imag() * stages.into_re.row(j);
    matrix += stages.out_re.col(j) * re - stages.out_im.col(j) * im;
  }
  EXPECT_LT((matrix - stages.to_velocity).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(RadauStages, PairsMakeUpTheMatrix) {
  expect_apart_as_together<4>();
  expect_apart_as_together<8>();
}

/// A positive definite chain of random blocks.
ChainMatrix random_chain(std::size_t nodes, double diagonal) {
  ChainMatrix chain(nodes);
  for (Eigen::Matrix4d& block : chain.diagonal) {
    const Eigen::Matrix4d r = Eigen::Matrix4d::Random();
    block = r * r.transpose() + diagonal * Eigen::Matrix4d::Identity();
  }
  for (Eigen::Matrix4d& block : chain.next) block = Eigen::Matrix4d::Random();
  return chain;
}

Eigen::MatrixXd dense(const ChainMatrix& chain) {
  const auto n = static_cast<Eigen::Index>(chain.diagonal.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(4 * n, 4 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    matrix.block<4, 4>(4 * i, 4 * i) = chain.diagonal[static_cast<std::size_t>(i)];
    if (i + 1 == n) continue;
    matrix.block<4, 4>(4 * i, 4 * i + 4) = chain.next[static_cast<std::size_t>(i)];
    matrix.block<4, 4>(4 * i + 4, 4 * i) = chain.next[static_cast<std::size_t>(i)].transpose();
  }
  return matrix;
}

TEST(BlockTridiagonal, SolvesAsADenseMatrixDoes) {
  std::srand(5);
  constexpr std::size_t nodes = 7;
  const ChainMatrix mass = random_chain(nodes, 5.0), stiffness = random_chain(nodes, 4.0);
  const Eigen::Matrix4d first = random_chain(1, 0.0).diagonal[0];
  BlockTridiagonal<2>::Shares shares;
  const std::complex<double> k[2] = {{0.3, 2.0}, {40.0, -7.0}};
  for (int j = 0; j < 2; ++j) {
    shares.mass.re[j] = 1.0;
    shares.stiffness.re[j] = k[j].real();
    shares.stiffness.im[j] = k[j].imag();
    shares.first_node.im[j] = 0.5;
  }
  BlockTridiagonal<2> systems(nodes);
  systems.factor(mass, stiffness, first, shares);
  std::vector<ComplexLanes<2>> x(4 * nodes);
  const Eigen::VectorXd right = Eigen::VectorXd::Random(4 * nodes);
  for (std::size_t i = 0; i < x.size(); ++i) x[i].re.setConstant(right[static_cast<int>(i)]);
  systems.solve_in_place(x);
  for (int j = 0; j < 2; ++j) {
    Eigen::MatrixXcd matrix = dense(mass) + k[j] * dense(stiffness);
    matrix.topLeftCorner<4, 4>() += std::complex<double>(0.0, 0.5) * first;
    const Eigen::VectorXcd expected =
        matrix.partialPivLu().solve(right.cast<std::complex<double>>());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::complex<double> found(x[i].re[j], x[i].im[j]);
      EXPECT_LT(std::abs(found - expected[static_cast<int>(i)]), 1e-12);
    }
  }
}

/// A bar with everything the chain knows, bent, stretched and moving.
struct BentBar {
  BentBar() {
    rig.gravity = 9.81;
    rig.beam.masses = {{0.5, 0.3}};
    rig.beam.damping = {.mass = 3.0, .stiffness = 1e-5};
    rig.hinge = {.spring = 400.0, .viscous = 2.0};
    std::srand(3);
    q = Eigen::VectorXd::Zero(beam().size());
    v = Eigen::VectorXd::Zero(beam().size());
    beam().set_rigid_motion(0.4, 1.5, q, v);
    q += 0.01 * Eigen::VectorXd::Random(q.size());
    v += 0.5 * Eigen::VectorXd::Random(q.size());
  }

  AncfBeam& beam() {
    if (!made) made = std::make_unique<AncfBeam>(rig, std::array<int, 2>{4, 2});
    return *made;
  }

  Rig rig = paper_rig();
  std::unique_ptr<AncfBeam> made;
  Eigen::VectorXd q, v;
};

/// Stages that differ, each accelerated as the bar is in its place.
template <int S>
void expect_balanced_stages() {
  BentBar bent;
  bent.rig.beam.damping = {};
  bent.rig.hinge.viscous = 0.0;
  AncfBeam& beam = bent.beam();
  const AncfChain chain(beam);
  StageArray<S> q(S, chain.coordinates()), a = q, residual = q, without = q;
  Eigen::ArrayXd nodes;
  for (int i = 0; i < S; ++i) {
    const Eigen::VectorXd stage = (1.0 - 0.1 * i) * bent.q,
                          rest = Eigen::VectorXd::Zero(beam.size());
    Eigen::VectorXd acceleration(beam.size());
    beam.acceleration(stage, rest, 0.0, acceleration);
    chain.from_beam(stage, nodes);
    q.row(i) = nodes.transpose();
    chain.from_beam(acceleration, nodes);
    a.row(i) = nodes.transpose();
  }
  chain.residual<S>(q, a, residual);
  chain.residual<S>(q, StageArray<S>::Zero(S, chain.coordinates()), without);
  for (int i = 0; i < S; ++i)
    EXPECT_LT(residual.row(i).abs().maxCoeff(), 1e-11 * without.row(i).abs().maxCoeff()) << i;
}

TEST(AncfChain, BalancesEveryStageByItself) {
  expect_balanced_stages<4>();
  expect_balanced_stages<8>();
}

TEST(AncfChain, IsTheBarNodeByNode) {
  BentBar bar;
  const AncfChain chain(bar.beam());
  Eigen::VectorXd a(bar.q.size());
  bar.beam().acceleration(bar.q, bar.v, 0.0, a);
  Eigen::ArrayXd node_q, node_v, node_a;
  chain.from_beam(bar.q, node_q);
  chain.from_beam(bar.v, node_v);
  chain.from_beam(a, node_a);
  StageArray<4> q(4, chain.coordinates()), v = q, x = q, residual = q, without = q;
  for (int i = 0; i < 4; ++i) {
    q.row(i) = node_q.transpose();
    v.row(i) = node_v.transpose();
    x.row(i) = node_a.transpose();
  }
  chain.residual<4>(q, x, residual);
  const double size = residual.abs().maxCoeff();
  chain.add_damping<4>(q, v, residual);
  EXPECT_LT(residual.abs().maxCoeff(), 1e-11 * size);
  x.setZero();
  chain.residual<4>(q, x, without);
  EXPECT_GT(without.abs().maxCoeff(), 1e-3 * size);
  const BeamEnergy of_beam = bar.beam().energy(bar.q, bar.v);
  const BeamEnergy of_chain = chain.energy(node_q, node_v);
  EXPECT_NEAR(of_chain.kinetic, of_beam.kinetic, 1e-12 * of_beam.kinetic);
  EXPECT_NEAR(of_chain.elastic, of_beam.elastic, 1e-12 * of_beam.elastic);
  EXPECT_NEAR(of_chain.spring, of_beam.spring, 1e-12 * of_beam.spring);
  EXPECT_NEAR(of_chain.gravitational, of_beam.gravitational, 1e-12);
}

TEST(AncfChain, StiffnessIsTheDerivativeOfItsForces) {
  BentBar bar;
  bar.rig.hinge = {};
  bar.made.reset();
  const AncfChain chain(bar.beam());
  Eigen::ArrayXd node_q;
  chain.from_beam(bar.q, node_q);
  ChainMatrix k(static_cast<std::size_t>(chain.nodes()));
  chain.stiffness(node_q, k);
  const Eigen::MatrixXd matrix = dense(k);
  constexpr double step = 1e-6;
  StageArray<4> q(4, chain.coordinates()), zero = StageArray<4>::Zero(4, chain.coordinates());
  StageArray<4> force = zero;
  for (int c = 0; c < chain.coordinates(); ++c) {
    if (c == 0 || c == 2) continue;  // the hinge holds these
    for (int i = 0; i < 4; ++i) q.row(i) = node_q.transpose();
    q(0, c) += step;
    q(1, c) -= step;
    chain.residual<4>(q, zero, force);
    const Eigen::VectorXd difference = (force.row(0) - force.row(1)).transpose() / (2.0 * step);
    EXPECT_LT((difference - matrix.col(c)).norm(), 1e-6 * matrix.col(c).norm()) << c;
  }
}

/// Struck point of a soft bar after a free flight with large rotation in steps of one length.
double flown_with(int halvings, double accuracy) {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.beam.youngs_modulus = 1e6;
  rig.contact.law = "none";
  Solver solver = ancf(2, 1, accuracy, 1.0);
  const std::unique_ptr<BarMotion> bar = make_ancf_motion(rig, solver, {});
  bar->start(-0.5, 0.0);
  bar->set_scales({.energy = 1e-12});  // so small an energy makes Newton exact to rounding
  StopStep step;
  step.force = step.force_series = NodeVector::Zero(bar->rule().nodes());
  const int level = 12 + 2 * halvings;
  for (double left = 0.25; left > 1e-9; left -= bar->ladder().length_of(level)) {
    bar->begin_step(level);
    do {
      if (!bar->improve({&step, 1})) return std::nan("");
    } while (!bar->settled());
    bar->finish({&step, 1});
    bar->take(1.0);
  }
  return bar->struck(0).displacement;
}

TEST(AncfMotion, HasTheOrderOfRadauInPosition) {
  // four stages, order 7; Newton's tolerance is kept out of the way by the accuracy asked for,
  // which chooses eight stages below 1e-5: the order of those is too high to be seen
  const double finest = flown_with(5, 1e-12);
  double before = 0.0;
  for (const int halvings : {2, 3, 4}) {
    const double error = std::abs(flown_with(halvings, 1.1e-5) - finest);
    if (halvings > 2) {
      EXPECT_GT(std::log2(before / error), 6.5) << halvings;
    }
    before = error;
  }
  EXPECT_LT(before, 1e-12);
}

TEST(AncfMotion, AgreesWithDop853InFullEquations) {
  // stiff and soft, with damping, hinge and mass, and with a bar that bends by a tenth of its
  // length
  struct Scene {
    double modulus, speed, duration;
    bool everything;
  };

  for (const Scene& scene : {Scene{6.8952e10, 0.441, 1e-3, false},
                             Scene{6.8952e10, 0.441, 1e-3, true}, Scene{5e7, 5.0, 2e-2, false}}) {
    Rig rig = paper_rig();
    rig.gravity = 9.81;
    rig.contact.damping = "lankarani-nikravesh";
    rig.contact.restitution = 0.6;
    rig.beam.youngs_modulus = scene.modulus;
    rig.start.velocity = scene.speed;
    if (scene.everything) {
      rig.beam.masses = {{0.5, 0.3}, {0.8, 0.1}};
      rig.beam.damping = {.mass = 3.0, .stiffness = 1e-7};
      rig.hinge = {.spring = 400.0, .viscous = 2.0};
    }
    const Solver solver = ancf(5, 2, 1e-8, scene.duration);
    SimulationOptions options;
    options.motion = Motion::full;
    const Simulation radau = simulate(rig, solver, options);
    Solver tighter = solver;
    tighter.accuracy = 1e-10;
    AncfBeam beam(rig, solver.elements);
    const Simulation dop = ImpactRun(rig, tighter, options, beam).simulate();
    ASSERT_EQ(radau.episodes.size(), dop.episodes.size());
    // the first contact keeps the accuracy asked for; later ones inherit the errors before them
    const Episode& found = radau.episodes.front();
    const Episode& expected = dop.episodes.front();
    EXPECT_NEAR(found.peak_force / expected.peak_force, 1.0, 1e-8);
    EXPECT_NEAR(found.impulse / expected.impulse, 1.0, 1e-8);
    EXPECT_NEAR(found.end / expected.end, 1.0, 1e-8);
    EXPECT_LT(std::abs(radau.energy.imbalance), 1e-7);
  }
}

// Flights may leave out what the next contact hardly feels of the bar's vibration; each contact
// magnifies the errors of those before it.
TEST(AncfMotion, ContactsAfterFlightsAreAsAccurateAsAskedFor) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  rig.gravity = 9.81;
  SimulationOptions options;
  options.motion = Motion::full;
  const Simulation run = simulate(rig, ancf(7, 1, 1e-3, 1.0), options);
  const Simulation finer = simulate(rig, ancf(7, 1, 1e-6, 1.0), options);
  ASSERT_EQ(run.episodes.size(), finer.episodes.size());
  ASSERT_GE(run.episodes.size(), 5U);
  for (std::size_t i = 0; i < run.episodes.size(); ++i)
    EXPECT_NEAR(run.episodes[i].impulse / finer.episodes[i].impulse, 1.0, 1e-3) << i;
}

TEST(AncfMotion, NeedsNoMoreStepsForFinerMeshes) {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  SimulationOptions exact;
  exact.exact = true;
  const Simulation coarse = simulate(rig, ancf(56, 8, 1e-3, 5e-4), exact);
  const Simulation fine = simulate(rig, ancf(448, 64, 1e-3, 5e-4), exact);
  EXPECT_LT(fine.cost.steps, 1.5 * static_cast<double>(coarse.cost.steps));
  EXPECT_NEAR(fine.peak_force / coarse.peak_force, 1.0, 0.01);
}

}  // namespace
}  // namespace impactrig::tests
