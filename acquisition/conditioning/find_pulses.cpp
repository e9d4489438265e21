// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <span>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/baseline_search.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/measure_pulse.hpp"
#include "acquisition/conditioning/steady_drift.hpp"
#include "acquisition/conditioning/touch_in_vibration.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double dense_height = 20.0;    ///< standard deviations, where the pulse fills the record
constexpr std::size_t least_quiet = 16;  ///< samples that tell a level and its noise

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// Where and how a signal is looked for.
struct Trigger {
  double level = 0.0;      ///< of the quiet signal
  double threshold = 0.0;  ///< departure from it that is a contact
  double sigma = 0.0;      ///< noise
};

class PulseSearch {
 public:
  /// `grain`: grain_of() the signal as it was recorded.
  PulseSearch(const Trace& trace, double grain, const DetectionOptions& options)
      : trace_(trace),
        y_(trace.values),
        options_(options),
        grain_(grain),
        gate_(noise_gate(y_.size())),
        window_(static_cast<std::size_t>(std::max(200.0, options.before() / trace.interval))) {}

  std::vector<Contact> run();

 private:
  std::optional<Trigger> sparse_trigger() const;
  std::optional<Trigger> dense_trigger() const;
  Trigger sharpened(Trigger trigger) const;
  std::optional<Trigger> begin_trigger(const Trigger& trigger) const;
  double width_of_tallest(double level) const;
  QuietFit course_before(std::size_t end) const;
  bool is_level(std::size_t end) const;
  bool ends_on_rail(const Trigger& begin, std::size_t crossing) const;
  bool comes_to_rest_at(const Trigger& begin) const;
  double height(double level, std::size_t begin, std::size_t end) const;
  std::size_t first_above(const Trigger& trigger, std::size_t from) const;
  Pulse tallest(const Trigger& trigger, std::size_t from, std::size_t count) const;
  std::size_t quiet_run(double level, double limit, bool from_end) const;
  Baseline baseline_before(std::size_t end, std::size_t floor, const Pulse& pulse,
                           const Trigger& trigger) const;
  std::optional<Contact> measure_from(const Baseline& baseline, std::size_t crossing,
                                      std::size_t floor, const Trigger& trigger,
                                      std::optional<double> touch = {}) const;
  bool wanders_like_foot(const Contact& far, const Contact& near, const QuietFit& level,
                         std::size_t floor, std::size_t length) const;
  std::optional<Contact> measure(std::size_t crossing, std::size_t floor,
                                 const Trigger& trigger) const;
  bool swings(double level, double least, std::size_t begin, std::size_t end) const;
  std::size_t first_contact(const Trigger& trigger) const;
  std::optional<Contact> measure_from_plateau(const Contact& contact, std::size_t crossing,
                                              std::size_t floor, const Pulse& pulse,
                                              const Trigger& trigger) const;
  double height_by_blocks(double level, std::size_t begin, std::size_t end) const;
  std::size_t next_impact(const Contact& contact, const Trigger& trigger, std::size_t& floor) const;

  double at_least_a_step(double sigma) const { return noise_above_step(sigma, grain_); }

  const Trace& trace_;
  std::span<const double> y_;
  const DetectionOptions& options_;
  double grain_;
  double gate_;
  std::size_t window_;  ///< samples before a pulse that say what is quiet
  mutable std::vector<double> block_heights_;
};

double PulseSearch::height(double level, std::size_t begin, std::size_t end) const {
  double largest = 0.0;
  for (std::size_t i = begin; i < std::min(end, y_.size()); ++i)
    largest = std::max(largest, std::abs(y_[i] - level));
  return largest;
}

std::size_t PulseSearch::first_above(const Trigger& trigger, std::size_t from) const {
  while (from < y_.size() && std::abs(y_[from] - trigger.level) <= trigger.threshold) ++from;
  return from;
}

