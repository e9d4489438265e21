// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/clipping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/stepped_rail.hpp"

namespace impactrig::acquisition {

using datasets::Impact;
using datasets::ImpactSignal;
using datasets::Quantity;

namespace {

constexpr std::size_t plateau_samples = 16;
constexpr std::size_t rail_samples = 32;  ///< equal ones on end that noise does not make

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

constexpr std::size_t fewest_equal = 3;  ///< samples on end that are a flat top without noise

/// Noise before a contact; 0 where nothing is known of it.
double noise_before(const Trace& trace, const Contact& contact, double quantum,
                    const DetectionOptions& options) {
  const auto quiet = quiet_before(trace, contact.onset, 0, options);
  if (!quiet) return 0.0;
  return fit_quiet(trace.values, quiet->begin, quiet->end, 1, quantum, trace.valid).sigma;
}

/// How many equal samples on end are no chance: with noise of more than half of a digitiser's step
/// two are equal in step / (2 sqrt(pi) sigma) of all cases, and so many that this happens in one of
/// 10⁴.
std::size_t equal_by_chance(double sigma, double quantum) {
  if (!(quantum > 0.0) || !(sigma > 0.5 * quantum)) return fewest_equal;
  const double chance = quantum / (2.0 * std::sqrt(std::numbers::pi) * sigma);
  return std::max(fewest_equal,
                  1 + static_cast<std::size_t>(std::ceil(std::log(1e-4) / std::log(chance))));
}

/// A flat top that no smooth crest makes: three or more equal extreme samples, above half of the
/// peak, and beyond them the signal falls off faster than a parabola through digitiser steps would
/// (a crest one step high over a run of m samples is 9 steps high over 3 m). Fewer than noise makes
/// equal by chance count where the signal falls off on both sides faster than one of fourth order
/// would, whose noise hides how it bends (81 times as high over 3 m).
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
  if (sound < fewest_equal) return false;
  const double before = std::abs(top - y[first > run ? first - run : 0]);
  const double after = std::abs(top - y[std::min(last + run, y.size() - 1)]);
  const double sigma = noise_before(trace, contact, quantum, options);
  if (sound >= equal_by_chance(sigma, quantum)) return std::max(before, after) > 13.5 * quantum;
  return std::min(before, after) > 81.0 * (4.0 * sigma + quantum);
}

/// A level stretch of a signal at its extreme, in the direction of `sign`.
struct Plateau {
  const std::vector<double>& y;
  double sign;
  std::size_t first, last;  ///< samples
  double level = 0.0;

  std::size_t size() const { return last - first + 1; }

