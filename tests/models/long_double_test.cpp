// SPDX-License-Identifier: BSD-3-Clause
// The paper's impact once more in long double, every part by other means: modes from their textbook
// formulas, Goldsmith's law through Boost's Lambert W, time by Boost.Odeint with steps graded
// towards touch and separation. Good to 1e-15; `accuracy` has to hold against it, for each set of
// equations against its own.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/lambert_w.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "models/simulation.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using namespace impactrig::tests;
using Real = long double;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using ConstMap = Eigen::Map<const Vector>;

constexpr Real pi = boost::math::constants::pi<Real>();

/// Goldsmith's law with a damping factor, [Goldsmith1960] as in Shen et al. (31)-(33).
class Press {
 public:
  explicit Press(const Rig& rig) {
    const Contact& c = rig.contact;
    const auto plane = [](Real modulus, Real ratio) {
      return (1 - ratio * ratio) / (pi * modulus);
    };
    const Real both =
        plane(c.modulus, c.poisson_ratio) + plane(c.counter_modulus, c.counter_poisson_ratio);
    compliance_ = both / c.length;
    limit_ = std::pow(Real(c.length), c.exponent) * (Real(c.counter_radius) - Real(c.radius)) /
             (Real(c.radius) * Real(c.counter_radius) * both);
    const Real e = c.restitution;
    mu_ = c.damping == "none" ? 0 : 3 * (1 - e * e) / (4 * Real(rig.start.velocity));
  }

  Real force(Real depth, Real rate) const {
    if (depth <= 0) return 0;
    const Real argument = -depth / (std::exp(Real(1)) * compliance_ * limit_);
    return -depth / (compliance_ * boost::math::lambert_wm1(argument)) * (1 + mu_ * rate);
  }

 private:
  Real compliance_, limit_, mu_;
};

struct Motions {
  Real depth = 0, rate = 0;  // of the struck point, closing > 0
};

/// A bar in coordinates q (n), v (n).
struct Bar {
  Vector start;       // v at first touch
  Vector place = {};  // q there; 0 where it is empty
  std::function<Motions(ConstMap q, ConstMap v)> struck;
  std::function<void(ConstMap q, ConstMap v, Real force, Eigen::Map<Vector> a)> accelerate;
};

struct Mode {
  Real omega = 0;   // [rad/s]
  Real moment = 0;  // ∫ ρA x φ dx
  std::function<Real(Real)> value, slope;
};

/// Bending mode of unit modal mass, [Blevins1979] tables 8-1; roots by Newton's iteration.
Mode mode(const Beam& beam, Basis basis, int number) {
  const bool clamped = basis == Basis::cantilever;
  Real z = clamped ? (number - Real(0.5)) * pi : (number + Real(0.25)) * pi;
  if (clamped && number == 1) z = Real(1.875);
  for (int i = 0; i < 30; ++i)
    z -= clamped ? (std::cos(z) * std::cosh(z) + 1) /
                       (std::cos(z) * std::sinh(z) - std::sin(z) * std::cosh(z))
                 : (std::tan(z) - std::tanh(z)) /
                       (std::pow(std::tan(z), 2) + std::pow(std::tanh(z), 2));
  const Real length = beam.length;
  const Real line_density = Real(beam.density) * Real(beam.area);
  const Real beta = z / length;
  // 1 − σ of the cantilever, σ itself cancels: cosh − σ sinh = e^(−ξ) + (1 − σ) sinh
  const Real rest = (std::sin(z) - std::cos(z) - std::exp(-z)) / (std::sinh(z) + std::sin(z));
  const Real ratio = std::sin(z) / std::sinh(z);
  const auto value = [=](Real x) -> Real {
    const Real xi = beta * x;
    return clamped ? std::exp(-xi) + rest * std::sinh(xi) - std::cos(xi) + (1 - rest) * std::sin(xi)
                   : std::sin(xi) + ratio * std::sinh(xi);
  };
  const auto slope = [=](Real x) -> Real {
    const Real xi = beta * x;
    return beta * (clamped ? -std::exp(-xi) + rest * std::cosh(xi) + std::sin(xi) +
                                 (1 - rest) * std::cos(xi)
                           : std::cos(xi) + ratio * std::cosh(xi));
  };
  // ∫ φ² dx = L φ(L)² / 4, ∫ x φ dx = φ''(0) / β⁴
  const Real scale = 2 / std::sqrt(line_density * length * std::pow(value(length), 2));
  return {.omega = beta * beta *
                   std::sqrt(Real(beam.youngs_modulus) * Real(beam.second_moment) / line_density),
          .moment = clamped ? line_density * scale * 2 / (beta * beta) : 0,
          .value = [=](Real x) { return scale * value(x); },
          .slope = [=](Real x) { return scale * slope(x); }};
}

