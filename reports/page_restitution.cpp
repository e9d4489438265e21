// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

struct Meaning {
  const char* key;
  const char* name;
  const char* meaning;
};

constexpr std::array<Meaning, 4> meanings{
    {{"law", "of the law", "the parameter e of the damping law: a property of the contact"},
     {"energetic", "energetic (Stronge)",
      "square root of the work the contact gave back over the work it took"},
     {"kinetic", "kinetic (Poisson)", "impulse after deepest penetration over impulse before it"},
     {"kinematic", "kinematic (Newton)",
      "speed of the struck point after the first contact over its speed before"}}};

std::string html_estimates(const fitting::Fit& fit) {
  double largest = 1.0;
  for (const auto& [key, estimate] : fit.restitution)
    for (const double value : {estimate.value, estimate.ci95[1]})
      if (std::isfinite(value)) largest = std::max(largest, value);
  std::string rows;
  for (const Meaning& meaning : meanings) {
    const auto found = fit.restitution.find(meaning.key);
    if (found == fit.restitution.end()) continue;
    const fitting::Estimate& estimate = found->second;
    const bool interval = has_interval(estimate.ci95);
    // Four decimals are plenty: the interval knows nothing of what the model leaves out.
    const double error =
        interval ? std::max(1e-3, (estimate.ci95[1] - estimate.ci95[0]) / 4.0) : 0.0;
    const bool law = meaning.key == std::string("law");
    rows += fmt::format(
        "<tr{}><th scope=\"row\">{}<span>{}</span></th><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td>"
        "<td class=\"chart\">{}</td></tr>\n",
        law ? " class=\"strong\"" : "", meaning.name, meaning.meaning,
        to_precision_of(estimate.value, error, {1.0, ""}),
        interval ? interval_text(estimate.ci95, error, {1.0, ""})
        : law && find_parameter(fit, "contact.restitution") == nullptr ? "held, not fitted"
                                                                       : "not estimated",
        svg_interval(estimate.value, estimate.ci95, largest,
                     law ? palette::model : palette::measured));
  }
  if (rows.empty()) return "<p>No restitution was computed for this fit.</p>\n";
  return "<div class=\"scroll\"><table class=\"restitution\"><caption>The four restitutions, of "
         "the "
         "first contact" +
         std::string(fit.predictions.size() > 1 ? " of the first recording" : "") +
         "</caption>\n<thead><tr><th scope=\"col\">Restitution</th><th scope=\"col\" "
         "class=\"n\">Value"
         "</th><th scope=\"col\" class=\"n\">95 % interval</th><th scope=\"col\" class=\"chart\">" +
         svg_interval_scale(largest) + "</th></tr></thead>\n<tbody>" + rows +
         "</tbody></table></div>\n";
}

struct Share {
  const char* css_class;
  std::string name;
  double energy;  // [J]
};

/// Where the energy the bar brought is at the end of the run.
std::vector<Share> shares(const models::EnergyAudit& energy) {
  const double rest =
      energy.initial - energy.dissipated - energy.damped - energy.vibration - energy.rigid_rotation;
  return {{"lost", "dissipated in the contact", energy.dissipated},
          {"damped", "damped in bar, hinge and stop", energy.damped},
          {"vibration", "left in vibration", energy.vibration},
          {"rotation", "left in rigid rotation", energy.rigid_rotation},
          {"rest", "rest: raised, in the hinge’s spring, in the stop", rest}};
}

/// Stacked bar with its legend; text and widths only, so that it adapts to the screen and prints.
std::string html_energy_bar(const models::EnergyAudit& energy) {
  std::string bar, legend;
  double whole = 0.0;
  for (const Share& share : shares(energy)) whole += std::max(0.0, share.energy);
  if (!(whole > 0.0) || !(energy.initial > 0.0))
    return "<p>The energy balance of this prediction is not known.</p>\n";
  for (const Share& share : shares(energy)) {
    if (share.css_class == std::string("rest") && std::abs(share.energy) < 1e-3 * energy.initial)
      continue;  // no more than rounding
    if (share.css_class == std::string("damped") && share.energy == 0.0) continue;
    const double part = std::max(0.0, share.energy) / whole;
    if (part >= 5e-4)
      bar += fmt::format("<span class=\"{}\" style=\"flex-grow:{:.4f}\"></span>", share.css_class,
                         part);
    legend += fmt::format("<div><dt class=\"{}\">{}</dt><dd>{} <span>{}</span></dd></div>",
                          share.css_class, share.name, quantity(share.energy, "J"),
                          percent(share.energy / energy.initial));
  }
  return fmt::format(
      "<figure class=\"energy\"><figcaption>Where the {} went that the bar brought "
      "(100 %)</figcaption><div class=\"bar\" aria-hidden=\"true\">{}</div><dl>{}</dl>"
      "</figure>\n",
      quantity(energy.initial, "J"), bar, legend);
}

std::string energy_sentence(const models::EnergyAudit& energy) {
  if (!(energy.initial > 0.0)) return "";
  return fmt::format(
      "The bar came with {} of kinetic energy. The contact dissipated {} of it{}; {} was left in "
      "the bar’s vibration at the end of the run and {} in its rotation. ",
      quantity(energy.initial, "J"), percent(energy.dissipated / energy.initial),
      energy.damped > 0.0 ? fmt::format(", damping in bar, hinge and stop {}",
                                        percent(energy.damped / energy.initial))
                          : "",
      percent(energy.vibration / energy.initial), percent(energy.rigid_rotation / energy.initial));
}

