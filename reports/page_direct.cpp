// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/direct_wording.hpp"
#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

std::string html_row(const DirectPair& pair) {
  const fitting::DirectEstimate& e = pair.direct;
  if (!e.given())
    return fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td colspan=\"3\">{}</td></tr>\n",
        capital(pair.name), significant(pair.fitted, 3), escaped(e.absent));
  const DisplayUnit unit = display_unit(std::abs(e.value), pair.unit);
  const fitting::Contribution* const source = pair.main_source();
  const std::string suffix = unit.text.empty() ? "" : " " + unit.text;
  return fmt::format(
      "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}{}</td><td "
      "class=\"n\">{}{}</td><td>{}</td></tr>\n",
      capital(pair.name),
      std::isfinite(pair.fitted) ? to_precision_of(pair.fitted, e.std_error, unit) + suffix : "–",
      to_precision_of(e.value, e.std_error, unit), suffix, interval_text(e.ci95, e.std_error, unit),
      suffix,
      source == nullptr
          ? "–"
          : escaped(fmt::format("{}, {}", source->source,
                                percent(std::pow(source->std_error / e.std_error, 2)))));
}

std::string html_table(const std::vector<DirectPair>& pairs) {
  std::string rows;
  for (const DirectPair& pair : pairs) rows += html_row(pair);
  return "<div class=\"scroll\"><table><caption>The model against what the record shows without "
         "one, first contact</caption>\n<thead><tr><th scope=\"col\"></th><th scope=\"col\" "
         "class=\"n\">Fitted model</th><th scope=\"col\" class=\"n\">Direct</th><th scope=\"col\" "
         "class=\"n\">95 % interval of the direct value</th><th scope=\"col\">Largest source and "
         "its share of the variance</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

/// Every source of uncertainty, one column an estimate.
std::string html_budget(const std::vector<DirectPair>& pairs) {
  std::vector<std::string> sources;
  std::string head;
  for (const DirectPair& pair : pairs) {
    if (!pair.direct.given()) continue;
    head += fmt::format("<th scope=\"col\" class=\"n\">{}</th>", capital(pair.name));
    for (const fitting::Contribution& part : pair.direct.budget)
      if (std::ranges::find(sources, part.source) == sources.end()) sources.push_back(part.source);
  }
  if (sources.empty()) return "";
  const auto cell = [](const DirectPair& pair, double error) {
    // Below a millionth of the whole: rounding, where a source cancels.
    if (!(error > 1e-6 * pair.direct.std_error)) return std::string("<td class=\"n\">0</td>");
    return fmt::format("<td class=\"n\">{}</td>", quantity(error, pair.unit, 2));
  };
  std::string rows;
  for (const std::string& source : sources) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th>", escaped(capital(source)));
    for (const DirectPair& pair : pairs) {
      if (!pair.direct.given()) continue;
      const auto found =
          std::ranges::find(pair.direct.budget, source, &fitting::Contribution::source);
      rows += found == pair.direct.budget.end() ? "<td class=\"n\">–</td>"
                                                : cell(pair, found->std_error);
    }
    rows += "</tr>\n";
  }
  rows += "<tr class=\"strong\"><th scope=\"row\">Together</th>";
  for (const DirectPair& pair : pairs)
    if (pair.direct.given()) rows += cell(pair, pair.direct.std_error);
  return "<div class=\"scroll\"><table><caption>Uncertainty of the direct values: standard "
         "uncertainty by source</caption>\n<thead><tr><th scope=\"col\"></th>" +
         head + "</tr></thead>\n<tbody>" + rows + "</tr></tbody></table></div>\n";
}

/// The first contact as the model has it.
Series model_loop(const models::Simulation& run) {
  Series loop{
      .label = "model", .x = {}, .y = {}, .colour = palette::model, .width = 1.8, .arrows = {}};
  const models::History& history = run.history;
  if (run.episodes.empty()) return loop;
  const std::size_t n = std::min(history.force.size(), history.penetration.size());
  for (std::size_t i = 0; i < n; ++i) {
    const double t = history.start + history.interval * static_cast<double>(i);
    if (t < 0.0 || t > run.episodes.front().end) continue;
    loop.x.push_back(history.penetration[i]);
    loop.y.push_back(history.force[i]);
  }
  return loop;
}

/// Whether a low-pass or a resampling made one of a recording's channels, of which it tells nothing
/// that is faster.
bool is_filtered(const fitting::Fit& fit, std::size_t recording) {
  return std::ranges::any_of(fit.channels, [recording](const fitting::ChannelFit& channel) {
    return static_cast<std::size_t>(channel.recording) == recording && channel.every > 1;
  });
}

std::string html_direct_loop(const fitting::Fit& fit, std::size_t recording) {
  const fitting::Hysteresis& measured = fit.direct[recording].hysteresis;
  if (measured.force.empty()) return "";
  Figure figure;
  figure.title = "Contact force over penetration, measured and modelled";
  figure.width = 460.0;
  figure.ticks = 5;
  Panel panel;
  panel.height = 250.0;
  panel.ticks = 5;
  if (recording < fit.predictions.size()) panel.series = {model_loop(fit.predictions[recording])};
  panel.series.push_back({.label = "measured",
                          .x = measured.penetration,
                          .y = measured.force,
                          .colour = palette::measured,
                          .width = 1.1,
                          .arrows = {}});
  double depth = 0.0, force = 0.0, least = 0.0;
  for (const Series& series : panel.series) {
    for (const double x : series.x) {
      depth = std::max(depth, x);
      least = std::min(least, x);
    }
    for (const double y : series.y) force = std::max(force, y);
  }
  figure.x = {"Penetration", display_unit(depth, "m"), {{least - 0.03 * depth, 1.04 * depth}}};
  panel.y = {"Force", display_unit(force, "N"), {}};
  figure.panels = {panel};
  return fmt::format(
      "<figure class=\"loop direct\">{}<figcaption>Force over penetration of the first contact: "
      "measured (the velocity's integral, both sensors' responses taken off{}) and as the fitted "
      "model has it. The area is the energy dissipated.</figcaption></figure>\n",
      svg(figure),
      is_filtered(fit, recording) ? ", what the record's filters took not put back" : "");
}

}  // namespace

std::string html_direct(const fitting::Fit& fit) {
  std::string out;
  for (std::size_t r = 0; r < fit.direct.size(); ++r) {
    const std::vector<DirectPair> pairs = direct_pairs(fit, r);
    out += fit.direct.size() > 1
               ? fmt::format("<h3>Without a model: {}</h3>\n", escaped(recording_name(fit, r)))
               : "<h3>Without a model</h3>\n";
    out += "<p>" + escaped(direct_explanation(fit, r)) + "</p>\n";
    if (std::ranges::none_of(pairs, [](const DirectPair& p) { return p.direct.given(); })) continue;
    out += html_table(pairs) + html_direct_loop(fit, r) + html_budget(pairs);
  }
  return out;
}

}  // namespace impactrig::reports
