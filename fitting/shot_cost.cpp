// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot_cost.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <span>

#include "fitting/all_cores.hpp"

namespace impactrig::fitting {
namespace {

using Role = Variable::Role;

// Of equations that have no slopes: central differences of a simulation accurate to 1e-8 or so;
// truncation and noise balance near this part of the scale.
constexpr double difference_step = 2e-4;
// What friction does is a straight line but for where the hinge turns round, and little: a step
// that is seen beside the rounding of two simulations.
constexpr double friction_step = 0.05;
constexpr std::size_t predictions_kept = 8;
// How far from a jump a sample may show either side of it, in samples; while a search is far off.
constexpr double beside_jump = 1.0, rough_beside_jump = 8.0;

const Shown::Curve& curve_of(const Shown& shown, datasets::Quantity quantity) {
  if (quantity == datasets::Quantity::force) return *shown.force;
  if (quantity == datasets::Quantity::velocity) return *shown.velocity;
  return *shown.displacement;
}

bool needs_simulation(const Variable& v) {
  return v.role == Role::physics || v.role == Role::chain;
}

/// (a - b) / span, all over.
void divide_difference(std::optional<Shown::Curve>& a, const std::optional<Shown::Curve>& b,
                       double span) {
  if (a) *a = difference_quotient(*a, *b, span);
}

Shown difference(const Shown& above, const Shown& below, double span) {
  Shown result = above;
  divide_difference(result.force, below.force, span);
  divide_difference(result.velocity, below.velocity, span);
  divide_difference(result.displacement, below.displacement, span);
  const models::Restitution &a = above.restitution, &b = below.restitution;
  result.restitution = {};
  result.restitution.kinematic = (a.kinematic - b.kinematic) / span;
  result.restitution.kinetic = (a.kinetic - b.kinetic) / span;
  result.restitution.energetic = (a.energetic - b.energetic) / span;
  return result;
}

}  // namespace

ShotCost::ShotCost(const RigFile& rig, const ShotModel& model,
                   const std::vector<FittedChannel>& channels,
                   const std::vector<Variable>& variables, const std::vector<std::size_t>& numbers,
                   Loss loss)
    : rig_(rig),
      model_(model),
      channels_(channels),
      variables_(variables),
      loss_(loss) {
  for (const std::size_t number : numbers) {
    const Variable& v = variables_[number];
    const std::size_t unknown = v.tie ? v.tie->to : number;
    auto block = std::ranges::find(blocks_, unknown);
    if (block == blocks_.end()) block = blocks_.insert(blocks_.end(), unknown);
    slots_.push_back({&v,
                      static_cast<std::size_t>(block - blocks_.begin()),
                      v.tie ? v.tie->factor : 1.0,
                      v.tie ? v.tie->offset : 0.0,
                      {}});
  }
  double origin = 0.0;  // of the background's time: the impact as found [s]
  for (const Slot& slot : slots_)
    if (slot.variable->role == Role::touch) origin = slot.variable->initial;
  for (const FittedChannel& channel : channels_) {
    residuals_ += static_cast<int>(channel.used.size());
    for (Slot& slot : slots_)
      if (slot.variable->role == Role::background &&
          slot.variable->quantity == channel.signal->quantity)
        for (const std::size_t k : channel.used)
          slot.background.push_back(slot.variable->background.at(channel.signal->time(k) - origin));
  }
  set_num_residuals(residuals_);
  mutable_parameter_block_sizes()->assign(blocks_.size(), 1);
}

ShotCost::Values ShotCost::values_of(const double* const* parameters) const {
  Values values;
  for (const Slot& slot : slots_)
    values.push_back(slot.offset + slot.factor * variables_[blocks_[slot.block]].value_at(
                                                     parameters[slot.block][0]));
  return values;
}

ShotCost::Values ShotCost::present_values() const {
  Values values;
  for (const Slot& slot : slots_)
    values.push_back(slot.offset + slot.factor * variables_[blocks_[slot.block]].value);
  return values;
}

/// A number that a simulation needs, where a search without bounds took it too far; a rounding is
/// not.
const ShotCost::Slot* ShotCost::beyond_bounds(const Values& values) const {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const Variable& v = *slots_[i].variable;
    const double rounding = 1e-12 * v.scale;
    if (needs_simulation(v) && !v.tie &&
        !(values[i] >= v.lower - rounding && values[i] <= v.upper + rounding))
      return &slots_[i];
  }
  return nullptr;
}

