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
  using Series = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, most_terms, 2>;
  using AtNodes = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, most_nodes * most_nodes, 2>;

  Kernels(int terms, int nodes)
      : blocks((terms + Collocation::block_size - 1) / Collocation::block_size),
        series(Series::Zero(blocks * Collocation::block_size, 2)),
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
    AtNodes at_nodes = AtNodes::Zero(s * s, 2);
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
  Series series;
  NodeMatrix early_displacement, early_velocity;
};

void respond(const ModesOverStep& modes) {
  modes.damping ? step_damped_modes(modes) : step_modes(modes);
}

}  // namespace

double ModalStep::longest(const ModalBeam& beam) {
  const double highest = fastest_in_series(beam, std::nullopt);
  return highest > 0.0 ? longest_phase / highest : std::numeric_limits<double>::infinity();
}

ModalStep::ModalStep(const ModalBeam& beam, const Collocation& rule, double h)
    : ModalStep(h, beam.modes(), rule.nodes()) {
  const double phase = h * fastest_in_series(beam, h);
  if (phase > longest_phase * (1.0 + slack))
    throw std::logic_error("ModalStep: the step is too long for the highest mode");
  const int s = rule.nodes();
  const int terms = std::max(terms_needed(phase), s);
  Kernels kernels(terms, s);
  ModesOverStep modes = modes_over(beam, rule, h, 0, 0);
  modes.of_a = at(Part::of_a);
  modes.of_rate = at(Part::of_rate);
  modes.a_of_force = at(Part::a_of_force);
  modes.rate_of_force = at(Part::rate_of_force);
  modes.a_of_a = at(Part::a_of_a);
  modes.a_of_rate = at(Part::a_of_rate);
  modes.rate_of_a = at(Part::rate_of_a);
  modes.rate_of_rate = at(Part::rate_of_rate);
  modes.terms = terms;
  kernels.write_to(modes);
  respond(modes);
  Eigen::Map<Eigen::VectorXd>(at(Part::a_of_unit_force), modes_) =
      Rows(at(Part::a_of_force), modes_, nodes_).rowwise().sum();
  Eigen::Map<Eigen::VectorXd>(at(Part::rate_of_unit_force), modes_) =
      Rows(at(Part::rate_of_force), modes_, nodes_).rowwise().sum();
  kernels.respond_to_force(rule, h, response_);
  if (beam.stops() > 1) respond_further(beam, rule, terms);
}

ModalStep::ModalStep(double h, Eigen::Index modes, Eigen::Index nodes)
    : h_(h),
      modes_(modes),
      nodes_(nodes),
      numbers_(place(Part::end, modes, nodes)) {
  response_.displacement_of_force.resize(nodes, nodes);
  response_.velocity_of_force.resize(nodes, nodes);
}

Eigen::Index ModalStep::place(Part part, Eigen::Index modes, Eigen::Index nodes) {
  const auto number = static_cast<Eigen::Index>(part);
  const auto of_force = static_cast<Eigen::Index>(Part::a_of_force);
  const auto of_state = static_cast<Eigen::Index>(Part::of_a);
  if (number <= of_force) return number * modes;
  if (number <= of_state) return (of_force + (number - of_force) * nodes) * modes;
  return (of_force + (of_state - of_force) * nodes + (number - of_state) * 2 * nodes) * modes;
}

ModalStep::Scale::Scale(int modes, int nodes, double time, double mass)
    : time_(time),
      of_numbers_(place(Part::end, modes, nodes)),
      of_displacement_(NodeMatrix::Constant(nodes, nodes, time * time / mass)),
      of_velocity_(NodeMatrix::Constant(nodes, nodes, time / mass)) {
  const double root = std::sqrt(mass);
  const auto set = [&](Part first, Part last, double factor) {
    const Eigen::Index begin = place(first, modes, nodes);
    of_numbers_.segment(begin, place(last, modes, nodes) - begin).setConstant(factor);
  };
  const auto set_rows = [&](Part part, double of_displacement, double of_velocity) {
    Eigen::Map<Eigen::MatrixXd> rows(of_numbers_.data() + place(part, modes, nodes), 2 * nodes,
                                     modes);
    rows.topRows(nodes).setConstant(of_displacement);
    rows.bottomRows(nodes).setConstant(of_velocity);
  };
  set(Part::a_of_a, Part::a_of_rate, 1.0);
  set(Part::a_of_rate, Part::rate_of_a, time);
  set(Part::rate_of_a, Part::rate_of_rate, 1.0 / time);
  set(Part::rate_of_rate, Part::a_of_unit_force, 1.0);
  set(Part::a_of_unit_force, Part::rate_of_unit_force, time * time / root);
  set(Part::rate_of_unit_force, Part::a_of_force, time / root);
  set(Part::a_of_force, Part::rate_of_force, time * time / root);
  set(Part::rate_of_force, Part::of_a, time / root);
  set_rows(Part::of_a, 1.0 / root, 1.0 / (root * time));
  set_rows(Part::of_rate, time / root, 1.0 / root);
}

