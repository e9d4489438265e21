// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/spikes.hpp"

#include <algorithm>
#include <cmath>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double foot = 0.1, edge = 0.7;  // of a spike's height
constexpr std::size_t fewest = 3;         // what a sample of noise becomes in a recorder's filter
constexpr std::size_t longest_square = 16, longest = 64;
constexpr std::size_t neighbours = 6, gap = 3;  // low samples where it changes its sign
constexpr double times_of_square = 10.0, times_of_any = 20.0;

/// The samples about the highest one of a pulse, above a level.
class PulseAbout {
 public:
  PulseAbout(const Trace& trace, std::size_t top, double level)
      : trace_(trace),
        level_(level),
        height_(trace.values[top] - level),
        range_{top, top + 1} {
    take_before();
    take_behind();
  }

  std::optional<Spike> spike() const {
    const bool square = part(range_.begin) > edge && part(range_.end - 1) > edge;
    if (range_.begin == 0 || range_.end == trace_.values.size()) return std::nullopt;
    if (range_.size() <= fewest || (square && range_.size() <= longest_square))
      return Spike{range_, times_of_square};
    if (range_.size() <= longest && rests(range_.size())) return Spike{range_, times_of_any};
    return std::nullopt;
  }

  const IndexRange& range() const { return range_; }

  /// For at least so many samples on both sides.
  bool rests(std::size_t samples) const {
    const std::size_t count = std::max(samples, neighbours);
    if (range_.begin < count || range_.end + count > trace_.values.size()) return false;
    for (std::size_t k = 0; k < count; ++k)
      for (const std::size_t i : {range_.begin - 1 - k, range_.end + k})
        if (!trace_.is_valid(i) || is_high(i)) return false;
    return true;
  }

 private:
  void take_before() {
    for (std::size_t low = 0; low < gap && range_.begin > low && range_.size() <= longest;) {
      ++low;
      if (!is_high(range_.begin - low)) continue;
      range_.begin -= low;
      low = 0;
    }
  }

  void take_behind() {
    const std::size_t n = trace_.values.size();
    for (std::size_t low = 0; low < gap && range_.end + low < n && range_.size() <= longest;) {
      ++low;
      if (!is_high(range_.end + low - 1)) continue;
      range_.end += low;
      low = 0;
    }
  }

  double part(std::size_t i) const { return (trace_.values[i] - level_) / height_; }

  bool is_high(std::size_t i) const { return std::abs(part(i)) >= foot; }

  const Trace& trace_;
  double level_, height_;
  IndexRange range_;
};

}  // namespace

std::optional<Spike> spike_among(const Trace& trace, const std::vector<Contact>& contacts) {
  for (const Contact& contact : contacts)
    if (const auto spike = PulseAbout(trace, contact.peak_index, contact.baseline).spike())
      return spike;
  return std::nullopt;
}

std::optional<Spike> spike_after(const Trace& trace, double quantum,
                                 const std::vector<Contact>& contacts,
                                 const DetectionOptions& options) {
  constexpr double of_peak = 0.05, of_noise = 12.0;
  const std::vector<double>& y = trace.values;
  if (y.size() < 4 * neighbours) return std::nullopt;
  const double noise = std::max(step_noise(y, trace.valid), 0.75 * quantum);
  const double post = options.post_trigger / trace.interval;
  const auto last = static_cast<double>(y.size() - neighbours);
  for (const Contact& contact : contacts) {
    const double least = std::max(of_peak * std::abs(contact.peak), of_noise * noise);
    const auto begin = std::max(static_cast<std::size_t>(contact.end) + 1, neighbours);
    const auto end = static_cast<std::size_t>(std::min(contact.onset + post + 1.0, last));
    for (std::size_t i = begin; i < end; ++i) {
      const auto here = y.begin() + static_cast<std::ptrdiff_t>(i);
      const double level = median({here - static_cast<std::ptrdiff_t>(neighbours), here});
      if (std::abs(y[i] - level) <= least) continue;
      const auto top = std::max_element(
          here, y.begin() + static_cast<std::ptrdiff_t>(std::min(end, i + longest)),
          [=](double a, double b) { return std::abs(a - level) < std::abs(b - level); });
      const PulseAbout pulse(trace, static_cast<std::size_t>(top - y.begin()), level);
      const auto spike = pulse.spike();
      if (spike && pulse.rests(0) && spike->least_contact() <= contact.end - contact.onset)
        return spike;
      i = std::max(i, pulse.range().end);
    }
  }
  return std::nullopt;
}

}  // namespace impactrig::acquisition
