// SPDX-License-Identifier: BSD-3-Clause
#include "bench/sundials_impact.hpp"

#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "models/beams/ancf.hpp"
#include "models/beams/floating_frame.hpp"
#include "models/contact/contact_force.hpp"
#include "models/run_limits.hpp"

namespace impactrig::bench {
namespace {

using models::PointMotion;
using Phase = models::ContactForce::Phase;

void check(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(fmt::format("{} failed with {}", what, flag));
}

template <auto free_it>
struct Freed {
  template <typename Pointer>
  void operator()(Pointer p) const {
    free_it(p);
  }
};

using Context = std::unique_ptr<_SUNContext, decltype([](SUNContext c) { SUNContext_Free(&c); })>;
using Vector = std::unique_ptr<_generic_N_Vector, Freed<N_VDestroy>>;
using Matrix = std::unique_ptr<_generic_SUNMatrix, Freed<SUNMatDestroy>>;
using LinearSolver = std::unique_ptr<_generic_SUNLinearSolver, Freed<SUNLinSolFree>>;
using NonlinearSolver = std::unique_ptr<_generic_SUNNonlinearSolver, Freed<SUNNonlinSolFree>>;

Context make_context() {
  SUNContext context = nullptr;
  check(SUNContext_Create(nullptr, &context), "SUNContext_Create");
  return Context(context);
}

Eigen::Map<Eigen::VectorXd> mapped(N_Vector v) {
  return {N_VGetArrayPointer(v), N_VGetLength(v)};
}

std::unique_ptr<models::BeamDynamics> make_beam(const models::Rig& rig,
                                                const models::Solver& solver) {
  if (solver.model == models::BeamModel::ancf)
    return std::make_unique<models::AncfBeam>(rig, solver.elements);
  const bool rigid = solver.model == models::BeamModel::rigid;
  return std::make_unique<models::FloatingFrameBeam>(rig, solver.basis, rigid ? 0 : solver.modes,
                                                     rigid ? 0 : solver.axial_modes);
}

/// Bar and contact as a first-order system y = [q, v, impulse, dissipated energy], in an order of
/// its own where a Jacobian is to be banded.
class Equations {
 public:
  Equations(const models::Rig& rig, const models::Solver& solver, bool node_by_node)
      : beam_(make_beam(rig, solver)),
        contact_(rig),
        n_(beam_->size()),
        y_(2 * n_ + 2),
        slope_(2 * n_ + 2) {
    if (node_by_node) order_node_by_node(2 * solver.elements[0] - 1);
    const double speed = touch_velocity(rig);
    y_.setZero();
    beam_->set_steady_motion(0.0, speed / rig.contact.position, y_.head(n_), y_.segment(n_, n_));
    start_ = y_;
    const double kinetic = beam_->energy(y_.head(n_), y_.segment(n_, n_)).kinetic;
    const double depth = models::penetration_storing(contact_, kinetic);
    const Eigen::VectorXd speeds =
        (2.0 * kinetic * beam_->inertia_diagonal().cwiseInverse()).cwiseSqrt();
    scale_.resize(2 * n_ + 2);
    scale_ << speeds * (depth / speed), speeds, 2.0 * kinetic / speed, kinetic;
  }

  int size() const { return 2 * n_ + 2; }

  models::ContactForce& contact() { return contact_; }

  void write_start(N_Vector y) const { scatter(start_, y); }

  /// What the energy at touch gives each unknown.
  void write_scale(N_Vector y) const { scatter(scale_, y); }

  int slope(N_Vector y, N_Vector dydt) {
    ++evaluations_;
    if (place_.empty()) {
      evaluate(mapped(y), mapped(dydt));
    } else {
      gather(y);
      evaluate(y_, slope_);
      scatter(slope_, dydt);
    }
    return 0;
  }

  PointMotion struck(N_Vector y) {
    if (place_.empty()) {
      const auto state = mapped(y);
      return beam_->struck_point(state.head(n_), state.segment(n_, n_));
    }
    gather(y);
    return beam_->struck_point(y_.head(n_), y_.segment(n_, n_));
  }

