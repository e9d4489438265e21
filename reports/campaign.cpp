// SPDX-License-Identifier: BSD-3-Clause
#include "reports/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/campaign_wording.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {
namespace {

/// A mesh error that could not be told widens nothing.
double known_or_none(double mesh) {
  return std::isfinite(mesh) ? mesh : 0.0;
}

constexpr double normal95 = 1.959964;  // 97.5 % point of the normal distribution
constexpr double closest = 0.999;      // correlation with the speed, beyond which rounding decides

/// Of errors of parameter i and of the approach speed; 0 where either has none.
double correlation_with_speed(const fitting::Fit& fit, std::size_t i) {
  const auto speed =
      std::ranges::find(fit.parameters, std::string("start.velocity"), &fitting::Parameter::name);
  if (speed == fit.parameters.end()) return 0.0;
  const auto column = static_cast<Eigen::Index>(speed - fit.parameters.begin());
  const auto row = static_cast<Eigen::Index>(i);
  if (fit.correlations.rows() <= std::max(row, column)) return 0.0;
  const double r = fit.correlations(row, column);
  return std::isfinite(r) ? r : 0.0;
}

void add_parameters(const fitting::Fit& fit, CampaignShot& shot) {
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const fitting::Parameter& p = fit.parameters[i];
    if (p.nuisance) continue;
    const std::string label = parameter_label(p.name);
    const bool known = p.identifiable && !p.at_bound && p.std_error > 0.0;
    shot.numbers.push_back({.name = p.name,
                            .label = label.empty() ? p.name : label,
                            .unit = p.unit,
                            .value = p.value,
                            .std_error = known ? p.std_error : 0.0,
                            .ci95 = p.ci95,
                            .mesh_shift = known_or_none(p.mesh_shift),
                            .mesh_error = known_or_none(p.mesh_error),
                            .compared = p.tied_to.empty(),
                            .with_speed = correlation_with_speed(fit, i)});
  }
}

void add_restitutions(const fitting::Fit& fit, CampaignShot& shot) {
  for (const char* key : {"kinematic", "kinetic", "energetic"})
    if (const auto found = fit.restitution.find(key); found != fit.restitution.end()) {
      const fitting::Estimate& estimate = found->second;
      shot.numbers.push_back({.name = std::string("restitution.") + key,
                              .label = fmt::format("Fitted restitution, {}", key),
                              .unit = "1",
                              .value = estimate.value,
                              .std_error = (estimate.ci95[1] - estimate.ci95[0]) / 2.0 / normal95,
                              .ci95 = estimate.ci95,
                              .compared = false});
    }
  if (fit.direct.empty()) return;
  const fitting::DirectRestitution& direct = fit.direct.front();
  for (const auto& [key, estimate] :
       {std::pair{"kinematic", &direct.kinematic}, std::pair{"kinetic", &direct.kinetic},
        std::pair{"energetic", &direct.energetic}})
    if (estimate->given())
      shot.numbers.push_back({.name = std::string("direct.") + key,
                              .label = fmt::format("Restitution read directly, {}", key),
                              .unit = "1",
                              .value = estimate->value,
                              .std_error = estimate->std_error,
                              .ci95 = estimate->ci95});
}

/// What is read directly needs a whole impact only, a parameter a fit that has come to its end.
bool counts(const CampaignShot& shot, const ShotNumber& number) {
  const bool whole =
      std::none_of(shot.flags.begin(), shot.flags.end(), [](const std::string& flag) {
        return flag == "no-hit" || flag == "too-short" || flag == "swapped" ||
               flag == "implausible";
      });
  const bool ended =
      number.name.starts_with("direct.") || shot.verdict.grade != Verdict::Grade::open;
  return whole && ended && std::isfinite(number.value) && std::isfinite(number.std_error) &&
         number.std_error > 0.0;
}

/// An approach speed has no trend with itself.
bool of_speed(const std::string& name) {
  return name == "start.velocity" || name == "start.release_angle";
}

void add_trend(const Campaign& campaign, CampaignQuantity& quantity) {
  std::vector<fitting::ShotValue> values;
  std::vector<fitting::ShotSpeed> speeds;
  for (const std::size_t i : quantity.shots) {
    const CampaignShot& shot = campaign.shots[i];
    const bool fitted = std::isfinite(shot.fitted_speed) && std::isfinite(shot.speed_error);
    if (!fitted && !std::isfinite(shot.approach_speed)) continue;
    const ShotNumber& number = *shot.number(quantity.name);
    values.push_back({number.value, number.std_error});
    speeds.push_back(fitted ? fitting::ShotSpeed{shot.fitted_speed, shot.speed_error,
                                                 std::clamp(number.with_speed, -closest, closest)}
                            : fitting::ShotSpeed{.speed = shot.approach_speed});
  }
  quantity.trend = fitting::speed_trend(values, speeds);
}

