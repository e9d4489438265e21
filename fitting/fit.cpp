// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit.hpp"

#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "fitting/covariance.hpp"
#include "fitting/metrics.hpp"
#include "fitting/shot_cost.hpp"
#include "fitting/shot_model.hpp"
#include "fitting/solver_options.hpp"
#include "fitting/variables.hpp"
#include "models/contact/damping_law.hpp"
#include "models/mesh_error.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::ImpactSignal;

// The first pass looks no further than this many contact durations: what follows the first
// separation depends so strongly on the parameters that a fit from afar would run into a false
// minimum.
constexpr double first_window = 1.2;
// A first pass that ends with more than this reduced chi-square is started again from other places.
constexpr double poor_fit = 4.0;
// A reduced chi-square above this is no chance: the noise itself is known to a tenth from the few
// hundred samples before a trigger.
constexpr double misfit = 1.25;
// Small motion predicts the fit where it leaves out less than this part of the energy, and to the
// end where the full equations would move no parameter by more than this part of its standard
// error.
constexpr double smallest_motion = 1e-3;
constexpr double harmless_shift = 0.1;
// A shift by the mesh is worth a warning from this part of a standard error on.
constexpr double telling_shift = 0.5;
// The error of a mesh against the change to one twice as fine: errors fall about tenfold.
constexpr double beyond_finer = 1.1;
constexpr double unseen_noise = 1e-3;  // of the peak, where the record shows no noise at all

/// Passes of the search. The first looks at the first contact and leaves mains hum at zero, which
/// so short a window cannot tell from the rest; the last takes every sample and iterates to the
/// end.
enum class Stage { first, last };

/// One recording with what was chosen for it.
struct Shot {
  const Impact* impact = nullptr;
  double window = 0.0;   ///< fitted after first touch [s]
  double contact = 0.0;  ///< duration of the first contact as seen [s]
  std::vector<FittedChannel> channels;
  std::vector<std::size_t> variables;  ///< indices into Session::variables_
  std::unique_ptr<ShotModel> model;
};

class Session {
 public:
  Session(const std::vector<Impact>& impacts, const RigFile& rig, const FitOptions& options);
  Fit run();

 private:
  void add_shot(const Impact& impact, int number);
  FittedChannel weigh(const Impact& impact, const ImpactSignal& signal);
  void choose_samples(double window_share);
  double solve(Stage stage);
  void restart_elsewhere(double reduced);
  void choose_motion();
  void set_motion(models::Motion motion);
  template <typename Change>
  Eigen::VectorXd shift_by(const Change& change, const Eigen::MatrixXd& jacobian,
                           const Uncertainty& spread) const;
  double shift_by_full_motion(const Eigen::MatrixXd& jacobian, const Uncertainty& spread) const;
  void estimate_mesh_shift(const Eigen::MatrixXd& jacobian, const Uncertainty& spread);
  double chi2(Eigen::MatrixXd* jacobian) const;
  double samples() const;
  std::unique_ptr<ShotCost> cost_of(const Shot& shot) const;
  std::vector<double> values_of(const Shot& shot) const;
  void report_parameters(const Uncertainty& spread, double inflation, Fit& fit) const;
  double report_goodness(double priors, Goodness& goodness) const;
  void report_predictions(Fit& fit);
  void report_channels(Fit& fit);
  void report_restitution(const Uncertainty& spread, double inflation, Fit& fit);
  void warn(Fit& fit, double reduced) const;

  const std::vector<Impact>& impacts_;
  const FitOptions& options_;
  RigFile rig_;
  std::vector<Variable> variables_;
  std::vector<Shot> shots_;
  std::vector<std::string> warnings_;
  std::string termination_;
  Eigen::VectorXd mesh_shift_;  // of the variables; empty where the mesh has no error to estimate
  std::string skipped_;         // what the predictions leave out, and what that does to the fit
  bool noise_known_ = true;
  int iterations_ = 0;
  mutable long simulations_ = 0;
};

