// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/dropouts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/samples.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Edit;
using datasets::Quantity;

namespace {

constexpr double gate = 8.0;             ///< standard deviations
constexpr double least_part = 0.02;      ///< of what the signal spans
constexpr double comes_back = 2.0;       ///< departure over the change across
constexpr double line_fits = 4.0;        ///< departure over the scatter of its neighbours
constexpr double on_course = 0.1;        ///< of that departure
constexpr double line_misses = 3.0;      ///< times the scatter: on course where a bar passes zero
constexpr std::size_t least_block = 64;  ///< samples of a local scatter, three blocks together
constexpr std::size_t neighbours = 12;   ///< samples that say how the signal goes
constexpr std::size_t cluster = 3;       ///< samples between two that stand out for one edge

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// Departure of each sample from the cubic through its four neighbours; 0 at the two at each end.
std::vector<double> departures(std::span<const double> y) {
  std::vector<double> result(y.size(), 0.0);
  for (std::size_t i = 2; i + 2 < y.size(); ++i)
    result[i] = y[i] - (4.0 * (y[i - 1] + y[i + 1]) - y[i - 2] - y[i + 2]) / 6.0;
  return result;
}

double scatter(std::span<const double> departures) {
  std::vector<double> sizes(departures.begin(), departures.end());
  for (double& size : sizes) size = std::abs(size);
  return normal_mad * median(std::move(sizes));
}

/// What the signal spans, a percent at each end left out.
double span_of(std::span<const double> y) {
  std::vector<double> sample = evenly_spread(y, std::size_t{1} << 16);
  std::ranges::sort(sample);
  const std::size_t edge = sample.size() / 100;
  return sample[sample.size() - 1 - edge] - sample[edge];
}

/// Samples that stand out, as stretches [begin, end). The longest dropout, which may be noise
/// alone, is a third of the samples that say what the scatter is around it.
std::vector<IndexRange> edges_in(std::span<const double> y, std::size_t longest) {
  const std::size_t block = std::max(least_block, longest);
  const std::vector<double> departure = departures(y);
  const std::span<const double> all(departure);
  const std::span<const double> inner = all.subspan(2, y.size() - 4);
  const double usual = scatter(evenly_spread(inner, std::size_t{1} << 18));
  const double floor =
      std::max({gate * usual, least_part * span_of(y), gate * 0.75 * quantum_of(y)});
  std::vector<IndexRange> edges;
  for (std::size_t from = 0; from < inner.size(); from += block) {
    const std::size_t to = std::min(from + block, inner.size());
    const auto part = inner.subspan(from, to - from);
    const auto stands_out = [](double limit) {
      return [limit](double d) { return std::abs(d) > limit; };
    };
    if (std::ranges::none_of(part, stands_out(floor))) continue;
    const std::size_t left = from > block ? from - block : 0;
    const std::size_t right = std::min(to + block, inner.size());
    const double limit = std::max(floor, gate * scatter(inner.subspan(left, right - left)));
    for (std::size_t i = from; i < to; ++i) {
      if (std::abs(inner[i]) <= limit) continue;
      const std::size_t sample_index = i + 2;
      if (!edges.empty() && sample_index <= edges.back().end + cluster)
        edges.back().end = sample_index + 1;
      else
        edges.push_back({sample_index, sample_index + 1});
    }
  }
  return edges;
}

/// The line through the sound samples beside a stretch.
struct Line {
  double value, slope;  ///< at the stretch's edge; [1/sample]
  double scatter;       ///< rms of the samples about it
};

std::optional<Line> line_beside(std::span<const double> y, const std::vector<std::uint8_t>& valid,
                                std::size_t edge, bool before) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
  for (std::size_t k = 0; k < neighbours; ++k) {
    if (before ? edge <= k : edge + k >= y.size()) break;
    const std::size_t i = before ? edge - 1 - k : edge + k;
    if (!valid.empty() && valid[i] == 0) break;
    const double x = before ? -as_double(k) - 1.0 : as_double(k);
    n += 1.0;
    sx += x;
    sy += y[i];
    sxx += x * x;
    sxy += x * y[i];
    syy += y[i] * y[i];
  }
  if (n < 4.0) return std::nullopt;
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  const double value = (sy - slope * sx) / n;
  const double squares = syy - value * sy - slope * sxy;
  return Line{value, slope, std::sqrt(std::max(0.0, squares / n))};
}

