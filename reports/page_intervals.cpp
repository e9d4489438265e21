// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

constexpr double quantile = 3.841458820694124;  // of chi-square, 1 degree of freedom, 95 %
constexpr std::size_t beside = 3;               // pictures in a row
constexpr double picture_width = 240.0;         // [px]

DisplayUnit unit_for(const fitting::Parameter& p) {
  return display_unit(std::max(std::abs(p.value), p.std_error), p.unit);
}

std::string profile_text(const fitting::Profile& profile, const fitting::Parameter& p) {
  const DisplayUnit unit = unit_for(p);
  const double error = p.std_error > 0.0 ? p.std_error : 0.01 * std::abs(p.value);
  const auto limit = [&](const std::optional<double>& value) {
    return value ? to_precision_of(*value, error, unit) : std::string("no limit");
  };
  return limit(profile.lower) + " to " + limit(profile.upper);
}

/// Whether other intervals than that of the covariance were found.
bool has_other_interval(const fitting::Fit& fit, const fitting::Parameter& p) {
  const auto is_of = [&](const auto& other) { return other.name == p.name; };
  return std::ranges::any_of(fit.profiles, is_of) ||
         (fit.bootstrap && std::ranges::any_of(fit.bootstrap->parameters, is_of));
}

/// One row a parameter, one column a kind of interval.
std::string html_kinds(const fitting::Fit& fit) {
  std::string rows;
  for (const fitting::Parameter& p : fit.parameters) {
    if (!has_other_interval(fit, p)) continue;
    const DisplayUnit unit = unit_for(p);
    std::string profile = "–", bootstrap = "–", bias = "–";
    for (const fitting::Profile& other : fit.profiles)
      if (other.name == p.name) profile = profile_text(other, p);
    if (fit.bootstrap)
      for (const fitting::Bootstrap::Parameter& other : fit.bootstrap->parameters)
        if (other.name == p.name) {
          if (has_interval(other.ci95))
            bootstrap = interval_text(other.ci95, other.std_error, unit);
          bias = significant(other.bias / other.std_error, 2);
        }
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"u\">{}</td><td class=\"n\">{}</td>"
        "<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        html_code(p.name), escaped(unit.text),
        has_interval(p.ci95) ? interval_text(p.ci95, p.std_error, unit) : "–", escaped(profile),
        escaped(bootstrap), escaped(bias));
  }
  return "<div class=\"scroll\"><table><caption>95 % intervals of several kinds</caption>\n<thead>"
         "<tr><th scope=\"col\">Parameter</th><th scope=\"col\">Unit</th><th scope=\"col\" "
         "class=\"n\">Covariance</th><th scope=\"col\" class=\"n\">Profile</th><th scope=\"col\" "
         "class=\"n\">Bootstrap</th><th scope=\"col\" class=\"n\">Bias, standard errors</th></tr>"
         "</thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

/// Δχ² of one parameter, and the parabola that its standard error makes.
Figure picture(const fitting::Profile& profile, const fitting::Parameter& p) {
  Figure figure;
  figure.title = "Profile likelihood of " + p.name;
  figure.heading = p.name;
  figure.width = picture_width;
  figure.ticks = 3;
  figure.x = {.name = "", .unit = unit_for(p), .range = {}};
  Series data{
      .label = "", .x = {}, .y = {}, .colour = palette::measured, .width = 1.8, .arrows = {}};
  Series parabola{
      .label = "", .x = {}, .y = {}, .colour = palette::model, .width = 1.2, .arrows = {}};
  parabola.dashes = "5 3";
  const double top = 2.0 * quantile;
  for (std::size_t i = 0; i < profile.value.size(); ++i)
    if (profile.delta_chi2[i] <= top) {
      data.x.push_back(profile.value[i]);
      data.y.push_back(profile.delta_chi2[i]);
    }
  for (int i = -50; i <= 50 && p.std_error > 0.0; ++i) {
    const double z = 0.05 * i;
    if (z * z > top) continue;
    parabola.x.push_back(p.value + z * p.std_error);
    parabola.y.push_back(z * z);
  }
  Panel panel;
  panel.y = {.name = "Δχ²", .unit = {}, .range = std::array{0.0, top}};
  panel.height = 150.0;
  panel.series = {data};
  if (!parabola.x.empty()) panel.series.push_back(parabola);
  panel.bands.push_back({.low = 0.0, .high = quantile, .label = ""});
  figure.panels.push_back(panel);
  return figure;
}

std::string html_pictures(const fitting::Fit& fit) {
  std::vector<Figure> figures;
  for (const fitting::Profile& profile : fit.profiles)
    for (const fitting::Parameter& p : fit.parameters)
      if (p.name == profile.name) figures.push_back(picture(profile, p));
  std::string html;
  for (std::size_t i = 0; i < figures.size(); i += beside) {
    const auto first = figures.begin() + static_cast<std::ptrdiff_t>(i);
    const auto last =
        figures.begin() + static_cast<std::ptrdiff_t>(std::min(i + beside, figures.size()));
    html += "<figure>" + svg_beside("Profile likelihood", {first, last}) + "</figure>\n";
  }
  return html;
}

}  // namespace

std::string html_intervals(const fitting::Fit& fit) {
  if (fit.profiles.empty() && !fit.bootstrap) return "";
  std::string html = html_kinds(fit);
  if (!fit.profiles.empty())
    html +=
        "<p>Profile likelihood: how much worse the data are explained when one parameter is held "
        "and all others follow (blue), and what the standard error says of it (dashed). Within "
        "the band is the 95 % interval; where the curve leaves the dashed one, the standard error "
        "is not the whole story. A side without limit is one on which the data do not bound the "
        "parameter.</p>\n" +
        html_pictures(fit);
  if (fit.bootstrap)
    html +=
        fmt::format("<p class=\"note\">Bootstrap: {} refits of {}, seed {}, {}.</p>\n",
                    fit.bootstrap->draws - fit.bootstrap->failed,
                    fit.bootstrap->kind == fitting::BootstrapKind::parametric
                        ? "data drawn from the fitted model and its noise"
                        : "the fitted model with residuals whose signs were drawn block by block",
                    fit.bootstrap->seed, quantity(fit.bootstrap->seconds, "s"));
  return html;
}

}  // namespace impactrig::reports
