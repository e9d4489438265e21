// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/campaign_sections.hpp"
#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {
namespace {

struct Column {
  std::string name, label, unit;
};

/// What is compared between shots; the rest is in summary.csv.
std::vector<Column> columns_of(const Campaign& campaign) {
  std::vector<Column> columns;
  for (const CampaignShot& shot : campaign.shots)
    for (const ShotNumber& number : shot.numbers)
      if (number.compared && std::none_of(columns.begin(), columns.end(),
                                          [&](const Column& c) { return c.name == number.name; }))
        columns.push_back({number.name, number.label, number.unit});
  return columns;
}

/// A cell whose full value the sorting sees.
std::string number_cell(double value, const std::string& shown) {
  return fmt::format("<td class=\"n\" data-value=\"{}\">{}</td>",
                     std::isfinite(value) ? fmt::format("{}", value) : "", escaped(shown));
}

std::string quantity_cell(double value, const char* unit) {
  return number_cell(value, std::isfinite(value) ? quantity(value, unit, 4) : "–");
}

std::string shot_cell(const CampaignShot& shot, const Column& column) {
  const ShotNumber* number = shot.number(column.name);
  if (number == nullptr) return "<td class=\"n\" data-value=\"\">–</td>";
  const RoundedValue shown = rounded(number->value, number->std_error, number->unit);
  std::string text = shown.value;
  if (!shown.error.empty()) text += " ±\u00a0" + shown.error;
  if (!shown.unit.empty()) text += "\u00a0" + shown.unit;
  return number_cell(number->value, text);
}

std::string row_of(const Campaign& campaign, std::size_t i, const std::vector<Column>& columns) {
  const CampaignShot& shot = campaign.shots[i];
  std::string name = escaped(file_name(shot.file));
  if (shot.has_report)
    name = fmt::format("<a href=\"reports/{}.html\">{}</a>", escaped(url_path(shot.name)), name);
  std::string out = fmt::format(
      "<tr><td class=\"n\" data-value=\"{0}\">{0}</td><th scope=\"row\">{1}</th><td><span "
      "class=\"word {2}\">{2}</span></td>",
      i + 1, name, word(shot));
  for (const Column& column : columns) out += shot_cell(shot, column);
  out += number_cell(shot.reduced_chi2, significant(shot.reduced_chi2, 3));
  out += quantity_cell(shot.peak_force, "N") + quantity_cell(shot.approach_speed, "m/s");
  return out + fmt::format("<td>{}</td><td>{}</td></tr>\n", escaped(shot.verdict.headline),
                           escaped(fmt::format("{}", fmt::join(shot.flags, ", "))));
}

}  // namespace

std::string url_path(const std::string& name) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  std::string out;
  for (const char c : name)
    out += plain.find(c) != std::string_view::npos
               ? std::string(1, c)
               : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return out;
}

std::string html_shots(const Campaign& campaign) {
  if (campaign.shots.empty())
    return html_section("shots", "Recordings", "<p>No recording has a result.</p>\n");
  const std::vector<Column> columns = columns_of(campaign);
  std::string out =
      "<p class=\"filter\"><label>Show rows with <input type=\"search\"></label></p>\n"
      "<div class=\"scroll\"><table class=\"shots\"><caption>One row a recording, ± one standard "
      "error; a click on a head sorts. All numbers: <a href=\"summary.csv\">summary.csv</a>, <a "
      "href=\"summary.json\">summary.json</a>.</caption>\n<thead><tr><th scope=\"col\" "
      "class=\"n\">No.</th><th scope=\"col\">Recording</th><th scope=\"col\">Verdict</th>";
  for (const Column& column : columns)
    out += fmt::format("<th scope=\"col\" class=\"n\" title=\"{}\">{}</th>", escaped(column.name),
                       escaped(column.label));
  out +=
      "<th scope=\"col\" class=\"n\" title=\"chi-square by degree of freedom; 1 where residuals "
      "are noise\">Reduced χ²</th><th scope=\"col\" class=\"n\">Peak force</th><th scope=\"col\" "
      "class=\"n\">Speed before touch</th><th scope=\"col\">In words</th><th "
      "scope=\"col\">Flags</th></tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < campaign.shots.size(); ++i) out += row_of(campaign, i, columns);
  out += "</tbody></table></div>\n";
  const bool reports = std::any_of(campaign.shots.begin(), campaign.shots.end(),
                                   [](const CampaignShot& shot) { return shot.has_report; });
  if (!reports)
    out +=
        "<p class=\"note\">No report a recording was written; <code>--reports</code> adds them, "
        "or <code>impactrig report fits/NAME.json -o NAME.html</code> one.</p>\n";
  return html_section("shots", "Recordings", out);
}

}  // namespace impactrig::reports