models::Rig ShotCost::rig_at(const Values& values) const {
  models::Rig rig = rig_.rig;
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (slots_[i].variable->physics) slots_[i].variable->physics->of(rig) = values[i];
  return rig;
}

models::Rig ShotCost::rig() const {
  return rig_at(present_values());
}

SensorChains ShotCost::chains_at(const Values& values) const {
  SensorChains chains = model_.chains();
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (const Variable& v = *slots_[i].variable; v.chain) {
      auto& sensor = chains.of(v.quantity);
      if (!sensor) sensor.emplace().quantity = v.quantity;
      v.chain->of(*sensor) = values[i];
    }
  return chains;
}

/// In the order of the slots of each kind.
WantedSlopes ShotCost::wanted_slopes() const {
  WantedSlopes wanted;
  for (const Slot& slot : slots_) {
    if (slot.variable->physics) wanted.rig.push_back(slot.variable->physics->of);
    if (slot.variable->chain)
      wanted.chain.push_back({slot.variable->quantity, slot.variable->chain});
  }
  return wanted;
}

ShotCost::Measurement ShotCost::measurement(datasets::Quantity quantity,
                                            const Values& values) const {
  Measurement m;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const Variable& v = *slots_[i].variable;
    if (v.role == Role::touch) m.shift += values[i];
    if (v.quantity != quantity) continue;
    if (v.role == Role::gain) m.gain = values[i];
    if (v.role == Role::delay)
      m.shift += values[i] - v.initial;  // the known part is off the clock already
  }
  return m;
}

/// With its slopes where they are wanted and the equations have them.
ShotCost::Prediction ShotCost::predict(const Values& values, bool with_slopes) const {
  Values key;
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (needs_simulation(*slots_[i].variable)) key.push_back(values[i]);
  const bool of_small_motion = small_slopes_ && model_.motion() == models::Motion::full;
  const bool slopes =
      with_slopes && !of_small_motion && without_slopes_ != model_.motion() && !key.empty();
  const auto found = cache_.find(key);
  if (found != cache_.end() && (!slopes || !found->second->slopes.empty())) return found->second;
  if (cache_.size() > predictions_kept) cache_.clear();
  ++simulations_;
  const Prediction shown = std::make_shared<const Shown>(
      model_.predict(rig_at(values), chains_at(values), slopes ? wanted_slopes() : WantedSlopes{}));
  if (slopes && shown->slopes.empty()) without_slopes_ = model_.motion();
  return cache_[key] = shown;
}

std::vector<ShotCost::Prediction> ShotCost::predict_all(const std::vector<Values>& places) const {
  std::vector<Prediction> predictions(places.size());
  run_on_all_cores(places.size(), [&](std::size_t i, std::size_t) {
    predictions[i] =
        std::make_shared<const Shown>(model_.predict(rig_at(places[i]), chains_at(places[i])));
  });
  simulations_ += static_cast<long>(places.size());
  return predictions;
}

