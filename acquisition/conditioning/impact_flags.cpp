// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/impact_flags.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/dropouts.hpp"

namespace impactrig::acquisition {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::ImpactSignal;
using datasets::Quantity;

namespace {

constexpr double enough_samples = 20.0;     ///< over a contact
constexpr double longest_dropout = 300e-6;  ///< [s], as the conditioning step has it
constexpr double much_noise = 0.02;         ///< of a signal, one standard deviation
constexpr double much_wandering = 0.02;     ///< of a peak
constexpr double much_shift = 0.01;         ///< of a peak
constexpr std::size_t plateau_samples = 16;
constexpr std::size_t rail_samples = 32;  ///< equal ones on end that noise does not make
constexpr std::size_t quiet_blocks = 16;  ///< of the time before touch
constexpr std::size_t least_after = 16;   ///< samples that say where a force comes to rest

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// How many equal samples on end are no chance: three without noise; with noise of more than half
/// of a digitiser's step two are equal in step / (2 sqrt(pi) sigma) of all cases, and so many that
/// this happens in one of 10⁴.
std::size_t equal_by_chance(const Trace& trace, const Contact& contact, double quantum,
                            const DetectionOptions& options) {
  constexpr std::size_t fewest = 3;
  const auto quiet = quiet_before(trace, contact.onset, 0, options);
  if (!quiet || !(quantum > 0.0)) return fewest;
  const double sigma = fit_quiet(trace.values, quiet->begin, quiet->end, 1, quantum).sigma;
  if (!(sigma > 0.5 * quantum)) return fewest;
  const double chance = quantum / (2.0 * std::sqrt(std::numbers::pi) * sigma);
  return std::max(fewest,
                  1 + static_cast<std::size_t>(std::ceil(std::log(1e-4) / std::log(chance))));
}

/// A flat top that no smooth crest makes: three or more equal extreme samples, above half of the
/// peak, and beyond them the signal falls off faster than a parabola through digitiser steps would
/// (a crest one step high over a run of m samples is 9 steps high over 3 m).
bool flat_top(const Trace& trace, const Contact& contact, double quantum,
              const DetectionOptions& options) {
  const std::vector<double>& y = trace.values;
  const double top = y[contact.peak_index];
  const auto same = [&](std::size_t i) {
    return std::abs(y[i] - top) <= 1e-9 * std::abs(contact.peak);
  };
  std::size_t first = contact.peak_index, last = contact.peak_index;
  while (first > 0 && same(first - 1)) --first;
  while (last + 1 < y.size() && same(last + 1)) ++last;
  const std::size_t run = last - first + 1;
  std::size_t sound = 0;  // what bridges invalid samples is level too
  for (std::size_t i = first; i <= last; ++i) sound += trace.is_valid(i) ? 1 : 0;
  if (sound < equal_by_chance(trace, contact, quantum, options)) return false;
  const std::size_t left = first > run ? first - run : 0;
  const std::size_t right = std::min(last + run, y.size() - 1);
  const double fall = std::max(std::abs(top - y[left]), std::abs(top - y[right]));
  return fall > 13.5 * quantum;
}

/// A flat top with noise behind it: the samples about the peak that lie within the noise before
/// touch are a level stretch, and the signal leaves it at both ends at once as steeply as it goes
/// on. A crest curves within such a stretch, and a plateau that the contact makes rounds off.
bool noisy_flat_top(const Trace& trace, const Contact& contact, double quantum,
                    const DetectionOptions& options) {
  const std::vector<double>& y = trace.values;
  const auto quiet = quiet_before(trace, contact.onset, 0, options);
  if (!quiet) return false;
  // On a level between two values of a digitiser the least noise is half a step.
  const double sigma =
      std::max(fit_quiet(y, quiet->begin, quiet->end, 1, quantum).sigma, 0.5 * quantum);
  if (!(sigma > 0.0)) return false;
  const double sign = contact.peak < 0.0 ? -1.0 : 1.0;
  const double height = std::abs(contact.peak);
  const auto near_top = [&](std::size_t i) {
    return sign * (y[i] - contact.baseline) >=
           height - 9.0 * sigma;  // noise makes 3 to 4 of them at the peak
  };
  const std::size_t peak = contact.peak_index;
  std::size_t first = peak, last = peak;
  while (first > 0 && near_top(first - 1)) --first;
  while (last + 1 < y.size() && near_top(last + 1)) ++last;
  if (last - first + 1 < plateau_samples) return false;
  // From here on the level is the plateau's own.
  const double level = median({y.begin() + static_cast<std::ptrdiff_t>(first),
                               y.begin() + static_cast<std::ptrdiff_t>(last) + 1});
  const auto depth = [&](std::size_t i) { return sign * (level - y[i]); };
  while (first < last && depth(first) > 2.5 * sigma) ++first;
  while (last > first && depth(last) > 2.5 * sigma) --last;
  const std::size_t run = last - first + 1;
  const std::size_t part = std::max<std::size_t>(3, run / 12);
  if (run < plateau_samples || first < 2 * part || last + 2 * part >= y.size()) return false;
  const QuietFit course = fit_quiet(y, first, last + 1, 2, quantum);
  // Of noise alone these are 2.2 and 1.7 standard errors of the mean at one standard deviation.
  const double error = sigma / std::sqrt(as_double(run));
  const double bend = 1.5 * std::abs(course.coefficients[2]);
  const double lean = 2.0 * std::abs(course.coefficients[1]);
  if (bend > 0.3 * sigma + 9.0 * error || lean > 0.3 * sigma + 9.0 * error) return false;
  const auto steep = [&](double near, double far) {
    return near > 10.0 * sigma && near > 0.6 * (far - near);
  };
  return steep(depth(first - part), depth(first - 2 * part)) &&
         steep(depth(last + part), depth(last + 2 * part));
}

/// Whether a signal reaches its known range, or invalid samples of it are a top that the recorder
/// marked: finite ones above half of the peak that no sound sample of the contact is higher than.
/// `half_peak` 0: these do not count.
bool over_range(const RecordedSignal& signal, std::size_t first, std::size_t last, double half_peak,
                double baseline) {
  const Trace& trace = signal.trace;
  for (std::size_t i = first; i <= last; ++i)
    if (at_range(trace.values[i], signal.range)) return true;
  if (!(half_peak > 0.0)) return false;
  // As recorded: the trace bridges what is invalid.
  const datasets::Channel& channel = *signal.channel;
  const double level = channel.value(first);
  double sound = 0.0, marked = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    const double height = std::abs(channel.value(i) - level);
    if (trace.is_valid(i))
      sound = std::max(sound, height);
    else if (!std::isnan(height) && std::abs(trace.values[i] - baseline) >= half_peak)
      marked = std::max(marked, height);
  }
  return marked > 0.0 && marked >= 0.999 * sound;
}

bool clipped(const RecordedSignal& trigger, const Contact& contact,
             const DetectionOptions& options) {
  const std::vector<double>& y = trigger.trace.values;
  const bool pulse = trigger.trace.quantity != Quantity::velocity;
  const auto first = static_cast<std::size_t>(contact.onset);
  const std::size_t last = std::min(y.size() - 1, static_cast<std::size_t>(contact.end));
  return over_range(trigger, first, last, pulse ? 0.5 * std::abs(contact.peak) : 0.0,
                    contact.baseline) ||
         (pulse && (flat_top(trigger.trace, contact, trigger.quantum, options) ||
                    noisy_flat_top(trigger.trace, contact, trigger.quantum, options)));
}

/// White noise beyond a digitiser's rounding on whatever smooth course. Fourth differences leave
/// hardly anything of a curve and turn in 0.80 of white noise; sixth ones tell the same noise then,
/// and less where it is a vibration that few samples follow. Rounding alone is 0.3 to 0.55 of a
/// step by its median, as differences are whole steps.
bool has_rough_noise(const std::vector<double>& y, double quantum, double span) {
  const auto differences = [](std::vector<double> values, int times) {
    for (int k = 0; k < times; ++k) {
      for (std::size_t i = 0; i + 1 < values.size(); ++i) values[i] = values[i + 1] - values[i];
      values.pop_back();
    }
    return values;
  };
  const auto typical = [](std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    return normal_mad * median(std::move(values));
  };
  const std::vector<double> fourth = differences(y, 4);
  std::size_t turns = 0;
  for (std::size_t i = 1; i < fourth.size(); ++i) turns += fourth[i] * fourth[i - 1] < 0.0 ? 1 : 0;
  // sums of the squared binomial coefficients
  const double noise =
      std::min(typical(fourth) / std::sqrt(70.0), typical(differences(y, 6)) / std::sqrt(924.0));
  return 2 * turns > fourth.size() && noise > std::max(0.7 * quantum, 3e-5 * span);
}

/// A rail that no range states: noise on the way, none for many samples on end at the extreme.
/// A digitiser's level is none: its runs end where the noise is a step high, and without such noise
/// a bar at rest or at constant speed has them too. Nor is zero, where lost lasers are.
bool on_rail(const ImpactSignal& signal, double sign) {
  const std::vector<double>& y = signal.values;
  const auto valid = [&](std::size_t i) { return signal.valid.empty() || signal.valid[i] != 0; };
  double top = -INFINITY, bottom = INFINITY;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (!valid(i)) continue;
    top = std::max(top, sign * y[i]);
    bottom = std::min(bottom, sign * y[i]);
  }
  const double span = top - bottom;
  if (!(span > 0.0) || std::abs(top) <= 1e-3 * span) return false;
  const auto same = [&](double a, double b) { return std::abs(a - b) <= 1e-9 * span; };
  std::vector<double> off;  // what is on neither extreme
  std::size_t run = 0, longest = 0, elsewhere = 0, longest_elsewhere = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const bool at_top = valid(i) && same(sign * y[i], top);
    run = at_top ? run + 1 : 0;
    longest = std::max(longest, run);
    if (at_top || same(sign * y[i], bottom)) continue;
    elsewhere = !off.empty() && same(y[i], off.back()) ? elsewhere + 1 : 1;
    longest_elsewhere = std::max(longest_elsewhere, elsewhere);
    off.push_back(y[i]);
  }
  if (longest < rail_samples || longest < 4 * longest_elsewhere || off.size() < rail_samples)
    return false;
  return has_rough_noise(off, signal.quantum, span);
}

