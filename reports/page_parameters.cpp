// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

/// What a reader must know before using the number; "" when nothing.
std::string remark(const fitting::Parameter& parameter, const DisplayUnit& shown) {
  if (parameter.at_bound) {
    const bool lower =
        std::abs(parameter.value - parameter.lower) <= std::abs(parameter.value - parameter.upper);
    const double bound = lower ? parameter.lower : parameter.upper;
    return fmt::format("at its {} bound{}", lower ? "lower" : "upper",
                       std::isfinite(bound) ? " of " + significant(bound * shown.factor, 3) +
                                                  (shown.text.empty() ? "" : " " + shown.text)
                                            : "");
  }
  if (!parameter.identifiable) return "these data cannot tell";
  if (!(parameter.std_error > 0.0) || !std::isfinite(parameter.std_error))
    return "uncertainty could not be estimated";
  return "";
}

/// How the number came about, where not by itself.
std::string note_of(const fitting::Parameter& parameter) {
  if (!parameter.tied_to.empty()) return "tied to " + parameter.tied_to;
  return parameter.by_logarithm ? "by its logarithm: the interval goes by a factor" : "";
}

std::string prior_text(const fitting::Parameter& parameter, const DisplayUnit& shown) {
  if (!parameter.prior) return "none";
  const auto [mean, error] = *parameter.prior;
  return to_precision_of(mean, error, shown) + " ± " + significant(error * shown.factor, 2);
}

std::string html_row(const fitting::Parameter& parameter) {
  const RoundedValue value = rounded(parameter.value, parameter.std_error, parameter.unit);
  const double size = std::isfinite(parameter.std_error)
                          ? std::max(std::abs(parameter.value), parameter.std_error)
                          : std::abs(parameter.value);
  const DisplayUnit shown = display_unit(size, parameter.unit);
  const std::string label = parameter_label(parameter.name);
  const std::string warning = remark(parameter, shown);
  const std::string head = label.empty()
                               ? html_code(parameter.name)
                               : escaped(label) + "<span>" + html_code(parameter.name) + "</span>";
  return fmt::format(
      "<tr{}><th scope=\"row\">{}</th><td class=\"n v\">{}</td><td class=\"e\">{}</td>"
      "<td class=\"u\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
      "<td class=\"r\">{}</td></tr>\n",
      warning.empty() ? "" : " class=\"flagged\"", head, value.value,
      value.error.empty() ? "" : "± " + value.error, escaped(value.unit),
      has_interval(parameter.ci95) ? interval_text(parameter.ci95, parameter.std_error, shown)
                                   : "–",
      to_precision_of(parameter.initial, parameter.std_error, shown), prior_text(parameter, shown),
      warning.empty() ? escaped(note_of(parameter))
                      : "<span class=\"flag\">" + escaped(warning) + "</span>");
}

std::string html_table(const fitting::Fit& fit) {
  std::string physics, chain;
  for (const fitting::Parameter& parameter : fit.parameters)
    (parameter.nuisance ? chain : physics) += html_row(parameter);
  const auto group = [](const char* title, const std::string& rows) {
    return rows.empty() ? std::string()
                        : fmt::format(
                              "<tbody><tr class=\"group\"><th colspan=\"8\" "
                              "scope=\"rowgroup\">{}</th></tr>\n{}</tbody>\n",
                              title, rows);
  };
  return "<div class=\"scroll\"><table class=\"parameters\"><thead><tr><th scope=\"col\">Parameter"
         "</th><th scope=\"col\" class=\"n\">Value</th><th scope=\"col\">± standard error</th>"
         "<th scope=\"col\">Unit</th><th scope=\"col\" class=\"n\">95 % interval</th>"
         "<th scope=\"col\" class=\"n\">Initial</th><th scope=\"col\" class=\"n\">Prior</th>"
         "<th scope=\"col\">Remark</th></tr></thead>\n" +
         group("Of the impact", physics) + group("Of the measuring chain and the timing", chain) +
         "</table></div>\n";
}

/// Two decimals, more where they would round to 1.
std::string correlation_text(double r) {
  const int decimals = std::abs(r) < 0.995 ? 2 : std::abs(r) < 0.9995 ? 3 : 5;
  return tick_text(r, decimals);
}

