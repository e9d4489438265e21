// SPDX-License-Identifier: BSD-3-Clause
// The geometrically exact bar that shears: its small motion, its equilibria in closed form and by
// shooting, what a rotation leaves alone, and impacts against an explicit integrator.
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <boost/numeric/odeint.hpp>
#include <complex>
#include <memory>
#include <random>

#include "models/beams/ancf.hpp"
#include "models/beams/reissner_beam.hpp"
#include "models/implicit/reissner_chain.hpp"
#include "models/simulation.hpp"
#include "tests/models/elastica.hpp"
#include "tests/models/reference/impact_run.hpp"
#include "tests/models/scenes.hpp"
#include "tests/models/timoshenko_bar.hpp"
#include "tests/models/virtual_work.hpp"
#include "tests/support/convergence_study.hpp"

namespace impactrig::tests {
namespace {

using namespace models;
using Element = ReissnerElement;
using Values = Element::Values<double>;

constexpr double pi = std::numbers::pi;

Values random_values(unsigned seed, double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-size, size);
  Values values;
  for (double& value : values) value = unit(random);
  return values;
}

Element thick_element() {
  return Element({.length = 0.7,
                  .axial_stiffness = 40.0,
                  .bending_stiffness = 3.0,
                  .line_density = 2.0,
                  .shear_compliance = 0.07,
                  .rotary_inertia = 0.15});
}

Eigen::Map<const Element::Vector> vector(const Values& values) {
  return Eigen::Map<const Element::Vector>(values.data());
}

/// The element after its bar has turned about the hinge by an angle, opening.
Values turned(const Element& element, const Values& p, double angle) {
  Values t = p;
  const auto turn = [&](std::size_t place, double straight) {
    const double along = p[place + Element::u0] - straight;  // Y
    t[place] = std::cos(angle) * p[place] - std::sin(angle) * along;
    t[place + Element::u0] = straight + std::cos(angle) * along + std::sin(angle) * p[place];
  };
  turn(Element::x0, element.bar().x);
  turn(Element::x1, element.bar().x + element.bar().length);
  turn(Element::xa, 0.0);
  turn(Element::xc, 0.0);
  t[Element::turn0] += angle;
  t[Element::turn1] += angle;
  return t;
}

TEST(ReissnerElement, ForcesAndStiffnessAreDerivatives) {
  const Element element = thick_element();
  const Values p = random_values(3, 0.5);
  const Element::Matrix k = element.stiffness(p);
  Values force{};
  element.add_elastic_force<double>(p, force);
  const double step = 1e-5;
  for (std::size_t i = 0; i < Element::values; ++i) {
    Values more = p, less = p, force_more{}, force_less{};
    more[i] += step;
    less[i] -= step;
    const double slope =
        (element.elastic_energy(more) - element.elastic_energy(less)) / (2.0 * step);
    EXPECT_NEAR(force[i], slope, 1e-7);
    element.add_elastic_force<double>(more, force_more);
    element.add_elastic_force<double>(less, force_less);
    const Element::Vector column = (vector(force_more) - vector(force_less)) / (2.0 * step);
    EXPECT_LT((column - k.col(static_cast<int>(i))).norm(), 1e-8 * k.norm()) << i;
  }
}

TEST(ReissnerElement, ARotationLeavesStrainsDampingAndKineticEnergyAlone) {
  Element element = thick_element();
  const Values p = random_values(4, 0.3), straight{};
  for (const double angle : {1e-3, 0.7, 3.0, -20.0}) {
    EXPECT_NEAR(element.elastic_energy(turned(element, p, angle)) / element.elastic_energy(p), 1.0,
                1e-12);
    EXPECT_LT(element.elastic_energy(turned(element, straight, angle)), 1e-29);
    // rates of the rotation: damping does not brake it
    const double step = 1e-5;
    const Values next = turned(element, p, angle + step), last = turned(element, p, angle - step);
    const Values here = turned(element, p, angle);
    Values rates, braked{}, other{};
    for (std::size_t i = 0; i < Element::values; ++i) rates[i] = (next[i] - last[i]) / (2.0 * step);
    element.add_damping_force<double>(0.1, here, rates, braked);
    element.add_damping_force<double>(0.1, here, random_values(5, 1.0), other);
    EXPECT_LT(vector(braked).norm(), 1e-8 * vector(other).norm());
  }
}

// Of a bar without strain, turned as it may be, the power is τ Σ ∫ stiffness times strain rate
// squared = τ v' K v; of a strained one it is bounded by Schwarz: (dU/dt)² <= 2 U power / τ.
TEST(ReissnerElement, DampingTakesThePowerOfItsStrainRates) {
  const Element element = thick_element();
  const Values rates = random_values(6, 1.0);
  const auto power = [&](const Values& p) {
    Values force{};
    element.add_damping_force<double>(0.1, p, rates, force);
    return vector(force).dot(vector(rates));
  };
  for (const double angle : {0.0, 0.7, -3.0}) {
    const Values p = turned(element, {}, angle);
    EXPECT_NEAR(power(p) / (0.1 * vector(rates).dot(element.stiffness(p) * vector(rates))), 1.0,
                1e-12);
  }
  const Values bent = random_values(7, 0.4);
  Values force{};
  element.add_elastic_force<double>(bent, force);
  const double rate = vector(force).dot(vector(rates));
  EXPECT_LT(rate * rate, 2.0 * element.elastic_energy(bent) * power(bent) / 0.1);
}

/// A cantilever of elements of unit length together, at rest under a dead load and a moment at its
/// tip, by Newton's method.
class Cantilever {
 public:
  Cantilever(const BarElement& bar, int elements) : size_(Element::own * elements + 3) {
    for (int e = 0; e < elements; ++e) {
      BarElement own = bar;
      own.length = 1.0 / elements;
      own.x = e * own.length;
      elements_.emplace_back(own);
    }
    q_ = Vector::Zero(size_);
  }