/// The longest level stretch of a signal at its largest value, in the direction of `sign`, of a
/// digitiser whose step is known.
struct LevelStretch {
  const ImpactSignal& signal;
  double sign, top;
  std::size_t first = 0, size = 0;  ///< samples
  long span = 0;                    ///< steps to the other extreme

  LevelStretch(const ImpactSignal& of, double direction) : signal(of), sign(direction) {
    const auto [least, most] = std::ranges::minmax(signal.values);
    top = sign > 0.0 ? most : least;
    span = std::lround((most - least) / signal.quantum);
    for (std::size_t i = 0, begin = 0; i < signal.values.size(); ++i) {
      if (below(i) > 0) begin = i + 1;
      if (i + 1 - begin > size) first = begin, size = i + 1 - begin;
    }
  }

  bool begins_inside() const { return first == 0; }

  bool ends_inside() const { return first + size == signal.values.size(); }

  /// Steps under the extreme.
  long below(std::size_t i) const {
    return std::lround(sign * (top - signal.values[i]) / signal.quantum);
  }

  /// How far the signal has fallen `samples` behind the end of the stretch, or before its begin.
  long fall(std::size_t samples, bool behind) const {
    if (behind) return below(std::min(first + size - 1 + samples, signal.values.size() - 1));
    return below(first > samples ? first - samples : 0);
  }

