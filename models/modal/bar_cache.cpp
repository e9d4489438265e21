// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/bar_cache.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "models/beams/linear_bar.hpp"
#include "models/make_beam.hpp"

namespace impactrig::models {
namespace {

constexpr double longest_step = 1.0;  // [s], of a bar without vibration

double longest_ladder(const ModalBeam& modes) {
  return std::min(ModalStep::longest(modes), longest_step);
}

/// The same for every number near by, so that a bar's family does not depend on who else is in it.
double nearest_power_of_two(double x) {
  return std::exp2(std::round(std::log2(x)));
}

}  // namespace

ModalBar::ModalBar(std::unique_ptr<const SmallMotionBeam> beam, const Rig& rig)
    : beam_(std::move(beam)),
      modes_(*beam_, rig),
      ladder_{longest_ladder(modes_)} {}

ModalBar::ModalBar(std::unique_ptr<const RitzBar> beam, const Rig& rig)
    : ModalBar(std::unique_ptr<const SmallMotionBeam>(std::move(beam)), rig) {
  residuals_ = static_cast<const RitzBar&>(*beam_).residuals(modes_.shapes());
  find_detuning();
}

/// Twice Kato's and Temple's bound, the square of the residual over the distance to the next mode
/// [Parlett1998, 10.5]: the bound is for a residual of the stiffness's norm, which is larger (by up
/// to 1.4 times more was seen).
void ModalBar::find_detuning() {
  const Eigen::ArrayXd squares = modes_.omega().array().square();
  const Eigen::Index m = squares.size();
  detuning_.setZero(m);
  for (Eigen::Index k = 1; k < m; ++k) {
    double distance = 1.0;
    for (const Eigen::Index next : {k - 1, k + 1})
      if (next > 0 && next < m)
        distance = std::min(distance, std::abs(1.0 - squares[k] / squares[next]));
    const double part = residuals_[k] * std::min(residuals_[k] / distance, 1.0);
    detuning_[k] = part * modes_.omega()[k];
  }
}

ModalBar::ModalBar(std::shared_ptr<const ModalBar> other, const ModalBeam::Change& change)
    : other_(std::move(other)),
      modes_(other_->modes(), change),
      ladder_{longest_ladder(modes_)} {}

ModalBar::~ModalBar() {
  for (const std::atomic<const Steps*>& steps : steps_) delete steps.load();
}

const ModalStep& ModalBar::step(const Collocation& rule, int level) const {
  const int nodes = rule.nodes();
  std::atomic<const Steps*>& kept = steps_[static_cast<std::size_t>(level)];
  const auto find = [&]() -> const ModalStep* {
    for (const Steps* steps = kept.load(std::memory_order_acquire); steps;
         steps = steps->others.get())
      if (steps->nodes == nodes) return &steps->step;
    return nullptr;
  };
  if (const ModalStep* step = find()) return *step;
  const std::lock_guard lock(mutex_);
  if (const ModalStep* step = find()) return *step;
  auto added = std::make_unique<Steps>(
      Steps{nodes, ModalStep(modes_, rule, ladder_.length_of(level)), nullptr});
  added->others.reset(kept.load());
  kept.store(added.release(), std::memory_order_release);
  return kept.load()->step;
}

BarKey BarKey::of(const Rig& rig, const Solver& solver) {
  std::vector<double> further;
  for (const FurtherStop& stop : rig.further_stops)
    further.push_back(stop.direction() * stop.contact.position);
  return {rig.beam,     rig.hinge,       rig.contact.position, rig.gravity, std::move(further),
          solver.model, solver.elements, solver.modes,         solver.basis};
}

std::size_t BarKey::Hash::operator()(const BarKey& key) const {
  std::size_t hash = 0;
  for (const double value :
       {key.beam.length, key.beam.area, key.beam.second_moment, key.beam.youngs_modulus,
        key.beam.density, key.hinge.spring, key.position, key.gravity})
    hash = 31 * hash + std::hash<double>()(value);
  return hash;
}

std::shared_ptr<const ModalBar> make_modal_bar(const Rig& rig, const Solver& solver) {
  return std::make_shared<const ModalBar>(make_small_motion_beam(rig, solver), rig);
}

std::shared_ptr<const ModalBar> make_ritz_bar(const Rig& rig, const Solver& solver, int modes) {
  auto bar = std::make_unique<const LinearBar>(
      rig, bar_elements(rig.beam, rig.contact.position, solver.elements));
  std::vector<Eigen::VectorXd> loads;
  for (int stop = 0; stop < rig.stops(); ++stop)
    loads.push_back(bar->small_motion_row(rig.contact_of(stop).position));
  if (rig.hinge.spring > 0.0 || rig.hinge.viscous > 0.0) loads.push_back(bar->hinge());
  return std::make_shared<const ModalBar>(
      std::make_unique<const RitzBar>(std::move(bar), loads, modes), rig);
}

std::optional<Rig> BarFamily::representative(const Rig& rig) {
  if (!rig.beam.masses.empty() || !rig.beam.segments.empty() || rig.beam.shears())
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
  return std::make_shared<const ModalBar>(
      bar_, ModalBeam::Change{.stiffness = beam.youngs_modulus * beam.second_moment /
                                           (beam_.youngs_modulus * beam_.second_moment),
                              .mass = beam.density * beam.area / (beam_.density * beam_.area),
                              .spring = rig.hinge.spring,
                              .viscous = rig.hinge.viscous});
}

std::shared_ptr<const ModalBar> BarCache::find(const Rig& rig, const Solver& solver, int modes) {
  const BarKey key = BarKey::of(rig, solver);
  const std::lock_guard lock(mutex_);
  if (key_ != key) bars_.clear();
  key_ = key;
  std::shared_ptr<const ModalBar>& bar = bars_[modes];
  if (!bar) bar = modes == 0 ? make_modal_bar(rig, solver) : make_ritz_bar(rig, solver, modes);
  return bar;
}

}  // namespace impactrig::models