/// The greatest departure among `count` samples from `from` on, and twice its full width at half of
/// it, which neither noise nor hum changes much: a sine squared pulse is as long.
Pulse PulseSearch::tallest(const Trigger& trigger, std::size_t from, std::size_t count) const {
  const auto departs = [&](std::size_t i) { return std::abs(y_[i] - trigger.level); };
  std::size_t top = from;
  for (std::size_t i = from; i < std::min(from + count, y_.size()); ++i)
    if (departs(i) > departs(top)) top = i;
  const double half = 0.5 * departs(top);
  std::size_t begin = top, end = top;
  while (begin > from && departs(begin - 1) > half) --begin;
  while (end < y_.size() && departs(end) > half) ++end;
  return {.height = departs(top), .top = top, .length = 2 * (end - begin)};
}

/// How many samples from one end of the record stay within `limit` of `level`.
std::size_t PulseSearch::quiet_run(double level, double limit, bool from_end) const {
  std::size_t n = 0;
  while (n < y_.size() && std::abs(y_[from_end ? y_.size() - 1 - n : n] - level) <= limit) ++n;
  return n;
}

/// A record that is quiet for most of its time: the median is its level.
std::optional<Trigger> PulseSearch::sparse_trigger() const {
  const Spread spread = robust_spread(y_, trace_.valid);
  const double sigma = at_least_a_step(spread.sigma);
  const double peak = height(spread.centre, 0, y_.size());
  if (peak <= gate_ * sigma) return std::nullopt;
  if (trace_.interval * as_double(y_.size()) <= longest_hum) {
    // A part of a period may be flat for most of its time, and then bend.
    const double noise = at_least_a_step(step_noise(y_, trace_.valid));
    if (fast_part(y_, trace_.interval).highest <= std::max(gate_ * noise, 0.1 * peak))
      return std::nullopt;
  }
  return Trigger{spread.centre, std::max(gate_ * sigma, peak_fraction * peak), sigma};
}

/// A record that the pulse fills: quiet at one of its ends at least.
std::optional<Trigger> PulseSearch::dense_trigger() const {
  const std::size_t n = y_.size();
  if (n < 32 || trace_.interval * as_double(n) > longest_hum) return std::nullopt;
  const std::size_t m = std::clamp<std::size_t>(n / 32, 4, 64);
  const double sigma = at_least_a_step(step_noise(y_, trace_.valid));

  std::size_t longest = 0;
  Trigger best;
  double best_peak = 0.0;
  for (const bool from_end : {false, true}) {
    const auto edge = from_end ? y_.last(m) : y_.first(m);
    const double level = median({edge.begin(), edge.end()});
    const double peak = height(level, 0, n);
    const double limit = std::max(gate_ * sigma, peak_fraction * peak);
    const std::size_t run = quiet_run(level, limit, from_end);
    if (run <= longest || run == n) continue;
    longest = run;
    best = {level, limit, sigma};
    best_peak = peak;
  }
  if (longest < std::max<std::size_t>(8, n / 20) || best_peak < dense_height * sigma ||
      explained_by_drift_and_hum(y_, trace_.interval, best_peak, sigma))
    return std::nullopt;
  return best;
}

/// Full width at half of the greatest departure, in samples.
double PulseSearch::width_of_tallest(double level) const {
  const double half = 0.5 * height(level, 0, y_.size());
  const auto above = [&](std::size_t i) { return std::abs(y_[i] - level) > half; };
  const auto tallest =
      std::ranges::max_element(y_, {}, [level](double value) { return std::abs(value - level); });
  const auto top = static_cast<std::size_t>(tallest - y_.begin());
  std::size_t left = top, right = top;
  while (left > 0 && above(left - 1)) --left;
  while (right + 1 < y_.size() && above(right + 1)) ++right;
  return as_double(right - left + 1);
}

/// The course of the last window before sample `end`.
QuietFit PulseSearch::course_before(std::size_t end) const {
  return fit_quiet(y_, end > window_ ? end - window_ : 0, end, 1, grain_, trace_.valid);
}

/// Whether what lies before sample `end` scatters as its last window does. The spread of coarse
/// steps is a whole number of them, one for noise of less than a step too.
bool PulseSearch::is_level(std::size_t end) const {
  return robust_spread(y_.first(end), trace_.marks(0, end)).sigma <
         std::max(1.5 * at_least_a_step(course_before(end).sigma), 1.01 * normal_mad * grain_);
}