/// Why the kinematic number is not the contact's.
std::string kinematic_sentence(double kinematic, double energetic) {
  if (!std::isfinite(kinematic) || !std::isfinite(energetic)) return "";
  if (std::abs(kinematic - energetic) <= 0.05)
    return fmt::format(
        "The struck point left at {} of its approach speed and the contact’s own "
        "(energetic) restitution is {}: in this impact the bar behaved nearly as a "
        "rigid body. ",
        significant(kinematic, 2), significant(energetic, 2));
  return fmt::format(
      "The struck point left at {} of its approach speed, although the contact gave back {} of the "
      "work it had taken ({}²): the difference is no loss in the contact but motion that the bar’s "
      "bending has taken up or given. A restitution read from velocities must therefore not be put "
      "into a contact law: it would count the vibration as contact loss. ",
      significant(kinematic, 2), percent(energetic * energetic), significant(energetic, 2));
}

/// Why the kinetic number can be above 1.
std::string kinetic_sentence(double kinetic) {
  if (!(kinetic > 1.0)) return "";
  return fmt::format(
      "The kinetic restitution is {}, above 1: after its deepest point the bar was "
      "pressed on by its own vibration, so that the contact’s second half had the "
      "larger impulse. ",
      significant(kinetic, 2));
}

/// Why e of the law is not the ratio it returns.
std::string law_sentence(double law, double energetic, const std::string& damping) {
  if (!std::isfinite(law) || !std::isfinite(energetic) || damping == "none") return "";
  if (std::abs(law - energetic) <= 0.02)
    return fmt::format(
        "The law’s e and the energetic restitution agree: {} damping did what its "
        "parameter says.",
        damping);
  return fmt::format(
      "The law’s e is {}, but the contact returned {} (energetic). That is no contradiction: e "
      "enters the {} law through its damping factor and equals the energetic restitution only "
      "where "
      "that factor is exact and the approach undisturbed. To compare contacts, compare the "
      "energetic "
      "number; to simulate again with this law, use e.",
      significant(law, 2), significant(energetic, 2), damping);
}

double value_of(const fitting::Fit& fit, const char* key, double fallback) {
  const auto found = fit.restitution.find(key);
  return found == fit.restitution.end() ? fallback : found->second.value;
}

std::string html_explanation(const fitting::Fit& fit) {
  if (fit.predictions.empty()) return "";
  const models::Simulation& run = fit.predictions.front();
  const double energetic = value_of(fit, "energetic", run.restitution.energetic);
  std::string out =
      "<p>Four numbers are called restitution. For a rigid body without friction they are equal; "
      "for "
      "a bar that bends they are not, and only the first belongs to the contact law.</p>\n<p>";
  out +=
      escaped(energy_sentence(run.energy) +
              kinematic_sentence(value_of(fit, "kinematic", run.restitution.kinematic), energetic) +
              kinetic_sentence(value_of(fit, "kinetic", run.restitution.kinetic)));
  out += "</p>\n";
  const models::Contact& contact = fit.rig.rig.contact;
  if (!contact.takes_restitution()) return out;
  const std::string law =
      law_sentence(value_of(fit, "law", run.restitution.law), energetic, contact.damping);
  return law.empty() ? out : out + "<p>" + escaped(law) + "</p>\n";
}

/// The same numbers of each recording, where there are several.
std::string html_by_recording(const fitting::Fit& fit) {
  if (fit.predictions.size() < 2) return "";
  std::string rows;
  for (std::size_t r = 0; r < fit.predictions.size(); ++r) {
    const models::Restitution& e = fit.predictions[r].restitution;
    rows += fmt::format("<tr><th scope=\"row\">{}</th>", escaped(recording_name(fit, r)));
    for (const double value : {e.energetic, e.kinetic, e.kinematic})
      rows += "<td class=\"n\">" + significant(value, 3) + "</td>";
    rows += "</tr>\n";
  }
  return "<div class=\"scroll\"><table><caption>As predicted, by recording</caption><thead><tr>"
         "<th scope=\"col\">Recording</th><th scope=\"col\" class=\"n\">energetic</th>"
         "<th scope=\"col\" class=\"n\">kinetic</th><th scope=\"col\" class=\"n\">kinematic</th>"
         "</tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

std::string html_balances(const fitting::Fit& fit) {
  std::string out;
  for (std::size_t r = 0; r < fit.predictions.size(); ++r) {
    if (fit.predictions.size() > 1) out += "<h3>" + escaped(recording_name(fit, r)) + "</h3>\n";
    const models::EnergyAudit& energy = fit.predictions[r].energy;
    out += html_energy_bar(energy);
    const double unbalanced = std::abs(energy.unbalanced());
    if (std::isfinite(unbalanced))
      out +=
          fmt::format("<p class=\"note\">The account is out of balance by {} of the energy.</p>\n",
                      unbalanced < 1e-4 ? significant(unbalanced, 1) : percent(unbalanced));
  }
  return out;
}

}  // namespace

std::string html_restitution(const ReportData& data) {
  return html_section("restitution", "Two truths about e",
                      html_explanation(data.fit) + html_estimates(data.fit) +
                          html_by_recording(data.fit) + html_direct(data.fit) +
                          html_balances(data.fit));
}

}  // namespace impactrig::reports
