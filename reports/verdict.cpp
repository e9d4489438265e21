// SPDX-License-Identifier: BSD-3-Clause
#include "reports/verdict.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reports/diagnosis.hpp"
#include "reports/numbers.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

constexpr double noise_limit = 1.5;  // residual over noise: power 2.25 times that of noise alone
constexpr double shape_limit = 0.1;  // Sprague-Geers comprehensive

double peak(const fitting::ChannelFit& channel) {
  double out = 0.0;
  for (const double value : channel.measured)
    if (std::isfinite(value)) out = std::max(out, std::abs(value));
  return out;
}

bool within_noise(const fitting::ChannelFit& channel) {
  return channel.noise > 0.0 && channel.residual_rms <= noise_limit * channel.noise;
}

/// By Sprague-Geers; without it by the residual over the peak, which is of the same order.
bool right_in_shape(const fitting::ChannelFit& channel) {
  const auto metric = channel.metrics.find("sprague_geers_comprehensive");
  if (metric != channel.metrics.end() && std::isfinite(metric->second))
    return metric->second <= shape_limit;
  return channel.residual_rms <= shape_limit * peak(channel);
}

/// "the measured force by 1.1 times its noise (0.4 % of its peak)".
std::string difference(const fitting::Fit& fit, const fitting::ChannelFit& channel) {
  std::string out = fmt::format("the measured {}", channel.quantity);
  if (fit.impacts.size() > 1)
    out += " of " + recording_name(fit, static_cast<std::size_t>(std::max(0, channel.recording)));
  const double height = peak(channel);
  const std::string share =
      height > 0.0 ? percent(channel.residual_rms / height) + " of its peak" : "";
  if (channel.noise > 0.0 && std::isfinite(channel.residual_rms))
    return fmt::format("{} by {} times its noise{}", out,
                       significant(channel.residual_rms / channel.noise, 2),
                       share.empty() ? "" : " (" + share + ")");
  return fmt::format("{} by {}", out,
                     share.empty() ? quantity(channel.residual_rms, channel.unit) : share);
}

/// All of them; the worst of each quantity where there are many recordings.
std::string differences(const fitting::Fit& fit) {
  std::vector<const fitting::ChannelFit*> shown;
  for (const fitting::ChannelFit& channel : fit.channels) {
    const auto same = std::find_if(shown.begin(), shown.end(), [&](const auto* other) {
      return other->quantity == channel.quantity;
    });
    const auto relative = [](const fitting::ChannelFit& c) {
      return c.noise > 0.0 ? c.residual_rms / c.noise : c.residual_rms;
    };
    if (same == shown.end())
      shown.push_back(&channel);
    else if (relative(channel) > relative(**same))
      *same = &channel;
  }
  std::string out = fit.impacts.size() > 1 ? "At worst, the prediction differs (rms) from "
                                           : "The prediction differs (rms) from ";
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (i > 0) out += i + 1 == shown.size() ? " and from " : ", from ";
    out += difference(fit, *shown[i]);
  }
  return out + ".";
}

std::string restitution_sentence(const fitting::Fit& fit) {
  const fitting::Parameter* e = find_parameter(fit, "contact.restitution");
  if (e == nullptr) return "";
  const RoundedValue shown = rounded(e->value, e->std_error, "1");
  if (shown.error.empty())
    return fmt::format(
        " The contact law’s e is {}; {}.", shown.value,
        e->identifiable ? "its uncertainty could not be estimated" : "these data cannot tell it");
  std::string out = fmt::format(" The contact law’s e is {} ±\u00a0{}", shown.value, shown.error);
  if (has_interval(e->ci95))
    out += fmt::format(" (95\u00a0% interval {})", interval_text(e->ci95, e->std_error, {1.0, ""}));
  return out + ".";
}

std::string reservations(const fitting::Fit& fit) {
  std::size_t at_bound = 0, unknown = 0;
  std::vector<std::string> contradicted;
  for (const fitting::Parameter& parameter : fit.parameters) {
    at_bound += parameter.at_bound ? 1 : 0;
    unknown += !parameter.identifiable ? 1 : 0;
    if (parameter.contradicts_prior) contradicted.push_back(parameter.name);
  }
  std::string out;
  if (!contradicted.empty())
    out += fmt::format(
        " What is stated of {} contradicts the data or other calibrations: see the "
        "warnings before any number is used.",
        listed(contradicted));
  if (at_bound > 0)
    out += fmt::format(" {} parameter{} at {} bound.", capital(count_word(at_bound)),
                       at_bound == 1 ? " sits" : "s sit", at_bound == 1 ? "its" : "their");
  if (unknown > 0)
    out += fmt::format(" {} parameter{} cannot be told from these data.",
                       capital(count_word(unknown)), unknown == 1 ? "" : "s");
  for (const datasets::Impact& impact : fit.impacts)
    if (impact.has(datasets::ImpactFlag::clipped)) {
      out += " A signal was clipped: peak and impulse are lower limits.";
      break;
    }
  return out;
}

}  // namespace

Verdict verdict(const fitting::Fit& fit) {
  using Grade = Verdict::Grade;
  for (const datasets::Impact& impact : fit.impacts)
    if (impact.has(datasets::ImpactFlag::no_hit))
      return {Grade::open, "No impact found",
              fmt::format("In {} nothing rises above the noise, so there was nothing to explain.",
                          file_name(impact.recording))};
  for (const datasets::Impact& impact : fit.impacts)
    if (impact.has(datasets::ImpactFlag::too_short))
      return {Grade::open, "The recording does not hold the whole contact",
              fmt::format("{} begins or ends in contact. What follows is fitted to a part of it: e "
                          "and the stiffness trade against "
                          "each other there, and their intervals are too narrow.",
                          file_name(impact.recording))};
  for (const datasets::Impact& impact : fit.impacts)
    if (impact.has(datasets::ImpactFlag::implausible))
      return {Grade::open, "Impulse and speed do not fit this rig",
              fmt::format("In {} they differ by a factor that no restitution explains: a unit, a "
                          "sensitivity or a gain is wrong, or the rig file describes another bar. "
                          "See the warnings before what follows.",
                          file_name(impact.recording))};
  if (fit.channels.empty())
    return {Grade::open, "Nothing was compared",
            "No channel of the recording was compared with the prediction."};
  const std::string diagnosis = diagnosis_summary(fit);
  const std::string rest = differences(fit) + (diagnosis.empty() ? "" : " " + diagnosis) +
                           restitution_sentence(fit) + reservations(fit);
  if (fit.termination != "converged")
    return {Grade::open, "Provisional: the fit did not converge",
            fmt::format("It ended with: {}. {}", fit.termination, rest)};
  const bool explained = std::all_of(fit.channels.begin(), fit.channels.end(), within_noise);
  if (explained && std::ranges::any_of(fit.parameters, &fitting::Parameter::contradicts_prior))
    return {Grade::in_shape, "Explained to within the noise, but against what is stated", rest};
  if (explained)
    return {Grade::explained,
            any_unsound(fit) ? "Explained to about the noise, but for a small part that is none"
                             : "Explained to within the noise",
            rest};
  if (std::all_of(fit.channels.begin(), fit.channels.end(), right_in_shape))
    return {Grade::in_shape, "Explained in shape, not to within the noise", rest};
  return {Grade::not_explained, "Not explained by this model", rest};
}

}  // namespace impactrig::reports