/// Whether a record that leaves its first level before sample `crossing` ends at its extreme,
/// level, for longer than it has taken to get there: an amplifier that does not come back from its
/// limit. One that ends nearer zero, and has hardly been at its first level for longer than that,
/// begins within a contact and ends at rest.
bool PulseSearch::ends_on_rail(const Trigger& begin, std::size_t crossing) const {
  constexpr double much = 20.0, near_extreme = 0.95, within = 6.0;
  const std::size_t n = y_.size(), last = std::max(least_quiet, (n - crossing) / 4);
  if (n - crossing < 2 * last) return false;
  const Spread rail = robust_spread(y_.last(last), trace_.marks(n - last, n));
  const double height = std::abs(rail.centre - begin.level);
  const double sigma = at_least_a_step(rail.sigma);
  if (height < near_extreme * this->height(begin.level, 0, n) ||
      height < much * std::max(sigma, begin.sigma))
    return false;
  std::size_t from = n;
  while (from > crossing && std::abs(y_[from - 1] - rail.centre) <= within * sigma) --from;
  const std::size_t way = std::max(least_quiet, from - crossing);
  const bool begins_nearer_zero = std::abs(begin.level) < std::abs(rail.centre);
  return n - from >= way && (begins_nearer_zero || 2 * crossing >= 3 * way);
}

/// Whether a record rests at its end where it begins.
bool PulseSearch::comes_to_rest_at(const Trigger& begin) const {
  constexpr double within = 4.0;
  const std::size_t n = y_.size(), last = std::max(least_quiet, n / 32);
  if (n < 4 * last) return false;
  const Spread end = robust_spread(y_.last(last), trace_.marks(n - last, n));
  const double of_begin = begin.sigma, of_end = at_least_a_step(end.sigma);
  const bool alike = of_end <= within * of_begin && of_begin <= within * of_end;
  return alike && std::abs(end.centre - begin.level) <= within * std::max(of_begin, of_end);
}

/// A force that begins off the level of most of its record, as one whose zero the impact has
/// shifted does: the level of the begin, where it stays for longer than the highest pulse and that
/// is no part of a contact, from which the record departs by no more than the contact is high; or
/// it ends on a rail, or where it begins. None where that is not so.
std::optional<Trigger> PulseSearch::begin_trigger(const Trigger& trigger) const {
  const Spread first = robust_spread(y_.first(least_quiet), trace_.marks(0, least_quiet));
  Trigger begin{.level = first.centre, .sigma = at_least_a_step(first.sigma)};
  const double peak = height(begin.level, 0, y_.size());
  begin.threshold = std::max(gate_ * begin.sigma, peak_fraction * peak);
  const std::size_t crossing = first_above(begin, 0);
  if (crossing < least_quiet || crossing == y_.size() || !is_level(crossing - crossing / 4))
    return std::nullopt;
  const bool comes_back = peak >= stands_out * std::abs(begin.level - trigger.level) &&
                          as_double(crossing) >= width_of_tallest(begin.level);
  const bool known = comes_back || ends_on_rail(begin, crossing) || comes_to_rest_at(begin);
  return known ? std::optional(begin) : std::nullopt;
}

/// The threshold by the noise before the first crossing: ringing afterwards is no noise.
Trigger PulseSearch::sharpened(Trigger trigger) const {
  std::size_t crossing = first_above(trigger, 0);
  if (crossing - crossing / 4 < least_quiet && y_.size() > least_quiet)
    if (const auto begin = begin_trigger(trigger)) {
      trigger = *begin;
      crossing = first_above(trigger, 0);
    }
  const std::size_t end = crossing - crossing / 4;
  if (crossing >= y_.size() || end < least_quiet) return trigger;
  const Spread all = robust_spread(y_.first(end), trace_.marks(0, end));
  trigger.sigma = at_least_a_step(course_before(end).sigma);
  // 2.5 of the spread are above the crest of hum, whose spread is its amplitude.
  const double noise = std::max(gate_ * trigger.sigma, 2.5 * all.sigma);
  // A level stretch before the first crossing is no departure: where contacts take half of the
  // record, its median is not what it rests at.
  const double error = gate_ * 1.25 * trigger.sigma / std::sqrt(as_double(end));  // of a median
  if (is_level(end) && std::abs(all.centre - trigger.level) > error) trigger.level = all.centre;
  trigger.threshold = std::max(noise, peak_fraction * height(trigger.level, 0, y_.size()));
  return trigger;
}