  struct Tip {
    double across, shortening, turn;
  };

  Tip under(double force, double moment, int steps = 10) {
    for (int step = 1; step <= steps; ++step) solve(force * step / steps, moment * step / steps);
    return {q_[size_ - 3], q_[size_ - 2], q_[size_ - 1]};
  }

 private:
  void solve(double force, double moment) {
    const int held = 3;
    double moved = 1.0;
    for (int iteration = 0; iteration < 50 && moved > 1e-12; ++iteration) {
      Vector residual = Vector::Zero(size_);
      Eigen::MatrixXd tangent = Eigen::MatrixXd::Zero(size_, size_);
      residual[size_ - 3] = -force;
      residual[size_ - 1] = -moment;
      for (std::size_t e = 0; e < elements_.size(); ++e) {
        const int first = Element::own * static_cast<int>(e);
        Values p, share{};
        Element::Vector::Map(p.data()) = q_.segment<Element::values>(first);
        elements_[e].add_elastic_force<double>(p, share);
        residual.segment<Element::values>(first) += vector(share);
        tangent.block<Element::values, Element::values>(first, first) += elements_[e].stiffness(p);
      }
      const int n = size_ - held;
      const Vector change = tangent.bottomRightCorner(n, n).lu().solve(residual.tail(n));
      q_.tail(n) -= change;
      moved = change.cwiseAbs().maxCoeff();
    }
    EXPECT_LT(moved, 1e-9) << "no equilibrium found";
  }

