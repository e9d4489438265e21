// SPDX-License-Identifier: BSD-3-Clause
#include "reports/campaign_wording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/wording.hpp"

namespace impactrig::reports {
namespace {

/// "the restitution": what varies.
std::string noun(const std::string& name) {
  if (name == "start.velocity") return "the approach speed";
  if (name == "contact.restitution" || name.starts_with("direct.")) return "the restitution";
  if (name == "contact.stiffness_factor" || name == "contact.stiffness") return "the stiffness";
  return "the value";
}

std::string with_unit(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

DisplayUnit unit_of(const CampaignQuantity& quantity) {
  return display_unit(std::abs(quantity.between.mean), quantity.unit);
}

/// A spread, to two significant digits, in the unit of the mean.
std::string spread_text(double spread, const CampaignQuantity& quantity) {
  const DisplayUnit unit = unit_of(quantity);
  return with_unit(significant(spread * unit.factor, 2), unit.text);
}

std::string share_of_mean(const CampaignQuantity& quantity) {
  const double mean = std::abs(quantity.between.mean);
  return mean > 0.0 ? fmt::format(", {} of it", percent(quantity.between.tau / mean)) : "";
}

std::string tau_interval(const CampaignQuantity& quantity) {
  const auto& ci = quantity.between.tau_ci95;
  const DisplayUnit unit = unit_of(quantity);
  return fmt::format("95\u00a0%: {} to {}", significant(ci[0] * unit.factor, 2),
                     with_unit(significant(ci[1] * unit.factor, 2), unit.text));
}

}  // namespace

std::string between_sentence(const CampaignQuantity& quantity) {
  const fitting::BetweenShots& b = quantity.between;
  const std::string what = noun(quantity.name);
  switch (fitting::agreement(b)) {
    case fitting::ShotAgreement::scatter:
      return fmt::format(
          "The shots scatter {} times as much as each interval says: {} itself varies by {} from "
          "shot to shot ({}){}.",
          significant(b.scatter, 2), what, spread_text(b.tau, quantity), tau_interval(quantity),
          share_of_mean(quantity));
    case fitting::ShotAgreement::too_well:
      return fmt::format(
          "The shots scatter only {} times as much as each interval says: the intervals hold "
          "something that all shots share, such as a calibration. It does not average out, so the "
          "mean is known no better than that allows.",
          significant(b.scatter, 2));
    default:
      return fmt::format(
          "The shots differ no more than their intervals say ({} times); if {} itself varies from "
          "shot to shot, then by less than {} (95\u00a0%).",
          significant(b.scatter, 2), what, spread_text(b.tau_ci95[1], quantity));
  }
}

std::string trend_sentence(const CampaignQuantity& quantity) {
  if (!quantity.trend) return "";
  const fitting::SpeedTrend& trend = *quantity.trend;
  const double half = (trend.ci95[1] - trend.ci95[0]) / 2.0;
  const RoundedValue slope = rounded(trend.slope, half, quantity.unit);
  const std::string unit = slope.unit.empty() ? "per m/s" : slope.unit + " per m/s";
  const std::string numbers = fmt::format("{} ±\u00a0{} {} (95\u00a0%; p = {})", slope.value,
                                          slope.error, unit, significant(trend.p_value, 2));
  if (!(trend.p_value < 0.05))
    return fmt::format("No trend with approach speed is seen: {}.", numbers);
  return fmt::format("{} {} with approach speed: {}.", capital(noun(quantity.name)),
                     trend.slope > 0.0 ? "rises" : "falls", numbers);
}

std::string mean_text(const CampaignQuantity& quantity) {
  const fitting::BetweenShots& b = quantity.between;
  const DisplayUnit unit = unit_of(quantity);
  return with_unit(
      fmt::format("{} ±\u00a0{} (95\u00a0%: {})", to_precision_of(b.mean, b.std_error, unit),
                  significant(b.std_error * unit.factor, 2),
                  interval_text(quantity.ci95, b.std_error, unit)),
      unit.text);
}

std::string mesh_sentence(const CampaignQuantity& quantity) {
  if (!(std::abs(quantity.mesh_shift) > quantity.between.std_error)) return "";
  return fmt::format(
      "A mesh twice as fine would move all shots by about {}, {} standard errors of the mean; the "
      "mean’s interval was widened by that.",
      spread_text(quantity.mesh_shift, quantity),
      significant(std::abs(quantity.mesh_shift) / quantity.between.std_error, 2));
}

std::string tau_text(const CampaignQuantity& quantity) {
  if (!(quantity.between.tau_ci95[1] > 0.0)) return "none seen";
  return fmt::format("{} ({})", spread_text(quantity.between.tau, quantity),
                     tau_interval(quantity));
}

std::string outlier_names(const Campaign& campaign, const CampaignQuantity& quantity) {
  std::string names;
  for (std::size_t i = 0; i < quantity.between.deviations.size(); ++i) {
    const fitting::ShotDeviation& found = quantity.between.deviations[i];
    if (!found.outlier) continue;
    names += fmt::format("{}{} ({} standard deviations from the others)", names.empty() ? "" : ", ",
                         file_name(campaign.shots[quantity.shots[i]].file),
                         significant(found.residual, 2));
  }
  return names;
}

std::string count_sentence(const Campaign& campaign) {
  const auto count = [&](const char* wanted) {
    return std::count_if(campaign.shots.begin(), campaign.shots.end(),
                         [&](const CampaignShot& shot) { return word(shot) == wanted; });
  };
  const std::size_t all = campaign.shots.size() + campaign.failed.size();
  return fmt::format("{} of {} recordings fitted: {} pass, {} warn, {} fail{}",
                     campaign.shots.size(), all, count("pass"), count("warn"), count("fail"),
                     campaign.failed.empty()
                         ? std::string()
                         : fmt::format("; {} without a result", campaign.failed.size()));
}

}  // namespace impactrig::reports
