// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

using Range = std::array<double, 2>;

std::size_t samples(const fitting::ChannelFit& channel) {
  return std::min({channel.time.size(), channel.measured.size(), channel.model.size()});
}

bool used(const fitting::ChannelFit& channel, std::size_t i) {
  return i >= channel.used.size() || channel.used[i] != 0;
}

/// First and last fitted instant; everything when nothing was fitted.
Range fitted_window(const fitting::ChannelFit& channel) {
  Range out{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < samples(channel); ++i) {
    if (!used(channel, i)) continue;
    out[0] = std::min(out[0], channel.time[i]);
    out[1] = std::max(out[1], channel.time[i]);
  }
  if (!(out[0] < out[1]) && samples(channel) > 0)
    out = {channel.time.front(), channel.time[samples(channel) - 1]};
  return out;
}

/// Spans of time a recording's plots can be set to.
struct Views {
  Range contact;  ///< the contacts and one and a half times as much after them: what is shown first
  Range fitted;   ///< what entered the fit, and a margin
};

Views views(const fitting::Fit& fit, int recording) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Range fitted{infinity, -infinity}, all{infinity, -infinity};
  for (const fitting::ChannelFit& channel : fit.channels) {
    if (channel.recording != recording || samples(channel) == 0) continue;
    const Range window = fitted_window(channel);
    fitted = {std::min(fitted[0], window[0]), std::max(fitted[1], window[1])};
    all = {std::min(all[0], channel.time.front()),
           std::max(all[1], channel.time[samples(channel) - 1])};
  }
  if (!(all[0] < all[1])) return {{0.0, 1e-3}, {0.0, 1e-3}};
  const auto within = [&](double from, double to) {
    const Range out{std::max(all[0], from), std::min(all[1], to)};
    return out[0] < out[1] ? out : all;
  };
  const double margin = (fitted[1] - fitted[0]) / 20.0;
  Views out;
  out.fitted = out.contact = within(fitted[0] - margin, fitted[1] + margin);
  const auto r = static_cast<std::size_t>(std::max(0, recording));
  if (r >= fit.predictions.size() || fit.predictions[r].episodes.empty()) return out;
  const double end = fit.predictions[r].episodes.back().end;
  if (end > 0.0) out.contact = within(-0.25 * end, 2.5 * end);
  return out;
}

/// The end of what was simulated [s]: beyond it the model's curve means nothing.
double simulated_until(const fitting::Fit& fit, const fitting::ChannelFit& channel) {
  const auto r = static_cast<std::size_t>(std::max(0, channel.recording));
  const double duration = r < fit.predictions.size() ? fit.predictions[r].duration : 0.0;
  return duration > 0.0 ? duration : std::numeric_limits<double>::infinity();
}

/// The stretches of time inside `view` that did not enter the fit; not those between samples of
/// which it took one in so many.
std::vector<Band> not_fitted(const fitting::ChannelFit& channel, const Range& view) {
  std::vector<Band> out;
  const std::size_t n = samples(channel);
  for (std::size_t i = 0; i < n; ++i) {
    if (used(channel, i) || channel.time[i] < view[0] || channel.time[i] > view[1]) continue;
    std::size_t last = i;
    while (last + 1 < n && !used(channel, last + 1) && channel.time[last + 1] <= view[1]) ++last;
    const std::size_t from = i;
    i = last;
    if (last - from + 1 < channel.every) continue;
    const double until = last + 1 < n ? channel.time[last + 1] : channel.time[last];
    out.push_back({std::max(view[0], channel.time[from]), std::min(view[1], until),
                   out.empty() ? "not fitted" : ""});
  }
  return out;
}

/// The two curves and, below, their difference in units of the noise, for paper.
struct Curves {
  Series measured, model, residual;
};

/// How far from zero residuals are drawn: what was not fitted, as a clipped crest, may be so far
/// off that nothing would be seen of the others.
double drawn_residual(const fitting::ChannelFit& channel) {
  constexpr double beyond = 1.5;  // of the largest fitted one
  double most = 0.0;
  for (std::size_t i = 0; i < samples(channel); ++i)
    if (used(channel, i) && std::isfinite(channel.model[i]))
      most = std::max(most, std::abs(channel.measured[i] - channel.model[i]));
  return most > 0.0 ? beyond * most : std::numeric_limits<double>::infinity();
}

Curves curves(const fitting::ChannelFit& channel, const Range& view, double unit, double until) {
  Curves out;
  out.measured = {"measured", {}, {}, palette::measured, 1.0, 1.0, {}};
  out.model = {"model", {}, {}, palette::model, 4.0, 1.0, {}};
  out.residual = {"", {}, {}, palette::measured, 0.8, 1.0, {}};
  const double drawn = drawn_residual(channel);
  for (std::size_t i = 0; i < samples(channel); ++i) {
    if (channel.time[i] < view[0] || channel.time[i] > view[1]) continue;
    for (Series* series : {&out.measured, &out.model, &out.residual})
      series->x.push_back(channel.time[i]);
    out.measured.y.push_back(channel.measured[i]);
    const double model = channel.time[i] <= until ? channel.model[i] : std::nan("");
    out.model.y.push_back(model);
    const double residual = channel.measured[i] - model;
    out.residual.y.push_back(std::abs(residual) <= drawn ? residual / unit : std::nan(""));
  }
  return out;
}

