// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "fitting/filtered_samples.hpp"
#include "models/modal/arrival.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactSignal;

/// Variables of a fit that a recording with these channels tells.
std::vector<std::size_t> told_numbers(const std::vector<Variable>& variables,
                                      const std::vector<FittedChannel>& channels, int shot) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const Variable& v = variables[i];
    const bool fitted = v.quantity == datasets::Quantity::unknown ||
                        std::ranges::any_of(channels, [&](const FittedChannel& c) {
                          return c.signal->quantity == v.quantity;
                        });
    if (v.concerns(shot) && fitted) numbers.push_back(i);
  }
  return numbers;
}

}  // namespace

FitProblem::FitProblem(const std::vector<Impact>& impacts, const RigFile& rig,
                       const FitOptions& options)
    : loss_(options.loss) {
  if (impacts.empty()) throw std::invalid_argument("there is no impact to fit to");
  auto own = std::make_shared<RigFile>(rig);
  if (own->rig.start.release_angle) {
    if (own->solver.model != models::BeamModel::rigid)
      release_vibration_ = models::release_vibration(own->rig).value_or(0.0);
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
  other.deadline_ = deadline_;
  for (const Shot& shot : shots_)
    other.shots_.push_back({shot.impact, shot.window, shot.contact, shot.reach, shot.channels,
                            shot.numbers, shot.model, nullptr});
  other.rebuild_costs();
  return other;
}

void FitProblem::add_channels(const FitOptions& options, Shot& shot) {
  const Impact& impact = *shot.impact;
  for (const auto* candidate : {&impact.force, &impact.velocity, &impact.displacement}) {
    if (!*candidate || (*candidate)->values.empty()) continue;
    const ImpactSignal& signal = **candidate;
    warn_of_constant(impact, signal);
    if (!is_fitted(impact, *candidate, options)) continue;
    warn_of_short_pre_trigger(impact, signal);
    shot.channels.push_back(weigh(impact, signal, rig_->mains_frequency));
    if (!shot.channels.back().noise_known) warn_of_unseen_noise(impact, signal);
    shot.reach = std::max(shot.reach, reach_of(signal));
  }
  if (shot.channels.empty())
    throw std::invalid_argument(
        fmt::format("{} has no force, velocity or displacement to fit to", impact.recording));
}

void FitProblem::warn_of_constant(const Impact& impact, const ImpactSignal& signal) {
  const auto [least, most] = std::ranges::minmax(signal.values);
  if (least == most)
    warnings_.push_back(
        fmt::format("{} of {} is constant and was left out; is the sensor connected?",
                    signal.channel, impact.recording));
}

void FitProblem::warn_of_short_pre_trigger(const Impact& impact, const ImpactSignal& signal) {
  const auto every = static_cast<double>(every_of(signal));
  if (impact.start - signal.start < 20.0 * every * signal.interval)
    warnings_.push_back(
        fmt::format("{} of {} has fewer than 20 samples before first touch: its noise and "
                    "baseline are hardly known. Record a longer pre-trigger.",
                    signal.channel, impact.recording));
}

void FitProblem::warn_of_unseen_noise(const Impact& impact, const ImpactSignal& signal) {
  noise_known_ = false;
  warnings_.push_back(
      fmt::format("{} shows no noise before the trigger in {}; it was weighed with {:g} % of its "
                  "peak and all intervals follow from the scatter of the residuals instead.",
                  signal.channel, impact.recording, 100.0 * unseen_noise));
}

void FitProblem::add_shot(const Impact& impact, int number, const FitOptions& options) {
  Shot shot;
  shot.impact = &impact;
  shot.contact = impact.end - impact.start;
  add_channels(options, shot);
  double last = -std::numeric_limits<double>::infinity();
  double first = std::numeric_limits<double>::infinity();
  double finest = std::numeric_limits<double>::infinity();
  for (const FittedChannel& channel : shot.channels) {
    const ImpactSignal& signal = *channel.signal;
    first = std::min(first, signal.start);
    last = std::max(last, signal.time(signal.values.size() - 1));
    finest = std::min(finest, signal.interval);
  }
  shot.window = last - impact.start;
  if (options.window > 0.0) shot.window = std::min(shot.window, options.window);
  if (rig_->solver.duration) shot.window = std::min(shot.window, *rig_->solver.duration);
  if (!(shot.window > 0.0))
    throw std::invalid_argument(
        fmt::format("{} ends at first touch; there is nothing to fit to", impact.recording));
  refuse_all_made_up(shot);
  shot.numbers = told_numbers(*variables_, shot.channels, number);
  shot.model = std::make_shared<ShotModel>(*rig_, impact, impact.start - first + margin_of(shot),
                                           shot.window + margin_of(shot), finest);
  shots_.push_back(std::move(shot));
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
    shot.model->set_rough(rough);
    fitting::choose_samples(shot, contacts, one_by_one);
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

void FitProblem::set_models(const std::vector<ShotModel>& models) {
  for (std::size_t i = 0; i < shots_.size(); ++i) *shots_[i].model = models[i];
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
