// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/spikes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "acquisition/conditioning/background.hpp"

namespace impactrig::acquisition {

namespace {

constexpr double foot = 0.1, edge = 0.7;  // of a spike's height
constexpr std::size_t fewest = 3;         // what a sample of noise becomes in a recorder's filter
constexpr std::size_t longest_square = 16, longest = 64;
constexpr std::size_t neighbours = 6;  // at rest on either side, so that it is alone
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
    const double height = std::abs(height_);
    if (range_.size() <= fewest || (square && range_.size() <= longest_square))
      return Spike{range_, times_of_square, height};
    if (range_.size() <= longest && rests(range_.size()))
      return Spike{range_, times_of_any, height};
    return std::nullopt;
  }

  const IndexRange& range() const { return range_; }

  /// For at least so many samples on both sides.
  bool rests(std::size_t samples) const {
    const std::size_t count = std::max(samples, neighbours);
    if (range_.begin < count || range_.end + count > trace_.values.size()) return false;
    for (std::size_t k = 0; k < count; ++k)
      for (const std::size_t i : {range_.begin - 1 - k, range_.end + k})
        if (is_high(i)) return false;
    return true;
  }

 private:
  void take_before() {
    for (std::size_t low = 0;
         low + 1 < neighbours && range_.begin > low && range_.size() <= longest;) {
      ++low;
      if (!is_high(range_.begin - low)) continue;
      range_.begin -= low;
      low = 0;
    }
  }

  void take_behind() {
    const std::size_t n = trace_.values.size();
    for (std::size_t low = 0;
         low + 1 < neighbours && range_.end + low < n && range_.size() <= longest;) {
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

bool Spike::is_short_beside(const std::vector<Contact>& contacts) const {
  constexpr double least_height = 0.2;
  const double begin = static_cast<double>(range.begin), end = static_cast<double>(range.end);
  return std::ranges::any_of(contacts, [&](const Contact& contact) {
    const bool apart = contact.onset >= end || contact.end <= begin;
    return apart && contact.end - contact.onset >= times * (end - begin) &&
           std::abs(contact.peak) > least_height * height;
  });
}

std::vector<Spike> spikes_among(const Trace& trace, const std::vector<Contact>& contacts) {
  std::vector<Spike> spikes;
  for (const Contact& contact : contacts)
    if (const auto spike = PulseAbout(trace, contact.peak_index, contact.baseline).spike())
      spikes.push_back(*spike);
  return spikes;
}

namespace {

/// Where spikes are looked for, from behind something high on.
struct Search {
  const Trace& trace;
  double least;     ///< that one is high [SI]
  double from, to;  ///< [samples]

  template <typename Judge>
  void run(const Judge& is_one, std::vector<Spike>& spikes) const {
    const std::vector<double>& y = trace.values;
    const auto last = static_cast<double>(y.size() - neighbours);
    const auto begin =
        static_cast<std::size_t>(std::max(from + 1.0, static_cast<double>(neighbours)));
    const auto end = static_cast<std::size_t>(std::min(to + 1.0, last));
    for (std::size_t i = begin; i < end; ++i) {
      const auto here = y.begin() + static_cast<std::ptrdiff_t>(i);
      const double level = median({here - static_cast<std::ptrdiff_t>(neighbours), here});
      if (std::abs(y[i] - level) <= least) continue;
      const auto top = std::max_element(
          here, y.begin() + static_cast<std::ptrdiff_t>(std::min(end, i + longest)),
          [=](double a, double b) { return std::abs(a - level) < std::abs(b - level); });
      const PulseAbout pulse(trace, static_cast<std::size_t>(top - y.begin()), level);
      const auto spike = pulse.spike();
      if (spike && pulse.rests(0) && is_one(*spike)) spikes.push_back(*spike);
      i = std::max(i, pulse.range().end);
    }
  }
};

constexpr double of_peak = 0.05, of_noise = 12.0;

double noise_of(const Trace& trace, double quantum) {
  return std::max(step_noise(trace.values, trace.valid), 0.75 * quantum);
}

}  // namespace

std::vector<Spike> spikes_after(const Trace& trace, double quantum,
                                const std::vector<Contact>& contacts,
                                const DetectionOptions& options) {
  std::vector<Spike> spikes;
  if (trace.values.size() < 4 * neighbours) return spikes;
  const double noise = noise_of(trace, quantum);
  for (const Contact& contact : contacts) {
    const Search search{trace, std::max(of_peak * std::abs(contact.peak), of_noise * noise),
                        contact.end, contact.onset + options.after() / trace.interval};
    search.run([&](const Spike& spike) { return spike.is_short_beside({contact}); }, spikes);
  }
  return spikes;
}

std::vector<Spike> spikes_like(const Spike& spike, const Trace& trace, double quantum,
                               const DetectionOptions& options) {
  std::vector<Spike> spikes{spike};
  if (trace.values.size() < 4 * neighbours) return spikes;
  const auto begin = static_cast<double>(spike.range.begin),
             end = static_cast<double>(spike.range.end);
  const Search search{trace, std::max(of_peak * spike.height, of_noise * noise_of(trace, quantum)),
                      end, begin + options.after() / trace.interval};
  search.run(
      [&](const Spike& other) {
        return other.range.size() <= std::max(fewest, spike.range.size());
      },
      spikes);
  return spikes;
}

}  // namespace impactrig::acquisition
