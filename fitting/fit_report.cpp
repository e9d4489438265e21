// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "datasets/number_text.hpp"
#include "fitting/all_cores.hpp"
#include "fitting/fit_diagnostics.hpp"
#include "fitting/metrics.hpp"
#include "models/mesh_error.hpp"

namespace impactrig::fitting {
namespace {

using datasets::ImpactFlag;
using datasets::ImpactSignal;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

// A shift by the mesh is worth a warning from this part of a standard error on.
constexpr double telling_shift = 0.5;
// Of standard uncertainties between a fitted value and what was stated of it: 1 fit in 16 000 by
// chance.
constexpr double far_from_stated = 4.0;
// Of standard deviations of that distance where all calibrations are right: 1 parameter in 370 by
// chance, and gains of two channels that differ go together.
constexpr double contradicted = 3.0;
// Part of a stated variance that the data must take off for a distance to mean anything.
constexpr double least_taken = 0.01;

/// Samples that count as independent.
double independent_samples(const FitProblem& problem) {
  double count = 0.0;
  for (const Shot& shot : problem.shots())
    for (const FittedChannel& channel : shot.channels)
      count += static_cast<double>(channel.used.size()) * channel.noise.independent_share();
  return count;
}

/// The place among the unknowns of variable number i, or of what it is tied to; none where nothing
/// tells it.
std::optional<std::size_t> unknown_of(const FitProblem& problem, const Variable& v, std::size_t i) {
  const auto found = std::ranges::find(problem.unknowns(), v.tie ? v.tie->to : i);
  if (found == problem.unknowns().end()) return std::nullopt;
  return static_cast<std::size_t>(found - problem.unknowns().begin());
}

/// Variables as lines of the unknowns: (n_variables, n_unknowns); a row of zeros where nothing
/// tells a variable.
Eigen::MatrixXd lines_of(const FitProblem& problem) {
  const std::vector<Variable>& variables = problem.variables();
  Eigen::MatrixXd lines =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(variables.size()),
                            static_cast<Eigen::Index>(problem.unknowns().size()));
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (const auto unknown = unknown_of(problem, variables[i], i))
      lines(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(*unknown)) =
          variables[i].tie ? variables[i].tie->factor : 1.0;
  return lines;
}

Eigen::MatrixXd correlations_of(const Eigen::MatrixXd& covariance, const Fit& fit) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols());
  for (Eigen::Index i = 0; i < covariance.rows(); ++i)
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      if (i == j) continue;
      const double size = std::sqrt(covariance(i, i) * covariance(j, j));
      const bool known = fit.parameters[static_cast<std::size_t>(i)].identifiable &&
                         fit.parameters[static_cast<std::size_t>(j)].identifiable;
      result(i, j) = !known ? not_known : size > 0.0 ? covariance(i, j) / size : 0.0;
    }
  return result;
}

/// Searched so, or in proportion to one that is.
bool by_logarithm(const FitProblem& problem, const Variable& v) {
  if (!v.tie) return v.by_logarithm;
  return v.tie->offset == 0.0 && problem.variables()[v.tie->to].by_logarithm;
}

/// 95 %, widened by the mesh's error and within bounds. That the size of the noise is hardly known
/// widens nothing beyond what was known before the shot.
std::array<double, 2> interval_of(const Variable& v, const Parameter& p, double quantile) {
  constexpr double normal = 1.959963985;
  const bool bounded = v.prior && p.std_error <= (*v.prior)[1];
  const double known = bounded ? normal * (*v.prior)[1] : INFINITY;
  const double half = std::min(quantile * p.std_error, known);
  std::array<double, 2> interval = {v.value - half, v.value + half};
  if (p.by_logarithm)
    interval = {v.value * std::exp(-half / v.value), v.value * std::exp(half / v.value)};
  interval = {interval[0] - p.mesh_error, interval[1] + p.mesh_error};
  if (!v.tie) interval = {std::max(interval[0], v.lower), std::min(interval[1], v.upper)};
  return interval;
}