  int size_;
  std::vector<Element> elements_;
  Vector q_;
};

/// EI = 1, EA and κGA as told.
BarElement unit_bar(double stretching, double shearing) {
  return {.length = 1.0,
          .axial_stiffness = stretching,
          .bending_stiffness = 1.0,
          .line_density = 1.0,
          .shear_compliance = 1.0 / shearing,
          .rotary_inertia = 1.0};
}

TEST(ReissnerEquilibrium, ASmallTipLoadBendsAndShearsACantilever) {
  for (const double shearing : {5.0, 1e3, 1e6})
    for (const int elements : {1, 5}) {
      const double load = 1e-5;
      const double expected = load * (1.0 / 3.0 + 1.0 / shearing);
      const double found =
          Cantilever(unit_bar(1e2 * shearing, shearing), elements).under(load, 0.0, 1).across;
      EXPECT_NEAR(found / expected, 1.0, 1e-9) << shearing << ' ' << elements;  // load² beyond
    }
}

// Quadratic Θ is exact; the tip of the half circle is where Gauss points integrate its direction
// to, with order six, however slender the bar.
TEST(ReissnerEquilibrium, AMomentBendsTheBarIntoACircle) {
  for (const double stiffness : {1e1, 1e4, 1e8}) {
    ConvergenceStudy study;
    for (const int elements : {2, 3, 4, 6}) {
      const Cantilever::Tip tip =
          Cantilever(unit_bar(stiffness, 0.4 * stiffness), elements).under(0.0, pi);
      EXPECT_NEAR(tip.turn, pi, 1e-9);
      study.add(1.0 / elements, std::hypot(tip.across - 2.0 / pi, 1.0 - tip.shortening));
    }
    EXPECT_NEAR(study.order(), 6.0, 0.1) << stiffness;
  }
}

/// The bar's continuous equations under a dead load P across the tip, shot from the clamp: κ is
/// sought that leaves no moment at the tip.
Cantilever::Tip shot(double stretching, double shearing, double load) {
  using State = std::array<double, 4>;  // Θ, κ, X, shortening
  const auto end = [&](double curvature) {
    State y{0.0, curvature, 0.0, 0.0};
    const auto slope = [&](const State& s, State& d, double) {
      const double sine = std::sin(s[0]), cosine = std::cos(s[0]);
      const double stretch = load * sine / stretching, shear = load * cosine / shearing;
      const double x = (1.0 + stretch) * sine + shear * cosine;
      const double along = (1.0 + stretch) * cosine - shear * sine;
      d = {s[1], -load * along, x, 1.0 - along};
    };
    boost::numeric::odeint::runge_kutta_fehlberg78<State> stepper;
    const int steps = 200;
    for (int i = 0; i < steps; ++i) stepper.do_step(slope, y, 0.0, 1.0 / steps);
    return y;
  };
  double low = 0.0, high = load;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (end(middle)[1] < 0.0 ? low : high) = middle;
  }
  const State y = end(low);
  return {y[2], y[3], y[0]};
}

// From stubby to a slenderness, length over radius of gyration, of a thousand.
TEST(ReissnerEquilibrium, ConvergesToItsContinuousEquationsWithOrderFourHoweverSlender) {
  const double load = 5.0;
  std::vector<double> errors;  // of four elements
  for (const double stiffness : {30.0, 1e4, 1e6}) {
    const Cantilever::Tip exact = shot(stiffness, 0.4 * stiffness, load);
    ConvergenceStudy place;
    for (const int elements : {4, 6, 8, 12}) {
      const Cantilever::Tip tip =
          Cantilever(unit_bar(stiffness, 0.4 * stiffness), elements).under(load, 0.0);
      place.add(1.0 / elements,
                std::hypot(tip.across - exact.across, tip.shortening - exact.shortening));
      if (elements == 4) errors.push_back(tip.across - exact.across);
    }
    EXPECT_NEAR(place.order(), 4.0, 0.2) << stiffness;
  }
  EXPECT_NEAR(errors[2] / errors[1], 1.0, 0.05);
}

TEST(ReissnerEquilibrium, ApproachesTheElasticaWithOrderOneInItsCompliances) {
  for (const double load : {1.0, 10.0}) {
    const Elastica elastica(load);
    ConvergenceStudy study;
    for (const double stiffness : {1e3, 4e3, 1.6e4}) {
      const Cantilever::Tip tip =
          Cantilever(unit_bar(stiffness, 0.4 * stiffness), 32).under(load, 0.0);
      study.add(1.0 / stiffness, std::abs(tip.across - elastica.tip.across));
    }
    EXPECT_NEAR(study.order(), 1.0, 0.02) << load;
    EXPECT_GT(study.correlation(), 0.9999) << load;
  }
}

/// A bar with everything.
Rig laden(double radius) {
  Rig rig = shearing(radius);
  rig.gravity = 9.81;
  rig.gravity_direction = 0.4;
  rig.beam.masses = {{0.5, 0.3}, {0.8, 0.1}};
  rig.beam.damping = {.mass = 3.0, .stiffness = 1e-6};
  rig.hinge = {.spring = 400.0, .viscous = 2.0};
  return rig;
}

