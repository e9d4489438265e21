// SPDX-License-Identifier: BSD-3-Clause
// Bars of segments: closed forms, transfer matrices, and the uniform bar they may be.
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <functional>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "models/beams/ancf.hpp"
#include "models/beams/assumed_modes.hpp"
#include "models/beams/bending_modes.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/integration/gauss.hpp"
#include "models/mesh_error.hpp"
#include "models/modal/modal_beam.hpp"
#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using testing::ThrowsMessage;

BeamSegment round(double length, double radius) {
  return {.length = length,
          .area = std::numbers::pi * radius * radius,
          .second_moment = std::numbers::pi * std::pow(radius, 4) / 4.0,
          .shear_coefficient = 0.886};
}

/// Aluminium of 30 mm, 300 mm long, then steel of 20 mm, then aluminium again.
Rig stepped(BeamTheory theory) {
  Rig rig = paper_rig();
  rig.beam.theory = theory;
  rig.beam.segments = {round(0.3, 0.015), round(0.25, 0.01), round(0.25, 0.012)};
  rig.beam.segments[1].youngs_modulus = 2.1e11;
  rig.beam.segments[1].density = 7850.0;
  return rig;
}

Rig stepped() {
  return stepped(BeamTheory::euler_bernoulli);
}

LinearBar mesh(const Rig& rig, int elements) {
  return LinearBar(rig, bar_elements(rig.beam, rig.beam.length, {elements, 0}));
}

/// An integral over the bar, f(x, piece), piece by piece.
double integral(const Beam& beam, const std::function<double(double, const BarElement&)>& f) {
  const GaussRule& rule = gauss_legendre(6);
  double sum = 0.0;
  for (const BarElement& piece : bar_pieces(beam))
    for (std::size_t g = 0; g < rule.points.size(); ++g)
      sum += piece.length * rule.weights[g] * f(piece.x + rule.points[g] * piece.length, piece);
  return sum;
}

TEST(SteppedBar, HasTheMomentsOfItsSegments) {
  for (const BeamTheory theory : {BeamTheory::euler_bernoulli, BeamTheory::timoshenko}) {
    Beam beam = stepped(theory).beam;
    beam.masses = {{0.7, 0.2}};
    const double area[3] = {beam.segments[0].area, beam.segments[1].area, beam.segments[2].area};
    const double mass = 2766.7 * (0.3 * area[0] + 0.25 * area[2]) + 7850.0 * 0.25 * area[1];
    EXPECT_NEAR(beam.bar_mass() / mass, 1.0, 1e-14);
    const auto line = [](double, const BarElement& piece) { return piece.line_density; };
    EXPECT_NEAR(integral(beam, line) / mass, 1.0, 1e-14);
    const auto first = [&](double x, const BarElement& p) { return x * line(x, p); };
    EXPECT_NEAR(beam.first_moment() / (integral(beam, first) + 0.14), 1.0, 1e-14);
    const auto second = [&](double x, const BarElement& p) {
      return x * x * line(x, p) + p.rotary_inertia;
    };
    EXPECT_NEAR(beam.hinge_inertia() / (integral(beam, second) + 0.098), 1.0, 1e-14);
  }
}

TEST(SteppedBar, OfEqualSegmentsIsTheUniformBar) {
  for (const BeamTheory theory : {BeamTheory::euler_bernoulli, BeamTheory::timoshenko}) {
    Rig uniform = paper_rig();
    uniform.gravity = 9.81;
    uniform.contact.position = 0.6;
    uniform.beam.theory = theory;
    uniform.beam.shear_coefficient = 0.886;
    uniform.beam.masses = {{0.4, 0.1}};
    Rig segments = uniform;
    segments.beam.segments = {round(0.3, 0.015), round(0.5, 0.015)};
    EXPECT_NEAR(elastic_compliance(segments.beam, 0.6) / elastic_compliance(uniform.beam, 0.6), 1.0,
                1e-13);
    // a node of the uniform mesh is where the segments meet
    SimulationOptions linear;
    linear.motion = Motion::small;
    const Simulation one = simulate(uniform, ancf(12, 4, 1e-5, 2e-3), linear);
    const Simulation two = simulate(segments, ancf(12, 4, 1e-5, 2e-3), linear);
    EXPECT_NEAR(two.peak_force / one.peak_force, 1.0, 1e-9);
    EXPECT_NEAR(two.episodes[0].end / one.episodes[0].end, 1.0, 1e-9);
    EXPECT_NEAR(two.neglected / one.neglected, 1.0, 1e-6);
    SimulationOptions exact;
    exact.exact = true;
    const Simulation slow = simulate(uniform, ancf(6, 2, 1e-5, 1e-3), exact);
    const Simulation same = simulate(segments, ancf(6, 2, 1e-5, 1e-3), exact);
    EXPECT_NEAR(same.peak_force / slow.peak_force, 1.0, 1e-9);
    // modes from a mesh and from closed forms
    const Simulation closed = simulate(uniform, hybrid(Basis::pinned_free, 7, 1e-6, 1e-3));
    const Simulation meshed = simulate(segments, hybrid(Basis::pinned_free, 7, 1e-6, 1e-3));
    EXPECT_NEAR(meshed.peak_force / closed.peak_force, 1.0, 1e-4);
  }
}