bool at_bound(const Variable& v) {
  if (v.tie) return false;
  const double near = 1e-9 * v.scale;
  return v.value - v.lower <= near || v.upper - v.value <= near;
}

double first_touch(const FitProblem& problem, const Shot& shot) {
  for (const std::size_t i : shot.numbers)
    if (problem.variables()[i].role == Variable::Role::touch) return problem.value(i);
  return shot.impact->start;
}

ChannelFit channel_fit(const Shot& shot, const FittedChannel& channel, double touch) {
  const ImpactSignal& signal = *channel.signal;
  ChannelFit out;
  out.quantity = datasets::name(signal.quantity);
  out.channel = signal.channel;
  out.unit = datasets::si_unit(signal.quantity);
  if (channel.noise_known) out.noise = std::max(signal.noise, least_noise(signal));
  out.measured = signal.values;
  out.model = shot.cost->model_values(channel);
  out.every = channel.every;
  out.used.assign(signal.values.size(), 0);
  double squares = 0.0;
  for (const std::size_t k : channel.used) {
    out.used[k] = 1;
    squares += (out.measured[k] - out.model[k]) * (out.measured[k] - out.model[k]);
  }
  for (std::size_t k = 0; k < signal.values.size(); ++k) out.time.push_back(signal.time(k) - touch);
  out.residual_rms =
      std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, channel.used.size())));
  return out;
}

/// Of the samples that were fitted.
std::map<std::string, double> metrics_of(const ChannelFit& channel) {
  std::vector<double> measured, computed;
  std::size_t first = channel.used.size(), last = 0;
  for (std::size_t k = 0; k < channel.used.size(); ++k) {
    if (!channel.used[k]) continue;
    measured.push_back(channel.measured[k]);
    computed.push_back(channel.model[k]);
    first = std::min(first, k);
    last = k;
  }
  return metrics(measured, computed,
                 !measured.empty() && (last - first) / channel.every + 1 == measured.size());
}

/// How many independent samples the noise is known from, of the channel that has fewest over all
/// recordings; and which that is.
struct KnownNoise {
  double samples = std::numeric_limits<double>::infinity();
  std::string channel;
};

KnownNoise least_known_noise(const FitProblem& problem) {
  std::map<std::string, double> samples;
  for (const Shot& shot : problem.shots())
    for (const FittedChannel& channel : shot.channels)
      samples[channel.signal->channel] += channel.noise.freedom();
  KnownNoise least;
  for (const auto& [channel, count] : samples)
    if (count < least.samples) least = {count, channel};
  return least;
}

/// Of a 95 % interval, in standard errors: Student's, of what tells the size of the noise.
double half_width(const FitProblem& problem, const Goodness& goodness) {
  const double dof =
      std::min(static_cast<double>(goodness.dof), least_known_noise(problem).samples);
  return boost::math::quantile(boost::math::students_t(std::max(1.0, dof)), 0.975);
}

void warn_of_noise(const FitProblem& problem, Fit& fit) {
  constexpr double enough = 30.0;
  const KnownNoise least = least_known_noise(problem);
  if (!(least.samples < enough)) return;
  fit.warnings.push_back(fmt::format(
      "The noise of {} before touch tells as much as {} independent samples would: how large it is "
      "and how it hangs together is hardly known. The 95 % intervals of what no certificate bounds "
      "are {} times wider for that, profiles and bootstrap are not. Keep more of the record before "
      "touch (--pre-trigger), or "
      "record more.",
      least.channel, datasets::figures(least.samples, 2),
      datasets::figures(half_width(problem, fit.goodness) / 1.96, 3)));
}

/// Of a channel, the least square of residuals over noise that is no chance: one of a hundred
/// channels whose noise is known from so few samples exceeds it.
double least_misfit(const ChannelFit& channel, const NoiseModel& noise) {
  const auto used = static_cast<double>(std::ranges::count(channel.used, 1));
  if (used == 0.0 || !std::isfinite(noise.freedom())) return misfit;
  const boost::math::fisher_f ratio(used, noise.freedom());
  return std::max(misfit, boost::math::quantile(boost::math::complement(ratio, 0.01)));
}

