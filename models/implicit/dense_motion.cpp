// SPDX-License-Identifier: BSD-3-Clause
#include "models/implicit/dense_motion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

#include "models/beams/bending_modes.hpp"
#include "models/hinge_friction.hpp"
#include "models/implicit/dense_slope.hpp"
#include "models/implicit/newton_progress.hpp"
#include "models/implicit/radau_errors.hpp"
#include "models/implicit/radau_stages.hpp"

namespace impactrig::models {
namespace {

// Of the accuracy asked for, what Newton's method may leave of a step: so little that neither the
// error estimate nor the energy's balance sees it, or steps shrink for nothing.
constexpr double newton_share = 0.002;
constexpr int kept_factors = 6;

/// Unknown are the accelerations a of the stages: those that leave no force unbalanced there. So no
/// stage needs its mass matrix; Newton's method has that, and the derivatives of these forces, of
/// one state for many steps.
class DenseMotion final : public BarMotion {
 public:
  DenseMotion(const Rig& rig, const Solver& solver, const HistoryRequest& history)
      : bar_(rig, solver, history),
        beam_(*bar_.beam),
        n_(beam_.size()),
        forces_(Matrix::Zero(S, 1 + static_cast<Eigen::Index>(bar_.further.size()))),
        compliance_(models::elastic_compliance(rig.beam, rig.contact.position)),
        accuracy_(std::max(solver.accuracy, Solver::finest_accuracy)),
        damped_bar_(models::damped(rig)),
        weight_energy_(rig.gravity * rig.beam.first_moment()),
        inertia_(beam_.inertia_diagonal()),
        friction_(rig.hinge.friction),
        rotation_(rig.hinge.rotation),
        newton_(newton_share * accuracy_) {
    q_ = v_ = end_q_ = end_v_ = scratch_ = at_q_ = at_v_ = touch_q_ = way_ = end_way_ = at_way_ =
        Vector::Zero(n_);
    a_ = previous_ = whole_ = stage_q_ = stage_v_ = residual_ = change_ = stage_way_ = series_ =
        Stages::Zero(n_, S);
    projected_ = solved_ = Eigen::VectorXcd::Zero(n_);
    matrix_ = Eigen::MatrixXcd::Zero(n_, n_);
    tangent_.mass = tangent_.by_q = tangent_.by_v = Matrix::Zero(n_, n_);
    by_force_ = to_point_ = Matrix::Zero(n_, std::max(rig.stops(), 1));
    factors_.assign(kept_factors, Factor(n_, stops()));
    hinge_ = holding_ = NodeVector::Zero(S);
  }

  const Collocation& rule() const override { return stages_.rule; }

  const StepLadder& ladder() const override { return ladder_; }

  void start(double angle, double rate) override {
    steady_ = beam_.set_steady_motion(angle, rate, q_, v_);
    if (rotation_) beam_.set_hinge(angle, rate, q_, v_);
    energy_ = beam_.energy(q_, v_);
    lost_ = 0.0;
    last_h_ = 0.0;
    touched_ = in_contact_ = false;
    friction_.start(rate);
    t_ = 0.0;
    angle_at_start_ = angle;
    renew_tangent();
  }

  bool began_steady() const override { return steady_; }

  void expect_contact(int stop, double displacement) override {
    touched_ = true;
    count_from_here(stop, displacement);
    renew_tangent();
  }

  void set_scales(const Scales& scales) override {
    speed_scale_ = std::sqrt(2.0 * scales.energy);
    contact_time_ = scales.contact_time;
    damping_ = scales.damping;
  }

  void expect_flight() override { in_contact_ = false; }

  PointMotion struck(int stop) const override { return seen(stop, q_, v_, way_); }

  BeamEnergy energy() const override { return energy_; }

  RigidPart rigid_part() const override { return beam_.rigid_part(q_, v_); }

  double elastic_compliance() const override { return compliance_; }

  void begin_step(int level) override {
    h_ = ladder_.length_of(level);
    if (last_h_ > 0.0)
      predict(previous_, h_ / last_h_, 1.0, 3, a_);
    else
      a_.setZero();
    begin();
  }

  void begin_part(double part) override {
    h_ *= part;
    whole_ = a_;
    predict(whole_, part, 0.0, S, a_);
    begin();
  }

  double step() const override { return h_; }

  const Response& response(int point, int stop) const override {
    return factor_->responses[index_of(point, stop)];
  }

