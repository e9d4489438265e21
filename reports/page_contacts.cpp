// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

/// Where force passes half of its peak on the way in and on the way out.
std::vector<std::size_t> half_peak(const std::vector<double>& force) {
  const auto peak = std::max_element(force.begin(), force.end());
  if (peak == force.end() || *peak <= 0.0) return {};
  const auto above = [&](double f) { return f >= 0.5 * *peak; };
  const auto in = std::find_if(force.begin(), peak, above);
  const auto out = std::find_if_not(peak, force.end(), above);
  std::vector<std::size_t> found{static_cast<std::size_t>(in - force.begin())};
  if (out != force.end()) found.push_back(static_cast<std::size_t>(out - force.begin()));
  return found;
}

/// Force over penetration, one series a contact, the first one strong. Touch and separation are
/// added where the samples left them out.
std::vector<Series> loops(const models::History& history) {
  std::vector<Series> out;
  const std::size_t n = std::min(history.force.size(), history.penetration.size());
  bool inside = false;
  for (std::size_t i = 0; i < n; ++i) {
    const bool touching = history.penetration[i] > 0.0;
    if (touching && !inside) {
      Series loop;
      const bool first = out.empty();
      loop.label = first ? "first contact" : out.size() == 1 ? "later contacts" : "";
      loop.colour = first ? palette::model : palette::muted;
      loop.width = first ? 1.8 : 1.1;
      loop.x = loop.y = {0.0};
      out.push_back(loop);
    }
    inside = touching;
    if (touching) {
      out.back().x.push_back(history.penetration[i]);
      out.back().y.push_back(history.force[i]);
    } else if (!out.empty() && out.back().x.back() != 0.0) {
      out.back().x.push_back(0.0);
      out.back().y.push_back(0.0);
    }
  }
  for (Series& loop : out)
    if (loop.colour == palette::model) loop.arrows = half_peak(loop.y);
  return out;
}

std::string html_loop(const models::Simulation& run) {
  const std::vector<Series> series = loops(run.history);
  if (series.empty())
    return "<p>The prediction was stored without its history, so there is no force-penetration "
           "loop "
           "to show.</p>\n";
  Figure figure;
  figure.title = "Contact force over penetration, as predicted";
  figure.width = 460.0;
  figure.ticks = 5;
  double depth = 0.0, force = 0.0;
  for (const Series& loop : series) {
    depth = std::max(depth, *std::max_element(loop.x.begin(), loop.x.end()));
    force = std::max(force, *std::max_element(loop.y.begin(), loop.y.end()));
  }
  figure.x = {"Penetration", display_unit(depth, "m"), {{0.0, 1.04 * depth}}};
  Panel panel;
  panel.y = {"Force", display_unit(force, "N"), {{0.0, 1.06 * force}}};
  panel.height = 250.0;
  panel.series = series;
  panel.ticks = 5;
  figure.panels = {panel};
  return fmt::format(
      "<figure class=\"loop\">{}<figcaption>Force over penetration, as predicted. The "
      "area within a loop is the energy that contact dissipates; arrows show the "
      "direction of time.</figcaption></figure>\n",
      svg(figure));
}

/// One column of the table of contacts, its unit in the head.
struct EpisodeColumn {
  const char* title;
  const char* unit;
  int digits;
  double (*value)(const models::Episode&);
};

constexpr std::array<EpisodeColumn, 8> episode_columns{{
    {"begins", "s", 3, [](const models::Episode& e) { return e.start; }},
    {"lasts", "s", 3, [](const models::Episode& e) { return e.end - e.start; }},
    {"peak force", "N", 4, [](const models::Episode& e) { return e.peak_force; }},
    {"impulse", "N s", 3, [](const models::Episode& e) { return e.impulse; }},
    {"deepest", "m", 3, [](const models::Episode& e) { return e.max_penetration; }},
    {"speed in", "m/s", 3, [](const models::Episode& e) { return e.approach_velocity; }},
    {"speed out", "m/s", 3,
     [](const models::Episode& e) { return e.open ? std::nan("") : e.separation_velocity; }},
    {"dissipated", "J", 3, [](const models::Episode& e) { return e.dissipated; }},
}};

