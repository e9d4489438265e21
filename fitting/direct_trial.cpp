// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/direct_trial.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace impactrig::fitting {

using datasets::ImpactSignal;

namespace {

constexpr double around = 3.0;         // contact durations read before and after the contact
constexpr double guard_part = 0.05;    // of the contact: kept free before touch
constexpr double smooth_part = 0.02;   // of the contact: half a mean
constexpr double derived_part = 0.01;  // of the contact: half a parabola for a speed

bool sound(const ImpactSignal& signal, std::size_t i) {
  return (signal.valid.empty() || signal.valid[i] != 0) && std::isfinite(signal.values[i]);
}

bool lost_between(const ImpactSignal& signal, double from, double to) {
  for (std::size_t i = 0; i < signal.values.size(); ++i)
    if (signal.time(i) >= from && signal.time(i) <= to && !sound(signal, i)) return true;
  return false;
}

/// Slopes of parabolas through 2 m + 1 samples.
std::vector<double> slopes(const std::vector<double>& y, double interval, std::ptrdiff_t m) {
  const auto n = static_cast<std::ptrdiff_t>(y.size());
  const auto half = static_cast<double>(m);
  const double squares = half * (half + 1.0) * (2.0 * half + 1.0) / 3.0;
  std::vector<double> slope(y.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t centre = std::clamp(i, std::min(m, n / 2), std::max(n / 2, n - 1 - m));
    double sum = 0.0;
    for (std::ptrdiff_t j = -m; j <= m; ++j)
      sum += static_cast<double>(j) *
             y[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(centre + j, 0, n - 1))];
    slope[static_cast<std::size_t>(i)] = sum / (squares * interval);
  }
  return slope;
}

/// At a place between samples, by the cubic of Catmull and Rom.
double between(const std::vector<double>& y, double place) {
  const auto last = static_cast<double>(y.size() - 1);
  place = std::clamp(place, 0.0, last);
  const auto i = std::min(static_cast<std::size_t>(place), y.size() - 2);
  const double x = place - static_cast<double>(i);
  const double b = y[i], c = y[i + 1];
  const double a = i > 0 ? y[i - 1] : 2.0 * b - c;
  const double d = i + 2 < y.size() ? y[i + 2] : 2.0 * c - b;
  return b +
         0.5 * x * (c - a + x * (2.0 * a - 5.0 * b + 4.0 * c - d + x * (3.0 * (b - c) + d - a)));
}

}  // namespace

DirectReading::DirectReading(const datasets::Impact& impact, const RigFile& rig) : impact_(impact) {
  if (!impact.force || (!impact.velocity && !impact.displacement))
    throw std::invalid_argument("a direct reading needs a force and a motion");
  if (rig.force) force_sensor_ = *rig.force;
  const auto& sensor = impact.velocity ? rig.velocity : rig.displacement;
  if (sensor) motion_sensor_ = *sensor;
  motion_sensor_.low_cut.reset();  // refused by the caller: its integral has no known start
  force_window_ = window_of(*impact.force);
  motion_window_ = window_of(motion());
  force_ = sound_samples(*impact.force, force_window_);
  motion_ = sound_samples(motion(), motion_window_);
  quiet_end_ = impact.start -
               std::max(guard_part * (impact.end - impact.start), 3.0 * impact.force->interval);
  take_baseline();
  plain_force_ = force_of({});
  plain_speed_ = speed_of({});
  smooth_speed_ = plain_speed_;
  const double half = smooth_part * (impact.end - impact.start) / motion().interval;
  smooth_speed_.values = running_means(plain_speed_.values, static_cast<std::size_t>(half));
}

const ImpactSignal& DirectReading::motion() const {
  return impact_.velocity ? *impact_.velocity : *impact_.displacement;
}

DirectReading::Window DirectReading::window_of(const ImpactSignal& signal) const {
  const double reach = around * (impact_.end - impact_.start);
  const auto last = static_cast<double>(signal.values.size());
  const auto index = [&](double t) {
    return static_cast<std::size_t>(std::clamp((t - signal.start) / signal.interval, 0.0, last));
  };
  return {index(impact_.start - reach), index(impact_.end + 1.3 * reach)};
}

/// Of the window, which shrinks to between its first and last sound sample; gaps are bridged by
/// lines, so that filters can run over them.
std::vector<double> DirectReading::sound_samples(const ImpactSignal& signal, Window& window) const {
  while (window.first < window.last && !sound(signal, window.first)) ++window.first;
  while (window.last > window.first && !sound(signal, window.last - 1)) --window.last;
  std::vector<double> values(signal.values.begin() + static_cast<std::ptrdiff_t>(window.first),
                             signal.values.begin() + static_cast<std::ptrdiff_t>(window.last));
  std::size_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!sound(signal, window.first + i)) continue;
    for (std::size_t k = before + 1; k < i; ++k)
      values[k] = values[before] + (values[i] - values[before]) * static_cast<double>(k - before) /
                                       static_cast<double>(i - before);
    before = i;
  }
  return values;
}

