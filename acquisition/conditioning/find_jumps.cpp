// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/course_bends.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double comparison_time = 0.2e-3;   ///< [s] averaged on either side: about one contact
constexpr double longest_dropout = 300e-6;   ///< [s], as the conditioning step has it
constexpr double on_course = 5.0;            ///< standard deviations
constexpr double beyond_scatter = 1.5;       ///< of a lasting change; a linear fall has 1.7
constexpr std::size_t least_return = 16;     ///< samples
constexpr std::size_t fewest_samples = 8;    ///< that say what a course is
constexpr std::size_t fewest_of_slow = 256;  ///< means of samples, of a slow contact's record

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// Mean of the m samples from i on minus mean of the m samples before i; 0 where they do not fit.
std::vector<double> step_response(std::span<const double> y, std::size_t m) {
  std::vector<double> steps(y.size(), 0.0);
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < m; ++i) {
    before += y[i] - y[0];
    after += y[i + m] - y[0];
  }
  for (std::size_t i = m; i + m <= y.size(); ++i) {
    steps[i] = (after - before) / as_double(m);
    if (i + m == y.size()) break;
    before += y[i] - y[i - m];
    after += y[i + m] - y[i];
  }
  return steps;
}

/// The samples a change takes, and the mean step there.
struct Lobe {
  std::size_t begin, end;
  double height;
};

/// The courses on both sides of a change, and how far the signal has gone from one to the other.
struct Change {
  std::span<const double> y;
  QuietFit before, after;
  double size = 0.0;  ///< after minus before, at the middle

  void between(const Lobe& lobe, const QuietFit& then) {
    const double middle = 0.5 * (as_double(lobe.begin) + as_double(lobe.end));
    after = then;
    size = after.at(middle) - before.at(middle);
  }

  double gone(std::size_t i) const { return (y[i] - before.at(as_double(i))) / size; }

  double left(std::size_t i) const { return (after.at(as_double(i)) - y[i]) / size; }
};

class JumpSearch {
 public:
  JumpSearch(const Trace& trace, const DetectionOptions& options)
      : trace_(trace),
        y_(trace.values),
        options_(options),
        grain_(grain_of(y_, trace.valid)),
        window_(static_cast<std::size_t>(std::max(200.0, options.before() / trace.interval))),
        post_(static_cast<std::size_t>(options.after() / trace.interval)) {
    const double n = as_double(y_.size());
    m_ = static_cast<std::size_t>(
        std::clamp(comparison_time / trace.interval, 4.0, std::max(4.0, n / 16.0)));
    steps_ = step_response(y_, m_);
  }

  std::vector<Contact> run() const {
    if (options_.threshold > 0.0) return above(options_.threshold);
    std::vector<Contact> contacts = at_bends();
    if (contacts.empty())
      if (const auto contact = filling()) contacts.push_back(*contact);
    return contacts;
  }

  std::vector<Contact> at_bends() const;

 private:
  std::vector<Contact> above(double threshold) const;
  std::optional<Contact> filling() const;
  std::optional<Contact> at(const Bend& bend, std::size_t floor) const;
  std::optional<std::size_t> returns(const Bend& bend, std::size_t floor) const;
  QuietFit course_before(std::size_t end, std::size_t floor) const;
  QuietFit lasting_after(std::size_t begin, std::size_t change) const;
  Lobe lobe_around(std::size_t above) const;
  Contact measure(const Lobe& lobe, const Change& change, std::size_t floor) const;

  const Trace& trace_;
  std::span<const double> y_;
  const DetectionOptions& options_;
  double grain_;
  std::size_t window_;  ///< samples on either side that say what the course is
  std::size_t post_;    ///< samples that belong to an impact after its touch
  std::size_t m_;       ///< samples averaged on either side
  std::vector<double> steps_;
};

