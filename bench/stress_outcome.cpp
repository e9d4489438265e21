// SPDX-License-Identifier: BSD-3-Clause
#include "bench/stress_outcome.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <vector>

namespace impactrig::bench {
namespace {

using Json = nlohmann::ordered_json;

/// The first number of a result that is not finite where it should be; "" when all are.
std::string not_finite(const models::Simulation& run) {
  std::string found;
  const auto look = [&](const char* what, double value) {
    if (found.empty() && !std::isfinite(value)) found = fmt::format("{} is {}", what, value);
  };
  look("peak_force", run.peak_force);
  look("peak_time", run.peak_time);
  look("max_penetration", run.max_penetration);
  look("impulse", run.impulse);
  look("duration", run.duration);
  for (const models::Episode& e : run.episodes) {
    for (const double value : {e.start, e.end, e.peak_force, e.peak_time, e.impulse,
                               e.max_penetration, e.approach_velocity, e.dissipated})
      look("a number of a contact", value);
    if (!e.open) look("a separation velocity", e.separation_velocity);
  }
  if (!run.episodes.empty() && !run.episodes.front().open)
    for (const double value :
         {run.restitution.kinematic, run.restitution.kinetic, run.restitution.energetic})
      look("a restitution", value);
  const models::EnergyAudit& a = run.energy;
  for (const double value : {a.initial, a.kinetic, a.elastic, a.gravitational, a.contact_stored,
                             a.dissipated, a.rigid_rotation, a.vibration, a.imbalance})
    look("an energy", value);
  for (const std::vector<double>* samples :
       {&run.history.force, &run.history.penetration, &run.history.velocity,
        &run.history.displacement, &run.history.deflection, &run.history.extension})
    for (const double value : *samples) look("a sample of the history", value);
  for (const models::StopHistory& stop : run.history.further)
    for (const std::vector<double>* samples : {&stop.force, &stop.penetration})
      for (const double value : *samples) look("a sample at a further stop", value);
  return found;
}

/// What cannot be in a result, whatever the scene; "" when it is sound. Contacts pull where the rig
/// file allows that.
std::string unsound(const models::Rig& rig, const models::Simulation& run) {
  if (!rig.has_stop()) return run.episodes.empty() ? "" : "a contact with no stop";
  if (run.episodes.empty()) return "no contact";
  const bool may_pull = rig.contact.tension == models::Tension::allow;
  if (!(run.peak_force > 0.0)) return fmt::format("a peak force of {:g} N", run.peak_force);
  std::vector<double> ends(std::max<std::size_t>(run.stops.size(), 1));
  for (const models::Episode& e : run.episodes) {
    double& before = ends[static_cast<std::size_t>(e.stop)];
    if (e.start < before || e.end < e.start)
      return fmt::format("a contact from {:g} to {:g} s after one that ended at {:g} s", e.start,
                         e.end, before);
    if (!may_pull && e.impulse < -1e-12 * run.impulse)
      return fmt::format("an impulse of {:g} N s", e.impulse);
    if (e.dissipated < -run.solver.accuracy * run.energy.initial)
      return fmt::format("a contact that gives {:g} J", -e.dissipated);
    if (e.stop == 0 && e.peak_force > run.peak_force)
      return "a contact with more than the peak force";
    before = e.end;
  }
  if (may_pull) return "";
  for (const double force : run.history.force)
    if (force < 0.0) return fmt::format("a pulling force of {:g} N", force);
  for (const models::StopHistory& stop : run.history.further)
    for (const double force : stop.force)
      if (force < 0.0) return fmt::format("a pulling force of {:g} N at a further stop", force);
  return "";
}

bool warns_of(const models::Simulation& run, const char* words) {
  return std::ranges::any_of(run.warnings, [&](const std::string& warning) {
    return warning.find(words) != std::string::npos;
  });
}

/// Of the largest forces in the sensor; none where a run was cut before it, or says that it is not
/// known.
double sensor_difference(const models::Simulation& run, const models::Simulation& fine) {
  if (!run.sensor || run.cut_short || fine.cut_short || !run.sensor->peak_known) return 0.0;
  return std::abs(run.sensor->peak_force / fine.sensor->peak_force - 1.0);
}

void judge_contact(const models::Simulation& run, const models::Simulation& fine,
                   Outcome& outcome) {
  const models::Episode& a = run.episodes.front();
  const models::Episode& b = fine.episodes.front();
  const auto difference = [](double x, double y) { return std::abs(x - y) / std::abs(y); };
  outcome.peak = difference(a.peak_force, b.peak_force);
  outcome.duration = difference(a.end, b.end);
  outcome.impulse = difference(a.impulse, b.impulse);
  outcome.sensor = sensor_difference(run, fine);
  if (outcome.error() <= (1.0 + 1.0 / finer) * outcome.accuracy) return;
  if (warns_of(run, "the first contact ")) return;  // that it may be so far off
  if (warns_of(fine, "the first contact ")) {
    outcome.kind = Kind::unconfirmed;
    outcome.sentence = "the finer run says that its own first contact may be far off";
    return;
  }
  outcome.kind = Kind::not_converged;
  outcome.sentence = fmt::format(
      "first contact off by {:.1e} (peak), {:.1e} (duration), {:.1e} (impulse), sensor by "
      "{:.1e} at accuracy {:.1e}",
      outcome.peak, outcome.duration, outcome.impulse, outcome.sensor, outcome.accuracy);
}

/// Of samples at the same times, as a part of the bar's length.
double largest_difference(const models::Rig& rig, const std::vector<double>& a,
                          const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0.0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]) / rig.beam.length);
  return largest;
}

