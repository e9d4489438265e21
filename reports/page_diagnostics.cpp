// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <boost/math/distributions/normal.hpp>

#include "reports/diagnosis.hpp"
#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

using fitting::ChannelDiagnostics;
using fitting::ChannelFit;

constexpr std::size_t most_pictures = 8;  // channels with pictures on one page

std::string chance(double p_value) {
  if (!std::isfinite(p_value)) return "–";
  return p_value < 1e-4 ? "< 0.0001" : significant(p_value, 2);
}

std::string channel_title(const fitting::Fit& fit, const ChannelFit& channel) {
  std::string out = capital(channel.quantity);
  if (fit.impacts.size() > 1)
    out += ", " + recording_name(fit, static_cast<std::size_t>(std::max(0, channel.recording)));
  return out;
}

std::string html_row(const std::string& head, const std::vector<std::string>& cells) {
  std::string out = "<tr><th scope=\"row\">" + escaped(head) + "</th>";
  for (const std::string& cell : cells) out += "<td class=\"n\">" + escaped(cell) + "</td>";
  return out + "</tr>\n";
}

std::string html_table(const std::string& caption, const std::vector<std::string>& heads,
                       const std::string& rows) {
  std::string head;
  for (std::size_t i = 0; i < heads.size(); ++i)
    head +=
        fmt::format("<th scope=\"col\"{}>{}</th>", i > 0 ? " class=\"n\"" : "", escaped(heads[i]));
  return "<div class=\"scroll\"><table><caption>" + escaped(caption) + "</caption>\n<thead><tr>" +
         head + "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n";
}

std::string html_phases(const ChannelFit& channel) {
  std::string rows;
  for (const fitting::PhaseLevel& level : channel.diagnostics->phases)
    rows += html_row(
        capital(level.phase),
        {grouped(static_cast<unsigned long long>(std::max(0L, level.samples))),
         quantity(level.rms, channel.unit), significant(level.ratio, 3), chance(level.p_value)});
  return html_table("Residuals by phase of the impact",
                    {"Phase", "Samples", "Residual, rms", "Over noise", "Chance by noise alone"},
                    rows);
}

std::string share_text(double share) {
  return share < 1e-3 ? "< 0.1 %" : percent(share);
}

std::string structure_amount(const fitting::Structure& structure) {
  if (structure.kind == "gain")
    return significant(100.0 * structure.amount, 2) + " ± " +
           significant(100.0 * structure.std_error, 2) + " %";
  const RoundedValue shown = rounded(structure.amount, structure.std_error, structure.unit);
  std::string out =
      shown.value + (shown.error.empty() ? "" : " ± " + shown.error) + " " + shown.unit;
  if (structure.kind == "vibration") out += " at " + quantity(structure.frequency, "Hz", 4);
  return out;
}

std::string html_structures(const ChannelFit& channel) {
  std::string rows;
  for (const fitting::Structure& structure : channel.diagnostics->structures)
    rows += html_row(
        capital(structure.kind),
        {structure_amount(structure), share_text(structure.share), chance(structure.p_value)});
  if (rows.empty()) return "";
  return html_table("What the residuals after touch may look like, each taken alone",
                    {"Like", "How much", "Of the residual’s energy", "Chance by noise alone"},
                    rows);
}

/// A stem from zero at each lag.
Series stems(const std::vector<double>& values, double aside, const char* colour,
             const std::string& label) {
  Series out{label, {}, {}, colour, 3.0, 1.0, {}};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double x = static_cast<double>(k) + 1.0 + aside;
    for (const double y : {0.0, values[k], std::nan("")}) {
      out.x.push_back(x);
      out.y.push_back(y);
    }
  }
  return out;
}

