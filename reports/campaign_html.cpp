// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "reports/campaign_pictures.hpp"
#include "reports/campaign_sections.hpp"
#include "reports/campaign_wording.hpp"
#include "reports/embedded.hpp"
#include "reports/page_template.hpp"
#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {
namespace {

const char* verdict_class(const Campaign& campaign) {
  bool warned = false;
  for (const CampaignShot& shot : campaign.shots) {
    if (word(shot) == "fail") return "bad";
    warned = warned || word(shot) == "warn";
  }
  if (!campaign.failed.empty()) return "bad";
  return warned ? "partly" : "good";
}

std::string html_key_numbers(const Campaign& campaign) {
  if (campaign.quantities.empty()) return "";
  std::string rows;
  for (const CampaignQuantity& quantity : campaign.quantities)
    rows += fmt::format(
        "<tr><th scope=\"row\">{}<span>{}</span></th><td class=\"n\">{}</td><td>{}</td><td>{}</td>"
        "<td class=\"n\">{} ({})</td><td class=\"n\">{}</td></tr>\n",
        escaped(quantity.label), html_code(quantity.name), quantity.between.shots,
        escaped(mean_text(quantity)), escaped(tau_text(quantity)),
        significant(quantity.between.q, 3), quantity.between.dof, percent(quantity.between.i2));
  return "<div class=\"scroll\"><table><caption>Over the shots: weighted mean ± standard error, "
         "and the standard deviation from shot to shot besides the errors each shot states. Q: "
         "Cochran’s, beside its expectation; I²: share of the scatter that those errors do not "
         "explain.</caption>\n<thead><tr><th scope=\"col\">Quantity</th><th scope=\"col\" "
         "class=\"n\">Shots</th><th scope=\"col\">Mean</th><th scope=\"col\">From shot to "
         "shot</th><th scope=\"col\" class=\"n\">Q</th><th scope=\"col\" "
         "class=\"n\">I²</th></tr></thead>\n<tbody>\n" +
         rows + "</tbody></table></div>\n";
}

std::string html_head(const Campaign& campaign) {
  std::string sentences;
  if (!campaign.quantities.empty())
    sentences =
        escaped(campaign.quantities.front().label + ": " + campaign.quantities.front().sentence);
  return fmt::format(
      "<header><h1>{}</h1>\n<p class=\"verdict {}\"><strong>{}</strong>{}</p>\n{}</header>\n",
      escaped(campaign.title), verdict_class(campaign), escaped(count_sentence(campaign)),
      sentences, html_key_numbers(campaign));
}

std::string html_quantity(const Campaign& campaign, const CampaignQuantity& quantity) {
  std::string out =
      fmt::format("<h3>{}</h3>\n<p>{}", escaped(quantity.label), escaped(quantity.sentence));
  if (const std::string mesh = mesh_sentence(quantity); !mesh.empty()) out += " " + escaped(mesh);
  if (const std::string names = outlier_names(campaign, quantity); !names.empty())
    out += " " + escaped("Stands out: " + names + ".");
  if (!quantity.trend_sentence.empty()) out += " " + escaped(quantity.trend_sentence);
  out += "</p>\n";
  if (!quantity.left_out.empty())
    out += fmt::format(
        "<p class=\"note\">{} recording{} not counted here: no value, no standard "
        "error, at a bound, or the fit gives no verdict.</p>\n",
        quantity.left_out.size(), quantity.left_out.size() == 1 ? "" : "s");
  return out + "<figure>" + svg_shots(campaign, quantity) + "</figure>\n";
}

std::string html_between(const Campaign& campaign) {
  std::string out;
  for (const std::string& sentence : campaign.not_compared)
    out += "<p>" + escaped(sentence) + "</p>\n";
  if (campaign.quantities.empty())
    return html_section("between", "Between shots",
                        out + "<p>At least two shots with a standard error are needed.</p>\n");
  for (const CampaignQuantity& quantity : campaign.quantities)
    out += html_quantity(campaign, quantity);
  return html_section(
      "between", "Between shots",
      out +
          "<p class=\"note\">Random effects: weights 1 / (s² + τ²), τ² by Paule and Mandel with "
          "its Q-profile interval, the mean’s interval by Hartung and Knapp. A shot stands out "
          "where the others, without it, give it less than 0.05 by the number of shots. What all "
          "shots share, such as a calibration, does not scatter and does not average out.</p>\n");
}

std::string html_speed(const Campaign& campaign) {
  const std::string picture = svg_speeds(campaign);
  if (picture.empty()) return "";
  std::string sentences;
  for (const CampaignQuantity& quantity : campaign.quantities)
    if (!quantity.trend_sentence.empty())
      sentences +=
          fmt::format("<li>{}</li>\n", escaped(quantity.label + ": " + quantity.trend_sentence));
  return html_section("speed", "Restitution against approach speed",
                      "<figure>" + picture + "</figure>\n" +
                          (sentences.empty() ? "<p>The approach speeds are too much alike, or the "
                                               "shots too few, to tell a trend.</p>\n"
                                             : "<ul>\n" + sentences + "</ul>\n"));
}

std::string html_failures(const Campaign& campaign) {
  std::string out;
  for (const CampaignFailure& failure : campaign.failed)
    out += fmt::format("<li>{}: {}</li>\n", html_code(failure.file), escaped(failure.sentence));
  out = out.empty() ? "<p>None.</p>\n" : "<ul>\n" + out + "</ul>\n";
  if (!campaign.left_out.empty()) {
    out += "<h3>Left out</h3>\n<ul>\n";
    for (const CampaignFailure& failure : campaign.left_out)
      out += fmt::format("<li>{}: {}</li>\n", html_code(failure.file), escaped(failure.sentence));
    out += "</ul>\n";
  }
  return html_section("failed", "Failed recordings", out);
}

std::string html_origin(const Campaign& campaign) {
  const ResultProvenance& p = campaign.provenance;
  std::string command;
  for (const std::string& word : p.command) command += (command.empty() ? "" : " ") + word;
  return html_section(
      "provenance", "Provenance",
      fmt::format("<dl class=\"list\"><div><dt>Program</dt><dd>{} {} {}, {}</dd></div>\n"
                  "<div><dt>Command</dt><dd><code>{}</code></dd></div>\n"
                  "<div><dt>Rig file</dt><dd class=\"hash\">SHA-256 {}</dd></div>\n"
                  "<div><dt>Started</dt><dd>{} on {}</dd></div>\n"
                  "<div><dt>Result key</dt><dd class=\"hash\">{}</dd></div></dl>\n<pre>{}</pre>\n",
                  escaped(p.tool), escaped(p.version), escaped(p.git), escaped(p.build),
                  escaped(command), escaped(p.config_sha256), escaped(p.started), escaped(p.host),
                  escaped(p.result_key), escaped(p.config)));
}

}  // namespace

std::string to_html(const Campaign& campaign) {
  return filled(embedded::campaign_html.bytes,
                {{"title", escaped(campaign.title)},
                 {"report_css", std::string(embedded::report_css.bytes)},
                 {"campaign_css", std::string(embedded::campaign_css.bytes)},
                 {"head", html_head(campaign)},
                 {"shots", html_shots(campaign)},
                 {"between", html_between(campaign)},
                 {"speed", html_speed(campaign)},
                 {"failed", html_failures(campaign)},
                 {"provenance", html_origin(campaign)},
                 {"footer", escaped(campaign.provenance.tool + " " + campaign.provenance.version)},
                 {"json", script_safe(to_json(campaign))},
                 {"campaign_js", std::string(embedded::campaign_js.bytes)}});
}

}  // namespace impactrig::reports