/// M q̈ + K q = −rᵀ F, where r q is the depth.
Bar linear_bar(const Matrix& mass, const Matrix& stiffness, const Vector& row,
               const Vector& start) {
  const Eigen::LLT<Matrix> factor(mass);
  const Matrix returning = factor.solve(stiffness);
  const Vector pushed = factor.solve(row);
  return {.start = start,
          .place = {},
          .struck =
              [=](ConstMap q, ConstMap v) {
                return Motions{row.dot(q), row.dot(v)};
              },
          .accelerate =
              [=](ConstMap q, ConstMap, Real force, Eigen::Map<Vector> a) {
                a.noalias() = -returning * q;
                a -= force * pushed;
              }};
}

/// Small motion in hybrid coordinates: [angle, modes].
Bar small_hybrid(const Rig& rig, Basis basis, int modes) {
  const Real at = rig.contact.position;
  Matrix mass = Matrix::Identity(1 + modes, 1 + modes);
  Matrix stiffness = Matrix::Zero(1 + modes, 1 + modes);
  Vector row(1 + modes), start = Vector::Zero(1 + modes);
  mass(0, 0) =
      Real(rig.beam.density) * Real(rig.beam.area) * std::pow(Real(rig.beam.length), 3) / 3;
  row[0] = at;
  for (int k = 1; k <= modes; ++k) {
    const Mode m = mode(rig.beam, basis, k);
    mass(0, k) = mass(k, 0) = m.moment;
    stiffness(k, k) = m.omega * m.omega;
    row[k] = m.value(at);
  }
  start[0] = Real(rig.start.velocity) / at;
  return linear_bar(mass, stiffness, row, start);
}

/// Small motion of cubic elements: [slope of the hinge, (value, slope) of each node].
Bar small_ancf(const Rig& rig, std::array<int, 2> elements) {
  const int size = 2 * (elements[0] + elements[1]) + 2;
  Matrix mass = Matrix::Zero(size, size), stiffness = Matrix::Zero(size, size);
  Vector start(size);
  start.head<2>() << 0, 1;
  const Real at = rig.contact.position;
  Real x = 0;
  for (int e = 0; e < elements[0] + elements[1]; ++e) {
    const Real l = e < elements[0] ? at / elements[0] : (Real(rig.beam.length) - at) / elements[1];
    Eigen::Matrix<Real, 4, 4> m, k;
    m << 156, 22 * l, 54, -13 * l, 22 * l, 4 * l * l, 13 * l, -3 * l * l,  //
        54, 13 * l, 156, -22 * l, -13 * l, -3 * l * l, -22 * l, 4 * l * l;
    k << 12, 6 * l, -12, 6 * l, 6 * l, 4 * l * l, -6 * l, 2 * l * l,  //
        -12, -6 * l, 12, -6 * l, 6 * l, 2 * l * l, -6 * l, 4 * l * l;
    mass.block<4, 4>(2 * e, 2 * e) += Real(rig.beam.density) * Real(rig.beam.area) * l / 420 * m;
    stiffness.block<4, 4>(2 * e, 2 * e) +=
        Real(rig.beam.youngs_modulus) * Real(rig.beam.second_moment) / (l * l * l) * k;
    x += l;
    start.segment<2>(2 * e + 2) << x, 1;
  }
  start *= Real(rig.start.velocity) / at;
  // the hinge does not move
  const int n = size - 1;
  return linear_bar(mass.bottomRightCorner(n, n), stiffness.bottomRightCorner(n, n),
                    Vector::Unit(n, 2 * elements[0] - 1), start.tail(n));
}