TEST(ReissnerBeam, HasTheSmallMotionOfTheLinearBar) {
  Rig rig = laden(0.05);
  rig.gravity = 0.0;
  rig.hinge.spring = 0.0;
  for (const double scale : {1.0, 0.5})  // of the radius
    rig.beam.segments.push_back({.length = 0.4,
                                 .area = rig.beam.area * scale * scale,
                                 .second_moment = rig.beam.second_moment * std::pow(scale, 4),
                                 .shear_coefficient = 0.886});
  const ReissnerBeam beam(rig, {3, 2});
  const SmallMotion motion = beam.small_motion();
  const int n = beam.size() + ReissnerBeam::held;
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n), stiffness = mass;
  for (std::size_t e = 0; e < beam.elements().size(); ++e) {
    const int first = Element::own * static_cast<int>(e);
    mass.block<11, 11>(first, first) += beam.masses()[e];
    stiffness.block<11, 11>(first, first) += beam.elements()[e].stiffness(Values{});
  }
  std::vector<int> across;  // of one direction, and the rotations
  for (int i = 1; i < n; ++i) {
    const int place = i % Element::own;
    if (place == Element::x0 || place == Element::turn0 || place == Element::xa ||
        place == Element::xc || place == Element::turn_b)
      across.push_back(i);
  }
  const auto frequencies = [](const Eigen::MatrixXd& k, const Eigen::MatrixXd& m) -> Vector {
    return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(k, m)
        .eigenvalues()
        .cwiseMax(0.0)
        .cwiseSqrt();
  };
  const Vector found = frequencies(stiffness(across, across), mass(across, across));
  const Vector linear = frequencies(motion.stiffness, motion.mass);
  ASSERT_EQ(found.size(), linear.size());
  for (int k = 1; k < found.size(); ++k) EXPECT_NEAR(found[k] / linear[k], 1.0, 1e-9) << k;
}

TEST(ReissnerBeam, VibratesWithThePinnedFreeFrequencies) {
  // by Rayleigh's quotient of the full equations' accelerations about hanging straight
  const Rig rig = shearing(0.06);
  const std::vector<double> exact = pinned_free_frequencies(rig.beam, 3);
  const auto errors = [&](int elements) {
    Rig own = rig;
    own.contact.position = own.beam.length;
    ReissnerBeam beam(own, {elements, 0});
    const int n = beam.size();
    Eigen::MatrixXd k(n, n);
    Vector there(n);
    const double step = 1e-7;
    for (int i = 0; i < n; ++i) {
      beam.acceleration(step * Vector::Unit(n, i), Vector::Zero(n), 0.0, there);
      k.col(i) = -there / step;
    }
    const Eigen::VectorXcd squares = k.eigenvalues();
    std::vector<double> found;
    for (const double omega : exact) {
      double best = 1.0;
      for (const std::complex<double> square : squares)
        best = std::min(best, std::abs(std::sqrt(std::abs(square)) / omega - 1.0));
      found.push_back(best);
    }
    return found;
  };
  const std::vector<double> coarse = errors(8), fine = errors(16);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(fine[k], 1e-4) << k;
    EXPECT_NEAR(coarse[k] / fine[k], 16.0, 4.0) << k;
  }
}

// dE/dt along a motion, bent and turning: what forces do is what energies show.
TEST(ReissnerBeam, ForcesDoTheWorkItsEnergiesShow) {
  Rig rig = laden(0.06);
  rig.beam.youngs_modulus = 1e7;
  rig.beam.damping.stiffness = 1e-3;
  ReissnerBeam beam(rig, {3, 2});
  for (const double angle : {0.0, 0.8, -2.5}) {
    const RandomState s = random_state(beam, 7, angle, 0.02);
    Vector a(beam.size());
    beam.acceleration(s.q, s.v, 0.0, a);
    const auto energy = [&](double time) {
      const BeamEnergy e = beam.energy(s.q + time * s.v + 0.5 * time * time * a, s.v + time * a);
      return e.kinetic + e.elastic + e.spring + e.gravitational;
    };
    const double power =
        (8.0 * (energy(1e-6) - energy(-1e-6)) - energy(2e-6) + energy(-2e-6)) / 12e-6;
    EXPECT_GT(beam.damping_power(s.q, s.v), 0.0);
    EXPECT_NEAR(power / -beam.damping_power(s.q, s.v), 1.0, 1e-5);
  }
}