/// The Hermite cubic over [begin, end) between the lines on either side.
struct Bridge {
  std::size_t begin, end;
  Line left, right;

  double at(std::size_t i) const {
    const double length = as_double(end - begin);
    const double s = (as_double(i - begin) + 0.5) / length;
    const double r = 1.0 - s;
    return (1.0 + 2.0 * s) * r * r * left.value + s * r * r * length * left.slope +
           s * s * (1.0 + 2.0 * r) * right.value - s * s * r * length * right.slope;
  }
};

std::optional<Bridge> bridge_over(std::span<const double> y, const std::vector<std::uint8_t>& valid,
                                  std::size_t begin, std::size_t end) {
  const auto left = line_beside(y, valid, begin, true);
  const auto right = line_beside(y, valid, end, false);
  if (!left || !right) return std::nullopt;
  return Bridge{begin, end, *left, *right};
}

/// Of up to 2^16 samples, in increasing order.
std::vector<double> sizes_of(std::span<const double> y) {
  std::vector<double> sizes = evenly_spread(y, std::size_t{1} << 16);
  for (double& size : sizes) size = std::abs(size);
  std::ranges::sort(sizes);
  return sizes;
}

/// What a stretch is judged against.
struct Measure {
  double span;                     ///< what the signal spans
  double noise;                    ///< of a sample
  bool towards_zero;               ///< what the laser shows when it is lost
  std::vector<double> sizes = {};  ///< of some samples spread over it, in increasing order
};

/// A laser without light shows zero: a level stretch there that the courses on either side do not
/// lead to, whatever the signal does across it; one of them may, where the bar itself is at zero
/// just then. A decoder is some times as noisy without light. No bar at rest is that where it has a
/// dozen samples within the longest dropout: it comes to rest and leaves in longer than a few of
/// them.
bool pinned_to_zero(std::span<const double> y, const Bridge& bridge, const Measure& measure) {
  constexpr std::size_t edge = 3;  // two samples that stand out beside a step, and a spike
  if (bridge.end - bridge.begin < 2 * edge + neighbours) return false;
  const QuietFit course = fit_quiet(y, bridge.begin + edge, bridge.end - edge, 1, 0.0);
  const double level = course.coefficients[0];
  const double error =  // of the level; sqrt(12) of it of how far the course goes
      std::max(course.sigma, measure.noise) / std::sqrt(as_double(course.size()));
  std::size_t beside = 0;  // spikes within; more than a few are a stretch of their own
  for (std::size_t i = course.begin; i < course.end; ++i)
    if (std::abs(y[i] - course.at(as_double(i))) > gate * course.sigma) ++beside;
  const double near_zero = 0.03 * measure.span;
  const double step = std::max(gate * measure.noise, least_part * measure.span);
  const auto jumps = [&](const Line& line) {  // further than it would go over the edge, twice
    return std::abs(line.value - level) >
           std::max(step, 2.0 * as_double(edge) * std::abs(line.slope));
  };
  return 10 * beside < course.size() &&
         course.sigma <= std::max(6.0 * measure.noise, 0.01 * measure.span) &&
         std::abs(level) < near_zero + 3.0 * error &&
         2.0 * std::abs(course.coefficients[1]) < near_zero + 3.0 * std::sqrt(12.0) * error &&
         (jumps(bridge.left) || jumps(bridge.right));
}

/// Whether a level is the end of a decoder's range, where a lost laser may be too: few samples are
/// as far from zero, and hardly any between there and what the others reach, as a motion that went
/// there by itself would have them.
bool is_end_of_range(const Measure& measure, double level) {
  constexpr double at_level = 0.95, below = 0.6, most_at_level = 0.1, most_between = 0.002;
  const std::vector<double>& sizes = measure.sizes;
  const auto share_above = [&](double part) {
    const auto from = std::ranges::upper_bound(sizes, part * std::abs(level));
    return static_cast<double>(sizes.end() - from) / static_cast<double>(sizes.size());
  };
  const double at = share_above(at_level);
  return at <= most_at_level && share_above(below) - at <= most_between;
}