/// Shen et al. (1)-(17) without axial modes and gravity: q = [ψ, b], a place of the axis at x + w,
/// w = −b'H(x) b / 2, and y = S2 b in the frame; X = sin ψ (x + w) + cos ψ y, closing is −X.
Bar full_hybrid(const Rig& rig, Basis basis, int modes, int panels) {
  struct Place {
    Real x, mass;
    Vector shape;
    Matrix coupling;
  };

  const Beam& beam = rig.beam;
  std::vector<Mode> shapes;
  Vector stiffness = Vector::Zero(1 + modes);
  for (int k = 1; k <= modes; ++k) {
    shapes.push_back(mode(beam, basis, k));
    stiffness[k] = shapes.back().omega * shapes.back().omega;
  }
  using Rule = boost::math::quadrature::gauss<Real, 20>;
  const auto on_rule = [&](Real from, Real to, const auto& visit) {
    const Real half = (to - from) / 2;
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
      for (const int side : {-1, 1})
        visit((from + to) / 2 + side * half * Rule::abscissa()[i], half * Rule::weights()[i]);
  };
  const auto place = [&](Real x, Real weight) {
    Place p{x, Real(beam.density) * Real(beam.area) * weight, Vector(modes),
            Matrix::Zero(modes, modes)};
    for (int k = 0; k < modes; ++k) p.shape[k] = shapes[static_cast<std::size_t>(k)].value(x);
    for (int i = 0; i < panels; ++i)
      on_rule(x * i / panels, x * (i + 1) / panels, [&](Real xi, Real w) {
        Vector slopes(modes);
        for (int k = 0; k < modes; ++k) slopes[k] = shapes[static_cast<std::size_t>(k)].slope(xi);
        p.coupling += w * slopes * slopes.transpose();
      });
    return p;
  };
  std::vector<Place> places;
  for (int i = 0; i < panels; ++i)
    on_rule(Real(beam.length) * i / panels, Real(beam.length) * (i + 1) / panels,
            [&](Real x, Real w) { places.push_back(place(x, w)); });
  const Place struck = place(rig.contact.position, 0);
  Vector start = Vector::Zero(1 + modes);
  start[0] = -Real(rig.start.velocity) / Real(rig.contact.position);

  Bar bar;
  bar.start = start;
  bar.struck = [=](ConstMap q, ConstMap v) {
    const Vector b = q.tail(modes), u = v.tail(modes), hb = struck.coupling * b;
    const Real x = struck.x - b.dot(hb) / 2, y = struck.shape.dot(b);
    const Real c = std::cos(q[0]), s = std::sin(q[0]);
    return Motions{-(s * x + c * y),
                   -(v[0] * (c * x - s * y) - s * hb.dot(u) + c * struck.shape.dot(u))};
  };
  bar.accelerate = [=](ConstMap q, ConstMap v, Real force, Eigen::Map<Vector> a) {
    const int n = 1 + modes;
    const Vector b = q.tail(modes), u = v.tail(modes);
    Matrix mass = Matrix::Zero(n, n);
    Vector load = -stiffness.cwiseProduct(q);
    Vector along(n), across(n), hb(modes);
    for (const Place& p : places) {
      hb.noalias() = p.coupling * b;
      const Real x = p.x - b.dot(hb) / 2, y = p.shape.dot(b);
      along[0] = -y;
      across[0] = x;
      along.tail(modes) = -hb;
      across.tail(modes) = p.shape;
      // what the place accelerates by without a
      const Real bias_x = -u.dot(p.coupling * u) - v[0] * v[0] * x - 2 * v[0] * p.shape.dot(u);
      const Real bias_y = -v[0] * v[0] * y - 2 * v[0] * hb.dot(u);
      mass.noalias() += p.mass * along * along.transpose();
      mass.noalias() += p.mass * across * across.transpose();
      load -= p.mass * (bias_x * along + bias_y * across);
    }
    const Vector at_hb = struck.coupling * b;
    const Real c = std::cos(q[0]), s = std::sin(q[0]);
    load[0] += force * (c * (struck.x - b.dot(at_hb) / 2) - s * struck.shape.dot(b));
    load.tail(modes) += force * (c * struck.shape - s * at_hb);
    a = mass.llt().solve(load);
  };
  return bar;
}