double longest_stay(const models::Simulation& run) {
  double out = 0.0;
  for (const models::Episode& episode : run.episodes)
    out = std::max(out, episode.end - episode.start);
  return out;
}

std::string html_episodes(const models::Simulation& run) {
  if (run.episodes.empty())
    return "<p>The prediction has no contact: the bar never reached the stop.</p>\n";
  std::vector<std::string> rows(run.episodes.size());
  std::string head = "<th scope=\"col\" class=\"n\">No.</th>";
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = fmt::format("<tr><th scope=\"row\" class=\"n\">{}</th>", i + 1);
  for (const EpisodeColumn& column : episode_columns) {
    std::vector<double> values;
    for (const models::Episode& episode : run.episodes) values.push_back(column.value(episode));
    const double at_least = *column.unit == 's' ? longest_stay(run) : 0.0;
    const NumberColumn shown = number_column(values, column.unit, column.digits, at_least);
    head += fmt::format("<th scope=\"col\" class=\"n\">{}<span>[{}]</span></th>", column.title,
                        shown.unit.text);
    for (std::size_t i = 0; i < rows.size(); ++i)
      rows[i] += "<td class=\"n\">" + shown.cells[i] + "</td>";
  }
  std::string body;
  for (const std::string& row : rows) body += row + "</tr>\n";
  std::string out =
      "<div class=\"scroll\"><table><caption>Every contact of the run</caption>\n<thead><tr>" +
      head + "</tr></thead>\n<tbody>" + body + "</tbody></table></div>\n";
  if (run.episodes.back().open)
    out += "<p class=\"note\">The last contact was still closed when the run ended.</p>\n";
  return out;
}

std::string beam_text(const models::Solver& solver) {
  const auto count = [](int n) { return count_word(static_cast<std::size_t>(std::max(0, n))); };
  if (solver.model == models::BeamModel::hybrid)
    return fmt::format("hybrid coordinates: {} bending and {} axial modes, {} basis",
                       count(solver.modes), count(solver.axial_modes), models::name(solver.basis));
  if (solver.model == models::BeamModel::ancf)
    return fmt::format(
        "absolute nodal coordinates: {} elements from the hinge to the struck point, "
        "{} from there to the tip",
        count(solver.elements[0]), count(solver.elements[1]));
  return "rigid";
}

std::string html_how(const models::Simulation& run, const models::Contact& contact) {
  const auto fact = [](const char* term, const std::string& text) {
    return fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", term, escaped(text));
  };
  std::string out =
      "<dl class=\"list\">" + fact("Bar", beam_text(run.solver)) +
      fact("Contact force", contact.law + " law") + fact("Contact damping", contact.damping) +
      fact("Integration",
           fmt::format("to {} relative, {} steps", significant(run.solver.accuracy, 1),
                       grouped(static_cast<unsigned long long>(std::max(0L, run.cost.steps)))));
  if (!run.termination.empty()) out += fact("Ended", run.termination);
  out += "</dl>\n";
  if (!run.skipped.empty())
    out += "<p>Left out, since this impact does not need it:</p>\n" + html_list(run.skipped);
  return out;
}

std::string html_prediction_of(const fitting::Fit& fit, std::size_t r) {
  const models::Simulation& run = fit.predictions[r];
  std::string out;
  if (fit.predictions.size() > 1) out += "<h3>" + escaped(recording_name(fit, r)) + "</h3>\n";
  return out + "<div class=\"split\">" + html_loop(run) + "<div>" +
         html_how(run, fit.rig.rig.contact) + "</div></div>\n" + html_episodes(run);
}

}  // namespace

std::string html_contacts(const ReportData& data) {
  const fitting::Fit& fit = data.fit;
  std::string body;
  for (std::size_t r = 0; r < fit.predictions.size(); ++r) body += html_prediction_of(fit, r);
  if (body.empty()) body = "<p>No prediction is stored with this fit.</p>\n";
  return html_section("contact", "The contact, as predicted", body);
}

}  // namespace impactrig::reports
