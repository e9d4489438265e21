// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_problem.hpp"

#include <ceres/iteration_callback.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "fitting/filtered_samples.hpp"
#include "fitting/quiet_noise.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using datasets::ImpactSignal;

constexpr double unseen_noise = 1e-3;   // of the peak, where the record shows no noise at all
constexpr double margin_part = 0.1;     // of the contact: first touch moves during the fit
constexpr double margin_least = 20e-6;  // [s]

constexpr double edge = 1e-12;  // of a scale, beyond a bound by rounding

/// Watches a search from step to step.
class SearchWatch : public ceres::IterationCallback {
 public:
  /// `strays`: whether the search has come beyond a bound.
  SearchWatch(double tolerance, const std::vector<Shot>& shots, std::function<bool()> strays)
      : tolerance_(tolerance),
        shots_(shots),
        strays_(std::move(strays)) {
    look_ahead(true);
  }

  SearchWatch(const SearchWatch&) = delete;
  SearchWatch& operator=(const SearchWatch&) = delete;

  ~SearchWatch() override { look_ahead(false); }

  /// Ceres looks at its function tolerance after steps that succeed only. A step that changes the
  /// cost by less and fails does so for the rounding of the simulation: there is nothing more to
  /// gain.
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration > 0 && summary.step_is_valid && !summary.step_is_successful &&
        std::abs(summary.cost_change) <= tolerance_ * summary.cost)
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    if (summary.iteration > 0 && summary.step_is_successful) look_ahead(!is_last(summary));
    if (summary.step_is_successful) astray_ = strays_() ? astray_ + 1 : 0;
    if (astray_ == most_astray) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    gradient_ = summary.gradient_norm;
    return ceres::SOLVER_CONTINUE;
  }

 private:
  /// Whether the next step probably changes the cost by less than the tolerance, after which nobody
  /// asks for slopes: close to a minimum, a step gains as the square of the gradient.
  bool is_last(const ceres::IterationSummary& summary) const {
    const double part = summary.gradient_norm / gradient_;
    return summary.cost_change * part * part < tolerance_ * summary.cost;
  }

  void look_ahead(bool ahead) {
    for (const Shot& shot : shots_) shot.cost->look_ahead(ahead);
  }

  // Steps beyond bounds, one after the other, that a search may yet come back from.
  static constexpr int most_astray = 8;

  double tolerance_;
  const std::vector<Shot>& shots_;
  std::function<bool()> strays_;
  double gradient_ = 0.0;  // at the last step's beginning
  int astray_ = 0;
};

/// What is known of a variable beside the data: (value − mean) / uncertainty.
class PriorCost : public ceres::SizedCostFunction<1, 1> {
 public:
  explicit PriorCost(const Variable& variable) : variable_(variable) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const auto [mean, uncertainty] = *variable_.prior;
    const double value = variable_.value_at(parameters[0][0]);
    residuals[0] = (value - mean) / uncertainty;
    if (jacobians && jacobians[0]) jacobians[0][0] = variable_.slope_at(value) / uncertainty;
    return true;
  }

 private:
  const Variable& variable_;
};

double margin_of(const Shot& shot) {
  return std::max(margin_least, margin_part * shot.contact) + shot.reach;
}

double ceiling_of(const Impact& impact, const ImpactSignal& signal) {
  const bool told_by_flag_alone = impact.has(ImpactFlag::clipped) && signal.valid.empty() &&
                                  signal.quantity == datasets::Quantity::force;
  if (!told_by_flag_alone) return std::numeric_limits<double>::infinity();
  return 0.999 * *std::ranges::max_element(signal.values);
}

}  // namespace

FitProblem::FitProblem(const std::vector<Impact>& impacts, const RigFile& rig,
                       const FitOptions& options)
    : loss_(options.loss) {
  if (impacts.empty()) throw std::invalid_argument("there is no impact to fit to");
  auto own = std::make_shared<RigFile>(rig);
  if (own->rig.start.release_angle) {
    own->rig.start.velocity = models::touch_velocity(own->rig);
    own->rig.start.release_angle.reset();
  }
  rig_ = own;
  variables_ = std::make_unique<std::vector<Variable>>(make_variables(impacts, *rig_, options));
  for (std::size_t i = 0; i < impacts.size(); ++i)
    add_shot(impacts[i], static_cast<int>(i), options);
  std::vector<bool> told(variables_->size(), false);
  for (const Shot& shot : shots_)
    for (const std::size_t number : shot.numbers) {
      const Variable& v = (*variables_)[number];
      told[v.tie ? v.tie->to : number] = true;
    }
  for (std::size_t i = 0; i < variables_->size(); ++i) {
    if (told[i] && !(*variables_)[i].tie) unknowns_.push_back(i);
    if (told[i] && (*variables_)[i].prior) priors_.push_back(i);
  }
  warn_of_unused(options);
}