Session::Session(const std::vector<Impact>& impacts, const RigFile& rig, const FitOptions& options)
    : impacts_(impacts),
      options_(options),
      rig_(rig) {
  if (impacts.empty()) throw std::invalid_argument("there is no impact to fit to");
  if (rig_.rig.start.release_angle) {
    rig_.rig.start.velocity = models::touch_velocity(rig_.rig);
    rig_.rig.start.release_angle.reset();
  }
  variables_ = make_variables(impacts, rig_, options);
  for (std::size_t i = 0; i < impacts.size(); ++i) add_shot(impacts[i], static_cast<int>(i));
}

FittedChannel Session::weigh(const Impact& impact, const ImpactSignal& signal) {
  FittedChannel channel;
  channel.signal = &signal;
  channel.sigma = signal.noise;
  channel.correlation = std::max(1.0, signal.noise_correlation);
  channel.sigma = std::max(channel.sigma, signal.quantum / std::sqrt(12.0));
  double largest = 0.0;
  for (const double value : signal.values)
    largest = std::max(largest, std::isfinite(value) ? std::abs(value) : 0.0);
  if (!(channel.sigma > 1e-9 * largest)) {
    channel.sigma = unseen_noise * (largest > 0.0 ? largest : 1.0);
    channel.correlation = 1.0;
    channel.noise_known = noise_known_ = false;
    warnings_.push_back(
        fmt::format("{} shows no noise before the trigger in {}; it was weighed with {:g} % of its "
                    "peak and all "
                    "intervals follow from the scatter of the residuals instead.",
                    signal.channel, impact.recording, 100.0 * unseen_noise));
  }
  return channel;
}

void Session::add_shot(const Impact& impact, int number) {
  Shot shot;
  shot.impact = &impact;
  shot.contact = impact.end - impact.start;
  double last = -std::numeric_limits<double>::infinity();
  double first = std::numeric_limits<double>::infinity();
  double finest = std::numeric_limits<double>::infinity();
  for (const auto* candidate : {&impact.force, &impact.velocity, &impact.displacement}) {
    if (!*candidate || (*candidate)->values.empty()) continue;
    const ImpactSignal& signal = **candidate;
    const auto [least, most] = std::ranges::minmax(signal.values);
    if (least == most)
      warnings_.push_back(
          fmt::format("{} of {} is constant and was left out; is the sensor connected?",
                      signal.channel, impact.recording));
    if (!is_fitted(impact, *candidate, options_)) continue;
    if (impact.start - signal.start < 20.0 * signal.interval)
      warnings_.push_back(
          fmt::format("{} of {} has fewer than 20 samples before first touch: its noise and "
                      "baseline are hardly "
                      "known. Record a longer pre-trigger.",
                      signal.channel, impact.recording));
    shot.channels.push_back(weigh(impact, signal));
    first = std::min(first, signal.start);
    last = std::max(last, signal.time(signal.values.size() - 1));
    finest = std::min(finest, signal.interval);
  }
  if (shot.channels.empty())
    throw std::invalid_argument(
        fmt::format("{} has no force, velocity or displacement to fit to", impact.recording));
  shot.window = last - impact.start;
  if (options_.window > 0.0) shot.window = std::min(shot.window, options_.window);
  if (rig_.solver.duration) shot.window = std::min(shot.window, *rig_.solver.duration);
  if (!(shot.window > 0.0))
    throw std::invalid_argument(
        fmt::format("{} ends at first touch; there is nothing to fit to", impact.recording));
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const Variable& v = variables_[i];
    const bool fitted = v.quantity == datasets::Quantity::unknown ||
                        std::ranges::any_of(shot.channels, [&](const FittedChannel& c) {
                          return c.signal->quantity == v.quantity;
                        });
    if (v.concerns(number) && fitted) shot.variables.push_back(i);
  }
  const double slack = std::max(20e-6, 0.1 * shot.contact);  // first touch moves during the fit
  shot.model = std::make_unique<ShotModel>(rig_, impact, impact.start - first + slack,
                                           shot.window + slack, finest);
  shots_.push_back(std::move(shot));
}

