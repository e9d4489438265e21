// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/measure_pulse.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// Zero of the line through two samples at x and x + 1 (x + 1 the further one from the crossing),
/// at most one sample beyond `near`, the last sample on the baseline.
double extrapolated_onset(const Excursion& z, std::size_t near) {
  const double a = z.at(near + 1);
  const double b = near + 2 < z.y.size() ? z.at(near + 2) : a;
  const double rest = z.at(near);
  if (b > a && rest >= -z.stop)
    return std::clamp(as_double(near + 1) - a / (b - a), as_double(near) - 1.0,
                      as_double(near + 1));
  return as_double(near) + std::clamp(-rest / (a - rest), 0.0, 1.0);
}

double extrapolated_end(const Excursion& z, std::size_t near) {
  const double a = z.at(near - 1);
  const double b = near >= 2 ? z.at(near - 2) : a;
  const double rest = z.at(near);
  if (b > a && rest >= -z.stop)
    return std::clamp(as_double(near - 1) + a / (b - a), as_double(near - 1),
                      as_double(near) + 1.0);
  return as_double(near) - std::clamp(-rest / (a - rest), 0.0, 1.0);
}

/// Whether the signal is on its baseline from sample j on, not one of its samples alone: noise
/// falls to it from a slow flank.
bool rests(const Excursion& z, std::size_t j) {
  constexpr std::size_t some = 8;
  constexpr double near = 1.5;
  const std::size_t end = std::min(j + some, z.y.size());
  double sum = 0.0;
  for (std::size_t i = j; i < end; ++i) sum += z.at(i);
  return sum <= near * z.stop * as_double(end - j);
}

/// Follows the pulse from `crossing` to where it comes back to its baseline, or has stayed below
/// the threshold of its own peak for 10 samples and half of its length.
struct Descent {
  std::size_t peak_index, stop_index;
  double peak, end;
  bool ends_inside;
};

Descent follow(const Excursion& z, std::size_t crossing) {
  Descent d{crossing, crossing, 0.0, as_double(z.y.size() - 1), true};
  std::size_t last_above = crossing;
  for (std::size_t j = crossing; j < z.y.size(); ++j) {
    const double value = z.at(j);
    if (value > d.peak) {
      d.peak = value;
      d.peak_index = j;
    }
    d.stop_index = j;
    if (value > z.lasting(d.peak)) last_above = j;
    if (value <= z.stop && j > crossing && (d.peak > 1.5 * z.noise || rests(z, j))) {
      d.end = extrapolated_end(z, j);
      d.ends_inside = false;
      break;
    }
    if (j - last_above > 10 + (last_above - crossing) / 2) {
      d.end = as_double(last_above) + 1.0;
      d.ends_inside = false;
      break;
    }
  }
  return d;
}

/// Of a pulse that does not come back to its baseline: where it comes to rest beside it, as a force
/// does whose zero the impact has shifted. The second half of what lies behind the peak is level,
/// to 2 % of the peak and below half of it, and there for longer than the pulse takes.
std::optional<std::size_t> rest_beside(const Excursion& z, std::size_t crossing, const Descent& d) {
  constexpr std::size_t fewest = 32;
  constexpr double level = 0.02, low = 0.5;
  const std::size_t n = z.y.size(), half = d.peak_index + (n - d.peak_index) / 2;
  if (n - half < fewest) return std::nullopt;
  std::vector<double> tail;
  for (std::size_t i = half; i < n; ++i) tail.push_back(z.at(i));
  const QuietFit rest = fit_quiet(tail, 0, tail.size(), 1, 2.0 * z.stop);
  if (2.0 * std::abs(rest.coefficients[1]) > level * d.peak || rest.mean > low * d.peak)
    return std::nullopt;
  std::size_t begin = d.peak_index;
  while (begin < half && z.at(begin) > rest.mean + z.stop) ++begin;
  if (n - begin < begin - crossing) return std::nullopt;
  return begin;
}

/// Filters ring before a pulse too: where the first lobe is followed at once by one of the other
/// sign and five times its height, that one is the pulse. Returns where it crosses the threshold.
std::optional<std::size_t> main_lobe_after(const Excursion& z, std::size_t crossing,
                                           const Descent& first, double threshold) {
  const std::size_t limit =
      std::min(z.y.size(), first.stop_index + (first.stop_index - crossing) + 5);
  for (std::size_t j = first.stop_index; j < limit; ++j) {
    if (-z.at(j) <= threshold) continue;
    double opposite = 0.0;
    for (std::size_t k = j; k < z.y.size() && z.at(k) < 0.0; ++k)
      opposite = std::max(opposite, -z.at(k));
    if (opposite > 5.0 * first.peak) return j;
    break;
  }
  return std::nullopt;
}