/// What is asked for or stated of a parameter that no recording tells.
void FitProblem::warn_of_unused(const FitOptions& options) {
  const auto used = [&](const std::string& asked) {
    return std::ranges::any_of(shots_, [&](const Shot& shot) {
      return std::ranges::any_of(shot.numbers, [&](std::size_t number) {
        const Variable& v = (*variables_)[number];
        const auto [key, recording] = parameter_key(asked);
        return parameter_key(v.name).key == key && (recording == 0 || recording == v.recording + 1);
      });
    });
  };
  for (const ParameterSetting& setting : options.settings)
    if (!setting.fixed && !used(setting.name))
      warnings_.push_back(fmt::format(
          "What is stated of {} was not used: no channel that is fitted tells it.", setting.name));
  for (const std::string& name : options.free)
    if (!options.setting_of(name) && !used(name))
      warnings_.push_back(
          fmt::format("{} was not fitted: no channel that is fitted tells it.", name));
}

FitProblem FitProblem::copy() const {
  FitProblem other;
  other.rig_ = rig_;
  other.variables_ = std::make_unique<std::vector<Variable>>(*variables_);
  other.unknowns_ = unknowns_;
  other.priors_ = priors_;
  other.loss_ = loss_;
  other.noise_known_ = noise_known_;
  other.small_slopes_ = small_slopes_;
  for (const Shot& shot : shots_)
    other.shots_.push_back({shot.impact, shot.window, shot.contact, shot.reach, shot.channels,
                            shot.numbers, shot.model, nullptr});
  other.rebuild_costs();
  return other;
}

FittedChannel FitProblem::weigh(const Impact& impact, const ImpactSignal& signal) {
  FittedChannel channel;
  channel.signal = &signal;
  channel.measured = signal.values;
  channel.sound = sound_samples(signal);
  channel.every = every_of(signal);
  double sigma = std::max(signal.noise, signal.quantum / std::sqrt(12.0));
  double largest = 0.0;
  for (const double value : signal.values)
    largest = std::max(largest, std::isfinite(value) ? std::abs(value) : 0.0);
  if (sigma > 1e-9 * largest) {
    const double quiet_end =
        impact.start - std::max(5.0 * signal.interval, margin_part * (impact.end - impact.start));
    channel.noise = quiet_noise(signal, channel.sound, channel.every, quiet_end,
                                rig_->mains_frequency, sigma, signal.quantum / std::sqrt(12.0));
    return channel;
  }
  sigma = unseen_noise * (largest > 0.0 ? largest : 1.0);
  channel.noise = NoiseModel(sigma, 1.0);
  channel.noise_known = noise_known_ = false;
  warnings_.push_back(
      fmt::format("{} shows no noise before the trigger in {}; it was weighed with {:g} % of its "
                  "peak and all intervals follow from the scatter of the residuals instead.",
                  signal.channel, impact.recording, 100.0 * unseen_noise));
  return channel;
}

void FitProblem::add_shot(const Impact& impact, int number, const FitOptions& options) {
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
    if (!is_fitted(impact, *candidate, options)) continue;
    const auto every = static_cast<double>(every_of(signal));
    if (impact.start - signal.start < 20.0 * every * signal.interval)
      warnings_.push_back(
          fmt::format("{} of {} has fewer than 20 samples before first touch: its noise and "
                      "baseline are hardly known. Record a longer pre-trigger.",
                      signal.channel, impact.recording));
    shot.channels.push_back(weigh(impact, signal));
    shot.reach = std::max(shot.reach, reach_of(signal));
    first = std::min(first, signal.start);
    last = std::max(last, signal.time(signal.values.size() - 1));
    finest = std::min(finest, signal.interval);
  }
  if (shot.channels.empty())
    throw std::invalid_argument(
        fmt::format("{} has no force, velocity or displacement to fit to", impact.recording));
  shot.window = last - impact.start;
  if (options.window > 0.0) shot.window = std::min(shot.window, options.window);
  if (rig_->solver.duration) shot.window = std::min(shot.window, *rig_->solver.duration);
  if (!(shot.window > 0.0))
    throw std::invalid_argument(
        fmt::format("{} ends at first touch; there is nothing to fit to", impact.recording));
  refuse_all_made_up(shot);
  for (std::size_t i = 0; i < variables_->size(); ++i) {
    const Variable& v = (*variables_)[i];
    const bool fitted = v.quantity == datasets::Quantity::unknown ||
                        std::ranges::any_of(shot.channels, [&](const FittedChannel& c) {
                          return c.signal->quantity == v.quantity;
                        });
    if (v.concerns(number) && fitted) shot.numbers.push_back(i);
  }
  shot.model = std::make_shared<ShotModel>(*rig_, impact, impact.start - first + margin_of(shot),
                                           shot.window + margin_of(shot), finest);
  shots_.push_back(std::move(shot));
}