  double force(N_Vector y) {
    const PointMotion p = struck(y);
    return contact_.force(p.displacement, p.velocity);
  }

  double force_rate(N_Vector y, N_Vector dydt) {
    const PointMotion p = struck(y);
    double acceleration = 0.0;
    if (place_.empty()) {
      const auto s = mapped(y), d = mapped(dydt);
      acceleration = beam_->struck_acceleration(s.head(n_), s.segment(n_, n_), d.segment(n_, n_));
    } else {
      slope_ = y_;
      gather(dydt);
      acceleration =
          beam_->struck_acceleration(slope_.head(n_), slope_.segment(n_, n_), y_.segment(n_, n_));
    }
    const models::ContactForce::Response law = contact_.pressed(p.displacement, p.velocity);
    return law.to_depth * p.velocity + law.to_rate * acceleration;
  }

  double impulse(N_Vector y) const {
    return mapped(y)[place_.empty() ? 2 * n_ : place_[static_cast<std::size_t>(2 * n_)]];
  }

  long evaluations() const { return evaluations_; }

 private:
  /// ANCF: everything of a node side by side, impulse and energy with the struck node.
  void order_node_by_node(int struck_dof) {
    const int dofs = n_ / 2;
    place_.resize(static_cast<std::size_t>(size()));
    int next = 0;
    for (int node = 0; 2 * node <= dofs; ++node) {
      for (const int part : {0, dofs, n_, n_ + dofs})
        for (int dof = std::max(2 * node - 1, 0); dof < std::min(2 * node + 1, dofs); ++dof)
          place_[static_cast<std::size_t>(part + dof)] = next++;
      if (2 * node - 1 != struck_dof) continue;
      place_[static_cast<std::size_t>(2 * n_)] = next++;
      place_[static_cast<std::size_t>(2 * n_ + 1)] = next++;
    }
  }

  void gather(N_Vector y) {
    const double* from = N_VGetArrayPointer(y);
    for (int i = 0; i < size(); ++i) y_[i] = from[place_[static_cast<std::size_t>(i)]];
  }

  void scatter(const Eigen::VectorXd& y, N_Vector to) const {
    double* out = N_VGetArrayPointer(to);
    for (int i = 0; i < size(); ++i)
      out[place_.empty() ? i : place_[static_cast<std::size_t>(i)]] = y[i];
  }

  void evaluate(models::ConstVector y, models::VectorRef slope) {
    const auto q = y.head(n_), v = y.segment(n_, n_);
    const PointMotion p = beam_->struck_point(q, v);
    const double force = contact_.force(p.displacement, p.velocity);
    slope.head(n_) = v;
    beam_->acceleration(q, v, force, slope.segment(n_, n_));
    slope[2 * n_] = force;
    slope[2 * n_ + 1] = contact_.dissipation(p.displacement, p.velocity);
  }

  std::unique_ptr<models::BeamDynamics> beam_;
  models::ContactForce contact_;
  int n_;
  Eigen::VectorXd y_, slope_, start_, scale_;
  std::vector<int> place_;  // of [q, v, ...] in the state; empty: as they are
  long evaluations_ = 0;
};

int right_hand_side(double, N_Vector y, N_Vector dydt, void* equations) {
  return static_cast<Equations*>(equations)->slope(y, dydt);
}

/// What ends a phase: the gap, and where the law would pull. Without the other, a constant.
int events(double, N_Vector y, double* value, void* data) {
  auto& equations = *static_cast<Equations*>(data);
  const PointMotion p = equations.struck(y);
  const models::ContactForce& contact = equations.contact();
  value[0] = p.displacement;
  const double sign = contact.phase() == Phase::pressed ? 1.0 : -1.0;
  value[1] =
      contact.may_switch() ? sign * contact.switching(p.displacement, p.velocity).value : 1.0;
  return 0;
}

/// What CVODE and ARKODE have in common.
class Stepper {
 public:
  static constexpr int stopped = CV_TSTOP_RETURN, root = CV_ROOT_RETURN;