/// Whether a part of the stretch between two edges is sound: what lies between two losses, each
/// with edges of its own. It is less than half as far off as another part, or the laser shows more
/// there than what is expected of the bar, and quietly.
bool sound_within(std::span<const double> y, const Bridge& bridge,
                  std::span<const IndexRange> edges, const Measure& measure) {
  double nearest = INFINITY, furthest = 0.0;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    const std::size_t from = edges[k].end, to = edges[k + 1].begin;
    if (to < from + neighbours) continue;
    std::vector<double> sizes;
    for (std::size_t i = from; i < to; ++i) sizes.push_back(std::abs(y[i] - bridge.at(i)));
    const double typical = median(std::move(sizes));
    nearest = std::min(nearest, typical);
    furthest = std::max(furthest, typical);
    const QuietFit course = fit_quiet(y, from, to, 1, 0.0);
    const double level = course.coefficients[0], expected = bridge.at((from + to) / 2);
    if (measure.towards_zero && std::abs(level) > std::abs(expected) &&
        course.sigma < 0.5 * std::abs(level - expected) && !is_end_of_range(measure, level))
      return true;
  }
  return 2.0 * nearest < furthest;
}

/// The dropout that the stretch from the first edge to the last is, if it is one: without the
/// samples at its ends that are on their course.
std::optional<Dropout> dropout_in(std::span<const double> y, const std::vector<std::uint8_t>& valid,
                                  std::span<const IndexRange> edges, const Measure& measure) {
  const std::size_t begin = edges.front().begin, end = edges.back().end;
  const auto bridge = bridge_over(y, valid, begin, end);
  if (!bridge) return std::nullopt;
  Dropout dropout{begin, end, 0.0};
  std::vector<double> sizes;
  for (std::size_t i = begin; i < end; ++i) {
    const double departure = y[i] - bridge->at(i);
    sizes.push_back(std::abs(departure));
    if (std::abs(departure) > std::abs(dropout.departure)) dropout.departure = departure;
  }
  // Of a long stretch the typical sample must be off, of a spike the largest one.
  const double off = sizes.size() > 4 * cluster ? median(sizes) : std::abs(dropout.departure);
  const double across = std::abs(bridge->right.value - bridge->left.value);
  // Lines that miss their own samples (an impact among them) say nothing of the stretch.
  const double scatter = std::max(bridge->left.scatter, bridge->right.scatter);
  const bool away_and_back = off > line_fits * scatter && off > comes_back * across &&
                             !sound_within(y, *bridge, edges, measure);
  if (!away_and_back && !pinned_to_zero(y, *bridge, measure)) return std::nullopt;
  // Where the bar passes zero a lost sample is hardly off.
  const double sound =
      away_and_back ? on_course * off : line_misses * std::max(scatter, measure.noise);
  while (dropout.begin < dropout.end && sizes[dropout.begin - begin] < sound) ++dropout.begin;
  while (dropout.begin < dropout.end && sizes[dropout.end - 1 - begin] < sound) --dropout.end;
  if (dropout.begin == dropout.end) return std::nullopt;
  return dropout;
}

/// How many of the pairs of neighbours in a stretch are equal, as a part of them.
double share_of_equal(std::span<const double> y) {
  std::size_t equal = 0;
  for (std::size_t i = 1; i < y.size(); ++i) equal += y[i] == y[i - 1] ? 1 : 0;
  return y.size() > 1 ? as_double(equal) / as_double(y.size() - 1) : 1.0;
}