ModalStep ModalStep::sum(std::span<const ModalStep* const> steps, std::span<const double> weights,
                         double h, const Scale* scale) {
  const ModalStep& first = *steps.front();
  ModalStep total(h, first.modes_, first.nodes_);
  total.further_ = first.further_;
  total.of_force_ = first.of_force_;
  total.become_sum(steps, weights, h, scale);
  return total;
}

void ModalStep::become_sum(std::span<const ModalStep* const> steps, std::span<const double> weights,
                           double h, const Scale* scale) {
  h_ = h;
  std::vector<const double*> arrays(steps.size());
  const auto combine = [&](const auto& part, const double* factors) {
    for (std::size_t j = 0; j < steps.size(); ++j) arrays[j] = part(*steps[j]).data();
    auto& to = part(*this);
    find_sum({.count = static_cast<int>(to.size()),
              .terms = static_cast<int>(steps.size()),
              .arrays = arrays.data(),
              .weights = weights.data(),
              .factors = factors,
              .sum = to.data()});
  };
  combine(
      [](auto& step) -> auto& { return step.numbers_; },
      scale ? scale->of_numbers_.data() : nullptr);
  combine(
      [](auto& step) -> auto& { return step.response_.displacement_of_force; },
      scale ? scale->of_displacement_.data() : nullptr);
  combine(
      [](auto& step) -> auto& { return step.response_.velocity_of_force; },
      scale ? scale->of_velocity_.data() : nullptr);
  response_.set_most();
  for (std::size_t k = 0; k < further_.size(); ++k)
    for (const auto matrix :
         {&Further::of_a, &Further::of_rate, &Further::a_of_force, &Further::rate_of_force})
      combine(
          [&](auto& step) -> auto& { return step.further_[k].*matrix; }, nullptr);
  for (std::size_t k = 0; k < of_force_.size(); ++k) {
    combine(
        [&](auto& step) -> auto& { return step.of_force_[k].displacement_of_force; }, nullptr);
    combine(
        [&](auto& step) -> auto& { return step.of_force_[k].velocity_of_force; }, nullptr);
  }
}

ModalStep ModalStep::joined(std::span<const Share> shares, Eigen::Index m) {
  const ModalStep& first = *shares.front().step;
  ModalStep all(first.h_, m, first.nodes_);
  all.further_.resize(first.further_.size());
  all.of_force_.resize(first.of_force_.size());
  all.set_zero();
  for (const Share& share : shares) all.add(share);
  all.response_.set_most();
  return all;
}

void ModalStep::set_zero() {
  numbers_.setZero();
  const auto clear = [this](BarMotion::Response& response) {
    response.displacement_of_force = response.velocity_of_force = NodeMatrix::Zero(nodes_, nodes_);
  };
  clear(response_);
  for (BarMotion::Response& response : of_force_) clear(response);
  for (Further& further : further_) {
    further.of_a = further.of_rate = Eigen::MatrixXd::Zero(2 * nodes_, modes_);
    further.a_of_force = further.rate_of_force = Eigen::MatrixXd::Zero(modes_, nodes_);
  }
}

void ModalStep::add(const Share& share) {
  using Numbers = Eigen::Map<Eigen::MatrixXd>;
  const ModalStep& step = *share.step;
  const std::vector<Eigen::Index>& modes = *share.modes;
  for (auto number = static_cast<int>(Part::a_of_a); number < static_cast<int>(Part::end);
       ++number) {
    const auto part = static_cast<Part>(number);
    if (part >= Part::of_a) {
      Numbers(at(part), 2 * nodes_, modes_)(Eigen::all, modes) =
          Rows(step.at(part), 2 * nodes_, step.modes_);
      continue;
    }
    const Eigen::Index each = part >= Part::a_of_force ? nodes_ : 1;
    Numbers(at(part), modes_, each)(modes, Eigen::all) = Rows(step.at(part), step.modes_, each);
  }
  for (std::size_t k = 0; k < further_.size(); ++k) {
    further_[k].of_a(Eigen::all, modes) = step.further_[k].of_a;
    further_[k].of_rate(Eigen::all, modes) = step.further_[k].of_rate;
    further_[k].a_of_force(modes, Eigen::all) = step.further_[k].a_of_force;
    further_[k].rate_of_force(modes, Eigen::all) = step.further_[k].rate_of_force;
  }
  const auto add_response = [](const BarMotion::Response& one, BarMotion::Response& to) {
    to.displacement_of_force += one.displacement_of_force;
    to.velocity_of_force += one.velocity_of_force;
  };
  add_response(step.response_, response_);
  for (std::size_t k = 1; k < of_force_.size(); ++k)  // the first is response_
    add_response(step.of_force_[k], of_force_[k]);
}