TEST(ReissnerBeam, KnowsARigidMotion) {
  Rig rig = laden(0.06);
  rig.gravity_direction = 0.0;
  rig.hinge.viscous = rig.beam.damping.mass = 0.0;
  ReissnerBeam beam(rig, {3, 2});
  Vector q(beam.size()), v(beam.size());
  for (const double angle : {1e-6, 0.5, 2.0}) {
    beam.set_rigid_motion(-angle, 1.7, q, v);
    const BeamEnergy energy = beam.energy(q, v);
    EXPECT_LT(energy.elastic, 1e-18 * rig.beam.youngs_modulus * rig.beam.area * angle * angle);
    EXPECT_NEAR(energy.kinetic / (0.5 * rig.beam.hinge_inertia() * 1.7 * 1.7), 1.0, 1e-13);
    EXPECT_NEAR(energy.gravitational /
                    (9.81 * rig.beam.first_moment() * 2.0 * std::pow(std::sin(0.5 * angle), 2)),
                1.0, 1e-12);
    EXPECT_NEAR(energy.spring, 200.0 * angle * angle, 1e-12);
    EXPECT_NEAR(beam.rigid_part(q, v).rate, 1.7, 1e-12);
    EXPECT_NEAR(beam.rigid_part(q, v).along, std::cos(angle), 1e-2);  // without rotary inertia
    EXPECT_NEAR(beam.point(0.33, q, v).displacement, -0.33 * std::sin(angle), 1e-14);
    EXPECT_NEAR(beam.damping_power(q, v), 0.0, 1e-6);
    // a bar held by nothing but the hinge swings on as a rigid one would start to
    EXPECT_NEAR(beam.point(0.33, q, v).velocity, 1.7 * 0.33 * std::cos(angle), 1e-13);
  }
  beam.set_rigid_motion(-1e-6, 0.0, q, v);
  EXPECT_NEAR(beam.rigid_part(q, v).angle / -1e-6, 1.0, 1e-9);
}

/// All of a chain's matrix.
Eigen::MatrixXd dense(const std::vector<Element::Matrix>& elements) {
  const auto n = Element::own * static_cast<Eigen::Index>(elements.size()) + 3;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t e = 0; e < elements.size(); ++e)
    matrix.block<11, 11>(Element::own * static_cast<int>(e), Element::own * static_cast<int>(e)) +=
        elements[e];
  return matrix;
}

TEST(ElementChain, SolvesAsADenseMatrixDoes) {
  std::srand(5);
  const auto random = [](double diagonal) {
    std::vector<Element::Matrix> elements(5);
    for (Element::Matrix& matrix : elements) {
      const Element::Matrix r = Element::Matrix::Random();
      matrix = r * r.transpose() + diagonal * Element::Matrix::Identity();
    }
    return elements;
  };
  const std::vector<Element::Matrix> mass = random(5.0), stiffness = random(4.0);
  SystemShares<2> shares;
  const std::complex<double> k[2] = {{0.3, 2.0}, {40.0, -7.0}};
  for (int j = 0; j < 2; ++j) {
    shares.mass.re[j] = 1.0;
    shares.stiffness.re[j] = k[j].real();
    shares.stiffness.im[j] = k[j].imag();
    shares.first_node.im[j] = 0.5;
  }
  ElementChain<2, 8, 3> systems(5);
  systems.factor(mass, stiffness, 2, shares);
  const Vector right = Vector::Random(43);
  std::vector<ComplexLanes<2>> x(43);
  for (int i = 0; i < 43; ++i) x[static_cast<std::size_t>(i)].re.setConstant(right[i]);
  systems.solve_in_place(x);
  for (int j = 0; j < 2; ++j) {
    Eigen::MatrixXcd matrix = dense(mass) + k[j] * dense(stiffness);
    matrix(2, 2) += std::complex<double>(0.0, 0.5);
    const Eigen::VectorXcd expected =
        matrix.partialPivLu().solve(right.cast<std::complex<double>>());
    for (int i = 0; i < 43; ++i) {
      const ComplexLanes<2>& found = x[static_cast<std::size_t>(i)];
      EXPECT_LT(std::abs(std::complex<double>(found.re[j], found.im[j]) - expected[i]), 1e-12);
    }
  }
}

