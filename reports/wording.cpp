// SPDX-License-Identifier: BSD-3-Clause
#include "reports/wording.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fitting/parameters.hpp"
#include "reports/svg.hpp"

namespace impactrig::reports {

namespace {

struct Label {
  const char* key;
  const char* text;
};

// Whole keys of the rig file first, then their last word for those of the measuring chain.
constexpr std::array<Label, 24> labels{{
    {"contact.restitution", "Restitution e of the contact law"},
    {"contact.stiffness_factor", "Contact stiffness factor"},
    {"contact.stiffness", "Contact stiffness"},
    {"contact.length", "Length of the line contact"},
    {"contact.position", "Struck point, from the hinge"},
    {"contact.radius", "Radius of the bar’s contact patch"},
    {"contact.counterface.radius", "Radius of the counterface"},
    {"contact.modulus", "Young’s modulus of the contact patch"},
    {"contact.counter_modulus", "Young’s modulus of the stop"},
    {"start.velocity", "Approach speed"},
    {"start.release_angle", "Release angle"},
    {"impact.time", "Instant of first touch"},
    {"beam.length", "Length of the bar"},
    {"beam.youngs_modulus", "Young’s modulus of the bar"},
    {"beam.density", "Density of the bar"},
    {"first_touch", "Instant of first touch"},
    {"gain", "Gain"},
    {"offset", "Offset"},
    {"drift", "Drift"},
    {"sin", "Mains hum (sine)"},
    {"cos", "Mains hum (cosine)"},
    {"third_sin", "Third harmonic of the hum (sine)"},
    {"third_cos", "Third harmonic of the hum (cosine)"},
    {"delay", "Delay"},
}};

}  // namespace

std::string parameter_label(const std::string& name) {
  const auto [key, recording] = fitting::parameter_key(name);
  const std::string suffix = recording > 0 ? fmt::format(", recording {}", recording) : "";
  for (const Label& label : labels)
    if (key == label.key) return label.text + suffix;
  const std::string last = key.substr(key.rfind('.') + 1);
  for (const Label& label : labels) {
    if (last != label.key) continue;
    for (const auto* channel : {"force", "velocity", "displacement"})
      if (key.find(channel) != std::string::npos)
        return fmt::format("{} of the {} channel{}", label.text, channel, suffix);
    return label.text + suffix;
  }
  return "";
}

const fitting::Parameter* find_parameter(const fitting::Fit& fit, const std::string& key,
                                         int recording) {
  for (const fitting::Parameter& parameter : fit.parameters) {
    const fitting::ParameterKey found = fitting::parameter_key(parameter.name);
    if (found.key == key && (found.recording == 0 || found.recording == recording + 1))
      return &parameter;
  }
  return nullptr;
}

bool has_interval(const std::array<double, 2>& interval) {
  return std::isfinite(interval[0]) && std::isfinite(interval[1]) && interval[1] > interval[0];
}

std::string interval_text(const std::array<double, 2>& interval, double error,
                          const DisplayUnit& unit) {
  if (!(error > 0.0)) error = (interval[1] - interval[0]) / 4.0;
  return to_precision_of(interval[0], error, unit) + " to " +
         to_precision_of(interval[1], error, unit);
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

std::string capital(std::string word) {
  if (!word.empty() && word[0] >= 'a' && word[0] <= 'z')
    word[0] = static_cast<char>(word[0] - 'a' + 'A');
  return word;
}

std::string file_name(const std::string& path) {
  return path.substr(path.find_last_of("/\\") + 1);
}

std::string recording_name(const fitting::Fit& fit, std::size_t recording) {
  const std::string name =
      recording < fit.impacts.size() ? file_name(fit.impacts[recording].recording) : "";
  return name.empty() ? fmt::format("recording {}", recording + 1) : name;
}

std::string count_word(std::size_t count) {
  constexpr std::array<const char*, 13> words{{"no", "one", "two", "three", "four", "five", "six",
                                               "seven", "eight", "nine", "ten", "eleven",
                                               "twelve"}};
  return count < words.size() ? words[count] : fmt::format("{}", count);
}

std::string html_code(const std::string& name) {
  std::string out = "<code>", piece;
  for (const char c : name) {
    piece += c;
    if (c != '.' && c != '_' && c != '-') continue;
    out += escaped(piece) + "<wbr>";
    piece.clear();
  }
  return out + escaped(piece) + "</code>";
}

std::string html_list(const std::vector<std::string>& sentences, const char* css_class) {
  if (sentences.empty()) return "";
  std::string out = *css_class == '\0' ? "<ul>" : fmt::format("<ul class=\"{}\">", css_class);
  for (const std::string& sentence : sentences) out += "<li>" + escaped(sentence) + "</li>";
  return out + "</ul>\n";
}

std::string html_section(const char* id, const std::string& title, const std::string& body_html) {
  return fmt::format(
      "<section id=\"{}\" aria-labelledby=\"{}-title\">\n<h2 id=\"{}-title\">{}</h2>\n{}"
      "</section>\n",
      id, id, id, escaped(title), body_html);
}

}  // namespace impactrig::reports
