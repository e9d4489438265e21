// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "models/beams/bending_modes.hpp"
#include "models/collocation/bar_motion.hpp"
#include "models/hinge_friction.hpp"
#include "models/implicit/chain_factors.hpp"
#include "models/implicit/chain_points.hpp"
#include "models/implicit/chain_slope.hpp"
#include "models/implicit/newton_progress.hpp"
#include "models/implicit/radau_errors.hpp"
#include "models/implicit/radau_stages.hpp"
#include "models/implicit/stage_array.hpp"
#include "models/implicit/stage_maps.hpp"
#include "models/lanes/stage_lanes.hpp"
#include "models/rig.hpp"
#include "models/simulation.hpp"

// Included by one file a chain: internal linkage lets the compiler inline what is called once.
namespace impactrig::models {
namespace {

/// What chain_motion.hpp makes. S: stages of the method, an even number. Chain: AncfChain or
/// ReissnerChain; Hold: SlopeHold or SectionHold, for a hinge whose angle is given.
template <int S, typename Chain, template <int> typename Hold>
class ChainMotion final : public BarMotion {
 public:
  ChainMotion(const Rig& rig, const Solver& solver, const HistoryRequest& history)
      : beam_(rig, solver.elements),
        chain_(beam_),
        struck_(Chain::stride * solver.elements[0]),
        tip_(Chain::stride * (solver.elements[0] + solver.elements[1])),
        length_(rig.beam.length),
        place_(rig.contact.position),
        compliance_(models::elastic_compliance(rig.beam, rig.contact.position)),
        accuracy_(std::max(solver.accuracy, Solver::finest_accuracy)),
        weight_energy_(rig.gravity * rig.beam.first_moment()),
        friction_(rig.hinge.friction),
        hold_(chain_),
        rotation_(rig.hinge.rotation),
        points_(beam_, chain_, struck_, rig, history),
        tangent_(chain_.make_tangent()),
        factors_(chain_, points_.stops),
        work_(static_cast<std::size_t>(chain_.coordinates())),
        newton_(newton_share * accuracy_) {
    const int n = chain_.coordinates();
    q_ = v_ = end_q_ = end_v_ = Eigen::ArrayXd::Zero(n);
    a_ = previous_ = stage_q_ = stage_v_ = residual_ = series_ = Stages::Zero(S, n);
    chain_.for_each_pair([&](int across, int along, int) {
      across_.push_back(across);
      along_.push_back(along);
    });
    beam_q_.setZero(beam_.size());
    beam_v_.setZero(beam_.size());
    hinge_ = NodeVector::Zero(S);
  }

  const Collocation& rule() const override { return stages_.rule; }

  const StepLadder& ladder() const override { return ladder_; }

  void start(double angle, double rate) override {
    steady_ = beam_.set_steady_motion(angle, rate, beam_q_, beam_v_);
    chain_.from_beam(beam_q_, q_);
    chain_.from_beam(beam_v_, v_);
    if (rotation_) turn_as_hinge(place_, q_, v_);
    energy_ = chain_.energy(q_, v_);
    lost_ = 0.0;
    last_h_ = 0.0;
    in_contact_ = touched_ = false;
    t_ = 0.0;
    angle_at_start_ = angle;
    friction_.start(rate);
    if (friction_.sticks()) hold_.stop(angle);
    renew_tangent();
  }

  bool began_steady() const override { return steady_; }

  void expect_contact(int, double) override {
    in_contact_ = touched_ = true;
    renew_tangent();
  }

  void set_scales(const Scales& scales) override {
    speed_scale_ = std::sqrt(2.0 * scales.energy);
    contact_time_ = scales.contact_time;
    damping_ = scales.damping;
    magnification_ = scales.magnification;
  }

  PointMotion struck(int stop) const override { return point_before(stop, q_, v_); }

  BeamEnergy energy() const override { return energy_; }

  RigidPart rigid_part() const override {
    to_beam();
    return beam_.rigid_part(beam_q_, beam_v_);
  }

  double elastic_compliance() const override { return compliance_; }

  void begin_step(int level) override {
    h_ = ladder_.length_of(level);
    maps_.predict(previous_, last_h_ > 0.0 ? h_ / last_h_ : 0.0, 1.0, a_);
    begin();
  }

  void begin_part(double part) override {
    h_ *= part;
    previous_guess_ = a_;
    maps_.predict(previous_guess_, part, 0.0, a_);
    begin();
  }

  double step() const override { return h_; }