/// Takes the sound samples from the record's beginning to a share of each shot's window.
void Session::choose_samples(double window_share) {
  for (Shot& shot : shots_) {
    const double window = std::min(shot.window, window_share * shot.contact);
    shot.model->set_end(window + std::max(20e-6, 0.1 * shot.contact));
    for (FittedChannel& channel : shot.channels) {
      const ImpactSignal& signal = *channel.signal;
      double ceiling = std::numeric_limits<double>::infinity();
      if (shot.impact->has(ImpactFlag::clipped) && signal.valid.empty() &&
          signal.quantity == datasets::Quantity::force)
        ceiling = 0.999 * *std::ranges::max_element(signal.values);
      channel.used.clear();
      for (std::size_t k = 0; k < signal.values.size(); ++k) {
        const bool sound = (signal.valid.empty() || signal.valid[k]) &&
                           std::isfinite(signal.values[k]) && signal.values[k] < ceiling;
        if (sound && signal.time(k) <= shot.impact->start + window) channel.used.push_back(k);
      }
    }
  }
}

std::unique_ptr<ShotCost> Session::cost_of(const Shot& shot) const {
  std::vector<const Variable*> variables;
  for (const std::size_t i : shot.variables) variables.push_back(&variables_[i]);
  return std::make_unique<ShotCost>(rig_, *shot.model, shot.channels, std::move(variables));
}

std::vector<double> Session::values_of(const Shot& shot) const {
  std::vector<double> values;
  for (const std::size_t i : shot.variables) values.push_back(variables_[i].value);
  return values;
}

double Session::samples() const {
  double count = 0.0;
  for (const Shot& shot : shots_)
    for (const FittedChannel& channel : shot.channels)
      count += static_cast<double>(channel.used.size()) / channel.correlation;
  return count;
}

