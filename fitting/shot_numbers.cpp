// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot_numbers.hpp"

#include <algorithm>

namespace impactrig::fitting {

using Role = Variable::Role;

ShotNumbers::ShotNumbers(const std::vector<Variable>& variables,
                         const std::vector<std::size_t>& numbers)
    : variables_(variables) {
  for (const std::size_t number : numbers) {
    const Variable& v = variables_[number];
    const std::size_t unknown = v.tie ? v.tie->to : number;
    auto block = std::ranges::find(blocks_, unknown);
    if (block == blocks_.end()) block = blocks_.insert(blocks_.end(), unknown);
    slots_.push_back({&v, static_cast<std::size_t>(block - blocks_.begin()),
                      v.tie ? v.tie->factor : 1.0, v.tie ? v.tie->offset : 0.0});
  }
}

ShotNumbers::Values ShotNumbers::values_of(const double* const* parameters) const {
  Values values;
  for (const Slot& slot : slots_)
    values.push_back(slot.offset +
                     slot.factor * unknown(slot.block).value_at(parameters[slot.block][0]));
  return values;
}

ShotNumbers::Values ShotNumbers::present_values() const {
  Values values;
  for (const Slot& slot : slots_)
    values.push_back(slot.offset + slot.factor * unknown(slot.block).value);
  return values;
}

const ShotNumbers::Slot* ShotNumbers::beyond_bounds(const Values& values) const {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const Variable& v = *slots_[i].variable;
    const double rounding = 1e-12 * v.scale;
    if (slots_[i].needs_simulation() && !v.tie &&
        !(values[i] >= v.lower - rounding && values[i] <= v.upper + rounding))
      return &slots_[i];
  }
  return nullptr;
}

models::Rig ShotNumbers::rig_at(const Values& values, models::Rig rig) const {
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (slots_[i].variable->physics) slots_[i].variable->physics->of(rig) = values[i];
  return rig;
}

SensorChains ShotNumbers::chains_at(const Values& values, SensorChains chains) const {
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (const Variable& v = *slots_[i].variable; v.chain) {
      auto& sensor = chains.of(v.quantity);
      if (!sensor) sensor.emplace().quantity = v.quantity;
      v.chain->of(*sensor) = values[i];
    }
  return chains;
}

WantedSlopes ShotNumbers::wanted_slopes() const {
  WantedSlopes wanted;
  for (const Slot& slot : slots_) {
    if (slot.variable->physics) wanted.rig.push_back(slot.variable->physics->of);
    if (slot.variable->chain)
      wanted.chain.push_back({slot.variable->quantity, slot.variable->chain});
  }
  return wanted;
}

Measurement ShotNumbers::measurement(datasets::Quantity quantity, const Values& values) const {
  Measurement m;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const Variable& v = *slots_[i].variable;
    if (v.role == Role::touch) m.shift += values[i];
    if (v.quantity != quantity) continue;
    if (v.role == Role::gain) m.gain = values[i];
    if (v.role == Role::delay)
      m.shift += values[i] - v.initial;  // the known part is off the clock already
  }
  return m;
}

double ShotNumbers::origin() const {
  double origin = 0.0;
  for (const Slot& slot : slots_)
    if (slot.variable->role == Role::touch) origin = slot.variable->initial;
  return origin;
}

}  // namespace impactrig::fitting
