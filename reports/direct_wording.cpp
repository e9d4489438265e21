// SPDX-License-Identifier: BSD-3-Clause
#include "reports/direct_wording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "reports/numbers.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {

namespace {

constexpr std::string_view smoothed_name = "kinematic, vibration averaged";
constexpr double likely_delay =
    5.0;  // standard uncertainties: a delay error beyond it is no excuse

const fitting::Contribution* row(const fitting::DirectEstimate& estimate, std::string_view source) {
  const auto found = std::ranges::find(estimate.budget, source, &fitting::Contribution::source);
  return found == estimate.budget.end() ? nullptr : &*found;
}

double relative_delay(const datasets::Impact& impact) {
  const auto& motion = impact.velocity ? impact.velocity : impact.displacement;
  return std::hypot(impact.force ? impact.force->delay_uncertainty : 0.0,
                    motion ? motion->delay_uncertainty : 0.0);
}

/// Whether the fit has the delay of one of a recording's channels elsewhere than stated.
bool contradicts_delays(const fitting::Fit& fit, std::size_t recording) {
  constexpr std::array delays = {"sensors.force.delay", "sensors.velocity.delay",
                                 "sensors.displacement.delay"};
  return std::ranges::any_of(delays, [&](const char* key) {
    const fitting::Parameter* const delay = find_parameter(fit, key, static_cast<int>(recording));
    return delay != nullptr && delay->contradicts_prior;
  });
}

/// The model's kinematic restitution where its force ends, which is what a record shows.
double kinematic_as_recorded(const models::Simulation& run) {
  const auto end = early_end_of_force(run);
  if (!end) return run.restitution.kinematic;
  const models::History& h = run.history;
  const auto before = static_cast<std::size_t>((*end - h.start) / h.interval);
  return -0.5 * (h.velocity[before] + h.velocity[before + 1]) /
         run.episodes.front().approach_velocity;
}

/// What shift of one channel would bring the model's number and the direct one together.
std::string delay_excuse(const DirectPair& pair, const datasets::Impact& impact) {
  const fitting::Contribution* const delay = row(pair.direct, "relative delay");
  const double unsure = relative_delay(impact);
  if (delay == nullptr || !(delay->std_error > 0.0) || !(unsure > 0.0)) return "";
  const double shift = std::abs(pair.fitted - pair.direct.value) / delay->std_error * unsure;
  if (!(shift < likely_delay * unsure)) return "";
  return fmt::format("An error of {} in the delay between the channels would explain it. ",
                     quantity(shift, "s", 2));
}

/// One sentence or two for a number that the model has elsewhere.
std::string difference(const DirectPair& pair, const fitting::Fit& fit, std::size_t recording) {
  const fitting::DirectRestitution& direct = fit.direct[recording];
  const std::string name = pair.name;
  std::string text =
      fmt::format("The model's {} restitution, {}, is outside the direct interval, {} to {}. ",
                  name, significant(pair.fitted, 3), significant(pair.direct.ci95[0], 3),
                  significant(pair.direct.ci95[1], 3));
  if (!direct.notes.empty()) return text + "What is said above of the record may be the reason. ";
  if (name == "kinematic")
    return text +
           "The struck point's speed at the instant of separation is mostly vibration: modes that "
           "the model lacks, or has at another frequency, show there first. ";
  if (contradicts_delays(fit, recording))
    return text + "It rests on the stated delays, which the fit contradicts. ";
  const std::string excuse = delay_excuse(pair, fit.impacts[recording]);
  if (!excuse.empty()) return text + excuse;
  if (name == "kinetic")
    return text +
           "The measured force is spread otherwise over compression and restitution than the "
           "model's: look at the force's residual about the deepest point. ";
  return text +
         "The contact takes another share of the work than the damping law with its fitted e: "
         "another law may fit better, or the measured force and speed are not of one point. ";
}

// --- A displacement alone ------------------------------------------------------------------------

bool is_of_displacement_alone(const fitting::Fit& fit, std::size_t recording) {
  return recording < fit.impacts.size() && fit.impacts[recording].rebound.has_value();
}

/// An estimate whose uncertainty is that of the motion, as the finder of impacts states it.
fitting::DirectEstimate of_displacement(double value, double std_error) {
  constexpr double quantile = 1.959963985;
  return {.value = value,
          .std_error = std_error,
          .ci95 = {value - quantile * std_error, value + quantile * std_error},
          .budget = {},
          .absent = {}};
}

/// The stretch of the rebound, from first touch as the fit has it [s]: a displacement shows its
/// instant worse than how fast the bar comes.
std::array<double, 2> stretch_of_rebound(const fitting::Fit& fit, std::size_t recording) {
  const datasets::Impact& impact = fit.impacts[recording];
  const fitting::Parameter* const fitted =
      find_parameter(fit, "impact.time", static_cast<int>(recording));
  const double touch = fitted != nullptr ? fitted->value : impact.start;
  return {impact.rebound->from - touch, impact.rebound->to - touch};
}

/// The model's mean speed away from the stop over a stretch; NaN where its history does not reach
/// so far.
double mean_rebound(const models::Simulation& run, const std::array<double, 2>& stretch) {
  const models::History& h = run.history;
  const auto displacement_at = [&h](double t) {
    const double place = (t - h.start) / h.interval;
    const auto before = static_cast<std::size_t>(std::max(0.0, place));
    if (!(place >= 0.0) || before + 1 >= h.displacement.size())
      return std::numeric_limits<double>::quiet_NaN();
    const double part = place - static_cast<double>(before);
    return (1.0 - part) * h.displacement[before] + part * h.displacement[before + 1];
  };
  return (displacement_at(stretch[0]) - displacement_at(stretch[1])) / (stretch[1] - stretch[0]);
}

std::vector<DirectPair> displacement_pairs(const fitting::Fit& fit, std::size_t recording) {
  const datasets::Impact& impact = fit.impacts[recording];
  const datasets::Rebound& rebound = *impact.rebound;
  double approach = std::numeric_limits<double>::quiet_NaN(), ratio = approach;
  if (recording < fit.predictions.size() && !fit.predictions[recording].episodes.empty()) {
    approach = fit.predictions[recording].episodes.front().approach_velocity;
    ratio = mean_rebound(fit.predictions[recording], stretch_of_rebound(fit, recording)) / approach;
  }
  DirectPair mean = {"mean rebound over approach", "1",
                     of_displacement(rebound.restitution, rebound.restitution_error), ratio};
  if (!rebound.absent.empty()) {
    mean.direct = {};
    mean.direct.absent = rebound.absent;
  }
  return {{"speed of approach", "m/s",
           of_displacement(impact.approach_velocity, rebound.approach_error), approach},
          mean};
}

std::string displacement_explanation(const fitting::Fit& fit, std::size_t recording) {
  std::string text =
      "A displacement alone shows how the bar comes and goes, not the contact's end: there is no "
      "direct kinematic, kinetic or energetic restitution. ";
  for (const DirectPair& pair : displacement_pairs(fit, recording)) {
    if (!pair.direct.given()) {
      text += fmt::format("No {}: {} ", pair.name, pair.direct.absent);
    } else if (std::isfinite(pair.fitted)) {
      text += fmt::format("The model's {}, {}, {} the direct interval. ", pair.name,
                          quantity(pair.fitted, pair.unit, 3),
                          pair.inside() ? "lies within" : "is outside");
    } else {
      text += fmt::format("The model's {} is not known, as its history ends before. ", pair.name);
    }
  }
  const auto [from, to] = stretch_of_rebound(fit, recording);
  if (fit.impacts[recording].rebound->absent.empty())
    text += fmt::format("The rebound is the mean from {} to {} after touch. ",
                        quantity(from, "s", 3), quantity(to, "s", 3));
  text.pop_back();
  return text;
}

}  // namespace

