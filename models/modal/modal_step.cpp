// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "models/lanes/mode_lanes.hpp"
#include "models/modal/mode_kernel.hpp"

namespace impactrig::models {
namespace {

constexpr int most_terms = Collocation::block_size * Collocation::blocks;
static_assert(most_terms == ModesOverStep::most_terms);
// Phase of the highest mode over a step whose series has that many terms, with some to spare.
constexpr double longest_phase = 360.0;
// A bar moved along a slope by a little vibrates a little faster than the ladder of steps knows.
constexpr double slack = 0.01;

/// |λ| of the fastest e^{λt} in the modes of which a series over h has to know, or over any h.
double fastest_in_series(const ModalBeam& beam, std::optional<double> h) {
  double fastest = 0.0;
  for (Eigen::Index m = 0; m < beam.omega().size(); ++m) {
    const ModeKernel kernel(beam.omega()[m], beam.damping()[m]);
    fastest = std::max(fastest, h ? kernel.rate_in_series(*h) : kernel.lasting_rate());
  }
  return fastest;
}

/// How many terms of the Legendre series over the step of sin θτ and cos θτ matter. By
/// e^{izx} = Σ (2n+1) iⁿ j_n(z) P_n(x) [DLMF2010, 10.60.7], z = θ/2, x = 2τ − 1, they are spherical
/// Bessel functions.
int terms_needed(double theta) {
  const double z = 0.5 * theta;
  return std::min(static_cast<int>(z + 14.0 + 6.0 * std::cbrt(z)), most_terms);
}

void move(ModesUnderForce& modes) {
  modes.damping ? advance_damped_modes(modes) : advance_modes(modes);
}

/// What is known of the modes over a step, under the force of a stop and seen at the point before
/// another.
ModesOverStep modes_over(const ModalBeam& beam, const Collocation& rule, double h, int stop,
                         int point) {
  ModesOverStep modes{};
  modes.modes = beam.modes();
  modes.nodes = rule.nodes();
  modes.omega = beam.omega().data();
  modes.struck = beam.struck(stop).data();
  modes.damping = beam.damped() ? beam.damping().data() : nullptr;
  modes.seen = beam.struck(point).data();
  modes.h = h;
  modes.points = rule.points().data();
  modes.to_series = rule.to_series().data();
  return modes;
}

/// How a point moves under a force, as series over the step and, of what starts early, at the
/// nodes.
struct Kernels {
  Kernels(int terms, int nodes)
      : blocks((terms + Collocation::block_size - 1) / Collocation::block_size),
        series(Eigen::MatrixX2d::Zero(blocks * Collocation::block_size, 2)),
        early_displacement(NodeMatrix::Zero(nodes, nodes)),
        early_velocity(early_displacement) {}

  void write_to(ModesOverStep& modes) {
    modes.displacement_kernel = series.col(0).data();
    modes.velocity_kernel = series.col(1).data();
    modes.early_displacement = early_displacement.data();
    modes.early_velocity = early_velocity.data();
  }

  /// By the convolution of the kernels with the nodes' polynomials.
  void respond_to_force(const Collocation& rule, double h, BarMotion::Response& response) const {
    const int s = rule.nodes();
    Eigen::MatrixX2d at_nodes = Eigen::MatrixX2d::Zero(s * s, 2);
    for (int b = 0; b < blocks; ++b)
      for (int c = 0; c < 2; ++c)
        at_nodes.col(c).noalias() +=
            rule.convolutions(b) *
            series.col(c).segment(b * Collocation::block_size, Collocation::block_size);
    using Square = Eigen::Map<const Eigen::MatrixXd>;
    response.displacement_of_force = h * Square(at_nodes.col(0).data(), s, s);
    response.velocity_of_force = h * Square(at_nodes.col(1).data(), s, s);
    if (early_velocity.any()) {
      response.displacement_of_force += h * early_displacement * rule.to_series();
      response.velocity_of_force += h * early_velocity * rule.to_series();
    }
    response.set_most();
  }

