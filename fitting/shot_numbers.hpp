// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "fitting/fitted_channel.hpp"
#include "fitting/shot_model.hpp"
#include "fitting/variables.hpp"

namespace impactrig::fitting {

/// The numbers of a fit that concern one recording: what they are, from the solver's blocks or at
/// the variables' present values, and what they make of the rig, the sensors and the channels.
class ShotNumbers {
 public:
  using Values = std::vector<double>;  ///< of the slots

  /// A number of this recording: that of a block times a factor, and an offset.
  struct Slot {
    const Variable* variable;
    std::size_t block;
    double factor, offset;

    bool needs_simulation() const {
      return variable->role == Variable::Role::physics || variable->role == Variable::Role::chain;
    }
  };

  /// `numbers`: of the variables that concern this recording. The variables must live as long.
  ShotNumbers(const std::vector<Variable>& variables, const std::vector<std::size_t>& numbers);

  const std::vector<Slot>& slots() const { return slots_; }

  /// Numbers of the unknowns that are the parameter blocks, in order.
  const std::vector<std::size_t>& blocks() const { return blocks_; }

  const Variable& unknown(std::size_t block) const { return variables_[blocks_[block]]; }

  /// From the blocks, each the coordinate of its unknown.
  Values values_of(const double* const* parameters) const;

  Values present_values() const;

  /// A number that a simulation needs, where a search without bounds took it too far; a rounding is
  /// not.
  const Slot* beyond_bounds(const Values& values) const;

  models::Rig rig_at(const Values& values, models::Rig rig) const;
  SensorChains chains_at(const Values& values, SensorChains chains) const;

  /// In the order of the slots of each kind.
  WantedSlopes wanted_slopes() const;

  Measurement measurement(datasets::Quantity quantity, const Values& values) const;

  /// Of the background's time: the impact as found [s].
  double origin() const;

 private:
  const std::vector<Variable>& variables_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> blocks_;
};

}  // namespace impactrig::fitting
