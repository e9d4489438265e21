// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "models/simulation.hpp"

namespace impactrig::bench {

enum class Kind {
  answered,
  warned,         ///< answered, with a warning that the energy or the accuracy does not hold
  refused,        ///< with a sentence
  unconfirmed,    ///< answered, but the finer run was refused or late
  not_finite,     ///< from here on: failures
  unsound,        ///< contacts out of order, a pulling force
  energy,         ///< out of balance without a warning
  not_converged,  ///< the finer run differs by more than the accuracy
  endless,
  crashed,
  no_sentence  ///< an exception of another type, or without words
};

inline constexpr std::array kind_names = {"answered",
                                          "answered with a warning",
                                          "refused with a sentence",
                                          "not confirmed",
                                          "not finite",
                                          "unsound",
                                          "energy out of balance",
                                          "not converged",
                                          "over the limit",
                                          "crashed",
                                          "no sentence"};

constexpr bool failed(Kind kind) {
  return kind >= Kind::not_finite;
}

// Of the first run's accuracy, how many times finer the confirming run is.
inline constexpr double finer = 30.0;

/// What came of a scene.
struct Outcome {
  long number = 0;
  Kind kind = Kind::crashed;
  std::string sentence;
  double accuracy = 0.0, imbalance = 0.0;
  double peak = 0.0, duration = 0.0,
         impulse = 0.0;  ///< of the first contact, finer run less this one, relative
  double sensor = 0.0;   ///< likewise, of what the sensor of a stop that gives way carries at most
  double displacement =
      0.0;  ///< without a stop, at most over the run, as a part of the bar's length
  double seconds = 0.0;
  long evaluations = 0, contacts = 0;
  bool small_motion = false;
  bool cut_short = false;  ///< by solver.time_limit

  double error() const { return std::max({peak, duration, impulse, sensor, displacement}); }
};

nlohmann::ordered_json to_json(const Outcome& outcome);
Outcome outcome_of(const nlohmann::ordered_json& json);

/// Whether every number of the run is finite, contacts follow each other, no force pulls where it
/// may not, and the energy balances or a warning says that it does not.
void judge_alone(const models::Rig& rig, const models::Simulation& run, Outcome& outcome);

/// Whether the first contact and the sensor's largest force, or without a stop displacements over
/// the run, agree with a finer run within the accuracy asked for, or a warning says that they may
/// not.
void judge_against(const models::Rig& rig, const models::Simulation& run,
                   const models::Simulation& fine, Outcome& outcome);

/// Turns what simulate() throws into a kind.
template <typename Call>
void guarded(Outcome& outcome, Call call) {
  try {
    call();
  } catch (const std::exception& problem) {
    const bool expected = dynamic_cast<const std::runtime_error*>(&problem) != nullptr ||
                          dynamic_cast<const std::invalid_argument*>(&problem) != nullptr;
    outcome.sentence = problem.what();
    outcome.kind = expected && outcome.sentence.size() > 40 ? Kind::refused : Kind::no_sentence;
  }
}

}  // namespace impactrig::bench