/// A mode moves by its rate for a time h or, where it vibrates faster, for 1/ω.
double ModalStep::distance(const ModalStep& other, const ModalBeam& beam) const {
  const Eigen::ArrayXd squares = beam.omega().array().square();
  const Eigen::ArrayXd time = (1.0 + squares * h_ * h_).rsqrt() * h_;
  const double struck = beam.struck().cwiseAbs().maxCoeff();
  double most = 0.0;
  const auto compare = [&](Part part, Eigen::Index rows, Eigen::Index first, Eigen::Index count,
                           const Eigen::ArrayXd& scale) {
    const Rows here(at(part), rows, modes_), there(other.at(part), rows, modes_);
    const auto apart = (here - there).middleRows(first, count).cwiseAbs().colwise().maxCoeff();
    most = std::max(most, (apart.transpose().array() / scale).maxCoeff());
  };
  const Eigen::ArrayXd one = Eigen::ArrayXd::Ones(modes_);
  compare(Part::a_of_a, 1, 0, 1, one);
  compare(Part::a_of_rate, 1, 0, 1, time);
  compare(Part::rate_of_a, 1, 0, 1, (squares * time).max(1e-300));
  compare(Part::rate_of_rate, 1, 0, 1, one);
  compare(Part::of_a, 2 * nodes_, 0, nodes_, struck * one);
  compare(Part::of_a, 2 * nodes_, nodes_, nodes_, struck * (squares * time).max(1e-300));
  compare(Part::of_rate, 2 * nodes_, 0, nodes_, struck * time);
  compare(Part::of_rate, 2 * nodes_, nodes_, nodes_, struck * one);
  const auto compare_answers = [&](Part part, const Eigen::ArrayXd& scale) {
    const Rows here(at(part), modes_, nodes_), there(other.at(part), modes_, nodes_);
    const auto apart = (here - there).cwiseAbs().rowwise().maxCoeff();
    most = std::max(most, (apart.array() / scale).maxCoeff());
  };
  compare_answers(Part::a_of_force, struck * h_ * time);
  compare_answers(Part::rate_of_force, struck * time);
  const auto apart = [](const NodeMatrix& here, const NodeMatrix& there) {
    return (here - there).cwiseAbs().maxCoeff();
  };
  const BarMotion::Response& answer = other.response_;
  most = std::max(
      {most,
       apart(response_.displacement_of_force, answer.displacement_of_force) /
           answer.most_displacement,
       apart(response_.velocity_of_force, answer.velocity_of_force) / answer.most_velocity});
  return most;
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
      modes.of_a = further.of_a.data();
      modes.of_rate = further.of_rate.data();
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
  const Further* further = stop == 0 ? nullptr : &further_[static_cast<std::size_t>(stop - 1)];
  std::array<double, 2 * most_nodes> motion;
  find_at_nodes({.modes = static_cast<int>(modes_),
                 .rows = static_cast<int>(2 * nodes_),
                 .of_a = further ? further->of_a.data() : at(Part::of_a),
                 .of_rate = further ? further->of_rate.data() : at(Part::of_rate),
                 .a = from.a.data(),
                 .rate = from.rate.data(),
                 .motion = motion.data()});
  displacement = Eigen::Map<const Eigen::VectorXd>(motion.data(), nodes_);
  velocity = Eigen::Map<const Eigen::VectorXd>(motion.data() + nodes_, nodes_);
}

void ModalStep::move(const ModalState& from, const double* force, ModalState& to) const {
  find_at_end({.modes = static_cast<int>(modes_),
               .nodes = static_cast<int>(nodes_),
               .a_of_a = at(Part::a_of_a),
               .a_of_rate = at(Part::a_of_rate),
               .rate_of_a = at(Part::rate_of_a),
               .rate_of_rate = at(Part::rate_of_rate),
               .a_of_force = at(Part::a_of_force),
               .rate_of_force = at(Part::rate_of_force),
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