double largest(const std::vector<double>& values) {
  double out = 0.0;
  for (const double value : values)
    if (std::isfinite(value)) out = std::max(out, std::abs(value));
  return out;
}

struct PlotUnits {
  DisplayUnit time, value;
  double noise = 0.0;  ///< [SI], what the residual is divided by; 1 when not known
  std::string residual_unit;
};

PlotUnits plot_units(const fitting::ChannelFit& channel, const Range& view) {
  PlotUnits units;
  // Half: up to 2 ms an axis in microseconds reads better, and the contacts are told in them.
  units.time = display_unit(0.5 * std::max(std::abs(view[0]), std::abs(view[1])), "s");
  units.value =
      display_unit(std::max(largest(channel.measured), largest(channel.model)), channel.unit);
  const bool known = channel.noise > 0.0 && std::isfinite(channel.noise);
  units.noise = known ? channel.noise : 1.0 / units.value.factor;
  units.residual_unit = known ? "noise" : units.value.text;
  return units;
}

Figure static_figure(const fitting::ChannelFit& channel, const Range& view, const PlotUnits& units,
                     double until) {
  const Curves found = curves(channel, view, units.noise, until);
  Figure figure;
  figure.title = fmt::format(
      "{} over time, measured and as the model predicts it; below, the "
      "residual",
      capital(channel.quantity));
  figure.x = {"Time after first touch", units.time, view};
  figure.shaded = not_fitted(channel, view);
  Panel history;
  history.y = {capital(channel.quantity), units.value, {}};
  history.series = {found.measured, found.model};
  Panel residual;
  residual.y = {"Measured − model", {1.0, units.residual_unit}, {}};
  residual.series = {found.residual};
  residual.height = 84.0;
  residual.ticks = 3;
  if (units.residual_unit == "noise") residual.bands = {{-1.96, 1.96, "95 % of pure noise"}};
  figure.panels = {history, residual};
  return figure;
}

std::string html_data(const char* name, double value) {
  return fmt::format(" data-{}=\"{}\"", name, value);
}

std::string html_plot(const fitting::Fit& fit, std::size_t index, const Views& shown) {
  const fitting::ChannelFit& channel = fit.channels[index];
  const Range& view = shown.contact;
  const double until = simulated_until(fit, channel);
  const PlotUnits units = plot_units(channel, view);
  std::string out = fmt::format(
      "<figure class=\"plot\" data-curve=\"{}\" data-name=\"{}\" data-x-unit=\"{}\" "
      "data-y-unit=\"{}\" data-residual-unit=\"{}\"",
      index, escaped(capital(channel.quantity)), escaped(units.time.text),
      escaped(units.value.text), escaped(units.residual_unit));
  out += html_data("x-factor", units.time.factor) + html_data("y-factor", units.value.factor) +
         html_data("noise", units.noise) + html_data("from", view[0]) + html_data("to", view[1]) +
         html_data("fitted-from", shown.fitted[0]) + html_data("fitted-to", shown.fitted[1]);
  if (std::isfinite(until)) out += html_data("until", until);
  out += ">\n";
  if (!channel.channel.empty() && channel.channel != channel.quantity)
    out += "<figcaption>Channel " + escaped(channel.channel) + "</figcaption>\n";
  out += "<div class=\"still\">" + svg(static_figure(channel, view, units, until)) +
         "</div>\n</figure>\n";
  return out;
}

std::string html_recording(const ReportData& data, std::size_t recording) {
  const fitting::Fit& fit = data.fit;
  const Views shown = views(fit, static_cast<int>(recording));
  std::string plots;
  bool force = false, motion = false;
  for (std::size_t i = 0; i < fit.channels.size(); ++i) {
    if (fit.channels[i].recording != static_cast<int>(recording) || samples(fit.channels[i]) == 0)
      continue;
    force = force || fit.channels[i].quantity == "force";
    motion = motion || fit.channels[i].quantity != "force";
    plots += html_plot(fit, i, shown);
  }
  std::string text;
  if (recording < fit.impacts.size() && fit.impacts.size() > 1)
    text += fmt::format("<h3 id=\"recording-{}\">{}</h3>\n", recording + 1,
                        escaped(recording_name(fit, recording)));
  if (plots.empty())
    return text + "<p>No channel of this recording was compared with the model.</p>\n";
  if (!motion)
    text +=
        "<p>No velocity was compared: approach speed and restitution rest on the force and the "
        "rig file alone.</p>\n";
  if (!force)
    text += "<p>No force was compared: the contact’s stiffness rests on the motion alone.</p>\n";
  return fmt::format("{}<div class=\"recording\" data-recording=\"{}\">\n{}</div>\n", text,
                     recording, plots);
}

}  // namespace

std::string html_measured(const ReportData& data) {
  std::string body =
      "<p>The model is drawn as the sensor would have shown it: through the sensor’s resonance and "
      "the amplifier’s band, with delay, gain and offset. Beneath each history is what the model "
      "does not explain, in units of the noise seen before the trigger: pure noise stays within "
      "±1.96 for 95 % of the samples.</p>\n"
      "<p class=\"hint\">Drag to zoom, turn the wheel to zoom at the pointer, shift-drag to move, "
      "double click for the contact; the plots of one recording move together.</p>\n";
  std::size_t recordings = std::max<std::size_t>(1, data.fit.impacts.size());
  for (std::size_t r = 0; r < recordings; ++r) body += html_recording(data, r);
  return html_section("measured", "What was measured", body);
}

}  // namespace impactrig::reports