  bool improve(std::span<StopStep> stops) override;

  void press(std::span<const StopStep> stops) override;

  bool settled() const override { return newton_.settled(); }

  void finish(std::span<const StopStep> stops) override;

  double damped(double) const override { return damped_; }

  double driven() const override { return driven_; }

  double hinge_lateness() const override { return friction_.lateness(stages_.rule, hinge_); }

  double hinge_change() override {
    if (!friction_.acts()) return 2.0;
    friction_change_ = friction_.change(stages_.rule, hinge_);
    return friction_change_.part;
  }

  void change_hinge() override {
    friction_.follow(friction_change_);
    beam_.set_hinge(beam_.hinge_angle(q_), 0.0, q_, v_);
    lost_ += total(energy_);
    energy_ = beam_.energy(q_, v_);
    lost_ -= total(energy_);
    renew_tangent();
  }

  PointMotion struck_at_end(int stop) const override {
    return seen(stop, end_q_, end_v_, end_way_);
  }

  double error() const override;

  PointMotion struck_at(int stop, double part, double* acceleration) override;
  void sample(double first, double spacing, std::span<Sample> samples) override;

  bool parts_exact() const override { return false; }

  std::unique_ptr<MotionSlope> follow(const RigEffect& effect, const Solver& solver,
                                      const HistoryRequest& history) override {
    if (!effect.has_slopes()) return nullptr;
    followed_ = true;
    return std::make_unique<DenseSlope<DenseMotion>>(*this, effect, solver, history);
  }

  void take(double) override {
    lost_ += lost_in_step();
    std::swap(q_, end_q_);
    std::swap(v_, end_v_);
    std::swap(way_, end_way_);
    energy_ = end_energy_;
    std::swap(previous_, a_);
    last_h_ = h_;
    t_ += h_;
    if (newton_.slow()) renew_tangent();
  }

 private:
  friend class DenseSlope<DenseMotion>;
  static constexpr int S = 8;  // stages of the method
  static constexpr int stages = S;
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;
  using Stages = Eigen::Matrix<double, Eigen::Dynamic, S>;  // a column for each stage
  using Series = Eigen::Matrix<double, S, 1>;
  static constexpr int pairs = S / 2;

  /// The linear systems of a step of one length, at the tangent at hand.
  struct Factor {
    Factor(Eigen::Index size, int stops)
        : pressed(static_cast<std::size_t>(stops)),
          responses(pressed.size() * pressed.size()) {
      for (auto& system : systems) system = Eigen::PartialPivLU<Eigen::MatrixXcd>(size);
      for (auto& solution : pressed) solution.resize(size, pairs);
    }

    double h = 0.0;  ///< 0: of an older tangent
    std::array<Eigen::PartialPivLU<Eigen::MatrixXcd>, pairs> systems;
    /// Under a unit force of each stop.
    std::vector<Eigen::Matrix<std::complex<double>, Eigen::Dynamic, pairs>> pressed;
    std::vector<Response> responses;  ///< at index_of()
  };

  int stops() const { return static_cast<int>(forces_.cols()); }

  std::size_t index_of(int point, int stop) const {
    return static_cast<std::size_t>(point * stops() + stop);
  }

  PointMotion point_before(int stop, ConstVector q, ConstVector v) const {
    return bar_.before(stop, q, v);
  }

  void add_slopes(Sample& sample);

  /// Displacements count from this touch on.
  void count_from_here(int stop, double displacement) {
    for (std::size_t k = 0; k < at_touch_.size(); ++k)
      at_touch_[k] = struck(static_cast<int>(k)).displacement;
    at_touch_[static_cast<std::size_t>(stop)] = displacement;
    touch_q_ = q_;
    way_.setZero();
    in_contact_ = true;
  }

  /// The same with a displacement that has all the digits of what way the bar went since the last
  /// touch: laws may be steep near none. The coordinates leave it their own rounding.
  PointMotion seen(int stop, ConstVector q, ConstVector v, ConstVector way) const {
    PointMotion p = point_before(stop, q, v);
    if (in_contact_)
      p.displacement =
          at_touch_[static_cast<std::size_t>(stop)] + bar_.advance(stop, touch_q_, way);
    return p;
  }