Figure autocorrelation_figure(const fitting::Whiteness& whiteness) {
  Figure figure;
  figure.width = 360.0;
  figure.heading = "Do neighbours go together?";
  const double last = static_cast<double>(whiteness.autocorrelation.size()) + 1.0;
  figure.x = {"Lag in samples", {1.0, ""}, std::array<double, 2>{0.0, last}};
  figure.ticks = 5;
  Panel panel;
  panel.y = {"Autocorrelation", {1.0, ""}, {}};
  panel.series = {stems(whiteness.autocorrelation, 0.0, palette::measured, ""),
                  stems(whiteness.before, 0.3, palette::muted, "before touch")};
  panel.bands = {{-whiteness.band, whiteness.band, "95 % of chance"}};
  figure.panels = {panel};
  return figure;
}

Figure quantile_figure(const fitting::Normality& normality) {
  const double n = static_cast<double>(normality.quantiles.size());
  const boost::math::normal distribution;
  Series found{"residuals", {}, {}, palette::measured, 2.2, 1.0, {}};
  for (std::size_t i = 0; i < normality.quantiles.size(); ++i) {
    found.x.push_back(boost::math::quantile(distribution, (static_cast<double>(i) + 0.5) / n));
    found.y.push_back(normality.quantiles[i]);
  }
  const std::vector<double> ends = {found.x.front(), found.x.back()};
  Figure figure;
  figure.width = 360.0;
  figure.heading = "Are they normal?";
  figure.x = {"Of a normal distribution", {1.0, ""}, {}};
  figure.ticks = 5;
  Panel panel;
  panel.y = {"Quantile", {1.0, ""}, {}};
  panel.series = {found, {"normal", ends, ends, palette::model, 1.4, 1.0, {}, "5 3"}};
  figure.panels = {panel};
  return figure;
}

std::string html_shapes(const ChannelFit& channel) {
  const ChannelDiagnostics& found = *channel.diagnostics;
  if (found.whiteness.autocorrelation.empty() || found.normality.quantiles.size() < 2) return "";
  const std::string title = fmt::format(
      "Autocorrelation of the {}’s whitened residuals, and their quantiles against those of a "
      "normal distribution",
      channel.quantity);
  return "<figure>" +
         svg_beside(title,
                    {autocorrelation_figure(found.whiteness), quantile_figure(found.normality)}) +
         "</figure>\n";
}

/// Measured − model within the curve's time: the extremes of each of 150 stretches, enough to
/// see how wide the noise is.
Series residual_series(const ChannelFit& channel, double until) {
  constexpr std::size_t stretches = 150;
  Series all{"measured − model", {}, {}, palette::muted, 0.7, 0.7, {}};
  const std::size_t n =
      std::min({channel.time.size(), channel.measured.size(), channel.model.size()});
  for (std::size_t i = 0; i < n; ++i) {
    if (channel.time[i] < 0.0 || channel.time[i] > until) continue;
    const bool used = i >= channel.used.size() || channel.used[i] != 0;
    if (!used && channel.every > 1) continue;
    all.x.push_back(channel.time[i]);
    all.y.push_back(used ? channel.measured[i] - channel.model[i] : std::nan(""));
  }
  Series out = all;
  out.x.clear();
  out.y.clear();
  for (const std::size_t i : min_max_indices(all.y, stretches)) {
    out.x.push_back(all.x[i]);
    out.y.push_back(all.y[i]);
  }
  return out;
}

/// The contacts and what follows them, where the largest lies there; else all [s].
double shown_until(const fitting::Fit& fit, const ChannelFit& channel) {
  const fitting::Discrepancy& found = channel.diagnostics->discrepancy;
  const auto r = static_cast<std::size_t>(std::max(0, channel.recording));
  if (r >= fit.predictions.size() || fit.predictions[r].episodes.empty()) return found.time.back();
  const double close = 2.5 * fit.predictions[r].episodes.front().end;
  return found.largest_time < close ? std::min(close, found.time.back()) : found.time.back();
}

