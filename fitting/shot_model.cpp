// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/sampled_curve.hpp"
#include "fitting/force_curve.hpp"
#include "models/mesh_error.hpp"
#include "models/sensitivities/spot_sensitivity.hpp"

namespace impactrig::fitting {
namespace {

// Finer than the recording by this: interpolation and the chain's linear hold are off by a
// hundred-thousandth of the peak at 1 MHz and contacts of 200 us, of which noise leaves nothing.
constexpr double oversampling = 4.0;
constexpr double coarsest = 0.25e-6;  // [s]
// In small motion, where it costs little: what a step of the solver changes must not drown in what
// the next simulation rounds differently.
constexpr double fine_accuracy = 1e-9;
// Of noise that is a thousandth of the peak, a thousandth; slopes need no more.
constexpr double rough_accuracy = 1e-6;
// They lead a search, and are what standard errors are made of.
constexpr double slope_accuracy = 1e-5;
// Of a number of a sensor's chain, for a central difference of closed forms.
constexpr double chain_step = 1e-4;

double least_size(double a, double b) {
  if (!(a * b > 0.0)) return 0.0;
  return std::abs(a) < std::abs(b) ? a : b;
}

/// sensor_response() takes its input as linear between samples, which lie on the wrong side of a
/// bent course by h²/12 of its curvature on the average. Less that, the error is of fourth order
/// where the course is smooth; next to a kink the smaller curvature beside it counts.
std::vector<double> unbent(const std::vector<double>& values) {
  std::vector<double> result = values;
  const auto bend = [&](std::size_t k) { return values[k - 1] - 2.0 * values[k] + values[k + 1]; };
  for (std::size_t k = 2; k + 2 < values.size(); ++k)
    result[k] -= least_size(bend(k), least_size(bend(k - 1), bend(k + 1))) / 12.0;
  return result;
}

/// Through the sensor's chain.
Shown::Curve curve(const std::optional<datasets::Sensor>& sensor, const models::History& history,
                   const std::vector<double>& values, ForceBreaks breaks = {}) {
  const bool bends = sensor && (sensor->resonance || sensor->low_cut || sensor->high_cut);
  Shown::Curve shown{.start = history.start,
                     .interval = history.interval,
                     .values = bends ? unbent(values) : values,
                     .jumps = std::move(breaks.jumps),
                     .spikes = std::move(breaks.spikes)};
  for (const models::SampleImpulse& known : breaks.impulses)
    datasets::add_missed(shown, known.time, known.sample, known.impulse);
  return bends ? datasets::sensor_response(*sensor, std::move(shown)) : shown;
}

ForceBreaks breaks_of(const models::History& history) {
  ForceBreaks breaks{.impulses = history.impulses};
  for (const models::ForceJump& jump : history.jumps)
    breaks.jumps.push_back({jump.time, jump.before, jump.after});
  return breaks;
}

/// Of the derivative's curve, at held times: a jump that moves leaves a spike in it.
ForceBreaks breaks_of(const models::History& derivative, const models::History& history) {
  ForceBreaks breaks{.impulses = derivative.impulses};
  if (history.jumps.empty()) return breaks;
  const Shown::Curve force = force_curve(history);
  for (std::size_t k = 0; k < history.jumps.size(); ++k) {
    const models::ForceJump &jump = history.jumps[k], &by = derivative.jumps[k];
    const auto held = [&](double limit, std::size_t piece) {
      return limit - by.time * force.at(jump.time, piece)[1];
    };
    breaks.jumps.push_back({jump.time, held(by.before, k), held(by.after, k + 1)});
    breaks.spikes.push_back({jump.time, -(jump.after - jump.before) * by.time});
  }
  return breaks;
}

constexpr std::optional<Shown::Curve> Shown::*all_curves[] = {&Shown::force, &Shown::velocity,
                                                              &Shown::displacement};
constexpr double models::Restitution::*all_restitutions[] = {&models::Restitution::kinematic,
                                                             &models::Restitution::kinetic,
                                                             &models::Restitution::energetic};

/// Whether a curve goes on at its jumps, as behind a low-pass.
bool is_continuous(const Shown::Curve& curve) {
  constexpr double rounding = 1e-9;
  return curve.spikes.empty() && std::ranges::all_of(curve.jumps, [](const auto& jump) {
           return std::abs(jump.after - jump.before) <= rounding * std::abs(jump.before);
         });
}

bool is_continuous(const Shown& shown) {
  return std::ranges::all_of(all_curves, [&](const auto curve) {
    return !(shown.*curve) || is_continuous(*(shown.*curve));
  });
}

/// None where a curve jumps.
std::optional<Shown> difference(const Shown& one, const Shown& other) {
  if (!is_continuous(one) || !is_continuous(other)) return std::nullopt;
  Shown result;
  for (const auto curve : all_curves) {
    const auto &a = one.*curve, &b = other.*curve;
    if (!a) continue;
    if (a->values.size() != b->values.size()) return std::nullopt;
    Shown::Curve left{.start = a->start, .interval = a->interval, .values = a->values};
    for (std::size_t k = 0; k < left.values.size(); ++k) left.values[k] -= b->values[k];
    result.*curve = std::move(left);
  }
  for (const auto which : all_restitutions)
    result.restitution.*which = one.restitution.*which - other.restitution.*which;
  return result;
}

/// Within the time of what is added, which does not jump.
void add(const Shown::Curve& more, Shown::Curve& to) {
  const double end = more.start + more.interval * static_cast<double>(more.values.size() - 1);
  const auto at = [&](double time) {
    return time >= more.start && time <= end ? more.at(time)[0] : 0.0;
  };
  for (std::size_t k = 0; k < to.values.size(); ++k)
    to.values[k] += at(to.start + to.interval * static_cast<double>(k));
  for (datasets::CurveJump& jump : to.jumps) {
    jump.before += at(jump.time);
    jump.after += at(jump.time);
  }
}

void add(const Shown& more, Shown& to) {
  for (const auto curve : all_curves)
    if (to.*curve) add(*(more.*curve), *(to.*curve));
  for (const auto which : all_restitutions) to.restitution.*which += more.restitution.*which;
}

}  // namespace

std::optional<datasets::Sensor>& SensorChains::of(datasets::Quantity quantity) {
  if (quantity == datasets::Quantity::force) return force;
  return quantity == datasets::Quantity::velocity ? velocity : displacement;
}

const std::optional<datasets::Sensor>& SensorChains::of(datasets::Quantity quantity) const {
  if (quantity == datasets::Quantity::force) return force;
  return quantity == datasets::Quantity::velocity ? velocity : displacement;
}

ShotModel::ShotModel(const RigFile& rig, const datasets::Impact& impact, double lead, double end,
                     double step)
    : chains_{rig.force, rig.velocity, rig.displacement},
      solver_(rig.solver),
      force_(impact.force.has_value()),
      velocity_(impact.velocity.has_value()),
      displacement_(impact.displacement.has_value()),
      lead_(lead),
      end_(end),
      interval_(std::min(step / oversampling, coarsest)) {}

bool ShotModel::learn_full_motion(const models::Rig& rig, const SensorChains& chains) {
  ShotModel small = *this, full = *this;
  small.forget_full_motion();
  full.motion_ = models::Motion::full;
  const Shown by_small = small.predict(rig, chains);
  if (!is_continuous(by_small)) return false;
  const std::optional<Shown> beyond = difference(full.predict(rig, chains), by_small);
  if (!beyond) return false;
  beyond_small_ = std::make_shared<const Shown>(*beyond);
  return true;
}

ShotModel ShotModel::as_learned() const {
  ShotModel model = *this;
  if (beyond_small_) model.motion_ = models::Motion::full;
  return model;
}

ShotModel ShotModel::in_small_motion() const {
  ShotModel model = *this;
  model.motion_ = models::Motion::small;
  model.for_slopes_ = true;
  return model;
}

ShotModel ShotModel::finer() const {
  ShotModel model = *this;
  model.solver_ = models::refined(solver_);
  model.bars_ = std::make_shared<models::BarCache>();
  return model;
}

std::optional<ShotModel> ShotModel::halved(const models::Rig& rig) const {
  const std::optional<models::Solver> solver = models::halved(rig, solver_);
  if (!solver) return std::nullopt;
  ShotModel model = *this;
  model.solver_ = *solver;
  model.bars_ = std::make_shared<models::BarCache>();
  return model;
}

ShotModel ShotModel::coarser(const models::Rig& rig) const {
  ShotModel model = *this;
  model.solver_ = models::coarsened(rig, solver_);
  model.bars_ = std::make_shared<models::BarCache>();
  return model;
}

models::Simulation ShotModel::simulate(const models::Rig& rig, double interval,
                                       const std::vector<models::RigParameter>& by) const {
  models::SimulationOptions options;
  options.history.interval = interval;
  options.sensitivities = by;
  return simulate(rig, chains_, std::move(options));
}

models::Simulation ShotModel::simulate(const models::Rig& rig, const SensorChains& chains,
                                       models::SimulationOptions options) const {
  models::Solver solver = solver_;
  solver.duration = end_;
  if (motion_ == models::Motion::small)
    solver.accuracy =
        std::min(solver.accuracy, rough_ || for_slopes_ ? rough_accuracy : fine_accuracy);
  options.history.lead = lead_;
  options.motion = motion_;
  options.bars = bars_.get();
  if (chains.velocity) options.history.velocity_position = chains.velocity->position;
  if (chains.displacement) options.history.displacement_position = chains.displacement->position;
  return models::simulate(rig, solver, options);
}

/// A history, or its derivatives, with the breaks of its force: the sensors' chains are linear.
Shown ShotModel::show(const models::History& history, const SensorChains& chains,
                      ForceBreaks breaks) const {
  Shown shown;
  if (force_) shown.force = curve(chains.force, history, history.seen_force(), std::move(breaks));
  if (velocity_) shown.velocity = curve(chains.velocity, history, history.velocity);
  if (displacement_) shown.displacement = curve(chains.displacement, history, history.displacement);
  return shown;
}

/// By the place of a laser's spot.
Shown ShotModel::spot_slope(const models::History& history, const SensorChains& chains,
                            datasets::Quantity quantity) const {
  const models::Laser laser = quantity == datasets::Quantity::velocity
                                  ? models::Laser::velocity
                                  : models::Laser::displacement;
  return show(models::spot_sensitivity(history, laser), chains, {});
}

/// By a number of one sensor's chain: a central difference of the chain's response to the history,
/// which is smooth in it; the other channels do not change. The motion tells itself how what a
/// laser sees changes with its spot.
Shown ShotModel::chain_slope(const models::History& history, SensorChains chains,
                             const WantedSlopes::Chain& by) const {
  if (by.parameter->name == "position") return spot_slope(history, chains, by.quantity);
  double& number = by.parameter->of(*chains.of(by.quantity));
  const double middle = number, step = chain_step * middle;
  const auto shown_at = [&](double value) {
    number = value;
    return show(history, chains, breaks_of(history));
  };
  Shown slope = shown_at(middle + step);
  const Shown below = shown_at(middle - step);
  const auto difference = [&](std::optional<Shown::Curve>& to,
                              const std::optional<Shown::Curve>& from) {
    if (to) *to = difference_quotient(*to, *from, 2.0 * step);
  };
  difference(slope.force, below.force);
  difference(slope.velocity, below.velocity);
  difference(slope.displacement, below.displacement);
  slope.restitution = {};
  return slope;
}

Shown ShotModel::predict(const models::Rig& rig, const SensorChains& chains,
                         const WantedSlopes& wanted) const {
  const double interval = rough_ ? oversampling * interval_ : interval_;
  models::SimulationOptions options;
  options.history.interval = interval;
  options.history.spot_slopes = std::ranges::any_of(
      wanted.chain, [](const WantedSlopes::Chain& by) { return by.parameter->name == "position"; });
  options.sensitivities = wanted.rig;
  options.sensitivity_accuracy = slope_accuracy;
  options.judge_small_motion = false;
  const models::Simulation simulation = simulate(rig, chains, options);
  Shown shown = show(simulation.history, chains, breaks_of(simulation.history));
  shown.restitution = simulation.restitution;
  if (beyond_small_ && motion_ == models::Motion::small && !for_slopes_) add(*beyond_small_, shown);
  for (const models::Sensitivity& sensitivity : simulation.sensitivities) {
    shown.slopes.push_back(
        show(sensitivity.history, chains, breaks_of(sensitivity.history, simulation.history)));
    shown.slopes.back().restitution = sensitivity.restitution;
  }
  if (shown.slopes.size() < wanted.rig.size()) return shown;  // the equations have none
  for (const WantedSlopes::Chain& by : wanted.chain)
    shown.slopes.push_back(chain_slope(simulation.history, chains, by));
  return shown;
}

}  // namespace impactrig::fitting