void warn_of_residuals(const FitProblem& problem, double inflation, Fit& fit) {
  const bool robust = problem.loss() != Loss::squares;
  std::vector<const NoiseModel*> noise;
  for (const Shot& shot : problem.shots())
    for (const FittedChannel& channel : shot.channels) noise.push_back(&channel.noise);
  for (std::size_t k = 0; k < fit.channels.size(); ++k) {
    const ChannelFit& channel = fit.channels[k];
    const double ratio = channel.residual_rms / channel.noise;
    const double least = inflation > 1.0 ? misfit : least_misfit(channel, *noise[k]);
    if (!(channel.noise > 0.0 && ratio > std::sqrt(least))) continue;
    std::string then;
    if (inflation > 1.0)
      then = fmt::format(" Standard errors were multiplied by {}; they do not cover a wrong model.",
                         datasets::figures(inflation, 3));
    else if (robust)
      then = " Standard errors follow from the scatter that was seen.";
    const std::string of =
        problem.shots().size() < 2
            ? ""
            : fit.impacts[static_cast<std::size_t>(channel.recording)].recording + ": ";
    fit.warnings.push_back(fmt::format(
        "{}The residuals of {} are {} times its noise before the trigger: the model or the "
        "calibration does not explain all that was measured.{} Look at the residuals; try another "
        "law or a finer mesh, free a gain or delay, or shorten the fitted window.",
        of, channel.channel, datasets::figures(ratio, 3), then));
  }
}

/// Where a mesh that the rig file states is too coarse for the data to be explained.
std::string advice_on_stated_mesh(const FitEnd& end, double reduced, const RigFile& rig) {
  constexpr double seen = 0.3;  // of the residuals, a tenth of their square
  if (!(reduced > misfit && end.mesh_misfit > seen) || rig.mesh_chosen) return "";
  return fmt::format(
      " The residuals show it: what that mesh changes besides is {} times as large as they are, "
      "and the numbers may be further off than the intervals say. Leave {} out of the rig file: "
      "ANCF on a mesh that the data ask for is taken then.",
      datasets::figures(end.mesh_misfit, 2),
      rig.solver.model == models::BeamModel::ancf ? "solver.elements"
                                                  : "solver.model and solver.modes");
}

void warn_of_mesh(const FitEnd& end, double reduced, Fit& fit) {
  std::string shifts;
  for (const Parameter& p : fit.parameters)
    if (!p.nuisance && std::abs(p.mesh_shift) > telling_shift * p.std_error)
      shifts += fmt::format("{}{} by {:+.2g}{} ({} standard errors)", shifts.empty() ? "" : ", ",
                            p.name, p.mesh_shift, p.unit == "1" ? "" : " " + p.unit,
                            datasets::figures(std::abs(p.mesh_shift) / p.std_error, 2));
  if (shifts.empty()) return;
  const models::Solver finer = models::refined(fit.rig.solver);
  fit.warnings.push_back(fmt::format(
      "The mesh is coarser than the data are good: one twice as fine{} would move {}. The "
      "intervals were widened by that; with {} they would be narrower.{}",
      end.mesh_room < 1.0 ? ", as far as the residuals have room for it," : "", shifts,
      finer.model == models::BeamModel::ancf
          ? fmt::format("solver.elements = [{}, {}]", finer.elements[0], finer.elements[1])
          : fmt::format("solver.modes = {}", finer.modes),
      advice_on_stated_mesh(end, reduced, fit.rig)));
}

/// A zero of the velocity that the fit moved far: what the bar's speed at rest was, no data tell.
void warn_of_zero(Fit& fit) {
  constexpr double far = 0.1;    // of the approach speed
  constexpr double known = 4.0;  // standard errors
  for (const Parameter& p : fit.parameters) {
    const std::string_view name = "sensors.velocity.offset";
    if (!p.name.starts_with(name)) continue;
    const auto speed = std::ranges::find(
        fit.parameters, "start.velocity" + p.name.substr(name.size()), &Parameter::name);
    if (speed == fit.parameters.end() || !(std::abs(p.value) > far * std::abs(speed->value)) ||
        !(std::abs(p.value) > known * p.std_error))
      continue;
    fit.warnings.push_back(fmt::format(
        "{} ended at {:.3g} m/s, {} of the approach speed: the fit moved the laser's zero by that, "
        "and restitution and speed lean on it. Where the laser was right at rest the model is not: "
        "look at the residuals, and at what the laser shows of a bar that rests.",
        p.name, p.value, datasets::percent(std::abs(p.value / speed->value))));
  }
}

