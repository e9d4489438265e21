// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/number_text.hpp"
#include "fitting/diagnostics/diagnose.hpp"

namespace impactrig::fitting {
namespace {

// A structure is named where it explains this part of what noise does not.
constexpr double telling_share = 0.25;
// Nine tenths of what is left of a free vibration in so few samples: no model errs like that, but a
// disturbance does.
constexpr double few_samples = 0.15;

/// The most energy beyond noise among phases that have significantly more than noise; null where
/// none has.
const PhaseLevel* worst_phase(const ChannelDiagnostics& found, double limit) {
  const PhaseLevel* worst = nullptr;
  const auto excess = [](const PhaseLevel& level) {
    return static_cast<double>(level.samples) * (level.ratio * level.ratio - 1.0);
  };
  for (const PhaseLevel& level : found.phases)
    if (level.p_value < limit && (worst == nullptr || excess(level) > excess(*worst)))
      worst = &level;
  return worst;
}

/// Energy of the residuals after touch that noise does not explain, as a part of all of it.
double unexplained(const ChannelDiagnostics& found) {
  double whole = 0.0, noise = 0.0;
  for (const PhaseLevel& level : found.phases) {
    if (level.phase == "before touch") continue;
    whole += static_cast<double>(level.samples) * level.ratio * level.ratio;
    noise += static_cast<double>(level.samples);
  }
  return whole > 0.0 ? std::max(0.0, 1.0 - noise / whole) : 0.0;
}

const Structure* likeness(const ChannelDiagnostics& found, double limit) {
  const Structure* best = nullptr;
  for (const Structure& structure : found.structures)
    if (structure.p_value < limit && structure.share > telling_share * unexplained(found) &&
        (best == nullptr || structure.share > best->share))
      best = &structure;
  return best;
}

bool model_vibrates(const Structure& structure) {
  return structure.model_amplitude > 2.0 * structure.amount;
}

std::string looks_like(const Structure& s) {
  if (s.kind == "delay")
    return fmt::format("a delay of {} us ({})", datasets::figures(1e6 * std::abs(s.amount), 2),
                       s.amount > 0.0 ? "measured late" : "measured early");
  if (s.kind == "gain") return fmt::format("a gain error of {:+.2g} %", 100.0 * s.amount);
  if (s.kind == "vibration")
    return fmt::format(
        "a vibration at {:.4g} Hz of {} {}{}", s.frequency, datasets::figures(s.amount, 2), s.unit,
        model_vibrates(s) ? ", which the model has otherwise" : ", which the model lacks");
  return fmt::format("{} of {:+.2g} {}", s.kind == "offset" ? "an offset" : "a drift", s.amount,
                     s.unit);
}

std::string next_step(const std::string& quantity, const Structure& s) {
  if (s.kind == "delay")
    return fmt::format(
        "correct sensors.{}.delay or state its uncertainty, so that it is fitted, and compare "
        "laws of the contact if it stays",
        quantity);
  if (s.kind == "gain")
    return fmt::format("check sensors.{0}.sensitivity{1}, or free sensors.{0}.gain", quantity,
                       quantity == "force" ? "" : " and where the laser points");
  if (s.kind == "vibration" && model_vibrates(s))
    return quantity == "force"
               ? "check the bar's data and solver.modes or elements, and a compliant stop"
               : "check the bar's data, where the laser points (sensors." + quantity +
                     ".position) and its damping";
  if (s.kind == "vibration")
    return "take more modes or elements, or let the stop or the hinge give way (stop, hinge)";
  return fmt::format("check the zero of the {} and condition its drift away", quantity);
}

bool is_disturbed(const PhaseLevel& level) {
  return level.phase == "free vibration" && level.concentration < few_samples;
}

std::string next_step(const std::string& quantity, const PhaseLevel& level) {
  if (is_disturbed(level))
    return quantity == "force"
               ? "spikes, a foreign blow or a contact that the model does not make: look at the "
                 "record, shorten the fitted window, or take the loss tukey"
               : "a laser's dropout, a spike or a contact that the model does not make: look at "
                 "the record, mark it with the conditioning step dropouts, or take the loss tukey";
  if (level.phase == "before touch")
    return "the baseline wanders, or the fit bends it to make up for what the model lacks: look at "
           "the other phases first";
  if (level.phase == "compression")
    return "compare elastic laws (contact.law) and damping laws (contact.damping), or let the stop "
           "give way";
  if (level.phase == "restitution")
    return "compare damping laws (contact.damping), then elastic laws (contact.law)";
  if (level.phase == "free vibration")
    return quantity == "force"
               ? "check the sensor's resonance and the stop's compliance, or shorten the fitted "
                 "window"
               : "check the bar's data, where the laser points, its damping and the number of "
                 "modes";
  return "what follows the first separation depends on all before it: mend the first contact, or "
         "shorten the fitted window";
}

std::string where(const std::string& phase) {
  if (phase == "before touch" || phase == "compression" || phase == "restitution")
    return (phase == "before touch" ? "" : "during ") + phase;
  return "in " + phase;
}

/// Of residuals that are nowhere larger than noise may be.
std::string size_by_chance(const ChannelDiagnostics& found) {
  constexpr double notable = 1.1;
  double largest = 0.0;
  for (const PhaseLevel& phase : found.phases) largest = std::max(largest, phase.ratio);
  return largest < notable
             ? "are hardly larger than the noise"
             : fmt::format("are up to {} times the noise, which so few samples may be by chance",
                           datasets::figures(largest, 3));
}

}  // namespace

std::string diagnosis_sentence(const ChannelResiduals& channel, const ChannelDiagnostics& found) {
  if (!found.judged && found.coarse)
    return fmt::format(
        "The {}'s residuals were not judged: before touch it rests on the "
        "digitiser's steps, which do not tell its noise; record in a finer range.",
        channel.quantity);
  if (!found.judged)
    return fmt::format("The {}'s residuals were not judged: {} before touch {}.", channel.quantity,
                       found.noise_samples == 1 ? "a single sample"
                                                : fmt::format("{} samples", found.noise_samples),
                       found.noise_samples < fewest_quiet_samples
                           ? "do not tell its noise; record a longer pre-trigger"
                           : "show no noise to compare them with");
  if (found.sound)
    return fmt::format("The {}'s residuals are what {} leads to expect.", channel.quantity,
                       found.coarse ? "the digitiser's step" : "its noise before touch");
  const double tests =
      static_cast<double>(found.phases.size() + (found.coarse ? 0 : 1) + found.structures.size());
  const double limit = found.level / tests;
  const PhaseLevel* worst = worst_phase(found, limit);
  const Structure* like = likeness(found, limit);
  std::string text = fmt::format("The {}'s residuals ", channel.quantity);
  if (worst != nullptr)
    text += fmt::format("are {} times the noise {}", datasets::figures(worst->ratio, 3),
                        where(worst->phase));
  else
    text += fmt::format("{}, but follow each other as noise does not", size_by_chance(found));
  if (like != nullptr)
    text += " and look like " + looks_like(*like);
  else if (worst != nullptr && is_disturbed(*worst))
    text += fmt::format(", nine tenths of that in {} of the samples there",
                        datasets::percent(worst->concentration));
  text += "; ";
  if (like != nullptr)
    text += next_step(channel.quantity, *like);
  else if (worst != nullptr)
    text += next_step(channel.quantity, *worst);
  else
    text += "a small error of model, mesh or calibration: compare laws and a finer mesh";
  return text + ".";
}

}  // namespace impactrig::fitting