/// From the highest step near `above` both ways to where the steps are below 5 % of it.
Lobe JumpSearch::lobe_around(std::size_t above) const {
  std::size_t top = above;
  for (std::size_t i = above; i < std::min(y_.size(), above + 2 * m_); ++i)
    if (std::abs(steps_[i]) > std::abs(steps_[top])) top = i;
  const double low = 0.05 * std::abs(steps_[top]);
  const auto belongs = [&](std::size_t i) {
    return steps_[i] * steps_[top] > low * std::abs(steps_[top]);
  };
  Lobe lobe{top, top, steps_[top]};
  while (lobe.begin > 0 && belongs(lobe.begin - 1)) --lobe.begin;
  while (lobe.end + 1 < y_.size() && belongs(lobe.end + 1)) ++lobe.end;
  return lobe;
}

/// Index, between samples, where a rising course first passes `part` on the way from `from` to
/// `to`.
template <typename Course>
double passing(const Course& course, double part, std::size_t from, std::size_t to) {
  for (std::size_t i = from; i < to; ++i) {
    const double a = course(i), b = course(i + 1);
    if (a <= part && b > part) return as_double(i) + (part - a) / (b - a);
  }
  return as_double(to);
}

QuietFit JumpSearch::course_before(std::size_t end, std::size_t floor) const {
  return fit_quiet(y_, std::max(floor, end > window_ ? end - window_ : 0), end, 1, grain_,
                   trace_.valid);
}

/// The mean of what an impact leaves behind that changes the signal for so many samples, and how
/// far a struck bar's vibration scatters about it.
QuietFit JumpSearch::lasting_after(std::size_t begin, std::size_t change) const {
  QuietFit after;
  after.begin = begin;
  after.end = std::min(y_.size(), begin + std::max({window_, post_, 3 * change}));
  const auto part = y_.subspan(begin, after.size());
  after.mean = std::accumulate(part.begin(), part.end(), 0.0) / as_double(part.size());
  after.coefficients[0] = after.mean;
  double squares = 0.0;
  for (const double value : part) squares += (value - after.mean) * (value - after.mean);
  after.sigma = std::sqrt(squares / as_double(part.size()));
  return after;
}

Contact JumpSearch::measure(const Lobe& lobe, const Change& change, std::size_t floor) const {
  const std::size_t from = std::max(floor, change.before.begin), to = change.after.end;
  const auto gone = [&](std::size_t i) { return change.gone(i); };
  const auto arriving = [&](std::size_t i) { return -change.left(i); };
  const double begun = std::max(change.before.sigma, 0.5 * grain_) / std::abs(change.size);
  const double arrived = -std::max(change.after.sigma, 0.5 * grain_) / std::abs(change.size);
  std::size_t half = lobe.begin;
  while (half + 1 < lobe.end && gone(half) < 0.5) ++half;
  std::size_t first = half, last = half;
  while (first > from && gone(first) > begun) --first;
  while (last + 1 < to && arriving(last) < arrived) ++last;

  Contact contact;
  contact.onset = passing(gone, begun, first, half);
  contact.end = passing(arriving, arrived, half, last);
  contact.peak_index = half;
  contact.peak = change.size;
  const double quarter = passing(gone, 0.25, first, last);
  const double three_quarters = passing(gone, 0.75, static_cast<std::size_t>(quarter), last);
  contact.width = 2.0 * (three_quarters - quarter);
  contact.baseline = change.before.at(contact.onset);
  for (auto i = static_cast<std::size_t>(std::ceil(contact.onset)); as_double(i) + 1 <= contact.end;
       ++i)
    contact.impulse += 0.5 * (y_[i] + y_[i + 1]);
  return contact;
}

/// Whether the signal comes back to its course before as a laser does that has lost its light:
/// soon, and for as long as it was away. Returns where.
std::optional<std::size_t> JumpSearch::returns(const Bend& bend, std::size_t floor) const {
  const std::size_t begin = bend.index - 2 * bend.width;
  if (begin < floor + fewest_samples) return std::nullopt;
  const QuietFit before = course_before(begin, floor);
  const double band = on_course * std::max(before.sigma, 0.5 * grain_);
  const auto is_on = [&](std::size_t i) {
    return std::abs(y_[i] - before.at(as_double(i))) <= band;
  };
  std::size_t left = begin;
  while (left < std::min(y_.size(), bend.index + bend.width) && is_on(left)) ++left;
  const auto longest = static_cast<std::size_t>(longest_dropout / trace_.interval);
  std::size_t back = left;
  for (std::size_t i = left; i < y_.size() && back <= left + longest; ++i) {
    if (!is_on(i)) back = i + 1;
    if (back > left && i + 1 - back >= std::max({least_return, back - left, 2 * bend.width}))
      return back;
  }
  return std::nullopt;
}