std::optional<double> early_end_of_force(const models::Simulation& run) {
  const models::History& h = run.history;
  if (run.episodes.empty() || run.episodes.front().open || !(h.interval > 0.0)) return std::nullopt;
  const double parted = (run.episodes.front().end - h.start) / h.interval;
  if (!(parted >= 1.0) || !(parted < static_cast<double>(h.force.size()))) return std::nullopt;
  auto last = static_cast<std::size_t>(parted);
  while (last > 0 && h.force[last] == 0.0) --last;
  const double ends = static_cast<double>(last) + 0.5;
  if (parted - ends < 1.0) return std::nullopt;
  return h.start + h.interval * ends;
}

bool DirectPair::inside() const {
  return direct.given() && direct.ci95[0] <= fitted && fitted <= direct.ci95[1];
}

const fitting::Contribution* DirectPair::main_source() const {
  const auto largest =
      std::ranges::max_element(direct.budget, {}, &fitting::Contribution::std_error);
  return largest == direct.budget.end() || !(largest->std_error > 0.0) ? nullptr : &*largest;
}

std::vector<DirectPair> direct_pairs(const fitting::Fit& fit, std::size_t recording) {
  if (recording >= fit.direct.size()) return {};
  if (is_of_displacement_alone(fit, recording)) return displacement_pairs(fit, recording);
  const fitting::DirectRestitution& direct = fit.direct[recording];
  const double none = std::numeric_limits<double>::quiet_NaN();
  models::Restitution model{none, none, none, none};
  double dissipated = none, depth = none;
  if (recording < fit.predictions.size()) {
    const models::Simulation& run = fit.predictions[recording];
    model = run.restitution;
    model.kinematic = kinematic_as_recorded(run);
    if (!run.episodes.empty()) {
      dissipated = run.episodes.front().dissipated;
      depth = run.episodes.front().max_penetration;
    }
  }
  return {{"kinematic", "1", direct.kinematic, model.kinematic},
          {smoothed_name.data(), "1", direct.smoothed, none},
          {"kinetic", "1", direct.kinetic, model.kinetic},
          {"energetic", "1", direct.energetic, model.energetic},
          {"dissipated energy", "J", direct.hysteresis.dissipated, dissipated},
          {"greatest penetration", "m", direct.hysteresis.max_penetration, depth}};
}

