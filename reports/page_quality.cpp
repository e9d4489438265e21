// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <fmt/format.h>

#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

/// The record an impact was found in: by its file, else by position; null when there is none.
const datasets::Record* record_of(const ReportData& data, std::size_t recording) {
  for (const datasets::Record& record : data.records)
    if (!record.provenance.source_file.empty() &&
        record.provenance.source_file == data.fit.impacts[recording].recording)
      return &record;
  return recording < data.records.size() ? &data.records[recording] : nullptr;
}

std::string calibration_text(const datasets::Channel* channel, double gain_uncertainty) {
  if (channel == nullptr || !channel->calibration)
    return gain_uncertainty > 0.0 ? "± " + percent(gain_uncertainty) : "as recorded";
  const datasets::Calibration& c = *channel->calibration;
  const bool compound = c.physical_unit.find_first_of("/ ") != std::string::npos;
  std::string out =
      quantity(c.sensitivity,
               c.recorded_unit + (compound ? "/(" + c.physical_unit + ")" : "/" + c.physical_unit));
  if (c.uncertainty > 0.0) out += " ± " + percent(c.uncertainty / std::abs(c.sensitivity));
  return c.source.empty() ? out : out + ", " + file_name(c.source);
}

std::string html_signal(const ReportData& data, std::size_t recording,
                        const std::optional<datasets::ImpactSignal>& signal) {
  if (!signal) return "";
  const std::string unit(datasets::si_unit(signal->quantity));
  const datasets::Record* record = record_of(data, recording);
  const datasets::Channel* channel = record == nullptr ? nullptr : record->find(signal->channel);
  const auto or_dash = [&](double value) {
    return value > 0.0 ? quantity(value, unit, 2) : std::string("not seen");
  };
  std::string delay = quantity(signal->delay, "s", 2);
  if (signal->delay_uncertainty > 0.0) delay += " ± " + quantity(signal->delay_uncertainty, "s", 2);
  const std::array<std::string, 7> cells{
      signal->interval > 0.0 ? quantity(1.0 / signal->interval, "Hz") : "–",
      or_dash(signal->noise),
      significant(signal->noise_correlation, 2),
      or_dash(signal->quantum),
      quantity(signal->baseline, unit, 2),
      delay,
      calibration_text(channel, signal->gain_uncertainty)};
  std::string out =
      fmt::format("<tr><th scope=\"row\">{}<span>{}</span></th>",
                  capital(std::string(datasets::name(signal->quantity))), escaped(signal->channel));
  for (std::size_t i = 0; i < cells.size(); ++i)
    out +=
        fmt::format("<td{}>{}</td>", i + 1 < cells.size() ? " class=\"n\"" : "", escaped(cells[i]));
  return out + "</tr>\n";
}

std::string html_impact(const ReportData& data, std::size_t recording) {
  const datasets::Impact& impact = data.fit.impacts[recording];
  std::string rows = html_signal(data, recording, impact.force) +
                     html_signal(data, recording, impact.velocity) +
                     html_signal(data, recording, impact.displacement);
  std::string out = fmt::format("<h3>{}</h3>\n", escaped(recording_name(data.fit, recording)));
  std::string flags;
  for (const datasets::ImpactFlag flag : impact.flags)
    flags += fmt::format("<li><b>{}</b>: {}</li>", datasets::name(flag),
                         escaped(datasets::sentence(flag)));
  out += flags.empty()
             ? "<p>No flag: no clipping, drop-out, second contact within the window or short "
               "record was found.</p>\n"
             : "<ul class=\"flags\">" + flags + "</ul>\n";
  if (rows.empty())
    return out + "<p>What the sensors showed before the trigger is not stored with this fit.</p>\n";
  return out +
         "<div class=\"scroll\"><table><caption>Channels, as conditioned</caption>\n<thead><tr>"
         "<th scope=\"col\">Channel</th><th scope=\"col\" class=\"n\">Sampled at</th>"
         "<th scope=\"col\" class=\"n\">Noise, rms</th><th scope=\"col\" class=\"n\">Noise "
         "correlated over "
         "[samples]</th><th scope=\"col\" class=\"n\">Digitiser step</th><th scope=\"col\" "
         "class=\"n\">"
         "Baseline removed</th><th scope=\"col\" class=\"n\">Delay removed</th><th scope=\"col\">"
         "Calibration</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

}  // namespace

std::string html_quality(const ReportData& data) {
  std::string body;
  for (std::size_t r = 0; r < data.fit.impacts.size(); ++r) body += html_impact(data, r);
  if (body.empty()) body = "<p>No recording is stored with this fit.</p>\n";
  return html_section("quality", "Data quality", body);
}

}  // namespace impactrig::reports
