// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "fitting/diagnostics/discrepancy.hpp"
#include "fitting/diagnostics/residual_tests.hpp"
#include "fitting/diagnostics/structure.hpp"
#include "fitting/noise_model.hpp"

namespace impactrig::fitting {
namespace {

constexpr double coarse_step = 1.5;  // of the noise's standard deviation
constexpr const char* phase_names[] = {"before touch", "compression", "restitution",
                                       "free vibration", "later contacts"};

std::size_t phase_at(double t, const ImpactPhases& phases) {
  if (t < 0.0) return 0;
  if (t < phases.deepest) return 1;
  if (t < phases.end) return 2;
  for (const auto& [from, to] : phases.later)
    if (t >= from && t < to) return 4;
  return 3;
}

double time_of(const ChannelResiduals& channel, std::size_t i) {
  return channel.start + channel.interval * static_cast<double>(i);
}

/// What a digitiser of that step cannot have made of a right model.
std::vector<double> beyond_half_a_step(const std::vector<double>& residual, double quantum) {
  std::vector<double> out = residual;
  for (double& value : out)
    if (std::isfinite(value))
      value = std::copysign(std::max(0.0, std::abs(value) - 0.5 * quantum), value);
  return out;
}

/// Part of the samples that holds nine tenths of their sum.
double concentration(std::vector<double> energies) {
  std::ranges::sort(energies, std::greater<>());
  double left = 0.0;
  for (const double energy : energies) left += 0.9 * energy;
  std::size_t count = 0;
  while (count < energies.size() && left > 0.0) left -= energies[count++];
  return static_cast<double>(count) / static_cast<double>(energies.size());
}

/// Levels of raw residuals; significance by the whitened ones.
std::vector<PhaseLevel> levels(const ChannelResiduals& channel, std::span<const double> white,
                               const NoiseColour& noise) {
  constexpr std::size_t count = std::size(phase_names);
  std::vector<PhaseLevel> out(count);
  std::vector<double> squares(count, 0.0);
  std::vector<std::size_t> samples(count, 0);
  std::vector<std::vector<double>> energies(count);
  for (std::size_t i = 0; i < channel.residual.size(); ++i) {
    if (!std::isfinite(channel.residual[i])) continue;
    const std::size_t phase = phase_at(time_of(channel, i), channel.phases);
    energies[phase].push_back(channel.residual[i] * channel.residual[i]);
    out[phase].rms += energies[phase].back();
    ++out[phase].samples;
    if (!std::isfinite(white[i])) continue;
    squares[phase] += white[i] * white[i];
    ++samples[phase];
  }
  for (std::size_t k = 0; k < count; ++k) {
    out[k].phase = phase_names[k];
    if (out[k].samples > 0) {
      out[k].rms = std::sqrt(out[k].rms / static_cast<double>(out[k].samples));
      out[k].concentration = concentration(std::move(energies[k]));
    }
    out[k].ratio = out[k].rms / noise.deviation;
    out[k].p_value = k == 0 ? 1.0 : level_p_value(squares[k], samples[k], noise);
  }
  std::erase_if(out, [](const PhaseLevel& level) { return level.samples == 0; });
  return out;
}

/// The noise as the residuals before touch show it; away from the touch itself, which may be
/// misplaced.
std::size_t quiet_samples(const ChannelResiduals& channel) {
  const double guard = std::max(5.0 * channel.interval, 0.05 * std::max(0.0, channel.phases.end));
  std::size_t count = 0;
  while (count < channel.residual.size() && time_of(channel, count) < -guard) ++count;
  return count;
}

/// One test of the family.
void judge(double p_value, double tests, ChannelDiagnostics& out) {
  out.p_value = std::min(out.p_value, std::min(1.0, tests * p_value));
  out.sound = !(out.p_value < out.level);
}

void judge_coarse(const ChannelResiduals& channel, ChannelDiagnostics& out) {
  NoiseColour noise;
  noise.deviation = noise.innovation = std::max(out.noise, channel.quantum / std::sqrt(12.0));
  noise.samples = static_cast<std::size_t>(out.noise_samples);
  out.noise = noise.deviation;
  out.phases = levels(channel, beyond_half_a_step(channel.residual, channel.quantum), noise);
  for (const PhaseLevel& level : out.phases)
    judge(level.p_value, static_cast<double>(out.phases.size()), out);
}

void judge_all(const ChannelResiduals& channel, const NoiseColour& noise, std::size_t quiet,
               ChannelDiagnostics& out) {
  const std::vector<double> white = whitened(channel.residual, noise);
  const std::span<const double> all(white), before = all.first(quiet);
  std::size_t touch = quiet;
  while (touch < white.size() && time_of(channel, touch) < 0.0) ++touch;
  const std::span<const double> after = all.subspan(touch);
  const double start = time_of(channel, std::min(touch, white.size()));
  out.phases = levels(channel, white, noise);
  if (!out.phases.empty() && out.phases.front().phase == phase_names[0])
    out.phases.front().p_value = trend_p_value(before, noise);
  out.whiteness = whiteness(before, after);
  out.normality = normality(after, channel.quantum);
  out.run = longest_run(after, start, channel.interval);
  const AfterTouch task{std::span(channel.residual).subspan(touch),
                        std::span(channel.model).subspan(touch),
                        start,
                        channel.interval,
                        channel.phases.end,
                        channel.unit};
  out.structures = structures(task, noise);
  const double tests = static_cast<double>(out.phases.size() + 1 + out.structures.size());
  for (const PhaseLevel& level : out.phases) judge(level.p_value, tests, out);
  judge(out.whiteness.p_value, tests, out);
  for (const Structure& structure : out.structures) judge(structure.p_value, tests, out);
  out.discrepancy =
      discrepancy({task.residual, channel.interval, channel.phases.end, out.level}, noise);
}

}  // namespace

ChannelDiagnostics diagnose(const ChannelResiduals& channel, double level) {
  ChannelDiagnostics out;
  out.level = level;
  const std::size_t quiet = quiet_samples(channel);
  const NoiseColour noise = noise_colour(std::span(channel.residual).first(quiet));
  out.noise = noise.deviation;
  out.noise_correlation = noise.correlation_time;
  out.noise_samples = static_cast<long>(noise.samples);
  out.coarse = channel.quantum > coarse_step * noise.deviation;
  double largest = 0.0;
  for (const double value : channel.model) largest = std::max(largest, std::abs(value));
  const bool seen = channel.noise_known && noise.deviation > rounding_part * largest;
  out.judged = out.noise_samples >= fewest_quiet_samples && (seen || out.coarse);
  if (out.judged && out.coarse) judge_coarse(channel, out);
  if (out.judged && !out.coarse) judge_all(channel, noise, quiet, out);
  out.sentence = diagnosis_sentence(channel, out);
  return out;
}

}  // namespace impactrig::fitting