// P on the tip of a cantilever: ∫ (L − x)² / EI + 1 / κGA dx.
TEST(SteppedBar, ATipLoadBendsACantileverAsTheClosedFormSays) {
  for (const BeamTheory theory : {BeamTheory::euler_bernoulli, BeamTheory::timoshenko}) {
    const Rig rig = stepped(theory);
    double expected = 0.0;
    for (const BarElement& piece : bar_pieces(rig.beam)) {
      const double far = 0.8 - piece.x, near = far - piece.length;
      expected += (std::pow(far, 3) - std::pow(near, 3)) / (3.0 * piece.bending_stiffness) +
                  piece.length * piece.shear_compliance;
    }
    for (const int elements : {3, 8}) {
      const LinearBar bar = mesh(rig, elements);
      const Eigen::MatrixXd k = bar.small_motion().stiffness;
      const Eigen::Index n = k.rows() - 1;
      const Eigen::Index tip = bar.places(bar.elements().size() - 1)[2] - 1;
      const Eigen::VectorXd load = Eigen::VectorXd::Unit(n, tip);
      EXPECT_NEAR(k.bottomRightCorner(n, n).lu().solve(load)[tip] / expected, 1.0, 1e-11);
    }
  }
}

/// Bending moment and shear force at the tip of a bar pinned at the hinge, from its rotation and
/// force there: (w, θ, M, Q)' = A (w, θ, M, Q) in each piece. The determinant of the two.
double free_end(const Beam& beam, double omega) {
  const double square = omega * omega;
  Eigen::Matrix4d transfer = Eigen::Matrix4d::Identity();
  for (const BarElement& piece : bar_pieces(beam)) {
    Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
    a(0, 1) = 1.0;
    a(0, 3) = piece.shear_compliance;
    a(1, 2) = 1.0 / piece.bending_stiffness;
    a(2, 1) = -piece.rotary_inertia * square;
    a(2, 3) = -1.0;
    a(3, 0) = -piece.line_density * square;
    // in units that make the entries alike
    const Eigen::Vector4d unit(1.0, 1.0, 1e4, 1e4);
    const Eigen::Matrix4d scaled =
        unit.cwiseInverse().asDiagonal() * a * unit.asDiagonal() * piece.length;
    transfer = (scaled.exp() * transfer).eval();
  }
  return transfer(2, 1) * transfer(3, 3) - transfer(2, 3) * transfer(3, 1);
}

std::vector<double> frequencies(const Beam& beam, std::size_t count) {
  std::vector<double> roots;
  const double step = 10.0;
  for (double low = step; roots.size() < count; low += step) {
    if (free_end(beam, low) * free_end(beam, low + step) > 0.0) continue;
    double a = low, b = low + step;
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (a + b);
      (free_end(beam, a) * free_end(beam, middle) > 0.0 ? a : b) = middle;
    }
    roots.push_back(a);
  }
  return roots;
}

TEST(SteppedBar, HasTheFrequenciesOfItsTransferMatrix) {
  EXPECT_NEAR(frequencies(paper_rig().beam, 1)[0] /
                  BendingMode(paper_rig().beam, Basis::pinned_free, 1).angular_frequency(),
              1.0, 1e-10);
  for (const BeamTheory theory : {BeamTheory::euler_bernoulli, BeamTheory::timoshenko}) {
    const Rig rig = stepped(theory);
    const std::vector<double> exact = frequencies(rig.beam, 4);
    const LinearBar coarse = mesh(rig, 15), fine = mesh(rig, 30);
    const ModalBeam few(coarse, rig), many(fine, rig);
    const AssumedModes modes(rig.beam, Basis::pinned_free, 4);
    const FloatingFrameBeam frame(rig, Basis::pinned_free, 4, 0);
    const ModalBeam turned(frame, rig);
    for (int k = 1; k <= 4; ++k) {
      const double omega = exact[static_cast<std::size_t>(k) - 1];
      const double error = many.omega()[k] / omega - 1.0;
      EXPECT_LT(error, 1e-4) << k;
      EXPECT_NEAR(modes.omega()[k - 1] / omega, 1.0, 1e-4) << k;
      EXPECT_NEAR(turned.omega()[k] / omega, 1.0, 1e-4) << k;
      if (error < 1e-6) continue;  // its digits are rounding
      EXPECT_NEAR((few.omega()[k] / omega - 1.0) / error, 16.0, 3.0) << k;
    }
  }
}