/// The trend of the force before touch, continued to the middle of the contact: what the mean
/// leaves open, beyond what noise alone would show.
void DirectReading::take_baseline() {
  const ImpactSignal& signal = *impact_.force;
  double n = 0.0, sum_t = 0.0, sum_tt = 0.0, sum_y = 0.0, sum_ty = 0.0;
  const double origin = impact_.start;
  for (std::size_t i = 0; i < force_.size(); ++i) {
    const double t = signal.time(force_window_.first + i);
    if (t > quiet_end_) break;
    n += 1.0;
    sum_t += t - origin;
    sum_tt += (t - origin) * (t - origin);
    sum_y += force_[i];
    sum_ty += (t - origin) * force_[i];
  }
  if (n < 3.0) return;
  const double spread = sum_tt - sum_t * sum_t / n;
  const double slope = (sum_ty - sum_t * sum_y / n) / spread;
  const double variance = signal.noise * signal.noise * signal.noise_correlation / spread;
  const double way = 0.5 * (impact_.end - impact_.start) - sum_t / n;
  wander_ = std::sqrt(std::max(0.0, slope * slope - variance)) * way;
}

bool DirectReading::force_lost(double from, double to) const {
  return lost_between(*impact_.force, from, to);
}

bool DirectReading::motion_lost(double from, double to) const {
  return lost_between(motion(), from, to);
}

double DirectReading::level_before(const std::vector<double>& force) const {
  double level = 0.0, count = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (impact_.force->time(force_window_.first + i) > quiet_end_) break;
    level += force[i];
    count += 1.0;
  }
  return count > 0.0 ? level / count : 0.0;
}

Undone DirectReading::force_of(const Trial& trial) const {
  std::vector<double> force = force_;
  for (std::size_t i = 0; trial.force_noise && i < force.size(); ++i)
    force[i] += (*trial.force_noise)[i];
  const double level = level_before(force);
  for (double& value : force) value = trial.force_gain * (value - level) + trial.force_offset;
  return undo_chain(force_sensor_, force, impact_.force->interval, trial.chain);
}

/// As a speed.
Undone DirectReading::speed_of(const Trial& trial) const {
  std::vector<double> shown = motion_;
  for (std::size_t i = 0; trial.motion_noise && i < shown.size(); ++i)
    shown[i] += (*trial.motion_noise)[i];
  const double interval = motion().interval;
  Undone undone = undo_chain(motion_sensor_, shown, interval, trial.chain);
  if (!impact_.velocity) {
    const double half = derived_part * (impact_.end - impact_.start) / interval;
    undone.values = slopes(undone.values, interval, std::max<std::ptrdiff_t>(1, std::lround(half)));
  }
  for (double& value : undone.values) value = trial.motion_gain * value + trial.speed_offset;
  return undone;
}

ContactRecord DirectReading::record(const Trial& trial) const {
  const bool same_force = trial.force_noise == nullptr && trial.force_gain == 1.0 &&
                          trial.force_offset == 0.0 && trial.chain == ChainUndo::resolved;
  const bool same_speed = trial.motion_noise == nullptr && trial.motion_gain == 1.0 &&
                          trial.speed_offset == 0.0 && trial.chain == ChainUndo::resolved;
  const Undone force = same_force ? plain_force_ : force_of(trial);
  const Undone speed = trial.smooth_speed ? smooth_speed_
                       : same_speed       ? plain_speed_
                                          : speed_of(trial);
  const ImpactSignal &of_force = *impact_.force, &of_motion = motion();
  ContactRecord record;
  record.interval = of_force.interval;
  record.force.reserve(force.values.size());
  record.velocity.reserve(force.values.size());
  const double speed_start = of_motion.time(motion_window_.first) - speed.delay + trial.later;
  const double force_start = of_force.time(force_window_.first) - force.delay;
  const auto last = static_cast<double>(speed.values.size()) - 1.0;
  for (std::size_t i = 0; i < force.values.size(); ++i) {
    const double t = force_start + of_force.interval * static_cast<double>(i);
    const double place = (t - speed_start) / of_motion.interval;
    if (place < 0.0 || place > last) continue;  // only where both were recorded
    if (record.force.empty()) record.start = t;
    record.force.push_back(force.values[i]);
    record.velocity.push_back(between(speed.values, place));
  }
  return record;
}

ContactPhases DirectReading::phases(const Trial& trial) const {
  return contact_phases(record(trial), impact_.start, impact_.end, trial.touch, trial.separation);
}

NoiseSource::NoiseSource(double sigma, double correlation, std::uint64_t seed)
    : sigma_(sigma),
      memory_((std::max(1.0, correlation) - 1.0) / (std::max(1.0, correlation) + 1.0)),
      generator_(seed) {}

void NoiseSource::fill(std::vector<double>& values) {
  const double fresh = sigma_ * std::sqrt(1.0 - memory_ * memory_);
  std::uint64_t signs = generator_();
  double state = signs & 1 ? sigma_ : -sigma_;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = state;
    signs = i % 63 == 0 ? generator_() : signs >> 1;
    state = memory_ * state + (signs & 1 ? fresh : -fresh);
  }
}

}  // namespace impactrig::fitting
