// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/glitches.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::size_t longest = 3, longest_square = 16, neighbours = 6;
constexpr double square = 0.7;                   ///< of the largest departure, the least
constexpr double longest_of_one_value = 300e-6;  ///< [s]
constexpr double at_once = 12.0;                 ///< of what the neighbours let expect
constexpr double of_height = 0.1;

/// What stands on both sides of samples [begin, end).
class Surroundings {
 public:
  Surroundings(const Trace& trace, std::size_t begin, std::size_t end, double rest) {
    const std::vector<double>& y = trace.values;
    if (begin < neighbours || end + neighbours > y.size()) return;
    lowest_ = INFINITY;
    for (std::size_t k = 0; k < neighbours; ++k)
      for (const std::size_t i : {begin - 1 - k, end + k}) {
        if (!trace.is_valid(i)) return;
        lowest_ = std::min(lowest_, std::abs(y[i] - rest));
        highest_ = std::max(highest_, std::abs(y[i] - rest));
      }
    for (std::size_t k = 1; k + 1 < neighbours; ++k)
      for (const std::size_t i : {begin - 1 - k, end + k})
        bend_ = std::max(bend_, std::abs(y[i - 1] - 2.0 * y[i] + y[i + 1]));
    known_ = true;
    std::tie(lower_, upper_) = std::minmax(y[begin - 1], y[end]);
  }

  bool known() const { return known_; }

  double lowest() const { return lowest_; }

  double highest() const { return highest_; }

  double bend() const { return bend_; }

  /// How far a value is from between the nearest two.
  double apart(double value) const { return std::max(value - upper_, lower_ - value); }

 private:
  bool known_ = false;
  double lowest_ = 0.0, highest_ = 0.0, bend_ = 0.0, lower_ = 0.0, upper_ = 0.0;
};

/// Whether all samples [begin, begin + count) depart from their surroundings by more than `least`.
bool depart(const std::vector<double>& y, std::size_t begin, std::size_t count,
            const Surroundings& around, double least) {
  for (std::size_t i = begin; i < begin + count; ++i)
    if (around.apart(y[i]) <= least) return false;
  return true;
}

/// Whether they are off the line between their neighbours by much the same.
bool are_shifted(const std::vector<double>& y, std::size_t begin, std::size_t count) {
  const double from = y[begin - 1],
               slope = (y[begin + count] - from) / static_cast<double>(count + 1);
  double lowest = INFINITY, highest = -INFINITY;
  for (std::size_t k = 0; k < count; ++k) {
    const double off = y[begin + k] - from - slope * static_cast<double>(k + 1);
    lowest = std::min(lowest, off);
    highest = std::max(highest, off);
  }
  return lowest > 0.0 ? lowest > square * highest : highest < square * lowest;
}

/// How many samples from one on have its value; 0 of more than a recorder loses.
std::size_t equal_from(const Trace& trace, std::size_t i) {
  const auto size = static_cast<double>(trace.values.size());
  const auto most = static_cast<std::size_t>(std::min(longest_of_one_value / trace.interval, size));
  std::size_t count = 1;
  while (i + count < trace.values.size() && trace.values[i + count] == trace.values[i]) ++count;
  return count <= most ? count : 0;
}

}  // namespace

std::vector<std::size_t> find_glitches(const Trace& trace, double quantum) {
  const std::vector<double>& y = trace.values;
  std::vector<std::size_t> found;
  if (y.size() < 4 * neighbours) return found;
  const double rest = robust_spread(y, trace.valid).centre;
  const double noise = std::max(step_noise(y, trace.valid), 0.75 * quantum);
  for (std::size_t i = neighbours; i + neighbours < y.size(); ++i) {
    // most samples bend as their neighbours do
    const double bend = std::abs(y[i - 2] - 2.0 * y[i - 1] + y[i]);
    if (bend <= at_once * noise || bend <= 0.5 * of_height * std::abs(y[i - 1] - rest)) continue;
    const std::size_t same = equal_from(trace, i);
    for (std::size_t count = 1; count <= std::max(longest_square, same); ++count) {
      if (count > longest_square && count < same) continue;
      const Surroundings around(trace, i, i + count, rest);
      if (!around.known()) continue;
      const double least =
          std::max(at_once * (around.bend() + noise), of_height * around.highest());
      // the neighbours go on well off rest
      if (around.lowest() <= std::max(of_height * around.highest(), at_once * noise)) continue;
      if (!depart(y, i, count, around, least)) continue;
      const bool square_spike =
          static_cast<double>(count) * trace.interval <= longest_of_one_value &&
          are_shifted(y, i, count);
      if (count > longest && count != same && !square_spike) continue;
      for (std::size_t k = 0; k < count; ++k) found.push_back(i + k);
      i += count - 1;
      break;
    }
  }
  return found;
}

void bridge_glitches(Trace& trace, double quantum) {
  const std::vector<std::size_t> glitches = find_glitches(trace, quantum);
  if (glitches.empty()) return;
  if (trace.valid.empty()) trace.valid.assign(trace.values.size(), 1);
  for (const std::size_t i : glitches) trace.valid[i] = 0;
  bridge_invalid(trace.values, trace.valid);
}

}  // namespace impactrig::acquisition
