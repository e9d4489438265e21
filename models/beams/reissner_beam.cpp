// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/reissner_beam.hpp"

#include <cmath>

namespace impactrig::models {
namespace {

using Element = ReissnerElement;

std::vector<Element> elements_of(const Rig& rig, std::array<int, 2> elements) {
  std::vector<Element> bar;
  for (const BarElement& element : bar_elements(rig.beam, rig.contact.position, elements))
    bar.emplace_back(element);
  return bar;
}

}  // namespace

ReissnerBeam::ReissnerBeam(const Rig& rig, std::array<int, 2> elements)
    : elements_(elements_of(rig, elements)),
      linear_(rig, bar_elements(rig.beam, rig.contact.position, elements)),
      struck_(Element::own * elements[0] - held),
      struck_place_(rig.contact.position),
      gravity_(rig.gravity_along()),
      gravity_across_(rig.gravity_across()),
      further_stops_(rig.further_stops),
      hinge_(rig.hinge),
      damping_(rig.beam.damping),
      inertia_(rig.beam.hinge_inertia()),
      weight_force_(Eigen::VectorXd::Zero(size())),
      reference_(Eigen::VectorXd::Zero(size())),
      mass_(size(), size()) {
  for (const Element& element : elements_) masses_.push_back(element.mass());
  for (const LumpedMass& lump : rig.beam.masses) {
    const Row row = row_at(lump.position);
    const BarElement& bar = elements_[row.element].bar();
    const Element::Vector along = Element::along((lump.position - bar.x) / bar.length);
    masses_[row.element] +=
        lump.mass * (row.shape * row.shape.transpose() + along * along.transpose());
  }
  Element::Vector shift = Element::Vector::Zero();  // of the whole bar, by the weight's direction
  for (const std::size_t end : {Element::x0, Element::x1}) {
    shift[end] = gravity_across_;
    shift[end + Element::u0] = gravity_;
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    Values weight;
    Element::Vector::Map(weight.data()) = masses_[e] * shift;
    scatter(weight, e, -1.0, weight_force_);
    const int first = Element::own * static_cast<int>(e) - held;
    for (int r = 0; r < Element::values; ++r)
      for (int c = 0; c < Element::values; ++c)
        if (first + r >= 0 && first + c >= 0 && masses_[e](r, c) != 0.0)
          entries.emplace_back(first + r, first + c, masses_[e](r, c));
    reference_[first + static_cast<int>(Element::turn0)] = 1.0;
    reference_[first + static_cast<int>(Element::turn1)] = 1.0;
    reference_[first + static_cast<int>(Element::x1)] =
        elements_[e].bar().x + elements_[e].bar().length;
  }
  mass_.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(mass_);
}

ReissnerBeam::Values ReissnerBeam::gather(ConstVector q, std::size_t element) const {
  Values values;
  const int first = Element::own * static_cast<int>(element) - held;
  for (int i = 0; i < Element::values; ++i)
    values[static_cast<std::size_t>(i)] = first + i < 0 ? 0.0 : q[first + i];
  return values;
}

void ReissnerBeam::scatter(const Values& values, std::size_t element, double factor,
                           VectorRef to) const {
  const int first = Element::own * static_cast<int>(element) - held;
  for (int i = 0; i < Element::values; ++i)
    if (first + i >= 0) to[first + i] += factor * values[static_cast<std::size_t>(i)];
}

Eigen::VectorXd ReissnerBeam::inertia_diagonal() const {
  return mass_.diagonal();
}

void ReissnerBeam::set_rigid_motion(double angle, double rate, VectorRef q, VectorRef v) const {
  q.setZero();
  v.setZero();
  q[0] = -angle;
  v[0] = -rate;
  const double half = std::sin(0.5 * angle);
  for (int e = 0; e < count(); ++e) {
    const BarElement& bar = elements_[static_cast<std::size_t>(e)].bar();
    const double x = bar.x + bar.length;
    const int node = Element::own * (e + 1) - held;
    q.segment<3>(node) << -x * std::sin(angle), 2.0 * half * half * x, -angle;
    v.segment<3>(node) << -x * std::cos(angle) * rate, x * std::sin(angle) * rate, -rate;
  }
}

bool ReissnerBeam::set_steady_motion(double angle, double rate, VectorRef q, VectorRef v) const {
  const double pull = gravity_ * std::cos(angle) + gravity_across_ * std::sin(angle);
  const std::optional<Eigen::VectorXd> stretch = steady_stretch(pull, rate);
  if (!stretch) {
    set_rigid_motion(angle, rate, q, v);
    return false;
  }
  const double turning = rate * struck_place_ / (struck_place_ + (*stretch)[struck_ + 1]);
  set_rigid_motion(angle, turning, q, v);
  const double sine = std::sin(angle), cosine = std::cos(angle);
  for (int k = 0; k + 1 < size(); ++k) {
    const double more = (*stretch)[k + 1];
    if (more == 0.0) continue;
    q[k] -= sine * more;
    q[k + 1] -= cosine * more;
    v[k] -= cosine * turning * more;
    v[k + 1] += sine * turning * more;
  }
  return true;
}

/// Stretch of the straight bar, in the places of U, by a field [m/s²] and its turning [rad/s] that
/// pull from the hinge; none where they tear it.
std::optional<Eigen::VectorXd> ReissnerBeam::steady_stretch(double pull, double rate) const {
  constexpr std::array along = {Element::u0, Element::ua, Element::uc, Element::u1};
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(size());
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const BarElement& bar = elements_[e].bar();
    Element::Vector field = Element::Vector::Zero();
    field[Element::u0] = pull + rate * rate * bar.x;
    field[Element::u1] = pull + rate * rate * (bar.x + bar.length);
    Values share;
    Element::Vector::Map(share.data()) = masses_[e] * field;
    scatter(share, e, 1.0, force);
    const Element::Matrix stiffness = elements_[e].stiffness({}) - rate * rate * masses_[e];
    const int first = Element::own * static_cast<int>(e) - held;
    for (const int r : along)
      for (const int c : along)
        if (first + r >= 0 && first + c >= 0)
          entries.emplace_back(first + r, first + c, stiffness(r, c));
    for (const int r : {Element::turn0, Element::xa, Element::xc, Element::turn_b, Element::x1,
                        Element::turn1})  // as they are
      entries.emplace_back(first + r, first + r, 1.0);
  }
  Eigen::SparseMatrix<double> matrix(size(), size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      factor(matrix);
  if (factor.info() != Eigen::Success) return std::nullopt;
  return factor.solve(force).eval();
}

void ReissnerBeam::subtract_damping(ConstVector q, ConstVector v, VectorRef force) const {
  force[0] -= hinge_.viscous * v[0];
  if (damping_.stiffness == 0.0) return;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    Values share{};
    elements_[e].add_damping_force<double>(damping_.stiffness, gather(q, e), gather(v, e), share);
    scatter(share, e, -1.0, force);
  }
}

