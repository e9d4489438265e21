// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/ancf.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/integration/gauss.hpp"

namespace impactrig::models {
namespace {

/// d/dξ of the cubic Hermite shape functions (19) of an element of unit length.
Eigen::Vector4d shape_slope(double xi) {
  const double s = xi * xi;
  return {-6.0 * xi + 6.0 * s, 1.0 - 4.0 * xi + 3.0 * s, 6.0 * xi - 6.0 * s, 3.0 * s - 2.0 * xi};
}

/// d²S/dx².
Eigen::Vector4d shape_curvature(double xi, double l) {
  return {(12.0 * xi - 6.0) / (l * l), (6.0 * xi - 4.0) / l, (6.0 - 12.0 * xi) / (l * l),
          (6.0 * xi - 2.0) / l};
}

/// Rotations of both ends of an element against its chord: what bending is made of. In them a rigid
/// rotation leaves rounding only, and the energy its square.
struct EndRotations {
  EndRotations(const Eigen::Vector4d& u, double l)
      : first(u[1] - (u[2] - u[0]) / l),
        second(u[3] - (u[2] - u[0]) / l) {}

  double first, second;
};

/// ∫ S_xx'S_xx dx applied to nodal values: bending force, without EI.
Eigen::Vector4d bending_force(const Eigen::Vector4d& u, double l) {
  const EndRotations rotation(u, l);
  const double first = (4.0 * rotation.first + 2.0 * rotation.second) / l;
  const double second = (2.0 * rotation.first + 4.0 * rotation.second) / l;
  const double shear = (first + second) / l;
  return {shear, first, -shear, second};
}

/// ½ ∫ u_xx² dx.
double bending_energy(const Eigen::Vector4d& u, double l) {
  const EndRotations r(u, l);
  return 2.0 / l * (r.first * r.first + r.first * r.second + r.second * r.second);
}

std::vector<BarElement> elements_of(const Rig& rig, std::array<int, 2> elements) {
  if (rig.beam.shears())
    throw std::invalid_argument("beam.theory: AncfBeam does not shear, ReissnerBeam does");
  return bar_elements(rig.beam, rig.contact.position, elements);
}

}  // namespace

AncfBeam::AncfBeam(const Rig& rig, std::array<int, 2> elements)
    : elements_(elements_of(rig, elements)),
      linear_(rig, elements_),
      dofs_(2 * (elements[0] + elements[1]) + 1),
      struck_dof_(2 * elements[0] - 1),
      gravity_(rig.gravity_along()),
      gravity_across_(rig.gravity_across()),
      hinge_(rig.hinge),
      damping_(rig.beam.damping),
      further_stops_(rig.further_stops),
      inertia_(rig.beam.hinge_inertia()),
      masses_(rig.beam.masses),
      reference_(dofs_),
      weight_(Eigen::VectorXd::Zero(dofs_)),
      mass_([&] {
        BandMatrix mass(dofs_);
        const auto add = [&](std::size_t e, const Eigen::Matrix4d& m) {
          for (int i = 0; i < 4; ++i)
            for (int j = 0; j <= i; ++j) {
              const int row = e == 0 && i == 1 ? 0 : first_dof(e) + i;
              const int column = e == 0 && j == 1 ? 0 : first_dof(e) + j;
              const bool hinge = e == 0 && (i == 0 || j == 0);
              if (!hinge) mass.add(row, column, m(i, j));
            }
        };
        for (std::size_t e = 0; e < elements_.size(); ++e)
          add(e, elements_[e].mass().topLeftCorner<4, 4>());
        for (const LumpedMass& lump : masses_) {
          const std::size_t e = element_at(elements_, lump.position);
          const Nodal s = shape_at(e, lump.position);
          add(e, lump.mass * s * s.transpose());
        }
        return mass;
      }()),
      factor_(mass_) {
  const GaussRule& rule = gauss_legendre(5);
  for (std::size_t g = 0; g < 5; ++g) {
    slope_shapes_[g] = shape_slope(rule.points[g]);
    points_[g] = rule.points[g];
    weights_[g] = rule.weights[g];
  }
  reference_[0] = 1.0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    reference_[first_dof(e) + 2] = elements_[e].x + elements_[e].length;
    reference_[first_dof(e) + 3] = 1.0;
    const double l = elements_[e].length;
    add_weight(e, elements_[e].line_density * l * Nodal(0.5, l / 12.0, 0.5, -l / 12.0));
  }
  for (const LumpedMass& lump : masses_) {
    const std::size_t e = element_at(elements_, lump.position);
    add_weight(e, lump.mass * shape_at(e, lump.position));
  }
}