  const Response& response(int point, int stop) const override {
    return factor_->responses[static_cast<std::size_t>(point * stops() + stop)];
  }

  bool improve(std::span<StopStep> stops) override;
  void press(std::span<const StopStep> stops) override;

  bool settled() const override { return newton_.settled(); }

  void finish(std::span<const StopStep> stops) override {
    slow_ = newton_.slow();
    const auto presses = [](const StopStep& stop) { return !stop.force.isZero(0.0); };
    if (std::ranges::none_of(stops, presses)) in_contact_ = false;
    place_stages();
    end_q_ = stage_q_.row(S - 1).transpose();
    end_v_ = stage_v_.row(S - 1).transpose();
    if (rotation_) look_at_rotation(stops);
    end_energy_ = chain_.energy(end_q_, end_v_);
    work_done_ = 0.0;
    for (std::size_t k = 0; k < stops.size(); ++k) {
      const Across across = across_before(static_cast<int>(k));
      const Lanes speed = across.v + maps_.velocity_of(across.a);
      work_done_ += h_ * (stages_.rule.weights().array() * stops[k].force.array() * speed).sum();
    }
    damped_ = chain_.damped() ? damped_in_step() : 0.0;
    if (friction_.acts()) look_at_hinge(stops);
  }

  double driven() const override { return driven_; }

  double hinge_lateness() const override { return friction_.lateness(stages_.rule, hinge_); }

  double hinge_change() override {
    if (!friction_.acts()) return 2.0;
    friction_change_ = friction_.change(stages_.rule, hinge_);
    return friction_change_.part;
  }

  void change_hinge() override {
    friction_.follow(friction_change_);
    const double angle = Hold<S>::angle_of(q_);
    Hold<S>::place(angle, 0.0, q_, v_);
    hold_.stop(angle);
    lost_ += total(energy_);
    energy_ = chain_.energy(q_, v_);
    lost_ -= total(energy_);
    renew_tangent();
  }

  double damped(double) const override { return damped_; }

  PointMotion struck_at_end(int stop) const override { return point_before(stop, end_q_, end_v_); }

  double error() const override;

  PointMotion struck_at(int stop, double part, double* acceleration) override {
    const auto [q, v, a] = across_before(stop);
    const PointMotion p = maps_.motion_at(q, v, a, part);
    if (acceleration) {
      Series legendre;
      shifted_legendre(part, legendre);
      *acceleration = -legendre.dot(maps_.series_of(a));
    }
    return {-p.displacement, -p.velocity};
  }

  void sample(double first, double spacing, std::span<Sample> samples) override;

  bool parts_exact() const override { return false; }

  std::unique_ptr<MotionSlope> follow(const RigEffect& effect, const Solver& solver,
                                      const HistoryRequest& history) override {
    if (!effect.has_slopes()) return nullptr;
    followed_ = true;
    return std::make_unique<ChainSlope<ChainMotion>>(*this, effect, solver, history);
  }

  void take(double) override {
    std::swap(q_, end_q_);
    std::swap(v_, end_v_);
    lost_ += lost_in_step();
    energy_ = end_energy_;
    std::swap(previous_, a_);
    last_h_ = h_;
    t_ += h_;
    if (slow_) renew_tangent();
  }

 private:
  friend class ChainSlope<ChainMotion>;
  static constexpr int stages = S;
  using ChainType = Chain;
  using HoldType = Hold<S>;

  // Of the accuracy asked for, what Newton's method may leave of a step.
  // The finer method solves a step in one or two iterations: what they leave adds up, from step to
  // step, to vibration of which damping makes force.
  static constexpr double newton_share = S > 4 ? 0.005 : 0.2;
  // What four stages leave of the motion counts by this where no damping makes force of it: ends of
  // steps are far more exact than series are within. First contacts of 106 scenes then err
  // by 8.7e-4 of the accuracy in the median, 7.3e-4 without it, and by 0.38 in the worst, with and
  // without.
  static constexpr double weight_without_damping = S > 4 ? 1.0 : 0.1;
  // The same for what the contacts to come may make of it, of four and eight stages: the six of the
  // paper's bar in a second of bouncing (ANCF [7, 1], eight) had impulses right to 5e-3, 4e-4, 3e-6
  // and 1e-6 at 1e-2, 1e-3, 1e-4 and 1e-5; with 0.03, to 2e-3 at 1e-3.
  static constexpr double weight_in_flight = 0.1;