CampaignQuantity quantity_of(const Campaign& campaign, const ShotNumber& first) {
  CampaignQuantity quantity;
  quantity.name = first.name;
  quantity.label = first.label;
  quantity.unit = first.unit;
  std::vector<fitting::ShotValue> values;
  for (std::size_t i = 0; i < campaign.shots.size(); ++i) {
    const ShotNumber* number = campaign.shots[i].number(first.name);
    if (number == nullptr || !counts(campaign.shots[i], *number)) {
      quantity.left_out.push_back(i);
      continue;
    }
    quantity.shots.push_back(i);
    values.push_back({number->value, number->std_error});
    quantity.mesh_shift += number->mesh_shift;
    quantity.mesh_error += std::copysign(number->mesh_error, number->mesh_shift);
  }
  if (values.size() < 2) return quantity;
  quantity.between = fitting::between_shots(values);
  quantity.mesh_shift /= static_cast<double>(values.size());
  quantity.mesh_error /= static_cast<double>(values.size());
  const double mesh = std::abs(quantity.mesh_error);
  quantity.ci95 = {quantity.between.ci95[0] - mesh, quantity.between.ci95[1] + mesh};
  quantity.sentence = between_sentence(quantity);
  if (!of_speed(quantity.name)) {
    add_trend(campaign, quantity);
    quantity.trend_sentence = trend_sentence(quantity);
  }
  return quantity;
}

}  // namespace

const ShotNumber* CampaignShot::number(const std::string& wanted) const {
  for (const ShotNumber& number : numbers)
    if (number.name == wanted) return &number;
  return nullptr;
}

std::string word(const CampaignShot& shot) {
  // a fit that explains its window needs no warning that there are several contacts
  const bool sound = std::ranges::all_of(shot.flags, [](const std::string& flag) {
    return flag == "double-hit" || flag == "multiple-hits";
  });
  switch (shot.verdict.grade) {
    case Verdict::Grade::explained:
      return sound ? "pass" : "warn";
    case Verdict::Grade::in_shape:
      return "warn";
    default:
      return "fail";
  }
}

CampaignShot campaign_shot(const ReportData& data) {
  const fitting::Fit& fit = data.fit;
  CampaignShot shot;
  shot.verdict = verdict(fit);
  shot.converged = fit.termination == "converged";
  add_parameters(fit, shot);
  add_restitutions(fit, shot);
  if (fit.goodness.dof > 0)
    shot.reduced_chi2 = fit.goodness.chi2 / static_cast<double>(fit.goodness.dof);
  if (!fit.impacts.empty()) {
    const datasets::Impact& impact = fit.impacts.front();
    for (const datasets::ImpactFlag flag : impact.flags)
      shot.flags.emplace_back(datasets::name(flag));
    if (impact.force) shot.peak_force = impact.peak;
    if (impact.velocity) shot.approach_speed = impact.approach_velocity;
  }
  if (const ShotNumber* speed = shot.number("start.velocity"); speed != nullptr) {
    if (speed->std_error > 0.0) {
      shot.fitted_speed = speed->value;
      shot.speed_error = speed->std_error;
    }
    if (!std::isfinite(shot.approach_speed)) shot.approach_speed = speed->value;
  }
  if (!data.provenance.inputs.empty()) {
    shot.file = data.provenance.inputs.front().name;
    shot.input_sha256 = data.provenance.inputs.front().sha256;
  }
  shot.result_key = data.provenance.result_key;
  return shot;
}

void summarise(Campaign& campaign) {
  campaign.quantities.clear();
  campaign.not_compared.clear();
  std::vector<std::string> done;
  for (const CampaignShot& shot : campaign.shots)
    for (const ShotNumber& number : shot.numbers) {
      if (!number.compared || std::ranges::find(done, number.name) != done.end()) continue;
      done.push_back(number.name);
      CampaignQuantity quantity = quantity_of(campaign, number);
      const std::size_t shots = quantity.shots.size();
      if (shots > 1)
        campaign.quantities.push_back(std::move(quantity));
      else if (campaign.shots.size() > 1)
        campaign.not_compared.push_back(
            fmt::format("{} is not compared: of {} shots {} tells it with a standard error; the "
                        "others ended at "
                        "a bound, or their fits give no verdict.",
                        number.name, campaign.shots.size(), shots == 0 ? "none" : "one"));
    }
}

}  // namespace impactrig::reports