  /// Samples from the end (or begin) until the signal is so many steps down; none where it is not.
  std::optional<double> samples_to(long depth, bool behind) const {
    const std::size_t most = behind ? signal.values.size() - first - size : first;
    const double level = static_cast<double>(depth) - 0.5;  // where the value before gives way
    double last = 0.0;
    for (std::size_t n = 0; n < most; ++n) {
      const double here = static_cast<double>(below(behind ? first + size + n : first - 1 - n));
      if (here >= level) return as_double(n) - (here - level) / (here - last);
      last = here;
    }
    return std::nullopt;
  }
};

/// Whether a signal leaves its extreme at once as steeply as it goes on. What a contact's force
/// bends begins as t² or slower and takes 1.6 times as long over its first m steps as over the next
/// m; a rail that it crosses, once.
bool leaves_at_once(const LevelStretch& level, bool behind) {
  constexpr long fewest_steps = 4;
  constexpr double fewest_samples = 2.0;  // the stretch's own end is known to one
  const long m = std::max(fewest_steps, level.span / 12);
  const auto near = level.samples_to(1 + m, behind), far = level.samples_to(1 + 2 * m, behind);
  if (!near || !far || *near < fewest_samples) return false;
  return *near < 1.35 * (*far - *near) &&
         as_double(level.size) > 4.0 * std::max(*near, *far - *near) / static_cast<double>(m);
}

/// The part of the contact's impulse up to a time; none without a force.
std::optional<double> impulse_until(const Impact& impact, double time) {
  if (!impact.force) return std::nullopt;
  double before = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < impact.force->values.size(); ++i) {
    const double t = impact.force->time(i);
    if (t < impact.start || t > impact.end) continue;
    whole += impact.force->values[i];
    if (t < time) before += impact.force->values[i];
  }
  return whole != 0.0 ? std::optional(before / whole) : std::nullopt;
}

