// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/direct_wording.hpp"
#include "reports/svg.hpp"
#include "reports/verdict.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

struct KeyNumber {
  std::string label, value, unit, note;
};

std::string html_key_number(const KeyNumber& number) {
  const std::string unit = number.unit.empty() ? "" : " <i>" + escaped(number.unit) + "</i>";
  return fmt::format("<div><dt>{}</dt><dd><b>{}</b>{}<span>{}</span></dd></div>\n",
                     escaped(number.label), escaped(number.value), unit, escaped(number.note));
}

/// Why a parameter has no interval.
std::string no_interval(const fitting::Parameter& parameter) {
  if (parameter.at_bound) return "no interval: at its bound";
  if (!parameter.identifiable) return "no interval: the data cannot tell";
  return "no interval: could not be estimated";
}

/// A parameter's tile: fitted with its interval, or held at the rig file's value. At most four
/// digits: the table has them all.
KeyNumber parameter_tile(const fitting::Fit& fit, const std::string& label, const std::string& key,
                         double held, const char* unit) {
  const fitting::Parameter* parameter = find_parameter(fit, key);
  const double value = parameter == nullptr ? held : parameter->value;
  const DisplayUnit shown = display_unit(std::abs(value), unit);
  if (parameter == nullptr)
    return {label, significant(value * shown.factor, 4), shown.text, "held, not fitted"};
  const double error = std::isfinite(parameter->std_error) ? parameter->std_error : 0.0;
  const double coarse = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
  const double shown_error = value != 0.0 ? std::max(error, coarse) : error;
  KeyNumber number{label, to_precision_of(value, shown_error, shown), shown.text,
                   no_interval(*parameter)};
  if (!has_interval(parameter->ci95)) return number;
  const double half = 0.5 * (parameter->ci95[1] - parameter->ci95[0]);
  number.note = half < 0.05 * coarse  // both ends would round to the value
                    ? "95 %: ± " + quantity(half, unit, 2)
                    : "95 %: " + interval_text(parameter->ci95, shown_error, shown);
  return number;
}

/// "predicted 1572 N (−0.6 %)".
std::string predicted(double value, double measured, const DisplayUnit& unit) {
  std::string out = fmt::format("predicted {} {}", significant(value * unit.factor, 4), unit.text);
  if (measured > 0.0 && std::isfinite(value))
    out += fmt::format(" ({}{}\u00a0%)", value > measured ? "+" : "",
                       tick_text(100.0 * (value / measured - 1.0), 1));
  return out;
}

KeyNumber compared(const std::string& label, double measured, double value, const char* unit) {
  const bool known = std::isfinite(measured) && measured > 0.0;
  const DisplayUnit shown = display_unit(known ? measured : std::abs(value), unit);
  if (!known)
    return {label, significant(value * shown.factor, 4), shown.text, "predicted; not measured"};
  return {label, significant(measured * shown.factor, 4), shown.text,
          predicted(value, measured, shown)};
}

/// What was measured of the first contact; 0 where the recording cannot tell.
struct Measured {
  double peak = 0.0, duration = 0.0, impulse = 0.0;
};

Measured measured_contact(const fitting::Fit& fit, std::size_t recording) {
  Measured out;
  if (recording >= fit.impacts.size()) return out;
  const datasets::Impact& impact = fit.impacts[recording];
  // of a displacement alone the end is where it is back at first touch
  if (impact.end > impact.start && !impact.rebound) out.duration = impact.end - impact.start;
  if (!impact.force) return out;  // peak and impulse are then of the velocity
  out.peak = impact.peak;
  out.impulse = impact.impulse;
  return out;
}

/// Peak of the model as the force sensor shows it, which rings and lags; the contact's own peak
/// where no force was fitted.
double shown_peak(const fitting::Fit& fit, std::size_t recording) {
  for (const fitting::ChannelFit& channel : fit.channels)
    if (channel.quantity == "force" && channel.recording == static_cast<int>(recording) &&
        !channel.model.empty())
      return *std::ranges::max_element(channel.model);
  return fit.predictions[recording].peak_force;
}

/// Of the force, which is what a record shows.
double first_duration(const models::Simulation& run) {
  if (run.episodes.empty()) return std::nan("");
  const models::Episode& first = run.episodes.front();
  return early_end_of_force(run).value_or(first.end) - first.start;
}

