// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <span>

#include "acquisition/conditioning/contact_search.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double comparison_time = 0.2e-3;  ///< [s] averaged on either side: about one contact
constexpr double jump_fraction = 0.2;  ///< of the largest change: below it nothing is an impact

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

/// The courses on both sides of a change, and how far the signal has gone from one to the other.
struct Change {
  std::span<const double> y;
  QuietFit before, after;
  double size = 0.0;  ///< after minus before, at the middle

  double gone(std::size_t i) const { return (y[i] - before.at(as_double(i))) / size; }

  double left(std::size_t i) const { return (after.at(as_double(i)) - y[i]) / size; }
};

/// The samples a change takes, and the mean step there.
struct Lobe {
  std::size_t begin, end;
  double height;
};

class JumpSearch {
 public:
  JumpSearch(const Trace& trace, const DetectionOptions& options)
      : trace_(trace),
        y_(trace.values),
        options_(options),
        grain_(grain_of(y_)),
        window_(static_cast<std::size_t>(std::max(200.0, options.pre_trigger / trace.interval))) {
    const double n = as_double(y_.size());
    m_ = static_cast<std::size_t>(
        std::clamp(comparison_time / trace.interval, 4.0, std::max(4.0, n / 16.0)));
    steps_ = step_response(y_, m_);
  }

  std::vector<Contact> run();

 private:
  std::optional<double> threshold();
  Lobe lobe_around(std::size_t above) const;
  std::optional<Contact> measure(const Lobe& lobe, std::size_t floor, double least) const;

  const Trace& trace_;
  std::span<const double> y_;
  const DetectionOptions& options_;
  double grain_;
  std::size_t window_;  ///< samples on either side that say what the course is
  std::size_t m_;       ///< samples averaged on either side
  std::vector<double> steps_;
  bool fills_record_ = false;  ///< the change takes most of the record
};

std::optional<double> JumpSearch::threshold() {
  if (options_.threshold > 0.0) return options_.threshold;
  const double gate = noise_gate(y_.size());
  const auto inner = std::span(steps_).subspan(m_, y_.size() - 2 * m_ + 1);
  const Spread spread = robust_spread(inner);
  const double sigma = std::max(spread.sigma, grain_ / std::sqrt(as_double(m_)));
  double highest = 0.0;
  for (const double step : inner) highest = std::max(highest, std::abs(step - spread.centre));
  if (highest > gate * sigma) {
    for (double& step : inner) step -= spread.centre;
    return std::max(gate * sigma, jump_fraction * highest);
  }
  const double noise = std::max(step_noise(y_), 0.75 * grain_);
  const auto [low, high] = std::ranges::minmax(y_);
  if (trace_.interval * as_double(y_.size()) > longest_hum || high - low < 20.0 * noise ||
      explained_by_drift_and_hum(y_, trace_.interval, high - low, noise))
    return std::nullopt;
  fills_record_ = true;
  for (const double step : inner) highest = std::max(highest, std::abs(step));
  return 0.5 * highest;
}

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

std::optional<Contact> JumpSearch::measure(const Lobe& lobe, std::size_t floor,
                                           double least) const {
  const std::size_t from = std::max(floor, lobe.begin > window_ ? lobe.begin - window_ : 0);
  const std::size_t to = std::min(y_.size(), lobe.end + window_);
  if (lobe.begin < from + 8 || to < lobe.end + 8) return std::nullopt;
  Change change{y_, fit_quiet(y_, from, lobe.begin, 1, grain_),
                fit_quiet(y_, lobe.end, to, 1, grain_)};
  const double middle = 0.5 * (as_double(lobe.begin) + as_double(lobe.end));
  change.size = change.after.at(middle) - change.before.at(middle);
  // A dropout goes and comes back: the courses meet again.
  if (std::abs(change.size) < 0.5 * least) return std::nullopt;
  const double scatter = std::max(change.before.sigma, change.after.sigma);
  if (fills_record_ && (20 * std::min(change.before.size(), change.after.size()) < y_.size() ||
                        std::abs(change.size) < 20.0 * scatter))
    return std::nullopt;

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

std::vector<Contact> JumpSearch::run() {
  std::vector<Contact> contacts;
  const auto limit = threshold();
  if (!limit) return contacts;
  const auto post = static_cast<std::size_t>(options_.post_trigger / trace_.interval);
  std::size_t floor = 0, next = 0;
  double vibration = 0.0;  // the highest step since the last impact's window
  for (std::size_t i = m_; i + m_ <= y_.size(); ++i) {
    if (std::abs(steps_[i]) <= *limit) continue;
    const Lobe lobe = lobe_around(i);
    const bool later = contacts.empty() || lobe.begin >= next;
    if (later && std::abs(lobe.height) > 2.0 * vibration) {
      if (const auto contact = measure(lobe, floor, *limit)) {
        contacts.push_back(*contact);
        floor = static_cast<std::size_t>(contact->end) + 1;
        next = static_cast<std::size_t>(contact->onset) + post;
      }
    }
    if (!contacts.empty()) vibration = later ? 0.0 : std::max(vibration, std::abs(lobe.height));
    i = std::max(lobe.end, i);
  }
  return contacts;
}

}  // namespace

std::vector<Contact> find_jumps(const Trace& trace, const DetectionOptions& options) {
  if (trace.values.size() < 32) return {};
  return JumpSearch(trace, options).run();
}

}  // namespace impactrig::acquisition