/// A laser without light may show its last value: equal samples, more than chance brings about
/// beside others that differ, which end with a step. At an end of the signal they are a range's.
std::vector<Dropout> held_values(std::span<const double> y, const std::vector<std::uint8_t>& valid,
                                 std::size_t longest, const Measure& measure) {
  constexpr std::size_t fewest = 8;
  constexpr double by_chance = 1e-6;  // in the whole record
  const auto [lowest, highest] = std::ranges::minmax(y);
  const double step = std::max(gate * measure.noise, least_part * measure.span);
  std::vector<Dropout> held;
  for (std::size_t begin = 1; begin + fewest < y.size();) {
    std::size_t end = begin + 1;
    while (end < y.size() && y[end] == y[begin]) ++end;
    const std::size_t next = end, samples = end - begin;
    const double level = y[begin];
    const bool candidate = samples >= fewest && samples <= longest && end < y.size() &&
                           level > lowest && level < highest && std::abs(y[end] - level) > step;
    if (candidate) {
      const std::size_t left = begin > 4 * samples ? begin - 4 * samples : 0;
      const std::size_t right = std::min(y.size(), end + 4 * samples);
      const double equal = std::max(share_of_equal(y.subspan(left, begin - left)),
                                    share_of_equal(y.subspan(end, right - end)));
      const auto bridge = bridge_over(y, valid, begin + 1, end);  // the first was seen
      if (bridge && as_double(y.size()) * std::pow(equal, as_double(samples - 1)) < by_chance) {
        Dropout dropout{begin + 1, end, 0.0};
        for (std::size_t i = dropout.begin; i < end; ++i)
          if (const double departure = level - bridge->at(i);
              std::abs(departure) > std::abs(dropout.departure))
            dropout.departure = departure;
        held.push_back(dropout);
      }
    }
    begin = next;
  }
  return held;
}

}  // namespace

std::vector<Dropout> find_dropouts(std::span<const double> values,
                                   const std::vector<std::uint8_t>& valid, std::size_t longest,
                                   Quantity quantity) {
  if (values.size() < 2 * neighbours) return {};
  const std::vector<IndexRange> edges = edges_in(values, longest);
  const Measure measure{span_of(values),
                        std::max(step_noise(values), 0.75 * quantum_of(values, valid)),
                        quantity == Quantity::velocity, sizes_of(values)};
  std::vector<Dropout> dropouts;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    // The longest stretch first: a dropout may have spikes within.
    std::size_t last = e;
    while (last + 1 < edges.size() && edges[last + 1].end - edges[e].begin <= longest + 4) ++last;
    for (;; --last) {
      const auto dropout =
          dropout_in(values, valid, std::span(edges).subspan(e, last - e + 1), measure);
      if (dropout && dropout->end - dropout->begin <= longest) {
        dropouts.push_back(*dropout);
        e = last;
        break;
      }
      if (last == e) break;
    }
  }
  for (const Dropout& held : held_values(values, valid, longest, measure)) {
    const bool known = std::ranges::any_of(dropouts, [&held](const Dropout& other) {
      return other.begin < held.end && held.begin < other.end;
    });
    if (!known) dropouts.push_back(held);
  }
  std::ranges::sort(dropouts, {}, &Dropout::begin);
  return dropouts;
}

Edit repair_dropouts(Channel& channel, const datasets::RepairDropouts& repair) {
  if (channel.quantity == Quantity::force || channel.quantity == Quantity::acceleration)
    throw std::invalid_argument(
        fmt::format("channel '{}' is a {}, in which an impact itself is a spike; dropouts are "
                    "repaired in velocity and displacement",
                    channel.name, name(channel.quantity)));
  if (!(repair.longest > 0.0))
    throw std::invalid_argument(
        fmt::format("a longest dropout of {:g} s is not positive", repair.longest));
  std::vector<double> values = sound_values(channel);
  const double longest = std::min(1e9, repair.longest / channel.clock.interval + 1.0);
  const auto dropouts =
      find_dropouts(values, channel.valid, static_cast<std::size_t>(longest), channel.quantity);
  Edit edit{"repair dropouts", channel.name, {}};
  edit.parameters["longest"] = fmt::format("{:.12g} s", repair.longest);
  edit.parameters["found"] = std::to_string(dropouts.size());
  if (dropouts.empty()) return edit;

  if (channel.valid.empty()) channel.valid.assign(values.size(), 1);
  const std::vector<std::uint8_t> sound = channel.valid;
  const std::vector<double> recorded = values;
  std::size_t samples = 0;
  for (const Dropout& dropout : dropouts) {
    const auto bridge = bridge_over(recorded, sound, dropout.begin, dropout.end);
    for (std::size_t i = dropout.begin; i < dropout.end; ++i) {
      if (bridge) values[i] = bridge->at(i);
      channel.valid[i] = 0;
      ++samples;
    }
  }
  edit.parameters["samples"] = fmt::format("{} bridged and marked invalid", samples);
  edit.parameters["first"] = fmt::format("{:.9g} s", channel.clock.time(dropouts.front().begin));
  replace_values(channel, std::move(values));
  return edit;
}

}  // namespace impactrig::acquisition