/// Differences of simulations to both sides of every physical slot, then every chain slot, as far
/// as its bounds leave room.
std::vector<Shown> ShotCost::physics_differences(const Values& values) const {
  std::vector<Values> places;
  std::vector<double> spans;
  for (const bool chain : {false, true})
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      const Variable& v = *slots_[i].variable;
      if (chain ? v.chain == nullptr : v.physics == nullptr) continue;
      const bool friction = v.physics && v.physics->of_full_motion_only;
      const double step = (friction ? friction_step : difference_step) * v.scale;
      const bool ahead = values[i] + step <= v.upper || v.tie;
      const bool behind = values[i] - step >= v.lower || v.tie;
      for (const double side : {ahead ? step : 0.0, behind ? -step : 0.0}) {
        places.push_back(values);
        places.back()[i] += side;
      }
      spans.push_back((ahead ? step : 0.0) + (behind ? step : 0.0));
    }
  const std::vector<Prediction> shown = predict_all(places);
  std::vector<Shown> slopes;
  for (std::size_t k = 0; k < spans.size(); ++k)
    slopes.push_back(difference(*shown[2 * k], *shown[2 * k + 1], spans[k]));
  return slopes;
}

/// Of every slot that needs a simulation, in the order of the slots; `held` keeps those that were
/// made here.
std::vector<const Shown*> ShotCost::slopes_at(const Values& values, const Shown& shown,
                                              std::vector<Shown>& held) const {
  const std::vector<Shown>* slopes = &shown.slopes;
  if (slopes->empty() && small_slopes_) {
    ++simulations_;
    held =
        model_.in_small_motion().predict(rig_at(values), chains_at(values), wanted_slopes()).slopes;
    slopes = &held;
  }
  if (slopes->empty()) {
    held = physics_differences(values);
    slopes = &held;
  }
  std::size_t physics = 0;
  for (const Slot& slot : slots_) physics += slot.variable->physics ? 1 : 0;
  std::vector<const Shown*> result(slots_.size(), nullptr);
  std::size_t next = 0, next_chain = physics;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].variable->physics) result[i] = &slopes->at(next++);
    if (slots_[i].variable->chain) result[i] = &slopes->at(next_chain++);
  }
  return result;
}

void ShotCost::whiten(const FittedChannel& channel, std::span<double> of_used) const {
  const NoiseModel noise = channel.one_by_one ? channel.noise.as_if_white() : channel.noise;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= channel.used.size(); ++i)
    if (i == channel.used.size() || channel.used[i] != channel.used[i - 1] + channel.every) {
      noise.whiten(of_used.subspan(begin, i - begin));
      begin = i;
    }
}

/// Where the force jumps, the cost would too when a time moves a sample from one side to the other,
/// and the search would end there. A sample so near that the time may be that wrong shows the side
/// that is nearer to what was measured.
ShotCost::Look ShotCost::look(const FittedChannel& channel, const Measurement& m,
                              const Shown::Curve& curve) const {
  Look look{.channel = channel, .shift = m.shift};
  const double near = (model_.rough() ? rough_beside_jump : beside_jump) * channel.signal->interval;
  for (std::size_t number = 0; number < curve.jumps.size(); ++number) {
    const double time = curve.jumps[number].time;
    const double first = (time + m.shift - near - channel.signal->start) / channel.signal->interval;
    const auto end = static_cast<double>(channel.signal->values.size());
    for (double k = std::max(0.0, std::ceil(first)); k < end; ++k) {
      const auto sample = static_cast<std::size_t>(k);
      const double t = channel.signal->time(sample) - m.shift;
      if (t > time + near) break;
      const auto off = [&](std::size_t piece) {
        return std::abs(channel.measured[sample] - m.gain * curve.at(t, piece)[0]);
      };
      const std::size_t here = curve.piece_at(t);
      if (here != number && here != number + 1) continue;
      const std::size_t other = here == number ? number + 1 : number;
      if (off(other) < off(here)) look.elsewhere.push_back({sample, other});
    }
  }
  return look;
}

std::array<double, 2> ShotCost::Look::at(const Shown::Curve& curve, std::size_t sample) const {
  const double t = channel.signal->time(sample) - shift;
  for (const auto& [number, piece] : elsewhere)
    if (number == sample) return curve.at(t, piece);
  return curve.at(t);
}