/// Full width at half of the peak, in samples.
double half_width(const Excursion& z, const Descent& d) {
  const double half = 0.5 * d.peak;
  const auto crossing = [&](std::size_t above, std::size_t below) {
    const double a = z.at(above), b = z.at(below);
    return as_double(above) + (as_double(below) - as_double(above)) * (a - half) / (a - b);
  };
  std::size_t left = d.peak_index, right = d.peak_index;
  while (left > z.floor && z.at(left) > half) --left;
  while (right + 1 < z.y.size() && z.at(right) > half) ++right;
  const double from = z.at(left) <= half ? crossing(left + 1, left) : as_double(left);
  const double to = z.at(right) <= half ? crossing(right - 1, right) : as_double(right);
  return to - from;
}

/// Integral between two fractional indices by the trapezoidal rule; the signal is 0 at both unless
/// they are samples.
double integral(const Excursion& z, double from, double to) {
  const auto first = static_cast<std::size_t>(std::ceil(from));
  const auto last = static_cast<std::size_t>(std::floor(to));
  if (last < first) return 0.0;
  double sum =
      0.5 * (z.at(first) * (as_double(first) - from) + z.at(last) * (to - as_double(last)));
  for (std::size_t i = first; i < last; ++i) sum += 0.5 * (z.at(i) + z.at(i + 1));
  return sum;
}

struct FurtherHits {
  int count = 0;
  double end = 0.0;  ///< of the last one, or of the first contact; in samples
};

/// Later pulses of the same sign that ringing cannot be, before sample `limit`: each is more than
/// twice what the signal swings the other way before and right after it, and no single sample.
FurtherHits further_hits(const Excursion& z, const Contact& contact, const Descent& d,
                         std::size_t limit) {
  const double threshold = z.threshold(d.peak);
  const double rest = std::max(5.0, 0.05 * contact.width);
  const double least = std::max(1.0, 0.05 * contact.width);  // samples above the threshold
  limit = std::min(limit, z.y.size());
  FurtherHits hits{0, contact.end};
  double other_way = 0.0;
  std::size_t last_above = d.stop_index;
  for (std::size_t j = d.stop_index; j < limit; ++j) {
    const double value = z.at(j);
    other_way = std::max(other_way, -value);
    if (value <= threshold) continue;
    const bool rested = as_double(j - last_above) > rest;
    const std::size_t begin = j;
    double lobe = 0.0;
    std::size_t above = 0, longest = 0, end = j;
    for (; j < z.y.size() && z.at(j) > z.stop; ++j) {
      lobe = std::max(lobe, z.at(j));
      above = z.at(j) > threshold ? above + 1 : 0;
      longest = std::max(longest, above);
      if (above > 0) end = j + 1;
    }
    last_above = j;
    for (std::size_t k = j; k < std::min(z.y.size(), j + (j - begin)); ++k)
      other_way = std::max(other_way, -z.at(k));
    if (rested && as_double(longest) >= least && lobe > stands_out * other_way)
      hits = {hits.count + 1, as_double(end)};
  }
  return hits;
}

}  // namespace

std::optional<Contact> measure_pulse(Excursion z, std::size_t crossing, double threshold,
                                     double post, std::optional<double> touch) {
  if (z.at(crossing) < 0.0) z.sign = -1.0;
  if (z.at(crossing) <= z.stop) return std::nullopt;

  Descent d = follow(z, crossing);
  if (const auto later = main_lobe_after(z, crossing, d, threshold)) {
    crossing = *later;
    z.sign = -z.sign;
    d = follow(z, crossing);
  }
  if (d.ends_inside)
    if (const auto rest = rest_beside(z, crossing, d)) {
      d.end = as_double(*rest);
      d.stop_index = *rest;
      d.ends_inside = false;
    }

  if (d.peak <= threshold) return std::nullopt;  // hum lifted noise over the threshold

  Contact contact;
  std::size_t i = crossing;
  for (; i > z.floor && z.at(i) > z.stop; --i) {
    if (z.at(i) <= d.peak) continue;
    d.peak = z.at(i);
    d.peak_index = i;
  }
  const bool reached = z.at(i) <= z.stop;
  contact.onset = reached ? extrapolated_onset(z, i) : as_double(i);
  contact.onset = std::max(touch.value_or(contact.onset), 0.0);
  contact.begins_inside = !reached && i == 0 && z.at(0) > z.threshold(d.peak);
  contact.end = std::min(d.end, as_double(z.y.size() - 1));
  contact.ends_inside = d.ends_inside;
  contact.peak_index = d.peak_index;
  contact.peak = z.sign * d.peak;
  contact.width = half_width(z, d);
  contact.impulse = z.sign * integral(z, contact.onset, contact.end);
  contact.baseline = z.baseline.at(static_cast<std::size_t>(contact.onset));
  const FurtherHits further =
      further_hits(z, contact, d, static_cast<std::size_t>(contact.onset + post) + 1);
  contact.further_hits = further.count;
  contact.last_end = further.end;
  return contact;
}

}  // namespace impactrig::acquisition