void warn_of_release(const FitProblem& problem, Fit& fit) {
  const auto of_release = [&](const Parameter& p) {
    return p.name.starts_with("contact.restitution") &&
           p.std_error < problem.release_vibration() * std::abs(p.value);
  };
  if (std::ranges::none_of(fit.parameters, of_release)) return;
  fit.warnings.push_back(fmt::format(
      "Letting a straight bar go leaves vibration of up to {} of its speed at touch in it, more "
      "than the standard error of the restitution coefficient: the fit takes the speed from the "
      "data and knows of no such vibration, since its phase depends on how the bar was held. What "
      "is fitted may err by as much; hold the bar as it hangs, or damp it.",
      datasets::percent(problem.release_vibration())));
}

/// A parameter that ended far from what is stated of it.
struct Contradiction {
  const Variable* of = nullptr;
  double away = 0.0;   ///< from the stated mean
  double usual = 0.0;  ///< standard deviation of that where all calibrations are right

  double uncertainty() const { return (*of->prior)[1]; }
};

/// Calibrations that the data or the other calibrations contradict: the fit goes between them, and
/// nothing else tells. Where all are right, a parameter ends as far from what is stated of it as
/// the variance says that the data took off the stated one.
std::vector<Contradiction> contradictions(const FitProblem& problem, const FitEnd& end) {
  std::vector<Contradiction> found;
  const Eigen::MatrixXd lines = lines_of(problem);
  for (const std::size_t i : problem.priors()) {
    const Variable& v = problem.variables()[i];
    if (v.role == Variable::Role::background) continue;
    const auto [mean, uncertainty] = *v.prior;
    const double away = v.value - mean;
    const Eigen::RowVectorXd line = lines.row(static_cast<Eigen::Index>(i));
    const double left = line.dot(end.spread.covariance * line.transpose());
    const double taken = uncertainty * uncertainty - left;
    const double usual = std::max(1.0, end.inflation) *
                         std::sqrt(std::max(taken, least_taken * uncertainty * uncertainty));
    if (std::abs(away) >= contradicted * usual || std::abs(away) >= far_from_stated * uncertainty)
      found.push_back({&v, away, usual});
  }
  return found;
}

/// "3.1", "184".
std::string multiple(double factor) {
  return factor < 10.0 ? fmt::format("{:.2g}", factor) : fmt::format("{:.0f}", factor);
}

std::string sentence(const Contradiction& c) {
  const double usually = std::abs(c.away) / c.usual;
  const std::string far =
      usually < contradicted ? std::string()
                             : fmt::format(", {} times as far as right calibrations usually let it",
                                           multiple(usually));
  return fmt::format(
      "{} ended {:.3g} standard uncertainties {} what is stated of it, {:g} +- {:g}{}{}: a wrong "
      "calibration (perhaps of another sensor), range or unit, or a model that needs it. Other "
      "parameters lean on it; check the sensors before any number is used.",
      c.of->name, std::abs(c.away) / c.uncertainty(), c.away > 0.0 ? "above" : "below",
      (*c.of->prior)[0], c.uncertainty(), c.of->unit == "1" ? "" : " " + c.of->unit, far);
}

