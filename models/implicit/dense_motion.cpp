// SPDX-License-Identifier: BSD-3-Clause
#include "models/implicit/dense_motion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

#include "models/beams/bending_modes.hpp"
#include "models/implicit/newton_progress.hpp"
#include "models/implicit/radau_errors.hpp"
#include "models/implicit/radau_stages.hpp"
#include "models/make_beam.hpp"

namespace impactrig::models {
namespace {

// Of the accuracy asked for, what Newton's method may leave of a step: so little that the error
// estimate does not see it, or steps shrink for nothing.
constexpr double newton_share = 0.01;
constexpr int kept_factors = 6;

/// S: stages of the method, an even number. Unknown are the accelerations a of the stages; they are
/// those the bar has there, a = f(q, q̇, F), and Newton's method takes the derivatives of f from
/// differences.
template <int S>
class DenseMotion final : public BarMotion {
 public:
  DenseMotion(const Rig& rig, const Solver& solver, const HistoryRequest& history)
      : beam_(make_beam(rig, solver)),
        n_(beam_->size()),
        compliance_(models::elastic_compliance(rig.beam, rig.contact.position)),
        velocity_place_(history.velocity_position > 0.0 ? history.velocity_position
                                                        : rig.contact.position),
        displacement_place_(history.displacement_position > 0.0 ? history.displacement_position
                                                                : rig.contact.position),
        accuracy_(std::max(solver.accuracy, 1e-13)),
        damped_bar_(models::damped(rig)),
        weight_energy_(rig.gravity * rig.beam.first_moment()),
        inertia_(beam_->inertia_diagonal()),
        newton_(newton_share * accuracy_) {
    q_ = v_ = end_q_ = end_v_ = scratch_ = here_ = there_ = moved_ = at_q_ = at_v_ =
        Vector::Zero(n_);
    a_ = previous_ = whole_ = stage_q_ = stage_v_ = residual_ = change_ = Stages::Zero(n_, S);
    projected_ = solved_ = Eigen::VectorXcd::Zero(n_);
    matrix_ = Eigen::MatrixXcd::Zero(n_, n_);
    by_q_ = by_v_ = Matrix::Zero(n_, n_);
    by_force_ = to_struck_ = Vector::Zero(n_);
    factors_.resize(kept_factors);
  }

  const Collocation& rule() const override { return stages_.rule; }

  const StepLadder& ladder() const override { return ladder_; }

  void start(double angle, double rate) override {
    beam_->set_steady_motion(angle, rate, q_, v_);
    energy_ = beam_->energy(q_, v_);
    lost_ = 0.0;
    last_h_ = 0.0;
    renew_tangent();
  }

  void expect_contact() override { renew_tangent(); }

  void set_scales(double kinetic, double contact_time) override {
    speed_scale_ = std::sqrt(2.0 * kinetic);
    contact_time_ = contact_time;
  }

  PointMotion struck() const override { return beam_->struck_point(q_, v_); }

  BeamEnergy energy() const override { return energy_; }

  RigidPart rigid_part() const override { return beam_->rigid_part(q_, v_); }

  double elastic_compliance() const override { return compliance_; }

  void begin_step(int level) override {
    h_ = ladder_.length_of(level);
    if (last_h_ > 0.0)
      predict(previous_, h_ / last_h_, 1.0, 3);
    else
      a_.setZero();
    begin();
  }

  void begin_part(double part) override {
    h_ *= part;
    whole_ = a_;
    predict(whole_, part, 0.0, S);
    begin();
  }

  double step() const override { return h_; }

  const Response& response() const override { return factor_->response; }

  bool improve(const NodeVector& force, NodeVector& displacement, NodeVector& velocity) override;

  void press(const NodeVector& change) override;

  bool settled() const override { return newton_.settled(); }

  void finish(const NodeVector& force, const NodeVector&) override;

  double damped(double) const override { return damped_; }

  PointMotion struck_at_end() const override { return beam_->struck_point(end_q_, end_v_); }

  double error() const override;
  PointMotion struck_at(double part, double* acceleration) override;
  void sample(double first, double spacing, std::span<Sample> samples) override;

  bool parts_exact() const override { return false; }

  void take(double) override {
    lost_ += lost_in_step();
    std::swap(q_, end_q_);
    std::swap(v_, end_v_);
    energy_ = end_energy_;
    std::swap(previous_, a_);
    last_h_ = h_;
    if (newton_.slow()) renew_tangent();
  }

 private:
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;
  using Stages = Eigen::Matrix<double, Eigen::Dynamic, S>;  // a column for each stage
  using Series = Eigen::Matrix<double, S, 1>;
  static constexpr int pairs = S / 2;

  /// The linear systems of a step of one length, at the tangent at hand.
  struct Factor {
    double h = 0.0;  ///< 0: of an older tangent
    std::array<Eigen::PartialPivLU<Eigen::MatrixXcd>, pairs> systems;
    Eigen::Matrix<std::complex<double>, Eigen::Dynamic, pairs> pressed;  ///< under a unit force
    Response response;
  };