/// Levenberg-Marquardt from the variables' present values; returns the reduced chi-square reached.
double Session::solve(Stage stage) {
  std::vector<double> x(variables_.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = variables_[i].value / variables_[i].scale;
  std::vector<std::unique_ptr<ShotCost>> costs;
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  std::vector<std::unique_ptr<ceres::NormalPrior>> priors;
  for (const Shot& shot : shots_) {
    std::vector<double*> blocks;
    for (const std::size_t i : shot.variables) blocks.push_back(&x[i]);
    costs.push_back(cost_of(shot));
    problem.AddResidualBlock(costs.back().get(), nullptr, blocks);
  }
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const Variable& v = variables_[i];
    if (!problem.HasParameterBlock(&x[i])) continue;
    if (std::isfinite(v.lower)) problem.SetParameterLowerBound(&x[i], 0, v.lower / v.scale);
    if (std::isfinite(v.upper)) problem.SetParameterUpperBound(&x[i], 0, v.upper / v.scale);
    if (!v.prior) continue;
    if (v.role == Variable::Role::background && stage == Stage::first)
      problem.SetParameterBlockConstant(&x[i]);
    ceres::Matrix weight(1, 1);
    ceres::Vector mean(1);
    weight(0, 0) = v.scale / (*v.prior)[1];
    mean[0] = (*v.prior)[0] / v.scale;
    priors.push_back(std::make_unique<ceres::NormalPrior>(weight, mean));
    problem.AddResidualBlock(priors.back().get(), nullptr, &x[i]);
  }
  const ceres::Solver::Options solver =
      solver_options(stage == Stage::last ? SolverPass::final : SolverPass::rough);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  for (const auto& cost : costs) simulations_ += cost->simulations();
  if (summary.termination_type == ceres::FAILURE) {
    std::string why = summary.message;
    for (const auto& cost : costs)
      if (!cost->failure().empty()) why = cost->failure();
    throw std::runtime_error("the fit could not start: " + why);
  }
  iterations_ += summary.num_successful_steps;
  termination_ = summary.termination_type == ceres::CONVERGENCE
                     ? "converged"
                     : fmt::format("stopped after {} iterations without converging",
                                   summary.iterations.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    variables_[i].value =
        std::clamp(x[i] * variables_[i].scale, variables_[i].lower, variables_[i].upper);
  return 2.0 * summary.final_cost /
         std::max(1.0, samples() - static_cast<double>(variables_.size()));
}

/// Tries other restitutions and stiffnesses and keeps the best end.
void Session::restart_elsewhere(double reduced) {
  const std::vector<Variable> start = variables_;
  std::vector<Variable> best = variables_;
  for (const double restitution : {0.25, 0.8})
    for (const double stiffness : {0.4, 2.5}) {
      variables_ = start;
      for (Variable& v : variables_) {
        v.value = v.initial;
        if (v.name == "contact.restitution") v.value = restitution;
        if (v.name == "contact.stiffness_factor") v.value = stiffness * v.initial;
      }
      const double reached = solve(Stage::first);
      if (reached >= reduced) continue;
      reduced = reached;
      best = variables_;
    }
  variables_ = best;
}

/// Weighted sum of squares of the data at the present values, and the Jacobian of data and priors
/// to all variables, in their own units (not divided by the scale).
double Session::chi2(Eigen::MatrixXd* jacobian) const {
  double sum = 0.0;
  Eigen::Index rows = 0;
  for (const Variable& v : variables_) rows += v.prior ? 1 : 0;
  for (const Shot& shot : shots_)
    for (const FittedChannel& channel : shot.channels)
      rows += static_cast<Eigen::Index>(channel.used.size());
  if (jacobian)
    *jacobian = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(variables_.size()));
  Eigen::Index row = 0;
  for (const Shot& shot : shots_) {
    const auto cost = cost_of(shot);
    cost->use_central_differences();
    std::vector<double> x;
    for (const std::size_t i : shot.variables)
      x.push_back(variables_[i].value / variables_[i].scale);
    std::vector<const double*> blocks;
    for (const double& value : x) blocks.push_back(&value);
    Eigen::VectorXd residuals(cost->num_residuals());
    Eigen::MatrixXd columns(cost->num_residuals(), static_cast<Eigen::Index>(x.size()));
    std::vector<double*> pointers;
    for (Eigen::Index k = 0; k < columns.cols(); ++k) pointers.push_back(columns.col(k).data());
    if (!cost->Evaluate(blocks.data(), residuals.data(), jacobian ? pointers.data() : nullptr))
      throw std::runtime_error("the fit ended where the simulation fails: " + cost->failure());
    simulations_ += cost->simulations();
    sum += residuals.squaredNorm();
    if (jacobian)
      for (std::size_t k = 0; k < shot.variables.size(); ++k)
        jacobian->block(row, static_cast<Eigen::Index>(shot.variables[k]), columns.rows(), 1) =
            columns.col(static_cast<Eigen::Index>(k)) / variables_[shot.variables[k]].scale;
    row += columns.rows();
  }
  for (std::size_t i = 0; jacobian && i < variables_.size(); ++i)
    if (variables_[i].prior)
      (*jacobian)(row++, static_cast<Eigen::Index>(i)) = 1.0 / (*variables_[i].prior)[1];
  return sum;
}

void Session::report_parameters(const Uncertainty& spread, double inflation, Fit& fit) const {
  const double dof = std::max(1.0, static_cast<double>(fit.goodness.dof));
  const double quantile = boost::math::quantile(boost::math::students_t(dof), 0.975);
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const Variable& v = variables_[i];
    const auto k = static_cast<Eigen::Index>(i);
    Parameter p;
    p.name = v.name;
    p.unit = v.unit;
    p.value = v.value;
    p.std_error = inflation * std::sqrt(spread.covariance(k, k));
    if (mesh_shift_.size() > 0) p.mesh_shift = mesh_shift_[k];
    const double half = quantile * p.std_error + beyond_finer * std::abs(p.mesh_shift);
    p.ci95 = {std::max(v.value - half, v.lower), std::min(v.value + half, v.upper)};
    p.initial = v.initial;
    p.lower = v.lower;
    p.upper = v.upper;
    const double near_bound = 1e-6 * (std::isfinite(v.upper - v.lower) ? v.upper - v.lower : 1.0);
    p.at_bound = v.value - v.lower <= near_bound || v.upper - v.value <= near_bound;
    p.identifiable = spread.identifiable[i];
    p.nuisance = v.role != Variable::Role::physics;
    p.prior = v.prior;
    fit.parameters.push_back(std::move(p));
  }
  fit.correlations = spread.correlations;
  fit.not_identifiable = spread.sentences;
}

