// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot_cost.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>

namespace impactrig::fitting {
namespace {

using Role = Variable::Role;

const Shown::Curve& curve_of(const Shown& shown, datasets::Quantity quantity) {
  if (quantity == datasets::Quantity::force) return *shown.force;
  if (quantity == datasets::Quantity::velocity) return *shown.velocity;
  return *shown.displacement;
}

}  // namespace

ShotCost::ShotCost(const RigFile& rig, const ShotModel& model,
                   const std::vector<FittedChannel>& channels,
                   const std::vector<Variable>& variables, const std::vector<std::size_t>& numbers,
                   Loss loss)
    : model_(model),
      channels_(channels),
      numbers_(variables, numbers),
      predictions_(rig, model, numbers_),
      loss_(loss) {
  for (const FittedChannel& channel : channels_)
    residuals_ += static_cast<int>(channel.used.size());
  find_backgrounds();
  set_num_residuals(residuals_);
  mutable_parameter_block_sizes()->assign(numbers_.blocks().size(), 1);
}

void ShotCost::find_backgrounds() {
  backgrounds_.resize(numbers_.slots().size());
  const double origin = numbers_.origin();
  for (const FittedChannel& channel : channels_)
    for (std::size_t s = 0; s < backgrounds_.size(); ++s) {
      const Slot& slot = numbers_.slots()[s];
      if (!is_background_of(slot, channel)) continue;
      for (const std::size_t k : channel.used)
        backgrounds_[s].push_back(slot.variable->background.at(channel.signal->time(k) - origin));
    }
}

bool ShotCost::is_background_of(const Slot& slot, const FittedChannel& channel) const {
  return slot.variable->role == Role::background &&
         slot.variable->quantity == channel.signal->quantity;
}

SamplesAtJumps ShotCost::samples_of(const FittedChannel& channel, const Measurement& measurement,
                                    const Shown& shown) const {
  return {channel, measurement, curve_of(shown, channel.signal->quantity), model_.rough()};
}

models::Rig ShotCost::rig() const {
  return predictions_.rig_at(numbers_.present_values());
}

SensorChains ShotCost::chains() const {
  return numbers_.chains_at(numbers_.present_values(), model_.chains());
}

void ShotCost::differences(const Values& values, const Shown& shown, double* residuals) const {
  double* out = residuals;
  for (const FittedChannel& channel : channels_) {
    const Measurement m = numbers_.measurement(channel.signal->quantity, values);
    const Shown::Curve& curve = curve_of(shown, channel.signal->quantity);
    const SamplesAtJumps samples = samples_of(channel, m, shown);
    const std::span<double> part(out, channel.used.size());
    const std::vector<double> seen = samples.values(curve, channel.used);
    for (std::size_t i = 0; i < part.size(); ++i)
      part[i] = channel.measured[channel.used[i]] - m.gain * seen[i];
    for (std::size_t s = 0; s < backgrounds_.size(); ++s)
      if (is_background_of(numbers_.slots()[s], channel) && values[s] != 0.0)
        for (std::size_t i = 0; i < part.size(); ++i) part[i] -= values[s] * backgrounds_[s][i];
    whiten(channel, part);
    out += part.size();
  }
}

/// Of the weighted differences of one channel by the value of one slot, not yet whitened.
void ShotCost::derivative(std::size_t slot, const SamplesAtJumps& samples, double gain,
                          const Shown::Curve& curve, const Shown* slope,
                          std::span<double> out) const {
  const FittedChannel& channel = samples.channel();
  const datasets::Quantity quantity = channel.signal->quantity;
  const Variable& v = *numbers_.slots()[slot].variable;
  const bool of_channel = v.quantity == quantity;
  std::ranges::fill(out, 0.0);
  const auto fill = [&](double factor, const std::vector<double>& seen) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = factor * seen[i];
  };
  switch (v.role) {
    case Role::physics:
    case Role::chain:
      if (v.role == Role::chain && !of_channel) return;
      return fill(-gain, samples.values(curve_of(*slope, quantity), channel.used));
    case Role::delay:
    case Role::touch:
      if (v.role == Role::delay && !of_channel) return;
      return fill(gain, samples.slopes(curve, channel.used));
    case Role::background:
      if (!of_channel) return;
      return fill(-1.0, backgrounds_[slot]);
    case Role::gain:
      if (!of_channel) return;
      return fill(-1.0, samples.values(curve, channel.used));
  }
}

