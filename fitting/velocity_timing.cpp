// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/velocity_timing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/number_text.hpp"

namespace impactrig::fitting {

using datasets::Impact;
using datasets::ImpactSignal;

namespace {

constexpr double hardly_any = 0.05;    ///< of the largest departure
constexpr double beyond_noise = 20.0;  ///< standard deviations of the noise
constexpr std::size_t least_samples = 16;
constexpr double at_once = 0.1;  ///< of the time in which half of the impulse is given

/// When half of the contact's impulse has been given, from touch [s]; none where it is not
/// pressure.
std::optional<double> time_of_half_impulse(const Impact& impact) {
  const ImpactSignal& force = *impact.force;
  const auto sum_until = [&](double most) {
    double sum = 0.0;
    for (std::size_t i = 0; i < force.values.size(); ++i) {
      const double t = force.time(i);
      if (t < impact.start || t > impact.end) continue;
      sum += force.values[i];
      if (sum >= most) return std::pair{sum, t - impact.start};
    }
    return std::pair{sum, 0.0};
  };
  const double all = sum_until(INFINITY).first;
  if (!(all > 0.0)) return std::nullopt;
  return sum_until(0.5 * all).second;
}

/// Whether what the sensor and the bar do to the velocity is over in that time.
bool follows_within(double time, const RigFile& file) {
  if (!file.velocity) return true;
  const datasets::Sensor& sensor = *file.velocity;
  if (sensor.low_cut) return false;
  if (sensor.high_cut) {
    const double lag =
        sensor.high_cut->order / (2.0 * std::numbers::pi * sensor.high_cut->frequency);
    if (lag > time) return false;
  }
  if (!(sensor.position > 0.0)) return true;
  // a bending wave reaches a place x away in some x² √(ρA/EI)
  const models::Beam& beam = file.rig.beam;
  const double distance = sensor.position - file.rig.contact.position;
  return distance * distance *
             std::sqrt(beam.density * beam.area / (beam.youngs_modulus * beam.second_moment)) <=
         time;
}

constexpr double significant = 3.0;   ///< standard deviations of a mean of noise
constexpr double as_an_impact = 0.7;  ///< of the largest change

/// Where a signal changes most within a time, all of it before another time.
struct Change {
  double size = 0.0;
  double from = 0.0;  ///< [s]
};

/// By means over a tenth of that time at its two ends, which takes noise off.
Change largest_change(const ImpactSignal& signal, double within, double before) {
  const auto steps = static_cast<std::size_t>(within / signal.interval);
  const std::size_t averaged = std::max<std::size_t>(1, steps / 10);
  std::vector<double> sums = {0.0};
  std::vector<std::size_t> sound = {0};
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    const bool counts = signal.valid.empty() || signal.valid[i] != 0;
    sums.push_back(sums.back() + (counts ? signal.values[i] : 0.0));
    sound.push_back(sound.back() + (counts ? 1 : 0));
  }
  Change largest;
  for (std::size_t i = 0; i + steps + averaged < sums.size(); ++i) {
    if (signal.time(i + steps + averaged - 1) > before) break;
    const std::size_t first = sound[i + averaged] - sound[i];
    const std::size_t last = sound[i + steps + averaged] - sound[i + steps];
    if (first == 0 || last == 0) continue;
    const double change =
        std::abs((sums[i + steps + averaged] - sums[i + steps]) / static_cast<double>(last) -
                 (sums[i + averaged] - sums[i]) / static_cast<double>(first));
    if (change > largest.size) largest = {change, signal.time(i)};
  }
  return largest;
}

/// Whether so small an impulse between two times would be seen, and there is none. Where a light
/// tip is stopped first and the bar bends over it later, the first is a small part of all.
bool is_silent(const ImpactSignal& force, double from, double to, double impulse) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < force.values.size(); ++i) {
    if (force.time(i) < from || force.time(i) >= to) continue;
    sum += force.values[i];
    count += 1.0;
  }
  const double unsure = significant * force.noise * std::sqrt(count * force.noise_correlation);
  return std::abs(sum) <= unsure && unsure * force.interval < impulse;
}

/// About what it takes to change the speed of a bar's end by so much within a time: that of what
/// bending waves reach, half a wave long. 0 of a stepped bar, which is not looked at.
double least_impulse(const models::Beam& beam, double change, double within) {
  if (!beam.segments.empty()) return 0.0;
  const double line_mass = beam.density * beam.area;
  const double reached =
      std::sqrt(within * std::sqrt(beam.youngs_modulus * beam.second_moment / line_mass));
  return 0.5 * change * line_mass * std::min(reached, beam.length);
}