double first_impulse(const models::Simulation& run) {
  return run.episodes.empty() ? std::nan("") : run.episodes.front().impulse;
}

/// What the contact's damping law goes by; of none at all what comes of it.
KeyNumber damping_tile(const fitting::Fit& fit) {
  const models::Contact& contact = fit.rig.rig.contact;
  if (contact.viscous)
    return parameter_tile(fit, "Contact damping", "contact.viscous", *contact.viscous, "N s/m");
  if (contact.relaxation_time)
    return parameter_tile(fit, "Relaxation time of the contact", "contact.relaxation_time",
                          *contact.relaxation_time, "s");
  if (contact.takes_restitution())
    return parameter_tile(fit, "Restitution e of the contact law", "contact.restitution",
                          contact.restitution, "1");
  return {"Contact damping", "none", "", "the law dissipates nothing"};
}

std::string html_shared_tiles(const fitting::Fit& fit) {
  const models::Rig& rig = fit.rig.rig;
  return html_key_number(damping_tile(fit)) +
         html_key_number(parameter_tile(fit, "Contact stiffness factor", "contact.stiffness_factor",
                                        rig.contact.stiffness_factor, "1"));
}

std::string html_strip(const fitting::Fit& fit) {
  std::string tiles = html_shared_tiles(fit);
  if (fit.predictions.size() != 1) return "<dl class=\"strip two\">" + tiles + "</dl>\n";
  const models::Simulation& run = fit.predictions.front();
  const Measured measured = measured_contact(fit, 0);
  tiles += html_key_number(
      parameter_tile(fit, "Approach speed", "start.velocity", fit.rig.rig.start.velocity, "m/s"));
  KeyNumber peak = compared("Peak of the force channel", measured.peak, shown_peak(fit, 0), "N");
  peak.note += fmt::format("; in the contact {}", quantity(run.peak_force, "N", 4));
  tiles += html_key_number(peak);
  KeyNumber duration =
      compared("Duration of the first contact", measured.duration, first_duration(run), "s");
  if (run.episodes.size() > 1)
    duration.note += fmt::format("; {} contacts in all", count_word(run.episodes.size()));
  tiles += html_key_number(duration);
  tiles += html_key_number(
      compared("Impulse of the first contact", measured.impulse, first_impulse(run), "N s"));
  return "<dl class=\"strip\">" + tiles + "</dl>\n";
}

double residual_over_noise(const fitting::Fit& fit, std::size_t recording, const char* name) {
  for (const fitting::ChannelFit& channel : fit.channels)
    if (channel.quantity == name && channel.recording == static_cast<int>(recording) &&
        channel.noise > 0.0)
      return channel.residual_rms / channel.noise;
  return std::nan("");
}

/// One column of the table of recordings; `group` spans two.
struct RecordingColumn {
  const char* group;
  const char* title;
  const char* unit;
  int digits;
  double (*value)(const fitting::Fit&, std::size_t);
};

double known(double value) {
  return value > 0.0 ? value : std::nan("");
}

constexpr std::array<RecordingColumn, 9> recording_columns{{
    {"", "Approach speed", "m/s", 4,
     [](const fitting::Fit& fit, std::size_t r) {
       const fitting::Parameter* speed = find_parameter(fit, "start.velocity", static_cast<int>(r));
       return speed == nullptr ? fit.rig.rig.start.velocity : speed->value;
     }},
    {"Peak of the force channel", "measured", "N", 4,
     [](const fitting::Fit& fit, std::size_t r) { return known(measured_contact(fit, r).peak); }},
    {"", "predicted", "N", 4, shown_peak},
    {"Duration", "measured", "s", 3,
     [](const fitting::Fit& fit, std::size_t r) {
       return known(measured_contact(fit, r).duration);
     }},
    {"", "predicted", "s", 3,
     [](const fitting::Fit& fit, std::size_t r) { return first_duration(fit.predictions[r]); }},
    {"Impulse", "measured", "N s", 4,
     [](const fitting::Fit& fit, std::size_t r) {
       return known(measured_contact(fit, r).impulse);
     }},
    {"", "predicted", "N s", 4,
     [](const fitting::Fit& fit, std::size_t r) { return first_impulse(fit.predictions[r]); }},
    {"Residual / noise", "force", "1", 2,
     [](const fitting::Fit& fit, std::size_t r) { return residual_over_noise(fit, r, "force"); }},
    {"", "velocity", "1", 2,
     [](const fitting::Fit& fit, std::size_t r) {
       return residual_over_noise(fit, r, "velocity");
     }},
}};

