// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "reports/numbers.hpp"
#include "reports/report_data.hpp"

/// Words and pieces of HTML that several sections of the page share. What is named html is escaped
/// markup, everything else plain text.
namespace impactrig::reports {

/// "Restitution e of the contact law"; "" for a key without words of its own.
std::string parameter_label(const std::string& name);

/// The parameter of that key and, where recordings have their own, of that recording (from 0); null
/// when it was not fitted.
const fitting::Parameter* find_parameter(const fitting::Fit& fit, const std::string& key,
                                         int recording = 0);

/// Whether a value comes with an interval: finite and not of zero width.
bool has_interval(const std::array<double, 2>& interval);

/// "0.490 to 0.534", to the last place that two digits of `error` leave, in `unit`. `error` of 0:
/// of a quarter of the width.
std::string interval_text(const std::array<double, 2>& interval, double error,
                          const DisplayUnit& unit);

/// "Force", "Velocity": first letter upper case.
std::string capital(std::string word);

/// "shot 17.uff": without its folders.
std::string file_name(const std::string& path);

/// The recording's file name, "recording 2" when it has none.
std::string recording_name(const fitting::Fit& fit, std::size_t recording);

/// "one", "two", ... "twelve", then figures.
std::string count_word(std::size_t count);
/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& words);

/// <code> of a rig-file key or a file's name, which may be broken after a dot, dash or underscore.
std::string html_code(const std::string& name);

/// <ul> of escaped sentences; "" when there are none.
std::string html_list(const std::vector<std::string>& sentences, const char* css_class = "");

/// <section id=...><h2>...</h2>body</section>
std::string html_section(const char* id, const std::string& title, const std::string& body_html);

/// Of the parameters' section: intervals of profile likelihood and bootstrap; "" without them.
std::string html_intervals(const fitting::Fit& fit);

/// Of html_restitution: what the records show without a model, beside the fit.
std::string html_direct(const fitting::Fit& fit);

/// The page's sections, in order.
std::string html_summary(const ReportData& data);      ///< head, verdict, key numbers, warnings
std::string html_measured(const ReportData& data);     ///< histories and residuals
std::string html_restitution(const ReportData& data);  ///< the four restitutions, energy
std::string html_parameters(const ReportData& data);   ///< table, correlations
std::string html_contacts(const ReportData& data);     ///< loop and contacts of the prediction
std::string html_goodness(const ReportData& data);     ///< chi2, residuals against noise, metrics
std::string html_models(const ReportData& data);   ///< other models; "" where none were asked for
std::string html_quality(const ReportData& data);  ///< noise, calibration
std::string html_provenance(const ReportData& data);  ///< inputs, edits, rig file, how to reproduce

}  // namespace impactrig::reports