  virtual ~Stepper() = default;
  virtual void restart(double t, N_Vector y, double t_end, std::array<int, 2> directions) = 0;
  virtual int step(double t_end, N_Vector y, double& t) = 0;  ///< negative: failed
  virtual void dense(double t, int derivative, N_Vector y) = 0;
  virtual std::array<int, 2> roots() = 0;
  virtual long steps() = 0;
};

void ignore_messages(int, const char*, const char*, char*, void*) {}

class Cvode : public Stepper {
 public:
  Cvode(Equations& equations, const SundialsSettings& settings, int half_band, N_Vector y,
        N_Vector absolute, SUNContext context)
      : memory_(CVodeCreate(settings.method == SundialsMethod::bdf ? CV_BDF : CV_ADAMS, context)) {
    check(CVodeInit(memory_.get(), right_hand_side, 0.0, y), "CVodeInit");
    check(CVodeSetErrHandlerFn(memory_.get(), ignore_messages, nullptr), "CVodeSetErrHandlerFn");
    check(CVodeSetUserData(memory_.get(), &equations), "CVodeSetUserData");
    check(CVodeSVtolerances(memory_.get(), settings.tolerance, absolute), "CVodeSVtolerances");
    check(CVodeSetMaxNumSteps(memory_.get(), -1), "CVodeSetMaxNumSteps");
    if (settings.most_order > 0)
      check(CVodeSetMaxOrd(memory_.get(), settings.most_order), "CVodeSetMaxOrd");
    check(CVodeRootInit(memory_.get(), 2, events), "CVodeRootInit");
    check(CVodeSetNoInactiveRootWarn(memory_.get()), "CVodeSetNoInactiveRootWarn");
    if (settings.method == SundialsMethod::adams) {
      iteration_.reset(SUNNonlinSol_FixedPoint(y, 0, context));
      check(CVodeSetNonlinearSolver(memory_.get(), iteration_.get()), "CVodeSetNonlinearSolver");
      return;
    }
    const auto n = N_VGetLength(y);
    if (half_band > 0) {
      matrix_.reset(SUNBandMatrix(n, half_band, half_band, context));
      linear_.reset(SUNLinSol_Band(y, matrix_.get(), context));
    } else {
      matrix_.reset(SUNDenseMatrix(n, n, context));
      linear_.reset(SUNLinSol_Dense(y, matrix_.get(), context));
    }
    check(CVodeSetLinearSolver(memory_.get(), linear_.get(), matrix_.get()),
          "CVodeSetLinearSolver");
    check(CVodeSetStabLimDet(memory_.get(), SUNTRUE), "CVodeSetStabLimDet");
  }

  void restart(double t, N_Vector y, double t_end, std::array<int, 2> directions) override {
    before_ += counted();
    check(CVodeReInit(memory_.get(), t, y), "CVodeReInit");
    check(CVodeSetStopTime(memory_.get(), t_end), "CVodeSetStopTime");
    check(CVodeSetRootDirection(memory_.get(), directions.data()), "CVodeSetRootDirection");
  }

  int step(double t_end, N_Vector y, double& t) override {
    return CVode(memory_.get(), t_end, y, &t, CV_ONE_STEP);
  }

  void dense(double t, int derivative, N_Vector y) override {
    check(CVodeGetDky(memory_.get(), t, derivative, y), "CVodeGetDky");
  }

  std::array<int, 2> roots() override {
    std::array<int, 2> found{};
    check(CVodeGetRootInfo(memory_.get(), found.data()), "CVodeGetRootInfo");
    return found;
  }

  long steps() override { return before_ + counted(); }

 private:
  long counted() {
    long n = 0;
    check(CVodeGetNumSteps(memory_.get(), &n), "CVodeGetNumSteps");
    return n;
  }

