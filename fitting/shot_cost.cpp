// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot_cost.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <thread>

namespace impactrig::fitting {
namespace {

// Of full equations: central differences of a simulation accurate to 1e-8 or so: truncation and
// noise balance near this part of the scale.
constexpr double difference_step = 2e-4;

const Shown::Curve& curve_of(const Shown& shown, datasets::Quantity quantity) {
  if (quantity == datasets::Quantity::force) return *shown.force;
  if (quantity == datasets::Quantity::velocity) return *shown.velocity;
  return *shown.displacement;
}

}  // namespace

ShotCost::ShotCost(const RigFile& rig, const ShotModel& model, std::vector<FittedChannel> channels,
                   std::vector<const Variable*> variables)
    : rig_(rig),
      model_(model),
      channels_(std::move(channels)),
      variables_(std::move(variables)) {
  for (const FittedChannel& channel : channels_)
    residuals_ += static_cast<int>(channel.used.size());
  set_num_residuals(residuals_);
  for (std::size_t i = 0; i < variables_.size(); ++i) mutable_parameter_block_sizes()->push_back(1);
}

models::Rig ShotCost::rig_at(const std::vector<double>& values) const {
  models::Rig rig = rig_.rig;
  for (std::size_t i = 0; i < variables_.size(); ++i)
    if (variables_[i]->physics) variables_[i]->physics->of(rig) = values[i];
  return rig;
}

double ShotCost::Measurement::value(const Shown::Curve& curve, double t) const {
  double sum = gain * curve.at(t - shift)[0];
  for (const Term& term : background)
    if (term.amplitude != 0.0) sum += term.amplitude * term.shape.at(t - origin);
  return sum;
}

ShotCost::Measurement ShotCost::measurement(datasets::Quantity quantity,
                                            const std::vector<double>& values) const {
  Measurement m;
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const Variable& v = *variables_[i];
    if (v.role == Variable::Role::touch) {
      m.origin = v.initial;
      m.shift += values[i];
    }
    if (v.quantity != quantity) continue;
    if (v.role == Variable::Role::background) m.background.push_back({v.background, values[i]});
    if (v.role == Variable::Role::gain) m.gain = values[i];
    if (v.role == Variable::Role::delay)
      m.shift += values[i] - v.initial;  // the known part is off the clock already
  }
  return m;
}

std::vector<ShotCost::Prediction> ShotCost::predict(const std::vector<models::Rig>& rigs) const {
  std::vector<Prediction> predictions(rigs.size());
  std::vector<std::exception_ptr> errors(rigs.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < rigs.size(); i = next++) try {
        predictions[i] = std::make_shared<const Shown>(model_.predict(rigs[i]));
      } catch (...) {
        errors[i] = std::current_exception();
      }
  };
  const std::size_t workers =
      std::min<std::size_t>(rigs.size(), std::max(1U, std::thread::hardware_concurrency()));
  std::vector<std::jthread> threads;
  for (std::size_t k = 1; k < workers; ++k) threads.emplace_back(work);
  work();
  threads.clear();
  simulations_ += static_cast<long>(rigs.size());
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  return predictions;
}

/// With its derivatives by the physical variables where they are wanted and small motion has them.
ShotCost::Prediction ShotCost::predict_cached(const std::vector<double>& values,
                                              bool with_slopes) const {
  std::vector<double> key;
  std::vector<models::RigParameter> by;
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    if (!variables_[i]->physics) continue;
    key.push_back(values[i]);
    if (with_slopes && model_.motion() == models::Motion::small)
      by.push_back(variables_[i]->physics->of);
  }
  const auto found = cache_.find(key);
  if (found != cache_.end() && (by.empty() || !found->second->slopes.empty())) return found->second;
  if (cache_.size() > 8) cache_.clear();
  ++simulations_;
  return cache_[key] = std::make_shared<const Shown>(model_.predict(rig_at(values), by));
}

/// Predictions on both sides of every physical variable, in order, and the distance between each
/// pair.
void ShotCost::physics_pairs(const std::vector<double>& values, bool central,
                             std::vector<Prediction>& predictions,
                             std::vector<double>& spans) const {
  const Prediction here = predict_cached(values);
  std::vector<std::size_t> places;
  std::vector<models::Rig> rigs;
  const auto add_side = [&](std::size_t variable, double value) {
    predictions.push_back(here);
    if (value == values[variable]) return;
    std::vector<double> there = values;
    there[variable] = value;
    places.push_back(predictions.size() - 1);
    rigs.push_back(rig_at(there));
  };
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const Variable& v = *variables_[i];
    if (!v.physics) continue;
    const double step = difference_step * v.scale;
    const bool room_ahead = values[i] + step <= v.upper;
    const bool room_behind = values[i] - step >= v.lower;
    const double ahead = room_ahead ? values[i] + step : values[i];
    const double behind = room_behind && (central || !room_ahead) ? values[i] - step : values[i];
    add_side(i, ahead);
    add_side(i, behind);
    spans.push_back(ahead - behind);
  }
  const std::vector<Prediction> fresh = predict(rigs);
  for (std::size_t k = 0; k < fresh.size(); ++k) predictions[places[k]] = fresh[k];
}

