// SPDX-License-Identifier: BSD-3-Clause
#include "app/law_texts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "reports/numbers.hpp"

namespace impactrig::app {
namespace {

using reports::quantity;

Json or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::string or_dash(const std::optional<double>& value, const char* format = "{:.4f}") {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

template <typename Text>
Json entry_json(const Text& law) {
  return {{"name", law.name},
          {"description", law.description},
          {"formula", law.formula},
          {"validity", law.validity},
          {"source", law.source}};
}

template <typename Text>
std::string head_text(const Text& law, const std::string& origin) {
  return fmt::format("{}: {}\n  formula   {}\n  valid     {}\n  source    {}\n  contact   {}\n",
                     law.name, law.description, law.formula, law.validity, law.source, origin);
}

std::string warnings_text(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += fmt::format("\nwarning: {}\n", warning);
  return text;
}

/// p/f ∂f/∂p and its like: by how many per cent one per cent of the key changes the quantity.
struct Elasticity {
  double force, energy, penetration;
};

Elasticity elasticity(const models::LawDerivative& by, const ElasticFigures& at) {
  return {by.value * by.force / at.force, by.value * by.energy / at.energy,
          by.value * by.penetration / at.penetration};
}

std::string row_text(const std::string& label, const ReboundRow& row) {
  std::string text = fmt::format("  {:<42}", label);
  for (const std::optional<double>& e : row.rebound) text += fmt::format(" {:>6}", or_dash(e));
  return text + "\n";
}

/// Whether a law rebounds the same beside all families, in the digits shown.
bool same(std::span<const ReboundRow> rows) {
  return std::ranges::all_of(
      rows, [&](const ReboundRow& row) { return row_text("", row) == row_text("", rows[0]); });
}

std::string impact_line(std::string_view law, const models::FreeImpact& impact) {
  return fmt::format("  {:<29} {:>10} {:>10} {:>10} {:>8.4f}\n", law,
                     quantity(impact.peak_force, "N", 4), quantity(impact.max_penetration, "m", 4),
                     quantity(impact.duration, "s", 4), impact.rebound_ratio);
}

Json impact_json(std::string_view law, const models::FreeImpact& impact) {
  return {{"law", law},
          {"peak_force_n", impact.peak_force},
          {"max_penetration_m", impact.max_penetration},
          {"duration_s", impact.duration},
          {"rebound_ratio", impact.rebound_ratio}};
}

}  // namespace

std::string list_text() {
  const auto lines = [](const auto& law) {
    return fmt::format("  {:<29}{}\n  {:<29}{}\n", law.text.name, law.text.description, "",
                       law.text.source);
  };
  std::string text = "Elastic (contact.law)\n";
  for (const models::ElasticLawEntry& law : models::elastic_laws()) text += lines(law);
  text += "\nDamping (contact.damping)\n";
  for (const models::DampingLaw& law : models::damping_laws()) text += lines(law);
  return text +
         "\n`impactrig laws LAW` tells more of one, `--table` what e_in comes out as, "
         "`--compare RIG` draws all.\n";
}

Json list_json() {
  Json json = {{"elastic", Json::array()}, {"damping", Json::array()}};
  for (const auto& law : models::elastic_laws()) json["elastic"].push_back(entry_json(law.text));
  for (const auto& law : models::damping_laws()) json["damping"].push_back(entry_json(law.text));
  return json;
}

std::string elastic_text(const LawScene& scene, const LawContact& choice,
                         const ElasticFigures& at) {
  std::string text =
      head_text(models::elastic_law_entry(choice.contact.law).text, "of " + scene.origin);
  if (!choice.stand_in.empty()) text += fmt::format("  stand-in  {}\n", choice.stand_in);
  text += fmt::format("\nAt a penetration of {}:\n", quantity(at.penetration, "m", 4));
  const auto line = [&](const char* what, const std::string& value) {
    text += fmt::format("  {:<17}{}\n", what, value);
  };
  line("force", quantity(at.force, "N", 5));
  line("stiffness", quantity(at.stiffness, "N/m", 5));
  line("stored energy", quantity(at.energy, "J", 5));
  line("limit force", at.limit_force ? quantity(*at.limit_force, "N", 4) : "none");
  if (at.half_width) line("half width", fmt::format("{:.3g} of the bar's radius", *at.half_width));
  text += fmt::format("\n  {:<33}{:>14} {:<6} {:>9} {:>9} {:>9}\n", "key p", "value", "",
                      "dlnf/dlnp", "dlnU/dlnp", "dlnd/dlnp");
  for (const models::LawDerivative& by : at.derivatives) {
    const Elasticity e = elasticity(by, at);
    text += fmt::format("  {:<33}{:>14.6g} {:<6} {:>9.4f} {:>9.4f} {:>9.4f}\n", by.key, by.value,
                        by.unit == "1" ? "" : by.unit, e.force, e.energy, e.penetration);
  }
  return text + "  (force f and energy U at this penetration d; d at this force)\n" +
         warnings_text(at.warnings);
}

Json elastic_json(const LawScene& scene, const LawContact& choice, const ElasticFigures& at) {
  const models::ElasticLawText& law = models::elastic_law_entry(choice.contact.law).text;
  Json json = {{"law", law.name},
               {"force_n", at.force},
               {"stiffness_n_m", at.stiffness},
               {"energy_j", at.energy},
               {"limit_force_n", or_null(at.limit_force)},
               {"penetration_m", at.penetration},
               {"half_width_m",
                at.half_width ? Json(*at.half_width * choice.contact.radius) : Json(nullptr)},
               {"half_width_over_radius", or_null(at.half_width)},
               {"derivatives", Json::array()},
               {"warnings", at.warnings},
               {"formula", law.formula},
               {"validity", law.validity},
               {"source", law.source},
               {"contact", scene.origin}};
  if (!choice.stand_in.empty()) json["stand_in"] = choice.stand_in;
  for (const models::LawDerivative& by : at.derivatives) {
    const Elasticity e = elasticity(by, at);
    json["derivatives"].push_back({{"key", by.key},
                                   {"unit", by.unit},
                                   {"value", by.value},
                                   {"force_n", by.force},
                                   {"energy_j", by.energy},
                                   {"penetration_m", by.penetration},
                                   {"dlnf_dlnp", e.force},
                                   {"dlnu_dlnp", e.energy},
                                   {"dlnd_dlnp", e.penetration}});
  }
  return json;
}

std::string damping_text(const LawScene& scene, std::string_view name, const DampingFigures& of) {
  const models::DampingLawText& law = models::damping_law(name).text;
  std::string text =
      head_text(law, fmt::format("law {} of {}", scene.rig.contact.law, scene.origin));
  text += of.restitution ? fmt::format("\nFor a restitution of {:g}:\n", *of.restitution)
                         : "\nFor the coefficient that the rig states:\n";
  if (of.factor) text += fmt::format("  factor d         {:.7g}\n", *of.factor);
  if (of.damping_ratio) text += fmt::format("  damping ratio    {:.7g}\n", *of.damping_ratio);
  if (of.relaxation_time)
    text += fmt::format("  relaxation time  {}\n", quantity(*of.relaxation_time, "s", 5));
  text += fmt::format("  rebound          {} of the approach speed, of free rigid bodies\n",
                      or_dash(of.rebound, "{:.6f}"));
  const bool both = of.tension_matters();
  text += fmt::format("\n  {:>5} {:>9}{}\n", "e_in", "e_out", both ? "  with tension" : "");
  for (const ReboundPoint& point : of.curve)
    text += fmt::format("  {:>5.2f} {:>9}{}\n", point.restitution, or_dash(point.clipped),
                        both ? fmt::format("  {:>12}", or_dash(point.tension)) : "");
  if (!of.curve.empty() && !of.curve.front().clipped)
    text += "  (-: the law has no damping that returns so little)\n";
  return text + warnings_text(of.warnings);
}

Json damping_json(const LawScene& scene, std::string_view name, const DampingFigures& of) {
  const models::DampingLawText& law = models::damping_law(name).text;
  Json json = {{"law", law.name},
               {"restitution", or_null(of.restitution)},
               {"d", or_null(of.factor)},
               {"rebound_ratio", or_null(of.rebound)},
               {"damping_ratio", or_null(of.damping_ratio)},
               {"relaxation_time_s", or_null(of.relaxation_time)},
               {"curve", Json::array()},
               {"warnings", of.warnings},
               {"formula", law.formula},
               {"validity", law.validity},
               {"source", law.source},
               {"elastic_law", scene.rig.contact.law},
               {"contact", scene.origin}};
  for (const ReboundPoint& point : of.curve)
    json["curve"].push_back({{"restitution", point.restitution},
                             {"rebound_ratio", or_null(point.clipped)},
                             {"rebound_ratio_tension", or_null(point.tension)}});
  return json;
}

std::string table_text(const LawScene& scene, const std::vector<ReboundRow>& rows) {
  std::string text = fmt::format("e_out of a free rigid impact for e_in, contact of {}\n\n  {:<42}",
                                 scene.origin, "e_in");
  for (int i = 1; i <= 10; ++i) text += fmt::format(" {:>6.1f}", 0.1 * i);
  text += "\n";
  for (std::span<const ReboundRow> left = rows; !left.empty();) {
    std::size_t count = 1;
    while (count < left.size() && left[count].damping == left[0].damping) ++count;
    const std::span<const ReboundRow> own = left.first(count);
    if (same(own))
      text += row_text(fmt::format("{}, all three", own[0].damping), own[0]);
    else
      for (const ReboundRow& row : own)
        text += row_text(fmt::format("{}, {}", row.damping, row.elastic), row);
    left = left.subspan(count);
  }
  return text +
         "\nThe three: goldsmith, hertz-point, and linear as stiff as takes the impact's "
         "energy to goldsmith's depth. -: the law cannot.\n";
}

Json table_json(const LawScene& scene, const std::vector<ReboundRow>& rows) {
  Json json = {{"contact", scene.origin}, {"restitution", Json::array()}, {"rows", Json::array()}};
  for (int i = 1; i <= 10; ++i) json["restitution"].push_back(i / 10.0);
  for (const ReboundRow& row : rows) {
    Json rebound = Json::array();
    for (const std::optional<double>& e : row.rebound) rebound.push_back(or_null(e));
    json["rows"].push_back(
        {{"damping", row.damping}, {"elastic", row.elastic}, {"rebound_ratio", rebound}});
  }
  return json;
}

std::string comparison_text(const LawScene& scene, const LawComparison& comparison) {
  const models::Contact& own = scene.rig.contact;
  std::string text = fmt::format("Contact of {}\n\n", scene.origin);
  const auto head = [&](const std::string& what) {
    text += fmt::format("{}\n  {:<29} {:>10} {:>10} {:>10} {:>8}\n", what, "law", "peak", "depth",
                        "contact", "e_out");
  };
  head("Elastic laws, undamped free impact");
  bool stand_ins = false;
  for (const ElasticCurve& curve : comparison.elastic) {
    text += impact_line(std::string(curve.law->name) + (curve.stand_in.empty() ? "" : "*"),
                        curve.impact);
    stand_ins = stand_ins || !curve.stand_in.empty();
  }
  if (stand_ins)
    text += "  *: a stiffness the rig does not state, as stiff as takes the energy to its depth\n";
  head(fmt::format("\nDamping laws, free impact with {} and e = {:g}", own.law, own.restitution));
  for (const DampingLoop& loop : comparison.damping)
    text += impact_line(loop.law->name, loop.impact);
  return text;
}

Json comparison_json(const LawScene& scene, const LawComparison& comparison) {
  Json json = {{"contact", scene.origin},
               {"elastic_law", scene.rig.contact.law},
               {"damping_law", scene.rig.contact.damping},
               {"restitution", scene.rig.contact.restitution},
               {"effective_mass_kg", scene.mass},
               {"approach_velocity_m_s", scene.speed},
               {"penetration_m", scene.depth},
               {"elastic", Json::array()},
               {"damping", Json::array()},
               {"refused", Json::array()}};
  for (const ElasticCurve& curve : comparison.elastic) {
    Json entry = impact_json(curve.law->name, curve.impact);
    entry["force_n"] = curve.force;
    if (!curve.stand_in.empty()) entry["stand_in"] = curve.stand_in;
    json["elastic"].push_back(entry);
  }
  for (const DampingLoop& loop : comparison.damping)
    json["damping"].push_back(impact_json(loop.law->name, loop.impact));
  for (const Refusal& refusal : comparison.refused)
    json["refused"].push_back({{"law", refusal.law}, {"reason", refusal.reason}});
  return json;
}

}  // namespace impactrig::app