void Session::report_channels(Fit& fit) {
  for (std::size_t s = 0; s < shots_.size(); ++s) {
    const Shot& shot = shots_[s];
    const auto cost = cost_of(shot);
    const std::vector<double> values = values_of(shot);
    double touch = shot.impact->start;
    for (const std::size_t i : shot.variables)
      if (variables_[i].role == Variable::Role::touch) touch = variables_[i].value;
    for (const FittedChannel& channel : shot.channels) {
      const ImpactSignal& signal = *channel.signal;
      ChannelFit out;
      out.quantity = datasets::name(signal.quantity);
      out.channel = signal.channel;
      out.unit = datasets::si_unit(signal.quantity);
      out.recording = static_cast<int>(s);
      out.noise = signal.noise;
      out.measured = signal.values;
      out.model = cost->model_values(channel, values);
      out.used.assign(signal.values.size(), 0);
      std::vector<double> measured, computed;
      double squares = 0.0;
      for (const std::size_t k : channel.used) {
        out.used[k] = 1;
        measured.push_back(out.measured[k]);
        computed.push_back(out.model[k]);
        squares += (measured.back() - computed.back()) * (measured.back() - computed.back());
      }
      for (std::size_t k = 0; k < signal.values.size(); ++k)
        out.time.push_back(signal.time(k) - touch);
      out.residual_rms =
          std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, measured.size())));
      const bool contiguous = !channel.used.empty() &&
                              channel.used.back() - channel.used.front() + 1 == channel.used.size();
      out.metrics = metrics(measured, computed, contiguous);
      fit.channels.push_back(std::move(out));
    }
    simulations_ += cost->simulations();
  }
}

void Session::report_restitution(const Uncertainty& spread, double inflation, Fit& fit) {
  const Shot& shot = shots_.front();
  const auto cost = cost_of(shot);
  const Eigen::MatrixXd gradient = cost->restitution_gradient(values_of(shot));
  const auto count = static_cast<Eigen::Index>(shot.variables.size());
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      covariance(i, j) =
          spread.covariance(static_cast<Eigen::Index>(shot.variables[static_cast<std::size_t>(i)]),
                            static_cast<Eigen::Index>(shot.variables[static_cast<std::size_t>(j)]));
  const models::Restitution& r = fit.predictions.front().restitution;
  const double values[] = {r.kinematic, r.kinetic, r.energetic};
  const char* names[] = {"kinematic", "kinetic", "energetic"};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double half =
        rig_.solver.accuracy * std::abs(values[k]) +
        1.96 * inflation *
            std::sqrt(std::max(0.0, gradient.row(k).dot(covariance * gradient.row(k).transpose())));
    fit.restitution[names[k]] = {values[k], {values[k] - half, values[k] + half}};
  }
  Estimate law{rig_.rig.contact.restitution,
               {rig_.rig.contact.restitution, rig_.rig.contact.restitution}};
  for (const Parameter& p : fit.parameters)
    if (p.name == "contact.restitution") law = {p.value, p.ci95};
  fit.restitution["law"] = law;
  simulations_ += cost->simulations();
}

