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

ModalBar::ModalBar(std::shared_ptr<const SmallMotionBeam> beam, const Rig& rig)
    : beam_(std::move(beam)),
      modes_(*beam_, rig),
      own_modes_(modes_.modes()),
      ladder_{longest_ladder(modes_)} {}

ModalBar::ModalBar(std::shared_ptr<const ReducedBar> beam, const Rig& rig)
    : ModalBar(std::static_pointer_cast<const SmallMotionBeam>(beam), rig) {
  own_modes_ = beam->own_modes();
}

ModalBar::ModalBar(std::shared_ptr<const ModalBar> other, const ModalBeam::Change& change)
    : other_(std::move(other)),
      modes_(other_->modes(), change),
      own_modes_(modes_.modes()),
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
  return {rig.beam,           rig.hinge,    rig.contact.position, rig.gravity,
          std::move(further), solver.model, solver.elements,      solver.modes,
          solver.axial_modes, solver.basis};
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
  return std::make_shared<const ModalBar>(
      std::shared_ptr<const SmallMotionBeam>(make_small_motion_beam(rig, solver)), rig);
}

std::shared_ptr<const ReducedBar> make_reduced_bar(const Rig& rig, const Solver& solver,
                                                   int modes) {
  auto bar = std::make_shared<const LinearBar>(
      rig, bar_elements(rig.beam, rig.contact.position, solver.elements));
  std::vector<double> points;
  for (int stop = 0; stop < rig.stops(); ++stop) points.push_back(rig.contact_of(stop).position);
  return std::make_shared<const ReducedBar>(std::move(bar), std::move(points), modes);
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

void BarCache::forget_others(const Rig& rig, const Solver& solver) {
  BarKey key = BarKey::of(rig, solver);
  if (key_ == key) return;
  whole_.reset();
  reduced_.clear();
  last_.reset();
  key_ = std::move(key);
}

std::shared_ptr<const ModalBar> BarCache::bar(const Rig& rig, const Solver& solver) {
  const std::lock_guard lock(mutex_);
  forget_others(rig, solver);
  if (!whole_) whole_ = make_modal_bar(rig, solver);
  return whole_;
}

std::shared_ptr<const ModalBar> BarCache::reduced_bar(const Rig& rig, const Solver& solver,
                                                      int modes) {
  const std::lock_guard lock(mutex_);
  forget_others(rig, solver);
  std::shared_ptr<const ModalBar>& bar = reduced_[modes];
  if (bar) return bar;
  last_ = last_ ? std::make_shared<const ReducedBar>(*last_, modes)
                : make_reduced_bar(rig, solver, modes);
  bar = std::make_shared<const ModalBar>(last_, rig);
  return bar;
}

}  // namespace impactrig::models