  int blocks;
  Eigen::MatrixX2d series;
  NodeMatrix early_displacement, early_velocity;
};

template <typename Rows>
void write_rows(Rows& rows, ModesOverStep& modes) {
  modes.of_a = rows.of_a.data();
  modes.of_rate = rows.of_rate.data();
}

void respond(const ModesOverStep& modes) {
  modes.damping ? step_damped_modes(modes) : step_modes(modes);
}

}  // namespace

double ModalStep::longest(const ModalBeam& beam) {
  const double highest = fastest_in_series(beam, std::nullopt);
  return highest > 0.0 ? longest_phase / highest : std::numeric_limits<double>::infinity();
}

ModalStep::ModalStep(const ModalBeam& beam, const Collocation& rule, double h)
    : h_(h),
      a_of_a_(beam.modes()),
      a_of_rate_(beam.modes()),
      rate_of_a_(beam.modes()),
      rate_of_rate_(beam.modes()),
      a_of_force_(beam.modes(), rule.nodes()),
      rate_of_force_(beam.modes(), rule.nodes()) {
  const double phase = h * fastest_in_series(beam, h);
  if (phase > longest_phase * (1.0 + slack))
    throw std::logic_error("ModalStep: the step is too long for the highest mode");
  const int s = rule.nodes();
  response_.of_a.resize(2 * s, beam.modes());
  response_.of_rate.resize(2 * s, beam.modes());
  const int terms = std::max(terms_needed(phase), s);
  Kernels kernels(terms, s);
  ModesOverStep modes = modes_over(beam, rule, h, 0, 0);
  write_rows(response_, modes);
  modes.a_of_force = a_of_force_.data();
  modes.rate_of_force = rate_of_force_.data();
  modes.a_of_a = a_of_a_.data();
  modes.a_of_rate = a_of_rate_.data();
  modes.rate_of_a = rate_of_a_.data();
  modes.rate_of_rate = rate_of_rate_.data();
  modes.terms = terms;
  kernels.write_to(modes);
  respond(modes);
  of_unit_force_ = {a_of_force_.rowwise().sum(), rate_of_force_.rowwise().sum()};
  kernels.respond_to_force(rule, h, response_.of_force);
  if (beam.stops() > 1) respond_further(beam, rule, terms);
}

ModalStep ModalStep::sum(std::span<const ModalStep> steps, std::span<const double> weights) {
  ModalStep total = steps.front();
  const auto combine = [&](const auto& part) {
    auto& to = part(total);
    to.setZero();
    for (std::size_t j = 0; j < steps.size(); ++j)
      if (weights[j] != 0.0) to += weights[j] * part(steps[j]);
  };
  combine([](auto& step) -> auto& { return step.a_of_a_; });
  combine([](auto& step) -> auto& { return step.a_of_rate_; });
  combine([](auto& step) -> auto& { return step.rate_of_a_; });
  combine([](auto& step) -> auto& { return step.rate_of_rate_; });
  combine([](auto& step) -> auto& { return step.a_of_force_; });
  combine([](auto& step) -> auto& { return step.rate_of_force_; });
  combine([](auto& step) -> auto& { return step.of_unit_force_.a; });
  combine([](auto& step) -> auto& { return step.of_unit_force_.rate; });
  combine([](auto& step) -> auto& { return step.response_.of_a; });
  combine([](auto& step) -> auto& { return step.response_.of_rate; });
  combine([](auto& step) -> auto& { return step.response_.of_force.displacement_of_force; });
  combine([](auto& step) -> auto& { return step.response_.of_force.velocity_of_force; });
  total.response_.of_force.set_most();
  for (std::size_t k = 0; k < total.further_.size(); ++k)
    for (const auto matrix :
         {&Further::of_a, &Further::of_rate, &Further::a_of_force, &Further::rate_of_force})
      combine([&](auto& step) -> auto& { return step.further_[k].*matrix; });
  for (std::size_t k = 0; k < total.of_force_.size(); ++k) {
    combine([&](auto& step) -> auto& { return step.of_force_[k].displacement_of_force; });
    combine([&](auto& step) -> auto& { return step.of_force_[k].velocity_of_force; });
  }
  return total;
}

/// The points before further stops; what two points do to each other they do both ways.
void ModalStep::respond_further(const ModalBeam& beam, const Collocation& rule, int terms) {
  const int s = rule.nodes();
  const Eigen::MatrixXd rows(2 * s, beam.modes()), of_force(beam.modes(), s);
  further_.assign(static_cast<std::size_t>(beam.stops() - 1), {rows, rows, of_force, of_force});
  of_force_.resize(static_cast<std::size_t>(beam.stops() * beam.stops()));
  Eigen::ArrayXd swing(beam.modes());
  for (int stop = 1; stop < beam.stops(); ++stop) {
    Further& further = further_[static_cast<std::size_t>(stop - 1)];
    for (int point = 0; point <= stop; ++point) {
      Kernels kernels(terms, s);
      ModesOverStep modes = modes_over(beam, rule, h_, stop, point);
      write_rows(further, modes);
      modes.a_of_force = further.a_of_force.data();
      modes.rate_of_force = further.rate_of_force.data();
      modes.a_of_a = modes.a_of_rate = modes.rate_of_a = modes.rate_of_rate = swing.data();
      modes.terms = terms;
      kernels.write_to(modes);
      respond(modes);
      BarMotion::Response& response =
          of_force_[static_cast<std::size_t>(point * beam.stops() + stop)];
      kernels.respond_to_force(rule, h_, response);
      of_force_[static_cast<std::size_t>(stop * beam.stops() + point)] = response;
    }
  }
}

void ModalStep::coast(int stop, const ModalState& from, NodeVector& displacement,
                      NodeVector& velocity) const {
  const auto coast_by = [&](const auto& rows) {
    std::array<double, 2 * most_nodes> motion;
    const Eigen::Index s = rows.of_a.rows() / 2;
    find_at_nodes({.modes = static_cast<int>(rows.of_a.cols()),
                   .rows = static_cast<int>(2 * s),
                   .of_a = rows.of_a.data(),
                   .of_rate = rows.of_rate.data(),
                   .a = from.a.data(),
                   .rate = from.rate.data(),
                   .motion = motion.data()});
    displacement = Eigen::Map<const Eigen::VectorXd>(motion.data(), s);
    velocity = Eigen::Map<const Eigen::VectorXd>(motion.data() + s, s);
  };
  if (stop == 0)
    coast_by(response_);
  else
    coast_by(further_[static_cast<std::size_t>(stop - 1)]);
}

void ModalStep::move(const ModalState& from, const double* force, ModalState& to) const {
  find_at_end({.modes = static_cast<int>(a_of_force_.rows()),
               .nodes = static_cast<int>(a_of_force_.cols()),
               .a_of_a = a_of_a_.data(),
               .a_of_rate = a_of_rate_.data(),
               .rate_of_a = rate_of_a_.data(),
               .rate_of_rate = rate_of_rate_.data(),
               .a_of_force = a_of_force_.data(),
               .rate_of_force = rate_of_force_.data(),
               .a = from.a.data(),
               .rate = from.rate.data(),
               .force = force,
               .end_a = to.a.data(),
               .end_rate = to.rate.data()});
}

void ModalStep::coast(const ModalState& from, ModalState& to) const {
  move(from, nullptr, to);
}

void ModalStep::advance(const ModalState& from, const NodeVector& force, ModalState& to) const {
  move(from, force.data(), to);
}

void ModalStep::advance(const ModalState& from, std::span<const NodeVector> forces,
                        ModalState& to) const {
  advance(from, forces[0], to);
  for (std::size_t k = 1; k < forces.size(); ++k)
    if (!forces[k].isZero(0.0)) add(static_cast<int>(k), forces[k], to);
}

void ModalStep::add(int stop, const NodeVector& force, ModalState& to) const {
  const Further& further = further_[static_cast<std::size_t>(stop - 1)];
  to.a.noalias() += further.a_of_force * force;
  to.rate.noalias() += further.rate_of_force * force;
}

PointMotion advance(const ModalBeam& beam, double h, const NodeVector& series,
                    const ModalState& from, ModalState& to, double* acceleration) {
  ModesUnderForce modes{.modes = beam.modes(),
                        .terms = static_cast<int>(series.size()),
                        .omega = beam.omega().data(),
                        .struck = beam.struck().data(),
                        .damping = beam.damped() ? beam.damping().data() : nullptr,
                        .h = h,
                        .series = series.any() ? series.data() : nullptr,
                        .a = from.a.data(),
                        .rate = from.rate.data(),
                        .end_a = to.a.data(),
                        .end_rate = to.rate.data()};
  move(modes);
  if (acceleration) *acceleration = modes.acceleration;
  return {modes.displacement, modes.velocity};
}

void advance(const ModalBeam& beam, double h, std::span<const NodeVector> series,
             const ModalState& from, ModalState& to) {
  advance(beam, h, series[0], from, to);
  for (std::size_t k = 1; k < series.size(); ++k)
    if (!series[k].isZero(0.0)) add_force(beam, static_cast<int>(k), h, series[k], to);
}

void add_force(const ModalBeam& beam, int stop, double h, const NodeVector& series,
               ModalState& to) {
  static thread_local Eigen::VectorXd rest, a, rate;  // within steps: no allocation
  rest.setZero(beam.modes());
  a.resize(beam.modes());
  rate.resize(beam.modes());
  ModesUnderForce modes{.modes = beam.modes(),
                        .terms = static_cast<int>(series.size()),
                        .omega = beam.omega().data(),
                        .struck = beam.struck(stop).data(),
                        .damping = beam.damped() ? beam.damping().data() : nullptr,
                        .h = h,
                        .series = series.data(),
                        .a = rest.data(),
                        .rate = rest.data(),
                        .end_a = a.data(),
                        .end_rate = rate.data()};
  move(modes);
  to.a += a;
  to.rate += rate;
}

}  // namespace impactrig::models