std::string flag_names(const fitting::Fit& fit, std::size_t recording) {
  std::string out;
  if (recording < fit.impacts.size())
    for (const datasets::ImpactFlag flag : fit.impacts[recording].flags)
      out += (out.empty() ? "" : ", ") + std::string(datasets::name(flag));
  return out.empty() ? "none" : out;
}

/// One row a recording, when there are several.
std::string html_recordings(const fitting::Fit& fit) {
  const std::size_t n = fit.predictions.size();
  if (n < 2) return "";
  std::string groups = "<tr><th rowspan=\"2\" scope=\"col\">Recording</th>", heads = "<tr>";
  std::vector<std::string> rows;
  for (std::size_t r = 0; r < n; ++r)
    rows.push_back(fmt::format("<tr><th scope=\"row\"><a href=\"#recording-{}\">{}</a></th>", r + 1,
                               escaped(recording_name(fit, r))));
  for (std::size_t c = 0; c < recording_columns.size(); ++c) {
    const RecordingColumn& column = recording_columns[c];
    std::vector<double> values;
    for (std::size_t r = 0; r < n; ++r) values.push_back(column.value(fit, r));
    const NumberColumn shown = number_column(values, column.unit, column.digits);
    const std::string unit =
        shown.unit.text.empty() ? "" : "<span>[" + shown.unit.text + "]</span>";
    if (c == 0)
      groups +=
          fmt::format("<th rowspan=\"2\" scope=\"col\" class=\"n\">{}{}</th>", column.title, unit);
    else
      heads += fmt::format("<th scope=\"col\" class=\"n\">{}{}</th>", column.title, unit);
    if (*column.group != '\0')
      groups +=
          fmt::format("<th colspan=\"2\" scope=\"colgroup\" class=\"g\">{}</th>", column.group);
    for (std::size_t r = 0; r < n; ++r) rows[r] += "<td class=\"n\">" + shown.cells[r] + "</td>";
  }
  std::string body;
  for (std::size_t r = 0; r < n; ++r)
    body += rows[r] + "<td>" + flag_names(fit, r) + "</td></tr>\n";
  return "<div class=\"scroll\"><table><caption>One row for each recording; duration and impulse "
         "are "
         "of the first contact</caption>\n<thead>" +
         groups + "<th rowspan=\"2\" scope=\"col\">Flags</th></tr>\n" + heads +
         "</tr></thead>\n<tbody>" + body + "</tbody></table></div>\n";
}

/// The same words about several files become one warning.
class Warnings {
 public:
  void add(const std::string& file, const std::string& words) {
    for (auto& [text, files] : said_)
      if (text == words) {
        if (!file.empty()) files.push_back(file);
        return;
      }
    said_.push_back({words, file.empty() ? std::vector<std::string>{} : std::vector{file}});
  }

  std::vector<std::string> sentences() const {
    std::vector<std::string> out;
    for (const auto& [text, files] : said_) {
      std::string names;
      for (std::size_t i = 0; i < files.size() && i < 5; ++i)
        names += (i > 0 ? ", " : "") + files[i];
      if (files.size() > 5) names += fmt::format(" and {} more", files.size() - 5);
      out.push_back(names.empty() ? text : names + ": " + text);
    }
    return out;
  }

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> said_;
};

/// Whether the fit has already said this, perhaps with a file's name before it.
bool said(const fitting::Fit& fit, std::string_view words) {
  return std::any_of(fit.warnings.begin(), fit.warnings.end(), [&](const std::string& warning) {
    return warning.find(words) != std::string::npos;
  });
}

