// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sampled_curve.hpp"

#include <algorithm>
#include <cmath>

namespace impactrig::datasets {
namespace {

// Samples nearer to a jump than this, in intervals, are left to the jump's own side.
constexpr double next_to_jump = 0.1;
// As near as rounding leaves a sample that is on a jump.
constexpr double on_jump = 1e-6;

/// A few points of a curve; places in intervals.
struct Points {
  std::array<double, 10> place{}, value{};
  std::size_t count = 0;

  void add(double at, double y) {
    place[count] = at;
    value[count++] = y;
  }
};

/// Lagrange's polynomial through `size` points from `first` on, and its slope.
std::array<double, 2> interpolate(const Points& points, std::size_t first, std::size_t size,
                                  double x) {
  double value = 0.0, slope = 0.0;
  for (std::size_t i = first; i < first + size; ++i) {
    double basis = 1.0, change = 0.0;
    for (std::size_t j = first; j < first + size; ++j) {
      if (j == i) continue;
      const double by = 1.0 / (points.place[i] - points.place[j]);
      change = change * (x - points.place[j]) * by + basis * by;
      basis *= (x - points.place[j]) * by;
    }
    value += basis * points.value[i];
    slope += change * points.value[i];
  }
  return {value, slope};
}

/// Through four neighbours at −1, 0, 1, 2.
std::array<double, 2> cubic(const double* at, double s) {
  const double a = at[-1], b = at[0], c = at[1], d = at[2];
  const double c1 = c - a / 3.0 - b / 2.0 - d / 6.0;
  const double c2 = (a + c) / 2.0 - b;
  const double c3 = (d - a) / 6.0 + (b - c) / 2.0;
  return {b + s * (c1 + s * (c2 + s * c3)), c1 + s * (2.0 * c2 + 3.0 * s * c3)};
}

}  // namespace

std::size_t SampledCurve::piece_at(double time) const {
  const auto after = std::ranges::upper_bound(jumps, time, {}, &CurveJump::time);
  return static_cast<std::size_t>(after - jumps.begin());
}

std::array<double, 2> SampledCurve::at(double time) const {
  const double last = static_cast<double>(values.size()) - 1.0;
  const double place = (time - start) / interval;
  if (!(place > 0.0)) return {values.front(), 0.0};
  if (!(place < last)) return {values.back(), 0.0};
  if (!jumps.empty()) return at(time, piece_at(time));
  const auto base = static_cast<std::size_t>(place);
  if (base < 1 || base + 2 >= values.size()) return at(time, 0);
  const auto [value, slope] = cubic(&values[base], place - static_cast<double>(base));
  return {value, slope / interval};
}

std::array<double, 2> SampledCurve::at(double time, std::size_t piece) const {
  const double place = (time - start) / interval;
  const auto place_of = [&](const CurveJump& jump) { return (jump.time - start) / interval; };
  const CurveJump* const from = piece > 0 ? &jumps[piece - 1] : nullptr;
  const CurveJump* const to = piece < jumps.size() ? &jumps[piece] : nullptr;
  const double end = static_cast<double>(values.size()) - 1.0;
  const double first = from ? std::max(0.0, std::ceil(place_of(*from) + next_to_jump)) : 0.0;
  const double last = to ? std::min(end, std::floor(place_of(*to) - next_to_jump)) : end;
  const double base = std::floor(place);
  if (base >= first + 1.0 && base + 2.0 <= last) {
    const auto [value, slope] = cubic(&values[static_cast<std::size_t>(base)], place - base);
    return {value, slope / interval};
  }
  Points points;
  const double low = std::max(first, std::min(base, last) - 3.0);
  const double high = std::min(last, std::max(base, first) + 4.0);
  if (from && low == first) points.add(place_of(*from), from->after);
  for (double k = low; k <= high; ++k) points.add(k, values[static_cast<std::size_t>(k)]);
  if (to && high == last) points.add(place_of(*to), to->before);
  const std::size_t size = std::min<std::size_t>(points.count, 4);
  std::size_t begin = 0;  // with two points to either side of the place where there are
  while (begin + size < points.count && points.place[begin + size / 2] <= place) ++begin;
  const auto [value, slope] = interpolate(points, begin, size, place);
  return {value, slope / interval};
}

void add_missed(SampledCurve& curve, double time, std::size_t value, double integral) {
  const double grace = on_jump * curve.interval;
  const double end = curve.start + curve.interval * static_cast<double>(value);
  double at = end - curve.interval, height = curve.values[value - 1], seen = 0.0;
  const auto between = [&](double t) {
    return t >= end - curve.interval - grace && t < end - grace;
  };
  for (const CurveJump& jump : curve.jumps) {
    if (!between(jump.time)) continue;
    seen += 0.5 * (height + jump.before) * (jump.time - at);
    at = jump.time;
    height = jump.after;
  }
  seen += 0.5 * (height + curve.values[value]) * (end - at);
  for (const CurveSpike& spike : curve.spikes)
    if (between(spike.time)) seen += spike.area;
  const auto place = std::ranges::upper_bound(curve.spikes, time, {}, &CurveSpike::time);
  curve.spikes.insert(place, {time, integral - seen});
}

SampledCurve difference_quotient(const SampledCurve& one, const SampledCurve& other, double span) {
  SampledCurve result = one;
  for (std::size_t k = 0; k < result.values.size(); ++k)
    result.values[k] = (one.values[k] - other.values[k]) / span;
  result.jumps.clear();
  if (one.jumps.size() != other.jumps.size()) return result;
  for (std::size_t k = 0; k < one.jumps.size(); ++k) {
    const CurveJump &a = one.jumps[k], &b = other.jumps[k];
    const double time = 0.5 * (a.time + b.time);
    const auto quotient = [&](std::size_t piece) {
      return (one.at(time, piece)[0] - other.at(time, piece)[0]) / span;
    };
    result.jumps.push_back({time, quotient(k), quotient(k + 1)});
    // samples that the jump passed, or on which it is
    const double places = std::abs(a.time - b.time) / result.interval + 2.0 * on_jump;
    const double first = (std::min(a.time, b.time) - result.start) / result.interval - on_jump;
    for (double sample = std::max(0.0, std::ceil(first));
         sample <= first + places && sample < static_cast<double>(result.values.size()); ++sample) {
      const double at = result.start + sample * result.interval;
      const std::size_t piece = at > time + on_jump * result.interval ? k + 1 : k;
      result.values[static_cast<std::size_t>(sample)] =
          (one.at(at, piece)[0] - other.at(at, piece)[0]) / span;
    }
  }
  return result;
}

}  // namespace impactrig::datasets
