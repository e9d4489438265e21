// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <fmt/format.h>

#include "reports/embedded.hpp"
#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

/// A word as a POSIX shell takes it: quoted where it must be.
std::string shell_word(const std::string& word) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_./=+:,@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_line(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + shell_word(word);
  return out;
}

/// Collapsed on a screen with script, open on paper and without script.
std::string html_fold(const std::string& title, const std::string& body_html) {
  return fmt::format("<div class=\"fold\"><h3>{}</h3><div class=\"folded\">{}</div></div>\n",
                     escaped(title), body_html);
}

std::string html_fact(const char* term, const std::string& text) {
  return text.empty() ? ""
                      : fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", term, escaped(text));
}

std::string html_inputs(const ResultProvenance& provenance) {
  std::string rows;
  for (const InputFile& input : provenance.inputs)
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td><code class=\"hash\">{}"
        "</code></td></tr>\n",
        escaped(input.name), grouped(input.bytes), escaped(input.sha256));
  if (rows.empty()) return "<p>No input file is recorded.</p>\n";
  return "<div class=\"scroll\"><table><thead><tr><th scope=\"col\">File</th><th scope=\"col\" "
         "class=\"n\">Bytes</th><th scope=\"col\">SHA-256</th></tr></thead><tbody>" +
         rows + "</tbody></table></div>\n";
}

std::string edit_text(const datasets::Edit& edit) {
  std::string out = edit.what;
  if (!edit.channel.empty()) out += ", " + edit.channel;
  std::string settings;
  for (const auto& [name, value] : edit.parameters)
    settings += (settings.empty() ? "" : ", ") + name + " " + value;
  return settings.empty() ? out : out + ": " + settings;
}

std::string html_record(const datasets::Record& record) {
  const datasets::Provenance& source = record.provenance;
  std::string out = "<h4>" + escaped(file_name(source.source_file)) + "</h4>\n<dl class=\"facts\">";
  out += html_fact("Title", record.title) + html_fact("Recorded", record.started) +
         html_fact("Importer", source.importer) + html_fact("Read by", source.program);
  std::string channels;
  for (const datasets::Channel& channel : record.channels)
    channels += (channels.empty() ? "" : "; ") + channel.name +
                (channel.unit.empty() ? "" : " [" + channel.unit + "]");
  out += html_fact("Channels", channels);
  for (const auto& [name, value] : record.attributes)
    out += html_fact(escaped(name).c_str(), value);
  out += "</dl>\n";
  if (source.edits.empty()) return out + "<p>Nothing was changed after reading.</p>\n";
  out += "<p>Changed after reading, in this order:</p><ol>";
  for (const datasets::Edit& edit : source.edits)
    out += "<li>" + escaped(edit_text(edit)) + "</li>";
  return out + "</ol>\n";
}

std::string html_making(const ResultProvenance& p) {
  return "<dl class=\"facts\">" + html_fact("Tool", p.tool + " " + p.version) +
         html_fact("Commit", p.git) + html_fact("Build", p.build) +
         html_fact("Command", command_line(p.command)) + html_fact("Started", p.started) +
         html_fact("Took", p.wall_s > 0.0 ? quantity(p.wall_s, "s") : "") +
         html_fact("Host", p.host) + html_fact("Result key", p.result_key) +
         html_fact("Plot library", fmt::format("dygraphs (MIT licence), SHA-256 {}",
                                               embedded::dygraph_min_js.sha256)) +
         "</dl>\n";
}

std::string html_reproduce(const ResultProvenance& p) {
  std::string checks;
  for (const InputFile& input : p.inputs)
    if (!input.sha256.empty()) checks += fmt::format("{}  {}\n", input.sha256, input.name);
  std::string out;
  if (!checks.empty())
    out += "<p>Check that the inputs are the same:</p>\n<pre>" +
           escaped("sha256sum -c <<'END'\n" + checks + "END") + "</pre>\n";
  if (p.command.empty())
    out += "<p>The command that made this result was not recorded.</p>\n";
  else
    out += fmt::format("<p>With {}, from the same folder:</p>\n<pre>{}</pre>\n",
                       escaped(p.tool + " " + p.version), escaped(command_line(p.command)));
  if (!p.result_key.empty())
    out += fmt::format(
        "<p>The same result carries the same result key, <code class=\"hash\">{}</code>. "
        "Times, host and this page’s layout do not enter it.</p>\n",
        escaped(p.result_key));
  return out +
         "<p>All numbers of this page are inside it, as JSON in the element <code>report</code>; "
         "curves are rounded there to a millionth of their range.</p>\n"
         "<p class=\"downloads\" hidden></p>\n";
}

}  // namespace

std::string html_provenance(const ReportData& data) {
  std::string records;
  for (const datasets::Record& record : data.records) records += html_record(record);
  if (records.empty()) records = "<p>No recording’s header is stored with this fit.</p>\n";
  const std::string& config =
      data.provenance.config.empty() ? data.fit.rig.text : data.provenance.config;
  std::string rig = config.empty() ? "<p>The rig file’s text is not stored.</p>\n"
                                   : "<pre>" + escaped(config) + "</pre>\n";
  if (!data.provenance.config_sha256.empty())
    rig += "<p>SHA-256 <code class=\"hash\">" + escaped(data.provenance.config_sha256) +
           "</code></p>\n";
  return html_section("reproduce", "How to reproduce", html_reproduce(data.provenance)) +
         html_section("provenance", "Provenance",
                      html_fold("Inputs", html_inputs(data.provenance)) +
                          html_fold("Recordings and what was done to them", records) +
                          html_fold("Rig file", rig) +
                          html_fold("Command, version, build", html_making(data.provenance)));
}

}  // namespace impactrig::reports
