// SPDX-License-Identifier: BSD-3-Clause
#include "reports/campaign_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reports/svg.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {
namespace {

constexpr double gap = std::numeric_limits<double>::quiet_NaN();

/// Dashes for values, lines for their intervals.
struct Marks {
  Series values, intervals;
};

Marks marks(const std::string& label, const char* colour) {
  Marks out;
  out.values.label = label;
  out.values.colour = out.intervals.colour = colour;
  out.values.width = 3.5;
  out.intervals.width = 1.0;
  out.intervals.opacity = 0.6;
  return out;
}

/// What a shot's own errors say, without the mesh error, which is all shots' alike.
std::array<double, 2> own_interval(const ShotNumber& number) {
  if (number.mesh_shift == 0.0) return number.ci95;
  const double half = 1.96 * number.std_error;
  return {number.value - half, number.value + half};
}

void add(Marks& marks, double x, double half_width, const ShotNumber& number) {
  for (const double end : {x + half_width, x - half_width, gap}) {
    marks.values.x.push_back(end);
    marks.values.y.push_back(std::isfinite(end) ? number.value : gap);
  }
  const std::array<double, 2> interval = own_interval(number);
  for (const double end : {interval[0], interval[1], gap}) {
    marks.intervals.x.push_back(std::isfinite(end) ? x : gap);
    marks.intervals.y.push_back(end);
  }
}

void append(Panel& panel, Marks&& marks) {
  if (marks.values.x.empty()) return;
  panel.series.push_back(std::move(marks.values));
  panel.series.push_back(std::move(marks.intervals));
}

Axis axis_of(const std::string& name, double magnitude, const std::string& unit) {
  return {name, display_unit(std::abs(magnitude), unit), std::nullopt};
}

bool stands_out(const CampaignQuantity& quantity, std::size_t i) {
  return i < quantity.between.deviations.size() && quantity.between.deviations[i].outlier;
}

/// From one end to the other, so that the lines stay apart: what falls in x is drawn sample by
/// sample (svg.cpp).
void add_all(const Campaign& campaign, const CampaignQuantity& quantity, double half_width,
             const std::vector<double>& x, Panel& panel) {
  Marks inside = marks("a shot, with the 95 % interval of its own errors", palette::measured);
  Marks outside = marks("stands out", palette::model);
  for (std::size_t i = quantity.shots.size(); i-- > 0;) {
    const CampaignShot& shot = campaign.shots[quantity.shots[i]];
    if (std::isfinite(x[i]))
      add(stands_out(quantity, i) ? outside : inside, x[i], half_width,
          *shot.number(quantity.name));
  }
  append(panel, std::move(outside));
  append(panel, std::move(inside));
}

std::vector<double> speeds_of(const Campaign& campaign, const CampaignQuantity& quantity) {
  std::vector<double> speeds;
  for (const std::size_t i : quantity.shots) speeds.push_back(campaign.shots[i].approach_speed);
  return speeds;
}

Series trend_line(const fitting::SpeedTrend& trend, double from, double to) {
  Series line;
  line.label = "trend, weighted";
  line.x = {from, to};
  line.width = 1.4;
  for (const double speed : line.x)
    line.y.push_back(trend.at_mean_speed + trend.slope * (speed - trend.mean_speed));
  return line;
}

bool is_restitution(const CampaignQuantity& quantity) {
  return quantity.name == "contact.restitution" || quantity.name.starts_with("direct.");
}

}  // namespace

std::string svg_shots(const Campaign& campaign, const CampaignQuantity& quantity) {
  Figure figure;
  figure.title = quantity.label + ", shot by shot";
  figure.width = 960.0;
  const auto count = static_cast<double>(campaign.shots.size());
  figure.x = {"Recording, in the order of the table", {1.0, ""}, {{0.4, count + 0.6}}};
  Panel panel;
  panel.y = axis_of(quantity.label, quantity.between.mean, quantity.unit);
  panel.zero_line = false;
  panel.bands = {{quantity.between.ci95[0], quantity.between.ci95[1], "mean, 95 %"}};
  std::vector<double> x;
  for (const std::size_t i : quantity.shots) x.push_back(static_cast<double>(i + 1));
  add_all(campaign, quantity, 0.3, x, panel);
  figure.panels.push_back(std::move(panel));
  return svg(figure);
}

std::string svg_speeds(const Campaign& campaign) {
  Figure figure;
  figure.title = "Restitution against approach speed";
  figure.width = 960.0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const CampaignShot& shot : campaign.shots)
    if (std::isfinite(shot.approach_speed)) {
      low = std::min(low, shot.approach_speed);
      high = std::max(high, shot.approach_speed);
    }
  if (!(low <= high)) return "";
  const double margin = std::max(0.04 * (high - low), 0.002 * std::abs(high));
  figure.x = axis_of("Approach speed", high, "m/s");
  figure.x.range = {{low - margin, high + margin}};
  for (const CampaignQuantity& quantity : campaign.quantities) {
    if (!is_restitution(quantity)) continue;
    Panel panel;
    panel.y = axis_of(quantity.name == "contact.restitution" ? "e of the law" : quantity.name, 1.0,
                      quantity.unit);
    panel.zero_line = false;
    panel.height = 150.0;
    if (quantity.trend) panel.series.push_back(trend_line(*quantity.trend, low, high));
    add_all(campaign, quantity, 0.006 * (high - low + 2.0 * margin), speeds_of(campaign, quantity),
            panel);
    if (!panel.series.empty()) figure.panels.push_back(std::move(panel));
  }
  return figure.panels.empty() ? "" : svg(figure);
}

}  // namespace impactrig::reports