Baseline PulseSearch::baseline_before(std::size_t end, std::size_t floor, const Pulse& pulse,
                                      const Trigger& trigger) const {
  return BaselineSearch(trace_, grain_, window_)
      .before(end, floor, pulse)
      .value_or(Baseline{.constant = trigger.level, .sigma = trigger.sigma});
}

/// Whether the signal wanders by as much as the foot rises that a contact has by the level far
/// before it, and has not by the one near to it: hum or drift, then, not a foot. Told by the means
/// of blocks over as long as the pulse takes, before the foot and what tells the far level.
bool PulseSearch::wanders_like_foot(const Contact& far, const Contact& near, const QuietFit& level,
                                    std::size_t floor, std::size_t length) const {
  constexpr double alike = 0.5;
  constexpr std::size_t blocks = 16, fewest = 4;
  const double foot = near.onset - far.onset;
  if (foot < as_double(window_ / 8)) return false;
  const std::size_t end = std::min(static_cast<std::size_t>(far.onset), level.end);
  const std::size_t size = std::max(length, static_cast<std::size_t>(foot));
  const std::size_t begin = std::max(floor, end > size ? end - size : 0);
  if (end < begin + fewest * blocks || as_double(end - begin) < foot) return false;
  const auto before = y_.subspan(begin, end - begin);
  const auto marks = trace_.marks(begin, end);
  const double noise =
      step_noise(before, marks) / std::sqrt(as_double(end - begin) / as_double(blocks));
  return range_of_means(before, marks, blocks) - 4.0 * noise >
         alike * std::abs(near.baseline - far.baseline);
}

std::optional<Contact> PulseSearch::measure(std::size_t crossing, std::size_t floor,
                                            const Trigger& trigger) const {
  const auto post = static_cast<std::size_t>(options_.after() / trace_.interval);
  const Pulse pulse = tallest(trigger, crossing, post + 1);
  // A quarter is left out at first, since some pulses begin with a long foot, or more where that is
  // level; then, when first touch is known, what lies before it counts.
  const std::size_t far = crossing > floor ? (crossing - floor) / 4 : 0;
  const auto baseline_apart = [&](std::size_t guard) {
    guard = std::max<std::size_t>(3, std::min(far, guard));
    return baseline_before(crossing > guard ? crossing - guard : 0, floor, pulse, trigger);
  };
  const Baseline near = baseline_apart(window_ / 4);
  std::optional<Contact> contact = measure_from(near, crossing, floor, trigger);
  if (pulse.length / 8 > window_ / 4)
    if (const Baseline farther = baseline_apart(pulse.length / 8); farther.steady)
      if (const auto far_off = measure_from(farther, crossing, floor, trigger);
          far_off && !(contact && near.steady &&
                       wanders_like_foot(*far_off, *contact, farther.fit, floor, pulse.length)))
        contact = far_off;
  if (!contact) return std::nullopt;
  // what crossed the threshold first may be a slope that the pulse stands on
  const bool lies_before = contact->onset > as_double(crossing);
  const std::size_t inside = lies_before ? contact->peak_index : crossing;
  Baseline nearer;
  if (const auto quiet = quiet_before(trace_, contact->onset, floor, options_)) {
    nearer = baseline_before(quiet->end, floor, pulse, trigger);
    if (nearer.steady)
      if (const auto second = measure_from(nearer, inside, floor, trigger)) contact = second;
  }
  if (const auto touch = touch_in_vibration(trace_, *contact, crossing, floor, grain_, options_)) {
    const std::size_t end = touch->index > 3 ? touch->index - 3 : 0;
    nearer = baseline_before(end, floor, pulse, trigger);
    if (const auto third =
            measure_from(nearer, touch->top, floor, trigger, as_double(touch->index)))
      return third;
  }
  if (const auto last = measure_from_plateau(*contact, crossing, floor, pulse, trigger))
    return last;
  return contact;
}