/// Of two delays of one recording, of which one ended later than stated and the other earlier: what
/// the data tell is how far the two channels are apart.
std::string sentence_of_delays(const Contradiction& late, const Contradiction& early,
                               const std::string& recording) {
  const auto stated = [](const Contradiction& c) {
    return fmt::format("{:.4g} +- {:.2g} us", 1e6 * (*c.of->prior)[0], 1e6 * c.uncertainty());
  };
  const double apart = late.away - early.away;
  return fmt::format(
      "{}The {} shows the impact {:.3g} us later than the {} does, the stated delays ({} and {}) "
      "taken off, {} times their uncertainty: one of the two is later than stated (its filter, "
      "decoder or trigger), or earlier. Which one these data cannot tell, and the fit moved both, "
      "{} and {}. Where the delay is known, state it; what needs both channels (work, kinetic and "
      "energetic restitution, the direct estimates) rests on it.",
      recording.empty() ? "" : recording + ": ", datasets::name(late.of->quantity), 1e6 * apart,
      datasets::name(early.of->quantity), stated(late), stated(early),
      multiple(apart / std::hypot(late.uncertainty(), early.uncertainty())), late.of->name,
      early.of->name);
}

/// Delays that the data move apart are told together, as they are one fact.
void warn_of_priors(const FitProblem& problem, const FitEnd& end, Fit& fit) {
  const std::vector<Contradiction> found = contradictions(problem, end);
  const auto of_other_side = [&](const Contradiction& c) {
    return std::ranges::find_if(found, [&](const Contradiction& other) {
      return other.of->role == Variable::Role::delay && other.of->recording == c.of->recording &&
             other.away * c.away < 0.0;
    });
  };
  std::set<const Variable*> told;
  for (const Contradiction& c : found) {
    for (Parameter& parameter : fit.parameters)
      if (parameter.name == c.of->name) parameter.contradicts_prior = true;
    if (told.contains(c.of)) continue;
    const auto other = c.of->role == Variable::Role::delay ? of_other_side(c) : found.end();
    if (other == found.end()) {
      fit.warnings.push_back(sentence(c));
      continue;
    }
    told.insert({c.of, other->of});
    fit.warnings.push_back(sentence_of_delays(
        c.away > 0.0 ? c : *other, c.away > 0.0 ? *other : c,
        problem.shots().size() > 1 && c.of->recording >= 0
            ? problem.shots()[static_cast<std::size_t>(c.of->recording)].impact->recording
            : ""));
  }
}

/// Of kinematic, kinetic and energetic restitution of the first recording, by the unknowns.
Eigen::MatrixXd restitution_gradient(const FitProblem& problem) {
  const ShotCost& cost = *problem.shots().front().cost;
  const Eigen::MatrixXd by_block = cost.restitution_gradient();
  Eigen::MatrixXd gradient =
      Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(problem.unknowns().size()));
  for (std::size_t b = 0; b < cost.blocks().size(); ++b) {
    const auto place = std::ranges::find(problem.unknowns(), cost.blocks()[b]);
    gradient.col(place - problem.unknowns().begin()) = by_block.col(static_cast<Eigen::Index>(b));
  }
  return gradient;
}

/// Where the other one's bounds end it, its own ends too.
std::array<double, 2> tied_interval(const Variable::Line& tie, std::array<double, 2> of_other) {
  for (double& end : of_other) end = tie.factor * end + tie.offset;
  if (tie.factor < 0.0) std::swap(of_other[0], of_other[1]);
  return of_other;
}

bool of_later_contacts(ImpactFlag flag) {
  return flag == ImpactFlag::double_hit || flag == ImpactFlag::multiple_hits;
}

/// Of the impacts; later contacts only where the fit goes through them and does not explain what
/// it shows. Of three and more contacts one sentence is enough.
void warn_of_flags(const FitProblem& problem, bool later_misfit, Fit& fit) {
  for (const Shot& shot : problem.shots())
    for (const ImpactFlag flag : shot.impact->flags) {
      if (of_later_contacts(flag) && !later_misfit) continue;
      if (flag == ImpactFlag::double_hit && shot.impact->has(ImpactFlag::multiple_hits)) continue;
      fit.warnings.push_back(
          fmt::format("{}: {}", shot.impact->recording, datasets::sentence(flag)));
    }
}

