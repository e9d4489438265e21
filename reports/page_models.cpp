// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <fmt/format.h>

#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

std::string ratio_text(double chi2, long dof) {
  return significant(chi2 / static_cast<double>(std::max(1L, dof)), 3);
}

std::string name_cell(const fitting::ModelScore& s) {
  return escaped(s.label) +
         (s.note.empty() ? "" : fmt::format("<br><small>{}</small>", escaped(s.note)));
}

std::string html_row(const fitting::ModelScore& s, bool held_out) {
  if (!s.failure.empty())
    return fmt::format(
        "<tr><th scope=\"row\">{}</th><td colspan=\"{}\">could not be fitted: {}</td></tr>\n",
        name_cell(s), held_out ? 8 : 7, escaped(s.failure));
  return fmt::format(
      "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}</td>"
      "<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
      "{}<td>{}</td></tr>\n",
      name_cell(s), s.unknowns, ratio_text(s.chi2, s.dof), significant(s.aicc, 6),
      significant(s.bic, 6), significant(s.delta, 3), significant(s.weight, 2),
      !held_out    ? ""
      : s.held_out ? "<td class=\"n\">" + ratio_text(s.held_out->chi2, s.held_out->dof) + "</td>"
                   : "<td class=\"n\">–</td>",
      s.sound ? "explains the data" : "does not explain the data");
}

}  // namespace

std::string html_models(const ReportData& data) {
  if (!data.models) return "";
  const fitting::ModelComparison& models = *data.models;
  const bool held_out = std::ranges::any_of(
      models.scores, [](const fitting::ModelScore& s) { return s.held_out.has_value(); });
  std::string rows;
  for (const fitting::ModelScore& s : models.scores) rows += html_row(s, held_out);
  std::string body = "<p>" + escaped(models.sentence) + "</p>\n";
  body += fmt::format(
      "<div class=\"scroll\"><table><caption>Models, best first</caption>\n<thead><tr>"
      "<th scope=\"col\">Model</th><th scope=\"col\" class=\"n\">Unknowns</th>"
      "<th scope=\"col\" class=\"n\">χ² a degree of freedom</th><th scope=\"col\" "
      "class=\"n\">AICc</th>"
      "<th scope=\"col\" class=\"n\">BIC</th><th scope=\"col\" class=\"n\">Δ</th>"
      "<th scope=\"col\" class=\"n\">Akaike weight</th>{}<th "
      "scope=\"col\">Residuals</th></tr></thead>\n"
      "<tbody>{}</tbody></table></div>\n",
      held_out ? "<th scope=\"col\" class=\"n\">χ² of held-out shots</th>" : "", rows);
  body += fmt::format(
      "<p class=\"note\">Δ and weight are by AICc with χ² divided by {}, the best model’s χ² a "
      "degree of freedom (1 at least): differences between models all of which are wrong do not "
      "count as if noise were all there is.{}</p>\n",
      significant(models.inflation, 3),
      held_out ? " Held-out shots are foretold by the parameters that the other shots gave; only "
                 "their own speed, touch, background and calibration are fitted."
               : "");
  return html_section("models", "Which model", body);
}

}  // namespace impactrig::reports