/// A contact that begins many times its length before it rises does so on a crest of hum, which a
/// window of many samples takes for a foot: by the level just before it rises, where that is level
/// and hardly above the one before.
std::optional<Contact> PulseSearch::measure_from_plateau(const Contact& contact,
                                                         std::size_t crossing, std::size_t floor,
                                                         const Pulse& pulse,
                                                         const Trigger& trigger) const {
  constexpr std::size_t many = 2, fewest = 16, guard = 3;
  constexpr double hardly = 0.01;  // of the height
  const double before = as_double(crossing) - contact.onset;
  const std::size_t window = std::max(fewest, 2 * pulse.length);
  if (before < as_double(many * pulse.length + window)) return std::nullopt;
  const auto level = BaselineSearch(trace_, grain_, window).before(crossing - guard, floor, pulse);
  if (!level || !level->steady) return std::nullopt;
  const auto found = measure_from(*level, crossing, floor, trigger);
  if (!found || found->onset <= contact.onset) return std::nullopt;
  const bool is_low = std::abs(found->baseline - contact.baseline) < hardly * pulse.height;
  return is_low ? found : std::nullopt;
}

std::optional<Contact> PulseSearch::measure_from(const Baseline& baseline, std::size_t crossing,
                                                 std::size_t floor, const Trigger& trigger,
                                                 std::optional<double> touch) const {
  double noise = gate_ * at_least_a_step(baseline.sigma);
  if (options_.threshold > 0.0) noise = std::min(noise, options_.threshold);
  const Excursion excursion{.y = y_,
                            .baseline = baseline,
                            .stop = std::max(baseline.sigma, 0.5 * grain_),
                            .noise = noise,
                            .floor = floor};
  return measure_pulse(excursion, crossing, trigger.threshold, options_.after() / trace_.interval,
                       touch);
}

/// The greatest departure within [begin, end), in blocks that lie within it.
double PulseSearch::height_by_blocks(double level, std::size_t begin, std::size_t end) const {
  constexpr std::size_t size = 64;
  if (block_heights_.empty())
    for (std::size_t i = 0; i < y_.size(); i += size)
      block_heights_.push_back(height(level, i, i + size));
  double largest = 0.0;
  for (std::size_t b = (begin + size - 1) / size; b < end / size; ++b)
    largest = std::max(largest, block_heights_[b]);
  return largest;
}

/// The first crossing after what belongs to `contact` has died away: later than its window, after
/// a rest, and twice as high as anything within the time of a window before. `floor` becomes the
/// end of what belongs to `contact`.
std::size_t PulseSearch::next_impact(const Contact& contact, const Trigger& trigger,
                                     std::size_t& floor) const {
  const auto rest = static_cast<std::size_t>(std::max(10.0, 2.0 * contact.width));
  const auto post = static_cast<std::size_t>(options_.after() / trace_.interval);
  const auto end = static_cast<std::size_t>(contact.end);
  std::size_t last_above = end;
  for (std::size_t j = first_above(trigger, last_above + 1); j < y_.size();
       j = first_above(trigger, j + 1)) {
    if (j - last_above > rest && j >= static_cast<std::size_t>(contact.onset) + post) {
      const std::size_t from = std::max(end + rest, j > post ? j - post : 0);
      if (height(trigger.level, j, j + rest) >
          stands_out * height_by_blocks(trigger.level, from, j - rest / 2)) {
        floor = last_above + 1;
        return j;
      }
    }
    last_above = j;
  }
  return y_.size();
}

/// Whether a stretch departs from a level by at least this both ways.
bool PulseSearch::swings(double level, double least, std::size_t begin, std::size_t end) const {
  const auto stretch = y_.subspan(begin, end - begin);
  const auto [low, high] = std::ranges::minmax(stretch);
  return high - level >= least && level - low >= least;
}