/// The residuals, and the curve with its band.
std::string html_discrepancy_plot(const fitting::Fit& fit, const ChannelFit& channel) {
  fitting::Discrepancy found = channel.diagnostics->discrepancy;
  if (found.time.size() < 2) return "";
  const double until = shown_until(fit, channel);
  const auto end = std::upper_bound(found.time.begin(), found.time.end(), until);
  found.time.erase(end, found.time.end());
  found.mean.resize(found.time.size());
  found.error.resize(found.time.size());
  Series mean{"left out by the model", found.time, found.mean, palette::model, 2.2, 1.0, {}};
  Series high{"its 95 % band", found.time, {}, palette::ink, 0.8, 1.0, {}, "4 2"};
  Series low{"", found.time, {}, palette::ink, 0.8, 1.0, {}, "4 2"};
  for (std::size_t i = 0; i < found.mean.size(); ++i) {
    high.y.push_back(found.mean[i] + 1.96 * found.error[i]);
    low.y.push_back(found.mean[i] - 1.96 * found.error[i]);
  }
  Figure figure;
  figure.title = fmt::format("What the model leaves out of the {} over time", channel.quantity);
  figure.x = {"Time after first touch", display_unit(0.5 * until, "s"),
              std::array<double, 2>{0.0, until}};
  Panel panel;
  panel.y = {capital(channel.quantity), display_unit(std::abs(found.largest), channel.unit), {}};
  panel.series = {mean, high, low, residual_series(channel, until)};
  figure.panels = {panel};
  return "<figure>" + svg(figure) + "</figure>\n";
}

std::string html_whole(const ChannelFit& channel) {
  const ChannelDiagnostics& found = *channel.diagnostics;
  if (!found.judged || found.coarse) return "";
  return fmt::format(
      "<p>The noise before touch is {} ({} samples, correlated over {}). After touch, "
      "whitened "
      "by its colour, neighbours correlate by {} (chance of all lags by noise alone: {}); the "
      "distribution is {} (Anderson–Darling: {}); the longest run of one sign has {} samples, from "
      "{} to {} after touch (chance: {}).</p>\n",
      escaped(quantity(found.noise, channel.unit)),
      grouped(static_cast<unsigned long long>(std::max(0L, found.noise_samples))),
      significant(found.noise_correlation, 2), significant(found.whiteness.lag1, 2),
      escaped(chance(found.whiteness.p_value)), escaped(found.normality.words),
      escaped(chance(found.normality.p_value)), found.run.samples, quantity(found.run.from, "s"),
      quantity(found.run.to, "s"), escaped(chance(found.run.p_value)));
}

}  // namespace

std::string html_diagnostics(const fitting::Fit& fit) {
  std::string out;
  std::size_t pictures = 0, without = 0;
  for (const ChannelFit& channel : fit.channels) {
    if (!channel.diagnostics) continue;
    const ChannelDiagnostics& found = *channel.diagnostics;
    const std::string discrepancy = discrepancy_sentence(channel);
    out += "<h4>" + escaped(channel_title(fit, channel)) + "</h4>\n<p>" +
           escaped(found.sentence + (discrepancy.empty() ? "" : " " + discrepancy)) + "</p>\n";
    if (!found.judged) continue;
    if (fit.channels.size() > most_pictures && (found.sound || pictures == most_pictures)) {
      ++without;
      continue;
    }
    ++pictures;
    out += html_phases(channel) + html_whole(channel) + html_structures(channel) +
           html_shapes(channel) + html_discrepancy_plot(fit, channel);
  }
  if (out.empty()) return "";
  if (without > 0)
    out += fmt::format(
        "<p class=\"note\">Tables and pictures of {} more channels are left out here, of sound "
        "ones "
        "and of all beyond {}; their numbers are in the JSON of this page.</p>\n",
        without, most_pictures);
  return "<h3 id=\"diagnostics\">Where the model fails</h3>\n"
         "<p>Residuals are measured − model. Each test asks for the chance that noise of the size "
         "and colour seen before touch does as much; a channel is called unsound where one of them "
         "is too rare, so that a right model is accused in at most 5 % of fits.</p>\n" +
         out;
}

}  // namespace impactrig::reports