/// By how much the velocity is early [s]; none where it is not by more than `half`, in which half
/// of the impulse is given.
std::optional<double> time_early(const Impact& impact, const models::Beam& beam, double half) {
  const ImpactSignal& velocity = *impact.velocity;
  if (!(half > 4.0 * velocity.interval)) return std::nullopt;
  if (impact.has(datasets::ImpactFlag::unmarked_dropout)) return std::nullopt;  // spikes
  const Change before = largest_change(velocity, half, impact.start - 0.1 * half);
  const Change any = largest_change(velocity, half, INFINITY);
  if (before.size < as_an_impact * any.size || !(before.size > beyond_noise * velocity.noise))
    return std::nullopt;
  constexpr double part = 0.3;
  if (!is_silent(*impact.force, before.from, impact.start,
                 part * least_impulse(beam, before.size, half)))
    return std::nullopt;
  const double early = impact.start - before.from;
  return early > half ? std::optional(early) : std::nullopt;
}

/// A velocity about its mean before touch.
class Departure {
 public:
  Departure(const ImpactSignal& velocity, double touch) : velocity_(velocity), touch_(touch) {
    double sum = 0.0;
    for (std::size_t i = 0; i < velocity.values.size() && velocity.time(i) < touch; ++i) {
      if (!sound(i)) continue;
      sum += velocity.values[i];
      ++before_;
    }
    if (before_ > 0) course_ = sum / static_cast<double>(before_);
    for (std::size_t i = 0; i < velocity.values.size(); ++i)
      if (velocity.time(i) >= touch && sound(i)) largest_ = std::max(largest_, std::abs(at(i)));
  }

  std::size_t samples_before() const { return before_; }

  double largest() const { return largest_; }

  /// Mean of so much time before one after touch; none where no sample is sound.
  std::optional<double> mean(double time, double over) const {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < velocity_.values.size(); ++i) {
      const double t = velocity_.time(i) - touch_;
      if (t <= time - over || t > time || !sound(i)) continue;
      sum += at(i);
      count += 1.0;
    }
    return count > 0.0 ? std::optional(sum / count) : std::nullopt;
  }

  /// When it is larger than this for three samples, after touch [s].
  std::optional<double> begins(double size) const {
    int in_row = 0;
    for (std::size_t i = 0; i < velocity_.values.size(); ++i) {
      if (velocity_.time(i) < touch_ || !sound(i)) continue;
      in_row = std::abs(at(i)) > size ? in_row + 1 : 0;
      if (in_row == 3) return velocity_.time(i - 2) - touch_;
    }
    return std::nullopt;
  }

 private:
  bool sound(std::size_t i) const { return velocity_.valid.empty() || velocity_.valid[i] != 0; }

  double at(std::size_t i) const { return velocity_.values[i] - course_; }

  const ImpactSignal& velocity_;
  double touch_;
  double course_ = 0.0, largest_ = 0.0;
  std::size_t before_ = 0;
};

}  // namespace

std::string velocity_out_of_time(const Impact& impact, const RigFile& rig) {
  if (!impact.force || !impact.velocity || impact.force->channel != impact.trigger) return {};
  const auto half = time_of_half_impulse(impact);
  if (!half || !follows_within(at_once * *half, rig)) return {};
  constexpr std::string_view remedy =
      "the two were not sampled together, or the delay of one is not stated. State "
      "sensors.velocity.delay, or let the data tell it (step = \"align\", with a range that holds "
      "it).";
  if (const auto early = time_early(impact, rig.rig.beam, *half))
    return fmt::format("'{}' leaves its course some {} us before '{}' rises: {}",
                       impact.velocity->channel, datasets::figures(1e6 * *early, 2),
                       impact.force->channel, remedy);
  const Departure departure(*impact.velocity, impact.start);
  if (departure.samples_before() < least_samples) return {};
  if (!(departure.largest() > beyond_noise * impact.velocity->noise)) return {};
  const auto so_far = departure.mean(*half, 0.25 * *half);
  if (!so_far || std::abs(*so_far) > hardly_any * departure.largest()) return {};
  const auto begins =
      departure.begins(std::max(hardly_any * departure.largest(), 6.0 * impact.velocity->noise));
  if (!begins || !(*begins > *half)) return {};
  return fmt::format(
      "'{}' keeps its course until {} us after '{}' rises, when half of the impulse has long been "
      "given ({} us): {}",
      impact.velocity->channel, datasets::figures(1e6 * *begins, 2), impact.force->channel,
      datasets::figures(1e6 * *half, 2), remedy);
}

}  // namespace impactrig::fitting