void AncfBeam::add_weight(std::size_t e, const Nodal& share) {
  for (int i = 0; i < 4; ++i)
    if (e > 0 || i > 0) weight_[e == 0 && i == 1 ? 0 : first_dof(e) + i] += share[i];
}

AncfBeam::Nodal AncfBeam::gather(ConstVector part, std::size_t element) const {
  if (element == 0) return {0.0, part[0], part[1], part[2]};
  return part.segment<4>(first_dof(element));
}

Eigen::VectorXd AncfBeam::inertia_diagonal() const {
  Eigen::VectorXd diagonal(size());
  for (int i = 0; i < dofs_; ++i) diagonal[i] = diagonal[dofs_ + i] = mass_.at(i, i);
  return diagonal;
}

/// `stretch`: how much further from the hinge the nodes are than as the bar is made, and how that
/// is spread.
void AncfBeam::set_straight(const Eigen::VectorXd& stretch, double angle, double rate, VectorRef q,
                            VectorRef v) const {
  // X = −x sin(angle), Y = −x cos(angle)
  const double half = std::sin(0.5 * angle);
  const Eigen::VectorXd along = reference_ + stretch;
  q.head(dofs_) = -std::sin(angle) * along;
  q.tail(dofs_) = 2.0 * half * half * reference_ - std::cos(angle) * stretch;
  v.head(dofs_) = -std::cos(angle) * rate * along;
  v.tail(dofs_) = std::sin(angle) * rate * along;
}

void AncfBeam::set_rigid_motion(double angle, double rate, VectorRef q, VectorRef v) const {
  set_straight(Eigen::VectorXd::Zero(dofs_), angle, rate, q, v);
}

bool AncfBeam::set_steady_motion(double angle, double rate, VectorRef q, VectorRef v) const {
  const double pull = gravity_ * std::cos(angle) + gravity_across_ * std::sin(angle);
  const std::optional<Eigen::VectorXd> stretch = steady_stretch(pull, rate);
  if (!stretch) {
    set_rigid_motion(angle, rate, q, v);
    return false;
  }
  const double place = reference_[struck_dof_];
  set_straight(*stretch, angle, rate * place / (place + (*stretch)[struck_dof_]), q, v);
  return true;
}

/// Stretch of a straight bar by a field [m/s²] and its turning [rad/s] that pull from the hinge, by
/// Newton's method; none where that finds none, as where it is pressed too hard to stand. Solved
/// for how much each element stretches: the places of nodes close to each other would round away
/// what short elements do. A bar that is pulled resists more the further it stretches: Newton's
/// steps come down to where it holds, however far the first.
std::optional<Eigen::VectorXd> AncfBeam::steady_stretch(double pull, double rate) const {
  constexpr int most_iterations = 100;
  Eigen::VectorXd parts = Eigen::VectorXd::Zero(dofs_), stretch = parts, force(dofs_);
  double last = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    BandMatrix stiffness(dofs_);
    mass_.multiply(reference_ + stretch, force);
    force = rate * rate * force + pull * weight_;
    for (int i = dofs_ - 2; i > 1; i -= 2) force[i - 2] += force[i];  // on all nodes beyond
    for (std::size_t e = 0; e < elements_.size(); ++e) add_axial(e, parts, force, stiffness);
    try {
      BandCholesky(stiffness).solve_in_place(force);
    } catch (const std::invalid_argument&) {
      return std::nullopt;
    }
    parts += force;
    stretch = parts;
    for (int i = 3; i < dofs_; i += 2) stretch[i] += stretch[i - 2];
    for (int i = 3; i < dofs_; i += 2) force[i] += force[i - 2];
    const double change = force.norm() / reference_.norm();
    if (!std::isfinite(change)) return std::nullopt;
    // rounding is left
    if (change < 1e-12 * stretch.norm() / reference_.norm() || change >= last) {
      if (turned_over(parts)) return std::nullopt;
      return stretch;
    }
    if (change < 1e-6) last = change;
  }
  return std::nullopt;
}