void Session::warn(Fit& fit, double reduced) const {
  for (const ChannelFit& channel : fit.channels) {
    const double ratio = channel.residual_rms / channel.noise;
    if (!(channel.noise > 0.0 && ratio > std::sqrt(misfit))) continue;
    fit.warnings.push_back(fmt::format(
        "The residuals of {} are {:.3g} times its noise before the trigger: the model or the "
        "calibration does not explain all that "
        "was measured. Standard errors were multiplied by {:.3g}; they do not cover a wrong model. "
        "Look at the residuals; try "
        "another law or a finer mesh, free a gain or delay, or shorten the fitted window.",
        channel.channel, ratio, std::sqrt(reduced)));
  }
  std::string shifts;
  for (const Parameter& p : fit.parameters)
    if (!p.nuisance && std::abs(p.mesh_shift) > telling_shift * p.std_error)
      shifts += fmt::format(
          "{}{} by {:+.2g}{} ({:.2g} standard errors)", shifts.empty() ? "" : ", ", p.name,
          p.mesh_shift, p.unit == "1" ? "" : " " + p.unit, std::abs(p.mesh_shift) / p.std_error);
  if (!shifts.empty()) {
    const models::Solver finer = models::refined(rig_.solver);
    fit.warnings.push_back(fmt::format(
        "The mesh is coarser than the data are good: one twice as fine would move {}. The "
        "intervals "
        "were widened by that; with {} they would be narrower.",
        shifts,
        finer.model == models::BeamModel::ancf
            ? fmt::format("solver.elements = [{}, {}]", finer.elements[0], finer.elements[1])
            : fmt::format("solver.modes = {}", finer.modes)));
  }
  for (const Parameter& p : fit.parameters)
    if (p.at_bound)
      fit.warnings.push_back(fmt::format(
          "{} ended at its bound {:g} {}; its interval means little. Widen what the model can do, "
          "or fix it.",
          p.name, p.value, p.unit == "1" ? "" : p.unit));
  for (const Impact& impact : impacts_)
    for (const ImpactFlag flag : impact.flags)
      fit.warnings.push_back(fmt::format("{}: {}", impact.recording, datasets::sentence(flag)));
  if (!rig_.force && !rig_.velocity && !rig_.displacement)
    fit.warnings.push_back(
        "The rig file describes no sensors: channels were taken as perfect, without delay. Add "
        "[sensors.force] "
        "and [sensors.velocity].");
  for (const models::Simulation& prediction : fit.predictions)
    for (const std::string& warning : prediction.warnings)
      if (std::ranges::find(fit.warnings, warning) == fit.warnings.end())
        fit.warnings.push_back(warning);
}

void Session::set_motion(models::Motion motion) {
  for (Shot& shot : shots_) shot.model->set_motion(motion);
}

/// Small motion is faster by an order and leaves out what a noisy recording seldom shows. One
/// choice for the whole fit: a change between two predictions would be taken for an effect of the
/// parameters.
void Session::choose_motion() {
  try {
    set_motion(models::Motion::small);
    for (const Shot& shot : shots_)
      if (shot.model->simulate(rig_.rig, 0.0).neglected > smallest_motion)
        return set_motion(models::Motion::full);
  } catch (const std::exception&) {
    set_motion(models::Motion::full);  // it has the last word on what is wrong with the rig
  }
}

/// By how much the variables would move if other models predicted, to first order: change(model) is
/// the other model of a shot.
template <typename Change>
Eigen::VectorXd Session::shift_by(const Change& change, const Eigen::MatrixXd& jacobian,
                                  const Uncertainty& spread) const {
  Eigen::VectorXd changes = Eigen::VectorXd::Zero(jacobian.rows());
  Eigen::Index row = 0;
  for (const Shot& shot : shots_) {
    const auto cost = cost_of(shot);
    const Eigen::VectorXd part = cost->change_by(change(*shot.model), values_of(shot));
    changes.segment(row, part.size()) = part;
    row += part.size();
    simulations_ += cost->simulations();
  }
  return -spread.covariance * (jacobian.transpose() * changes);
}

/// The largest shift of a parameter of the impact, in standard errors.
double Session::shift_by_full_motion(const Eigen::MatrixXd& jacobian,
                                     const Uncertainty& spread) const {
  const auto with_full_motion = [](ShotModel model) {
    model.set_motion(models::Motion::full);
    return model;
  };
  const Eigen::VectorXd shift = shift_by(with_full_motion, jacobian, spread);
  double largest = 0.0;
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (variables_[i].physics && spread.covariance(k, k) > 0.0)
      largest = std::max(largest, std::abs(shift[k]) / std::sqrt(spread.covariance(k, k)));
  }
  return largest;
}

