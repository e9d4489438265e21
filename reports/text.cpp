// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "models/mesh_error.hpp"
#include "reports/diagnosis.hpp"
#include "reports/direct_wording.hpp"
#include "reports/wording.hpp"

namespace impactrig::reports {
namespace {

/// A value to the digit that two digits of its error leave; nine digits without an error.
std::string to_error(double value, double error) {
  if (!(error > 0.0 && std::isfinite(error))) return fmt::format("{:.9g}", value);
  const int last = static_cast<int>(std::floor(std::log10(error))) - 1;
  const int first = value != 0.0 ? static_cast<int>(std::floor(std::log10(std::abs(value)))) : last;
  return fmt::format("{:.{}g}", value, std::clamp(first - last + 1, 1, 15));
}

std::string parameter_line(const fitting::Parameter& p) {
  const std::string unit = p.unit == "1" ? "" : " " + p.unit;
  std::string line = fmt::format("  {:<31} {:>10}", p.name, to_error(p.value, p.std_error));
  if (!p.identifiable)
    line += "   not identifiable";
  else if (p.std_error > 0.0)
    line += fmt::format(" ± {:<9.2g} 95 %: {} to {}{}", p.std_error,
                        to_error(p.ci95[0], p.std_error), to_error(p.ci95[1], p.std_error), unit);
  if (p.at_bound) line += "   at its bound";
  if (!p.nuisance) line += fmt::format("   (started at {:.4g})", p.initial);
  if (!p.tied_to.empty()) line += fmt::format("   (tied to {})", p.tied_to);
  if (p.prior) line += fmt::format("   (prior: {:.4g} ± {:.2g})", (*p.prior)[0], (*p.prior)[1]);
  return line + "\n";
}

std::string estimate_line(const char* label, const fitting::Fit& fit, const char* name,
                          const char* meaning) {
  const auto found = fit.restitution.find(name);
  if (found == fit.restitution.end()) return "";
  const auto& [value, ci] = found->second;
  if (!std::isfinite(value))
    return fmt::format("  {:<10} {:>9}   not simulated: the run ends in contact   {}\n", label, "-",
                       meaning);
  if (!std::isfinite(ci[0]) || !std::isfinite(ci[1]))
    return fmt::format("  {:<10} {:>9}   not identifiable   {}\n", label, to_error(value, 0.0),
                       meaning);
  const double error = (ci[1] - ci[0]) / 4.0;
  return fmt::format("  {:<10} {:>9}   {} to {}   {}\n", label, to_error(value, error),
                     to_error(ci[0], error), to_error(ci[1], error), meaning);
}

/// Intervals of other kinds than the covariance's.
std::string intervals_text(const fitting::Fit& fit) {
  std::string text;
  const auto error_of = [&](const std::string& name) {
    for (const fitting::Parameter& p : fit.parameters)
      if (p.name == name) return p.std_error;
    return 0.0;
  };
  if (!fit.profiles.empty()) text += "\n95 % by profile likelihood\n";
  for (const fitting::Profile& p : fit.profiles) {
    const auto limit = [&](const std::optional<double>& value) {
      return value ? to_error(*value, error_of(p.name)) : std::string("no limit");
    };
    text += fmt::format("  {:<31} {} to {}{}\n", p.name, limit(p.lower), limit(p.upper),
                        p.unit == "1" ? "" : " " + p.unit);
  }
  if (!fit.bootstrap) return text;
  text +=
      fmt::format("\n95 % by bootstrap ({}, {} refits, {:.2f} s)\n",
                  fitting::name(fit.bootstrap->kind), fit.bootstrap->draws, fit.bootstrap->seconds);
  for (const fitting::Bootstrap::Parameter& p : fit.bootstrap->parameters) {
    if (!std::isfinite(p.std_error)) {
      text += fmt::format("  {:<31} not identifiable\n", p.name);
      continue;
    }
    text +=
        fmt::format("  {:<31} {}   (standard error {:.2g}, bias {:.2g} of it)\n", p.name,
                    has_interval(p.ci95) ? fmt::format("{} to {}", to_error(p.ci95[0], p.std_error),
                                                       to_error(p.ci95[1], p.std_error))
                                         : std::string("–"),
                    p.std_error, p.bias / p.std_error);
  }
  return text;
}

/// What a record shows without a model, beside the fit.
std::string direct_text(const fitting::Fit& fit) {
  std::string text;
  for (std::size_t r = 0; r < fit.direct.size(); ++r) {
    text += fit.direct.size() > 1
                ? fmt::format("\nRead directly from {}, without a model\n",
                              r < fit.impacts.size() ? fit.impacts[r].recording : "")
                : "\nRead directly from the record, without a model\n";
    for (const DirectPair& pair : direct_pairs(fit, r)) {
      const fitting::DirectEstimate& e = pair.direct;
      if (!e.given()) continue;
      const fitting::Contribution* const source = pair.main_source();
      text += fmt::format("  {:<31} {:>10} ± {:<9.2g} 95 %: {} to {}{}{}\n", pair.name,
                          to_error(e.value, e.std_error), e.std_error,
                          to_error(e.ci95[0], e.std_error), to_error(e.ci95[1], e.std_error),
                          pair.unit == std::string("1") ? "" : fmt::format(" {}", pair.unit),
                          source == nullptr ? "" : fmt::format("   (mostly {})", source->source));
    }
    text += fmt::format("  {}\n", direct_explanation(fit, r));
  }
  return text;
}

std::string models_text(const fitting::ModelComparison& models) {
  std::size_t width = 42;
  for (const fitting::ModelScore& s : models.scores) width = std::max(width, s.label.size());
  std::string text = fmt::format("\n{:<{}} {:>9} {:>10} {:>10} {:>9}\n", "Models, best first",
                                 width + 2, "chi2/dof", "delta", "weight", "held out");
  for (const fitting::ModelScore& s : models.scores) {
    const std::string note = s.note.empty() ? "" : fmt::format("    {}\n", s.note);
    if (!s.failure.empty()) {
      text += fmt::format("  {:<{}} could not be fitted: {}\n{}", s.label, width, s.failure, note);
      continue;
    }
    const auto ratio = [](double chi2, long dof) {
      return chi2 / static_cast<double>(std::max(1L, dof));
    };
    text += fmt::format("  {:<{}} {:>9.4g} {:>10.4g} {:>10.2g} {:>9}\n{}", s.label, width,
                        ratio(s.chi2, s.dof), s.delta, s.weight,
                        s.held_out ? fmt::format("{:.4g}", ratio(s.held_out->chi2, s.held_out->dof))
                                   : std::string("-"),
                        note);
  }
  return text + "  " + models.sentence + "\n";
}

std::string warnings_text(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += fmt::format("\nwarning: {}\n", warning);
  return text;
}

/// "shot05.csv: " before what is of a channel of one of several recordings.
std::string whose(const fitting::Fit& fit, const fitting::ChannelFit& channel) {
  if (fit.impacts.size() < 2) return "";
  return recording_name(fit, static_cast<std::size_t>(std::max(0, channel.recording))) + ": ";
}

/// What a channel's diagnostics say; of a sound one nothing but that.
std::string diagnosis_text(const fitting::Fit& fit, const fitting::ChannelFit& channel) {
  if (!channel.diagnostics) return "";
  std::string text = fmt::format("  {}{}\n", whose(fit, channel), channel.diagnostics->sentence);
  if (channel.diagnostics->discrepancy.significant)
    text += fmt::format("  {}{}\n", whose(fit, channel), discrepancy_sentence(channel));
  return text;
}

/// Peak and contact are those of a force; a displacement alone shows when it is back.
std::string impact_text(const datasets::Impact& impact) {
  return fmt::format("  {}: first touch at {:.6g} s, {}{} {:.4g} us\n", impact.recording,
                     impact.start, impact.force ? fmt::format("peak {:.5g} N, ", impact.peak) : "",
                     impact.rebound ? "back there after" : "contact",
                     1e6 * (impact.end - impact.start));
}

}  // namespace

std::string to_text(const ReportData& data) {
  const fitting::Fit& fit = data.fit;
  std::string text = fmt::format("{}\n", data.title);
  for (const datasets::Impact& impact : fit.impacts) text += impact_text(impact);
  const std::string loss =
      fit.loss == fitting::Loss::squares ? "" : fmt::format("loss {}, ", fitting::name(fit.loss));
  text += fmt::format("\nFitted parameters ({}, {}{} iterations, {} simulations, {:.2g} s)\n",
                      fit.termination, loss, fit.iterations, fit.simulations, fit.seconds);
  for (const bool nuisance : {false, true})
    for (const fitting::Parameter& p : fit.parameters)
      if (p.nuisance == nuisance) text += parameter_line(p);
  for (const std::string& sentence : fit.not_identifiable)
    text += fmt::format("  ! {}\n", sentence);
  text += intervals_text(fit);
  text += fmt::format("\nRestitution{}: four different numbers for a flexible bar\n",
                      fit.impacts.size() < 2 ? "" : " of " + recording_name(fit, 0));
  if (fit.rig.rig.contact.takes_restitution())
    text += estimate_line("law", fit, "law", "in the damping law");
  else
    text += fmt::format("  {:<10} {:>9}   not used by this law\n", "law", "-");
  text += estimate_line("kinematic", fit, "kinematic",
                        "separation over approach speed of the struck point");
  text += estimate_line("kinetic", fit, "kinetic", "impulse after over before deepest penetration");
  text += estimate_line("energetic", fit, "energetic",
                        "root of work returned over work taken by the contact");
  text += direct_text(fit);
  text += "\nResiduals\n";
  for (const fitting::ChannelFit& channel : fit.channels)
    text += fmt::format(
        "  {}{:<14}{:.3g} {} (noise before the trigger {:.3g} {}{})\n", whose(fit, channel),
        channel.quantity, channel.residual_rms, channel.unit, channel.noise, channel.unit,
        channel.every > 1 ? fmt::format("; one sample in {} fitted", channel.every) : "");
  text += fmt::format("  chi-square / degrees of freedom: {:.4g} / {}\n", fit.goodness.chi2,
                      fit.goodness.dof);
  for (const fitting::ChannelFit& channel : fit.channels) text += diagnosis_text(fit, channel);
  if (data.models) text += models_text(*data.models);
  text += warnings_text(fit.warnings);
  if (fit.termination != "converged")
    text += fmt::format(
        "\nwarning: The fit did not converge: {}. Values and intervals are provisional. Start "
        "nearer to the answer (--set), or free fewer parameters (--free).\n",
        fit.termination);
  return text;
}

namespace {

std::string mesh_error_text(const models::MeshError& error,
                            const std::vector<models::Episode>& episodes) {
  const models::Solver& finer = error.finer;
  const std::string mesh =
      finer.model == models::BeamModel::ancf
          ? fmt::format("{} + {} elements", finer.elements[0], finer.elements[1])
          : fmt::format("{} modes", finer.modes);
  const auto told = [](double part) {
    return std::isfinite(part) ? fmt::format("{:+.2g} %", 100.0 * part) : std::string("unknown");
  };
  std::string text = fmt::format("mesh error        {} peak force, {} duration, {} impulse",
                                 told(error.peak_force), told(error.duration), told(error.impulse));
  if (error.sensor_peak_force)
    text += fmt::format(", {} sensor's largest force", told(*error.sensor_peak_force));
  if (error.sensor_until) text += fmt::format(" up to {:.4g} s", *error.sensor_until);
  const std::size_t contact = models::compared_contact(episodes) + 1;
  return text + fmt::format(", of contact {}, by {}\n", contact, mesh);
}

/// A number, or what stands for one that is not known.
std::string digits(double number, int count) {
  return std::isfinite(number) ? fmt::format("{:.{}g}", number, count) : std::string("-");
}

/// What happened at the stop.
std::string contact_text(const models::Simulation& s, const models::Contact& laws) {
  std::string text = fmt::format(
      "contact           {}, damping {}{}\n"
      "peak force        {:.9g} N at {:.6g} us\ndeepest           {:.6g} um\nimpulse           "
      "{:.9g} N s over {:.6g} ms\n",
      laws.law == "goldsmith" ? fmt::format("goldsmith (exponent {})", laws.exponent) : laws.law,
      laws.damping, laws.takes_restitution() ? fmt::format(", e = {:g}", laws.restitution) : "",
      s.peak_force, 1e6 * s.peak_time, 1e6 * s.max_penetration, s.impulse, 1e3 * s.duration);
  if (s.sensor)
    text += fmt::format("sensor            {:.9g} N at {:.6g} us, {:.9g} N s over the run\n",
                        s.sensor->peak_force, 1e6 * s.sensor->peak_time, s.sensor->impulse);
  text += fmt::format("\n  {:>12} {:>12} {:>12} {:>12} {:>12} {:>12}{}\n", "touch [us]",
                      "leaves [us]", "peak [N]", "impulse [Ns]", "in [m/s]", "out [m/s]",
                      s.stops.empty() ? "" : " stop");
  for (const models::Episode& e : s.episodes)
    text += fmt::format("  {:>12.6g} {:>12} {:>12.6g} {:>12.6g} {:>12.6g} {:>12}{}\n",
                        1e6 * e.start, e.open ? "-" : digits(1e6 * e.end, 6), e.peak_force,
                        e.impulse, e.approach_velocity, digits(e.separation_velocity, 6),
                        s.stops.empty() ? "" : fmt::format(" {:>4}", e.stop));
  text +=
      fmt::format("\nrestitution       law {}, kinematic {}, kinetic {}, energetic {}\n",
                  laws.takes_restitution() ? digits(s.restitution.law, 5) : "not used by this law",
                  digits(s.restitution.kinematic, 5), digits(s.restitution.kinetic, 5),
                  digits(s.restitution.energetic, 5));
  return text;
}

}  // namespace

std::string to_text(const models::Simulation& s, const models::Rig& rig) {
  std::string model(models::name(s.solver.model));
  if (s.solver.model == models::BeamModel::ancf)
    model += fmt::format(", {} + {} elements", s.solver.elements[0], s.solver.elements[1]);
  if (s.solver.model == models::BeamModel::hybrid)
    model += fmt::format(", {} {} modes, {} axial", s.solver.modes, models::name(s.solver.basis),
                         s.solver.axial_modes);
  std::string text = fmt::format("model             {}\n", model);
  text += rig.has_stop() ? contact_text(s, rig.contact)
                         : fmt::format("free swing        {:.6g} s\n", s.duration);
  const models::EnergyAudit& energy = s.energy;
  const double in_play = energy.kinetic + std::abs(energy.elastic - energy.elastic_at_start) +
                         energy.dissipated + energy.damped;
  const bool set_free =
      in_play > 2.0 * energy.initial;  // by weight or spring, as after a slow touch
  const double whole = set_free ? in_play : energy.initial;
  const auto percent = [whole](double joules) {
    const double part = 100.0 * joules / whole;
    return std::abs(part) < 0.005 ? 0.0 : part;  // no "-0.00"
  };
  text += fmt::format(
      "energy            {}{:.5g} J: {:.2f} % lost in the contact, {}{:.2f} % in vibration, "
      "{}{:.2f} % in rotation; imbalance {:.1e}\n",
      set_free ? fmt::format("{:.3g} J at touch, in play ", energy.initial) : "", whole,
      100.0 * energy.dissipated / whole,
      energy.damped > 0.0
          ? fmt::format("{:.2f} % damped in bar, hinge and stop, ", 100.0 * energy.damped / whole)
          : "",
      percent(energy.vibration),
      energy.stop != 0.0 ? fmt::format("{:.2f} % in the stop, ", percent(energy.stop)) : "",
      100.0 * energy.rigid_rotation / whole, energy.unbalanced());
  if (s.energy.driven != 0.0)
    text += fmt::format("driven            {:.6g} J by what turns the hinge\n", s.energy.driven);
  text += fmt::format("cost              {} steps, {} rejected, {} evaluations, {:.3g} ms\n",
                      s.cost.steps, s.cost.rejected, s.cost.evaluations, 1e3 * s.cost.seconds);
  if (s.mesh_error) text += mesh_error_text(*s.mesh_error, s.episodes);
  text += fmt::format("ended             {}\n", s.termination);
  return text + warnings_text(s.warnings);
}

}  // namespace impactrig::reports
