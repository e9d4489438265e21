// SPDX-License-Identifier: BSD-3-Clause
#include "app/law_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "reports/svg.hpp"

namespace impactrig::app {
namespace {

using models::DampingForm;
using reports::Series;

constexpr int points = 160;  // along a force curve
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A kind of law has a colour and a dash: Okabe and Ito's blue, vermilion, green and purple.
struct Style {
  const char* colour;
  const char* dashes;
};

constexpr Style first_kind{"#0072b2", ""};
constexpr Style second_kind{"#d55e00", "7 3"};
constexpr Style third_kind{"#00805f", "2 2.5"};
constexpr Style fourth_kind{"#aa4499", "9 3 2 3"};

Style style_of(const models::ElasticLaw& law) {
  if (std::holds_alternative<models::LogarithmicContact<>>(law)) return first_kind;
  if (std::holds_alternative<models::PowerContact<>>(law)) return second_kind;
  return third_kind;
}

Style style_of(DampingForm form) {
  switch (form) {
    case DampingForm::proportional:
      return first_kind;
    case DampingForm::implicit:
      return fourth_kind;
    case DampingForm::constant:
    case DampingForm::natural:
    case DampingForm::tangent:
    case DampingForm::closing:
      return second_kind;
    case DampingForm::relaxing:
    case DampingForm::hertzian:
      return third_kind;
  }
  return first_kind;
}

void dress(Series& series, const Style& style, bool own) {
  series.colour = own ? reports::palette::ink : style.colour;
  series.dashes = style.dashes;
  series.width = own ? 2.8 : 1.3;
  series.opacity = own ? 1.0 : 0.85;
}

Series force_curve(const models::Contact& contact, double depth) {
  const models::ElasticLaw law = models::elastic_law(contact);
  Series series;
  for (int i = 0; i <= points; ++i) {
    series.x.push_back(depth * i / points);
    series.y.push_back(models::elastic_force(law, series.x.back()));
  }
  return series;
}

/// Cuts what lies above `most`, so that the line ends there.
void cut_above(Series& series, double most) {
  for (std::size_t i = 1; i < series.y.size(); ++i) {
    if (series.y[i] <= most) continue;
    const double part = (most - series.y[i - 1]) / (series.y[i] - series.y[i - 1]);
    series.x[i] = series.x[i - 1] + part * (series.x[i] - series.x[i - 1]);
    series.y[i] = most;
    series.x.resize(i + 1);
    series.y.resize(i + 1);
  }
}

reports::Axis penetration_axis(double most) {
  return {"Penetration", reports::display_unit(most, "m"), {}};
}

reports::Axis force_axis(double most) {
  return {"Force", reports::display_unit(most, "N"), {}};
}

/// Whether two loops are nearly one line.
bool alike(const models::FreeImpact& a, const models::FreeImpact& b) {
  constexpr double apart = 0.02;  // of the largest penetration and force
  const std::size_t count = std::min(a.loop.size(), b.loop.size());
  const auto differ = [&](const auto& p, const auto& q) {
    return std::hypot((p.penetration - q.penetration) / a.max_penetration,
                      (p.force - q.force) / a.peak_force) > apart;
  };
  for (std::size_t i = 0; i < count; ++i)
    if (differ(a.loop[i], b.loop[i])) return false;
  return !differ(a.loop.back(), b.loop.back());
}

using Group = std::vector<const DampingLoop*>;

/// Damping laws of a kind whose loops are nearly one line, by the peak force of the first; the
/// rig's own law stands for its group.
std::vector<Group> grouped(const std::vector<DampingLoop>& loops, std::string_view own) {
  std::vector<Group> groups;
  const auto sort_in = [&](const DampingLoop& loop) {
    const auto same = std::ranges::find_if(groups, [&](const Group& group) {
      return style_of(group.front()->law->form).colour == style_of(loop.law->form).colour &&
             alike(group.front()->impact, loop.impact);
    });
    if (same != groups.end())
      same->push_back(&loop);
    else
      groups.push_back({&loop});
  };
  for (const DampingLoop& loop : loops)
    if (loop.law->name == own) sort_in(loop);
  for (const DampingLoop& loop : loops)
    if (loop.law->name != own) sort_in(loop);
  std::ranges::stable_sort(groups, std::greater{},
                           [](const Group& group) { return group.front()->impact.peak_force; });
  return groups;
}

/// The names of a group in lines that fit the key.
std::string names_of(const Group& group) {
  constexpr std::size_t longest = 36;  // characters
  std::string text, line;
  for (const DampingLoop* loop : group) {
    const std::string name(loop->law->name);
    if (!line.empty() && line.size() + name.size() > longest) {
      text += line + ",\n";
      line.clear();
    }
    line += (line.empty() ? "" : ", ") + name;
  }
  return text + line;
}

/// "0.500", "0.470 to 0.488": rebound over approach speed.
std::string rebounds_of(const Group& group) {
  double low = group.front()->impact.rebound_ratio, high = low;
  for (const DampingLoop* loop : group) {
    low = std::min(low, loop->impact.rebound_ratio);
    high = std::max(high, loop->impact.rebound_ratio);
  }
  const std::string one = fmt::format("{:.3f}", low), other = fmt::format("{:.3f}", high);
  return one == other ? one : one + " to " + other;
}

Series loop_of(const Group& group, bool own) {
  Series series;
  for (const models::FreeImpact::Point& point : group.front()->impact.loop) {
    series.x.push_back(point.penetration);
    series.y.push_back(point.force);
  }
  dress(series, style_of(group.front()->law->form), own);
  series.label = names_of(group);
  series.note = rebounds_of(group);
  return series;
}

reports::Figure elastic_panel(const LawScene& scene, const LawComparison& comparison) {
  const double own = models::elastic_force(models::elastic_law(scene.rig.contact), scene.depth);
  const double most = 2.5 * own;
  reports::Panel panel;
  panel.height = 430.0;
  panel.y = force_axis(most);
  panel.y.range = {{0.0, 1.02 * most}};
  panel.ticks = 6;
  bool stand_ins = false;
  for (const ElasticCurve& curve : comparison.elastic) {
    Series series = force_curve(curve.contact, scene.depth);
    cut_above(series, most);
    dress(series, style_of(models::elastic_law(curve.contact)),
          curve.law->name == scene.rig.contact.law);
    series.tag = fmt::format("{}", panel.series.size() + 1);
    series.label = std::string(curve.law->name) + (curve.stand_in.empty() ? "" : "*");
    const reports::DisplayUnit& unit = panel.y.unit;
    series.note = reports::significant(unit.factor * curve.force, 3) + " " + unit.text;
    stand_ins = stand_ins || !curve.stand_in.empty();
    panel.series.push_back(std::move(series));
  }
  reports::Figure figure;
  figure.heading = "Elastic laws, up to the depth of the rig's impact";
  figure.x = penetration_axis(scene.depth);
  figure.x.range = {{0.0, 1.03 * scene.depth}};
  figure.ticks = 5;
  figure.width = 785.0;
  figure.key = 320.0;
  figure.key_title = "law";
  figure.note_title = "force at that depth";
  figure.key_foot = {"solid: logarithmic; dashed: power laws;", "dotted: others; bold: the rig's"};
  if (stand_ins) figure.key_foot.push_back("*: a stiffness that the rig does not state");
  figure.panels = {std::move(panel)};
  return figure;
}

reports::Figure damping_panel(const LawScene& scene, const LawComparison& comparison) {
  const models::Contact& contact = scene.rig.contact;
  reports::Panel panel;
  panel.height = 430.0;
  panel.ticks = 6;
  double deepest = 0.0, highest = 0.0, lowest = 0.0;
  for (const Group& group : grouped(comparison.damping, contact.damping)) {
    const models::FreeImpact& impact = group.front()->impact;
    deepest = std::max(deepest, impact.max_penetration);
    highest = std::max(highest, impact.peak_force);
    lowest = std::min(lowest, impact.lowest_force);
    panel.series.push_back(loop_of(group, group.front()->law->name == contact.damping));
    panel.series.back().tag = fmt::format("{}", panel.series.size());
  }
  panel.y = force_axis(highest);
  panel.y.range = {{1.05 * lowest, 1.05 * highest}};
  reports::Figure figure;
  figure.heading = fmt::format("Damping laws, loops of one free rigid impact ({}, e = {:g})",
                               contact.law, contact.restitution);
  figure.x = penetration_axis(deepest);
  figure.x.range = {{0.0, 1.03 * deepest}};
  figure.ticks = 5;
  figure.width = 900.0;
  figure.key = 425.0;
  figure.key_title = "law, by peak force";
  figure.note_title = "rebound / approach speed";
  figure.key_foot = {"solid: in proportion to the elastic force; dash and dots: implicit;",
                     "dashed: made of a damping ratio; dotted: others; bold: the rig's.",
                     "Laws within 2 % of each other are one line."};
  figure.panels = {std::move(panel)};
  return figure;
}

}  // namespace

std::string elastic_picture(const models::Contact& contact, const ElasticFigures& figures) {
  const double limit = models::limit_penetration(models::elastic_law(contact));
  const bool near = limit < 4.0 * figures.penetration;
  const double depth = near ? 1.1 * limit : 1.3 * figures.penetration;
  Series law = force_curve(contact, depth);
  law.label = contact.law;
  law.width = 2.0;
  law.colour = first_kind.colour;
  Series point;
  point.label = reports::quantity(figures.force, "N", 4) + " at " +
                reports::quantity(figures.penetration, "m", 4);
  point.x = {0.0, figures.penetration, figures.penetration};
  point.y = {figures.force, figures.force, 0.0};
  point.colour = reports::palette::muted;
  point.dashes = "4 3";
  reports::Panel panel;
  panel.y = force_axis(law.y.back());
  panel.height = 300.0;
  panel.series = {law, point};
  reports::Figure figure;
  figure.title = "Force against penetration of the law " + contact.law;
  figure.x = penetration_axis(depth);
  figure.x.range = {{0.0, depth}};
  figure.panels = {panel};
  if (near) figure.shaded = {{limit, depth, "beyond the law's limit"}};
  return reports::svg(figure);
}

std::string damping_picture(std::string_view law, const DampingFigures& figures) {
  Series clipped, allowed, asked;
  for (const ReboundPoint& point : figures.curve) {
    clipped.x.push_back(point.restitution);
    clipped.y.push_back(point.clipped.value_or(nan));
    allowed.x.push_back(point.restitution);
    allowed.y.push_back(point.tension.value_or(nan));
  }
  const bool both = figures.tension_matters();
  clipped.label = both ? "no tension" : std::string(law);
  clipped.colour = first_kind.colour;
  clipped.width = 2.0;
  allowed.label = "tension allowed";
  allowed.colour = second_kind.colour;
  allowed.dashes = second_kind.dashes;
  allowed.width = 1.6;
  asked.label = "as asked for";
  asked.colour = reports::palette::muted;
  asked.dashes = third_kind.dashes;
  asked.x = asked.y = {0.0, 1.0};
  reports::Panel panel;
  panel.y = {"Rebound / approach speed", {}, {{0.0, 1.0}}};
  panel.height = 380.0;
  panel.series = {clipped};
  if (both) panel.series.push_back(allowed);
  panel.series.push_back(asked);
  reports::Figure figure;
  figure.title = fmt::format("Rebound of a free rigid impact against e, law {}", law);
  figure.heading = fmt::format("{}, free rigid impact", law);
  figure.x = {"Restitution e in the law", {}, {{0.0, 1.0}}};
  figure.width = 600.0;
  figure.panels = {panel};
  return reports::svg(figure);
}

std::string comparison_picture(const LawScene& scene, const LawComparison& comparison) {
  return reports::svg_beside(
      fmt::format("Contact laws compared for {}: elastic law {}, damping law {}", scene.origin,
                  scene.rig.contact.law, scene.rig.contact.damping),
      {elastic_panel(scene, comparison), damping_panel(scene, comparison)});
}

}  // namespace impactrig::app