  void predict(const Stages& from, double ratio, double origin, int terms) {
    Eigen::Matrix<double, S, S> values = Eigen::Matrix<double, S, S>::Zero();
    Series legendre;
    for (int i = 0; i < S; ++i) {
      shifted_legendre(origin + ratio * stages_.rule.points()[i], legendre);
      values.row(i).head(terms) = legendre.head(terms).transpose();
    }
    const Eigen::Matrix<double, S, S> map = (values * to_series_).transpose();
    a_.noalias() = from * map;
  }

  void begin() {
    newton_.begin_step();
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

  double lost_in_step() const { return total(energy_) + work_done_ - damped_ - total(end_energy_); }

  void place_stages() {
    const Eigen::Matrix<double, S, S> integrals = h_ * stages_.to_velocity.transpose();
    stage_v_.noalias() = a_ * integrals;
    stage_v_.colwise() += v_;
    stage_q_.noalias() = stage_v_ * integrals;
    stage_q_.colwise() += q_;
  }

  void renew_tangent();
  void make_factor(Factor& factor);

  /// Adds to `sum` what the complex accelerations `solved_` of a pair of stages make of all.
  void gather(int pair, Stages& sum) const {
    for (int i = 0; i < S; ++i)
      sum.col(i) +=
          stages_.out_re(i, pair) * solved_.real() - stages_.out_im(i, pair) * solved_.imag();
  }

  /// Position and speed within the solved step, into `at_q_` and `at_v_`.
  void move_to(double part) {
    Series integrals;
    shifted_legendre_integrals(part, integrals);
    integrals = h_ * to_series_.transpose() * integrals;
    at_v_ = v_;
    at_v_.noalias() += a_ * integrals;
    at_q_ = q_;
    at_q_.noalias() += stage_v_ * integrals;
  }

  std::unique_ptr<BeamDynamics> beam_;
  int n_;
  const RadauStages<S>& stages_ = RadauStages<S>::get();
  Eigen::Matrix<double, S, S> to_series_ = stages_.rule.to_series();
  StepLadder ladder_;
  double compliance_;
  double velocity_place_, displacement_place_;
  double accuracy_;
  bool damped_bar_;
  double weight_energy_;
  Vector inertia_;
  double speed_scale_ = 1.0, contact_time_ = 1.0;

  Vector q_, v_, end_q_, end_v_, scratch_, here_, there_, moved_, at_q_, at_v_;
  double h_ = 0.0, last_h_ = 0.0;
  Stages a_, previous_, whole_, stage_q_, stage_v_, residual_, change_;
  Eigen::VectorXcd projected_, solved_;
  Eigen::MatrixXcd matrix_;
  BeamEnergy energy_, end_energy_;
  double lost_ = 0.0;       // by the method since the start [J]
  double damped_ = 0.0;     // in bar and hinge over the step [J]
  double work_done_ = 0.0;  // on the bar by the stop over the step [J]

  // Derivatives of the acceleration, and of the struck point's displacement by q.
  Matrix by_q_, by_v_;
  Vector by_force_, to_struck_;
  std::vector<Factor> factors_;
  std::size_t next_factor_ = 0;
  Factor* factor_ = nullptr;
  NewtonProgress newton_;
  double excess_ = 1.0;
};

/// By differences over a small part of what the motion does while a contact sinks in.
template <int S>
void DenseMotion<S>::renew_tangent() {
  constexpr double part = 1e-4;
  beam_->acceleration(q_, v_, 0.0, here_);
  beam_->acceleration(q_, v_, 1.0, there_);
  by_force_ = there_ - here_;
  const double place = beam_->struck_point(q_, v_).displacement;
  for (int i = 0; i < n_; ++i) {
    const double speed = part * speed_scale_ / std::sqrt(inertia_[i]);
    const double way = speed * contact_time_;
    moved_ = q_;
    moved_[i] += way;
    beam_->acceleration(moved_, v_, 0.0, there_);
    by_q_.col(i) = (there_ - here_) / way;
    to_struck_[i] = (beam_->struck_point(moved_, v_).displacement - place) / way;
    if (!damped_bar_) continue;
    moved_ = v_;
    moved_[i] += speed;
    beam_->acceleration(q_, moved_, 0.0, there_);
    by_v_.col(i) = (there_ - here_) / speed;
  }
  for (Factor& factor : factors_) factor.h = 0.0;
}

template <int S>
void DenseMotion<S>::make_factor(Factor& factor) {
  factor.h = h_;
  factor.pressed.resize(n_, pairs);
  Eigen::Matrix<double, S, S> acceleration = Eigen::Matrix<double, S, S>::Zero();
  for (int j = 0; j < pairs; ++j) {
    const std::complex<double> z = h_ * stages_.eigenvalues[j];
    auto& system = factor.systems[static_cast<std::size_t>(j)];
    matrix_ = -z * z * by_q_ - z * by_v_;
    matrix_.diagonal().array() += 1.0;
    system.compute(matrix_);
    projected_ = by_force_.cast<std::complex<double>>();
    solved_ = system.solve(projected_);
    factor.pressed.col(j) = solved_;
    const std::complex<double> own(to_struck_.dot(solved_.real()), to_struck_.dot(solved_.imag()));
    const auto re = own.real() * stages_.into_re.row(j) - own.imag() * stages_.into_im.row(j);
    const auto im = own.real() * stages_.into_im.row(j) + own.imag() * stages_.into_re.row(j);
    acceleration += stages_.out_re.col(j) * re - stages_.out_im.col(j) * im;
  }
  factor.response.displacement_of_force = h_ * h_ * stages_.to_displacement * acceleration;
  factor.response.velocity_of_force = h_ * stages_.to_velocity * acceleration;
}

template <int S>
bool DenseMotion<S>::improve(const NodeVector& force, NodeVector& displacement,
                             NodeVector& velocity) {
  place_stages();
  for (int i = 0; i < S; ++i) {
    beam_->acceleration(stage_q_.col(i), stage_v_.col(i), force[i], scratch_);
    residual_.col(i) = a_.col(i) - scratch_;
  }
  change_.setZero();
  for (int j = 0; j < pairs; ++j) {
    projected_.setZero();
    for (int i = 0; i < S; ++i)
      projected_ +=
          std::complex<double>(stages_.into_re(j, i), stages_.into_im(j, i)) * residual_.col(i);
    solved_ = factor_->systems[static_cast<std::size_t>(j)].solve(projected_);
    gather(j, change_);
  }
  a_ -= change_;
  place_stages();
  displacement.resize(S);
  velocity.resize(S);
  for (int i = 0; i < S; ++i) {
    const PointMotion p = beam_->struck_point(stage_q_.col(i), stage_v_.col(i));
    displacement[i] = p.displacement;
    velocity[i] = p.velocity;
  }
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() *
                          std::sqrt(inertia_.dot(q_.cwiseAbs2())) / (h_ * speed_scale_);
  return newton_.improved(excess_ * size_of(change_), excess_ * rounding);
}

template <int S>
void DenseMotion<S>::press(const NodeVector& change) {
  const Eigen::Matrix<double, pairs, 1> re = stages_.into_re * change;
  const Eigen::Matrix<double, pairs, 1> im = stages_.into_im * change;
  change_.setZero();
  for (int j = 0; j < pairs; ++j) {
    solved_ = factor_->pressed.col(j) * std::complex<double>(re[j], im[j]);
    gather(j, change_);
  }
  a_ += change_;
  newton_.pressed(excess_ * size_of(change_));
}

template <int S>
void DenseMotion<S>::finish(const NodeVector& force, const NodeVector&) {
  place_stages();
  end_q_ = stage_q_.col(S - 1);
  end_v_ = stage_v_.col(S - 1);
  end_energy_ = beam_->energy(end_q_, end_v_);
  work_done_ = damped_ = 0.0;
  for (int i = 0; i < S; ++i) {
    const double weight = h_ * stages_.rule.weights()[i];
    if (force[i] != 0.0)
      work_done_ -=
          weight * force[i] * beam_->struck_point(stage_q_.col(i), stage_v_.col(i)).velocity;
    if (damped_bar_) damped_ += weight * beam_->damping_power(stage_q_.col(i), stage_v_.col(i));
  }
}

template <int S>
double DenseMotion<S>::error() const {
  Series squares = Series::Zero();
  for (int k = 0; k < n_; ++k)
    squares += inertia_[k] * (to_series_ * a_.row(k).transpose()).cwiseAbs2();
  const double motion =
      h_ * std::min(1.0, h_ / contact_time_) * series_remainder<S>(squares.array()) / speed_scale_;
  const EnergyLoss loss{lost_in_step(), lost_, end_energy_, weight_energy_};
  return std::max(motion, loss.error(0.5 * speed_scale_ * speed_scale_, accuracy_));
}

template <int S>
PointMotion DenseMotion<S>::struck_at(double part, double* acceleration) {
  move_to(part);
  if (acceleration) {
    Series values;
    shifted_legendre(part, values);
    values = to_series_.transpose() * values;
    scratch_.noalias() = a_ * values;
    *acceleration = beam_->struck_acceleration(at_q_, at_v_, scratch_);
  }
  return beam_->struck_point(at_q_, at_v_);
}

template <int S>
void DenseMotion<S>::sample(double first, double spacing, std::span<Sample> samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double part = first + static_cast<double>(i) * spacing;
    if (part > 0.0) {
      move_to(part);
    } else {
      at_q_ = q_;
      at_v_ = v_;
    }
    samples[i] = {beam_->struck_point(at_q_, at_v_),
                  beam_->point(velocity_place_, at_q_, at_v_).velocity,
                  beam_->point(displacement_place_, at_q_, at_v_).displacement};
  }
}

}  // namespace

std::unique_ptr<BarMotion> make_dense_motion(const Rig& rig, const Solver& solver,
                                             const HistoryRequest& history) {
  if (solver.accuracy > 5e-6) return std::make_unique<DenseMotion<4>>(rig, solver, history);
  return std::make_unique<DenseMotion<8>>(rig, solver, history);
}

}  // namespace impactrig::models
