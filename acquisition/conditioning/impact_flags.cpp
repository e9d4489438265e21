// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/impact_flags.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/clipping.hpp"
#include "acquisition/conditioning/dropouts.hpp"

namespace impactrig::acquisition {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::ImpactSignal;
using datasets::Quantity;

namespace {

constexpr double longest_dropout = 300e-6;  ///< [s], as the conditioning step has it
constexpr double much_noise = 0.02;         ///< of a signal, one standard deviation
constexpr double much_wandering = 0.02;     ///< of a peak
constexpr double much_shift = 0.01;         ///< of a peak
constexpr std::size_t quiet_blocks = 16;    ///< of the time before touch
constexpr std::size_t least_after = 16;     ///< samples that say where a force comes to rest

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// Invalid samples that are not at the end of the range.
bool lost(const std::optional<ImpactSignal>& signal, double range) {
  if (!signal || signal->valid.empty()) return false;
  for (std::size_t i = 0; i < signal->values.size(); ++i)
    if (signal->valid[i] == 0 && !at_range(signal->values[i], range)) return true;
  return false;
}

/// A motion that stays on one value while the force presses: a laser without light, or nothing
/// behind the channel.
bool dead(const std::optional<ImpactSignal>& motion) {
  constexpr std::size_t fewest = 16;
  if (!motion || motion->values.size() < fewest) return false;
  const double first = motion->values.front();
  return std::ranges::all_of(motion->values, [first](double value) { return value == first; });
}

/// Clipped samples that the recorder marked are clipped, not lost.
bool dropout(const Impact& impact, const Contact& contact, bool is_clipped,
             const std::vector<const RecordedSignal*>& signals) {
  if (lost(impact.velocity, known_range(signals, Quantity::velocity))) return true;
  if (lost(impact.displacement, known_range(signals, Quantity::displacement))) return true;
  if (dead(impact.velocity) || dead(impact.displacement)) return true;
  if (!impact.force || impact.force->valid.empty()) return false;
  if (!is_clipped) return true;
  const ImpactSignal& force = *impact.force;
  for (std::size_t i = 0; i < force.values.size(); ++i)
    if (force.valid[i] == 0 && std::abs(force.values[i]) < 0.5 * std::abs(contact.peak))
      return true;
  return false;
}

/// Motion that steps away and back, of contacts with samples enough. Where further contacts are
/// behind, only what begins before the first one ends: later motion may do so by itself.
bool unmarked_dropout(const Impact& impact, const Contact& contact) {
  if (undersampled(contact)) return false;
  const double until = contact.further_hits > 0 ? impact.end : INFINITY;
  const auto found = [until](const std::optional<ImpactSignal>& signal) {
    if (!signal) return false;
    const auto longest = static_cast<std::size_t>(longest_dropout / signal->interval);
    if (longest == 0) return false;
    const auto dropouts = find_dropouts(signal->values, signal->valid, longest, signal->quantity);
    return std::ranges::any_of(
        dropouts, [&](const Dropout& dropout) { return signal->time(dropout.begin) < until; });
  };
  return found(impact.velocity) || found(impact.displacement);
}

/// Samples [first, last) of a motion that repeat for longer than noise lets them: the laser holds
/// what it saw last, or its range is at an end. Two neighbours are equal with a probability of a
/// step over 2 sqrt(pi) standard deviations; of the whole record less than one run in 10⁴ is as
/// long.
std::optional<std::pair<std::size_t, std::size_t>> held(const ImpactSignal& motion, double step) {
  constexpr std::size_t fewest = 4;
  constexpr double by_chance = 1e-4;
  const std::vector<double>& y = motion.values;
  const double noise = step_noise(y, motion.valid);
  if (!(noise > step)) return std::nullopt;
  const double equal = step / (2.0 * std::sqrt(std::numbers::pi) * noise);
  for (std::size_t i = 0, from = 0; i <= y.size(); ++i) {
    const bool sound = i < y.size() && (motion.valid.empty() || motion.valid[i] != 0);
    if (sound && i > from && y[i] == y[from]) continue;
    const double run = as_double(i - from);
    if (i >= from + fewest && as_double(y.size()) * std::pow(equal, run - 1.0) < by_chance)
      return std::pair{from, i};
    from = sound ? i : i + 1;
  }
  return std::nullopt;
}

/// Whether a displacement alone is held: at its extreme by its range, else by lost light.
bool held_at_extreme(const Impact& impact, const RecordedSignal& trigger, bool extreme) {
  if (!impact.rebound) return false;
  const auto stretch = held(*impact.displacement, grain_of_motion(trigger.trace));
  if (!stretch) return false;
  const std::vector<double>& y = impact.displacement->values;
  const auto [least, most] = std::ranges::minmax(y);
  return (y[stretch->first] == least || y[stretch->first] == most) == extreme;
}

/// The largest force within the contact, signed; the trigger may be another channel.
double force_peak(const Impact& impact) {
  const ImpactSignal& force = *impact.force;
  double peak = 0.0;
  for (std::size_t i = 0; i < force.values.size(); ++i) {
    const double t = force.time(i);
    if (t < impact.start || t > impact.end) continue;
    if (std::abs(force.values[i]) > std::abs(peak)) peak = force.values[i];
  }
  return peak;
}

bool noisy(const Impact& impact) {
  if (impact.force && impact.force->noise > much_noise * std::abs(force_peak(impact))) return true;
  const ImpactSignal* const motion = impact.velocity  ? &*impact.velocity
                                     : impact.rebound ? &*impact.displacement
                                                      : nullptr;
  if (motion == nullptr) return false;
  const auto [least, most] = std::ranges::minmax(motion->values);
  return motion->noise > much_noise * (most - least);
}

const RecordedSignal* force_among(const std::vector<const RecordedSignal*>& signals) {
  for (const RecordedSignal* const signal : signals)
    if (signal->trace.quantity == Quantity::force) return signal;
  return nullptr;
}

/// Whether a force or an acceleration wanders for as long before touch as the contact takes, or the
/// baseline's window where that is longer: the means of 16 blocks spread by more than their noise.
bool unsteady(const RecordedSignal& pulse, const Impact& impact, double peak, double floor,
              const DetectionOptions& options) {
  const Trace& trace = pulse.trace;
  const double first = std::max(0.0, std::ceil(trace.index(floor)));
  auto quiet =
      quiet_before(trace, trace.index(impact.start), static_cast<std::size_t>(first), options);
  if (!quiet) return false;
  const double contact = std::floor((impact.end - impact.start) / trace.interval);
  const double begin = std::max(first, as_double(quiet->end) - contact);
  quiet->begin = std::min(quiet->begin, static_cast<std::size_t>(std::max(0.0, begin)));
  if (quiet->end - quiet->begin < 4 * quiet_blocks) return false;
  const std::size_t n = quiet->end - quiet->begin;
  const std::span<const double> before(trace.values.data() + quiet->begin, n);
  const auto marks = trace.marks(quiet->begin, quiet->end);
  // White noise only: what is correlated over a block is wandering.
  const double noise =
      step_noise(before, marks) / std::sqrt(as_double(n) / as_double(quiet_blocks));
  return range_of_means(before, marks, quiet_blocks) >
         much_wandering * std::abs(peak) + 6.0 * noise;
}

/// How far a digitiser's rounding may move the mean of a level: half of a step where all samples
/// are on one value or the next, and 0.012 of a step or less where they scatter by more than these
/// can.
double rounding_error(double sigma, double quantum) {
  return sigma > 0.5 * quantum ? 0.012 * quantum : 0.5 * quantum;
}

/// What a force does about a level for longer than an eighth of the stretch: ringing, hum and
/// drift, by the means of eight blocks.
double slow_scatter(std::span<const double> stretch) {
  const std::vector<double> means = block_means(stretch, {}, 8);
  const double n = as_double(means.size());
  const double mean = std::accumulate(means.begin(), means.end(), 0.0) / n;
  double square = 0.0;
  for (const double of_block : means) square += std::pow(of_block - mean, 2);
  return std::sqrt(square / n);
}

/// Of a level after an impact against the one before, by noise [N].
struct LevelError {
  double slow;   ///< the part of the noise that does not change from sample to sample
  double means;  ///< four standard deviations of what the rest leaves of both levels
};

LevelError level_error(const ImpactSignal& force, double touch, double sigma_after,
                       std::size_t samples_after) {
  const auto before = static_cast<std::size_t>(
      std::clamp((touch - force.start) / force.interval, 0.0, as_double(force.values.size())));
  if (before < least_after) return {force.noise, 0.0};
  const std::span quiet(force.values.data(), before);
  const std::span valid = std::span(force.valid).first(std::min(before, force.valid.size()));
  const double fast = step_noise(quiet, valid);
  // a line's end is known half as well as the mean along it
  const double ends = 1.0 / as_double(samples_after) + 4.0 / as_double(before);
  return {std::sqrt(std::max(0.0, force.noise * force.noise - fast * fast)),
          4.0 * std::max(sigma_after, force.noise) * std::sqrt(ends)};
}

/// How far below its level before a low cut of first order [Hz] leaves a force at a time [s] [N].
double taken_by_low_cut(const ImpactSignal& force, double low_cut, double until) {
  const double rate = 2.0 * std::numbers::pi * low_cut;
  double pushed = 0.0;
  for (std::size_t i = 0; i < force.values.size() && force.time(i) < until; ++i)
    pushed += force.values[i] * force.interval;
  return rate * pushed;
}

/// Whether the force after the last contact, which ends at `end` [s], lies off its level before,
/// and off where the sensor's low cut [Hz] leaves it too. Ringing has a mean near zero and scatters
/// more than that. A bar that hits again may go on pressing, so what has the sign of the peak is no
/// shift then.
bool shifted(const Impact& impact, const Contact& contact, double end, double peak,
             double low_cut) {
  const ImpactSignal& force = *impact.force;
  const double from = end + impact.width, to = end + 6.0 * impact.width;
  std::vector<double> after;
  for (std::size_t i = 0; i < force.values.size(); ++i) {
    const double t = force.time(i);
    if (t >= from && t <= to && (force.valid.empty() || force.valid[i]))
      after.push_back(force.values[i]);
  }
  if (after.size() < least_after) return false;
  const QuietFit level = fit_quiet(after, 0, after.size(), 0, force.quantum);
  if (contact.further_hits > 0 && level.mean * peak > 0.0) return false;
  const LevelError error = level_error(force, impact.start, level.sigma, after.size());
  const double rounding =
      rounding_error(force.noise, force.quantum) + rounding_error(level.sigma, force.quantum);
  const double middle = 0.5 * (from + std::min(to, force.time(force.values.size() - 1)));
  const double below = taken_by_low_cut(force, low_cut, middle);
  return std::min(std::abs(level.mean), std::abs(level.mean + below)) >
         std::max(
             {much_shift * std::abs(peak), slow_scatter(after), error.slow, error.means, rounding});
}

/// Tension in the contact, or a bar that comes from the other side, which a record that begins
/// within the contact does not show: the bar may be on its way back then.
bool inverted(const Impact& impact, const Contact& contact, double peak) {
  if (impact.force && peak < 0.0) return true;
  if (contact.bounce) return contact.bounce->sign < 0.0;
  if (!impact.velocity || contact.begins_inside) return false;
  return impact.approach_velocity < -3.0 * impact.velocity->noise;
}

}  // namespace

std::vector<ImpactFlag> flags_of(const Impact& impact, const Contact& contact,
                                 const std::vector<const RecordedSignal*>& signals, double floor,
                                 const DetectionOptions& options) {
  std::vector<ImpactFlag> flags;
  const auto flag = [&flags](bool is, ImpactFlag which) {
    if (is) flags.push_back(which);
  };
  const bool is_clipped = trigger_clipped(*signals.front(), contact, options);
  const double peak = impact.force ? force_peak(impact) : 0.0;
  const RecordedSignal* const force = impact.force ? force_among(signals) : nullptr;
  flag(is_clipped || motion_clipped(impact, contact, signals) ||
           held_at_extreme(impact, *signals.front(), true),
       ImpactFlag::clipped);
  flag(contact.further_hits > 0, ImpactFlag::double_hit);
  flag(contact.further_hits > 1, ImpactFlag::multiple_hits);
  flag(contact.begins_inside || contact.ends_inside, ImpactFlag::too_short);
  flag(contact.begins_inside, ImpactFlag::missed_start);
  flag(contact.ends_inside, ImpactFlag::truncated_tail);
  flag(dropout(impact, contact, is_clipped, signals), ImpactFlag::dropout);
  flag(unmarked_dropout(impact, contact) || held_at_extreme(impact, *signals.front(), false),
       ImpactFlag::unmarked_dropout);
  flag(undersampled(contact), ImpactFlag::undersampled);
  flag(noisy(impact), ImpactFlag::noisy);
  const Trace& trigger = signals.front()->trace;
  if (force == nullptr && trigger.quantity == Quantity::acceleration)
    flag(unsteady(*signals.front(), impact, contact.peak, floor, options), ImpactFlag::unsteady);
  if (force != nullptr) {
    flag(unsteady(*force, impact, peak, floor, options), ImpactFlag::unsteady);
    const double last = contact.further_hits > 0 ? trigger.time(contact.last_end) : impact.end;
    flag(!contact.ends_inside && shifted(impact, contact, last, peak, force->low_cut),
         ImpactFlag::baseline_shift);
  }
  flag(inverted(impact, contact, peak), ImpactFlag::inverted);
  return flags;
}

}  // namespace impactrig::acquisition
