// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reports/embedded.hpp"
#include "reports/page_template.hpp"
#include "reports/report_data.hpp"
#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

constexpr std::size_t most_samples = 20000;  // of a curve in a page; 2 channels of it are 1 MB
constexpr std::size_t buckets = 4000;        // of min/max pairs outside the fitted samples

/// To a millionth of the largest magnitude: far below noise and digitiser step, and a third of the
/// length in the page.
void shorten(std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  if (!(largest > 0.0)) return;
  const double power = std::floor(std::log10(largest)) - 6.0;
  if (power < -300.0 || power > 300.0) return;
  // Multiplying and dividing by exact powers of ten gives the double next to the short decimal.
  const double unit = std::pow(10.0, std::abs(power));
  for (double& value : values)
    if (std::isfinite(value))
      value = power < 0.0 ? std::round(value * unit) / unit : std::round(value / unit) * unit;
}

template <typename T>
void keep(std::vector<T>& values, const std::vector<std::size_t>& kept) {
  std::vector<T> out;
  for (const std::size_t i : kept)
    if (i < values.size()) out.push_back(values[i]);
  values = std::move(out);
}

/// Full rate where the fit looked, elsewhere what a plot can show.
void thin(fitting::ChannelFit& channel) {
  const std::size_t n = channel.measured.size();
  if (n <= most_samples) return;
  std::vector<std::uint8_t> wanted(n, 0);
  for (const auto* values : {&channel.measured, &channel.model})
    for (const std::size_t i : min_max_indices(*values, buckets))
      if (i < n) wanted[i] = 1;
  const auto fitted = static_cast<std::size_t>(
      std::count_if(channel.used.begin(), channel.used.end(), [](auto u) { return u != 0; }));
  if (fitted <= most_samples)
    for (std::size_t i = 0; i < std::min(n, channel.used.size()); ++i)
      if (channel.used[i] != 0) wanted[i] = 1;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < n; ++i)
    if (wanted[i] != 0) kept.push_back(i);
  keep(channel.time, kept);
  keep(channel.measured, kept);
  keep(channel.model, kept);
  keep(channel.used, kept);
}

/// Every k-th sample, so that at most `most_samples` are left.
void thin(models::History& history) {
  const std::size_t n = history.force.size();
  const std::size_t every = (n + most_samples - 1) / most_samples;
  if (every < 2) return;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < n; i += every) kept.push_back(i);
  for (auto* values :
       {&history.force, &history.penetration, &history.velocity, &history.displacement})
    keep(*values, kept);
  if (!history.sensor_force.empty()) keep(history.sensor_force, kept);
  history.interval *= static_cast<double>(every);
}

/// The numbers a page carries.
std::string page_json(ReportData data) {
  for (fitting::ChannelFit& channel : data.fit.channels) {
    thin(channel);
    for (auto* values : {&channel.time, &channel.measured, &channel.model}) shorten(*values);
    if (!channel.diagnostics) continue;
    fitting::ChannelDiagnostics& found = *channel.diagnostics;
    for (auto* values :
         {&found.whiteness.autocorrelation, &found.whiteness.before, &found.normality.quantiles,
          &found.discrepancy.time, &found.discrepancy.mean, &found.discrepancy.error})
      shorten(*values);
  }
  for (fitting::DirectRestitution& direct : data.fit.direct)
    for (auto* values :
         {&direct.hysteresis.time, &direct.hysteresis.penetration, &direct.hysteresis.force})
      shorten(*values);
  for (models::Simulation& run : data.fit.predictions) {
    thin(run.history);
    for (auto* values : {&run.history.force, &run.history.penetration, &run.history.velocity,
                         &run.history.displacement, &run.history.sensor_force})
      shorten(*values);
  }
  return script_safe(to_json(data));
}

/// A sentence when the page holds less than the recording.
std::string thinning_note(const ReportData& data) {
  for (const fitting::ChannelFit& channel : data.fit.channels)
    if (channel.measured.size() > most_samples)
      return fmt::format(
          "<p class=\"note\">To keep this page small, samples that did not enter the fit "
          "are shown as {} pairs of smallest and largest values a channel; impactrig fit "
          "--json holds them all.</p>\n",
          buckets);
  return "";
}

/// Without the hint that sends a debugger after a file that is not there.
std::string without_source_map(std::string_view text) {
  std::string out(text);
  for (const char* hint : {"//# sourceMappingURL", "/*# sourceMappingURL"})
    if (const std::size_t at = out.rfind(hint); at != std::string::npos) out.resize(at);
  return out;
}

}  // namespace

std::string to_html(const ReportData& data) {
  const std::string title = data.title.empty() ? "Impact report" : data.title;
  return filled(embedded::page_html.bytes,
                {{"title", escaped(title)},
                 {"dygraph_css", without_source_map(embedded::dygraph_min_css.bytes)},
                 {"report_css", std::string(embedded::report_css.bytes)},
                 {"summary", html_summary(data)},
                 {"measured", html_measured(data) + thinning_note(data)},
                 {"contacts", html_contacts(data)},
                 {"parameters", html_parameters(data)},
                 {"restitution", html_restitution(data)},
                 {"goodness", html_goodness(data) + html_models(data)},
                 {"quality", html_quality(data)},
                 {"provenance", html_provenance(data)},
                 {"footer", escaped(data.provenance.tool + " " + data.provenance.version)},
                 {"json", page_json(data)},
                 {"dygraphs_licence", std::string(embedded::dygraphs_licence_txt.bytes)},
                 {"dygraph_js", without_source_map(embedded::dygraph_min_js.bytes)},
                 {"report_js", std::string(embedded::report_js.bytes)}});
}

}  // namespace impactrig::reports