std::string direct_explanation(const fitting::Fit& fit, std::size_t recording) {
  std::string text;
  if (recording >= fit.direct.size() || recording >= fit.impacts.size()) return text;
  if (is_of_displacement_alone(fit, recording)) return displacement_explanation(fit, recording);
  const fitting::DirectRestitution& direct = fit.direct[recording];
  for (const std::string& note : direct.notes) text += note + " ";
  if (recording < fit.predictions.size())
    if (const auto end = early_end_of_force(fit.predictions[recording])) {
      const models::Simulation& run = fit.predictions[recording];
      text += fmt::format(
          "The model's force ends {} before its surfaces part; a record shows the end of the "
          "force, "
          "where the model's kinematic restitution is {} ({} where they part). ",
          quantity(run.episodes.front().end - *end, "s", 2),
          significant(kinematic_as_recorded(run), 3), significant(run.restitution.kinematic, 3));
    }
  std::vector<std::string> agree, missing;
  std::string apart, why;
  for (const DirectPair& pair : direct_pairs(fit, recording)) {
    if (pair.unit != std::string_view("1") || pair.name == smoothed_name) continue;
    if (!pair.direct.given()) {
      missing.emplace_back(pair.name);
      why = pair.direct.absent;
    } else if (pair.inside()) {
      agree.emplace_back(pair.name);
    } else if (std::isfinite(pair.fitted)) {
      apart += difference(pair, fit, recording);
    }
  }
  if (!agree.empty())
    text += fmt::format(
        "The model's {} restitution {} within what force and velocity show without a model. ",
        listed(agree), agree.size() == 1 ? "lies" : "lie");
  text += apart;
  if (!missing.empty()) text += fmt::format("No direct {} restitution: {} ", listed(missing), why);
  if (!text.empty()) text.pop_back();
  return text;
}

}  // namespace impactrig::reports
