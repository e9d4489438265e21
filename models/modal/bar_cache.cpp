// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/bar_cache.hpp"

#include <functional>
#include <utility>

#include "models/beams/linear_bar.hpp"
#include "models/make_beam.hpp"

namespace impactrig::models {

BarKey BarKey::of(const Rig& rig, const Solver& solver) {
  std::vector<double> further;
  for (const FurtherStop& stop : rig.further_stops)
    further.push_back(stop.direction() * stop.contact.position);
  return {rig.beam,
          rig.hinge,
          rig.contact.position,
          rig.gravity_along(),
          rig.gravity_across(),
          std::move(further),
          solver.model,
          solver.elements,
          solver.modes,
          solver.axial_modes,
          solver.basis,
          LinearBar::negligible_weight_at(solver.accuracy)};
}

std::size_t BarKey::Hash::operator()(const BarKey& key) const {
  std::size_t hash = 0;
  for (const double value :
       {key.beam.length, key.beam.area, key.beam.second_moment, key.beam.youngs_modulus,
        key.beam.density, key.hinge.spring, key.position, key.gravity_along, key.gravity_across})
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
      rig, bar_elements(rig.beam, rig.contact.position, solver.elements),
      LinearBar::negligible_weight_at(solver.accuracy));
  std::vector<double> points;
  for (int stop = 0; stop < rig.stops(); ++stop) points.push_back(rig.contact_of(stop).position);
  return std::make_shared<const ReducedBar>(std::move(bar), std::move(points), modes);
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