  void predict(const Stages& from, double ratio, double origin, int terms, Stages& to) const {
    Eigen::Matrix<double, S, S> values = Eigen::Matrix<double, S, S>::Zero();
    Series legendre;
    for (int i = 0; i < S; ++i) {
      shifted_legendre(origin + ratio * stages_.rule.points()[i], legendre);
      values.row(i).head(terms) = legendre.head(terms).transpose();
    }
    const Eigen::Matrix<double, S, S> map = (values * to_series_).transpose();
    to.noalias() = from * map;
  }

  void begin() {
    newton_.begin_step(h_ / contact_time_);
    excess_ = std::max(1.0, std::sqrt(2.0 * energy_.kinetic) / speed_scale_);
    const auto found = std::ranges::find_if(
        factors_, [&](const Factor& factor) { return std::abs(factor.h - h_) <= 1e-3 * h_; });
    if (found != factors_.end()) {
      factor_ = &*found;
      return;
    }
    factor_ = &factors_[next_factor_];
    next_factor_ = (next_factor_ + 1) % factors_.size();
    make_factor(*factor_);
  }

  /// Of changed accelerations: the speed they make over the step.
  double size_of(const Stages& change) const {
    const double square = (inertia_.array() * change.array().square().rowwise().maxCoeff()).sum();
    return h_ * std::sqrt(square) / speed_scale_;
  }

  double lost_in_step() const {
    return total(energy_) + work_done_ + driven_ - damped_ - total(end_energy_);
  }

  void place_stages() {
    integrate(q_, v_, a_, stage_q_, stage_v_);
    if (!in_contact_) return;
    stage_way_.noalias() = stage_v_ * (h_ * stages_.to_velocity.transpose());
    stage_way_.colwise() += way_;
  }

  /// From a state under the accelerations of the stages to the stages.
  void integrate(const Vector& q, const Vector& v, const Stages& a, Stages& stage_q,
                 Stages& stage_v) const {
    const Eigen::Matrix<double, S, S> integrals = h_ * stages_.to_velocity.transpose();
    stage_v.noalias() = a * integrals;
    stage_v.colwise() += v;
    stage_q.noalias() = stage_v * integrals;
    stage_q.colwise() += q;
  }

  /// Whether something holds the hinge: its friction, or what turns it as stated.
  bool held() const { return rotation_ || friction_.sticks(); }

  /// The hinge's, where it is held, at a place of the step [rad/s²].
  double hinge_acceleration(double part) const {
    return rotation_ ? rotation_->acceleration_at(t_ + part * h_) : 0.0;
  }

  /// Of the positions, turned into forces: of size_of() a change.
  double rounding() const {
    return 16.0 * std::numeric_limits<double>::epsilon() * std::sqrt(inertia_.dot(q_.cwiseAbs2())) /
           (h_ * speed_scale_);
  }

  void find_unbalanced(std::span<const StopStep> stops);
  void correct(const Stages& residual, Stages& change);
  void add_response(std::size_t stop, const NodeVector& change, Stages& to);
  void look_at_hinge(std::span<const StopStep> stops);
  void look_at_rotation(std::span<const StopStep> stops);
  void renew_tangent();
  void make_factor(Factor& factor);
  void respond_to(int stop, Factor& factor);

  /// Adds to `sum` what the complex accelerations `solved_` of a pair of stages make of all.
  void gather(int pair, Stages& sum) const {
    for (int i = 0; i < S; ++i)
      sum.col(i) +=
          stages_.out_re(i, pair) * solved_.real() - stages_.out_im(i, pair) * solved_.imag();
  }

  /// Position and speed within the solved step, into `at_q_` and `at_v_`.
  void move_to(double part) {
    part_ = part;
    move(part, q_, v_, a_, stage_v_, at_q_, at_v_);
    if (!in_contact_) return;
    at_way_ = way_;
    at_way_.noalias() += stage_v_ * integrals_to(part);
  }

  /// Over the first part of the step, of what has these values at the stages.
  Series integrals_to(double part) const {
    Series integrals;
    shifted_legendre_integrals(part, integrals);
    return h_ * to_series_.transpose() * integrals;
  }

  void move(double part, const Vector& q, const Vector& v, const Stages& a, const Stages& stage_v,
            Vector& at_q, Vector& at_v) const {
    const Series integrals = integrals_to(part);
    at_v = v;
    at_v.noalias() += a * integrals;
    at_q = q;
    at_q.noalias() += stage_v * integrals;
  }

  /// Where move_to() went.
  const Vector& acceleration_there() {
    Series values;
    shifted_legendre(part_, values);
    values = to_series_.transpose() * values;
    scratch_.noalias() = a_ * values;
    return scratch_;
  }