/// Whether an element of a bar that stretches like this ends before its beginning: pressed through
/// itself, it would hang from the hinge.
bool AncfBeam::turned_over(const Eigen::VectorXd& parts) const {
  for (std::size_t e = 0; e < elements_.size(); ++e)
    if (!(elements_[e].length + parts[2 * static_cast<Eigen::Index>(e) + 1] > 0.0)) return true;
  return false;
}

/// What an element's stretch resists, along the bar, off the force; and its tangent. Of `parts` the
/// odd ones tell how much further each element's end is from its beginning, the others slopes.
void AncfBeam::add_axial(std::size_t e, const Eigen::VectorXd& parts, Eigen::VectorXd& force,
                         BandMatrix& stiffness) const {
  const double l = elements_[e].length;
  const double bending = elements_[e].bending_stiffness;
  const int first = 2 * static_cast<int>(e);
  const Nodal nodes(0.0, parts[first], parts[first + 1], parts[first + 2]);
  Nodal resisting = bending * bending_force(nodes, l);
  Eigen::Matrix4d tangent;
  for (int i = 0; i < 4; ++i) tangent.col(i) = bending * bending_force(Nodal::Unit(i), l);
  for (std::size_t g = 0; g < 5; ++g) {
    Nodal s = slope_shapes_[g];
    s[0] /= l;
    s[2] /= l;
    const double slope = s.dot(nodes);
    const double strain = slope + 0.5 * slope * slope;
    const double axial = elements_[e].axial_stiffness * weights_[g] * l;
    resisting += axial * strain * (1.0 + slope) * s;
    tangent += axial * (1.0 + 3.0 * strain) * s * s.transpose();
  }
  for (int i = 1; i < 4; ++i) {
    force[first + i - 1] -= resisting[i];
    for (int j = 1; j <= i; ++j) stiffness.add(first + i - 1, first + j - 1, tangent(i, j));
  }
}

void AncfBeam::add_elastic_force(ConstVector q, VectorRef force) const {
  const auto across = q.head(dofs_);
  const auto along = q.tail(dofs_);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const double l = elements_[e].length;
    const Nodal x = gather(across, e);
    const Nodal u = gather(along, e);
    Nodal force_x = -elements_[e].bending_stiffness * bending_force(x, l);
    Nodal force_u = -elements_[e].bending_stiffness * bending_force(u, l);
    for (std::size_t g = 0; g < 5; ++g) {
      Nodal s = slope_shapes_[g];
      s[0] /= l;
      s[2] /= l;
      const double x_slope = s.dot(x);
      const double u_slope = s.dot(u);
      const double strain = 0.5 * (x_slope * x_slope + u_slope * u_slope) - u_slope;
      const double tension = elements_[e].axial_stiffness * strain * weights_[g] * l;
      force_x -= tension * x_slope * s;
      force_u -= tension * (u_slope - 1.0) * s;
    }
    if (e == 0) {
      force.head<3>() += force_x.tail<3>();
      force.segment<3>(dofs_) += force_u.tail<3>();
    } else {
      force.segment<4>(first_dof(e)) += force_x;
      force.segment<4>(dofs_ + first_dof(e)) += force_u;
    }
  }
}