Eigen::MatrixXd ShotCost::jacobian_at(const Values& values, const Shown& shown) const {
  const std::vector<Slot>& slots = numbers_.slots();
  Eigen::MatrixXd jacobian =
      Eigen::MatrixXd::Zero(residuals_, static_cast<Eigen::Index>(numbers_.blocks().size()));
  std::vector<Shown> held;
  std::vector<const Shown*> slopes(slots.size(), nullptr);
  if (std::ranges::any_of(slots, &Slot::needs_simulation))
    slopes = predictions_.slopes_at(values, shown, held);
  Eigen::Index row = 0;
  Eigen::VectorXd column;
  for (const FittedChannel& channel : channels_) {
    const Measurement m = numbers_.measurement(channel.signal->quantity, values);
    const Shown::Curve& curve = curve_of(shown, channel.signal->quantity);
    const SamplesAtJumps samples = samples_of(channel, m, shown);
    column.resize(static_cast<Eigen::Index>(channel.used.size()));
    const std::span<double> out(column.data(), channel.used.size());
    for (std::size_t s = 0; s < slots.size(); ++s) {
      const Variable& v = *slots[s].variable;
      if (v.quantity != datasets::Quantity::unknown && v.quantity != channel.signal->quantity)
        continue;
      derivative(s, samples, m.gain, curve, slopes[s], out);
      whiten(channel, out);
      jacobian.block(row, static_cast<Eigen::Index>(slots[s].block), column.size(), 1) +=
          slots[s].factor * column;
    }
    row += column.size();
  }
  return jacobian;
}

void ShotCost::evaluate(const Values& values, Eigen::VectorXd& residuals,
                        Eigen::MatrixXd* jacobian) const {
  const ShotPredictions::Prediction shown =
      predictions_.predict(values, jacobian != nullptr || slopes_ahead_);
  residuals.resize(residuals_);
  differences(values, *shown, residuals.data());
  if (jacobian) *jacobian = jacobian_at(values, *shown);
}

void ShotCost::linearise(Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const {
  evaluate(numbers_.present_values(), residuals, jacobian);
}

bool ShotCost::Evaluate(const double* const* parameters, double* residuals,
                        double** jacobians) const {
  try {
    Eigen::VectorXd differences;
    Eigen::MatrixXd slopes;
    const Values values = numbers_.values_of(parameters);
    if (const Slot* outside = numbers_.beyond_bounds(values)) {
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
    for (std::size_t b = 0; b < numbers_.blocks().size(); ++b) {
      const Variable& v = numbers_.unknown(b);
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
  const Values values = numbers_.present_values();
  const ShotPredictions::Prediction shown = predictions_.predict(values, false);
  const datasets::Quantity quantity = channel.signal->quantity;
  const Measurement m = numbers_.measurement(quantity, values);
  const Shown::Curve& curve = curve_of(*shown, quantity);
  const double origin = numbers_.origin();
  const SamplesAtJumps samples = samples_of(channel, m, *shown);
  std::vector<std::size_t> all(channel.signal->values.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> model = samples.values(curve, all);
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double t = channel.signal->time(k);
    model[k] *= m.gain;
    for (std::size_t s = 0; s < numbers_.slots().size(); ++s)
      if (is_background_of(numbers_.slots()[s], channel) && values[s] != 0.0)
        model[k] += values[s] * numbers_.slots()[s].variable->background.at(t - origin);
  }
  return model;
}

ShotCost::Change ShotCost::change(const ShotModel& one, const ShotModel& other) const {
  const Values values = numbers_.present_values();
  const ShotPredictions::Prediction before =
      &one == &model_ ? predictions_.predict(values, false) : predictions_.predict_by(one, values);
  const ShotPredictions::Prediction after = predictions_.predict_by(other, values);
  Eigen::VectorXd of_one(residuals_);
  Change change{.differences = Eigen::VectorXd(residuals_), .restitution = {}};
  differences(values, *before, of_one.data());
  differences(values, *after, change.differences.data());
  change.differences -= of_one;
  for (const auto which : {&models::Restitution::kinematic, &models::Restitution::kinetic,
                           &models::Restitution::energetic})
    change.restitution.*which = after->restitution.*which - before->restitution.*which;
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
  Eigen::MatrixXd gradient =
      Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(numbers_.blocks().size()));
  const Values values = numbers_.present_values();
  const ShotPredictions::Prediction here = predictions_.predict(values, true);
  std::vector<Shown> held;
  const std::vector<const Shown*> slopes = predictions_.slopes_at(values, *here, held);
  for (std::size_t s = 0; s < numbers_.slots().size(); ++s) {
    if (!numbers_.slots()[s].variable->physics) continue;
    const models::Restitution& slope = slopes[s]->restitution;
    gradient.col(static_cast<Eigen::Index>(numbers_.slots()[s].block)) +=
        numbers_.slots()[s].factor *
        Eigen::Vector3d(slope.kinematic, slope.kinetic, slope.energetic);
  }
  return gradient;
}

}  // namespace impactrig::fitting