bool fits_later_contacts(const Fit& fit) {
  return std::ranges::any_of(fit.predictions, [&](const models::Simulation& prediction) {
    return prediction.episodes.size() > 1 && prediction.episodes[1].start < fit.window;
  });
}

}  // namespace

double report_goodness(const FitProblem& problem, const Uncertainty& spread, Goodness& goodness) {
  const double count = independent_samples(problem);
  goodness.unknowns =
      static_cast<int>(problem.unknowns().size()) - static_cast<int>(spread.undetermined.cols());
  const double unknowns = goodness.unknowns;
  const double dof = std::max(1.0, count + static_cast<double>(problem.priors().size()) - unknowns);
  goodness.dof = std::lround(dof);
  if (problem.loss() != Loss::squares) {  // which alone has a likelihood
    goodness.aicc = goodness.bic = not_known;
    return goodness.chi2 / dof;
  }
  goodness.aicc = goodness.chi2 + 2.0 * unknowns +
                  2.0 * unknowns * (unknowns + 1.0) / std::max(1.0, count - unknowns - 1.0);
  goodness.bic = goodness.chi2 + unknowns * std::log(count);
  return goodness.chi2 / dof;
}

void report_parameters(const FitProblem& problem, const FitEnd& end, Fit& fit) {
  const double quantile = half_width(problem, fit.goodness);
  const Eigen::MatrixXd lines = lines_of(problem);
  const Eigen::MatrixXd covariance = lines * end.spread.covariance * lines.transpose();
  for (std::size_t i = 0; i < problem.variables().size(); ++i) {
    const Variable& v = problem.variables()[i];
    const auto row = static_cast<Eigen::Index>(i);
    Parameter p;
    p.name = v.name;
    p.unit = v.unit;
    p.value = v.value;
    p.by_logarithm = by_logarithm(problem, v);
    const std::optional<std::size_t> unknown = unknown_of(problem, v, i);
    p.identifiable = unknown && end.spread.identifiable[*unknown];
    if (p.identifiable) {
      p.std_error = end.inflation * std::sqrt(covariance(row, row));
      if (end.mesh_shift.size() > 0) p.mesh_shift = lines.row(row).dot(end.mesh_shift);
      p.mesh_error = end.beyond_finer * std::abs(p.mesh_shift);
      p.ci95 = interval_of(v, p, quantile);
      if (!end.mesh_known) p.mesh_shift = p.mesh_error = not_known;
    } else {
      p.std_error = p.mesh_shift = p.mesh_error = not_known;
      p.ci95 = {not_known, not_known};
    }
    p.initial = v.initial;
    p.lower = v.lower;
    p.upper = v.upper;
    p.at_bound = p.identifiable && at_bound(v);
    p.nuisance = v.role != Variable::Role::physics;
    p.prior = v.prior;
    if (v.tie) p.tied_to = problem.variables()[v.tie->to].name;
    fit.parameters.push_back(std::move(p));
  }
  for (std::size_t i = 0; i < problem.variables().size(); ++i)
    if (const auto& tie = problem.variables()[i].tie)
      fit.parameters[i].ci95 = tied_interval(*tie, fit.parameters[tie->to].ci95);
  fit.correlations = correlations_of(covariance, fit);
  fit.not_identifiable = end.spread.sentences;
}

void report_channels(const FitProblem& problem, Fit& fit) {
  int recording = 0;
  for (const Shot& shot : problem.shots()) {
    for (const FittedChannel& channel : shot.channels) {
      fit.channels.push_back(channel_fit(shot, channel, first_touch(problem, shot)));
      fit.channels.back().recording = recording;
    }
    ++recording;
  }
}

void report_more(const FitProblem& problem, Fit& fit) {
  fit.direct.resize(fit.impacts.size());
  const std::size_t channels = fit.channels.size();
  run_on_all_cores(fit.direct.size() + 2 * channels, [&](std::size_t i, std::size_t) {
    if (i < fit.direct.size()) {
      fit.direct[i] = direct_restitution(fit.impacts[i], problem.rig());
      return;
    }
    i -= fit.direct.size();
    ChannelFit& channel = fit.channels[i % channels];
    if (i < channels)
      channel.diagnostics = diagnostics_of(fit, channel);
    else
      channel.metrics = metrics_of(channel);
  });
}

