// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/bar_family.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>
#include <utility>
#include <vector>

#include "models/modal/bar_cache.hpp"

namespace impactrig::models {
namespace {

// Of the octaves of heaviness, how many ranges each is parted into.
constexpr double ranges_of_octave = 2.0;
// What is interpolated may differ by this much from what is solved: rounding alone makes up to a
// few 1e-13 of the fastest mode's phase over the longest steps.
constexpr double as_good_as_solved = 1e-12;

/// The same for every number near by, so that a bar's family does not depend on who else is in it.
double nearest_power_of_two(double x) {
  return std::exp2(std::round(std::log2(x)));
}

/// What of the modes everything else follows from, relative to the largest of its kind.
double distance(const ModalBeam& here, const ModalBeam& there) {
  const auto apart = [](const auto& a, const auto& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
  };
  constexpr double none = 1e-300;  // [rad/s], of a pendulum without weight
  const double of_frequency = (here.omega() - there.omega())
                                  .cwiseQuotient(there.omega().cwiseMax(none))
                                  .cwiseAbs()
                                  .maxCoeff();
  return std::max({of_frequency, apart(here.struck(), there.struck()),
                   apart(here.rigid(), there.rigid()),
                   apart(here.stations().slopes, there.stations().slopes)});
}

/// A bar whose modes and steps a table interpolates.
class BarBetween : public ModalBar {
 public:
  BarBetween(const BarTable& table, const BarTable::Weights& weights,
             const ModalBeam::Change& change)
      : ModalBar(table.bar(), table.modes(weights, change)),
        table_(table),
        weights_(weights),
        change_(change) {}

  void become(const BarTable::Weights& weights, const ModalBeam::Change& change) {
    weights_ = weights;
    change_ = change;
    scales_.clear();
    ModalBar::become([&](ModalBeam& modes) { table_.find_modes(weights, change, modes); });
  }

 private:
  void make_step(const Collocation& rule, int level,
                 std::optional<ModalStep>& step) const override {
    if (!table_.knows_step(rule, level)) return ModalBar::make_step(rule, level, step);
    const auto [scale, added] = scales_.try_emplace(rule.nodes(), modes().modes(), rule.nodes(),
                                                    change_.time(), change_.mass);
    table_.find_step(weights_, rule, level, &scale->second, step);
  }

  const BarTable& table_;
  BarTable::Weights weights_;
  ModalBeam::Change change_;
  mutable std::map<int, ModalStep::Scale> scales_;  // by nodes
};

}  // namespace

int BarTable::number_of(double heaviness) {
  return static_cast<int>(std::round(ranges_of_octave * std::log2(heaviness)));
}

double BarTable::middle_of(int number) {
  return std::exp2(number / ranges_of_octave);
}

/// Chebyshev's points of the range: between the middle two of them interpolation errs most.
BarTable::BarTable(std::shared_ptr<const ModalBar> bar, double heaviness)
    : bar_(std::move(bar)),
      middle_(middle_of(number_of(heaviness))) {
  const double half_range = std::exp2(0.5 / ranges_of_octave) - 1.0;
  for (std::size_t j = 0; j < size; ++j) {
    const double angle = std::numbers::pi * (static_cast<double>(j) + 0.5) / size;
    places_[j] = half_range * std::cos(angle);
    bars_[j] = solved(middle_ * (1.0 + places_[j]));
  }
  between_ = solved(middle_);
  const ModalBeam& there = between_->modes();
  const bool vibrates = there.modes() > 1;
  knows_modes_ = vibrates && distance(modes(weights(middle_), {}), there) < as_good_as_solved;
}

std::shared_ptr<const ModalBar> BarTable::solved(double heaviness) const {
  return std::make_shared<const ModalBar>(bar_, ModalBeam::Change{.weight = heaviness});
}

/// Lagrange's.
BarTable::Weights BarTable::weights(double heaviness) const {
  const double place = heaviness / middle_ - 1.0;
  Weights weights;
  for (std::size_t j = 0; j < size; ++j) {
    weights[j] = 1.0;
    for (std::size_t k = 0; k < size; ++k)
      if (k != j) weights[j] *= (place - places_[k]) / (places_[j] - places_[k]);
  }
  return weights;
}

ModalBeam BarTable::modes(const Weights& weights, const ModalBeam::Change& change) const {
  ModalBeam modes = bars_.front()->modes();
  find_modes(weights, change, modes);
  return modes;
}

void BarTable::find_modes(const Weights& weights, const ModalBeam::Change& change,
                          ModalBeam& modes) const {
  std::array<const ModalBeam*, size> beams;
  for (std::size_t j = 0; j < size; ++j) beams[j] = &bars_[j]->modes();
  modes.become_between(beams, weights, change);
}

void BarTable::find_step(const Weights& weights, const Collocation& rule, int level,
                         const ModalStep::Scale* scale, std::optional<ModalStep>& step) const {
  std::array<const ModalStep*, size> steps;
  double h = 0.0;  // in the family's time
  for (std::size_t j = 0; j < size; ++j) {
    steps[j] = &bars_[j]->step(rule, level);
    h += weights[j] * steps[j]->h();
  }
  if (scale) h *= scale->time();
  if (step && step->nodes() == rule.nodes())
    step->become_sum(steps, weights, h, scale);
  else
    step = ModalStep::sum(steps, weights, h, scale);
}

bool BarTable::knows_step(const Collocation& rule, int level) const {
  std::atomic<Steps>& steps =
      steps_[static_cast<std::size_t>(rule.nodes())][static_cast<std::size_t>(level)];
  if (steps == Steps::not_looked_at) {  // each thread that finds it so comes to the same
    std::optional<ModalStep> step;
    find_step(weights(middle_), rule, level, nullptr, step);
    const double apart = between_->step(rule, level).distance(*step, between_->modes());
    steps = apart < as_good_as_solved ? Steps::known : Steps::unknown;
  }
  return steps == Steps::known;
}

/// The bars of a table; those that are no longer needed are memory for others, of the same thread
/// first: what another processor core has written last is slow to write over.
class BarFamily::BarsBetween : public std::enable_shared_from_this<BarsBetween> {
 public:
  BarsBetween(const std::shared_ptr<const ModalBar>& bar, double heaviness)
      : table_(bar, heaviness) {}