/// Shen et al. (19)-(30): q = [X, U], each [slope of the hinge, (value, slope) of each node]; the
/// axis is at r = (X, U - x), closing is -X. Energies are integrated by ten Gauss points an
/// element.
class FullAncf {
 public:
  FullAncf(const Rig& rig, std::array<int, 2> elements)
      : rig_(rig),
        struck_(2 * elements[0] - 1),
        size_(2 * (elements[0] + elements[1]) + 1) {
    const Real at = rig.contact.position;
    nodes_.push_back(0);
    for (int i = 1; i <= elements[0]; ++i) nodes_.push_back(at * i / elements[0]);
    for (int i = 1; i <= elements[1]; ++i)
      nodes_.push_back(at + (Real(rig.beam.length) - at) * i / elements[1]);
    Matrix mass = Matrix::Zero(size_, size_), along = mass;
    straight_.setZero(size_);
    straight_[0] = 1;
    for (std::size_t e = 0; e + 1 < nodes_.size(); ++e) {
      straight_.segment(first(e) + 2, 2) << nodes_[e + 1], 1;
      on_element(e, [&](const Places& p, Real weight) {
        add(e, mass,
            Real(rig.beam.density) * Real(rig.beam.area) * weight * p.value * p.value.transpose());
        add(e, along,
            weight * (stretching() * p.slope * p.slope.transpose() +
                      bending() * p.bend * p.bend.transpose()));
      });
    }
    mass_ = mass;
    mass_factor_.compute(mass);
    along_factor_.compute(along);
  }

  /// Turning about the hinge at a steady rate, which stretches the bar by 1e-8 or so.
  Bar bar() const {
    const Real at = rig_.contact.position, speed = rig_.start.velocity;
    Vector stretch = Vector::Zero(size_);
    Real rate = speed / at;
    for (int i = 0; i < 6; ++i) {
      // U = -stretch: what it resists and what turning pulls with are in balance
      const Vector pull = rate * rate * (mass_ * (straight_ + stretch));
      Vector q = Vector::Zero(2 * size_);
      q.tail(size_) = -stretch;
      stretch += along_factor_.solve(pull - elastic_force(q).tail(size_));
      rate = speed / at;
    }
    rate = speed / (at + stretch[struck_]);
    Bar bar{.start = Vector::Zero(2 * size_),
            .place = Vector::Zero(2 * size_),
            .struck = {},
            .accelerate = {}};
    bar.place.tail(size_) = -stretch;
    bar.start.head(size_) = -rate * (straight_ + stretch);
    bar.struck = [struck = struck_](ConstMap q, ConstMap v) {
      return Motions{-q[struck], -v[struck]};
    };
    bar.accelerate = [own = *this](ConstMap q, ConstMap, Real force, Eigen::Map<Vector> a) {
      a = own.elastic_force(q);
      a[own.struck_] += force;
      own.mass_factor_.solveInPlace(a.head(own.size_));
      own.mass_factor_.solveInPlace(a.tail(own.size_));
    };
    return bar;
  }

 private:
  using Nodal = Eigen::Matrix<Real, 4, 1>;

  /// Hermite's cubics and their first two derivatives at a place.
  struct Places {
    Nodal value, slope, bend;
  };

  Real stretching() const { return Real(rig_.beam.youngs_modulus) * Real(rig_.beam.area); }

  Real bending() const { return Real(rig_.beam.youngs_modulus) * Real(rig_.beam.second_moment); }

  static Eigen::Index first(std::size_t e) { return 2 * static_cast<Eigen::Index>(e) - 1; }

  /// Calls visit(places, weight) at an element's Gauss points.
  template <typename Visit>
  void on_element(std::size_t e, const Visit& visit) const {
    using Rule = boost::math::quadrature::gauss<Real, 10>;
    const Real l = nodes_[e + 1] - nodes_[e];
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
      for (const int side : {-1, 1}) {
        const Real z = (1 + side * Rule::abscissa()[i]) / 2, w = 1 - z;
        visit({.value = {w * w * (1 + 2 * z), l * z * w * w, z * z * (3 - 2 * z), -l * z * z * w},
               .slope = {-6 * z * w / l, w * (1 - 3 * z), 6 * z * w / l, -z * (2 - 3 * z)},
               .bend = {(12 * z - 6) / (l * l), (6 * z - 4) / l, (6 - 12 * z) / (l * l),
                        (6 * z - 2) / l}},
              l * Rule::weights()[i] / 2);
      }
  }

  /// The hinge's value is not a coordinate.
  static void add(std::size_t e, Matrix& to, const Eigen::Matrix<Real, 4, 4>& share) {
    const int kept = e == 0 ? 3 : 4;
    to.block(std::max<Eigen::Index>(first(e), 0), std::max<Eigen::Index>(first(e), 0), kept,
             kept) += share.bottomRightCorner(kept, kept);
  }

  static void add(std::size_t e, Eigen::Ref<Vector> to, const Nodal& share) {
    const int kept = e == 0 ? 3 : 4;
    to.segment(std::max<Eigen::Index>(first(e), 0), kept) += share.tail(kept);
  }