/// A mesh twice as fine, compared in small motion: what large rotation adds is the same on both.
void Session::estimate_mesh_shift(const Eigen::MatrixXd& jacobian, const Uncertainty& spread) {
  if (rig_.solver.model == models::BeamModel::rigid) return;
  const models::Motion motion = shots_.front().model->motion();
  try {
    set_motion(models::Motion::small);
    mesh_shift_ = shift_by([](const ShotModel& model) { return model.finer(); }, jacobian, spread);
  } catch (const std::exception& error) {
    warnings_.push_back(fmt::format("The mesh error could not be estimated: {}", error.what()));
  }
  set_motion(motion);
}

/// From chi2, the samples and the unknowns. Returns chi2 by degree of freedom.
double Session::report_goodness(double priors, Goodness& goodness) const {
  const double count = samples();
  const double unknowns = static_cast<double>(variables_.size());
  const double dof = std::max(1.0, count + priors - unknowns);
  goodness.dof = std::lround(dof);
  goodness.aicc = goodness.chi2 + 2.0 * unknowns +
                  2.0 * unknowns * (unknowns + 1.0) / std::max(1.0, count - unknowns - 1.0);
  goodness.bic = goodness.chi2 + unknowns * std::log(count);
  return goodness.chi2 / dof;
}

void Session::report_predictions(Fit& fit) {
  for (const Shot& shot : shots_) {
    const double interval = std::min(1e-6, shot.channels.front().signal->interval);
    fit.predictions.push_back(
        shot.model->simulate(cost_of(shot)->rig_at(values_of(shot)), interval));
    if (!skipped_.empty()) fit.predictions.back().skipped.push_back(skipped_);
  }
}

Fit Session::run() {
  const auto started = std::chrono::steady_clock::now();
  choose_motion();
  choose_samples(first_window);
  const double first = solve(Stage::first);
  const bool several_starts = std::ranges::any_of(variables_, [](const Variable& v) {
    return v.name == "contact.restitution" || v.name == "contact.stiffness_factor";
  });
  if (first > poor_fit && several_starts) restart_elsewhere(first);
  choose_samples(std::numeric_limits<double>::infinity());
  solve(Stage::last);

  Fit fit;
  Eigen::MatrixXd jacobian;
  fit.goodness.chi2 = chi2(&jacobian);
  std::vector<std::string> names;
  std::vector<bool> held;
  double priors = 0.0;
  for (const Variable& v : variables_) {
    names.push_back(v.name);
    held.push_back(v.prior || v.role == Variable::Role::touch);
    priors += v.prior ? 1.0 : 0.0;
  }
  Uncertainty spread = uncertainty(jacobian, names, held);
  if (shots_.front().model->motion() == models::Motion::small) {
    const double shift = shift_by_full_motion(jacobian, spread);
    if (shift <= harmless_shift) {
      skipped_ = fmt::format(
          "in the fit: with the full equations no parameter of the impact would move by more than "
          "{:.2g} standard errors",
          shift);
    } else {
      set_motion(models::Motion::full);
      solve(Stage::last);
      fit.goodness.chi2 = chi2(&jacobian);
      spread = uncertainty(jacobian, names, held);
    }
  }
  estimate_mesh_shift(jacobian, spread);
  const double reduced = report_goodness(priors, fit.goodness);
  const double inflation = !noise_known_ || reduced > misfit ? std::sqrt(reduced) : 1.0;

  report_parameters(spread, inflation, fit);
  report_channels(fit);
  fit.rig = rig_;
  for (const Variable& v : variables_)
    if (v.physics && v.recording <= 0) v.physics->of(fit.rig.rig) = v.value;
  report_predictions(fit);
  report_restitution(spread, inflation, fit);
  fit.impacts = impacts_;
  for (const Impact& impact : impacts_) fit.direct.push_back(direct_restitution(impact, rig_));
  fit.termination = termination_;
  fit.iterations = iterations_;
  fit.warnings = warnings_;
  warn(fit, reduced);
  fit.simulations = simulations_ + static_cast<long>(shots_.size());
  fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return fit;
}

}  // namespace

Fit fit(const std::vector<datasets::Impact>& impacts, const RigFile& rig,
        const FitOptions& options) {
  if (!rig.rig.has_stop())
    throw std::invalid_argument("the rig has no [contact]: there is no impact to fit");
  return Session(impacts, rig, options).run();
}

}  // namespace impactrig::fitting
