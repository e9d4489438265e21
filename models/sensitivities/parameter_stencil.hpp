// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "models/simulation.hpp"
#include "models/stencil.hpp"

namespace impactrig::models {

/// Whether the bar may turn by much: released, or without a stop.
bool swings_far(const Rig& rig);

/// A number of the rig and values of it near by, from which derivatives by it are taken. Without a
/// stop Contact::position goes with the tip, where it is; the bar is as long as its segments.
class ParameterStencil {
 public:
  ParameterStencil(const Rig& rig, RigParameter parameter);

  /// Such values that the bar's elements stay what they are, and that what lies on one stays there:
  /// shapes are smooth within an element only.
  ParameterStencil(const Rig& rig, RigParameter parameter, const Solver& solver,
                   const HistoryRequest& history);

  /// False where there are none.
  bool keeps_elements() const { return keeps_elements_; }

  double& number(Rig& rig) const { return parameter_(rig); }

  /// By how much it may change for the rig to change by its like.
  double size() const { return size_; }

  static constexpr std::size_t places = 5;

  /// Whether a place counts.
  bool counts(std::size_t place) const { return stencil_.weights[place] != 0.0; }

  double weight(std::size_t place) const { return stencil_.weights[place] / spacing_; }

  /// How far the number is from its value there.
  double offset(std::size_t place) const { return stencil_.offsets[place] * spacing_; }

  /// The rig there.
  Rig rig_at(std::size_t place) const { return moved(stencil_.offsets[place]); }

  /// The rig beside the one at hand.
  Rig rig_beside() const {
    return moved(stencil_.offsets[4] != 0.0 ? stencil_.offsets[4] : stencil_.offsets[3]);
  }

  /// The rig at hand.
  const Rig& rig() const { return rig_; }

  const Stencil& stencil() const { return stencil_; }

  /// The same at two places where the number may go both ways, with an error of second order.
  ParameterStencil lighter() const {
    ParameterStencil by = *this;
    if (stencil_.offsets[0] == -stencil_.offsets[4])
      by.stencil_.weights = {0.0, -0.5, 0.0, 0.5, 0.0};
    return by;
  }

  /// The same with its places closer together.
  ParameterStencil closer(double factor) const {
    ParameterStencil by = *this;
    by.spacing_ *= factor;
    return by;
  }

  /// visit(place) where it counts.
  template <typename Visitor>
  void for_each_place(const Visitor& visit) const {
    for (std::size_t place = 0; place < places; ++place)
      if (counts(place)) visit(place);
  }

  /// How far the number is moved at most.
  double farthest() const {
    double most = 0.0;
    for_each_place([&](std::size_t place) { most = std::max(most, std::abs(offset(place))); });
    return most;
  }

  /// Σ weight value_at(place).
  template <typename Function>
  double slope(const Function& value_at) const {
    double sum = 0.0;
    for (std::size_t place = 0; place < places; ++place)
      if (counts(place)) sum += stencil_.weights[place] * value_at(place);
    return sum / spacing_;
  }

 private:
  Rig moved(double offset) const;
  double way_of_elements(const Solver& solver, const HistoryRequest& history) const;
  bool fits(const Stencil& stencil, const Solver& solver, const HistoryRequest& history) const;

  const Rig& rig_;
  RigParameter parameter_;
  double size_, spacing_;
  Stencil stencil_;
  bool keeps_elements_ = true;
};

}  // namespace impactrig::models