/// A rail that no range states, of a digitiser whose steps hide the noise: a level stretch at the
/// extreme, far longer than a step takes beside it, that the signal leaves at once. Inside the
/// window both ends have to, and fall off faster than the crest through such steps would that the
/// stretch allows (see flat_top). A velocity may begin or end on its rail; so may one at constant
/// speed whose contact begins with a jump, but that one leaves before the force has done anything.
/// Displacements do it by themselves, as a struck bar's.
bool on_stepped_rail(const Impact& impact, const ImpactSignal& signal, double sign) {
  constexpr long least_span = 48;  // steps: fewer do not tell a curve from a line
  constexpr long crest_fall = 13;
  if (!(signal.quantum > 0.0)) return false;
  if (!signal.valid.empty() && std::ranges::count(signal.valid, 0) > 0) return false;
  const LevelStretch level(signal, sign);
  const bool begins = level.begins_inside(), ends = level.ends_inside();
  const double span = static_cast<double>(level.span);
  if (level.size < plateau_samples || (begins && ends) ||
      std::abs(level.top) <= 1e-3 * span * signal.quantum)  // lost lasers show zero
    return false;
  if (!begins && !ends)
    return std::min(level.fall(level.size, false), level.fall(level.size, true)) > crest_fall &&
           leaves_at_once(level, false) && leaves_at_once(level, true);
  if (signal.quantity != Quantity::velocity || level.span < least_span) return false;
  const double edge = signal.time(begins ? level.size : level.first);
  const auto done = impulse_until(impact, edge);
  const double little = 0.02 + 3.0 / span;
  return done && *done > little && *done < 1.0 - little && leaves_at_once(level, begins);
}

double range_of(const std::vector<const RecordedSignal*>& signals, Quantity quantity) {
  for (const RecordedSignal* const signal : signals)
    if (signal->trace.quantity == quantity) return signal->range;
  return 0.0;
}

/// A velocity that goes on at the other end of a decoder's range: from one sample to the next it
/// turns over, beyond four fifths of its largest value on both sides, and stays there for three
/// samples at least. A contact of many samples takes longer, and a lost laser shows zero.
bool wraps(const ImpactSignal& velocity) {
  constexpr double near_end = 0.8, stays = 0.5;
  constexpr std::size_t beside = 3;
  const std::vector<double>& y = velocity.values;
  double largest = 0.0;
  for (const double value : y) largest = std::max(largest, std::abs(value));
  for (std::size_t i = beside; i + beside <= y.size(); ++i) {
    const double sign = y[i] < 0.0 ? -1.0 : 1.0;
    bool turned = sign * y[i] >= near_end * largest && -sign * y[i - 1] >= near_end * largest;
    for (std::size_t k = 1; turned && k < beside; ++k)
      turned = sign * y[i + k] >= stays * largest && -sign * y[i - 1 - k] >= stays * largest;
    if (turned && largest > 0.0) return true;
  }
  return false;
}

/// A motion that reaches its range, or a rail that is not stated, anywhere in the window, as its
/// approach counts too.
bool motion_clipped(const Impact& impact, const Contact& contact,
                    const std::vector<const RecordedSignal*>& signals) {
  if (impact.velocity && contact.end - contact.onset >= enough_samples && wraps(*impact.velocity))
    return true;
  for (const auto* signal : {&impact.velocity, &impact.displacement}) {
    if (!*signal) continue;
    const double range = range_of(signals, (*signal)->quantity);
    if (std::ranges::any_of((*signal)->values, [&](double v) { return at_range(v, range); }))
      return true;
    for (const double sign : {1.0, -1.0})
      if (on_rail(**signal, sign) || on_stepped_rail(impact, **signal, sign)) return true;
  }
  return false;
}

/// Invalid samples that are not at the end of the range.
bool lost(const std::optional<ImpactSignal>& signal, double range) {
  if (!signal || signal->valid.empty()) return false;
  for (std::size_t i = 0; i < signal->values.size(); ++i)
    if (signal->valid[i] == 0 && !at_range(signal->values[i], range)) return true;
  return false;
}

/// Clipped samples that the recorder marked are clipped, not lost.
bool dropout(const Impact& impact, const Contact& contact, bool is_clipped,
             const std::vector<const RecordedSignal*>& signals) {
  if (lost(impact.velocity, range_of(signals, Quantity::velocity))) return true;
  if (lost(impact.displacement, range_of(signals, Quantity::displacement))) return true;
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
  if (contact.end - contact.onset < enough_samples) return false;
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
  if (!impact.velocity) return false;
  const auto [least, most] = std::ranges::minmax(impact.velocity->values);
  return impact.velocity->noise > much_noise * (most - least);
}