  /// A head that rings at the bar's own frequencies makes more of it: see Scales::magnification.
  double weight_of_flight() const { return std::min(1.0, magnification_ * weight_in_flight); }

  using Stages = StageArray<S>;
  using Lanes = Eigen::Array<double, S, 1>;
  using Series = Eigen::Matrix<double, S, 1>;
  static constexpr int pairs = S / 2;
  using Complex = ComplexLanes<pairs>;

  void place_stages() { maps_.place(q_, v_, a_, stage_q_, stage_v_); }

  bool held() const { return rotation_ || friction_.sticks(); }

  /// The steady bar has the struck point's speed, a turned one its hinge's rate.
  void turn_as_hinge(double place, const Eigen::ArrayXd& q, Eigen::ArrayXd& v) const {
    v *= std::hypot(q[struck_], place - q[struck_ + Chain::beside]) / place;
  }

  double turned_at(double t) const { return angle_at_start_ + rotation_->angle_at(t); }

  /// As stated, at the stages of the step.
  void turn_hinge() {
    Lanes angle, rate, acceleration;
    for (int i = 0; i < S; ++i) {
      const double t = t_ + h_ * nodes_[i];
      angle[i] = turned_at(t);
      rate[i] = rotation_->rate_at(t);
      acceleration[i] = rotation_->acceleration_at(t);
    }
    hold_.turn(angle, rate, acceleration);
    set_turn(angle - tangent_angle_);
  }

  /// The work of what turns the hinge; the step ends at the hinge's very angle and rate.
  void look_at_rotation(std::span<const StopStep> stops) {
    unheld_residual(stops);
    const Lanes power = hold_.moment(stage_q_, residual_) * hold_.rate();
    driven_ = h_ * (stages_.rule.weights().array() * power).sum();
    Hold<S>::place(turned_at(t_ + h_), rotation_->rate_at(t_ + h_), end_q_, end_v_);
  }

  /// At the stages of the solved step, and what friction took.
  void look_at_hinge(std::span<const StopStep> stops) {
    if (friction_.sticks()) {
      unheld_residual(stops);
      hinge_ = hold_.moment(stage_q_, residual_).matrix();
      return;
    }
    hinge_ = chain_.template hinge_rate<S>(stage_q_, stage_v_).matrix();
    damped_ -= h_ * friction_.moment() * stages_.rule.weights().dot(hinge_);
  }

  /// Of the stages, the hinge let go.
  void unheld_residual(std::span<const StopStep> stops) {
    chain_.template residual<S>(stage_q_, a_, residual_);
    if (chain_.damped()) chain_.template add_damping<S>(stage_q_, stage_v_, residual_);
    if (friction_.slides())
      chain_.template add_hinge_moment<S>(friction_.moment(), stage_q_, residual_);
    for (std::size_t stop = 0; stop < stops.size(); ++stop)
      for_each_share(static_cast<int>(stop),
                     [&](int k, double w) { residual_.col(k) -= w * stops[stop].force.array(); });
  }

  /// By the powers at the nodes.
  double damped_in_step() {
    residual_.setZero();
    chain_.template add_damping<S>(stage_q_, stage_v_, residual_);
    const Lanes power = (residual_ * stage_v_).rowwise().sum();
    return h_ * (stages_.rule.weights().array() * power).sum();
  }

  int stops() const { return static_cast<int>(points_.stops.size()); }

  /// Calls share(k, w) for each coordinate that makes the displacement −Σ w q_k before a stop.
  template <typename Share>
  void for_each_share(int stop, const Share& share) const {
    for (const auto& [k, w] : points_.stops[static_cast<std::size_t>(stop)]) share(k, w);
  }

  PointMotion point_before(int stop, const Eigen::ArrayXd& q, const Eigen::ArrayXd& v) const {
    PointMotion sum;
    for_each_share(stop, [&](int k, double w) {
      sum.displacement -= w * q[k];
      sum.velocity -= w * v[k];
    });
    return sum;
  }

  /// Displacement across the bar before a stop, the other way, as a coordinate of its own.
  struct Across {
    double q = 0.0, v = 0.0;
    Lanes a = Lanes::Zero();
  };

  Across across_before(int stop) const {
    Across sum;
    for_each_share(stop, [&](int k, double w) {
      sum.q += w * q_[k];
      sum.v += w * v_[k];
      sum.a += w * a_.col(k);
    });
    return sum;
  }