  std::unique_ptr<void, decltype([](void* p) { CVodeFree(&p); })> memory_;
  Matrix matrix_;
  LinearSolver linear_;
  NonlinearSolver iteration_;
  long before_ = 0;  // steps before the last restart
};

class ErkStep : public Stepper {
 public:
  ErkStep(Equations& equations, const SundialsSettings& settings, N_Vector y, N_Vector absolute,
          SUNContext context)
      : memory_(ERKStepCreate(right_hand_side, 0.0, y, context)) {
    check(ERKStepSetErrHandlerFn(memory_.get(), ignore_messages, nullptr),
          "ERKStepSetErrHandlerFn");
    check(ERKStepSetUserData(memory_.get(), &equations), "ERKStepSetUserData");
    check(ERKStepSVtolerances(memory_.get(), settings.tolerance, absolute), "ERKStepSVtolerances");
    check(ERKStepSetTableName(memory_.get(), settings.table.c_str()), "ERKStepSetTableName");
    check(ERKStepSetMaxNumSteps(memory_.get(), -1), "ERKStepSetMaxNumSteps");
    check(ERKStepRootInit(memory_.get(), 2, events), "ERKStepRootInit");
    check(ERKStepSetNoInactiveRootWarn(memory_.get()), "ERKStepSetNoInactiveRootWarn");
  }

  void restart(double t, N_Vector y, double t_end, std::array<int, 2> directions) override {
    before_ += counted();
    check(ERKStepReInit(memory_.get(), right_hand_side, t, y), "ERKStepReInit");
    check(ERKStepSetStopTime(memory_.get(), t_end), "ERKStepSetStopTime");
    check(ERKStepSetRootDirection(memory_.get(), directions.data()), "ERKStepSetRootDirection");
  }

  int step(double t_end, N_Vector y, double& t) override {
    return ERKStepEvolve(memory_.get(), t_end, y, &t, ARK_ONE_STEP);
  }

  void dense(double t, int derivative, N_Vector y) override {
    check(ERKStepGetDky(memory_.get(), t, derivative, y), "ERKStepGetDky");
  }

  std::array<int, 2> roots() override {
    std::array<int, 2> found{};
    check(ERKStepGetRootInfo(memory_.get(), found.data()), "ERKStepGetRootInfo");
    return found;
  }

  long steps() override { return before_ + counted(); }

 private:
  long counted() {
    long n = 0;
    check(ERKStepGetNumSteps(memory_.get(), &n), "ERKStepGetNumSteps");
    return n;
  }

  std::unique_ptr<void, decltype([](void* p) { ERKStepFree(&p); })> memory_;
  long before_ = 0;  // steps before the last restart
};

/// One run from event to event.
class ImpactBySundials {
 public:
  ImpactBySundials(const models::Rig& rig, const models::Solver& solver,
                   const SundialsSettings& settings)
      : settings_(settings),
        t_end_(solver.duration.value()),
        banded_(settings.method == SundialsMethod::bdf && settings.band_nodes > 0 &&
                solver.model == models::BeamModel::ancf),
        equations_(rig, solver, banded_),
        context_(make_context()),
        y_(N_VNew_Serial(equations_.size(), context_.get())),
        slope_(N_VClone(y_.get())),
        probe_(N_VClone(y_.get())) {
    equations_.write_start(y_.get());
    equations_.write_scale(probe_.get());
    N_VScale(settings.tolerance * settings.absolute, probe_.get(), probe_.get());
    const int half_band = banded_ ? 8 * settings.band_nodes + 9 : 0;
    if (settings.method == SundialsMethod::erk)
      stepper_ =
          std::make_unique<ErkStep>(equations_, settings, y_.get(), probe_.get(), context_.get());
    else
      stepper_ = std::make_unique<Cvode>(equations_, settings, half_band, y_.get(), probe_.get(),
                                         context_.get());
  }

  SundialsRun run() {
    const auto started = std::chrono::steady_clock::now();
    const auto late = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() >
             settings_.time_limit;
    };
    touch();
    for (long k = 1;; ++k) {
      const double before = t_;
      const int flag = stepper_->step(t_end_, y_.get(), t_);
      if (flag < 0) result_.failure = fmt::format("stopped at {:g} s with {}", t_, flag);
      if (k % 1024 == 0 && late()) result_.failure = "over the time limit";
      if (!result_.failure.empty()) break;
      observe(before);
      if (flag == Stepper::stopped) break;
      if (flag == Stepper::root) change_phase();
    }
    result_.steps = stepper_->steps();
    result_.evaluations = equations_.evaluations();
    return result_;
  }