/// The lasting change that begins at a bend: its mean is off the course before by more than it
/// scatters, which a vibration's is not that begins or grows there.
std::optional<Contact> JumpSearch::at(const Bend& bend, std::size_t floor) const {
  const std::size_t begin = bend.index - 2 * bend.width;
  if (begin < floor + fewest_samples) return std::nullopt;
  Lobe lobe = lobe_around(std::max(m_, begin));
  lobe.begin = begin;
  const std::size_t to = std::min(y_.size(), lobe.end + window_);
  if (lobe.end <= lobe.begin || to < lobe.end + fewest_samples) return std::nullopt;
  Change change{y_, course_before(begin, floor), lasting_after(bend.index, lobe.end - lobe.begin)};
  const double lasting = change.after.mean - change.before.mean;
  if (std::abs(lasting) <= beyond_scatter * change.after.sigma) return std::nullopt;
  change.between(lobe, fit_quiet(y_, lobe.end, to, 1, grain_, trace_.valid));
  const auto agrees = [&] {
    const double ratio = change.size / lasting;
    return ratio > 0.5 && ratio < 2.5;
  };
  if (!agrees()) change.between(lobe, lasting_after(lobe.end, 0));
  if (!agrees()) return std::nullopt;
  return measure(lobe, change, floor);
}

std::vector<Contact> JumpSearch::at_bends() const {
  const BendSearch bends(y_, trace_.valid, trace_.interval, grain_);
  std::vector<Contact> contacts;
  std::size_t floor = 0, earliest = 0;
  while (const auto bend = bends.first(floor, earliest)) {
    if (const auto back = returns(*bend, floor)) {
      floor = earliest = *back;
    } else if (const auto contact = at(*bend, floor)) {
      contacts.push_back(*contact);
      floor = static_cast<std::size_t>(contact->end) + 1;
      earliest = std::max(floor, static_cast<std::size_t>(contact->onset) + post_);
    } else {
      earliest = bend->index + bend->width;
    }
  }
  return contacts;
}

/// The one change of a record that is too short to show what the course is before: it takes most of
/// the time, between two courses of which it is 20 times the scatter.
std::optional<Contact> JumpSearch::filling() const {
  constexpr double height = 20.0;  // standard deviations
  const double noise = std::max(step_noise(y_, trace_.valid), 0.75 * grain_);
  const auto [low, high] = std::ranges::minmax(y_);
  if (trace_.interval * as_double(y_.size()) > longest_hum || high - low < height * noise ||
      explained_by_drift_and_hum(y_, trace_.interval, high - low, noise))
    return std::nullopt;
  const auto steepest = std::ranges::max_element(
      steps_, [](double a, double b) { return std::abs(a) < std::abs(b); });
  const Lobe lobe = lobe_around(static_cast<std::size_t>(steepest - steps_.begin()));
  const std::size_t to = std::min(y_.size(), lobe.end + window_);
  if (lobe.begin < fewest_samples || lobe.begin > window_ || to < lobe.end + fewest_samples)
    return std::nullopt;
  Change change{y_, course_before(lobe.begin, 0), {}};
  change.between(lobe, fit_quiet(y_, lobe.end, to, 1, grain_, trace_.valid));
  const double scatter = std::max(change.before.sigma, change.after.sigma);
  if (20 * std::min(change.before.size(), change.after.size()) < y_.size() ||
      scatter > 1.25 * noise || std::abs(change.size) < height * scatter)
    return std::nullopt;
  const Contact contact = measure(lobe, change, 0);
  return contact.width > 0.0 ? std::optional(contact) : std::nullopt;  // it passes its quarters
}