  /// Of changed accelerations: the speed they make over the step.
  double size_of(const Stages& change) const {
    double square = 0.0;
    for (int k = 0; k < chain_.coordinates(); ++k)
      square += chain_.inertia()[k] * change.col(k).square().maxCoeff();
    return h_ * std::sqrt(square) / speed_scale_;
  }

  /// Of the positions, turned into forces by the stiffest elements: of size_of() a change.
  double rounding() const {
    return 16.0 * std::numeric_limits<double>::epsilon() *
           std::sqrt((chain_.inertia() * q_.square()).sum()) / (h_ * speed_scale_);
  }

  double lost_in_step() const {
    return total(energy_) + work_done_ + driven_ - damped_ - total(end_energy_);
  }

  void to_beam() const {
    chain_.to_beam(q_, beam_q_);
    chain_.to_beam(v_, beam_v_);
  }

  void begin() {
    newton_.begin_step(h_ / contact_time_);
    maps_.begin_step(h_);
    // a change counts relative to the speed that counts, and more where the bar moves faster
    excess_ = std::max(1.0, std::sqrt(2.0 * energy_.kinetic) / speed_scale_);
    if (rotation_)
      turn_hinge();
    else if (in_contact_ || friction_.sticks())
      turned_ = false;
    else
      set_turn(Lanes::Constant(chord_angle() - tangent_angle_));
    factor_ = &factors_.of(h_, points_.stops, [&](const auto& shares, auto& systems) {
      if (held())
        hold_.template factor<pairs>(tangent_, shares, systems);
      else
        chain_.template factor<pairs>(tangent_, shares, systems);
    });
  }

  /// Of the chord from hinge to tip against hanging, closing > 0 [rad].
  double chord_angle() const { return std::atan2(-q_[tip_], length_ - q_[tip_ + Chain::beside]); }

  void renew_tangent() {
    chain_.renew(q_, tangent_);
    if (held()) hold_.release(Hold<S>::angle_of(q_), tangent_);
    tangent_angle_ = rotation_ ? turned_at(t_) : chord_angle();
    factors_.forget();
    slow_ = false;
  }

  void set_turn(const Lanes& angle) {
    turned_ = (angle != 0.0).any();
    turn_cosine_ = angle.cos();
    turn_sine_ = angle.sin();
  }

  /// Turns every pair of coordinates by an angle, closing.
  void rotate(const Lanes& cosine, const Lanes& sine, Stages& x) const {
    turn_stages({.stages = S,
                 .pairs = static_cast<int>(across_.size()),
                 .first = across_.data(),
                 .second = along_.data(),
                 .cosine = cosine.data(),
                 .sine = sine.data(),
                 .columns = x.data()});
  }

  void add_departure(double part, Sample& sample) const;
  /// What forces of the stops change like this makes of the accelerations.
  template <typename ChangeOf>
  void respond(const ChangeOf& change_of, Stages& to);
  void solve(Stages& r);

  typename Chain::Beam beam_;
  Chain chain_;
  StageMaps<S> maps_{chain_.coordinates()};
  const RadauStages<S>& stages_ = maps_.method();
  Lanes nodes_ = stages_.rule.points().array();
  std::vector<int> across_, along_;  // coordinates that turn with the bar
  StepLadder ladder_;
  int struck_, tip_;
  double length_, place_;  // of the bar, of the struck point [m]
  double compliance_;
  double accuracy_;
  double weight_energy_;
  double speed_scale_ = 1.0, contact_time_ = 1.0, damping_ = 0.0, magnification_ = 1.0;

  Eigen::ArrayXd q_, v_;
  double h_ = 0.0, last_h_ = 0.0;
  Stages a_, previous_, previous_guess_, stage_q_, stage_v_, residual_;
  mutable Stages series_;  // scratch of error()
  Eigen::ArrayXd end_q_, end_v_;
  BeamEnergy energy_, end_energy_;
  double lost_ = 0.0;       // by the method since the start [J]
  double damped_ = 0.0;     // in bar and hinge over the step [J]
  double work_done_ = 0.0;  // on the bar by the stop over the step [J]

  HingeFriction friction_;
  HingeFriction::Change friction_change_;
  NodeVector hinge_;  // at the stages: its rate, or the moment that holds it
  Hold<S> hold_;
  std::optional<HingeRotation> rotation_;
  double t_ = 0.0;               // from the start, of a turned hinge [s]
  double angle_at_start_ = 0.0;  // [rad]
  double driven_ = 0.0;          // work of what turns the hinge over the step [J]
  ChainPoints points_;