  /// How far a sample lies under the level.
  double depth(std::size_t i) const { return sign * (level - y[i]); }
};

/// The samples about the peak that lie within noise of `sigma`; none where they are few.
std::optional<Plateau> plateau_at_peak(const std::vector<double>& y, const Contact& contact,
                                       double sigma) {
  const double sign = contact.peak < 0.0 ? -1.0 : 1.0;
  const double height = std::abs(contact.peak);
  const auto near_top = [&](std::size_t i) {
    return sign * (y[i] - contact.baseline) >=
           height - 9.0 * sigma;  // noise makes 3 to 4 of them at the peak
  };
  Plateau top{y, sign, contact.peak_index, contact.peak_index};
  while (top.first > 0 && near_top(top.first - 1)) --top.first;
  while (top.last + 1 < y.size() && near_top(top.last + 1)) ++top.last;
  if (top.size() < plateau_samples) return std::nullopt;
  // From here on the level is the plateau's own.
  top.level = median({y.begin() + static_cast<std::ptrdiff_t>(top.first),
                      y.begin() + static_cast<std::ptrdiff_t>(top.last) + 1});
  while (top.first < top.last && top.depth(top.first) > 2.5 * sigma) ++top.first;
  while (top.last > top.first && top.depth(top.last) > 2.5 * sigma) --top.last;
  if (top.size() < plateau_samples) return std::nullopt;
  return top;
}

/// Whether a plateau neither bends nor leans by more than its noise.
bool is_level(const Plateau& top, double sigma, double quantum) {
  const QuietFit course = fit_quiet(top.y, top.first, top.last + 1, 2, quantum);
  // Of noise alone these are 2.2 and 1.7 standard errors of the mean at one standard deviation.
  const double error = sigma / std::sqrt(as_double(top.size()));
  const double bend = 1.5 * std::abs(course.coefficients[2]);
  const double lean = 2.0 * std::abs(course.coefficients[1]);
  return !(bend > 0.3 * sigma + 9.0 * error || lean > 0.3 * sigma + 9.0 * error);
}

/// A flat top with noise behind it: the samples about the peak that lie within the noise before
/// touch are a level stretch, and the signal leaves it at both ends (or the record ends on it) at
/// once as steeply as it goes on. A crest curves within such a stretch, and a plateau that the
/// contact makes rounds off.
bool noisy_flat_top(const Trace& trace, const Contact& contact, double quantum,
                    const DetectionOptions& options) {
  const std::vector<double>& y = trace.values;
  const auto quiet = quiet_before(trace, contact.onset, 0, options);
  if (!quiet) return false;
  // On a level between two values of a digitiser the least noise is half a step.
  const double sigma = std::max(
      fit_quiet(y, quiet->begin, quiet->end, 1, quantum, trace.valid).sigma, 0.5 * quantum);
  if (!(sigma > 0.0)) return false;
  const auto top = plateau_at_peak(y, contact, sigma);
  if (!top) return false;
  const bool is_left = top->last + 1 < y.size();  // else the record ends on it
  const std::size_t behind = is_left ? y.size() - 1 - top->last : y.size();
  const std::size_t part =
      std::clamp<std::size_t>(top->size() / 12, 3, std::max<std::size_t>(4, behind / 2) - 1);
  if (top->first < 2 * part || (is_left && top->last + 2 * part >= y.size())) return false;
  if (!is_level(*top, sigma, quantum)) return false;
  const auto steep = [&](double near, double far) {
    return near > 10.0 * sigma && near > 0.6 * (far - near);
  };
  return steep(top->depth(top->first - part), top->depth(top->first - 2 * part)) &&
         (!is_left || steep(top->depth(top->last + part), top->depth(top->last + 2 * part)));
}

/// A crest whose noise is cut off with it: samples of a contact on one value, its extreme, far more
/// than on the next two. Noise of a step or more thins out towards an extreme.
bool cut_through_noise(const Trace& trace, const Contact& contact, double quantum,
                       const DetectionOptions& options) {
  constexpr std::size_t fewest = 6, more = 4;
  const double sigma = noise_before(trace, contact, quantum, options);
  if (!(sigma > 0.75 * quantum)) return false;
  const double sign = contact.peak < 0.0 ? -1.0 : 1.0;
  const double same = 1e-9 * std::abs(contact.peak);
  std::vector<double> depths;  // under the extreme
  const auto end = std::min(static_cast<std::size_t>(contact.end) + 1, trace.values.size());
  for (auto i = static_cast<std::size_t>(contact.onset); i < end; ++i)
    if (trace.is_valid(i))
      depths.push_back(sign * (trace.values[contact.peak_index] - trace.values[i]));
  std::ranges::sort(depths);
  std::array<std::size_t, 3> counts{};
  double value = 0.0;
  std::size_t k = 0;
  for (const double depth : depths) {
    if (depth > value + same && ++k == counts.size()) break;
    value = depth;
    ++counts[k];
  }
  return counts[0] >= std::max(fewest, more * std::max(counts[1], counts[2]));
}

bool reaches_range(const RecordedSignal& signal, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i <= last; ++i)
    if (at_range(signal.trace.values[i], signal.range)) return true;
  return false;
}

/// A pulse as it was recorded, its samples that the recorder marked too where they are finite, and
/// its peak in there.
struct AsRecorded {
  Trace trace;
  Contact contact;