void AncfBeam::add_material_damping(ConstVector q, ConstVector v, VectorRef force) const {
  if (damping_.stiffness == 0.0) return;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const double axial = damping_.stiffness * elements_[e].axial_stiffness;
    const double bending = damping_.stiffness * elements_[e].bending_stiffness;
    const double l = elements_[e].length;
    const Nodal x = gather(q.head(dofs_), e), x_rate = gather(v.head(dofs_), e);
    const Nodal u = gather(q.tail(dofs_), e), u_rate = gather(v.tail(dofs_), e);
    Nodal force_x = Nodal::Zero(), force_u = Nodal::Zero();
    for (std::size_t g = 0; g < 5; ++g) {
      Nodal s = slope_shapes_[g];
      s[0] /= l;
      s[2] /= l;
      const Nodal c = shape_curvature(points_[g], l);
      const double slope_x = s.dot(x), slope_y = s.dot(u) - 1.0;  // r_x
      const double rate_x = s.dot(x_rate), rate_y = s.dot(u_rate);
      const double bent_x = c.dot(x), bent_y = c.dot(u);  // r_xx
      const double square = slope_x * slope_x + slope_y * slope_y;
      const double spin = (slope_x * rate_y - slope_y * rate_x) / square;  // ω
      const double tension = axial * (slope_x * rate_x + slope_y * rate_y);
      const double moment_x = bending * (c.dot(x_rate) + spin * bent_y);  // EI τ D
      const double moment_y = bending * (c.dot(u_rate) - spin * bent_x);
      const double by_spin = (moment_x * bent_y - moment_y * bent_x) / square;
      const double weight = weights_[g] * l;
      force_x -= weight * (moment_x * c + (tension * slope_x - by_spin * slope_y) * s);
      force_u -= weight * (moment_y * c + (tension * slope_y + by_spin * slope_x) * s);
    }
    if (e == 0) {
      force.head<3>() += force_x.tail<3>();
      force.segment<3>(dofs_) += force_u.tail<3>();
    } else {
      force.segment<4>(first_dof(e)) += force_x;
      force.segment<4>(dofs_ + first_dof(e)) += force_u;
    }
  }
}

AncfBeam::HingeAngle AncfBeam::hinge_angle(ConstVector q) const {
  // r_x = (X', U' − 1); hanging straight it is (0, −1), and closing is −X
  const double across = -q[0];
  const double along = 1.0 - q[dofs_];
  const double square = across * across + along * along;
  return {.angle = std::atan2(across, along),
          .by_across = -along / square,
          .by_along = across / square};
}

double AncfBeam::hinge_rate(const HingeAngle& hinge, ConstVector v) const {
  return hinge.by_across * v[0] + hinge.by_along * v[dofs_];
}

void AncfBeam::add_hinge_moment(ConstVector q, ConstVector v, VectorRef force) const {
  if (hinge_ == Hinge{}) return;
  const HingeAngle hinge = hinge_angle(q);
  const double moment = hinge_.spring * hinge.angle + hinge_.viscous * hinge_rate(hinge, v);
  force[0] -= moment * hinge.by_across;
  force[dofs_] -= moment * hinge.by_along;
}

double AncfBeam::damping_power(ConstVector q, ConstVector v) const {
  const double turning = hinge_rate(hinge_angle(q), v);
  double power = hinge_.viscous * turning * turning;
  if (damping_.mass > 0.0) power += 2.0 * damping_.mass * kinetic_energy(v);
  if (damping_.stiffness > 0.0) {
    scratch_.setZero(size());
    add_material_damping(q, v, scratch_);
    power -= scratch_.dot(v);
  }
  return power;
}

void AncfBeam::acceleration(ConstVector q, ConstVector v, std::span<const double> forces,
                            VectorRef a) {
  a.head(dofs_) = -gravity_across_ * weight_;
  a.tail(dofs_) = -gravity_ * weight_;
  add_elastic_force(q, a);
  add_material_damping(q, v, a);
  add_hinge_moment(q, v, a);
  a[struck_dof_] += forces[0];
  for (std::size_t i = 1; i < forces.size(); ++i) {
    const FurtherStop& stop = further_stops_[i - 1];
    const auto [element, shape] = row_at(stop.contact.position);
    const Nodal share = stop.direction() * forces[i] * shape;
    if (element == 0)
      a.head<3>() += share.tail<3>();
    else
      a.segment<4>(first_dof(element)) += share;
  }
  factor_.solve_in_place(a.head(dofs_));
  factor_.solve_in_place(a.tail(dofs_));
  if (damping_.mass > 0.0) a -= damping_.mass * v;
}

PointMotion AncfBeam::struck_point(ConstVector q, ConstVector v) const {
  return {-q[struck_dof_], -v[struck_dof_]};
}

AncfBeam::Row AncfBeam::row_at(double x) const {
  const std::size_t e = element_at(elements_, x);
  return {e, shape_at(e, x)};
}

AncfBeam::Row AncfBeam::slope_row_at(double x) const {
  const std::size_t e = element_at(elements_, x);
  const BarElement& element = elements_[e];
  return {e, element.slope((x - element.x) / element.length).head<4>()};
}