  typename Chain::Tangent tangent_;
  ChainFactors<S, Chain> factors_;
  typename ChainFactors<S, Chain>::Factor* factor_ = nullptr;
  bool slow_ = false;
  bool followed_ = false;  // by a derivative
  bool steady_ = true;
  bool in_contact_ = false;
  bool touched_ = false;  // since the start
  double tangent_angle_ = 0.0;
  bool turned_ = false;  // the bar, since the tangent was made; by how much at the stages
  Lanes turn_cosine_ = Lanes::Ones(), turn_sine_ = Lanes::Zero();

  std::vector<Complex> work_;
  NewtonProgress newton_;
  double excess_ = 1.0;
  mutable Eigen::VectorXd beam_q_, beam_v_;
};

/// r becomes the accelerations that Newton's method takes off. A bar that has turned since the
/// tangent was made has the same tangent, turned.
template <int S, typename Chain, template <int> typename Hold>
void ChainMotion<S, Chain, Hold>::solve(Stages& r) {
  if (turned_) rotate(turn_cosine_, -turn_sine_, r);
  maps_.split(r, work_);
  factor_->systems.solve_in_place(work_);
  maps_.gather(work_, r);
  if (turned_) rotate(turn_cosine_, turn_sine_, r);
}

template <int S, typename Chain, template <int> typename Hold>
bool ChainMotion<S, Chain, Hold>::improve(std::span<StopStep> stops) {
  if (chain_.damped() || held())
    place_stages();
  else
    maps_.place_displacements(q_, v_, a_, stage_q_);
  unheld_residual(stops);
  if (held()) hold_.constrain(stage_q_, stage_v_, a_, residual_);
  solve(residual_);
  a_ -= residual_;
  for (std::size_t stop = 0; stop < stops.size(); ++stop) {
    const auto [q, v, a] = across_before(static_cast<int>(stop));
    stops[stop].displacement = -(q + maps_.displacement_of(v, a)).matrix();
    stops[stop].velocity = -(v + maps_.velocity_of(a)).matrix();
  }
  return newton_.improved(excess_ * size_of(residual_), excess_ * rounding());
}

template <int S, typename Chain, template <int> typename Hold>
template <typename ChangeOf>
void ChainMotion<S, Chain, Hold>::respond(const ChangeOf& change_of, Stages& to) {
  for (std::size_t stop = 0; stop < points_.stops.size(); ++stop) {
    Complex share;
    share.re = (stages_.into_re * change_of(stop)).array();
    share.im = (stages_.into_im * change_of(stop)).array();
    const std::vector<Complex>& pressed = factor_->pressed[stop];
    for (std::size_t k = 0; k < work_.size(); ++k) {
      const Complex x = pressed[k] * share;
      if (stop == 0)
        work_[k] = x;
      else
        work_[k] += x;
    }
  }
  maps_.gather(work_, to);
}

template <int S, typename Chain, template <int> typename Hold>
void ChainMotion<S, Chain, Hold>::press(std::span<const StopStep> stops) {
  respond([&](std::size_t stop) -> const NodeVector& { return stops[stop].change; }, residual_);
  a_ += residual_;
  newton_.pressed(excess_ * size_of(residual_));
}

/// Eight stages where four would need many more steps: of fine accuracy, where vibration that a
/// coarser method lets die is seen in the force, and against a stop of meshes so coarse that their
/// fastest vibration has to be followed anyway, or where a stiff spring is let go with the bar,
/// whose vibration lasts all the swing. At 6e-6 four stages erred by 0.9 of what was asked for (128
/// elements); times of both are equal at 3e-4 with 32 elements.
inline bool takes_eight_stages(const Rig& rig, const Solver& solver) {
  if (rig.has_stop() && rig.start.release_angle && spring_bends_bar(rig)) return true;
  const double elements = solver.elements[0] + solver.elements[1];
  const double followed = rig.has_stop() ? std::pow(8.0 / elements, 6) : 0.0;
  return solver.accuracy <= std::max(1e-5, followed);
}

template <typename Chain, template <int> typename Hold>
std::unique_ptr<BarMotion> make_chain_motion(const Rig& rig, const Solver& solver,
                                             const HistoryRequest& history) {
  if (takes_eight_stages(rig, solver))
    return std::make_unique<ChainMotion<8, Chain, Hold>>(rig, solver, history);
  return std::make_unique<ChainMotion<4, Chain, Hold>>(rig, solver, history);
}

}  // namespace
}  // namespace impactrig::models