  bool are_known() const { return table_.knows_modes(); }

  std::shared_ptr<const ModalBar> bar(const ModalBeam::Change& change) {
    const BarTable::Weights weights = table_.weights(change.heaviness());
    std::unique_ptr<BarBetween> bar = unused();
    if (bar)
      bar->become(weights, change);
    else
      bar = std::make_unique<BarBetween>(table_, weights, change);
    return {bar.release(), [of = shared_from_this()](BarBetween* used) { of->keep(used); }};
  }

 private:
  std::unique_ptr<BarBetween> unused() {
    const std::lock_guard lock(mutex_);
    if (unused_.empty()) return nullptr;
    const auto mine = std::ranges::find(unused_, std::this_thread::get_id(), &Unused::by);
    Unused& used = mine == unused_.end() ? unused_.back() : *mine;
    std::unique_ptr<BarBetween> bar = std::move(used.bar);
    if (&used != &unused_.back()) used = std::move(unused_.back());
    unused_.pop_back();
    return bar;
  }

  void keep(BarBetween* used) {
    std::unique_ptr<BarBetween> bar(used);
    const std::lock_guard lock(mutex_);
    unused_.push_back({std::move(bar), std::this_thread::get_id()});
  }

  struct Unused {
    std::unique_ptr<BarBetween> bar;
    std::thread::id by;
  };

  BarTable table_;
  std::mutex mutex_;
  std::vector<Unused> unused_;
};

std::optional<Rig> BarFamily::representative(const Rig& rig) {
  if (!rig.beam.masses.empty() || !rig.beam.segments.empty() || rig.beam.shears() ||
      rig.gravity_across() != 0.0)
    return std::nullopt;
  Rig other = rig;
  for (double Beam::*value :
       {&Beam::area, &Beam::second_moment, &Beam::youngs_modulus, &Beam::density})
    other.beam.*value = nearest_power_of_two(rig.beam.*value);
  other.hinge.spring = other.hinge.viscous = 0.0;
  return other;
}

BarFamily::BarFamily(const Rig& representative, const Solver& solver)
    : beam_(representative.beam),
      bar_(make_modal_bar(representative, solver)) {}

std::shared_ptr<const ModalBar> BarFamily::bar(const Rig& rig) const {
  const Beam& beam = rig.beam;
  const ModalBeam::Change change{.stiffness = beam.youngs_modulus * beam.second_moment /
                                              (beam_.youngs_modulus * beam_.second_moment),
                                 .mass = beam.density * beam.area / (beam_.density * beam_.area),
                                 .spring = rig.hinge.spring,
                                 .viscous = rig.hinge.viscous};
  const bool free = change.spring == 0.0 && change.viscous == 0.0 && !bar_->modes().damped();
  if (free && bar_->modes().stops() == 1) {
    const std::shared_ptr<BarsBetween> bars = bars_between(change.heaviness());
    if (bars->are_known()) return bars->bar(change);
  }
  return std::make_shared<const ModalBar>(bar_, change);
}

std::shared_ptr<BarFamily::BarsBetween> BarFamily::bars_between(double heaviness) const {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<BarsBetween>& bars = between_[BarTable::number_of(heaviness)];
  if (!bars) bars = std::make_shared<BarsBetween>(bar_, heaviness);
  return bars;
}

}  // namespace impactrig::models