  static Nodal nodal(std::size_t e, const Eigen::Ref<const Vector>& part) {
    if (e > 0) return part.segment(first(e), 4);
    return {0, part[0], part[1], part[2]};
  }

  /// -dU/dq of U = 1/2 EA (r'r' - 1)^2 / 4 + 1/2 EI r''r'' integrated along the bar.
  Vector elastic_force(const Eigen::Ref<const Vector>& q) const {
    Vector force = Vector::Zero(2 * size_);
    for (std::size_t e = 0; e + 1 < nodes_.size(); ++e) {
      const Nodal x = nodal(e, q.head(size_)), u = nodal(e, q.tail(size_));
      Nodal on_x = Nodal::Zero(), on_u = on_x;
      on_element(e, [&](const Places& p, Real weight) {
        const Real sx = p.slope.dot(x), su = p.slope.dot(u);
        const Real pull = weight * stretching() * ((sx * sx + su * su) / 2 - su);
        on_x -= pull * sx * p.slope + weight * bending() * p.bend.dot(x) * p.bend;
        on_u -= pull * (su - 1) * p.slope + weight * bending() * p.bend.dot(u) * p.bend;
      });
      add(e, force.head(size_), on_x);
      add(e, force.tail(size_), on_u);
    }
    return force;
  }

  Rig rig_;
  Eigen::Index struck_, size_;  // of one direction
  std::vector<Real> nodes_;     // from the hinge [m]
  Vector straight_;             // x as nodal values
  Matrix mass_;
  Eigen::LLT<Matrix> mass_factor_, along_factor_;
};

struct FirstContact {
  Real peak = 0, end = 0, impulse = 0;
};

/// Maximum of a function on [0, end], by golden section.
Real highest(const std::function<Real(Real)>& f, Real end) {
  const Real golden = (std::sqrt(Real(5)) - 1) / 2;
  Real low = 0, high = end;
  Real a = high - golden * end, b = low + golden * end;
  Real fa = f(a), fb = f(b);
  for (int i = 0; i < 45; ++i) {  // to 4e-10 of the interval, and the square of that in the value
    if (fa < fb) {
      low = a;
      a = b;
      fa = fb;
      b = low + golden * (high - low);
      fb = f(b);
    } else {
      high = b;
      b = a;
      fb = fa;
      a = high - golden * (high - low);
      fa = f(a);
    }
  }
  return std::max(fa, fb);
}

/// Steps are `ratio` of the time from touch or to separation, at most `longest` [s].
FirstContact reference(const Rig& rig, const Bar& bar, Real ratio, Real longest) {
  using State = std::vector<Real>;
  const Press press(rig);
  const Eigen::Index n = bar.start.size();
  const auto motions = [&](const State& y) {
    return bar.struck(ConstMap(y.data(), n), ConstMap(y.data() + n, n));
  };
  const auto force = [&](const State& y) {
    const Motions m = motions(y);
    return press.force(m.depth, m.rate);
  };
  boost::numeric::odeint::runge_kutta_fehlberg78<State, Real> stepper;
  const auto slope = [&](const State& y, State& d, Real) {
    const Real f = force(y);
    std::copy(y.begin() + n, y.begin() + 2 * n, d.begin());
    bar.accelerate(ConstMap(y.data(), n), ConstMap(y.data() + n, n), f,
                   Eigen::Map<Vector>(d.data() + n, n));
    d.back() = f;
  };
  const auto advanced = [&](State y, Real h) {
    stepper.do_step(slope, y, Real(0), h / 2);
    stepper.do_step(slope, y, Real(0), h / 2);
    return y;
  };
  State y(static_cast<std::size_t>(2 * n + 1), 0), before = y;
  if (bar.place.size() > 0) Eigen::Map<Vector>(y.data(), n) = bar.place;
  Eigen::Map<Vector>(y.data() + n, n) = bar.start;
  FirstContact contact;
  const Real least = 1e-13L;  // the force of the last and first step's depth is 1e-10 of the peak
  Real t = 0, h = least, h_before = 0;
  while (h >= least) {
    State next = y;
    stepper.do_step(slope, next, Real(0), h);
    if (force(next) < force(y) && force(y) > force(before)) {
      // a maximum within the last two steps, by golden section
      contact.peak = std::max(
          contact.peak, highest([&](Real s) { return force(advanced(before, s)); }, h_before + h));
    }
    before = y;
    h_before = h;
    y = next;
    t += h;
    h = std::min(std::max(ratio * t, least), longest);
    const Motions m = motions(y);
    if (m.rate < 0) h = std::min(h, ratio * m.depth / -m.rate);
  }
  const Motions last = motions(y);
  contact.end = t - last.depth / last.rate;
  contact.impulse = y.back();
  return contact;
}