 private:
  void touch() {
    models::ContactForce& contact = equations_.contact();
    const double speed = equations_.struck(y_.get()).velocity;
    if (result_.contacts++ == 0) first_speed_ = speed;
    contact.begin_episode(std::max(speed, models::grazing_fraction * first_speed_));
    contact.set_phase(Phase::pressed);
    begin_phase();
  }

  void change_phase() {
    models::ContactForce& contact = equations_.contact();
    const bool at_gap = stepper_->roots()[0] != 0;
    if (!at_gap) {
      contact.set_phase(contact.phase() == Phase::pressed ? Phase::slack : Phase::pressed);
    } else if (contact.phase() == Phase::free) {
      touch();
      return;
    } else {
      contact.set_phase(Phase::free);
      if (result_.contacts == 1) {
        result_.first_end = t_;
        result_.first_impulse = equations_.impulse(y_.get());
      }
    }
    begin_phase();
  }

  void begin_phase() {
    const Phase phase = equations_.contact().phase();
    stepper_->restart(t_, y_.get(), t_end_,
                      {phase == Phase::free ? 1 : -1, phase == Phase::pressed ? -1 : 1});
    force_ = rate_ = 0.0;
    fresh_ = true;
  }

  /// Peak force within the step from `before` to the present state, on the method's own
  /// interpolant, wherever a cubic through forces and rates at its ends has a maximum.
  void observe(double before) {
    if (equations_.contact().phase() != Phase::pressed) return;
    if (fresh_) {
      stepper_->dense(before, 0, probe_.get());
      stepper_->dense(before, 1, slope_.get());
      force_ = equations_.force(probe_.get());
      rate_ = equations_.force_rate(probe_.get(), slope_.get());
      fresh_ = false;
    }
    stepper_->dense(t_, 1, slope_.get());
    const double h = t_ - before;
    const double force = equations_.force(y_.get());
    const double rate = equations_.force_rate(y_.get(), slope_.get());
    double highest = std::max(force_, force);
    double from = rate_ > 0.0 && rate < 0.0 ? 0.0 : 2.0;
    for (const double s : {0.25, 0.5, 0.75}) {
      const double cubic = (1.0 - s) * (1.0 - s) * ((1.0 + 2.0 * s) * force_ + s * h * rate_) +
                           s * s * ((3.0 - 2.0 * s) * force - (1.0 - s) * h * rate);
      if (cubic <= highest) continue;
      highest = cubic;
      from = s - 0.25;
    }
    result_.peak_force = std::max(result_.peak_force, force);
    force_ = force;
    rate_ = rate;
    if (from > 1.0 || highest < 0.9 * result_.peak_force) return;
    const auto negative = [&](double s) {
      stepper_->dense(before + s * h, 0, probe_.get());
      return -equations_.force(probe_.get());
    };
    const double to = rate_ < 0.0 && from == 0.0 ? 1.0 : from + 0.5;
    const double top = -boost::math::tools::brent_find_minima(negative, from, to, 26).second;
    result_.peak_force = std::max(result_.peak_force, top);
  }

  SundialsSettings settings_;
  double t_end_;
  bool banded_;
  Equations equations_;
  Context context_;
  Vector y_, slope_, probe_;
  std::unique_ptr<Stepper> stepper_;
  double t_ = 0.0;
  double first_speed_ = 0.0;
  double force_ = 0.0, rate_ = 0.0;  // at the beginning of the step
  bool fresh_ = true;                // the phase has just begun: they are not known
  SundialsRun result_;
};

}  // namespace

SundialsRun run_sundials(const models::Rig& rig, const models::Solver& solver,
                         const SundialsSettings& settings) {
  return ImpactBySundials(rig, solver, settings).run();
}

}  // namespace impactrig::bench