TEST(ReissnerChain, IsTheBeamWithItsHingeHeld) {
  ReissnerBeam beam(laden(0.06), {4, 2});
  const RandomState s = random_state(beam, 3, 0.4, 0.01);
  const ReissnerChain chain(beam);
  Vector a(beam.size());
  beam.acceleration(s.q, s.v, 0.0, a);
  Eigen::ArrayXd own_q, own_v, own_a;
  chain.from_beam(s.q, own_q);
  chain.from_beam(s.v, own_v);
  chain.from_beam(a, own_a);
  StageArray<4> q(4, chain.coordinates()), v = q, x = q, residual = q;
  for (int i = 0; i < 4; ++i) {
    q.row(i) = own_q.transpose();
    v.row(i) = own_v.transpose();
    x.row(i) = own_a.transpose();
  }
  chain.residual<4>(q, x, residual);
  const double size = residual.abs().maxCoeff();
  EXPECT_GT(size, 0.0);
  chain.add_damping<4>(q, v, residual);
  EXPECT_LT(residual.abs().maxCoeff(), 1e-9 * size);
  const BeamEnergy of_beam = beam.energy(s.q, s.v), of_chain = chain.energy(own_q, own_v);
  EXPECT_NEAR(of_chain.kinetic / of_beam.kinetic, 1.0, 1e-12);
  EXPECT_NEAR(of_chain.elastic / of_beam.elastic, 1.0, 1e-12);
  EXPECT_NEAR(of_chain.spring / of_beam.spring, 1.0, 1e-12);
  EXPECT_NEAR(of_chain.gravitational / of_beam.gravitational, 1.0, 1e-12);
  for (const double place : {0.1, 0.45, 0.8}) {
    double sum = 0.0;
    for (const ChainShare& share : ReissnerChain::shares_of(beam.row_at(place)))
      sum -= share.shape * own_q[share.coordinate];
    EXPECT_NEAR(sum, beam.point(place, s.q, s.v).displacement, 1e-15);
  }
}

TEST(ReissnerBeam, IsForBarsThatShearAndAncfForThoseThatDoNot) {
  using testing::ThrowsMessage;
  EXPECT_THAT(
      [] {
        ReissnerBeam(paper_rig(), {2, 1});
      },
      ThrowsMessage<std::invalid_argument>("ReissnerElement: the bar does not shear"));
  EXPECT_THAT(
      [] {
        AncfBeam(shearing(0.015), {2, 1});
      },
      ThrowsMessage<std::invalid_argument>(
          "beam.theory: AncfBeam does not shear, ReissnerBeam does"));
}

Rig struck_rig(double radius) {
  Rig rig = shearing(radius);
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  return rig;
}

SimulationOptions full() {
  SimulationOptions options;
  options.motion = Motion::full;
  return options;
}

SimulationOptions small() {
  SimulationOptions options;
  options.motion = Motion::small;
  return options;
}

// What large motion does falls with the square of the speed; then full equations and small motion
// are the same equations, integrated by different methods.
TEST(ReissnerImpact, BecomesSmallMotionOnTheSameMesh) {
  for (const double radius : {0.015, 0.05}) {
    Rig rig = struck_rig(radius);
    std::vector<double> differences;
    for (const double speed : {4.41, 0.441, 0.0441}) {
      rig.start.velocity = speed;
      const Solver solver = ancf(7, 1, 1e-9, 1e-3);
      const Simulation linear = simulate(rig, solver, small());
      const Simulation exact = simulate(rig, solver, full());
      differences.push_back(std::abs(exact.peak_force / linear.peak_force - 1.0));
      EXPECT_LT(differences.back(), linear.neglected) << speed;
      EXPECT_LT(std::abs(exact.energy.imbalance), 1e-8);
    }
    EXPECT_LT(differences[1], 0.02 * differences[0]) << radius;
    EXPECT_LT(differences[2], 1e-9) << radius;
  }
}

TEST(ReissnerImpact, AgreesWithDop853) {
  struct Scene {
    double radius, modulus, speed, duration;
    bool everything;
  };

  for (const Scene& scene :
       {Scene{0.03, 6.8952e10, 0.441, 5e-4, false}, Scene{0.03, 6.8952e10, 0.441, 5e-4, true},
        Scene{0.06, 5e7, 5.0, 1e-2, false}}) {
    Rig rig = scene.everything ? laden(scene.radius) : struck_rig(scene.radius);
    rig.beam.damping.stiffness *= 0.01;
    rig.contact.damping = "lankarani-nikravesh";
    rig.contact.restitution = 0.6;
    rig.beam.youngs_modulus = scene.modulus;
    rig.start.velocity = scene.speed;
    const Solver solver = ancf(3, 1, 1e-8, scene.duration);
    const Simulation radau = simulate(rig, solver, full());
    Solver tighter = solver;
    tighter.accuracy = 1e-10;
    ReissnerBeam beam(rig, solver.elements);
    const SimulationOptions options = full();
    const Simulation dop = ImpactRun(rig, tighter, options, beam).simulate();
    ASSERT_EQ(radau.episodes.size(), dop.episodes.size());
    const Episode& found = radau.episodes.front();
    const Episode& expected = dop.episodes.front();
    EXPECT_NEAR(found.peak_force / expected.peak_force, 1.0, 1e-8);
    EXPECT_NEAR(found.impulse / expected.impulse, 1.0, 1e-8);
    EXPECT_NEAR(found.end / expected.end, 1.0, 1e-8);
    EXPECT_LT(std::abs(radau.energy.imbalance), 1e-7);
  }
}

