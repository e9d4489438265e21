// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "reports/diagnosis.hpp"
#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

struct MetricLabel {
  const char* key;
  const char* text;
};

constexpr std::array<MetricLabel, 12> metric_labels{
    {{"nrmse", "Normalised rms error (NRMSE)"},
     {"correlation", "Correlation (Pearson)"},
     {"sprague_geers_magnitude", "Sprague–Geers magnitude M"},
     {"sprague_geers_phase", "Sprague–Geers phase P"},
     {"sprague_geers_comprehensive", "Sprague–Geers comprehensive C"},
     {"theil_u", "Theil’s inequality U"},
     {"whang", "Whang’s inequality"},
     {"iso18571_corridor", "ISO 18571 corridor Z"},
     {"iso18571_phase", "ISO 18571 phase"},
     {"iso18571_magnitude", "ISO 18571 magnitude"},
     {"iso18571_slope", "ISO 18571 slope"},
     {"iso18571_rating", "ISO 18571 rating R"}}};

std::string metric_label(std::string key) {
  for (const MetricLabel& label : metric_labels)
    if (key == label.key) return label.text;
  for (char& c : key)
    if (c == '_') c = ' ';
  return key;
}

/// What chi2 over its degrees of freedom says.
std::string chi2_sentence(const fitting::Goodness& goodness) {
  if (goodness.dof <= 0 || !std::isfinite(goodness.chi2))
    return "χ² per degree of freedom could not be computed: there are no more samples than "
           "parameters, so nothing is left to test the model with.";
  const double reduced = goodness.chi2 / static_cast<double>(goodness.dof);
  const std::string value =
      fmt::format("χ² is {} with {} degrees of freedom: {} per degree. ",
                  significant(goodness.chi2, 4), goodness.dof, significant(reduced, 3));
  if (reduced < 0.5)
    return value +
           "Noise of the stated size would leave about 1; so little points to a noise that "
           "was estimated too large, or to neighbouring samples whose noise is alike.";
  if (reduced <= 1.5)
    return value + "Noise alone would leave about 1: there is little left to explain.";
  return value +
         fmt::format(
             "Noise alone would leave about 1: the residual is {} times what noise explains, "
             "so the model or the calibration misses something. Standard errors and intervals were "
             "widened by that factor; they still cannot tell which way the missing part bends the "
             "parameters.",
             significant(std::sqrt(reduced), 2));
}

/// Rows of numbers under one column a channel.
class ChannelTable {
 public:
  explicit ChannelTable(const fitting::Fit& fit) : fit_(fit) {}

  template <typename Cell>
  void row(const std::string& title, Cell cell) {
    rows_ += "<tr><th scope=\"row\">" + escaped(title) + "</th>";
    for (const fitting::ChannelFit& channel : fit_.channels)
      rows_ += "<td class=\"n\">" + escaped(cell(channel)) + "</td>";
    rows_ += "</tr>\n";
  }

  std::string html() const {
    std::string head = "<th scope=\"col\">Measure</th>";
    for (const fitting::ChannelFit& channel : fit_.channels) {
      head += "<th scope=\"col\" class=\"n\">" + escaped(capital(channel.quantity));
      if (fit_.impacts.size() > 1)
        head += "<span>" +
                escaped(recording_name(fit_,
                                       static_cast<std::size_t>(std::max(0, channel.recording)))) +
                "</span>";
      head += "</th>";
    }
    return "<div class=\"scroll\"><table><caption>Residuals and metrics, over the fitted samples"
           "</caption>\n<thead><tr>" +
           head + "</tr></thead>\n<tbody>" + rows_ + "</tbody></table></div>\n";
  }

 private:
  const fitting::Fit& fit_;
  std::string rows_;
};

std::string html_channels(const fitting::Fit& fit) {
  if (fit.channels.empty()) return "";
  using Channel = fitting::ChannelFit;
  ChannelTable table(fit);
  table.row("Samples fitted", [](const Channel& c) {
    std::size_t count = 0;
    for (const std::uint8_t used : c.used) count += used != 0 ? 1 : 0;
    const std::string fitted = grouped(c.used.empty() ? c.time.size() : count);
    return c.every > 1 ? fmt::format("{}, one in {}", fitted, c.every) : fitted;
  });
  table.row("Residual, rms", [](const Channel& c) { return quantity(c.residual_rms, c.unit); });
  table.row("Noise before the trigger, rms", [](const Channel& c) {
    return c.noise > 0.0 ? quantity(c.noise, c.unit) : std::string("not known");
  });
  table.row("Residual over noise", [](const Channel& c) {
    return c.noise > 0.0 ? significant(c.residual_rms / c.noise, 2) : std::string("–");
  });
  std::set<std::string> keys;
  for (const Channel& channel : fit.channels)
    for (const auto& [key, unused] : channel.metrics) keys.insert(key);
  for (const std::string& key : keys)
    table.row(metric_label(key), [&](const Channel& c) {
      const auto found = c.metrics.find(key);
      return found == c.metrics.end() ? std::string("–")
                                      : significant(found->second, key == "correlation" ? 5 : 3);
    });
  return table.html();
}

std::string criteria_sentence(const fitting::Fit& fit) {
  if (fit.loss != fitting::Loss::squares)
    return fmt::format("AICc and BIC go with the loss squares, not with {}.",
                       fitting::name(fit.loss));
  return fmt::format("Between fits of the same samples the smaller is better: AICc {}, BIC {}.",
                     significant(fit.goodness.aicc, 5), significant(fit.goodness.bic, 5));
}

}  // namespace

std::string html_goodness(const ReportData& data) {
  const fitting::Fit& fit = data.fit;
  std::string body = "<p>" + chi2_sentence(fit.goodness) + "</p>\n" + html_channels(fit);
  body += fmt::format(
      "<p class=\"note\">{} The fit took {} iterations and {} simulations in {}, with the loss {}, "
      "and ended with: {}. The "
      "verdict above calls "
      "a "
      "recording explained when every residual is at most 1.5 times its noise, and explained in "
      "shape when every Sprague–Geers C is at most 0.1; these limits are this report’s own.</p>\n",
      criteria_sentence(fit), fit.iterations, fit.simulations, quantity(fit.seconds, "s"),
      fitting::name(fit.loss), escaped(fit.termination));
  body += html_diagnostics(fit);
  return html_section("goodness", "How good the fit is", body);
}

}  // namespace impactrig::reports