TEST(SteppedBar, SwingsAsAPendulum) {
  Rig rig = stepped();
  rig.gravity = 9.81;
  const double omega = std::sqrt(9.81 * rig.beam.first_moment() / rig.beam.hinge_inertia());
  const LinearBar bar = mesh(rig, 24);
  const FloatingFrameBeam frame(rig, Basis::cantilever, 4, 0);
  EXPECT_NEAR(ModalBeam(bar, rig).omega()[0] / omega, 1.0, 3e-5);
  EXPECT_NEAR(ModalBeam(frame, rig).omega()[0] / omega, 1.0, 3e-5);
  // both take from the weight what bending lifts: they agree better
  EXPECT_NEAR(ModalBeam(bar, rig).omega()[0] / ModalBeam(frame, rig).omega()[0], 1.0, 1e-8);
}

TEST(SteppedBar, DeflectsAsTheSumOfItsModes) {
  for (const BeamTheory theory : {BeamTheory::euler_bernoulli, BeamTheory::timoshenko}) {
    Rig rig = stepped(theory);
    rig.beam.masses = {{0.55, 0.3}};  // on a node
    const LinearBar bar(rig, bar_elements(rig.beam, rig.contact.position, {60, 12}));
    const ModalBeam modes(bar, rig);
    double sum = 0.0;
    for (int k = 1; k < modes.modes(); ++k)
      sum += std::pow(modes.struck()[k] / modes.omega()[k], 2);
    EXPECT_NEAR(elastic_compliance(rig.beam, rig.contact.position) / sum, 1.0, 1e-6);
  }
}

// ½ ∫ u̇² dm of the first mode moving through a deflection, u̇ = ∫ w' ẇ' dξ.
TEST(SteppedBar, ShortensAsItsMassSays) {
  const Rig rig = stepped();
  const LinearBar bar = mesh(rig, 48);
  const ModalBeam modes(bar, rig);
  Eigen::VectorXd a = Eigen::VectorXd::Zero(modes.modes());
  a[1] = 1.0;
  const auto deflection = [&](double x) { return modes.point(x)[1]; };
  double drawn = 0.0, energy = 0.0;
  const int panels = 1600;
  const double h = 0.8 / panels;
  const std::vector<BarElement> pieces = bar_pieces(rig.beam);
  for (int i = 0; i < panels; ++i) {
    const double slope = (deflection((i + 1) * h) - deflection(i * h)) / h;
    const double step = slope * slope * h;
    energy += 0.5 * mass_between(pieces, i * h, (i + 1) * h) * std::pow(drawn + 0.5 * step, 2);
    drawn += step;
  }
  BarStations::Slopes slopes;
  modes.stations().find_slopes(a, a, slopes);
  Eigen::VectorXd momentum;
  EXPECT_NEAR(modes.stations().shorten(slopes, momentum) / energy, 1.0, 0.02);
}

TEST(SteppedBar, ElementsOfTheFullEquationsAreThoseOfSmallMotion) {
  const Rig rig = stepped();
  AncfBeam beam(rig, {7, 2});
  const SmallMotion motion = beam.small_motion();
  const Eigen::Index n = motion.rigid.size();
  std::srand(5);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(2 * n), v = q, a = q;
  q.head(n) = 1e-7 * Eigen::VectorXd::Random(n);
  beam.acceleration(q, v, 0.0, a);
  const Eigen::VectorXd expected = -(motion.stiffness * q.head(n));
  EXPECT_LT((motion.mass * a.head(n) - expected).norm(), 1e-8 * expected.norm());
}

TEST(SteppedBar, FullEquationsKeepTheEnergyAndAgreeWithSmallMotion) {
  const Rig rig = stepped();
  SimulationOptions exact;
  exact.exact = true;
  for (const Solver& solver :
       {ancf(12, 2, 1e-6, 1e-3), hybrid(Basis::pinned_free, 8, 1e-6, 1e-3)}) {
    const Simulation full = simulate(rig, solver, exact);
    EXPECT_LT(std::abs(full.energy.imbalance), 1e-6);
    SimulationOptions linear;
    linear.motion = Motion::small;
    const Simulation small = simulate(rig, solver, linear);
    EXPECT_NEAR(full.peak_force / small.peak_force, 1.0, 1e-4);
    Rig damped = rig;
    damped.beam.damping = {.mass = 3.0, .stiffness = 2e-6};
    const Simulation slowed = simulate(damped, solver, exact);
    EXPECT_LT(std::abs(slowed.energy.imbalance), 1e-6);
    EXPECT_GT(slowed.energy.damped, 0.01 * slowed.energy.initial);
  }
}

