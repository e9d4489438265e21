// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot_predictions.hpp"

#include "fitting/all_cores.hpp"

namespace impactrig::fitting {
namespace {

// Of equations that have no slopes: central differences of a simulation accurate to 1e-8 or so;
// truncation and noise balance near this part of the scale.
constexpr double difference_step = 2e-4;
// What friction does is a straight line but for where the hinge turns round, and little: a step
// that is seen beside the rounding of two simulations.
constexpr double friction_step = 0.05;
constexpr std::size_t predictions_kept = 8;

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

Shown ShotPredictions::simulate(const ShotModel& model, const Values& values,
                                const WantedSlopes& wanted) const {
  return model.predict(rig_at(values), numbers_.chains_at(values, model_.chains()), wanted);
}

ShotPredictions::Prediction ShotPredictions::predict(const Values& values, bool with_slopes) const {
  Values key;
  for (std::size_t i = 0; i < numbers_.slots().size(); ++i)
    if (numbers_.slots()[i].needs_simulation()) key.push_back(values[i]);
  const bool of_small_motion = small_slopes_ && model_.motion() == models::Motion::full;
  const bool slopes =
      with_slopes && !of_small_motion && without_slopes_ != model_.motion() && !key.empty();
  const auto found = cache_.find(key);
  if (found != cache_.end() && (!slopes || !found->second->slopes.empty())) return found->second;
  if (cache_.size() > predictions_kept) cache_.clear();
  ++simulations_;
  const Prediction shown = std::make_shared<const Shown>(
      simulate(model_, values, slopes ? numbers_.wanted_slopes() : WantedSlopes{}));
  if (slopes && shown->slopes.empty()) without_slopes_ = model_.motion();
  return cache_[key] = shown;
}

ShotPredictions::Prediction ShotPredictions::predict_by(const ShotModel& model,
                                                        const Values& values) const {
  ++simulations_;
  return std::make_shared<const Shown>(simulate(model, values));
}

std::vector<ShotPredictions::Prediction> ShotPredictions::predict_all(
    const std::vector<Values>& places) const {
  std::vector<Prediction> predictions(places.size());
  run_on_all_cores(places.size(), [&](std::size_t i, std::size_t) {
    predictions[i] = std::make_shared<const Shown>(simulate(model_, places[i]));
  });
  simulations_ += static_cast<long>(places.size());
  return predictions;
}

/// Differences of simulations to both sides of every physical slot, then every chain slot, as far
/// as its bounds leave room.
std::vector<Shown> ShotPredictions::differences(const Values& values) const {
  std::vector<Values> places;
  std::vector<double> spans;
  for (const bool chain : {false, true})
    for (std::size_t i = 0; i < numbers_.slots().size(); ++i) {
      const Variable& v = *numbers_.slots()[i].variable;
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

std::vector<const Shown*> ShotPredictions::slopes_at(const Values& values, const Shown& shown,
                                                     std::vector<Shown>& held) const {
  const std::vector<Shown>* slopes = &shown.slopes;
  if (slopes->empty() && small_slopes_) {
    ++simulations_;
    held = simulate(model_.in_small_motion(), values, numbers_.wanted_slopes()).slopes;
    slopes = &held;
  }
  if (slopes->empty()) {
    held = differences(values);
    slopes = &held;
  }
  std::size_t physics = 0;
  for (const ShotNumbers::Slot& slot : numbers_.slots()) physics += slot.variable->physics ? 1 : 0;
  std::vector<const Shown*> result(numbers_.slots().size(), nullptr);
  std::size_t next = 0, next_chain = physics;
  for (std::size_t i = 0; i < numbers_.slots().size(); ++i) {
    if (numbers_.slots()[i].variable->physics) result[i] = &slopes->at(next++);
    if (numbers_.slots()[i].variable->chain) result[i] = &slopes->at(next_chain++);
  }
  return result;
}

}  // namespace impactrig::fitting