/// Where a filter reaches so far that no sample of the window depends on recorded ones alone.
void FitProblem::refuse_all_made_up(const Shot& shot) const {
  for (const FittedChannel& channel : shot.channels) {
    const ImpactSignal& signal = *channel.signal;
    bool any = signal.filters.empty();
    for (std::size_t k = 0; k < signal.values.size() && !any; k += channel.every)
      any = channel.sound[k] && signal.time(k) > shot.impact->start &&
            signal.time(k) <= shot.impact->start + shot.window;
    if (any) continue;
    throw std::invalid_argument(fmt::format(
        "{} of {} went through a filter that reaches {:.3g} s to either side, over an end of the "
        "record or to a sample that is not valid from everywhere in the fitted window: what it "
        "made of those is no measurement. Filter at a higher cutoff, or leave the step out",
        signal.channel, shot.impact->recording, reach_of(signal)));
  }
}

std::vector<double> FitProblem::values() const {
  std::vector<double> values;
  for (const Variable& v : *variables_) values.push_back(v.value);
  return values;
}

void FitProblem::set_values(const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    Variable& v = (*variables_)[i];
    v.value = std::clamp(values[i], v.lower, v.upper);
  }
  follow_ties();
}

void FitProblem::set_initial_values() {
  for (Variable& v : *variables_) v.value = v.initial;
  follow_ties();
}

void FitProblem::set_prior_mean(std::size_t number, double mean) {
  (*(*variables_)[number].prior)[0] = mean;
}

void FitProblem::follow_ties() {
  for (Variable& v : *variables_)
    if (v.tie) v.value = v.tie->factor * (*variables_)[v.tie->to].value + v.tie->offset;
}

void FitProblem::choose_samples(double contacts, bool rough, bool one_by_one) {
  for (Shot& shot : shots_) {
    const double window = std::min(shot.window, contacts * shot.contact);
    shot.model->set_end(window + margin_of(shot));
    shot.model->set_rough(rough);
    for (FittedChannel& channel : shot.channels) {
      const ImpactSignal& signal = *channel.signal;
      const double ceiling = ceiling_of(*shot.impact, signal);
      channel.one_by_one = one_by_one;
      channel.used.clear();
      const bool clipped = shot.impact->has(ImpactFlag::clipped);
      for (std::size_t k = 0; k < signal.values.size(); k += channel.every)
        if (signal.time(k) <= shot.impact->start + window && channel.sound[k] &&
            (signal.values[k] < ceiling || !clipped))
          channel.used.push_back(k);
    }
  }
  rebuild_costs();
}

void FitProblem::see_separation() {
  for (Shot& shot : shots_)
    shot.model->set_end(
        std::max(shot.model->end(), rig_->solver.duration.value_or(2.0 * shot.contact)));
  rebuild_costs();
}

void FitProblem::rebuild_costs() {
  for (Shot& shot : shots_) {
    if (shot.cost) past_simulations_ += shot.cost->simulations();
    shot.cost = std::make_unique<ShotCost>(*rig_, *shot.model, shot.channels, *variables_,
                                           shot.numbers, loss_);
    if (small_slopes_) shot.cost->take_small_slopes();
  }
}

void FitProblem::set_motion(models::Motion motion) {
  if (motion == this->motion() && shots_.front().cost) return;
  for (Shot& shot : shots_) shot.model->set_motion(motion);
  rebuild_costs();
}

void FitProblem::set_loss(Loss loss) {
  if (loss == loss_) return;
  loss_ = loss;
  rebuild_costs();
}

models::Motion FitProblem::motion() const {
  return shots_.front().model->motion();
}

void FitProblem::take_small_slopes() {
  small_slopes_ = true;
  for (Shot& shot : shots_) shot.cost->take_small_slopes();
}