AncfBeam::Nodal AncfBeam::shape_at(std::size_t e, double x) const {
  return elements_[e].deflection((x - elements_[e].x) / elements_[e].length).head<4>();
}

double AncfBeam::struck_acceleration(ConstVector /*q*/, ConstVector /*v*/, ConstVector a) const {
  return -a[struck_dof_];
}

double AncfBeam::point_acceleration(double x, ConstVector q, ConstVector /*v*/,
                                    ConstVector a) const {
  return point(x, q, a).velocity;
}

PointMotion AncfBeam::point(double x, ConstVector q, ConstVector v) const {
  const std::size_t e = element_at(elements_, x);
  const Nodal s = shape_at(e, x);
  return {-s.dot(gather(q.head(dofs_), e)), -s.dot(gather(v.head(dofs_), e))};
}

std::vector<int> AncfBeam::coordinates_of(double x) const {
  const std::size_t e = element_at(elements_, x);
  if (e == 0) return {0, 1, 2};
  const int first = first_dof(e);
  return {first, first + 1, first + 2, first + 3};
}

/// X alone. Gravity acts through the tension it leaves in the hanging bar.
SmallMotion AncfBeam::small_motion() const {
  return linear_.small_motion();
}

Eigen::VectorXd AncfBeam::small_motion_row(double x) const {
  return linear_.small_motion_row(x);
}

Eigen::VectorXd AncfBeam::small_motion_load() const {
  return linear_.small_motion_load();
}

Eigen::MatrixXd AncfBeam::own_values(const Eigen::MatrixXd& shapes) const {
  return linear_.own_values(shapes);
}

Eigen::MatrixXd AncfBeam::shapes_of(const Eigen::MatrixXd& own) const {
  return linear_.shapes_of(own);
}

Eigen::MatrixXd AncfBeam::strains(const Eigen::MatrixXd& own) const {
  return linear_.strains(own);
}

double AncfBeam::kinetic_energy(ConstVector v) const {
  double energy = 0.0;
  Eigen::VectorXd product(dofs_);
  for (int part = 0; part < 2; ++part) {
    const auto rate = v.segment(part * dofs_, dofs_);
    mass_.multiply(rate, product);
    energy += 0.5 * rate.dot(product);
  }
  return energy;
}

BeamEnergy AncfBeam::energy(ConstVector q, ConstVector v) const {
  BeamEnergy energy;
  energy.kinetic = kinetic_energy(v);
  energy.gravitational =
      gravity_ * weight_.dot(q.tail(dofs_)) + gravity_across_ * weight_.dot(q.head(dofs_));
  const double turned = hinge_.spring > 0.0 ? hinge_angle(q).angle : 0.0;
  energy.spring = 0.5 * hinge_.spring * turned * turned;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const double l = elements_[e].length;
    const Nodal x = gather(q.head(dofs_), e);
    const Nodal u = gather(q.tail(dofs_), e);
    energy.elastic +=
        elements_[e].bending_stiffness * (bending_energy(x, l) + bending_energy(u, l));
    for (std::size_t g = 0; g < 5; ++g) {
      Nodal s = slope_shapes_[g];
      s[0] /= l;
      s[2] /= l;
      const double x_slope = s.dot(x);
      const double u_slope = s.dot(u);
      const double strain = 0.5 * (x_slope * x_slope + u_slope * u_slope) - u_slope;
      energy.elastic += 0.5 * elements_[e].axial_stiffness * strain * strain * weights_[g] * l;
    }
  }
  return energy;
}

RigidPart AncfBeam::rigid_part(ConstVector q, ConstVector v) const {
  Eigen::VectorXd product(dofs_);
  mass_.multiply(q.head(dofs_), product);
  RigidPart rigid;
  rigid.angle = -product.dot(reference_) / inertia_;
  // moment of momentum ∫ρA (X Ẏ − Y Ẋ) dx with Y = −x + U, counted positive while closing
  double moment = product.dot(v.tail(dofs_));
  mass_.multiply(v.head(dofs_), product);
  moment += product.dot(reference_ - q.tail(dofs_));
  rigid.rate = -moment / inertia_;
  mass_.multiply(q.tail(dofs_), product);
  rigid.along = 1.0 - product.dot(reference_) / inertia_;
  return rigid;
}

}  // namespace impactrig::models