std::vector<Contact> JumpSearch::above(double threshold) const {
  std::vector<Contact> contacts;
  std::size_t floor = 0, next = 0;
  double vibration = 0.0;  // the highest step since the last impact's window
  for (std::size_t i = m_; i + m_ <= y_.size(); ++i) {
    if (std::abs(steps_[i]) <= threshold) continue;
    const Lobe lobe = lobe_around(i);
    const bool later = contacts.empty() || lobe.begin >= next;
    const std::size_t to = std::min(y_.size(), lobe.end + window_);
    if (later && std::abs(lobe.height) > 2.0 * vibration && lobe.begin >= floor + fewest_samples &&
        to >= lobe.end + fewest_samples) {
      Change change{y_, course_before(lobe.begin, floor), {}};
      change.between(lobe, fit_quiet(y_, lobe.end, to, 1, grain_, trace_.valid));
      // A dropout goes and comes back: the courses meet again.
      if (std::abs(change.size) >= 0.5 * threshold) {
        contacts.push_back(measure(lobe, change, floor));
        floor = static_cast<std::size_t>(contacts.back().end) + 1;
        next = static_cast<std::size_t>(contacts.back().onset) + post_;
      }
    }
    if (!contacts.empty()) vibration = later ? 0.0 : std::max(vibration, std::abs(lobe.height));
    i = std::max(lobe.end, i);
  }
  return contacts;
}

/// As if time ran so many times as fast: means of that many samples, as far apart as these were.
Trace sped_up(const Trace& trace, std::size_t times) {
  Trace fast;
  fast.quantity = trace.quantity;
  fast.start = trace.start;
  fast.interval = trace.interval;
  const std::size_t n = trace.values.size() / times;
  for (std::size_t i = 0; i < n; ++i) {
    const auto block = std::span(trace.values).subspan(i * times, times);
    fast.values.push_back(std::accumulate(block.begin(), block.end(), 0.0) / as_double(times));
    if (trace.valid.empty()) continue;
    const auto marks = trace.marks(i * times, (i + 1) * times);
    fast.valid.push_back(std::ranges::find(marks, 0) == marks.end() ? 1 : 0);
  }
  return fast;
}

/// A contact found in that, as the trace has it.
Contact slowed_down(Contact contact, std::size_t times) {
  const double k = as_double(times), middle = 0.5 * (k - 1.0);
  contact.onset = k * contact.onset + middle;
  contact.end = k * contact.end + middle;
  contact.peak_index = times * contact.peak_index + times / 2;
  contact.width *= k;
  contact.impulse *= k;
  return contact;
}

/// What is let go begins to move as sharply as a soft stop slows it down. What meets a stop moves,
/// and loses all of it or more, less than twice as much.
bool is_slowed_down(const Contact& contact) {
  constexpr double least = 0.3;  // of the change
  return contact.baseline * contact.peak < 0.0 &&
         std::abs(contact.baseline) > least * std::abs(contact.peak);
}

/// What changes the signal for longer than any hard contact: a soft stop takes tens of
/// milliseconds, and what is a bend within a tenth of a second is as sharp as one within a
/// thousandth.
std::vector<Contact> find_slow_jumps(const Trace& trace, const DetectionOptions& options) {
  for (const std::size_t times : {4UL, 16UL}) {
    if (trace.values.size() / times < fewest_of_slow) break;
    const Trace fast = sped_up(trace, times);
    std::vector<Contact> found;
    for (const Contact& contact : JumpSearch(fast, options).at_bends())
      if (is_slowed_down(contact)) found.push_back(slowed_down(contact, times));
    if (!found.empty()) return found;
  }
  return {};
}

}  // namespace

std::vector<Contact> find_jumps(const Trace& trace, const DetectionOptions& options) {
  if (trace.values.size() < 32) return {};
  std::vector<Contact> contacts = JumpSearch(trace, options).run();
  if (contacts.empty() && options.threshold == 0.0) contacts = find_slow_jumps(trace, options);
  return contacts;
}

}  // namespace impactrig::acquisition