/// The first crossing; of a bar that vibrates since it was let go, and then touches, that of the
/// contact. A contact pushes one way: what swings both ways alike until the highest pulse begins,
/// and reaches a fifth of it at most, is none.
std::size_t PulseSearch::first_contact(const Trigger& trigger) const {
  constexpr double part = 0.2;   // of the pulse
  constexpr double alike = 0.5;  // of the larger swing, the other
  constexpr double flank = 1.3;  // times the vibration, where the contact is
  const std::size_t crossing = first_above(trigger, 0);
  if (crossing >= y_.size()) return crossing;
  const Pulse pulse = tallest(trigger, crossing, y_.size());
  const double sign = y_[pulse.top] < trigger.level ? -1.0 : 1.0;
  const auto height = [&](std::size_t i) { return sign * (y_[i] - trigger.level); };
  std::size_t rise = pulse.top;
  while (rise > crossing && height(rise) > 0.0) --rise;
  if (rise < crossing + 4) return crossing;
  const double largest = this->height(trigger.level, crossing, rise);
  if (largest > part * pulse.height) return crossing;
  // for as long as it takes, not only where a weak contact rings
  const auto post = static_cast<std::size_t>(options_.after() / trace_.interval);
  const std::size_t parts = std::min<std::size_t>(4, 1 + (rise - crossing) / (post + 1));
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t begin = crossing + (rise - crossing) * k / parts;
    const std::size_t end = crossing + (rise - crossing) * (k + 1) / parts;
    if (!swings(trigger.level, alike * largest, begin, end)) return crossing;
  }
  std::size_t contact = rise;
  while (contact < pulse.top && height(contact) <= flank * largest) ++contact;
  return contact;
}

std::vector<Contact> PulseSearch::run() {
  std::optional<Trigger> trigger = sparse_trigger();
  if (!trigger) trigger = dense_trigger();
  if (options_.threshold > 0.0) {
    if (!trigger) trigger = Trigger{.level = robust_spread(y_, trace_.valid).centre};
    trigger->threshold = options_.threshold;
    trigger->sigma = at_least_a_step(step_noise(y_, trace_.valid));
  } else if (trigger) {
    trigger = sharpened(*trigger);
  }
  std::vector<Contact> contacts;
  if (!trigger) return contacts;
  std::size_t floor = 0;
  std::size_t crossing =
      options_.threshold > 0.0 ? first_above(*trigger, 0) : first_contact(*trigger);
  while (crossing < y_.size()) {
    const auto contact = measure(crossing, floor, *trigger);
    if (contact) {
      contacts.push_back(*contact);
      crossing = next_impact(*contact, *trigger, floor);
    } else {
      while (crossing < y_.size() && std::abs(y_[crossing] - trigger->level) > trigger->threshold)
        ++crossing;
      crossing = first_above(*trigger, crossing);
    }
  }
  return contacts;
}

}  // namespace

std::optional<QuietSpan> quiet_before(const Trace& trace, double onset, std::size_t floor,
                                      const DetectionOptions& options) {
  const double window = std::max(200.0, options.before() / trace.interval);
  const double begin = std::max(std::ceil(onset - window), as_double(floor));
  const double end = std::floor(onset - std::max(3.0, 0.05 * (onset - begin)));
  if (end - begin < 8.0 || end > as_double(trace.values.size())) return std::nullopt;
  return QuietSpan{static_cast<std::size_t>(begin), static_cast<std::size_t>(end)};
}

std::vector<Contact> find_pulses(const Trace& trace, const DetectionOptions& options) {
  if (trace.values.size() < 4) return {};
  const double grain = grain_of(trace.values, trace.valid);
  const std::optional<SteadyDrift> drift = steady_drift(trace, grain);
  if (!drift) return PulseSearch(trace, grain, options).run();
  Trace level = trace;
  for (std::size_t i = 0; i < level.values.size(); ++i) level.values[i] -= drift->at(as_double(i));
  std::vector<Contact> contacts = PulseSearch(level, grain, options).run();
  for (Contact& contact : contacts) contact.baseline += drift->at(contact.onset);
  return contacts;
}

}  // namespace impactrig::acquisition