TEST(SteppedBar, HasElementsThatEndWhereItChanges) {
  const Rig rig = stepped();  // struck at 0.69 m
  EXPECT_EQ(fewest_elements(rig.beam, 0.69), (std::array{3, 1}));
  EXPECT_EQ(fewest_elements(rig.beam, 0.3), (std::array{1, 2}));
  EXPECT_EQ(fewest_elements(rig.beam, 0.3 + 1e-16), (std::array{1, 2}));
  EXPECT_EQ(fewest_elements(rig.beam, 0.8), (std::array{3, 0}));
  const double tip = std::nextafter(0.8, 0.0);  // to rounding
  EXPECT_EQ(fewest_elements(rig.beam, tip), (std::array{3, 0}));
  Rig struck_at_tip = rig;
  struck_at_tip.contact.position = tip;
  EXPECT_EQ(split_elements(16, struck_at_tip), (std::array{16, 0}));
  validate(struck_at_tip, ancf(16, 0, 1e-6, 1e-3));
  EXPECT_THROW(validate(struck_at_tip, ancf(14, 2, 1e-6, 1e-3)), std::invalid_argument);
  const std::vector<BarElement> elements = bar_elements(rig.beam, 0.69, {17, 3});
  ASSERT_EQ(elements.size(), 20u);
  EXPECT_NEAR(elements[17].x, 0.69, 1e-15);
  for (const double step : {0.3, 0.55, 0.69})
    EXPECT_TRUE(std::ranges::any_of(elements, [&](const BarElement& element) {
      return std::abs(element.x - step) < 1e-14;
    })) << step;
  for (int total : {1, 2, 8, 16}) {
    const auto [before, beyond] = split_elements(total, rig);
    EXPECT_GE(before, 3);
    EXPECT_GE(beyond, 1);
    EXPECT_EQ(before + beyond, std::max(total, 4));
  }
  const std::optional<MeshError> error = mesh_error(rig, ancf(14, 3, 1e-6, 1e-3), 10.0);
  ASSERT_TRUE(error);
  EXPECT_LT(error->largest(), 0.02);
}

TEST(Validate, RefusesSegmentsThatCannotBe) {
  const auto message = [](const std::function<void(Rig&, Solver&)>& spoil) -> std::string {
    Rig rig = stepped(BeamTheory::timoshenko);
    Solver solver;
    validate(rig, solver);
    spoil(rig, solver);
    try {
      validate(rig, solver);
    } catch (const std::invalid_argument& problem) {
      return problem.what();
    }
    return "";
  };
  EXPECT_EQ(message([](Rig& r, Solver&) { r.beam.segments[1].length = 0.0; }),
            "beam.segments.2.length: must be greater than zero, found 0 m");
  EXPECT_EQ(message([](Rig& r, Solver&) { r.beam.segments[2].area = -1.0; }),
            "beam.segments.3.section (area): must be greater than zero, found -1 m^2");
  EXPECT_EQ(message([](Rig& r, Solver&) { r.beam.segments[2].shear_coefficient = 0.0; }),
            "beam.segments.3.shear_coefficient: must be greater than zero, found 0");
  EXPECT_EQ(message([](Rig& r, Solver&) { r.beam.segments[1].density = 0.0; }),
            "beam.segments.2.density: must be greater than zero, found 0 kg/m^3");
  EXPECT_EQ(message([](Rig& r, Solver&) { r.beam.segments.pop_back(); }),
            "beam.length: the bar is 0.8 m long, its segments are together 0.55 m");
  EXPECT_EQ(message([](Rig&, Solver& s) {
              s.elements = {2, 2};
            }),
            "solver.elements: elements end where the bar changes: hinge to struck point needs at "
            "least 3, struck point to tip 1, found [2, 2]");
  EXPECT_EQ(message([](Rig&, Solver& s) {
              s.model = BeamModel::hybrid;
              s.axial_modes = 1;
            }),
            "solver.axial_modes: axial shapes are those of a uniform bar, this one has segments: "
            "must be 0, found 1; ANCF elements stretch");
}

}  // namespace