void ShotCost::differences(const Values& values, const Shown& shown, double* residuals) const {
  double* out = residuals;
  for (const FittedChannel& channel : channels_) {
    const Measurement m = measurement(channel.signal->quantity, values);
    const Shown::Curve& curve = curve_of(shown, channel.signal->quantity);
    const Look look = this->look(channel, m, curve);
    const std::span<double> part(out, channel.used.size());
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::size_t k = channel.used[i];
      part[i] = channel.measured[k] - m.gain * look.at(curve, k)[0];
    }
    for (std::size_t s = 0; s < slots_.size(); ++s)
      if (slots_[s].variable->role == Role::background &&
          slots_[s].variable->quantity == channel.signal->quantity && values[s] != 0.0)
        for (std::size_t i = 0; i < part.size(); ++i)
          part[i] -= values[s] * slots_[s].background[i];
    whiten(channel, part);
    out += part.size();
  }
}

/// Of the weighted differences of one channel by the value of one slot, not yet whitened.
void ShotCost::derivative(const Slot& slot, const Look& look, double gain,
                          const Shown::Curve& curve, const Shown* slope,
                          std::span<double> out) const {
  const FittedChannel& channel = look.channel;
  const datasets::Quantity quantity = channel.signal->quantity;
  const Variable& v = *slot.variable;
  const bool of_channel = v.quantity == quantity;
  std::ranges::fill(out, 0.0);
  const auto seen = [&](const Shown::Curve& of, std::size_t i) {
    return look.at(of, channel.used[i]);
  };
  switch (v.role) {
    case Role::physics:
    case Role::chain: {
      if (v.role == Role::chain && !of_channel) return;
      const Shown::Curve& slopes = curve_of(*slope, quantity);
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = -gain * seen(slopes, i)[0];
      return;
    }
    case Role::delay:
    case Role::touch:
      if (v.role == Role::delay && !of_channel) return;
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = gain * seen(curve, i)[1];
      return;
    case Role::background:
      if (!of_channel) return;
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = -slot.background[i];
      return;
    case Role::gain:
      if (!of_channel) return;
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = -seen(curve, i)[0];
      return;
  }
}

void ShotCost::evaluate(const Values& values, Eigen::VectorXd& residuals,
                        Eigen::MatrixXd* jacobian) const {
  const Prediction shown = predict(values, jacobian != nullptr || slopes_ahead_);
  residuals.resize(residuals_);
  differences(values, *shown, residuals.data());
  if (!jacobian) return;
  jacobian->setZero(residuals_, static_cast<Eigen::Index>(blocks_.size()));
  std::vector<Shown> held;
  std::vector<const Shown*> slopes(slots_.size(), nullptr);
  if (std::ranges::any_of(slots_, [](const Slot& s) { return needs_simulation(*s.variable); }))
    slopes = slopes_at(values, *shown, held);
  Eigen::Index row = 0;
  Eigen::VectorXd column;
  for (const FittedChannel& channel : channels_) {
    const Measurement m = measurement(channel.signal->quantity, values);
    const Shown::Curve& curve = curve_of(*shown, channel.signal->quantity);
    const Look look = this->look(channel, m, curve);
    column.resize(static_cast<Eigen::Index>(channel.used.size()));
    const std::span<double> out(column.data(), channel.used.size());
    for (std::size_t s = 0; s < slots_.size(); ++s) {
      const Variable& v = *slots_[s].variable;
      if (v.quantity != datasets::Quantity::unknown && v.quantity != channel.signal->quantity)
        continue;
      derivative(slots_[s], look, m.gain, curve, slopes[s], out);
      whiten(channel, out);
      jacobian->block(row, static_cast<Eigen::Index>(slots_[s].block), column.size(), 1) +=
          slots_[s].factor * column;
    }
    row += column.size();
  }
}