  AsRecorded(const RecordedSignal& signal, const Contact& of, std::size_t first, std::size_t last)
      : trace(signal.trace),
        contact(of) {
    const double level = signal.channel->value(first) - signal.trace.values[first];
    for (std::size_t i = first; i <= last; ++i) {
      const double value = signal.channel->value(i) - level;
      const std::vector<std::uint8_t>& marks = signal.channel->valid;
      const bool marked = !marks.empty() && marks[i] == 0;
      if (trace.is_valid(i) || !marked || !std::isfinite(value)) continue;
      trace.values[i] = value;
      trace.valid[i] = 1;
    }
    for (std::size_t i = first; i <= last; ++i) {
      const double height = trace.values[i] - contact.baseline;
      if (height * contact.peak <= contact.peak * contact.peak) continue;
      contact.peak = height;
      contact.peak_index = i;
    }
  }
};

/// Whether the samples above half of the peak that a recorder marked are no lower than any sound
/// one: most of them, and all but for noise. Marks that have nothing to do with the range leave
/// sound samples on one flank that are higher than some of the marked ones on the other.
bool marks_what_is_higher(const RecordedSignal& signal, const AsRecorded& recorded, double sigma,
                          std::size_t first, std::size_t last) {
  double sound = 0.0;
  std::vector<double> marked;
  for (std::size_t i = first; i <= last; ++i) {
    const double height = std::abs(recorded.trace.values[i] - recorded.contact.baseline);
    if (signal.trace.is_valid(i))
      sound = std::max(sound, height);
    else if (recorded.trace.is_valid(i) && height >= 0.5 * std::abs(recorded.contact.peak))
      marked.push_back(height);
  }
  if (marked.empty()) return false;
  const double least = *std::ranges::min_element(marked);
  return least >= sound - std::max(6.0 * sigma, 1e-3 * sound) &&
         median(std::move(marked)) >= 0.999 * sound;
}

/// Whether a recorder marked what is beyond its range, or what it recorded where it marked is a
/// flat top.
bool marked_top(const RecordedSignal& signal, const Contact& contact, std::size_t first,
                std::size_t last, const DetectionOptions& options) {
  const Trace& trace = signal.trace;
  if (trace.valid.empty()) return false;
  const AsRecorded recorded(signal, contact, first, last);
  const double sigma = noise_before(trace, contact, signal.quantum, options);
  return marks_what_is_higher(signal, recorded, sigma, first, last) ||
         flat_top(recorded.trace, recorded.contact, signal.quantum, options) ||
         noisy_flat_top(recorded.trace, recorded.contact, signal.quantum, options);
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

}  // namespace

bool trigger_clipped(const RecordedSignal& trigger, const Contact& contact,
                     const DetectionOptions& options) {
  const std::vector<double>& y = trigger.trace.values;
  const bool pulse = trigger.trace.quantity != Quantity::velocity &&
                     trigger.trace.quantity != Quantity::displacement;
  const auto first = static_cast<std::size_t>(contact.onset);
  const std::size_t last = std::min(y.size() - 1, static_cast<std::size_t>(contact.end));
  return reaches_range(trigger, first, last) ||
         (pulse && (marked_top(trigger, contact, first, last, options) ||
                    flat_top(trigger.trace, contact, trigger.quantum, options) ||
                    cut_through_noise(trigger.trace, contact, trigger.quantum, options) ||
                    noisy_flat_top(trigger.trace, contact, trigger.quantum, options)));
}

bool motion_clipped(const Impact& impact, const Contact& contact,
                    const std::vector<const RecordedSignal*>& signals) {
  if (impact.velocity && !undersampled(contact) && wraps(*impact.velocity)) return true;
  for (const auto* signal : {&impact.velocity, &impact.displacement}) {
    if (!*signal) continue;
    const double range = known_range(signals, (*signal)->quantity);
    if (std::ranges::any_of((*signal)->values, [&](double v) { return at_range(v, range); }))
      return true;
    for (const double sign : {1.0, -1.0})
      if (on_rail(**signal, sign) || on_stepped_rail(impact, **signal, sign)) return true;
  }
  if (!impact.velocity) return false;
  return on_noisy_rail(impact, *impact.velocity, 1.0) ||
         on_noisy_rail(impact, *impact.velocity, -1.0);
}

}  // namespace impactrig::acquisition