TEST(ReissnerImpact, KeepsTheAccuracyAskedFor) {
  for (const Rig& rig : {struck_rig(0.015), laden(0.04)}) {
    const Episode exact = simulate(rig, ancf(7, 1, 1e-11, 1e-3), full()).episodes.front();
    for (const double accuracy : {1e-3, 1e-5, 1e-7, 1e-9}) {
      const Simulation run = simulate(rig, ancf(7, 1, accuracy, 1e-3), full());
      const Episode& found = run.episodes.front();
      EXPECT_NEAR(found.peak_force / exact.peak_force, 1.0, accuracy);
      EXPECT_NEAR(found.impulse / exact.impulse, 1.0, accuracy);
      EXPECT_NEAR(found.end / exact.end, 1.0, accuracy);
      EXPECT_LT(std::abs(run.energy.imbalance), accuracy);
    }
  }
}

TEST(ReissnerImpact, NeedsNoMoreStepsForFinerMeshes) {
  const Rig rig = struck_rig(0.015);
  const Simulation coarse = simulate(rig, ancf(56, 8, 1e-3, 5e-4), full());
  const Simulation fine = simulate(rig, ancf(448, 64, 1e-3, 5e-4), full());
  EXPECT_LT(fine.cost.steps, 1.5 * static_cast<double>(coarse.cost.steps));
  EXPECT_NEAR(fine.peak_force / coarse.peak_force, 1.0, 0.02);
}

/// The same EI and ρA whatever the radius.
Rig as_thin(double radius, double bending, double line_density) {
  Rig rig = shearing(radius);
  rig.beam.youngs_modulus = bending / rig.beam.second_moment;
  rig.beam.density = line_density / rig.beam.area;
  return rig;
}

// Shear and rotary inertia vanish with the square of the radius; what is left are the elements that
// do not shear.
TEST(ReissnerImpact, ApproachesThatWithoutShearAsTheBarBecomesSlender) {
  const auto difference = [](double radius) {
    Rig rig = as_thin(radius, 2500.0, 2.0);
    rig.contact.law = "linear";
    rig.contact.stiffness = 1e6;
    const Simulation shears = simulate(rig, ancf(14, 2, 1e-8, 5e-3), full());
    rig.beam.theory = BeamTheory::euler_bernoulli;
    const Simulation plain = simulate(rig, ancf(14, 2, 1e-8, 5e-3), full());
    return std::abs(shears.peak_force / plain.peak_force - 1.0);
  };
  const double coarse = difference(0.004), fine = difference(0.002);
  EXPECT_NEAR(coarse / fine, 4.0, 0.2);
  EXPECT_LT(fine, 1e-3);
}

// A soft bar let go from the side.
TEST(ReissnerSwing, ApproachesThatWithoutShearAsTheBarBecomesSlender) {
  const auto difference = [](double radius) {
    Rig rig = as_thin(radius, 2e-2, 0.1);
    rig.gravity = 9.81;
    rig.contact.law = "none";
    rig.contact.position = 0.8;
    rig.start.release_angle = 1.5;
    SimulationOptions options = full();
    options.history.interval = 0.02;
    const Simulation shears = simulate(rig, ancf(12, 0, 1e-8, 0.6), options);
    rig.beam.theory = BeamTheory::euler_bernoulli;
    const Simulation plain = simulate(rig, ancf(24, 0, 1e-8, 0.6), options);
    EXPECT_LT(std::abs(shears.energy.imbalance), 1e-7);
    double most = 0.0;
    for (std::size_t i = 0; i < plain.history.displacement.size(); ++i)
      most =
          std::max(most, std::abs(shears.history.displacement[i] - plain.history.displacement[i]));
    return most;
  };
  const double coarse = difference(0.02), fine = difference(0.01);
  EXPECT_LT(fine, 0.35 * coarse);
  EXPECT_LT(fine, 1e-3);
}

}  // namespace
}  // namespace impactrig::tests