void ShotCost::linearise(Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const {
  evaluate(present_values(), residuals, jacobian);
}

bool ShotCost::Evaluate(const double* const* parameters, double* residuals,
                        double** jacobians) const {
  try {
    Eigen::VectorXd differences;
    Eigen::MatrixXd slopes;
    const Values values = values_of(parameters);
    if (const Slot* outside = beyond_bounds(values)) {
      failure_ = outside->variable->name + " left its bounds";
      return false;
    }
    evaluate(values, differences, jacobians ? &slopes : nullptr);
    for (Eigen::Index i = 0; i < differences.size(); ++i) {
      const LossResidual r = loss_residual(loss_, differences[i]);
      residuals[i] = r.value;
      if (jacobians && loss_ != Loss::squares) slopes.row(i) *= r.slope;
    }
    if (!jacobians) return true;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Variable& v = variables_[blocks_[b]];
      if (jacobians[b])
        Eigen::Map<Eigen::VectorXd>(jacobians[b], residuals_) =
            v.slope_at(v.value_at(parameters[b][0])) * slopes.col(static_cast<Eigen::Index>(b));
    }
  } catch (const std::exception& error) {
    failure_ = error.what();
    return false;
  }
  return true;
}

std::vector<double> ShotCost::model_values(const FittedChannel& channel) const {
  const Values values = present_values();
  const Prediction shown = predict(values, false);
  const datasets::Quantity quantity = channel.signal->quantity;
  const Measurement m = measurement(quantity, values);
  const Shown::Curve& curve = curve_of(*shown, quantity);
  double origin = 0.0;
  for (const Slot& slot : slots_)
    if (slot.variable->role == Role::touch) origin = slot.variable->initial;
  const Look look = this->look(channel, m, curve);
  std::vector<double> model(channel.signal->values.size());
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double t = channel.signal->time(k);
    model[k] = m.gain * look.at(curve, k)[0];
    for (std::size_t s = 0; s < slots_.size(); ++s)
      if (slots_[s].variable->role == Role::background &&
          slots_[s].variable->quantity == quantity && values[s] != 0.0)
        model[k] += values[s] * slots_[s].variable->background.at(t - origin);
  }
  return model;
}

ShotCost::Change ShotCost::change(const ShotModel& one, const ShotModel& other) const {
  const Values values = present_values();
  const Prediction before =
      &one == &model_
          ? predict(values, false)
          : std::make_shared<const Shown>(one.predict(rig_at(values), chains_at(values)));
  const Shown after = other.predict(rig_at(values), chains_at(values));
  simulations_ += &one == &model_ ? 1 : 2;
  Eigen::VectorXd of_one(residuals_);
  Change change{.differences = Eigen::VectorXd(residuals_), .restitution = {}};
  differences(values, *before, of_one.data());
  differences(values, after, change.differences.data());
  change.differences -= of_one;
  for (const auto which : {&models::Restitution::kinematic, &models::Restitution::kinetic,
                           &models::Restitution::energetic})
    change.restitution.*which = after.restitution.*which - before->restitution.*which;
  return change;
}

double ShotCost::signal_size() const {
  double squares = 0.0;
  for (const FittedChannel& channel : channels_) {
    const std::vector<double> model = model_values(channel);
    std::vector<double> used;
    for (const std::size_t k : channel.used) used.push_back(model[k]);
    whiten(channel, used);
    for (const double value : used) squares += value * value;
  }
  return std::sqrt(squares);
}

Eigen::MatrixXd ShotCost::restitution_gradient() const {
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(blocks_.size()));
  const Values values = present_values();
  const Prediction here = predict(values, true);
  std::vector<Shown> held;
  const std::vector<const Shown*> slopes = slopes_at(values, *here, held);
  for (std::size_t s = 0; s < slots_.size(); ++s) {
    if (!slots_[s].variable->physics) continue;
    const models::Restitution& slope = slopes[s]->restitution;
    gradient.col(static_cast<Eigen::Index>(slots_[s].block)) +=
        slots_[s].factor * Eigen::Vector3d(slope.kinematic, slope.kinetic, slope.energetic);
  }
  return gradient;
}

}  // namespace impactrig::fitting