/// Whether a warning of the fit is one of a recording, with its path before it.
bool told_by_records(const ReportData& data, const std::string& warning) {
  return std::any_of(data.records.begin(), data.records.end(), [&](const datasets::Record& record) {
    return std::any_of(record.warnings.begin(), record.warnings.end(),
                       [&](const std::string& words) {
                         const std::string end = ": " + words;
                         return warning.ends_with(end) &&
                                file_name(warning.substr(0, warning.size() - end.size())) ==
                                    file_name(record.provenance.source_file);
                       });
  });
}

/// Everything that asks for attention: of the fit, the predictions, the recordings and their flags.
std::string html_warnings(const ReportData& data) {
  const fitting::Fit& fit = data.fit;
  Warnings warnings;
  for (const std::string& warning : fit.warnings)
    if (!told_by_records(data, warning)) warnings.add("", warning);
  for (std::size_t r = 0; r < fit.predictions.size(); ++r)
    for (const std::string& warning : fit.predictions[r].warnings)
      if (!said(fit, warning))
        warnings.add(recording_name(fit, r), "in the prediction: " + warning);
  for (std::size_t r = 0; r < fit.impacts.size(); ++r)
    for (const datasets::ImpactFlag flag : fit.impacts[r].flags)
      if (!said(fit, datasets::sentence(flag)))
        warnings.add(recording_name(fit, r),
                     fmt::format("flagged {}. {}", datasets::name(flag), datasets::sentence(flag)));
  for (const datasets::Record& record : data.records)
    for (const std::string& warning : record.warnings)
      warnings.add(file_name(record.provenance.source_file), warning);
  const std::vector<std::string> all = warnings.sentences();
  if (all.empty()) return "";
  return fmt::format(
      "<aside class=\"warnings\" aria-label=\"Warnings\"><h2>{}</h2>{}</aside>\n",
      all.size() == 1 ? "One warning" : capital(count_word(all.size())) + " warnings",
      html_list(all));
}

/// "2024-05-17T14:03:22+02:00" -> "2024-05-17 14:03 +02:00"; other spellings as they are.
std::string readable_time(const std::string& time) {
  const bool iso = time.size() >= 19 && time[4] == '-' && time[10] == 'T' && time[16] == ':';
  if (!iso) return time;
  const std::size_t zone = time.find_first_of("+-Z", 19);
  std::string out = time.substr(0, 10) + " " + time.substr(11, 5);
  return zone == std::string::npos ? out : out + " " + time.substr(zone);
}

std::string html_facts(const ReportData& data) {
  std::string out;
  const auto add = [&](const char* term, const std::string& text) {
    if (!text.empty()) out += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", term, escaped(text));
  };
  std::string files;
  for (std::size_t r = 0; r < data.fit.impacts.size() && r < 4; ++r)
    files += (r > 0 ? ", " : "") + recording_name(data.fit, r);
  if (data.fit.impacts.size() > 4)
    files += fmt::format(" and {} more", data.fit.impacts.size() - 4);
  add(data.fit.impacts.size() == 1 ? "Recording" : "Recordings", files);
  if (!data.records.empty()) add("Recorded", readable_time(data.records.front().started));
  add("Rig", file_name(data.fit.rig.path));
  const std::string tool = data.provenance.tool + " " + data.provenance.version;
  add("Evaluated", data.provenance.started.empty()
                       ? "with " + tool
                       : readable_time(data.provenance.started) + " with " + tool);
  return "<dl class=\"facts\">" + out + "</dl>\n";
}

const char* css_class(Verdict::Grade grade) {
  switch (grade) {
    case Verdict::Grade::explained:
      return "good";
    case Verdict::Grade::in_shape:
      return "partly";
    case Verdict::Grade::not_explained:
      return "bad";
    case Verdict::Grade::open:
      break;
  }
  return "open";
}

}  // namespace

std::string html_summary(const ReportData& data) {
  const Verdict found = verdict(data.fit);
  return fmt::format(
             "<header>\n<h1>{}</h1>\n{}<p class=\"verdict {}\"><strong>{}.</strong> {}</p>\n"
             "</header>\n",
             escaped(data.title.empty() ? "Impact report" : data.title), html_facts(data),
             css_class(found.grade), escaped(found.headline), escaped(found.sentence)) +
         html_strip(data.fit) + html_recordings(data.fit) + html_warnings(data);
}

}  // namespace impactrig::reports