const RecordedSignal* force_among(const std::vector<const RecordedSignal*>& signals) {
  for (const RecordedSignal* const signal : signals)
    if (signal->trace.quantity == Quantity::force) return signal;
  return nullptr;
}

/// Whether the force before touch wanders: the means of 16 blocks spread by more than their noise.
bool unsteady(const RecordedSignal& force, const Impact& impact, double peak, double floor,
              const DetectionOptions& options) {
  const Trace& trace = force.trace;
  const double first = std::max(0.0, std::ceil(trace.index(floor)));
  const auto quiet =
      quiet_before(trace, trace.index(impact.start), static_cast<std::size_t>(first), options);
  if (!quiet || quiet->end - quiet->begin < 4 * quiet_blocks) return false;
  double least = INFINITY, most = -INFINITY;
  const std::size_t n = quiet->end - quiet->begin;
  for (std::size_t b = 0; b < quiet_blocks; ++b) {
    const std::size_t from = quiet->begin + n * b / quiet_blocks;
    const std::size_t to = quiet->begin + n * (b + 1) / quiet_blocks;
    double mean = 0.0;
    for (std::size_t i = from; i < to; ++i) mean += trace.values[i] / as_double(to - from);
    least = std::min(least, mean);
    most = std::max(most, mean);
  }
  // White noise only: what is correlated over a block is wandering.
  const double noise = step_noise({trace.values.data() + quiet->begin, n}) /
                       std::sqrt(as_double(n) / as_double(quiet_blocks));
  return most - least > much_wandering * std::abs(peak) + 6.0 * noise;
}

/// How far a digitiser's rounding may move the mean of a level: half of a step where all samples
/// are on one value or the next, and 0.012 of a step or less where they scatter by more than these
/// can.
double rounding_error(double sigma, double quantum) {
  return sigma > 0.5 * quantum ? 0.012 * quantum : 0.5 * quantum;
}

/// Whether the force after the last contact, which ends at `end` [s], lies off its level before.
/// Ringing has a mean near zero and scatters more than that. A bar that hits again may go on
/// pressing, so what has the sign of the peak is no shift then.
bool shifted(const Impact& impact, const Contact& contact, double end, double peak) {
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
  double scatter = robust_spread(after).sigma;
  if (scatter <= 1.01 * normal_mad * force.quantum) scatter = level.sigma;  // a step: no less shows
  if (contact.further_hits > 0 && level.mean * peak > 0.0) return false;
  const double rounding =
      rounding_error(force.noise, force.quantum) + rounding_error(level.sigma, force.quantum);
  return std::abs(level.mean) >
         std::max({much_shift * std::abs(peak), scatter, force.noise, rounding});
}

/// Tension in the contact, or a bar that comes from the other side, which a record that begins
/// within the contact does not show: the bar may be on its way back then.
bool inverted(const Impact& impact, const Contact& contact, double peak) {
  if (impact.force && peak < 0.0) return true;
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
  const bool is_clipped = clipped(*signals.front(), contact, options);
  const double peak = impact.force ? force_peak(impact) : 0.0;
  const RecordedSignal* const force = impact.force ? force_among(signals) : nullptr;
  flag(is_clipped || motion_clipped(impact, contact, signals), ImpactFlag::clipped);
  flag(contact.further_hits > 0, ImpactFlag::double_hit);
  flag(contact.further_hits > 1, ImpactFlag::multiple_hits);
  flag(contact.begins_inside || contact.ends_inside, ImpactFlag::too_short);
  flag(contact.begins_inside, ImpactFlag::missed_start);
  flag(contact.ends_inside, ImpactFlag::truncated_tail);
  flag(dropout(impact, contact, is_clipped, signals), ImpactFlag::dropout);
  flag(unmarked_dropout(impact, contact), ImpactFlag::unmarked_dropout);
  flag(contact.end - contact.onset < enough_samples, ImpactFlag::undersampled);
  flag(noisy(impact), ImpactFlag::noisy);
  if (force != nullptr) {
    flag(unsteady(*force, impact, peak, floor, options), ImpactFlag::unsteady);
    const Trace& trigger = signals.front()->trace;
    const double last = contact.further_hits > 0 ? trigger.time(contact.last_end) : impact.end;
    flag(!contact.ends_inside && shifted(impact, contact, last, peak), ImpactFlag::baseline_shift);
  }
  flag(inverted(impact, contact, peak), ImpactFlag::inverted);
  return flags;
}

}  // namespace impactrig::acquisition
