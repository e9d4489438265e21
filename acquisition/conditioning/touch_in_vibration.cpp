// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/touch_in_vibration.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/course_bends.hpp"

namespace impactrig::acquisition {

namespace {

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// The flank a pulse begins with: where it passes a part of its peak, and its first top.
struct Flank {
  std::size_t rise, top;
};

Flank first_flank(std::span<const double> y, const Contact& contact, std::size_t crossing) {
  constexpr double part = 0.3;  // of the peak
  const double sign = contact.peak < 0.0 ? -1.0 : 1.0;
  const auto height = [&](std::size_t i) { return sign * (y[i] - contact.baseline); };
  Flank flank{crossing, crossing};
  while (flank.rise < contact.peak_index && height(flank.rise) <= part * std::abs(contact.peak))
    ++flank.rise;
  flank.top = flank.rise;
  for (std::size_t i = flank.rise; i < y.size() && height(i) > 0.5 * height(flank.top); ++i)
    if (height(i) > height(flank.top)) flank.top = i;
  return flank;
}

/// From the highest value so far down to a later one.
double largest_fall(std::span<const double> y, double sign) {
  double top = -INFINITY, fall = 0.0;
  for (const double value : y) {
    top = std::max(top, sign * value);
    fall = std::max(fall, top - sign * value);
  }
  return fall;
}

/// From the bend back to the line through what is just before it.
std::optional<std::size_t> traced_back(std::span<const double> y,
                                       std::span<const std::uint8_t> valid, const Bend& bend,
                                       double sign, double noise, double grain) {
  constexpr double leaves = 3.0;  // standard deviations
  const std::size_t end = bend.index - bend.width;
  const std::size_t size = std::max<std::size_t>(8, 3 * bend.width);
  if (end < size) return std::nullopt;
  const QuietFit before = fit_quiet(y, end - size, end, 1, grain, valid);
  const double band = leaves * std::max(before.sigma, noise);
  std::size_t i = std::min(y.size() - 1, bend.index + bend.width);
  while (i > end && sign * (y[i] - before.at(as_double(i))) > band) --i;
  return i + 1 < y.size() ? std::optional(i) : std::nullopt;
}

}  // namespace

std::optional<Touch> touch_in_vibration(const Trace& force, const Contact& contact,
                                        std::size_t crossing, std::size_t floor, double grain,
                                        const DetectionOptions& options) {
  constexpr double vibrates = 2.0;  // standard deviations
  constexpr double falls = 9.0;     // of noise on a slope, between two of many samples
  constexpr double matters = 0.01;  // of the peak
  const std::span<const double> y(force.values);
  const Flank flank = first_flank(y, contact, crossing);
  const auto window = static_cast<std::size_t>(std::max(200.0, options.before() / force.interval));
  const std::size_t begin = std::max(floor, flank.rise > window ? flank.rise - window : 0);
  if (flank.rise < begin + 16) return std::nullopt;
  const auto traced = static_cast<std::size_t>(contact.onset);
  const auto line_before = [&](std::size_t end, std::size_t size) {
    const std::size_t first = std::max(floor, end > size ? end - size : 0);
    return fit_quiet(y, first, end, 1, grain, force.valid);
  };
  const auto before = y.subspan(begin, flank.rise - begin);
  const double noise = std::max(step_noise(before, force.marks(begin, flank.rise)), 0.75 * grain);
  const double least = std::max(vibrates * noise, matters * std::abs(contact.peak));
  if (line_before(flank.rise, window).sigma < least) return std::nullopt;
  const double sign = contact.peak < 0.0 ? -1.0 : 1.0;
  if (traced < flank.rise && traced >= floor + 16) {
    const std::size_t foot = flank.rise - traced;
    const bool rises = largest_fall(y.subspan(traced, foot), sign) < falls * noise;
    const QuietFit level = line_before(traced, std::max(window, foot));
    const double slope = std::abs(level.coefficients[1]) / level.half * as_double(foot);
    // the slow foot of a pulse rises all the way behind a level, and is no vibration
    if (rises && level.sigma < least && slope < least) return std::nullopt;
  }
  const auto course = y.subspan(begin, flank.top + 1 - begin);
  const auto marks = force.marks(begin, flank.top + 1);
  const auto bend = BendSearch(course, marks, force.interval, grain)
                        .first(0, traced > begin ? traced - begin : 0);
  if (!bend) return std::nullopt;
  const auto last = traced_back(course, marks, *bend, sign, noise, grain);
  return last ? std::optional(Touch{begin + *last, flank.top}) : std::nullopt;
}

}  // namespace impactrig::acquisition