Rig damped_rig() {
  Rig rig = paper_rig();
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  return rig;
}

/// Largest relative difference of what accuracy promises.
Real difference(const FirstContact& a, const FirstContact& b) {
  return std::max({std::abs(a.peak / b.peak - 1), std::abs(a.end / b.end - 1),
                   std::abs(a.impulse / b.impulse - 1)});
}

void expect_accuracy(const FirstContact& expected, Solver solver, Motion motion) {
  SimulationOptions options;
  options.motion = motion;
  for (double accuracy = 1e-3; accuracy > 5e-13; accuracy *= 0.1) {
    solver.accuracy = accuracy;
    const Simulation run = simulate(damped_rig(), solver, options);
    ASSERT_EQ(run.small_motion, motion == Motion::small);
    const Episode& first = run.episodes.at(0);
    const FirstContact found{first.peak_force, first.end, first.impulse};
    EXPECT_LE(difference(found, expected), accuracy) << "accuracy " << accuracy;
  }
}

/// The reference, and the same with steps half as long: it has to stand 1e-15.
FirstContact confirmed(const Bar& bar, Real longest) {
  const FirstContact found = reference(damped_rig(), bar, 0.125L, longest);
  const FirstContact finer = reference(damped_rig(), bar, 0.0625L, 0.5L * longest);
  EXPECT_LT(difference(found, finer), 1e-15L);
  return found;
}

TEST(LongDouble, HoldsSmallMotionOfHybridCoordinatesToItsAccuracy) {
  for (const Basis basis : {Basis::pinned_free, Basis::cantilever})
    for (const int modes : {3, 7}) {
      SCOPED_TRACE(testing::Message() << name(basis) << ' ' << modes);
      expect_accuracy(confirmed(small_hybrid(damped_rig(), basis, modes), 1e-6L),
                      hybrid(basis, modes, 1e-6, 6e-4), Motion::small);
    }
}

TEST(LongDouble, HoldsSmallMotionOfAncfToItsAccuracy) {
  for (const std::array<int, 2> elements : {std::array{2, 1}, std::array{6, 2}}) {
    SCOPED_TRACE(testing::Message() << elements[0] << ' ' << elements[1]);
    // the fastest vibration turns by 0.04 rad in a step
    expect_accuracy(confirmed(small_ancf(damped_rig(), elements), 2e-7L),
                    ancf(elements[0], elements[1], 1e-6, 6e-4), Motion::small);
  }
}

TEST(LongDouble, HoldsHybridCoordinatesWithForeshorteningToTheirAccuracy) {
  const Rig rig = damped_rig();
  for (const Basis basis : {Basis::pinned_free, Basis::cantilever}) {
    SCOPED_TRACE(name(basis));
    const FirstContact full = confirmed(full_hybrid(rig, basis, 3, 2), 1e-6L);
    expect_accuracy(full, hybrid(basis, 3, 1e-6, 3e-4), Motion::full);
    // 2e-8 to 3e-8: the two sets of equations are told apart from accuracy 1e-8 on
    EXPECT_GT(difference(full, reference(rig, small_hybrid(rig, basis, 3), 0.125L, 1e-6L)), 1e-8L);
  }
}

TEST(LongDouble, HoldsSevenModesWithForeshorteningToTheirAccuracy) {
  const Bar bar = full_hybrid(damped_rig(), Basis::pinned_free, 7, 2);
  expect_accuracy(reference(damped_rig(), bar, 0.125L, 1e-6L),
                  hybrid(Basis::pinned_free, 7, 1e-6, 6e-4), Motion::full);
}

TEST(LongDouble, HoldsAbsoluteNodalCoordinatesToTheirAccuracy) {
  const Rig rig = damped_rig();
  for (const std::array<int, 2> elements : {std::array{2, 1}, std::array{3, 1}}) {
    SCOPED_TRACE(testing::Message() << elements[0] << ' ' << elements[1]);
    const FirstContact full = confirmed(FullAncf(rig, elements).bar(), 1e-7L);
    expect_accuracy(full, ancf(elements[0], elements[1], 1e-6, 6e-4), Motion::full);
    EXPECT_GT(difference(full, reference(rig, small_ancf(rig, elements), 0.125L, 2e-7L)), 1e-9L);
  }
}

}  // namespace
