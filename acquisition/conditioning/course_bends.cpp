// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/course_bends.hpp"

#include <algorithm>
#include <cmath>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double longest_width = 0.5e-3;  ///< [s]
constexpr std::size_t enough_samples = 16;
constexpr double shortest_width = 4e-6;  ///< [s], in records of more samples than `many`
constexpr std::size_t many = std::size_t{1} << 18;
constexpr double sharper = 2.0;        ///< than all before
constexpr double fewest_widths = 3.0;  ///< of bends before
constexpr double of_noise = 8.0;       ///< standard deviations
constexpr double of_sharpest = 0.2;    ///< in the record: below it a bend is no touch
constexpr double uniform_noise = 0.3;  ///< grains: the standard deviation of rounding

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

}  // namespace

BendSearch::BendSearch(std::span<const double> values, std::span<const std::uint8_t> valid,
                       double interval, double grain)
    : size_(values.size()),
      sums_(values.size() + 1, 0.0) {
  for (std::size_t i = 0; i < size_; ++i) sums_[i + 1] = sums_[i] + (values[i] - values[0]);
  const double rounding = uniform_noise * grain;
  const double noise = std::max(step_noise(values, valid), rounding);
  for (std::size_t width = 1; 8 * width <= size_; width *= 2) {
    const double time = as_double(width) * interval;
    if (time < shortest_width && size_ / width > many) continue;
    if (time > longest_width && width > enough_samples) break;
    Scale scale{width, std::max<std::size_t>(1, width / 8), 0.0};
    double sharpest = 0.0;
    for (std::size_t i = 2 * width; i + width <= size_; i += scale.stride)
      sharpest = std::max(sharpest, bend(i, width));
    // The squares of 1, -2 and 1 sum up to 6. Rounding does not average out of a quiet signal.
    const double sigma = std::sqrt(6.0) * std::max(noise / std::sqrt(as_double(width)), rounding);
    scale.least = std::max(of_noise * sigma, of_sharpest * sharpest);
    scales_.push_back(scale);
  }
}

double BendSearch::bend(std::size_t index, std::size_t width) const {
  const double second = sums_[index + width] - 3.0 * sums_[index] + 3.0 * sums_[index - width] -
                        sums_[index - 2 * width];
  return std::abs(second) / as_double(width);
}

/// The bends up to one width before are what it has to be sharper than. Those of a sinusoid that
/// the record shows for less than half of a period grow as i from its zero: by 1 + 2 w / L over a
/// width w beyond a stretch L about it.
std::optional<Bend> BendSearch::first_of(const Scale& scale, std::size_t floor,
                                         std::size_t earliest, std::size_t end) const {
  const std::size_t w = scale.width, begin = floor + 2 * w;
  double before = 0.0;
  for (std::size_t past = begin; past + 2 * w <= size_ && past + w < end; past += scale.stride) {
    before = std::max(before, bend(past, w));
    const std::size_t i = past + w;
    const double seen = as_double(past - begin);
    if (i < earliest || seen < fewest_widths * as_double(w)) continue;
    const double here = bend(i, w);
    if (here <= scale.least || here <= sharper * (1.0 + 2.0 * as_double(w) / seen) * before)
      continue;
    std::size_t top = i;
    while (top + scale.stride + w <= size_ && bend(top + scale.stride, w) > bend(top, w))
      top += scale.stride;
    return Bend{top, w};
  }
  return std::nullopt;
}

std::optional<Bend> BendSearch::first(std::size_t floor, std::size_t earliest) const {
  std::optional<Bend> first;
  for (const Scale& scale : scales_) {
    const std::size_t end = first ? first->index + first->width : size_;
    const auto bend = first_of(scale, floor, earliest, end);
    if (bend && (!first || bend->index + bend->width < first->index + first->width)) first = bend;
  }
  return first;
}

}  // namespace impactrig::acquisition
