// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/bar_cache.hpp"

#include <algorithm>

#include "models/make_beam.hpp"

namespace impactrig::models {
namespace {

constexpr double longest_step = 1.0;  // [s], of a bar without vibration

}  // namespace

ModalBar::ModalBar(std::unique_ptr<const SmallMotionBeam> beam, const Rig& rig)
    : beam_(std::move(beam)),
      modes_(*beam_, rig),
      ladder_{std::min(ModalStep::longest(modes_), longest_step)} {}

const ModalStep& ModalBar::step(const Collocation& rule, int level) const {
  const std::lock_guard lock(mutex_);
  auto& step = steps_[{rule.nodes(), level}];
  if (!step) step = std::make_unique<const ModalStep>(modes_, rule, ladder_.length_of(level));
  return *step;
}

std::shared_ptr<const ModalBar> BarCache::bar(const Rig& rig, const Solver& solver) {
  const Key key{rig.beam,     rig.hinge,       rig.contact.position, rig.gravity,
                solver.model, solver.elements, solver.modes,         solver.basis};
  const std::lock_guard lock(mutex_);
  if (!bar_ || key_ != key) {
    bar_ = std::make_shared<const ModalBar>(make_small_motion_beam(rig, solver), rig);
    key_ = key;
  }
  return bar_;
}

}  // namespace impactrig::models