bool warns_of_swing(const models::Simulation& run) {
  return warns_of(run, "energy does not balance") || warns_of(run, "displacements c");
}

void judge_swing(const models::Rig& rig, const models::Simulation& run,
                 const models::Simulation& fine, Outcome& outcome) {
  outcome.displacement =
      std::max({largest_difference(rig, run.history.displacement, fine.history.displacement),
                largest_difference(rig, run.history.deflection, fine.history.deflection),
                largest_difference(rig, run.history.extension, fine.history.extension)});
  if (outcome.error() <= (1.0 + 1.0 / finer) * outcome.accuracy) return;
  if (warns_of_swing(run)) return;  // that they may be so far off
  if (warns_of_swing(fine)) {
    outcome.kind = Kind::unconfirmed;
    outcome.sentence = "the finer run says that its own displacements may be far off";
    return;
  }
  outcome.kind = Kind::not_converged;
  outcome.sentence = fmt::format("displacements off by {:.1e} of the length at accuracy {:.1e}",
                                 outcome.displacement, outcome.accuracy);
}

}  // namespace

Json to_json(const Outcome& o) {
  return {{"scene", o.number},
          {"kind", kind_names[static_cast<std::size_t>(o.kind)]},
          {"sentence", o.sentence},
          {"accuracy", o.accuracy},
          {"energy_imbalance", o.imbalance},
          {"difference",
           {{"peak", o.peak},
            {"duration", o.duration},
            {"impulse", o.impulse},
            {"sensor", o.sensor},
            {"displacement", o.displacement}}},
          {"solve_s", o.seconds},
          {"evaluations", o.evaluations},
          {"contacts", o.contacts},
          {"small_motion", o.small_motion},
          {"cut_short", o.cut_short}};
}

Outcome outcome_of(const Json& json) {
  const auto number = [](const Json& j) { return j.is_null() ? std::nan("") : j.get<double>(); };
  Outcome o;
  const std::string kind = json.at("kind");
  o.kind = static_cast<Kind>(std::ranges::find(kind_names, kind) - kind_names.begin());
  o.number = json.at("scene");
  o.sentence = json.at("sentence");
  o.accuracy = json.at("accuracy");
  o.imbalance = number(json.at("energy_imbalance"));
  o.peak = number(json.at("difference").at("peak"));
  o.duration = number(json.at("difference").at("duration"));
  o.impulse = number(json.at("difference").at("impulse"));
  o.sensor = number(json.at("difference").at("sensor"));
  o.displacement = number(json.at("difference").at("displacement"));
  o.seconds = json.at("solve_s");
  o.evaluations = json.at("evaluations");
  o.contacts = json.at("contacts");
  o.small_motion = json.at("small_motion");
  o.cut_short = json.at("cut_short");
  return o;
}

void judge_alone(const models::Rig& rig, const models::Simulation& run, Outcome& outcome) {
  outcome.imbalance = run.energy.unbalanced();
  outcome.seconds = run.cost.seconds;
  outcome.evaluations = run.cost.evaluations;
  outcome.contacts = static_cast<long>(run.episodes.size());
  outcome.small_motion = run.small_motion;
  outcome.cut_short = run.cut_short;
  outcome.kind = Kind::answered;
  if (!(outcome.sentence = not_finite(run)).empty()) {
    outcome.kind = Kind::not_finite;
  } else if (!(outcome.sentence = unsound(rig, run)).empty()) {
    outcome.kind = Kind::unsound;
  } else if (warns_of(run, "energy does not balance") || warns_of(run, "the first contact ") ||
             (run.sensor && !run.sensor->peak_known) || warns_of(run, "displacements c")) {
    outcome.kind = Kind::warned;
  } else if (!(std::abs(outcome.imbalance) <= 10.0 * run.solver.accuracy + 1e-10)) {
    outcome.kind = Kind::energy;
    outcome.sentence = fmt::format("energy imbalance {:.2g}", outcome.imbalance);
  }
}

void judge_against(const models::Rig& rig, const models::Simulation& run,
                   const models::Simulation& fine, Outcome& outcome) {
  if (rig.has_stop())
    judge_contact(run, fine, outcome);
  else
    judge_swing(rig, run, fine, outcome);
}

}  // namespace impactrig::bench