void ShotCost::fill_jacobian(const std::vector<double>& values, const Shown& shown,
                             double** jacobians) const {
  std::vector<Prediction> pairs;
  std::vector<double> spans;
  const bool exact = !shown.slopes.empty();
  if (!exact) physics_pairs(values, central_, pairs, spans);
  std::size_t physical = 0;
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const Variable& v = *variables_[i];
    const std::size_t pair = v.physics ? physical++ : 0;
    if (!jacobians[i]) continue;
    double* out = jacobians[i];
    for (const FittedChannel& channel : channels_) {
      const datasets::Quantity quantity = channel.signal->quantity;
      const Measurement m = measurement(quantity, values);
      const double weight = v.scale / (channel.sigma * std::sqrt(channel.correlation));
      const Shown::Curve& curve = curve_of(shown, quantity);
      const bool of_channel = v.quantity == quantity;
      for (const std::size_t k : channel.used) {
        const double t = channel.signal->time(k);
        double derivative = 0.0;  // of what the model shows
        switch (v.role) {
          case Variable::Role::physics:
            derivative = exact ? m.gain * curve_of(shown.slopes[pair], quantity).at(t - m.shift)[0]
                               : m.gain *
                                     (curve_of(*pairs[2 * pair], quantity).at(t - m.shift)[0] -
                                      curve_of(*pairs[2 * pair + 1], quantity).at(t - m.shift)[0]) /
                                     spans[pair];
            break;
          case Variable::Role::touch:
            derivative = -m.gain * curve.at(t - m.shift)[1];
            break;
          case Variable::Role::delay:
            if (of_channel) derivative = -m.gain * curve.at(t - m.shift)[1];
            break;
          case Variable::Role::background:
            if (of_channel) derivative = v.background.at(t - m.origin);
            break;
          case Variable::Role::gain:
            if (of_channel) derivative = curve.at(t - m.shift)[0];
            break;
        }
        *out++ = -weight * derivative;
      }
    }
  }
}

bool ShotCost::Evaluate(const double* const* parameters, double* residuals,
                        double** jacobians) const {
  std::vector<double> values(variables_.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = parameters[i][0] * variables_[i]->scale;
  try {
    const Prediction shown = predict_cached(values, jacobians != nullptr);
    double* out = residuals;
    for (const FittedChannel& channel : channels_) {
      const Measurement m = measurement(channel.signal->quantity, values);
      const Shown::Curve& curve = curve_of(*shown, channel.signal->quantity);
      const double weight = 1.0 / (channel.sigma * std::sqrt(channel.correlation));
      for (const std::size_t k : channel.used)
        *out++ = weight * (channel.signal->values[k] - m.value(curve, channel.signal->time(k)));
    }
    if (jacobians) fill_jacobian(values, *shown, jacobians);
  } catch (const std::exception& error) {
    failure_ = error.what();
    return false;
  }
  return true;
}

std::vector<double> ShotCost::model_values(const FittedChannel& channel,
                                           const std::vector<double>& values) const {
  const Prediction shown = predict_cached(values);
  const Measurement m = measurement(channel.signal->quantity, values);
  const Shown::Curve& curve = curve_of(*shown, channel.signal->quantity);
  std::vector<double> model(channel.signal->values.size());
  for (std::size_t k = 0; k < model.size(); ++k) model[k] = m.value(curve, channel.signal->time(k));
  return model;
}

Eigen::VectorXd ShotCost::change_by(const ShotModel& other,
                                    const std::vector<double>& values) const {
  const Prediction shown = predict_cached(values);
  const Shown changed = other.predict(rig_at(values));
  ++simulations_;
  Eigen::VectorXd change(residuals_);
  Eigen::Index row = 0;
  for (const FittedChannel& channel : channels_) {
    const datasets::Quantity quantity = channel.signal->quantity;
    const Measurement m = measurement(quantity, values);
    const double weight = m.gain / (channel.sigma * std::sqrt(channel.correlation));
    for (const std::size_t k : channel.used) {
      const double t = channel.signal->time(k) - m.shift;
      change[row++] =
          weight * (curve_of(*shown, quantity).at(t)[0] - curve_of(changed, quantity).at(t)[0]);
    }
  }
  return change;
}

Eigen::MatrixXd ShotCost::restitution_gradient(const std::vector<double>& values) const {
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(variables_.size()));
  const Prediction here = predict_cached(values, true);
  std::vector<Prediction> pairs;
  std::vector<double> spans;
  if (here->slopes.empty()) physics_pairs(values, true, pairs, spans);
  std::size_t pair = 0;
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    if (!variables_[i]->physics) continue;
    if (!here->slopes.empty()) {
      const models::Restitution& slope = here->slopes[pair++].restitution;
      gradient.col(static_cast<Eigen::Index>(i)) =
          Eigen::Vector3d(slope.kinematic, slope.kinetic, slope.energetic);
      continue;
    }
    const models::Restitution& a = pairs[2 * pair]->restitution;
    const models::Restitution& b = pairs[2 * pair + 1]->restitution;
    gradient.col(static_cast<Eigen::Index>(i)) =
        Eigen::Vector3d(a.kinematic - b.kinematic, a.kinetic - b.kinetic,
                        a.energetic - b.energetic) /
        spans[pair];
    ++pair;
  }
  return gradient;
}

}  // namespace impactrig::fitting