void ReissnerBeam::acceleration(ConstVector q, ConstVector v, std::span<const double> forces,
                                VectorRef a) {
  a = weight_force_;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    Values share{};
    elements_[e].add_elastic_force<double>(gather(q, e), share);
    scatter(share, e, -1.0, a);
  }
  a[0] -= hinge_.spring * q[0];
  subtract_damping(q, v, a);
  a[struck_] += forces[0];
  for (std::size_t i = 1; i < forces.size(); ++i) {
    const FurtherStop& stop = further_stops_[i - 1];
    const Row row = row_at(stop.contact.position);
    Values share;
    Element::Vector::Map(share.data()) = row.shape;
    scatter(share, row.element, stop.direction() * forces[i], a);
  }
  a = factor_.solve(a).eval();
  a -= damping_.mass * v;
}

PointMotion ReissnerBeam::struck_point(ConstVector q, ConstVector v) const {
  return {-q[struck_], -v[struck_]};
}

double ReissnerBeam::struck_acceleration(ConstVector /*q*/, ConstVector /*v*/,
                                         ConstVector a) const {
  return -a[struck_];
}

double ReissnerBeam::point_acceleration(double x, ConstVector q, ConstVector /*v*/,
                                        ConstVector a) const {
  return point(x, q, a).velocity;
}