/// A number and the shade of it: blue positive, orange negative, white at 0.
std::string html_cell(double r) {
  if (!std::isfinite(r)) return "<td class=\"n\">–</td>";
  const double strength = std::min(1.0, std::abs(r)) * 0.55;
  return fmt::format("<td class=\"n\" style=\"background:rgba({},{:.2f})\">{}</td>",
                     r >= 0.0 ? "43,108,176" : "209,72,10", strength, correlation_text(r));
}

std::string html_matrix(const fitting::Fit& fit) {
  std::string rows;
  const auto n = static_cast<std::size_t>(fit.correlations.rows());
  for (std::size_t i = 0; i < n; ++i) {
    rows += fmt::format("<tr><th scope=\"row\"><b>{}</b> {}</th>", i + 1,
                        html_code(fit.parameters[i].name));
    for (std::size_t j = 0; j < n; ++j) {
      if (j < i)
        rows +=
            html_cell(fit.correlations(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
      else
        rows += j == i ? "<td class=\"n self\">1</td>" : "<td class=\"void\"></td>";
    }
    rows += "</tr>\n";
  }
  std::string head = "<th scope=\"col\">Parameter</th>";
  for (std::size_t i = 0; i < n; ++i)
    head += fmt::format("<th scope=\"col\" class=\"n\">{}</th>", i + 1);
  return "<div class=\"scroll\"><table "
         "class=\"matrix\"><caption>Correlations</caption>\n<thead><tr>" +
         head + "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n";
}

/// For many parameters a matrix cannot be read: the strong pairs, strongest first, and none within
/// the measuring chain, whose offsets, drifts and hum always go together.
std::string html_pairs(const fitting::Fit& fit) {
  struct Pair {
    double r;
    std::size_t i, j;
  };

  std::vector<Pair> pairs;
  for (Eigen::Index i = 0; i < fit.correlations.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      if (const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
          std::abs(fit.correlations(i, j)) >= 0.5 &&
          !(fit.parameters[row].nuisance && fit.parameters[column].nuisance))
        pairs.push_back({fit.correlations(i, j), row, column});
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& a, const Pair& b) { return std::abs(a.r) > std::abs(b.r); });
  if (pairs.empty())
    return "<p>No parameter of the impact is correlated with another by more than 0.5.</p>\n";
  const std::size_t shown = std::min<std::size_t>(pairs.size(), 30);
  std::string rows;
  for (std::size_t k = 0; k < shown; ++k)
    rows += fmt::format("<tr><td>{}</td><td>{}</td>{}</tr>\n",
                        html_code(fit.parameters[pairs[k].j].name),
                        html_code(fit.parameters[pairs[k].i].name), html_cell(pairs[k].r));
  return fmt::format(
      "<div class=\"scroll\"><table class=\"matrix\"><caption>Correlations of 0.5 and "
      "more with a parameter of the impact: {} of {} pairs shown; all are in the "
      "JSON</caption>\n<thead><tr>"
      "<th scope=\"col\">Parameter</th><th scope=\"col\">and</th><th scope=\"col\" "
      "class=\"n\">r</th></tr></thead><tbody>{}</tbody></table></div>\n",
      shown, pairs.size(), rows);
}

std::string html_correlations(const fitting::Fit& fit) {
  const auto n = static_cast<std::size_t>(fit.correlations.rows());
  if (n < 2) return "";
  if (n != fit.parameters.size() || fit.correlations.cols() != fit.correlations.rows())
    return "<p>Correlations were not estimated.</p>\n";
  return n <= 12 ? html_matrix(fit) : html_pairs(fit);
}

}  // namespace

std::string html_parameters(const ReportData& data) {
  if (data.fit.parameters.empty())
    return html_section("parameters", "Fitted parameters",
                        "<p>Nothing was fitted: all parameters are the rig file’s.</p>\n");
  return html_section(
      "parameters", "Fitted parameters",
      "<p>Values with their standard errors, rounded to two digits of the error. A prior is what a "
      "calibration or the user said, or was assumed of background and mains hum, before the fit: "
      "mean ± standard "
      "uncertainty.</p>\n" +
          html_table(data.fit) + html_list(data.fit.not_identifiable, "remarks") +
          html_intervals(data.fit) + html_correlations(data.fit));
}

}  // namespace impactrig::reports
