// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "models/modal/modal_bar.hpp"
#include "models/simulation.hpp"

namespace impactrig::models {

/// Bars that differ in little but how heavy they are for their stiffness: their modes and what
/// their steps do are smooth in that, nearly constant where the weight bends them little. Of a
/// narrow range a few bars are solved, what lies between is interpolated. For concurrent use.
class BarTable {
 public:
  static constexpr std::size_t size = 4;
  using Weights = std::array<double, size>;

  /// Of bars like `bar`, free of spring and damper and with a single stop, that are about so heavy.
  BarTable(std::shared_ptr<const ModalBar> bar, double heaviness);

  /// The range a bar belongs to, all of them numbered, and where its middle is.
  static int number_of(double heaviness);
  static double middle_of(int number);

  /// Whether the modes between are as good as solved.
  bool knows_modes() const { return knows_modes_; }

  Weights weights(double heaviness) const;

  /// Of bars that weigh what the weights were made for.
  ModalBeam modes(const Weights& weights, const ModalBeam::Change& change) const;
  void find_modes(const Weights& weights, const ModalBeam::Change& change, ModalBeam& modes) const;

  /// Whether steps between are as good as solved.
  bool knows_step(const Collocation& rule, int level) const;

  /// Of the bar that weighs what the weights were made for; into a step that is no longer needed,
  /// or none.
  void find_step(const Weights& weights, const Collocation& rule, int level,
                 const ModalStep::Scale* scale, std::optional<ModalStep>& step) const;

  const std::shared_ptr<const ModalBar>& bar() const { return bar_; }

 private:
  std::shared_ptr<const ModalBar> solved(double heaviness) const;

  std::shared_ptr<const ModalBar> bar_;
  double middle_;
  std::array<double, size> places_;  // [-]
  std::array<std::shared_ptr<const ModalBar>, size> bars_;
  std::shared_ptr<const ModalBar> between_;  // what is interpolated is compared with
  bool knows_modes_ = false;
  enum class Steps : signed char { not_looked_at, known, unknown };
  // by nodes and level
  mutable std::array<std::array<std::atomic<Steps>, StepLadder::levels>, most_nodes + 1> steps_ =
      {};
};

/// Bars of the same length, struck point, mesh and weight a mass, without further masses, have
/// nearly the same modes, whatever E, I, ρ, A and the hinge's spring and damper are: those of each
/// follow from the modes of one that stands for all.
class BarFamily {
 public:
  /// The bar that stands for all; of beams that are in no family, none.
  static std::optional<Rig> representative(const Rig& rig);

  BarFamily(const Rig& representative, const Solver& solver);

  /// For concurrent use.
  std::shared_ptr<const ModalBar> bar(const Rig& rig) const;

 private:
  class BarsBetween;

  std::shared_ptr<BarsBetween> bars_between(double heaviness) const;

  Beam beam_;
  std::shared_ptr<const ModalBar> bar_;
  mutable std::mutex mutex_;
  mutable std::map<int, std::shared_ptr<BarsBetween>> between_;  // by the table's number
};

}  // namespace impactrig::models