std::size_t ReissnerBeam::element_at(double x) const {
  std::size_t e = 0;
  while (e + 1 < elements_.size() && x > elements_[e + 1].bar().x) ++e;
  return e;
}

ReissnerBeam::Row ReissnerBeam::row_at(double x) const {
  const std::size_t e = element_at(x);
  const BarElement& bar = elements_[e].bar();
  return {e, Element::across((x - bar.x) / bar.length)};
}

ReissnerBeam::Row ReissnerBeam::slope_row_at(double x) const {
  const std::size_t e = element_at(x);
  const BarElement& bar = elements_[e].bar();
  return {e, Element::across_slope((x - bar.x) / bar.length) / bar.length};
}

PointMotion ReissnerBeam::point(double x, ConstVector q, ConstVector v) const {
  const Row row = row_at(x);
  const Values place = gather(q, row.element), speed = gather(v, row.element);
  return {-row.shape.dot(Element::Vector::Map(place.data())),
          -row.shape.dot(Element::Vector::Map(speed.data()))};
}

std::vector<int> ReissnerBeam::coordinates_of(double x) const {
  const int first = Element::own * static_cast<int>(row_at(x).element) - held;
  std::vector<int> places;
  for (const std::size_t place : {Element::x0, Element::xa, Element::xc, Element::x1})
    if (first + static_cast<int>(place) >= 0) places.push_back(first + static_cast<int>(place));
  return places;
}

SmallMotion ReissnerBeam::small_motion() const {
  return linear_.small_motion();
}

Eigen::VectorXd ReissnerBeam::small_motion_row(double x) const {
  return linear_.small_motion_row(x);
}

Eigen::VectorXd ReissnerBeam::small_motion_load() const {
  return linear_.small_motion_load();
}

Eigen::MatrixXd ReissnerBeam::own_values(const Eigen::MatrixXd& shapes) const {
  return linear_.own_values(shapes);
}

Eigen::MatrixXd ReissnerBeam::shapes_of(const Eigen::MatrixXd& own) const {
  return linear_.shapes_of(own);
}

Eigen::MatrixXd ReissnerBeam::strains(const Eigen::MatrixXd& own) const {
  return linear_.strains(own);
}

double ReissnerBeam::damping_power(ConstVector q, ConstVector v) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(size());
  subtract_damping(q, v, force);
  return damping_.mass * v.dot(mass_ * v) - force.dot(v);
}

BeamEnergy ReissnerBeam::energy(ConstVector q, ConstVector v) const {
  BeamEnergy energy;
  energy.kinetic = 0.5 * v.dot(mass_ * v);
  energy.gravitational = -weight_force_.dot(q);
  energy.spring = 0.5 * hinge_.spring * q[0] * q[0];
  for (std::size_t e = 0; e < elements_.size(); ++e)
    energy.elastic += elements_[e].elastic_energy(gather(q, e));
  return energy;
}

/// With the moment of momentum ∫ρA (X Ẏ − Y Ẋ) + ρI Θ̇ dx, Y = −x + U, counted positive while
/// closing.
RigidPart ReissnerBeam::rigid_part(ConstVector q, ConstVector v) const {
  RigidPart rigid;
  rigid.angle = -reference_.dot(mass_ * q) / inertia_;
  Eigen::VectorXd arm = reference_;
  Eigen::VectorXd raised = Eigen::VectorXd::Zero(size());
  const int pairs[] = {Element::x0, Element::xa, Element::xc};
  for (int first = -held; first < size(); first += Element::own)
    for (const int x : pairs) {
      const int k = first + x;
      if (k < 0 || k + 1 >= size()) continue;
      arm[k] -= q[k + 1];
      arm[k + 1] = q[k];
      raised[k] = q[k + 1];
    }
  rigid.along = 1.0 - reference_.dot(mass_ * raised) / inertia_;
  rigid.rate = -arm.dot(mass_ * v) / inertia_;
  return rigid;
}

}  // namespace impactrig::models