  FrameBar bar_;
  FloatingFrameBeam& beam_;
  int n_;
  Matrix forces_;  // of the stops at the stages (S, stops) [N]
  const RadauStages<S>& stages_ = RadauStages<S>::get();
  Eigen::Matrix<double, S, S> to_series_ = stages_.rule.to_series();
  StepLadder ladder_;
  double compliance_;
  double accuracy_;
  bool damped_bar_;
  double weight_energy_;
  Vector inertia_;
  HingeFriction friction_;
  HingeFriction::Change friction_change_;
  std::optional<HingeRotation> rotation_;
  double t_ = 0.0;               // from the start, of a turned hinge [s]
  double angle_at_start_ = 0.0;  // [rad]
  double driven_ = 0.0;          // work of what turns the hinge over the step [J]
  NodeVector hinge_;             // at the stages: its rate, or the moment that holds it
  NodeVector holding_;           // that moment, as find_unbalanced() left it [N m]
  double speed_scale_ = 1.0, contact_time_ = 1.0, damping_ = 0.0;
  bool pressed_ = false;  // by a stop, over the step
  bool touched_ = false;  // since the start

  double part_ = 0.0;  // of the step, that was looked at last
  Vector q_, v_, end_q_, end_v_, scratch_, at_q_, at_v_;
  double h_ = 0.0, last_h_ = 0.0;
  Stages a_, previous_, whole_, stage_q_, stage_v_, residual_, change_;
  // of a contact: the last touch, the displacements there [m], and how far q has come since
  bool steady_ = true;
  bool in_contact_ = false;
  Vector touch_q_, way_, end_way_, at_way_;
  Stages stage_way_;
  std::vector<double> at_touch_ = std::vector<double>(1 + bar_.further.size());
  Eigen::VectorXcd projected_, solved_;
  Eigen::MatrixXcd matrix_;
  BeamEnergy energy_, end_energy_;
  double lost_ = 0.0;       // by the method since the start [J]
  double damped_ = 0.0;     // in bar and hinge over the step [J]
  double work_done_ = 0.0;  // on the bar by the stop over the step [J]