void FitProblem::limit_time(double seconds) {
  deadline_.reset();
  constexpr double endless = 1e9;  // [s]
  if (seconds < endless)
    deadline_ = std::chrono::steady_clock::now() +
                std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                    std::chrono::duration<double>(seconds));
}

double FitProblem::time_left() const {
  if (!deadline_) return std::numeric_limits<double>::infinity();
  return std::chrono::duration<double>(*deadline_ - std::chrono::steady_clock::now()).count();
}

/// Blocks and priors of a Ceres problem, which does not own the priors.
FitProblem::Priors FitProblem::state(const std::vector<std::size_t>& held, std::vector<double>& x,
                                     ceres::Problem& problem) const {
  Priors priors;
  for (const Shot& shot : shots_) {
    std::vector<double*> blocks;
    for (const std::size_t i : shot.cost->blocks()) blocks.push_back(&x[i]);
    problem.AddResidualBlock(shot.cost.get(), nullptr, blocks);
  }
  for (const std::size_t i : held) problem.SetParameterBlockConstant(&x[i]);
  for (const std::size_t i : priors_) {
    priors.push_back(std::make_unique<PriorCost>((*variables_)[i]));
    problem.AddResidualBlock(priors.back().get(), nullptr, &x[i]);
  }
  return priors;
}

SearchEnd FitProblem::search_once(const Search& how, const std::vector<std::size_t>& held) {
  for (const Shot& shot : shots_) shot.cost->forget_failure();
  std::vector<double> x(variables_->size());
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = (*variables_)[i].coordinate((*variables_)[i].value);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  const Priors priors = state(held, x, problem);
  ceres::Solver::Options solver = solver_options(how);
  const auto strays = [&] {
    return std::ranges::any_of(unknowns_, [&](std::size_t i) {
      const Variable& v = (*variables_)[i];
      const double value = v.value_at(x[i]), rounding = edge * v.scale;
      return value < v.lower - rounding || value > v.upper + rounding;
    });
  };
  SearchWatch watch(how.tolerance, shots_, strays);
  solver.callbacks.push_back(&watch);
  solver.update_state_every_iteration = true;
  solver.max_solver_time_in_seconds =
      std::clamp(time_left(), 0.0, solver.max_solver_time_in_seconds);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  SearchEnd end{.started = !summary.iterations.empty(),
                .cost = summary.final_cost,
                .converged = summary.termination_type == ceres::CONVERGENCE ||
                             summary.termination_type == ceres::USER_SUCCESS,
                .iterations = summary.num_successful_steps,
                .message = summary.message};
  end.strayed = strays();
  std::vector<double> values(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) values[i] = (*variables_)[i].value_at(x[i]);
  for (const Shot& shot : shots_) {
    if (shot.cost->failure().empty()) continue;
    end.strayed = true;
    if (!end.started) end.message = shot.cost->failure();
  }
  set_values(values);
  return end;
}

Eigen::Index FitProblem::data_size() const {
  Eigen::Index size = 0;
  for (const Shot& shot : shots_) size += shot.cost->num_residuals();
  return size;
}

void FitProblem::linearise(Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const {
  const auto count = static_cast<Eigen::Index>(unknowns_.size());
  residuals.resize(data_size() + static_cast<Eigen::Index>(priors_.size()));
  if (jacobian) jacobian->setZero(residuals.size(), count);
  std::vector<Eigen::Index> place(variables_->size(), -1);
  for (std::size_t k = 0; k < unknowns_.size(); ++k)
    place[unknowns_[k]] = static_cast<Eigen::Index>(k);
  Eigen::Index row = 0;
  for (const Shot& shot : shots_) {
    Eigen::VectorXd differences;
    Eigen::MatrixXd slopes;
    shot.cost->linearise(differences, jacobian ? &slopes : nullptr);
    residuals.segment(row, differences.size()) = differences;
    for (std::size_t b = 0; jacobian && b < shot.cost->blocks().size(); ++b)
      jacobian->block(row, place[shot.cost->blocks()[b]], differences.size(), 1) =
          slopes.col(static_cast<Eigen::Index>(b));
    row += differences.size();
  }
  for (const std::size_t i : priors_) {
    const Variable& v = (*variables_)[i];
    residuals[row] = (v.value - (*v.prior)[0]) / (*v.prior)[1];
    if (jacobian) (*jacobian)(row, place[i]) = 1.0 / (*v.prior)[1];
    ++row;
  }
}

long FitProblem::simulations() const {
  long count = past_simulations_;
  for (const Shot& shot : shots_) count += shot.cost->simulations();
  return count;
}

}  // namespace impactrig::fitting
