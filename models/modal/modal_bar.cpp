// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_bar.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace impactrig::models {
namespace {

constexpr double longest_step = 1.0;  // [s], of a bar without vibration

double longest_ladder(const ModalBeam& modes) {
  return std::min(ModalStep::longest(modes), longest_step);
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
  left_out_ = beam->left_out();
}

ModalBar::ModalBar(std::shared_ptr<const ModalBar> other, const ModalBeam::Change& change)
    : ModalBar(other, ModalBeam(other->modes(), change)) {}

ModalBar::ModalBar(std::shared_ptr<const ModalBar> other, ModalBeam modes)
    : other_(std::move(other)),
      modes_(std::move(modes)),
      own_modes_(modes_.modes()),
      ladder_{longest_ladder(modes_)} {}

ModalBar::~ModalBar() {
  forget_steps();
  while (unused_) unused_ = std::move(unused_->others);  // not one within the other
}

void ModalBar::forget_steps() {
  for (std::atomic<Steps*>& kept : steps_) {
    if (!kept.load(std::memory_order_relaxed)) continue;
    std::unique_ptr<Steps> steps(kept.exchange(nullptr));
    while (steps) {
      std::unique_ptr<Steps> others = std::exchange(steps->others, std::move(unused_));
      unused_ = std::exchange(steps, std::move(others));
    }
  }
}

void ModalBar::measure() {
  own_modes_ = modes_.modes();
  ladder_ = {longest_ladder(modes_)};
}

const ModalStep& ModalBar::step(const Collocation& rule, int level) const {
  const int nodes = rule.nodes();
  std::atomic<Steps*>& kept = steps_[static_cast<std::size_t>(level)];
  const auto find = [&]() -> const ModalStep* {
    for (const Steps* steps = kept.load(std::memory_order_acquire); steps;
         steps = steps->others.get())
      if (steps->nodes == nodes) return &*steps->step;
    return nullptr;
  };
  if (const ModalStep* step = find()) return *step;
  const std::lock_guard lock(mutex_);
  if (const ModalStep* step = find()) return *step;
  std::unique_ptr<Steps> added = std::move(unused_);
  if (added)
    unused_ = std::move(added->others);
  else
    added = std::make_unique<Steps>();
  added->nodes = nodes;
  make_step(rule, level, added->step);
  added->others.reset(kept.load());
  kept.store(added.release(), std::memory_order_release);
  return *kept.load()->step;
}

void ModalBar::make_step(const Collocation& rule, int level, std::optional<ModalStep>& step) const {
  step.emplace(modes_, rule, ladder_.length_of(level));
}

}  // namespace impactrig::models