  // Of the unbalanced forces, by the force of each stop too, and of the displacement before it by
  // q: a column for each stop.
  FloatingFrameBeam::Tangent tangent_;
  Matrix by_force_, to_point_;
  std::vector<Factor> factors_;
  std::size_t next_factor_ = 0;
  Factor* factor_ = nullptr;
  NewtonProgress newton_;
  double excess_ = 1.0;
  bool followed_ = false;  // by a derivative
  mutable Stages series_;  // scratch of error()
};

/// Where the step begins, free of the stops.
void DenseMotion::renew_tangent() {
  beam_.drive({.held = held(),
               .moment = friction_.slides() ? friction_.moment() : 0.0,
               .acceleration = hinge_acceleration(0.0)});
  beam_.acceleration(q_, v_, 0.0, scratch_);
  beam_.set_tangent(q_, v_, scratch_, tangent_);
  beam_.set_pressed(q_, by_force_);
  to_point_ = -by_force_;
  if (held()) {
    beam_.hold_hinge(tangent_);
    beam_.balance_hinge(by_force_);
  }
  for (Factor& factor : factors_) factor.h = 0.0;
}

void DenseMotion::make_factor(Factor& factor) {
  factor.h = h_;
  for (int j = 0; j < pairs; ++j) {
    const std::complex<double> z = h_ * stages_.eigenvalues[j];
    matrix_ = tangent_.mass - z * z * tangent_.by_q - z * tangent_.by_v;
    factor.systems[static_cast<std::size_t>(j)].compute(matrix_);
  }
  for (int stop = 0; stop < stops(); ++stop) respond_to(stop, factor);
}

/// All points to a unit force of a stop.
void DenseMotion::respond_to(int stop, Factor& factor) {
  auto& pressed = factor.pressed[static_cast<std::size_t>(stop)];
  for (int j = 0; j < pairs; ++j) {
    projected_ = by_force_.col(stop).template cast<std::complex<double>>();
    solved_ = factor.systems[static_cast<std::size_t>(j)].solve(projected_);
    pressed.col(j) = solved_;
  }
  for (int point = 0; point < stops(); ++point) {
    Eigen::Matrix<double, S, S> acceleration = Eigen::Matrix<double, S, S>::Zero();
    for (int j = 0; j < pairs; ++j) {
      const auto to_point = to_point_.col(point);
      const std::complex<double> own(to_point.dot(pressed.col(j).real()),
                                     to_point.dot(pressed.col(j).imag()));
      const auto re = own.real() * stages_.into_re.row(j) - own.imag() * stages_.into_im.row(j);
      const auto im = own.real() * stages_.into_im.row(j) + own.imag() * stages_.into_re.row(j);
      acceleration += stages_.out_re.col(j) * re - stages_.out_im.col(j) * im;
    }
    Response& response = factor.responses[index_of(point, stop)];
    response.displacement_of_force = h_ * h_ * stages_.to_displacement * acceleration;
    response.velocity_of_force = h_ * stages_.to_velocity * acceleration;
    response.set_most();
  }
}

/// At the stages, into residual_; and what holds a held hinge.
void DenseMotion::find_unbalanced(std::span<const StopStep> stops) {
  for (std::size_t k = 0; k < stops.size(); ++k)
    forces_.col(static_cast<Eigen::Index>(k)) = stops[k].force;
  beam_.unbalanced(stage_q_, stage_v_, a_, forces_, residual_);
  if (!held()) return;
  for (int i = 0; i < S; ++i)
    holding_[i] =
        beam_.hold_hinge(a_.col(i), hinge_acceleration(stages_.rule.points()[i]), residual_.col(i));
}

/// By what Newton's method adds to the accelerations.
void DenseMotion::correct(const Stages& residual, Stages& change) {
  change.setZero(n_, S);
  for (int j = 0; j < pairs; ++j) {
    projected_.setZero();
    for (int i = 0; i < S; ++i)
      projected_ +=
          std::complex<double>(stages_.into_re(j, i), stages_.into_im(j, i)) * residual.col(i);
    solved_ = factor_->systems[static_cast<std::size_t>(j)].solve(projected_);
    gather(j, change);
  }
}

/// Adds the accelerations that a change of a stop's force makes.
void DenseMotion::add_response(std::size_t stop, const NodeVector& change, Stages& to) {
  const Eigen::Matrix<double, pairs, 1> re = stages_.into_re * change;
  const Eigen::Matrix<double, pairs, 1> im = stages_.into_im * change;
  for (int j = 0; j < pairs; ++j) {
    solved_ = factor_->pressed[stop].col(j) * std::complex<double>(re[j], im[j]);
    gather(j, to);
  }
}

bool DenseMotion::improve(std::span<StopStep> stops) {
  place_stages();
  find_unbalanced(stops);
  correct(residual_, change_);
  a_ += change_;
  place_stages();
  for (std::size_t k = 0; k < stops.size(); ++k) {
    stops[k].displacement.resize(S);
    stops[k].velocity.resize(S);
    for (int i = 0; i < S; ++i) {
      const PointMotion p =
          seen(static_cast<int>(k), stage_q_.col(i), stage_v_.col(i), stage_way_.col(i));
      stops[k].displacement[i] = p.displacement;
      stops[k].velocity[i] = p.velocity;
    }
  }
  return newton_.improved(excess_ * size_of(change_), excess_ * rounding());
}

void DenseMotion::press(std::span<const StopStep> stops) {
  change_.setZero();
  for (std::size_t k = 0; k < stops.size(); ++k) add_response(k, stops[k].change, change_);
  a_ += change_;
  newton_.pressed(excess_ * size_of(change_));
}

void DenseMotion::finish(std::span<const StopStep> stops) {
  place_stages();
  end_q_ = stage_q_.col(S - 1);
  end_v_ = stage_v_.col(S - 1);
  end_way_ = stage_way_.col(S - 1);
  if (rotation_) look_at_rotation(stops);
  end_energy_ = beam_.energy(end_q_, end_v_);
  work_done_ = damped_ = 0.0;
  pressed_ =
      std::ranges::any_of(stops, [](const StopStep& stop) { return !stop.force.isZero(0.0); });
  for (int i = 0; i < S; ++i) {
    const double weight = h_ * stages_.rule.weights()[i];
    for (std::size_t k = 0; k < stops.size(); ++k)
      if (const double force = stops[k].force[i]; force != 0.0)
        work_done_ -= weight * force *
                      point_before(static_cast<int>(k), stage_q_.col(i), stage_v_.col(i)).velocity;
    if (damped_bar_) damped_ += weight * beam_.damping_power(stage_q_.col(i), stage_v_.col(i));
  }
  if (friction_.acts()) look_at_hinge(stops);
}

/// The work of what turns the hinge; the step ends at the hinge's very angle and rate.
void DenseMotion::look_at_rotation(std::span<const StopStep> stops) {
  driven_ = 0.0;
  find_unbalanced(stops);
  for (int i = 0; i < S; ++i)
    driven_ += h_ * stages_.rule.weights()[i] * holding_[i] * beam_.hinge_rate(stage_v_.col(i));
  beam_.set_hinge(angle_at_start_ + rotation_->angle_at(t_ + h_), rotation_->rate_at(t_ + h_),
                  end_q_, end_v_);
}

/// At the stages of the solved step, and what friction took.
void DenseMotion::look_at_hinge(std::span<const StopStep> stops) {
  if (friction_.sticks()) {
    find_unbalanced(stops);
    hinge_ = holding_;
    return;
  }
  for (int i = 0; i < S; ++i) {
    hinge_[i] = beam_.hinge_rate(stage_v_.col(i));
    damped_ -= h_ * stages_.rule.weights()[i] * friction_.moment() * hinge_[i];
  }
}

/// The terms of the accelerations' series count by the energy they would have as speeds: of a bar
/// that moves fast, the frame's turn and the modes nearly cancel.
double DenseMotion::error() const {
  Series squares;
  series_.noalias() = a_ * to_series_.transpose();
  beam_.kinetic(q_, series_, squares);
  squares *= 2.0;
  const double motion = h_ * weight_of_step(h_ / contact_time_) *
                        end_remainder<S>(squares.array(), followed_) / speed_scale_;
  double rate = 0.0;
  // a swing's vibration is what the damper of its first contact meets
  if ((pressed_ || !touched_) && damping_ > 0.0) {
    const Series struck = to_series_ * (a_.transpose() * to_point_.col(0));
    const double displaced = to_point_.col(0).cwiseAbs().dot(q_.cwiseAbs());
    rate = error_of_rate<S>(struck.array().square(), rounding_of_acceleration(displaced, h_),
                            damping_, contact_time_, h_);
  }
  const EnergyLoss loss{lost_in_step(), lost_, end_energy_, weight_energy_};
  return std::max({motion, rate, loss.error(0.5 * speed_scale_ * speed_scale_, accuracy_)});
}

PointMotion DenseMotion::struck_at(int stop, double part, double* acceleration) {
  move_to(part);
  if (acceleration) {
    acceleration_there();
    if (stop == 0) {
      *acceleration = beam_.struck_acceleration(at_q_, at_v_, scratch_);
    } else {
      const FurtherStop& there = bar_.further[static_cast<std::size_t>(stop - 1)];
      *acceleration = there.direction() *
                      beam_.point_acceleration(there.contact.position, at_q_, at_v_, scratch_);
    }
  }
  return seen(stop, at_q_, at_v_, at_way_);
}

/// Along the bar, where it was looked at last.
void DenseMotion::add_slopes(Sample& sample) {
  sample.velocity_slope = beam_.point_slope(bar_.velocity_place, at_q_, at_v_).velocity;
  sample.displacement_slope = beam_.point_slope(bar_.displacement_place, at_q_, at_v_).displacement;
  if (!rotation_) return;
  const auto [deflection, extension] = beam_.departure_slope(bar_.displacement_place, at_q_);
  sample.deflection_slope = deflection;
  sample.extension_slope = extension;
}

void DenseMotion::sample(double first, double spacing, std::span<Sample> samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double part = first + static_cast<double>(i) * spacing;
    if (part > 0.0) {
      move_to(part);
    } else {
      at_q_ = q_;
      at_v_ = v_;
      at_way_ = way_;
    }
    samples[i] = {seen(0, at_q_, at_v_, at_way_),
                  beam_.point(bar_.velocity_place, at_q_, at_v_).velocity,
                  beam_.point(bar_.displacement_place, at_q_, at_v_).displacement};
    if (rotation_) {
      const auto [deflection, extension] = beam_.departure(bar_.displacement_place, at_q_);
      samples[i].deflection = deflection;
      samples[i].extension = extension;
    }
    if (bar_.spot_slopes) add_slopes(samples[i]);
  }
}

}  // namespace

std::unique_ptr<BarMotion> make_dense_motion(const Rig& rig, const Solver& solver,
                                             const HistoryRequest& history) {
  return std::make_unique<DenseMotion>(rig, solver, history);
}

}  // namespace impactrig::models