void report_restitution(const FitProblem& problem, const FitEnd& end, Fit& fit) {
  const Eigen::MatrixXd gradient = restitution_gradient(problem);
  Eigen::VectorXd sizes(gradient.cols());
  for (Eigen::Index i = 0; i < sizes.size(); ++i)
    sizes[i] = problem.variables()[problem.unknowns()[static_cast<std::size_t>(i)]].scale;
  const double quantile = half_width(problem, fit.goodness);
  const models::Restitution& r = fit.predictions.front().restitution;
  const models::Restitution& finer = end.mesh_change;
  const double changes[] = {finer.kinematic, finer.kinetic, finer.energetic};
  const double values[] = {r.kinematic, r.kinetic, r.energetic};
  const char* names[] = {"kinematic", "kinetic", "energetic"};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double variance =
        gradient.row(k).dot(end.spread.covariance * gradient.row(k).transpose());
    double half = problem.rig().solver.accuracy * std::abs(values[k]) +
                  quantile * end.inflation * std::sqrt(std::max(0.0, variance));
    if (end.mesh_shift.size() > 0)
      half += end.beyond_finer * std::abs(changes[k] + gradient.row(k).dot(end.mesh_shift));
    if (!determines(end.spread, gradient.row(k), sizes, values[k])) half = not_known;
    fit.restitution[names[k]] = {values[k], {values[k] - half, values[k] + half}};
  }
  const auto fitted = [&](std::string_view name) {
    return std::ranges::any_of(
        fit.parameters, [&](const Parameter& p) { return parameter_key(p.name).key == name; });
  };
  if (!problem.rig().rig.contact.takes_restitution() || fitted("contact.viscous") ||
      fitted("contact.relaxation_time"))
    return;  // the law has none
  const double stated = problem.rig().rig.contact.restitution;
  Estimate law{stated, {stated, stated}};
  for (const Parameter& p : fit.parameters)
    if (p.name == "contact.restitution" || p.name == "contact.restitution[1]")
      law = {p.value, p.ci95};
  fit.restitution["law"] = law;
}

RigFile fitted_rig(const FitProblem& problem) {
  RigFile rig = problem.rig();
  for (const Variable& v : problem.variables()) {
    if (v.recording > 0) continue;
    if (v.physics) v.physics->of(rig.rig) = v.value;
    if (!v.chain) continue;
    auto& sensor = v.quantity == datasets::Quantity::force      ? rig.force
                   : v.quantity == datasets::Quantity::velocity ? rig.velocity
                                                                : rig.displacement;
    if (sensor) v.chain->of(*sensor) = v.value;
  }
  return rig;
}

void report_warnings(const FitProblem& problem, const FitEnd& end, Fit& fit) {
  const double reduced = fit.goodness.chi2 / static_cast<double>(std::max(1L, fit.goodness.dof));
  // what is wrong with the record first: what follows may follow from it
  const std::vector<std::string> so_far = std::exchange(fit.warnings, {});
  warn_of_flags(problem, fits_later_contacts(fit) && reduced > misfit, fit);
  warn_of_residuals(problem, end.inflation, fit);
  warn_of_priors(problem, end, fit);
  fit.warnings.insert(fit.warnings.end(), so_far.begin(), so_far.end());
  warn_of_zero(fit);
  warn_of_noise(problem, fit);
  warn_of_release(problem, fit);
  warn_of_mesh(end, reduced, fit);
  const RigFile& rig = problem.rig();
  if (!rig.force && !rig.velocity && !rig.displacement)
    fit.warnings.push_back(
        "The rig file describes no sensors: channels were taken as perfect, without delay. Add "
        "[sensors.force] and [sensors.velocity].");
  for (const models::Simulation& prediction : fit.predictions)
    for (const std::string& warning : prediction.warnings)
      if (std::ranges::find(fit.warnings, warning) == fit.warnings.end())
        fit.warnings.push_back(warning);
}

}  // namespace impactrig::fitting
